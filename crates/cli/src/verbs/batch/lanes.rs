//! The points of a chunk that run on lanes: sorted by soil and by the unknown, eight at a time.

use std::collections::BTreeMap;

use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, SolveStatus};

use super::columns::{Numbers, Point, Row};
use crate::operation::Prescribed;

/// The points of one soil that are solved alike, side by side.
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
    fn push(&mut self, place: usize, point: &Point<'_>, rebound: f64, given: f64) {
        self.places.push(place);
        self.radius.push(point.radius_m);
        self.width.push(point.width_m);
        self.rebound.push(rebound);
        self.slip.push(point.slip);
        self.given.push(given);
    }

    /// Puts the points that the kernel solves at their places.
    fn solve(&self, kernel: &BatchKernel, load: bool, answers: &mut [Option<Numbers>]) {
        let n = self.places.len();
        let points = BatchPoints {
            radius: (&self.radius).into(),
            width: (&self.width).into(),
            rebound: (&self.rebound).into(),
            slip: (&self.slip).into(),
        };
        let column = || vec![f64::NAN; n];
        let [
            mut sinkage,
            mut vertical_force,
            mut drawbar_pull,
            mut torque,
        ] = [column(), column(), column(), column()];
        let mut status = vec![SolveStatus::default(); n];
        let mut out = BatchColumns {
            sinkage: &mut sinkage,
            vertical_force: &mut vertical_force,
            drawbar_pull: &mut drawbar_pull,
            torque: &mut torque,
            status: &mut status,
        };
        // The columns are equally long, so that the kernel refuses none.
        let _ = if load {
            kernel.under_load(&points, &self.given, &mut out)
        } else {
            kernel.forces(&points, &self.given, &mut out)
        };
        for (i, &place) in self.places.iter().enumerate() {
            if status[i] == SolveStatus::Solved {
                answers[place] = Some(Numbers {
                    sinkage: sinkage[i],
                    forces: [vertical_force[i], drawbar_pull[i], torque[i]],
                    // lanes have no slip angle and no lugs
                    side: 0.0,
                    fluctuation: None,
                });
            }
        }
    }
}

/// The answer of each row, where the lanes have one; the rest is left to the general solver and its words.
pub(super) fn solve(
    rows: &[Row<'_>],
    kernel_of: impl Fn(&str) -> Option<BatchKernel>,
) -> Vec<Option<Numbers>> {
    let mut sorted: BTreeMap<(&str, bool), Columns> = BTreeMap::new();
    let mut kernels: BTreeMap<&str, Option<BatchKernel>> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        let Ok(point) = &row.point else { continue };
        if point.slip_angle_deg != 0.0 || point.grousers.is_some() {
            continue;
        }
        let kernel = kernels
            .entry(&*point.soil)
            .or_insert_with(|| kernel_of(&point.soil));
        let Some(kernel) = kernel else { continue };
        let rebound = point.rebound.unwrap_or(kernel.soil().params().rebound);
        let (load, given) = match point.prescribed {
            Prescribed::Load(load) => (true, load),
            Prescribed::Sinkage(sinkage) => (false, sinkage),
        };
        sorted
            .entry((&*point.soil, load))
            .or_default()
            .push(place, point, rebound, given);
    }
    let mut answers = vec![None; rows.len()];
    for ((soil, load), columns) in &sorted {
        let Some(Some(kernel)) = kernels.get(soil) else {
            continue;
        };
        columns.solve(kernel, *load, &mut answers);
    }
    answers
}
