//! The soil that the robot's computer has learnt, as text.

use std::fmt::Write as _;

use super::run::Run;
use crate::soil_text::words;

/// A line for each run that learnt.
pub(super) fn text(runs: &[Run], out: &mut String) {
    for run in runs {
        if let Some(soil) = &run.result.soil {
            // writing to a string cannot fail
            let _ = writeln!(out, "\nseed {}: {}", run.seed, words(soil));
        }
    }
}
