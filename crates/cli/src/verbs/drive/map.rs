//! The map of a drive: the ground's relief with contours, soils' regions, the track coloured by slip.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_rover::drive::Scenario;
use grouser_rover::ground::Ground;

use super::decisions::notable;
use super::relief::{Window, byte, contours, relief};
use super::run::Run;
use super::track::{Point, Track};
use grouser_figure::even_ticks;
use grouser_figure::{escaped, png_address};

/// The frame: its greatest width and height, and what stands around it.
const MOST: [f64; 2] = [800.0, 560.0];
const LEFT_MARGIN_PT: f64 = 58.0;
const TOP_MARGIN_PT: f64 = 12.0;
const RIGHT_MARGIN_PT: f64 = 22.0;
/// Below the frame: ticks and title, then the key.
const BOTTOM_MARGIN_PT: f64 = 100.0;
/// The track is drawn to this many units.
const MIN_TRACK_STEP_PT: f64 = 1.5;
/// Colours of slip from −1 to 1: blue brakes, pale rolls, red spins. They differ in lightness as well.
const SCALE: [(f64, [u8; 3]); 7] = [
    (-1.0, [0x0b, 0x2a, 0x5c]),
    (-0.4, [0x2d, 0x6f, 0xb3]),
    (0.0, [0xf7, 0xf4, 0xea]),
    (0.2, [0xf9, 0xd2, 0x6b]),
    (0.4, [0xee, 0x96, 0x3a]),
    (0.6, [0xcf, 0x4a, 0x32]),
    (1.0, [0x5e, 0x0d, 0x22]),
];

/// An SVG picture; nothing for ground that cannot be built, which the drive would have said.
pub(super) fn map(scenario: &Scenario, run: &Run, track: &Track) -> String {
    let Ok(ground) = scenario.ground.build(run.seed) else {
        return String::new();
    };
    let view = View::around(track);
    let [width, height] = view.size;
    let mut out = format!(
        "<svg viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" class=\"map\">\n\
         <title>Map: relief of the ground, the track coloured by slip</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        LEFT_MARGIN_PT + width + RIGHT_MARGIN_PT,
        TOP_MARGIN_PT + height + BOTTOM_MARGIN_PT
    );
    let contour = shape(&view, &ground, &mut out);
    way(&view, scenario, track, &mut out);
    marks(&view, run, track, &mut out);
    axes(&view, &mut out);
    key(&view, scenario, contour, &mut out);
    out.push_str("</svg>\n");
    out
}

/// From the ground to the picture.
struct View {
    window: Window,
    /// Units per metre.
    scale: f64,
    size: [f64; 2],
}

impl View {
    fn around(track: &Track) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in track.points.iter().map(|point| point.place) {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        if !(low[0] <= high[0]) {
            (low, high) = ([0.0; 2], [1.0; 2]);
        }
        let margin = 1.0 + 0.05 * (high[0] - low[0]).max(high[1] - low[1]);
        for axis in 0..2 {
            low[axis] -= margin;
            high[axis] += margin;
        }
        let extent = [high[0] - low[0], high[1] - low[1]];
        let scale = (MOST[0] / extent[0]).min(MOST[1] / extent[1]);
        Self {
            window: Window { low, high },
            scale,
            size: extent.map(|length| length * scale),
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Window { low, high } = self.window;
        [
            LEFT_MARGIN_PT + (x - low[0]) * self.scale,
            TOP_MARGIN_PT + (high[1] - y) * self.scale,
        ]
    }
}

/// Relief and contours; gives their distance in height.
fn shape(view: &View, ground: &Ground, out: &mut String) -> Option<f64> {
    let [width, height] = view.size;
    if let Ok(picture) = relief(ground, view.window, view.size).png() {
        let _ = writeln!(
            out,
            "<image x=\"{LEFT_MARGIN_PT}\" y=\"{TOP_MARGIN_PT}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             preserveAspectRatio=\"none\" href=\"{}\"/>",
            png_address(&picture)
        );
    }
    let (step, lines) = contours(ground, view.window)?;
    let mut path = String::new();
    for [from, to] in lines {
        let ([x1, y1], [x2, y2]) = (view.at(from), view.at(to));
        let _ = write!(path, "M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}");
    }
    let _ = writeln!(
        out,
        "<path d=\"{path}\" fill=\"none\" stroke=\"#6b5a3a\" stroke-opacity=\".45\" stroke-width=\".8\"/>"
    );
    Some(step)
}

/// The track, dark below so that every colour stands out.
fn way(view: &View, scenario: &Scenario, track: &Track, out: &mut String) {
    let mut stretches: Vec<([f64; 2], [f64; 2], Option<f64>)> = Vec::new();
    let mut from: Option<[f64; 2]> = None;
    for point in &track.points {
        let to = view.at([point.place[0], point.place[1]]);
        let Some(start) = from else {
            from = Some(to);
            continue;
        };
        if (to[0] - start[0]).hypot(to[1] - start[1]) >= MIN_TRACK_STEP_PT {
            stretches.push((start, to, mean_slip(scenario, point)));
            from = Some(to);
        }
    }
    let mut under = String::new();
    for (index, (from, to, _)) in stretches.iter().enumerate() {
        if index == 0 {
            let _ = write!(under, "M{:.1} {:.1}", from[0], from[1]);
        }
        let _ = write!(under, "L{:.1} {:.1}", to[0], to[1]);
    }
    let _ = writeln!(
        out,
        "<path d=\"{under}\" fill=\"none\" stroke=\"#1a1a1e\" stroke-width=\"7\" stroke-linecap=\"round\" \
         stroke-linejoin=\"round\"/>"
    );
    for (from, to, slip) in stretches {
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"{}\" stroke-width=\"4.6\" stroke-linecap=\"round\"/>",
            from[0],
            from[1],
            to[0],
            to[1],
            colour(slip)
        );
    }
}

/// Start, end, and the numbered decisions about the whole robot.
fn marks(view: &View, run: &Run, track: &Track, out: &mut String) {
    let mut disc = |place: [f64; 2], radius: f64, word: &str| {
        let [x, y] = view.at(place);
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"#ffffff\" stroke=\"#1a1a1e\" \
             stroke-width=\"1.6\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{word}</text>",
            y + 4.5
        );
    };
    let ends = [track.points.first(), track.points.last()];
    for (end, word) in ends.into_iter().flatten().zip(["A", "B"]) {
        disc([end.place[0], end.place[1]], 9.0, word);
    }
    for (number, decision) in notable(run) {
        let (x, y) = decision.place;
        disc([x, y], 9.0, &number.to_string());
    }
}

fn axes(view: &View, out: &mut String) {
    let Window { low, high } = view.window;
    let [width, height] = view.size;
    let bottom = TOP_MARGIN_PT + height;
    let _ = writeln!(
        out,
        "<rect x=\"{LEFT_MARGIN_PT}\" y=\"{TOP_MARGIN_PT}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" \
         stroke=\"#1a1a1e\" stroke-width=\"1.2\"/>"
    );
    let most = |length: f64| if length < 200.0 { 3 } else { 8 };
    for (value, label) in even_ticks(low[0], high[0], most(width)) {
        let [x, _] = view.at([value, low[1]]);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {bottom:.1}v-6\" stroke=\"#1a1a1e\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            bottom + 19.0
        );
    }
    for (value, label) in even_ticks(low[1], high[1], most(height)) {
        let [_, y] = view.at([low[0], value]);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT_MARGIN_PT} {y:.1}h6\" stroke=\"#1a1a1e\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            LEFT_MARGIN_PT - 7.0,
            y + 4.5
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\"><tspan font-style=\"italic\">x</tspan> (m)</text>\
         <text x=\"14\" y=\"{middle:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {middle:.1})\">\
         <tspan font-style=\"italic\">y</tspan> (m)</text>",
        LEFT_MARGIN_PT + 0.5 * width,
        bottom + 40.0,
        middle = TOP_MARGIN_PT + 0.5 * height,
    );
}

/// What colours, lines and letters mean.
fn key(view: &View, scenario: &Scenario, contour: Option<f64>, out: &mut String) {
    const MAX_BAR_WIDTH_PT: f64 = 260.0;
    let top = TOP_MARGIN_PT + view.size[1] + 60.0;
    out.push_str("<defs><linearGradient id=\"slip-scale\">");
    for (slip, [red, green, blue]) in SCALE {
        let _ = write!(
            out,
            "<stop offset=\"{}\" stop-color=\"#{red:02x}{green:02x}{blue:02x}\"/>",
            0.5 * (slip + 1.0)
        );
    }
    let _ = writeln!(
        out,
        "</linearGradient></defs>\n<rect x=\"{LEFT_MARGIN_PT}\" y=\"{top:.1}\" width=\"{MAX_BAR_WIDTH_PT}\" height=\"11\" \
         fill=\"url(#slip-scale)\" stroke=\"#1a1a1e\" stroke-width=\".8\"/>"
    );
    for (slip, label) in [
        (-1.0, "−1"),
        (-0.5, "−0.5"),
        (0.0, "0"),
        (0.5, "0.5"),
        (1.0, "1"),
    ] {
        let x = LEFT_MARGIN_PT + MAX_BAR_WIDTH_PT * 0.5 * (slip + 1.0);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {:.1}v4\" stroke=\"#1a1a1e\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{label}</text>",
            top + 11.0,
            top + 30.0
        );
    }
    let mut words = vec!["true slip, mean of the powered wheels".to_owned()];
    if let Some(step) = contour {
        words.push(format!("contours every {} m", short(step)));
    }
    words.push("A start, B end".to_owned());
    let soils = &scenario.ground.soils;
    if scenario.ground.regions.is_empty() {
        words.extend(
            soils
                .first()
                .map(|soil| format!("soil {}", escaped(&soil.name))),
        );
    } else {
        words.push("tinted: other soil".to_owned());
    }
    // two short lines beside the scale
    let split = words.len().div_ceil(2);
    for (line, part) in words.chunks(split.max(1)).enumerate() {
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            LEFT_MARGIN_PT + MAX_BAR_WIDTH_PT + 26.0,
            top + 10.0 + 20.0 * line as f64,
            part.join("; ")
        );
    }
}

fn short(value: f64) -> String {
    format!("{value:.3}")
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

/// Mean true slip of the powered wheels.
fn mean_slip(scenario: &Scenario, point: &Point) -> Option<f64> {
    let slips: Vec<f64> = scenario
        .robot
        .powered()
        .filter_map(|wheel| point.wheels.get(wheel)?.slip)
        .collect();
    (!slips.is_empty()).then(|| slips.iter().sum::<f64>() / slips.len() as f64)
}

/// The colour of a slip; grey where there is none.
fn colour(slip: Option<f64>) -> String {
    let Some(slip) = slip.filter(|slip| slip.is_finite()) else {
        return "#9a9a9e".to_owned();
    };
    let slip = slip.clamp(-1.0, 1.0);
    let next = SCALE
        .iter()
        .position(|(at, _)| *at >= slip)
        .unwrap_or(SCALE.len() - 1);
    let ((from, low), (to, high)) = (SCALE[next.saturating_sub(1)], SCALE[next]);
    let share = if to > from {
        (slip - from) / (to - from)
    } else {
        0.0
    };
    let mut out = String::from("#");
    for (low, high) in low.into_iter().zip(high) {
        let mixed = f64::from(low) + share * (f64::from(high) - f64::from(low));
        let _ = write!(out, "{:02x}", byte(mixed));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_slip_meet_the_scale_and_stay_in_it() {
        assert_eq!(colour(Some(0.0)), "#f7f4ea");
        assert_eq!(colour(Some(1.0)), "#5e0d22");
        assert_eq!(colour(Some(7.0)), colour(Some(1.0)));
        assert_eq!(colour(Some(-1.0)), "#0b2a5c");
        assert_eq!(colour(Some(f64::NAN)), colour(None));
        // half of the way between 0.2 and 0.4
        assert_eq!(colour(Some(0.3)), "#f4b453");
    }
}
