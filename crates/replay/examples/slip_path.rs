//! Slips of a log as the robot knew them at each time, by the online estimator over modes: what `bench/estimators` judges next to
//! `estimate`.
//!
//! ```text
//! cargo run --release -p grouser-replay --example slip_path -- LOG.csv --robot R.toml --map C.toml -o OUT.csv
//! ```

use std::fmt::Write as _;
use std::path::PathBuf;

use grouser_files::columns;
use grouser_files::robot;
use grouser_log::Log;
use grouser_replay::{Inputs, Options, log_samples};
use grouser_slip::Health;
use grouser_slip::online::{EstimatorSettings, SlipEstimator};

/// Slip above this is high: the limit of the row `high-slip` of `bench/estimators`.
const HIGH_SLIP: f64 = 0.6;

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
    let (samples, latency) = log_samples(&log, &file, &inputs)?;
    let usual = EstimatorSettings::default();
    let settings = EstimatorSettings {
        horizon: 0.0,
        free_slip: file.filter.free_slip,
        position_sigma: (inputs.position_sigma.or(file.topics.position_sigma))
            .unwrap_or(usual.position_sigma),
        yaw_sigma: file.settings.yaw_sigma,
        speed_sigma: file.settings.speed_sigma,
        reference_latency: latency,
        max_speed: file.settings.max_speed,
        dropout: file.settings.dropout,
        ..usual
    };
    let mut estimator = SlipEstimator::new(&file.robot, settings)?;
    let start_ns = samples.first().map_or(0, |sample| sample.time_ns);
    let mut text = String::from("time_s,wheel,slip,slip_sigma,motion,health,exceeds\n");
    for sample in samples {
        // a refused sample is counted
        let _ = estimator.update(sample);
        let Some(wheel) = sample
            .measurement
            .wheel()
            .filter(|_| sample.measurement.is_rotation())
        else {
            continue;
        };
        let known = estimator.latest();
        let estimate = known.wheels[wheel];
        if let (Some(slip), Some(sigma)) = (estimate.slip, estimate.sigma) {
            let time = (sample.time_ns - start_ns) as f64 * 1e-9;
            let health = if estimate.health == Health::Ok {
                "Ok"
            } else {
                "Degraded"
            };
            let exceeds = known.exceeds(wheel, HIGH_SLIP).unwrap_or(f64::NAN);
            let name = &file.robot.wheels()[wheel].name;
            let slip = slip.value();
            writeln!(
                text,
                "{time:.4},{name},{slip:.5},{sigma:.5},,{health},{exceeds:.4}"
            )?;
        }
    }
    std::fs::write(out.ok_or("-o is missing")?, text)?;
    Ok(())
}
