//! One finished drive, and several.

use grouser_page::run::DriveRecorder;
use grouser_rover::drive::{DriveResult, Outcome, Pilot, SlipScore};
use grouser_terrain::mission::PlannedDrive;

/// One finished drive.
pub(super) struct Run {
    pub(super) pilot: Pilot,
    pub(super) seed: u64,
    pub(super) result: DriveResult,
    /// The slips of the same drive where the ground obeys the estimator's own laws; `None` where it does anyway.
    pub(super) own_laws: Option<SlipScore>,
    /// How it planned and what it learnt, for a scenario that plans its way.
    pub(super) planned: Option<PlannedDrive>,
    /// What was seen on the way, of the first seed.
    pub(super) seen: Option<DriveRecorder>,
}

/// How many of the runs of a driver ended so.
pub(super) fn count(runs: &[Run], pilot: Pilot, outcome: Outcome) -> usize {
    runs.iter()
        .filter(|run| run.pilot == pilot && run.result.outcome == outcome)
        .count()
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
