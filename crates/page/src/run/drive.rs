//! A simulated drive: the numbers of `grouser drive --json`, and what was seen on the way.

use grouser_rover::drive::{DriveResult, Frame, NamedDecision, Pilot, Scenario};
use serde_json::{Value, json};

use super::columns::{Spans, WheelColumns, WheelTruth};
use super::{ground, learnt};

/// Frames kept a second: enough for a figure.
const FRAMES_PER_S: f64 = 10.0;
/// Slower than this, rim and centre, a slip is the quotient of two rests and is not shown, m/s.
const MIN_SHOWN_SPEED_M_PER_S: f64 = 0.02;

/// A finished drive.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'a> {
    /// What was driven.
    pub scenario: &'a Scenario,
    /// Who drove.
    pub pilot: Pilot,
    /// The seed of ground and noise.
    pub seed: u64,
    /// The slip setpoint.
    pub optimum: f64,
    /// What came of it.
    pub result: &'a DriveResult,
}

/// What was seen on the way, ten times a second.
///
/// ```no_run
/// use grouser_page::run::{Drive, DriveRecorder};
/// use grouser_rover::drive::{Pilot, Simulation, read_scenario};
///
/// let scenario = read_scenario("examples/scenarios/sandbox.toml".as_ref())?;
/// let optimum = scenario.slip_setpoint()?;
/// let mut seen = DriveRecorder::default();
/// let mut simulation = Simulation::new(&scenario, Pilot::Controller, optimum, scenario.seed)?;
/// let result = simulation.run(|frame| {
///     seen.add(frame);
///     true
/// });
/// let drive = Drive {
///     scenario: &scenario,
///     pilot: Pilot::Controller,
///     seed: scenario.seed,
///     optimum,
///     result: &result,
/// };
/// let run = seen.object(&drive);
/// assert_eq!(run["kind"], "drive");
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct DriveRecorder {
    time: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    heading: Vec<f64>,
    progress: Vec<f64>,
    speed: Vec<f64>,
    estimated_speed: Vec<Option<f64>>,
    requested_speed: Vec<f64>,
    energy: Vec<f64>,
    optimum: Vec<f64>,
    /// deg; none for a chassis without actuators.
    tip_over_margin: Vec<Option<f64>>,
    mode: Spans,
    wheels: Vec<WheelColumns>,
}

impl DriveRecorder {
    /// One frame more, if it is due.
    pub fn add(&mut self, frame: &Frame<'_>) {
        self.mode.add(frame.time, frame.mode.name());
        let due = self
            .time
            .last()
            .is_none_or(|last| frame.time - last >= 1.0 / FRAMES_PER_S - 1e-9);
        if !due {
            return;
        }
        self.time.push(rounded(frame.time));
        self.x.push(rounded(frame.place[0]));
        self.y.push(rounded(frame.place[1]));
        self.heading.push(rounded(frame.angles[2].to_degrees()));
        self.progress.push(rounded(frame.distance));
        self.speed.push(rounded(frame.speed));
        self.estimated_speed
            .push(frame.estimated_speed.map(rounded));
        self.requested_speed.push(rounded(frame.requested_speed));
        self.energy.push(rounded(frame.energy));
        self.optimum.push(rounded(frame.optimum));
        if !frame.actuators.is_empty() {
            let margin = frame.tip_over_margin.map(f64::to_degrees);
            self.tip_over_margin.push(margin.map(rounded));
        }
        self.wheels
            .resize_with(frame.wheels.len(), WheelColumns::default);
        for (columns, wheel) in self.wheels.iter_mut().zip(frame.wheels) {
            let fastest = wheel.speeds[0].abs().max(wheel.speeds[1].abs());
            let moves = fastest >= MIN_SHOWN_SPEED_M_PER_S;
            columns
                .true_slip
                .push(wheel.slip.filter(|_| moves).map(rounded));
            columns.slip.push(wheel.observation.slip.map(rounded));
            columns.sigma.push(wheel.observation.sigma.map(rounded));
            columns.torque.push(Some(rounded(wheel.torque)));
            columns.sinkage.push(Some(rounded(wheel.sinkage)));
            // to a tenth of a millimetre, of a degree and a hundredth of a newton: a page stays small
            let coarse = |value: f64, steps: f64| (value * steps).round() / steps;
            let ([along, across], [x, y, _]) = (wheel.forces, wheel.place);
            columns.truth.push(WheelTruth {
                place: [x, y].map(|place| coarse(place, 1e4)),
                heading: coarse(wheel.heading.to_degrees(), 10.0),
                forces: [along, across, wheel.load].map(|force| coarse(force, 1e2)),
            });
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

    /// The run as the page plays it.
    #[must_use]
    pub fn object(&self, drive: &Drive<'_>) -> Value {
        let Drive {
            scenario, result, ..
        } = *drive;
        let wheels: Vec<Value> = scenario
            .robot
            .wheels
            .iter()
            .zip(&self.wheels)
            .map(|(wheel, columns)| {
                let mut object = columns.object(&wheel.name);
                object["is_reference"] = json!(wheel.motor.is_none());
                object["radius_m"] = json!(wheel.wheel.radius());
                object["width_m"] = json!(wheel.wheel.width());
                object
            })
            .collect();
        json!({
            "kind": "drive",
            "title": scenario.title,
            "robot": scenario.robot.robot.name(),
            "controller": drive.pilot.name(),
            "seed": drive.seed,
            "optimum_slip": drive.optimum,
            "outcome": result.outcome.name(),
            "duration_s": result.duration,
            "distance_m": result.distance,
            "way_m": result.way,
            "energy_j": result.energy,
            "energy_j_per_m": result.energy_per_metre(),
            "energy_in_soil_j": result.ledger.soil,
            "energy_books_error": result.energy_error,
            "energy_went_into": energy_went_into(drive),
            "slip_rmse": result.slip.rmse,
            "worst_slip": result.worst_slip,
            "soil": learnt::soil(result.soil.as_ref()),
            "decisions": result.decisions.iter().map(|named| decision(scenario, named)).collect::<Vec<_>>(),
            "decision_count": result.decision_count,
            "ground": ground::object(drive, &self.x, &self.y),
            "time_s": self.time,
            "x_m": self.x,
            "y_m": self.y,
            "heading_deg": self.heading,
            "progress_m": self.progress,
            "speed_m_per_s": self.speed,
            "estimated_speed_m_per_s": self.estimated_speed,
            "requested_speed_m_per_s": self.requested_speed,
            "used_energy_j": self.energy,
            "slip_setpoint": (drive.pilot != Pilot::OpenLoop).then_some(&self.optimum),
            "tip_over_margin_deg": (!self.tip_over_margin.is_empty()).then_some(&self.tip_over_margin),
            "mode": self.mode.object(),
            "wheels": wheels,
        })
    }
}

/// To a millionth of its unit, far below what a picture shows: a page with a drive in it is a third as large.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// Where the electrical energy went, J: words and amounts that add up to all of it.
fn energy_went_into(drive: &Drive<'_>) -> Value {
    let ledger = &drive.result.ledger;
    let mut rows = vec![
        ("electronics", drive.scenario.hotel * drive.result.duration),
        ("heat of motors and gears", ledger.motor_heat),
        ("soil", ledger.soil),
        ("bearings", ledger.bearings),
        ("dampers", ledger.dampers),
    ];
    let gone: f64 = rows.iter().map(|(_, energy)| energy).sum();
    rows.push((
        "height and motion, and what the books lack",
        drive.result.energy - gone,
    ));
    json!(rows)
}

fn decision(scenario: &Scenario, named: &NamedDecision) -> Value {
    let decision = &named.decision;
    let wheel = decision.wheel.and_then(|i| scenario.robot.wheels.get(i));
    json!({
        "time_s": named.time,
        "action": decision.action.name(),
        "reason": decision.reason.name(),
        "wheel": wheel.map(|wheel| &wheel.name),
        "value": decision.value,
        "limit": decision.limit,
        "x_m": named.place.0,
        "y_m": named.place.1,
    })
}
