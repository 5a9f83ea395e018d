//! A recorded log through the estimator: the rows of `grouser estimate -o` in columns, and its doubts.

use std::io::{self, Cursor};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use grouser_files::{Document, columns, robot};
use grouser_log::Log;
use grouser_replay::{Options, Row, Sink, Step, run_into};
use serde_json::{Value, json};

use crate::request::{Problem, Request};
use crate::run::WheelColumns;

/// Most moments that are handed out; a longer run is thinned to every k-th, and `every` says so.
const MAX_MOMENTS: usize = 40_000;

/// Runs the log in `log_base64`, named `log_name`, with the robot file in `robot` and the column map in `columns`.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let bytes = STANDARD
        .decode(request.text("log_base64")?)
        .map_err(|error| Problem::new("log_base64", error.to_string()))?;
    let document =
        |name: &str, text: &str| Document::from_text(name, text.to_owned()).map_err(Problem::of);
    let robot =
        robot::parse(&document("robot.toml", request.text("robot")?)?).map_err(Problem::of)?;
    let map = request
        .optional_text("columns")?
        .map(|text| columns::parse(&document("columns.toml", text)?).map_err(Problem::of))
        .transpose()?
        .or_else(|| robot.columns.clone());
    let name = request.optional_text("log_name")?.unwrap_or("log");
    let log =
        Log::over(name.as_ref(), Cursor::new(bytes), map, &robot.topics).map_err(Problem::of)?;
    let names: Vec<String> = robot
        .robot
        .wheels()
        .iter()
        .map(|wheel| wheel.name.clone())
        .collect();
    let mut moments = Moments::new(names.len());
    let summary = run_into(&log, &robot, &Options::default(), &mut moments).map_err(Problem::of)?;
    let fused = summary.fused.as_ref();
    let doubts: Vec<String> = fused
        .map(|fused| fused.doubts.iter().map(ToString::to_string).collect())
        .unwrap_or_default();
    let wheels: Vec<Value> = names
        .iter()
        .zip(&moments.wheels)
        .zip(&summary.wheels)
        .map(|((name, columns), whole)| {
            let mut wheel = columns.object(name);
            wheel["median_slip"] = json!(whole.slip.median);
            wheel["is_reference"] = json!(whole.is_reference);
            wheel
        })
        .collect();
    Ok(json!({
        "kind": "estimate",
        "title": name,
        "duration_s": moments.time.last(),
        "distance_m": moments.distance,
        "doubts": doubts,
        "every": moments.every,
        "time_s": moments.time,
        "x_m": moments.x,
        "y_m": moments.y,
        "heading_deg": moments.heading,
        "speed_m_per_s": moments.speed,
        "wheels": wheels,
    }))
}

/// The moments of a run, every `every`-th of them.
struct Moments {
    every: usize,
    count: usize,
    time: Vec<f64>,
    x: Vec<Option<f64>>,
    y: Vec<Option<f64>>,
    heading: Vec<Option<f64>>,
    speed: Vec<Option<f64>>,
    distance: Option<f64>,
    wheels: Vec<WheelColumns>,
}

impl Moments {
    fn new(wheels: usize) -> Self {
        Self {
            every: 1,
            count: 0,
            time: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            heading: Vec::new(),
            speed: Vec::new(),
            distance: None,
            wheels: (0..wheels).map(|_| WheelColumns::default()).collect(),
        }
    }

    /// Drops every second moment.
    fn halve(&mut self) {
        self.every *= 2;
        let halve = |column: &mut Vec<Option<f64>>| {
            let mut i = 0;
            column.retain(|_| {
                i += 1;
                i % 2 == 1
            });
        };
        let mut i = 0;
        self.time.retain(|_| {
            i += 1;
            i % 2 == 1
        });
        for column in [&mut self.x, &mut self.y, &mut self.heading, &mut self.speed] {
            halve(column);
        }
        for wheel in &mut self.wheels {
            halve(&mut wheel.slip);
            halve(&mut wheel.sigma);
        }
    }
}

impl Sink for Moments {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        let wheel = &mut self.wheels[row.wheel];
        let motion = row.motion.map_or("", grouser_slip::Motion::name);
        wheel.motion.add(row.time_s, motion);
        wheel.health.add(row.time_s, &row.health.to_string());
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        self.distance = step
            .odometry
            .map(|odometry| odometry.distance)
            .or(self.distance);
        let due = self.count.is_multiple_of(self.every);
        self.count += 1;
        if !due {
            return Ok(());
        }
        self.time.push(step.time_s);
        let of = |pick: &dyn Fn(&grouser_replay::Odometry) -> f64| step.odometry.as_ref().map(pick);
        self.x.push(of(&|odometry| odometry.pose[0]));
        self.y.push(of(&|odometry| odometry.pose[1]));
        self.heading
            .push(of(&|odometry| odometry.pose[2].to_degrees()));
        self.speed.push(of(&|odometry| odometry.velocity[0]));
        for (columns, wheel) in self.wheels.iter_mut().zip(step.wheels) {
            columns
                .slip
                .push(wheel.slip.map(grouser_terra::Slip::value));
            columns.sigma.push(wheel.sigma);
        }
        if self.time.len() >= MAX_MOMENTS {
            self.halve();
        }
        Ok(())
    }
}
