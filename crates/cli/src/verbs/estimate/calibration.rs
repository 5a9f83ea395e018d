//! `estimate --calibrate-radius`: the effective radius from runs without slip.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::path::{Path, PathBuf};

use grouser_files::{Document, robot};
use grouser_replay::calibrate_radius;
use grouser_slip::WheelRole;
use serde_json::{Value, json};

use super::{Asked, file_error, note_input, replay_error};
use crate::error::{Error, Result, shown};
use crate::output::OutputFile;
use crate::report::{Object, Report};
use crate::session::Session;

/// Each log is a run of its own here.
pub(super) fn run(
    paths: &[PathBuf],
    robot_path: &Path,
    asked: &Asked,
    target: &Path,
    session: &mut Session,
) -> Result<Report> {
    let mut output = OutputFile::create(target)?;
    let mut logs = Vec::new();
    for path in paths {
        let log = asked.log(std::slice::from_ref(path))?;
        for file in log.files() {
            note_input(session, file)?;
        }
        logs.push(log);
    }
    let found = calibrate_radius(&logs, &asked.robot, &asked.options).map_err(replay_error)?;
    let document = Document::read(robot_path).map_err(|error| file_error(&error))?;
    let rewritten =
        robot::with_radii_scaled(&document, found.factor).map_err(|error| file_error(&error))?;
    let written = output.write_all(rewritten.as_bytes());
    written.map_err(|error| Error::file("write", target, &error))?;
    output.finish()?;

    let powered = asked.robot.robot.wheels().iter();
    let radii: Object = powered
        .filter(|wheel| wheel.role == WheelRole::Powered)
        .map(|wheel| (wheel.name.clone(), Value::from(wheel.radius * found.factor)))
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
    let object = json!({
        "radius_factor": found.factor,
        "radius_factors": found.factors,
        "half_spread": found.half_spread(),
        "radii_m": radii,
        "output": target.display().to_string(),
    });
    let Value::Object(object) = object else {
        return Err(Error::usage_without_hint("the result is no object"));
    };
    Ok(Report::done(object, text))
}
