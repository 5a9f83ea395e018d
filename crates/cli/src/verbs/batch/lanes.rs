//! The points of some rows that run on lanes: sorted by soil and by the unknown, eight at a time.

use std::ops::Range;

use grouser_terra::{
    BatchColumns, BatchInput, BatchPoints, Caution, Cautions, MAX_MISS, Prescribed, Soil,
    SoilColumns, SolveStatus,
};

use super::columns::{Numbers, Point, Row, SOIL_NUMBERS};
use super::soils::{Known, Soils};

/// The points in columns: those of one soil that are solved alike are side by side.
struct Points {
    radius: Vec<f64>,
    width: Vec<f64>,
    rebound: Vec<f64>,
    slip: Vec<f64>,
    /// Sinkage or load.
    given: Vec<f64>,
    /// Of [`SOIL_NUMBERS`] those that the table has.
    soil: [Option<Vec<f64>>; SOIL_NUMBERS.len()],
}

impl Points {
    /// The numbers of the soils of some points on one soil; `None` where the table has no column of them.
    fn soils(&self, soil: &Soil, range: &Range<usize>) -> Option<SoilColumns<'_>> {
        let mut soils = SoilColumns::from_soil(soil);
        let mut is_own = false;
        for (number, values) in SOIL_NUMBERS.into_iter().zip(&self.soil) {
            if let (Some(column), Some(values)) = (number.column(&mut soils), values) {
                *column = BatchInput::Column(&values[range.clone()]);
                is_own = true;
            }
        }
        is_own.then_some(soils)
    }
}

/// What the kernel found of the points, in columns.
pub(super) struct Found {
    /// Where each row stands in the columns; `None` where lanes do not serve.
    places: Vec<Option<usize>>,
    status: Vec<SolveStatus>,
    sinkage: Vec<f64>,
    vertical_force: Vec<f64>,
    drawbar_pull: Vec<f64>,
    torque: Vec<f64>,
    cautions: Vec<Cautions>,
}

impl Found {
    /// What was found of a row: the default status where lanes do not serve, and no numbers unless solved.
    pub(super) fn of_row(&self, row: usize) -> (SolveStatus, Option<Numbers>) {
        let Some(place) = self.places[row] else {
            return (SolveStatus::default(), None);
        };
        let status = self.status[place];
        let numbers = (status == SolveStatus::Solved).then(|| Numbers {
            sinkage: self.sinkage[place],
            forces: [
                self.vertical_force[place],
                self.drawbar_pull[place],
                self.torque[place],
            ],
            // lanes have no slip angle and no lugs
            side: 0.0,
            fluctuation: None,
            cautions: self.cautions[place],
        });
        (status, numbers)
    }

    /// Solves points of one soil, by their loads or by their sinkages.
    fn solve(&mut self, points: &Points, range: Range<usize>, (known, by_load): (&Known, bool)) {
        let kernel = &known.kernel;
        let soils = points.soils(&known.soil, &range);
        let given = &points.given[range.clone()];
        let points = BatchPoints {
            radius: (&points.radius[range.clone()]).into(),
            width: (&points.width[range.clone()]).into(),
            rebound: (&points.rebound[range.clone()]).into(),
            slip: (&points.slip[range.clone()]).into(),
        };
        let mut out = BatchColumns {
            sinkage: &mut self.sinkage[range.clone()],
            vertical_force: &mut self.vertical_force[range.clone()],
            drawbar_pull: &mut self.drawbar_pull[range.clone()],
            torque: &mut self.torque[range.clone()],
            status: &mut self.status[range.clone()],
        };
        // The columns are equally long, so that the kernel refuses none.
        let _ = match (&soils, by_load) {
            (None, true) => kernel.under_load(&points, given, &mut out),
            (None, false) => kernel.forces(&points, given, &mut out),
            (Some(soils), true) => kernel.under_load_on(soils, &points, given, &mut out),
            (Some(soils), false) => kernel.forces_on(soils, &points, given, &mut out),
        };
        for (at, cautions) in self.cautions[range].iter_mut().enumerate() {
            *cautions = match &soils {
                None => kernel.cautions(&points, &out, at),
                Some(soils) => kernel.cautions_on(soils, &points, &out, at),
            };
            let missed = (out.vertical_force[at] - given[at]).abs();
            let is_coarse = by_load && missed > MAX_MISS * given[at]; // NaN where there is no solution
            cautions.insert_if(is_coarse, Caution::LoadBelowResolution);
        }
    }
}

/// Is a point for the kernel? One with a drift or lugs is not.
fn is_served(point: &Point<'_>) -> bool {
    point.slip_angle_deg == 0.0 && point.grousers.is_none()
}

/// May several sinkages carry a point's load? Only the general search knows.
pub(super) fn may_be_several(point: &Point<'_>, soil: &Soil) -> bool {
    let soil = soil.params();
    let rises = point.rebound.unwrap_or(soil.rebound) > 0.0 || soil.transport_layer > 0.0;
    matches!(point.prescribed, Prescribed::Load(_)) && (rises || point.slip < 0.0)
}

/// What the kernel finds of each row.
pub(super) fn solve(
    rows: &[Row<'_>],
    soils: &Soils<'_>,
    has_numbers: [bool; SOIL_NUMBERS.len()],
) -> Found {
    // twice the soil's number, and one more for a load
    let group = |row: usize| {
        let point = rows[row].point.as_ref().ok()?;
        let (number, _) = soils.of_row(row)?;
        let by_load = matches!(point.prescribed, Prescribed::Load(_));
        is_served(point).then_some(2 * number + usize::from(by_load))
    };
    let groups: Vec<Option<usize>> = (0..rows.len()).map(group).collect();
    // how many points a group has, then where its next point goes
    let mut next = vec![0; 2 * soils.len() + 1];
    for group in groups.iter().flatten() {
        next[group + 1] += 1;
    }
    for group in 1..next.len() {
        next[group] += next[group - 1];
    }
    let column = || vec![0.0; next[2 * soils.len()]];
    let mut points = Points {
        radius: column(),
        width: column(),
        rebound: column(),
        slip: column(),
        given: column(),
        soil: has_numbers.map(|has| has.then(column)),
    };
    let mut found = Found {
        places: vec![None; rows.len()],
        status: vec![SolveStatus::default(); points.given.len()],
        sinkage: column(),
        vertical_force: column(),
        drawbar_pull: column(),
        torque: column(),
        cautions: vec![Cautions::default(); points.given.len()],
    };
    let starts = next.clone();
    for (row, group) in groups.iter().enumerate() {
        let (Some(group), Ok(point)) = (*group, &rows[row].point) else {
            continue;
        };
        let known = soils.at(group / 2);
        let rebound = point
            .rebound
            .or(known.map(|known| known.soil.params().rebound));
        let place = next[group];
        next[group] += 1;
        found.places[row] = Some(place);
        points.radius[place] = point.radius_m;
        points.width[place] = point.width_m;
        points.rebound[place] = rebound.unwrap_or_default();
        points.slip[place] = point.slip;
        let of_soils = known.map_or([f64::NAN; SOIL_NUMBERS.len()], |known| known.numbers);
        let numbers = point.soil_numbers.into_iter().zip(of_soils);
        for (values, (own, of_soil)) in points.soil.iter_mut().zip(numbers) {
            if let Some(values) = values {
                values[place] = own.unwrap_or(of_soil);
            }
        }
        points.given[place] = match point.prescribed {
            Prescribed::Load(given) | Prescribed::Sinkage(given) => given,
        };
    }
    for group in 0..2 * soils.len() {
        if let Some(known) = soils.at(group / 2) {
            let range = starts[group]..starts[group + 1];
            found.solve(&points, range, (known, group % 2 == 1));
        }
    }
    found
}
