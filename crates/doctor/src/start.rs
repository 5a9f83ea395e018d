//! A log through the check of units, signs and axes.

use grouser_files::robot::RobotFile;
use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::start::{Progress, StartCheck};
use grouser_slip::{Fault, Sample};

use crate::findings::Findings;
use crate::mistake::Mistake;

/// What [`check_start`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum StartOutcome {
    /// Every sensor agrees with the others.
    Plausible,
    /// The log does not show every sensor at work: the robot has to rest, drive, turn and speed up.
    Incomplete,
    /// A sensor disagrees with others over the whole log.
    Contradicted(Mistake),
    /// A sensor disagrees: another unit, another sign, another axis.
    Implausible {
        /// What disagrees, how much, and what that looks like.
        fault: Fault,
        /// When that was certain, s from the log's start.
        time_s: f64,
    },
}

impl StartOutcome {
    /// With what a run through the estimator found of how the sensors are described.
    #[must_use]
    pub fn beside(self, findings: &Findings) -> Self {
        let found = match self {
            Self::Implausible { fault, .. } if is_refuted(&fault, findings) => Self::Plausible,
            Self::Implausible { .. } => return self,
            other => other,
        };
        let first = findings.mistakes.first().copied();
        (first.or(findings.small_unit())).map_or(found, Self::Contradicted)
    }
}

/// Does the whole log refute what a part of it looked like? Slopes under an accelerometer, and a wheel that spins, look like
/// another unit or sign for a while.
fn is_refuted(fault: &Fault, findings: &Findings) -> bool {
    let Fault::Implausible {
        field, looks_like, ..
    } = fault
    else {
        return false;
    };
    // what shows at rest needs no speed to compare with
    let is_at_rest = looks_like.ends_with("at rest") || looks_like.ends_with("stationary");
    let is_refuted = match *field {
        "yaw rate" => {
            let wheel = findings.turns.as_ref().and_then(|turns| turns.wheel);
            findings.gyro_agrees || wheel.is_some()
        }
        "acceleration forward" | "acceleration left" => {
            findings.axes.acceleration.is_none() && findings.has_other_acceleration == Some(false)
        }
        _ => false,
    };
    is_refuted && !is_at_rest
}

/// Compares the sensors of a log while a filter runs: units, signs and axes. `samples` are those that an estimate uses.
///
/// # Errors
/// The first of the samples, and a robot that the filter refuses.
pub fn check_start<E: From<grouser_slip::Error>>(
    file: &RobotFile,
    samples: impl IntoIterator<Item = Result<Sample, E>>,
) -> Result<StartOutcome, E> {
    let settings = FilterSettings {
        // a log is in order of time: there is nothing to wait for
        horizon: 0.0,
        ..file.filter
    };
    let mut filter = SlipFilter::new(&file.robot, settings)?;
    let mut check = StartCheck::new(&file.robot)?;
    let mut progress = Progress::Looking;
    let mut start_ns = None;
    for sample in samples {
        let sample = sample?;
        let start_ns = *start_ns.get_or_insert(sample.time_ns);
        // What the filter refuses shows itself in what it knows.
        let _refused = filter.update(sample);
        match check.take(&sample, &filter.latest()) {
            Ok(reached) => progress = reached,
            Err(fault) => {
                let time_s = sample.time_ns.saturating_sub(start_ns) as f64 * 1e-9;
                return Ok(StartOutcome::Implausible { fault, time_s });
            }
        }
    }
    Ok(match progress {
        Progress::Plausible => StartOutcome::Plausible,
        Progress::Looking => StartOutcome::Incomplete,
    })
}
