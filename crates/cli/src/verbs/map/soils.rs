//! The soil, the soils drawn from its intervals, and their tables.

use grouser_files::Document;
use grouser_rover::robot::RobotModel;
use grouser_terra::Soil;
use grouser_terrain::{DemandSolver, Envelope, SlipTable, SoilIntervals};
use rayon::prelude::*;

use super::Arguments;
use crate::error::Result;
use crate::progress::Progress;
use crate::session::Session;

/// The soils drawn from the intervals; none where there are no intervals.
pub(super) fn draws(
    arguments: &Arguments,
    soil: &Soil,
    session: &mut Session,
) -> Result<Vec<Soil>> {
    let Some(path) = &arguments.soil_intervals else {
        return Ok(Vec::new());
    };
    let document = Document::read(path)?;
    let intervals = SoilIntervals::parse(&document)?;
    session.used_document(&document);
    session.used_seed(arguments.seed);
    Ok(intervals.draw(soil, arguments.soil_draws.into(), arguments.seed)?)
}

type SoilTable = (DemandSolver, SlipTable);

/// The tables of all soils, on all processors; the result does not depend on their number.
pub(super) fn tables(
    model: &RobotModel,
    soil: &Soil,
    drawn: &[Soil],
    envelope: Envelope,
) -> Result<(SoilTable, Vec<SoilTable>)> {
    let progress = Progress::of_items(drawn.len() as u64 + 1, "soils");
    let table = |(index, soil): (usize, &Soil)| -> grouser_terrain::Result<SoilTable> {
        let solver = DemandSolver::new(model.clone(), *soil)?;
        let table = SlipTable::new(&solver, envelope, index == 0).map_err(|error| {
            use grouser_terrain::Error;
            match error {
                Error::DoesNotMove { name, .. } => Error::DoesNotMove { name, draw: index },
                other => other,
            }
        })?;
        progress.advance(1);
        Ok((solver, table))
    };
    let soils: Vec<&Soil> = std::iter::once(soil).chain(drawn).collect();
    let mut tables = soils
        .into_par_iter()
        .enumerate()
        .map(table)
        .collect::<grouser_terrain::Result<Vec<_>>>()?;
    let draws = tables.split_off(1);
    let own = tables.remove(0);
    Ok((own, draws))
}
