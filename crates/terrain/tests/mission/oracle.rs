//! The map of a planner that knows the soils and the law of the world.

use grouser_terrain::mission::MissionSettings;
use grouser_terrain::plan::PlanMap;
use grouser_terrain::{Demand, Result};

use super::world::{DIG_SLIP, World};

/// A map with the true demand of every cell and heading: that of the weakest soil under a wheel. `known` has the relief.
pub(super) fn true_map(
    world: &World<'_>,
    known: &PlanMap,
    settings: &MissionSettings,
) -> Result<PlanMap> {
    let mut map = known.clone();
    let headings = settings.headings;
    for cell in 0..map.cells() {
        let place = map.place_of(cell);
        for heading in 0..headings.count() {
            let pose = cell * headings.count() + heading;
            map.energy[pose] = f32::NAN;
            let angle = headings.angle(heading);
            let Some(at) = world.pose(place, angle) else {
                continue;
            };
            if !settings.envelope.holds(at.pitch, at.roll) {
                continue;
            }
            let under = world.soils_under(place, angle);
            let soils = under.iter().map(|soil| &world.soils[*soil]);
            let weakest = soils
                .min_by(|a, b| a.table.steepest().total_cmp(&b.table.steepest()))
                .unwrap();
            map.risk[pose] = 0.0;
            if let Demand::Drives(driving) = weakest.demand(at)?
                && driving.slip <= DIG_SLIP
            {
                map.energy[pose] = driving.energy_per_metre() as f32;
                map.slip[pose] = driving.slip as f32;
                map.slip_high[pose] = driving.slip as f32;
            }
        }
    }
    Ok(map)
}

/// The robot may leave a cell that it stands on.
pub(super) fn open(map: &mut PlanMap, cell: usize) {
    let count = map.layout.headings.count();
    for pose in cell * count..(cell + 1) * count {
        if !(map.energy[pose] >= 0.0) && map.tip_over[pose] > 0.0 {
            map.energy[pose] = 0.0;
            map.slip[pose] = 0.0;
            map.slip_high[pose] = 0.0;
        }
    }
}

/// The cell of a place is not driven.
pub(super) fn close(map: &mut PlanMap, place: (f64, f64)) {
    if let Ok(cell) = map.cell_at("the place", place) {
        let count = map.layout.headings.count();
        map.energy[cell * count..(cell + 1) * count].fill(f32::NAN);
    }
}
