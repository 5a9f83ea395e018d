//! The points of a chunk that run on lanes: sorted by soil and by the unknown, eight at a time.

use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, SolveStatus};

use super::columns::{Numbers, Point, Row};
use super::soils::Soils;
use crate::operation::Prescribed;

/// What the kernel found of a row; the default where it does not serve.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    pub(super) status: SolveStatus,
    /// `None` unless solved.
    pub(super) numbers: Option<Numbers>,
}

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

    /// Puts what the kernel finds at the places of the points.
    fn solve(&self, kernel: &BatchKernel, load: bool, answers: &mut [Found]) {
        let n = self.places.len();
        if n == 0 {
            return;
        }
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
            let numbers = Numbers {
                sinkage: sinkage[i],
                forces: [vertical_force[i], drawbar_pull[i], torque[i]],
                // lanes have no slip angle and no lugs
                side: 0.0,
                fluctuation: None,
            };
            let status = status[i];
            let numbers = (status == SolveStatus::Solved).then_some(numbers);
            answers[place] = Found { status, numbers };
        }
    }
}

/// What the kernel finds of each row.
pub(super) fn solve(rows: &[Row<'_>], soils: &Soils<'_>) -> Vec<Found> {
    let mut by_soil: Vec<[Columns; 2]> = Vec::new();
    by_soil.resize_with(soils.len(), Default::default);
    for (place, row) in rows.iter().enumerate() {
        let Ok(point) = &row.point else { continue };
        if point.slip_angle_deg != 0.0 || point.grousers.is_some() {
            continue;
        }
        let Some((number, known)) = soils.of_row(place) else {
            continue;
        };
        let rebound = point.rebound.unwrap_or(known.soil.params().rebound);
        let (load, given) = match point.prescribed {
            Prescribed::Load(load) => (true, load),
            Prescribed::Sinkage(sinkage) => (false, sinkage),
        };
        by_soil[number][usize::from(load)].push(place, point, rebound, given);
    }
    let mut answers = vec![Found::default(); rows.len()];
    for (number, [by_sinkage, by_load]) in by_soil.iter().enumerate() {
        if let Some(known) = soils.at(number) {
            by_sinkage.solve(&known.kernel, false, &mut answers);
            by_load.solve(&known.kernel, true, &mut answers);
        }
    }
    answers
}
