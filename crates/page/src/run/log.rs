//! A recorded log through the estimator: the rows of `grouser estimate -o`, and its doubts.

use std::io;

use grouser_replay::{Row, Sink, Step, Summary};
use serde_json::{Value, json};

use super::columns::WheelColumns;

/// Most moments that are kept; a longer run is thinned to every k-th, and `every` says so.
const MAX_MOMENTS: usize = 40_000;

/// The rows of a log through the estimator, in columns.
///
/// ```
/// use grouser_page::run::LogRecorder;
///
/// let recorder = LogRecorder::new(4); // a sink of `grouser_replay::run_into`
/// # let _ = recorder;
/// ```
#[derive(Debug)]
pub struct LogRecorder {
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

impl LogRecorder {
    /// Takes the rows of a robot of `wheels` wheels.
    #[must_use]
    pub fn new(wheels: usize) -> Self {
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

    /// The run as the page plays it; `title` names the log.
    #[must_use]
    pub fn object(&self, title: &str, summary: &Summary) -> Value {
        let doubts: Vec<String> = summary.doubts().iter().map(ToString::to_string).collect();
        let wheels: Vec<Value> = self
            .wheels
            .iter()
            .zip(&summary.wheels)
            .map(|(columns, whole)| {
                let mut wheel = columns.object(&whole.name);
                wheel["median_slip"] = json!(whole.slip.median);
                wheel["is_reference"] = json!(whole.is_reference);
                wheel
            })
            .collect();
        json!({
            "kind": "estimate",
            "title": title,
            "duration_s": self.time.last(),
            "distance_m": self.distance,
            "doubts": doubts,
            "every": self.every,
            "time_s": self.time,
            "x_m": self.x,
            "y_m": self.y,
            "heading_deg": self.heading,
            "speed_m_per_s": self.speed,
            "wheels": wheels,
        })
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

impl Sink for LogRecorder {
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
