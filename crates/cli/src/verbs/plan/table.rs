//! A way as a table.

use grouser_report::number::exact;
use grouser_terrain::plan::{PlanMap, Route};

/// One row a cell.
pub(super) fn csv(map: &PlanMap, route: &Route) -> String {
    let mut out = String::from("x_m,y_m,heading_deg,slip,risk,energy_j,time_s,length_m\n");
    for point in &route.waypoints {
        let heading = map.layout.headings.angle(point.heading).to_degrees();
        let cells = [
            point.x,
            point.y,
            heading,
            point.slip,
            point.risk,
            point.energy,
            point.time,
            point.length,
        ];
        out.push_str(&cells.map(exact).join(","));
        out.push('\n');
    }
    out
}
