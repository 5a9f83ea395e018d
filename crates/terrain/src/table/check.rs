//! How far a table is from the exact solver between its nodes, and near which limits the exact solver decides.

use super::build::{self, MIN_LIMIT_ERROR_RAD, Near};
use super::cubic::{Stencil, at};
use super::{
    Beyond, CHECK_FACTOR, LIMIT_CHECK_FACTOR, MIN_SLIP_ERROR, SLIP_BOUND, Side, SlipTable, Spot,
    TableError,
};
use grouser_terra::slope::HeldSlip;

use crate::demand::Driving;
use crate::error::Result;

/// The exact solver's slip between the nodes is found to this accuracy.
const CHECK_TOLERANCE: f64 = 1e-7;

/// The exact demand of a pose at which a table reads a slip: by its own equation between slips about that
/// one, or by a search over all slips where it does not lie there.
fn exact_near(near: &Near<'_>, (pitch, roll): (f64, f64), slip: f64) -> Result<Option<Driving>> {
    const HALF_BRACKET: f64 = 0.5 * SLIP_BOUND;
    let posed = near.posed(pitch, roll)?;
    let at =
        |slip: f64| -> Result<(f64, f64)> { Ok((slip, posed.surplus(slip)?.unwrap_or(f64::NAN))) };
    let (low, high) = (at(slip - HALF_BRACKET)?, at(slip + HALF_BRACKET)?);
    // more slip, more pull: the side of a peak on which the smallest slip lies
    if low.1 < 0.0 && high.1 >= 0.0 {
        let exact = posed.between(low, high, CHECK_TOLERANCE)?;
        return posed.driving(exact).map(Some);
    }
    Ok(match posed.held()? {
        HeldSlip::Holds(slip) => Some(posed.driving(slip)?),
        _ => None,
    })
}

/// Compares the table with what it interpolates in the middle between its nodes: every cell in roll; in t the first and the
/// last cells and every fourth. Two rolls are compared with the exact laws, a quarter of the envelope from either end, all
/// others with the nodes that the table was built on: what those lack varies less with the roll than what the grid lacks.
pub(super) fn check(
    table: &mut SlipTable,
    on_nodes: &Near<'_>,
    roll_of: &impl Fn(f64) -> f64,
) -> Result<()> {
    let solver = on_nodes.solver;
    let exact_laws = Near::exact(solver);
    let mut error = TableError::default();
    let mut limit_errors = [0.0_f64; 2];
    let quarter = (table.rolls - 1) / 4;
    for index in 0..table.rolls - 1 {
        let near = if index % (2 * quarter) == quarter {
            &exact_laws
        } else {
            on_nodes
        };
        let roll = roll_of(index as f64 + 0.5);
        let across = table.across(roll);
        let rolling = across.along(&table.rolling);
        for (which, sense) in [1.0, -1.0].into_iter().enumerate() {
            let side = if which == 0 {
                &table.climbing
            } else {
                &table.braking
            };
            let mut limit = across.along(&side.limit);
            if side.beyond == Beyond::Soil {
                let exact = build::limit(near, table.envelope, (roll, rolling), sense, None)?;
                limit_errors[which] = limit_errors[which].max((exact.pitch - limit).abs());
                error.checks += 1;
                // what lies beyond the true limit is marginal, and has no slip to compare with
                limit = if sense > 0.0 {
                    limit.min(exact.pitch)
                } else {
                    limit.max(exact.pitch)
                };
            }
            let cells = table.steps - 1;
            for cell in (0..cells).filter(|cell| *cell < 2 || cell % 4 == 0 || *cell == cells - 1) {
                let t = (cell as f64 + 0.5) / cells as f64;
                let pitch = limit - (limit - rolling) * t * t;
                let along = Stencil::new(t, table.steps);
                let spot = Spot {
                    slip: at(&side.slip, table.steps, &across, &along),
                    is_climbing: which == 0,
                    across,
                    along,
                };
                let read = table.driving(&spot);
                let Some(exact) = exact_near(near, (pitch, roll), read.slip)? else {
                    continue;
                };
                error.checks += 1;
                error.slip = error.slip.max((read.slip - exact.slip).abs());
                let scale = exact
                    .work_per_metre
                    .abs()
                    .max(0.01 * solver.model().weight());
                let off = (read.work_per_metre - exact.work_per_metre).abs() / scale;
                error.energy = error.energy.max(off);
                error.sinkage = error.sinkage.max((read.sinkage - exact.sinkage).abs());
            }
        }
    }
    error.slip = (CHECK_FACTOR * error.slip).max(MIN_SLIP_ERROR);
    error.energy *= CHECK_FACTOR;
    error.sinkage *= CHECK_FACTOR;
    error.limit = LIMIT_CHECK_FACTOR * limit_errors[0].max(limit_errors[1]);
    for (which, limit_error) in limit_errors.into_iter().enumerate() {
        let steps = table.steps;
        let rolling = table.rolling.clone();
        let side = if which == 0 {
            &mut table.climbing
        } else {
            &mut table.braking
        };
        side.limit_error = (LIMIT_CHECK_FACTOR * limit_error).max(MIN_LIMIT_ERROR_RAD);
        side.marginal = marginal(side, &rolling, steps);
    }
    table.error = error;
    Ok(())
}

/// An error δ of the limit moves t by δ/(2 t Δ), Δ the range of the side in pitch; below the t at which this passes into
/// the slip as half of the bound, the exact solver decides.
fn marginal(side: &Side, rolling: &[f64], steps: usize) -> f64 {
    if side.beyond != Beyond::Soil {
        return 0.0;
    }
    let mut t = 0.0_f64;
    for (index, row) in side.slip.chunks_exact(steps).enumerate() {
        let slope = (row[0] - row[1]).abs() * (steps - 1) as f64;
        let range = (side.limit[index] - rolling[index]).abs();
        t = t.max(slope * side.limit_error / (SLIP_BOUND * range));
    }
    t
}
