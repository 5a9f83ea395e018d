//! The points of a chunk that run on lanes: sorted by soil and by what is asked, eight at a time.

use std::collections::BTreeMap;

use grouser_terra::{BatchForces, BatchKernel, BatchOutcome, BatchPoints};
use rayon::prelude::*;

use super::columns::{Point, Row};
use crate::operation::Asked;

/// Points handed to a thread at a time.
const PART: usize = 512;

/// The points of one soil that ask the same: side by side.
#[derive(Default)]
struct Columns {
    places: Vec<usize>,
    radius: Vec<f64>,
    width: Vec<f64>,
    rebound: Vec<f64>,
    slip: Vec<f64>,
    given: Vec<f64>,
}

impl Columns {
    fn push(&mut self, place: usize, point: &Point, rebound: f64, given: f64) {
        self.places.push(place);
        self.radius.push(point.radius_m);
        self.width.push(point.width_m);
        self.rebound.push(rebound);
        self.slip.push(point.slip);
        self.given.push(given);
    }

    fn solve(&self, kernel: &BatchKernel, load: bool) -> Vec<BatchOutcome> {
        let mut out = vec![BatchOutcome::default(); self.places.len()];
        out.par_chunks_mut(PART).enumerate().for_each(|(k, out)| {
            let range = k * PART..k * PART + out.len();
            let points = BatchPoints {
                radius: &self.radius[range.clone()],
                width: &self.width[range.clone()],
                rebound: &self.rebound[range.clone()],
                slip: &self.slip[range.clone()],
            };
            let given = &self.given[range];
            // The slices are cut alike, so that neither can refuse them; a point without an outcome is
            // solved by itself afterwards.
            let _ = if load {
                kernel.under_load(&points, given, out)
            } else {
                kernel.forces(&points, given, out)
            };
        });
        out
    }
}

/// The answer of each row, where the lanes have one; the rest is left to the general solver and its words.
pub(super) fn solve(
    rows: &[Row],
    kernel_of: impl Fn(&str) -> Option<BatchKernel>,
) -> Vec<Option<BatchForces>> {
    let mut sorted: BTreeMap<(&str, bool), Columns> = BTreeMap::new();
    let mut kernels: BTreeMap<&str, Option<BatchKernel>> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        let Ok(point) = &row.point else { continue };
        let kernel = kernels
            .entry(&point.soil)
            .or_insert_with(|| kernel_of(&point.soil));
        let Some(kernel) = kernel else { continue };
        let rebound = point.rebound.unwrap_or(kernel.soil().params().rebound);
        let (load, given) = match point.asked {
            Asked::Load(load) => (true, load),
            Asked::Sinkage(sinkage) => (false, sinkage),
        };
        sorted
            .entry((&point.soil, load))
            .or_default()
            .push(place, point, rebound, given);
    }
    let mut answers = vec![None; rows.len()];
    for ((soil, load), columns) in &sorted {
        let Some(Some(kernel)) = kernels.get(soil) else {
            continue;
        };
        for (place, outcome) in columns.places.iter().zip(columns.solve(kernel, *load)) {
            if let BatchOutcome::Done(forces) = outcome {
                answers[*place] = Some(forces);
            }
        }
    }
    answers
}
