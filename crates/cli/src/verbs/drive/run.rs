//! One finished drive, and several.

use grouser_page::run::DriveRecorder;
use grouser_report::number::rounded;
use grouser_rover::drive::{DriveResult, Outcome, Pilot, SlipScore};
use grouser_terra::Caution;
use grouser_terrain::mission::PlannedDrive;

use crate::error::Error;

/// One finished drive.
pub(super) struct Run {
    pub(super) pilot: Pilot,
    /// Share of the requested speeds that it was driven at: 1, in open loop that with the controller's mean speed.
    pub(super) pace: f64,
    pub(super) seed: u64,
    pub(super) result: DriveResult,
    /// Why it could not begin.
    pub(super) refusal: Option<String>,
    /// The slips of the same drive where the ground obeys the estimator's own laws; `None` where it does anyway.
    pub(super) own_laws: Option<SlipScore>,
    /// How it planned and what it learnt, for a scenario that plans its route.
    pub(super) planned: Option<PlannedDrive>,
    /// What was recorded during the drive, of the first seed.
    pub(super) seen: Option<DriveRecorder>,
}

impl Run {
    /// The row of a seed on whose ground a drive cannot begin.
    pub(super) fn refused(pilot: Pilot, seed: u64, error: &Error) -> Self {
        Self {
            pilot,
            pace: 1.0,
            seed,
            result: DriveResult::refused(),
            refusal: Some(error.to_string()),
            own_laws: None,
            planned: None,
            seen: None,
        }
    }
}

/// How many of the runs of a driver ended so.
pub(super) fn count(runs: &[Run], pilot: Pilot, outcome: Outcome) -> usize {
    runs.iter()
        .filter(|run| run.pilot == pilot && run.result.outcome == outcome)
        .count()
}

/// A balance of energy that is off by more than this share is said.
const BAD_BALANCE: f64 = 0.02;

/// Wheels that are sunk too deep for the laws for more than this share of the time are a caution.
const DEEP_SHARE: f64 = 0.01;

/// The worst balance of energy, where it belies the numbers of its drive.
fn bad_balance(runs: &[Run]) -> Option<String> {
    let share = |run: &Run| run.result.energy_error.abs();
    let bad = runs.iter().filter(|run| share(run) > BAD_BALANCE);
    let worst = bad.clone().max_by(|a, b| share(a).total_cmp(&share(b)))?;
    let count = bad.count();
    let among = if runs.len() > 1 {
        format!(
            " ({count} of {} drives are off by more than 2 %)",
            runs.len()
        )
    } else {
        String::new()
    };
    Some(format!(
        "the energy balance of `{}`, seed {}, is off by {} %{among}: its distances and energies are no more accurate; use a shorter `step_s` in \
         the scenario",
        worst.pilot.name(),
        worst.seed,
        rounded(100.0 * share(worst), 2)
    ))
}

/// What the drives say that their numbers do not.
pub(super) fn warnings(runs: &[Run]) -> Vec<String> {
    let undeclared = runs.first().and_then(|run| run.result.undeclared);
    bad_balance(runs)
        .into_iter()
        .chain(deep(runs))
        .chain(undeclared.map(|found| found.to_string()))
        .collect()
}

/// Wheels that are sunk too deep for the laws in more than a passing hollow.
fn deep(runs: &[Run]) -> Option<String> {
    let share = |run: &Run| run.result.deep_share;
    let worst = runs
        .iter()
        .max_by(|a, b| share(a).total_cmp(&share(b)))
        .filter(|worst| share(worst) > DEEP_SHARE)?;
    Some(format!(
        "caution for {} % of the time of a wheel of `{}`, seed {}: {}",
        rounded(100.0 * share(worst), 2),
        worst.pilot.name(),
        worst.seed,
        Caution::DeepSinkage
    ))
}

/// The drivers in the order of the command line, each once.
pub(super) fn pilots(runs: &[Run]) -> Vec<Pilot> {
    let mut pilots: Vec<Pilot> = Vec::new();
    for run in runs {
        if !pilots.contains(&run.pilot) {
            pilots.push(run.pilot);
        }
    }
    pilots
}
