//! The front as a CSV table.

use grouser_design::mission::{MissionFront, WheelDesign};
use grouser_report::number::exact;

pub(super) fn csv(front: &MissionFront) -> String {
    let mut out = WheelDesign::NAMES.join(",");
    out.push_str(",wheel_mass_kg,energy_j_per_m,least_reserve,energy_saved_j_per_m_kg,is_chosen\n");
    for (index, point) in front.points.iter().enumerate() {
        let optional = |x: Option<f64>| x.map_or_else(String::new, exact);
        let mut cells: Vec<String> = point.wheel.sizes().map(exact).to_vec();
        cells.extend([
            exact(point.wheel_mass),
            optional(point.energy),
            exact(point.least_reserve()),
            optional(point.energy_per_mass),
            u8::from(front.chosen == Some(index)).to_string(),
        ]);
        out.push_str(&cells.join(","));
        out.push('\n');
    }
    out
}
