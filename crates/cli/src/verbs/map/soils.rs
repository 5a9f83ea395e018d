//! The soil, the soils drawn from its intervals, and their tables.

use grouser_files::Document;
use grouser_rover::robot::RobotModel;
use grouser_terra::Soil;
use grouser_terrain::raster::Dem;
use grouser_terrain::{DemandSolver, Envelope, LegendSoil, SlipTable, SoilIntervals, SoilMap};
use rayon::prelude::*;

use super::Arguments;
use crate::error::Result;
use crate::progress::Progress;
use crate::session::Session;
use crate::wheel_choice::MaxSlip;

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

/// The soil map, where there is one.
pub(super) fn soil_map(
    arguments: &Arguments,
    dem: &Dem,
    session: &mut Session,
) -> Result<Option<SoilMap>> {
    let Some(path) = &arguments.soil_map else {
        return Ok(None);
    };
    let map = SoilMap::read(path)?;
    for file in map.files() {
        session.used_file(file)?;
    }
    map.check_overlap(path, dem.georeference(), dem.size())?;
    Ok(Some(map))
}

/// The soils drawn from the intervals of each soil of a legend; each soil has its own seed.
pub(super) fn legend_draws(
    arguments: &Arguments,
    legend: &[LegendSoil],
    session: &mut Session,
) -> Result<Vec<Vec<Soil>>> {
    let draw = |(index, entry): (usize, &LegendSoil)| {
        let Some(intervals) = &entry.intervals else {
            return Ok(Vec::new());
        };
        session.used_seed(arguments.seed);
        let seed = arguments.seed.wrapping_add(index as u64 + 1);
        Ok(intervals.draw(&entry.soil, arguments.soil_draws.into(), seed)?)
    };
    legend.iter().enumerate().map(draw).collect()
}

type SoilTable = (DemandSolver, SlipTable);

/// The tables of all soils and of their draws, on all processors; the result does not depend on their number.
pub(super) fn tables(
    model: &RobotModel,
    soils: &[(&Soil, &[Soil])],
    envelope: Envelope,
    max_slip: MaxSlip,
) -> Result<Vec<(SoilTable, Vec<SoilTable>)>> {
    let jobs: Vec<(usize, usize, &Soil)> = soils
        .iter()
        .enumerate()
        .flat_map(|(of, (own, drawn))| {
            let all = std::iter::once(*own).chain(*drawn).enumerate();
            all.map(move |(index, soil)| (of, index, soil))
        })
        .collect();
    let progress = Progress::of_items(jobs.len() as u64, "soils");
    let table = |(of, index, soil): (usize, usize, &Soil)| -> grouser_terrain::Result<SoilTable> {
        let solver = DemandSolver::new(model.clone(), *soil)?.with_max_slip(max_slip.max_slip)?;
        if of > 0 {
            // a patch may be impassable; ground as a whole may not
            let table = SlipTable::new_or_closed(&solver, envelope)?;
            progress.advance(1);
            return Ok((solver, table));
        }
        let table = SlipTable::new(&solver, envelope).map_err(|error| {
            use grouser_terrain::Error;
            match error {
                Error::DoesNotMove { name, .. } => Error::DoesNotMove { name, draw: index },
                other => other,
            }
        })?;
        progress.advance(1);
        Ok((solver, table))
    };
    let tables = jobs
        .into_par_iter()
        .map(table)
        .collect::<grouser_terrain::Result<Vec<_>>>()?;
    let mut tables = tables.into_iter();
    let soils = soils.iter();
    Ok(soils
        .filter_map(|(_, drawn)| {
            let own = tables.next()?;
            Some((own, tables.by_ref().take(drawn.len()).collect()))
        })
        .collect())
}
