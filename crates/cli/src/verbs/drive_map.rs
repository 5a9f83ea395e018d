//! The map of a drive: ground by its height, soils' regions, the track coloured by slip.

use std::fmt::Write as _;

use grouser_rover::drive::Scenario;

use super::drive::Run;
use super::drive_tables::{Point, Track};

/// Cells of the ground's picture along its longer side.
const CELLS: f64 = 120.0;
/// Width of the picture.
const WIDTH: f64 = 880.0;

/// An SVG picture.
pub(super) fn map(scenario: &Scenario, run: &Run, track: &Track) -> String {
    let Ok(ground) = scenario.ground.build(run.seed) else {
        return String::new();
    };
    let (low, high) = extent(track);
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    let scale = WIDTH / width;
    let mut out = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" aria-label=\"Map: ground by height, the track coloured by slip\">\n",
        WIDTH,
        height * scale + 40.0
    );
    let at = |x: f64, y: f64| ((x - low[0]) * scale, (high[1] - y) * scale);
    // the ground
    let cell = width.max(height) / CELLS;
    let mut cells = Vec::new();
    let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
    let mut y = low[1];
    while y < high[1] {
        let mut x = low[0];
        while x < high[0] {
            let place = ground.at(x + 0.5 * cell, y + 0.5 * cell);
            if place.known {
                heights = [heights[0].min(place.height), heights[1].max(place.height)];
                cells.push((x, y, place.height, place.soil));
            }
            x += cell;
        }
        y += cell;
    }
    let range = (heights[1] - heights[0]).max(1e-6);
    for (x, y, height, soil) in cells {
        let light = 0.82 + 0.14 * (height - heights[0]) / range;
        let hue = [40.0, 25.0, 90.0, 200.0][soil.min(3)];
        let (left, top) = at(x, y + cell);
        let _ = write!(
            out,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{size:.1}\" height=\"{size:.1}\" fill=\"hsl({hue} 35% {:.0}%)\"/>",
            100.0 * light,
            size = cell * scale + 0.3,
        );
    }
    for pair in track.points.windows(2) {
        let [from, to] = pair else { continue };
        let ((x1, y1), (x2, y2)) = (
            at(from.place[0], from.place[1]),
            at(to.place[0], to.place[1]),
        );
        let _ = write!(
            out,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{}\" stroke-width=\"4\" \
             stroke-linecap=\"round\"/>",
            colour(mean_slip(scenario, to))
        );
    }
    for named in &run.result.decisions {
        let (x, y) = at(named.place.0, named.place.1);
        if named.decision.wheel.is_none() {
            let _ = write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" fill=\"none\" stroke=\"#111\" stroke-width=\"1.5\"/>"
            );
        }
    }
    legend(height * scale + 24.0, scale, &mut out);
    out.push_str("</svg>\n");
    out
}

fn extent(track: &Track) -> ([f64; 2], [f64; 2]) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in &track.points {
        for axis in 0..2 {
            low[axis] = low[axis].min(point.place[axis]);
            high[axis] = high[axis].max(point.place[axis]);
        }
    }
    if !(low[0] <= high[0]) {
        return ([0.0; 2], [1.0; 2]);
    }
    let margin = 1.0 + 0.05 * (high[0] - low[0]);
    for axis in 0..2 {
        low[axis] -= margin;
        high[axis] += margin;
    }
    (low, high)
}

/// Mean true slip of the powered wheels.
fn mean_slip(scenario: &Scenario, point: &Point) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for wheel in scenario.robot.powered() {
        if let Some(slip) = point.wheels.get(wheel).and_then(|wheel| wheel.slip) {
            sum += slip;
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// From blue (no slip) over yellow to red (all of it); braking in green.
fn colour(slip: Option<f64>) -> String {
    let Some(slip) = slip else {
        return "#888".to_owned();
    };
    if slip < -0.02 {
        return format!("hsl(150 60% {:.0}%)", 50.0 - 25.0 * slip.abs().min(1.0));
    }
    format!("hsl({:.0} 80% 45%)", 230.0 * (1.0 - slip.clamp(0.0, 1.0)))
}

fn legend(y: f64, scale: f64, out: &mut String) {
    for step in 0..10 {
        let slip = f64::from(step) / 9.0;
        let _ = write!(
            out,
            "<rect x=\"{}\" y=\"{:.1}\" width=\"20\" height=\"10\" fill=\"{}\"/>",
            50 + 20 * step,
            y - 8.0,
            colour(Some(slip))
        );
    }
    let _ = write!(
        out,
        "<text x=\"0\" y=\"{y:.1}\" font-size=\"13\">slip 0</text><text x=\"256\" y=\"{y:.1}\" font-size=\"13\">1</text>\
         <line x1=\"320\" y1=\"{y:.1}\" x2=\"{:.1}\" y2=\"{y:.1}\" stroke=\"#111\" stroke-width=\"2\"/>\
         <text x=\"{:.1}\" y=\"{y:.1}\" font-size=\"13\">1 m</text>\
         <text x=\"500\" y=\"{y:.1}\" font-size=\"13\">circles: decisions</text>",
        320.0 + scale,
        328.0 + scale,
    );
}
