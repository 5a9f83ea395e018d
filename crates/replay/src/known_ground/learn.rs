//! Known grounds from runs with a reference, and the slips of a run by them.

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_real::Real;

use super::slip_range::{MIN_KNOWN, SlipRange, slip_of};
use super::stretch::{KnownGround, KnownGrounds, Stretch};
use super::stretches::{LogStretch, stretches};
use crate::effort::EffortUnit;
use crate::error::{Error, Result};
use crate::options::Options;

/// How well intervals hold in one run, by the other runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// The run.
    pub run: String,
    /// Seconds whose slip lies in the interval of their stretch.
    pub contained: usize,
    /// All seconds.
    pub seconds: usize,
}

/// The slip of one stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundSlip {
    /// The stretch.
    pub stretch: Stretch,
    /// Its slip.
    pub range: SlipRange,
    /// Its slip by the log's own reference, to compare; `None` without one.
    pub by_reference: Option<f64>,
}

/// The slips of a log by known grounds.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundSlips {
    /// The stretches of one command on one ground.
    pub stretches: Vec<GroundSlip>,
    /// When the motors showed another ground, s from the log's start.
    pub ground_changes_s: Vec<f64>,
    /// Length of the log, s.
    pub duration_s: f64,
}

/// The known grounds of runs with a reference, each with its name, and how well their intervals hold in each run by the
/// others.
///
/// # Errors
/// As [`run`](crate::run()); [`Error::NoReference`] of a log without an absolute reference; [`Error::TooFewGrounds`] of fewer
/// than three stretches; [`Error::MixedEfforts`] of runs with currents and runs with torques.
pub fn learn_grounds(
    logs: &[(String, Log)],
    file: &RobotFile,
    options: &Options,
) -> Result<(KnownGrounds, Vec<Coverage>)> {
    let mut unit = None;
    let mut measured: Vec<(KnownGround, Vec<f64>)> = Vec::new();
    for (run, log) in logs {
        let found = stretches(log, file, options)?;
        if !found.has_reference {
            return Err(Error::NoReference {
                reference: "any",
                needs: "a displacement, a pose, a speed over ground or a free wheel",
            });
        }
        if let Some(other) = found.unit {
            check_unit(*unit.get_or_insert(other), other)?;
        }
        measured.extend(
            found
                .stretches
                .into_iter()
                .filter_map(|stretch| known(run, stretch)),
        );
    }
    let grounds: Vec<KnownGround> = measured.iter().map(|(ground, _)| ground.clone()).collect();
    let (Some(unit), true) = (unit, grounds.len() >= MIN_KNOWN) else {
        return Err(Error::TooFewGrounds {
            known: grounds.len(),
        });
    };
    let (mut coverages, mut half_widths): (Vec<Coverage>, Vec<f64>) = (Vec::new(), Vec::new());
    for (ground, seconds) in &measured {
        let others = grounds.iter().filter(|other| other.run != ground.run);
        let Ok(range) = slip_of(&ground.stretch, &others.collect::<Vec<_>>()) else {
            continue;
        };
        let is_inside = |slip: &&f64| (range.low..=range.high).contains(*slip);
        half_widths.extend(seconds.iter().map(|_| 0.5 * (range.high - range.low)));
        if coverages.last().is_none_or(|of| of.run != ground.run) {
            coverages.push(Coverage {
                run: ground.run.clone(),
                contained: 0,
                seconds: 0,
            });
        }
        if let Some(of) = coverages.last_mut() {
            of.contained += seconds.iter().filter(is_inside).count();
            of.seconds += seconds.len();
        }
    }
    half_widths.sort_unstable_by(f64::total_cmp);
    let sum = |of: fn(&Coverage) -> usize| coverages.iter().map(of).sum::<usize>() as f64;
    let (contained, seconds) = (sum(|of| of.contained), sum(|of| of.seconds));
    Ok((
        KnownGrounds {
            robot: file.robot.name().to_owned(),
            unit,
            coverage: (seconds > 0.0).then(|| contained / seconds),
            half_width: half_widths.get(half_widths.len() / 2).copied(),
            grounds,
        },
        coverages,
    ))
}

/// The slip of each stretch of a log, with or without a reference of its own, by grounds that the robot has met before.
///
/// # Errors
/// As [`run`](crate::run()), a log without a reference apart; [`Error::OtherRobot`] and [`Error::MixedEfforts`] of grounds that
/// are not this robot's.
pub fn slips_by_known_grounds(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    known: &KnownGrounds,
) -> Result<GroundSlips> {
    if known.robot != file.robot.name() {
        return Err(Error::OtherRobot {
            learnt: known.robot.clone(),
            robot: file.robot.name().to_owned(),
        });
    }
    let found = stretches(log, file, options)?;
    if let Some(unit) = found.unit {
        check_unit(known.unit, unit)?;
    }
    let slips = found.stretches.into_iter().map(|of| {
        Ok(GroundSlip {
            range: known.slip(&of.stretch)?,
            stretch: of.stretch,
            by_reference: of.slip,
        })
    });
    Ok(GroundSlips {
        stretches: slips.collect::<Result<_>>()?,
        ground_changes_s: found.changes_s,
        duration_s: found.duration_s,
    })
}

fn check_unit(learnt: EffortUnit, logged: EffortUnit) -> Result<()> {
    if learnt == logged {
        Ok(())
    } else {
        Err(Error::MixedEfforts {
            learnt: learnt.symbol(),
            logged: logged.symbol(),
        })
    }
}

/// A stretch of a run with a reference as a known ground, with the slips of its seconds.
fn known(run: &str, found: LogStretch) -> Option<(KnownGround, Vec<f64>)> {
    let LogStretch {
        stretch,
        slip,
        seconds,
    } = found;
    let slip = slip.filter(|slip| *slip < 1.0 && *slip > -1.0)?;
    let count = seconds.len() as f64;
    if count < 2.0 {
        return None;
    }
    let mean = seconds.iter().sum::<f64>() / count;
    let square = seconds.iter().map(|s| Real::powi(s - mean, 2)).sum::<f64>();
    let ground = KnownGround {
        run: run.to_owned(),
        stretch,
        slip,
        scatter: (square / (count - 1.0)).sqrt(),
    };
    Some((ground, seconds))
}
