//! Slips of a log as the robot knew them at each time, by the online filter over modes: what `bench/estimators` judges next to
//! `estimate`.
//!
//! ```text
//! cargo run --release -p grouser-replay --example slip_path -- LOG.csv --robot R.toml --map C.toml -o OUT.csv
//! ```
//!
//! Delays that the robot file does not state and held readings are not found, and carriers of wheels are ignored. The first place
//! and heading are known from the start.

use std::fmt::Write as _;
use std::path::PathBuf;

use grouser_files::columns;
use grouser_files::robot::{self, RobotFile};
use grouser_log::Log;
use grouser_replay::{Inputs, Options, log_steps};
use grouser_slip::modes::ModeFilter;
use grouser_slip::motion::{Levels, Noise, Step, Value, start};
use grouser_slip::{Reference, WheelRole};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut files, mut robot, mut map, mut out) = (Vec::new(), None, None, None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--robot" => robot = arguments.next().map(PathBuf::from),
            "--map" => map = arguments.next().map(PathBuf::from),
            "-o" => out = arguments.next().map(PathBuf::from),
            _ => files.push(PathBuf::from(argument)),
        }
    }
    let file = robot::read(&robot.ok_or("--robot is missing")?)?;
    let map = map.map(|map| columns::read(&map)).transpose()?;
    let map = map.or_else(|| file.columns.clone());
    let log = Log::find_any(&files, map, &file.topics)?;
    let inputs = Inputs::of(&log, &file, &Options::default())?;
    let steps = log_steps(&log, &file, &inputs)?;
    let values = || {
        steps
            .iter()
            .flat_map(|step| &step.readings)
            .map(|of| of.value)
    };
    let place = values().find_map(|value| match value {
        Value::Place(place) => Some(place),
        Value::Heading(_) | Value::Speed(_) => None,
    });
    let heading = values().find_map(|value| match value {
        Value::Heading(heading) => Some(heading),
        Value::Place(_) | Value::Speed(_) => None,
    });
    let has_gyro = steps.iter().any(|step| step.turn.is_some());
    let begin = start(
        place.unwrap_or_default(),
        heading.unwrap_or_default(),
        has_gyro,
    );
    let mut levels = prior(&file, &inputs, has_gyro);
    // gravity on slopes is not taken out of the accelerometer: next to a free wheel, which measures the speed, all of it may be slopes
    if (file.robot.wheels().iter()).any(|wheel| wheel.role == WheelRole::Free) {
        levels.0[Noise::ForceBias as usize] = SLOPES * SLOPES;
    }
    let filter = ModeFilter::new(begin, levels, file.robot.wheels().len());
    let text = table(&file, &steps, &filter, file.filter.reference_latency)?;
    std::fs::write(out.ok_or("-o is missing")?, text)?;
    Ok(())
}

/// Random walk of gravity along the robot on rough ground, m/s²/√s: a prior, slopes of 3° within a second.
const SLOPES: f64 = 0.5;
/// Limit of the printed probability: slip above it is high.
const HIGH_SLIP: f64 = 0.6;

/// What is known at each step's end; `exceeds` is the probability of high slip.
///
/// A step ends between two rows of the wheels, so that it is known when the second of them is: up to one row later than its time.
/// A reading counts from its arrival on, `latency` after it was taken.
fn table(
    file: &RobotFile,
    steps: &[Step],
    begin: &ModeFilter,
    latency: f64,
) -> Result<String, Box<dyn std::error::Error>> {
    let wheels = file.robot.wheels();
    let (mut settled, mut ahead) = (begin.clone(), begin.clone());
    let mut text = String::from("time_s,wheel,slip,slip_sigma,motion,health,exceeds\n");
    let mut done = 0;
    for (now, step) in steps.iter().enumerate() {
        // the filter waits for the readings of a step, and a copy of it goes on without them
        while done <= now && steps[done].time <= step.time - latency {
            settled.advance(&steps[done])?;
            done += 1;
        }
        ahead.clone_from(&settled);
        for step in &steps[done..=now] {
            let mut unread = step.clone();
            unread.readings.clear();
            ahead.advance(&unread)?;
        }
        let filter = &ahead;
        for (index, wheel) in wheels.iter().enumerate() {
            if let (Some(slip), Some(exceeds)) =
                (filter.wheel_slip(index), filter.exceeds(index, HIGH_SLIP))
            {
                let (time, sigma) = (step.time, slip.variance.sqrt());
                writeln!(
                    text,
                    "{time:.4},{},{:.5},{sigma:.5},,Ok,{exceeds:.4}",
                    wheel.name, slip.slip
                )?;
            }
        }
    }
    Ok(text)
}

/// Sigmas of the kinds of noise before the log, in the order of [`Noise::ALL`].
fn prior(file: &RobotFile, inputs: &Inputs, has_gyro: bool) -> Levels {
    let by_displacement = inputs.reference == Reference::Displacement;
    let settings = &file.settings;
    // a cheap gyro's, or what wheels make of a turn
    let (turn, turn_bias) = if has_gyro { (2e-3, 2e-4) } else { (0.02, 0.04) };
    // a sum of displacements wanders, a pose does not; where the robot file states no noise, it is that of visual odometry at
    // 10 Hz, or of a GNSS or camera of middling quality
    let stated = file.topics.position_sigma;
    let (wander, place) = match (by_displacement, stated) {
        (true, Some(sigma)) => (1e-3, sigma),
        (true, None) => (6e-3, 3e-3),
        (false, sigma) => (1e-5, sigma.unwrap_or(0.02)),
    };
    let sigmas = [
        0.03,
        0.03,
        0.03,
        turn,
        turn_bias,
        3e-3,
        wander,
        place,
        settings.yaw_sigma,
        settings.speed_sigma,
        1.0,
    ];
    Levels(sigmas.map(|sigma| sigma * sigma))
}
