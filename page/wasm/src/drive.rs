//! A drive from a scenario: the numbers of `grouser drive --json`, and what was seen on the way.

use grouser_files::Document;
use grouser_rover::drive::{Pilot, Simulation, parse_scenario};
use grouser_rover::robot::RobotModel;
use serde_json::{Value, json};

use crate::request::{Problem, Request};
use crate::run::{Spans, WheelColumns};

/// Frames kept a second.
const FRAMES_PER_S: f64 = 10.0;
/// Slower than this, rim and centre, a slip is the quotient of two rests and is not shown, m/s.
const MIN_SHOWN_SPEED_M_PER_S: f64 = 0.02;

/// Drives the scenario in `scenario` with the robot in `robot`, both as the text of their files; `pilot` and `seed` as
/// of the command.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let document = |name: &str, field: &str| {
        Document::from_text(name, request.text(field)?.to_owned()).map_err(Problem::of)
    };
    let robot = RobotModel::parse(&document("robot.toml", "robot")?).map_err(Problem::of)?;
    let name = request.optional_text("name")?.unwrap_or("scenario");
    let scenario = parse_scenario(&document("scenario.toml", "scenario")?, name, robot)
        .map_err(Problem::of)?;
    let pilot = match request.optional_text("pilot")? {
        None => Pilot::Controller,
        Some(name) => Pilot::ALL
            .into_iter()
            .find(|pilot| pilot.name() == name)
            .ok_or_else(|| Problem::new("pilot", format!("`{name}` is no driver")))?,
    };
    let seed = match request.optional_number("seed")? {
        Some(_) => u64::from(request.count("seed", u32::MAX)?),
        None => scenario.seed,
    };
    let optimum = scenario.slip_setpoint().map_err(Problem::of)?;
    let mut simulation = Simulation::new(&scenario, pilot, optimum, seed).map_err(Problem::of)?;
    let mut seen = Seen::new(scenario.robot.wheels.len());
    let result = simulation.run(|frame| {
        seen.add(frame);
        true
    });
    let wheels: Vec<Value> = scenario
        .robot
        .wheels
        .iter()
        .zip(&seen.wheels)
        .map(|(wheel, columns)| {
            let mut object = columns.object(&wheel.name);
            object["is_reference"] = json!(wheel.motor.is_none());
            object
        })
        .collect();
    let decisions: Vec<Value> = result
        .decisions
        .iter()
        .map(|named| {
            let decision = &named.decision;
            json!({
                "time_s": named.time,
                "action": decision.action.name(),
                "reason": decision.reason.name(),
                "wheel": decision.wheel.and_then(|i| scenario.robot.wheels.get(i)).map(|wheel| &wheel.name),
                "value": decision.value,
                "limit": decision.limit,
                "x_m": named.place.0,
                "y_m": named.place.1,
            })
        })
        .collect();
    Ok(json!({
        "kind": "drive",
        "title": scenario.title,
        "controller": pilot.name(),
        "seed": seed,
        "optimum_slip": optimum,
        "outcome": result.outcome.name(),
        "duration_s": result.duration,
        "distance_m": result.distance,
        "way_m": result.way,
        "energy_j": result.energy,
        "energy_j_per_m": result.energy_per_metre(),
        "energy_in_soil_j": result.ledger.soil,
        "energy_books_error": result.energy_error,
        "slip_rmse": result.slip.rmse,
        "worst_slip": result.worst_slip,
        "decisions": decisions,
        "time_s": seen.time,
        "x_m": seen.x,
        "y_m": seen.y,
        "heading_deg": seen.heading,
        "speed_m_per_s": seen.speed,
        "estimated_speed_m_per_s": seen.estimated_speed,
        "requested_speed_m_per_s": seen.requested_speed,
        "used_energy_j": seen.energy,
        "mode": seen.mode.object(),
        "wheels": wheels,
    }))
}

/// What was seen on the way.
struct Seen {
    time: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    heading: Vec<f64>,
    speed: Vec<f64>,
    estimated_speed: Vec<Option<f64>>,
    requested_speed: Vec<f64>,
    energy: Vec<f64>,
    mode: Spans,
    wheels: Vec<WheelColumns>,
}

impl Seen {
    fn new(wheels: usize) -> Self {
        Self {
            time: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            heading: Vec::new(),
            speed: Vec::new(),
            estimated_speed: Vec::new(),
            requested_speed: Vec::new(),
            energy: Vec::new(),
            mode: Spans::default(),
            wheels: (0..wheels).map(|_| WheelColumns::default()).collect(),
        }
    }

    /// One frame more, if it is due.
    fn add(&mut self, frame: &grouser_rover::drive::Frame<'_>) {
        self.mode.add(frame.time, frame.mode.name());
        let due = self
            .time
            .last()
            .is_none_or(|last| frame.time - last >= 1.0 / FRAMES_PER_S - 1e-9);
        if !due {
            return;
        }
        self.time.push(frame.time);
        self.x.push(frame.place[0]);
        self.y.push(frame.place[1]);
        self.heading.push(frame.angles[2].to_degrees());
        self.speed.push(frame.speed);
        self.estimated_speed.push(frame.estimated_speed);
        self.requested_speed.push(frame.requested_speed);
        self.energy.push(frame.energy);
        for (columns, wheel) in self.wheels.iter_mut().zip(frame.wheels) {
            let fastest = wheel.speeds[0].abs().max(wheel.speeds[1].abs());
            let moves = fastest >= MIN_SHOWN_SPEED_M_PER_S;
            columns.true_slip.push(wheel.slip.filter(|_| moves));
            columns.slip.push(wheel.observation.slip);
            columns.sigma.push(wheel.observation.sigma);
            columns.torque.push(Some(wheel.torque));
            columns.sinkage.push(Some(wheel.sinkage));
            let motion = wheel
                .observation
                .motion
                .map_or("", grouser_slip::Motion::name);
            columns.motion.add(frame.time, motion);
            columns
                .health
                .add(frame.time, &wheel.observation.health.to_string());
        }
    }
}
