//! The map of a planner that knows the soils and the law of the world.

use super::believed_map::MissionSettings;
use super::world::{DIG_SLIP, World};
use crate::demand::Demand;
use crate::error::Result;
use crate::plan::PlanMap;

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
            let by_strength = |a: &usize, b: &usize| {
                let of = |soil: usize| world.soils()[soil].table.steepest();
                of(*a).total_cmp(&of(*b))
            };
            let Some(weakest) = under.min_by(by_strength) else {
                continue;
            };
            let soil = &world.soils()[weakest];
            map.risk[pose] = 0.0;
            if let Demand::Drives(driving) = soil.table.demand(&soil.solver, at.pitch, at.roll)?
                && driving.slip <= DIG_SLIP
            {
                map.energy[pose] = to_f32(driving.energy_per_metre());
                map.slip[pose] = to_f32(driving.slip);
                map.slip_high[pose] = to_f32(driving.slip);
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

#[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
fn to_f32(value: f64) -> f32 {
    value as f32
}
