//! The points of a chunk that run on lanes: sorted by soil and by the unknown, eight at a time.

use std::collections::BTreeMap;

use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, SolveStatus};
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

    /// The points that the kernel solves, by their places.
    fn solve(&self, kernel: &BatchKernel, load: bool) -> Vec<(usize, Solved)> {
        let parts = self.places.par_chunks(PART).enumerate();
        let solved = parts.flat_map_iter(|(k, places)| {
            let n = places.len();
            let range = k * PART..k * PART + n;
            let points = BatchPoints {
                radius: (&self.radius[range.clone()]).into(),
                width: (&self.width[range.clone()]).into(),
                rebound: (&self.rebound[range.clone()]).into(),
                slip: (&self.slip[range.clone()]).into(),
            };
            let given = &self.given[range];
            let [
                mut sinkage,
                mut vertical_force,
                mut drawbar_pull,
                mut torque,
            ] = [[f64::NAN; PART]; 4];
            let mut status = [SolveStatus::default(); PART];
            let mut out = BatchColumns {
                sinkage: &mut sinkage[..n],
                vertical_force: &mut vertical_force[..n],
                drawbar_pull: &mut drawbar_pull[..n],
                torque: &mut torque[..n],
                status: &mut status[..n],
            };
            // The columns are equally long, so that the kernel refuses none.
            let _ = if load {
                kernel.under_load(&points, given, &mut out)
            } else {
                kernel.forces(&points, given, &mut out)
            };
            let rows = (0..n).filter(move |&i| status[i] == SolveStatus::Solved);
            rows.map(move |i| {
                let solved = Solved {
                    sinkage: sinkage[i],
                    forces: [vertical_force[i], drawbar_pull[i], torque[i]],
                };
                (places[i], solved)
            })
        });
        solved.collect()
    }
}

/// A solved row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    /// Sinkage, m.
    pub(super) sinkage: f64,
    /// Vertical force (N), drawbar pull (N) and torque (N m).
    pub(super) forces: [f64; 3],
}

/// The answer of each row, where the lanes have one; the rest is left to the general solver and its words.
pub(super) fn solve(
    rows: &[Row],
    kernel_of: impl Fn(&str) -> Option<BatchKernel>,
) -> Vec<Option<Solved>> {
    let mut sorted: BTreeMap<(&str, bool), Columns> = BTreeMap::new();
    let mut kernels: BTreeMap<&str, Option<BatchKernel>> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        let Ok(point) = &row.point else { continue };
        if point.slip_angle_deg != 0.0 || point.grousers.is_some() {
            continue;
        }
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
        for (place, solved) in columns.solve(kernel, *load) {
            answers[place] = Some(solved);
        }
    }
    answers
}
