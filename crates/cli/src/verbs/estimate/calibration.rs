//! `estimate --calibrate-radius`: the effective radius from runs without slip.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::path::{Path, PathBuf};

use grouser_files::{Document, robot};
use grouser_replay::{Calibration, calibrate_radius};
use grouser_report::{Fields, fields};
use grouser_slip::WheelRole;

use super::request::Request;
use crate::error::{Error, Result, shown};
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;

/// Each log is a run of its own here.
pub(super) fn run(
    paths: &[PathBuf],
    robot_path: &Path,
    request: &Request,
    target: &Path,
    session: &mut Session,
) -> Result<Report> {
    let mut output = OutputFile::create(target)?;
    let mut logs = Vec::new();
    for path in paths {
        let log = request.log(std::slice::from_ref(path))?;
        for file in log.files() {
            session.used_file(file)?;
        }
        logs.push(log);
    }
    let found = calibrate_radius(&logs, &request.robot, &request.options)?;
    let document = Document::read(robot_path)?;
    let rewritten = robot::with_radii_scaled(&document, found.factor)?;
    let written = output.write_all(rewritten.as_bytes());
    written.map_err(|error| Error::file("write", target, &error))?;
    output.finish()?;

    let powered = request.robot.robot.wheels().iter();
    let radii: Vec<(String, f64)> = powered
        .filter(|wheel| wheel.role == WheelRole::Powered)
        .map(|wheel| (wheel.name.clone(), wheel.radius * found.factor))
        .collect();
    let each: Vec<String> = found
        .factors
        .iter()
        .map(|factor| format!("{factor:.4}"))
        .collect();
    let mut text = format!("effective radius: {:.4} of the robot file's", found.factor);
    if let Some(half) = found.half_spread() {
        let _ = write!(text, " ± {half:.4} (runs: {})", each.join(", "));
    }
    let _ = writeln!(text, "\nwrote {}", shown(target));
    let object = fields().object((&found, &radii, target));
    Ok(Report::done(object, text))
}

type Calibrated<'a> = (&'a Calibration, &'a Vec<(String, f64)>, &'a Path);

/// The JSON object of a calibration.
pub(super) fn fields<'a>() -> Fields<'a, Calibrated<'a>> {
    fields! { |found: Calibrated<'a>|
        "radius_factor" "effective radius over that of the robot file" = found.0.factor;
        "radius_factors" "the same of each run" = found.0.factors.clone();
        "half_spread" "half of their spread" = found.0.half_spread();
        "radii_m" "effective radius of each powered wheel" values = Some(found.1.iter().cloned());
        "output" "the file that was written" = found.2.display().to_string();
    }
}
