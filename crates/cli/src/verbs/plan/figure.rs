//! A way on its map.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::MapFrame;
use grouser_terrain::plan::{PlanMap, Route};

use crate::error::Result;
use crate::verbs::map::picture;
use crate::verbs::map::summary::Shades;

/// The way, the others thin and broken, on the slip of the worst heading.
pub(super) fn draw(map: &PlanMap, route: &Route, others: &[Route]) -> Result<String> {
    let headings = map.layout.headings.count();
    let mut shades = Shades::new(&map.layout);
    for cell in 0..map.cells() {
        let poses = cell * headings..(cell + 1) * headings;
        shades.add(
            cell,
            poses
                .filter(|pose| !map.pitch[*pose].is_nan())
                .map(|pose| (map.slip[pose], map.risk[pose])),
        );
    }
    let frame = picture::frame(&map.layout);
    let mut over = String::new();
    for other in others {
        let _ = writeln!(
            over,
            "<path d=\"{}\" fill=\"none\" stroke=\"#1f4e8c\" stroke-width=\"1.6\" stroke-dasharray=\"5 4\"/>",
            line(&frame, other)
        );
    }
    let _ = writeln!(
        over,
        "<path d=\"{0}\" fill=\"none\" stroke=\"#ffffff\" stroke-width=\"5\" stroke-linejoin=\"round\"/>\n\
         <path d=\"{0}\" fill=\"none\" stroke=\"#123a73\" stroke-width=\"2.8\" stroke-linejoin=\"round\"/>",
        line(&frame, route)
    );
    let ends = [route.waypoints.first(), route.waypoints.last()];
    for (end, word) in ends.into_iter().flatten().zip(["A", "B"]) {
        over.push_str(&frame.mark([end.x, end.y], word));
    }
    picture::figure(&map.layout, &shades, &over)
}

fn line(frame: &MapFrame, route: &Route) -> String {
    let mut out = String::new();
    for (index, point) in route.waypoints.iter().enumerate() {
        let [x, y] = frame.at([point.x, point.y]);
        let _ = write!(out, "{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' });
    }
    out
}
