//! Do the intervals of the slips hold what they promise? A factor on all sigmas from reference runs, by split conformal
//! prediction, checked on runs that it was not taken from. An error that the reference shares with the estimate, such as one of
//! the radii or of the reference's scale, is not visible in it.

use std::io;

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_slip::Health;

use crate::error::{Error, Result};
use crate::options::Options;
use crate::quantiles::SIGMAS_90;
use crate::run::run_into;
use crate::sink::{Row, Sink};

/// The share of true slips that an interval contains.
const COVERED_SHARE: f64 = 0.9;
/// Fewer runs do not show how much runs differ.
const MIN_RUNS: usize = 3;
/// Fewer runs do not narrow intervals: that four runs or fewer agree does not show that the next one does.
const MIN_RUNS_TO_NARROW: usize = 5;
/// A wheel-run with fewer compared estimates does not count.
const MIN_ROWS: usize = 20;

/// What a calibration of intervals found. The slip by the whole log is no true slip: radii, axes and the reference's scale are
/// those of the estimate too.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalCalibration {
    /// Factor on the standard deviations of all slips; below 1 of five runs or more.
    pub factor: f64,
    /// Share of each run's 90 % intervals that contain the slip by the whole log, with the factor from the other runs.
    pub coverages: Vec<f64>,
    /// The mean of these, and that without a factor.
    pub coverage: f64,
    /// The share without a factor.
    pub coverage_before: f64,
    /// Median half-width of the 90 % intervals with the factor.
    pub half_width: f64,
}

/// The factor on the standard deviations of online slips with which 90 % of the intervals contain the slip by the whole log, in runs with
/// a reference. Each run counts alike. `file` must not contain a factor yet: it is divided out.
///
/// Errors of radii, axes or of the reference's scale are
/// in both and not visible. Fewer than five runs yield no factor below 1.
///
/// # Errors
/// As [`run`](crate::run()); [`Error::TooFewRuns`] for less than three runs with slips.
pub fn calibrate_intervals(
    logs: &[Log],
    file: &RobotFile,
    options: &Options,
) -> Result<IntervalCalibration> {
    let mut plain = file.clone();
    plain.corrections.interval_factor = 1.0;
    let mut runs = Vec::new();
    for log in logs {
        let errors = errors_of(log, &plain, options)?;
        if errors.len() >= MIN_ROWS {
            runs.push(errors);
        }
    }
    if runs.len() < MIN_RUNS {
        return Err(Error::TooFewRuns {
            runs: runs.len(),
            needed: MIN_RUNS,
        });
    }
    let all: Vec<usize> = (0..runs.len()).collect();
    let min_factor = if runs.len() < MIN_RUNS_TO_NARROW {
        1.0
    } else {
        0.0
    };
    let factor_of = |used: &[usize]| factor_of(&runs, used).max(min_factor);
    let factor = factor_of(&all);
    let coverages: Vec<f64> = all
        .iter()
        .map(|held_out| {
            let others: Vec<usize> = all.iter().copied().filter(|run| run != held_out).collect();
            coverage(&runs[*held_out], factor_of(&others))
        })
        .collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let before: Vec<f64> = runs.iter().map(|run| coverage(run, 1.0)).collect();
    let mut widths: Vec<f64> = runs.iter().flatten().map(|error| error.sigma).collect();
    widths.sort_unstable_by(f64::total_cmp);
    Ok(IntervalCalibration {
        factor,
        coverage: mean(&coverages),
        coverages,
        coverage_before: mean(&before),
        half_width: factor * SIGMAS_90 * widths[widths.len() / 2],
    })
}

/// An estimate's error and its standard deviation.
#[derive(Clone, Copy, Debug)]
struct SlipError {
    error: f64,
    sigma: f64,
}

/// The factor with which the share is reached, each run weighing alike.
fn factor_of(runs: &[Vec<SlipError>], used: &[usize]) -> f64 {
    let mut scores: Vec<(f64, f64)> = used
        .iter()
        .flat_map(|run| {
            let errors = &runs[*run];
            let weight = 1.0 / (errors.len() * used.len()) as f64;
            errors
                .iter()
                .map(move |error| (error.error.abs() / (SIGMAS_90 * error.sigma), weight))
        })
        .collect();
    scores.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    for (score, weight) in &scores {
        below += weight;
        if below >= COVERED_SHARE {
            return *score;
        }
    }
    scores.last().map_or(1.0, |(score, _)| *score)
}

fn coverage(run: &[SlipError], factor: f64) -> f64 {
    let is_inside = |error: &&SlipError| error.error.abs() <= factor * SIGMAS_90 * error.sigma;
    run.iter().filter(is_inside).count() as f64 / run.len() as f64
}

/// The slips of all wheels, row by row, each with its standard deviation, where they can be trusted.
#[derive(Default)]
struct Kept(Vec<Option<[f64; 2]>>);

impl Sink for Kept {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        let known = row
            .slip
            .zip(row.slip_sigma)
            .map(|(slip, sigma)| [slip, sigma]);
        self.0
            .push(known.filter(|_| matches!(row.health, Health::Ok)));
        Ok(())
    }
}

/// The errors of all wheels of a run, by the slips of the whole log.
fn errors_of(log: &Log, file: &RobotFile, options: &Options) -> Result<Vec<SlipError>> {
    let [mut online, mut whole] = [Kept::default(), Kept::default()];
    for (kept, offline) in [(&mut online, false), (&mut whole, true)] {
        run_into(
            log,
            file,
            &Options {
                offline,
                ..*options
            },
            kept,
        )?;
    }
    let both = online
        .0
        .iter()
        .zip(&whole.0)
        .filter_map(|(a, b)| (*a).zip(*b));
    let errors = both.map(|([slip, sigma], [by_all, _])| SlipError {
        error: slip - by_all,
        sigma,
    });
    Ok(errors.filter(|of| of.sigma > 0.0).collect())
}
