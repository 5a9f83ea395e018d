//! The map of a drive: the ground's relief with contours, soils' regions, the track coloured by slip.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::{Colour, ColourScale, MapFrame, escaped};
use grouser_rover::drive::Scenario;
use grouser_rover::ground::Ground;

use super::decisions::notable;
use super::relief::{contours, relief};
use super::run::Run;
use super::track::{Point, Track};

/// The greatest width and height of the frame.
const MAX_SIZE_PT: [f64; 2] = [800.0, 560.0];
/// Width and height of the key.
const KEY_PT: [f64; 2] = [560.0, 40.0];
/// The bar of colours in it.
const BAR_WIDTH_PT: f64 = 260.0;
/// The track is drawn to this many units.
const MIN_TRACK_STEP_PT: f64 = 1.5;
/// Colours of slip from −1 to 1: blue brakes, pale rolls, red spins. They differ in lightness as well.
const SCALE: ColourScale<'_> = ColourScale(&[
    (-1.0, Colour(0x0b, 0x2a, 0x5c)),
    (-0.4, Colour(0x2d, 0x6f, 0xb3)),
    (0.0, Colour(0xf7, 0xf4, 0xea)),
    (0.2, Colour(0xf9, 0xd2, 0x6b)),
    (0.4, Colour(0xee, 0x96, 0x3a)),
    (0.6, Colour(0xcf, 0x4a, 0x32)),
    (1.0, Colour(0x5e, 0x0d, 0x22)),
]);
/// Where there is no slip.
const NO_SLIP: Colour = Colour(0x9a, 0x9a, 0x9e);

/// An SVG picture; nothing for ground that cannot be built, which the drive would have said.
pub(super) fn map(scenario: &Scenario, run: &Run, track: &Track) -> String {
    let Ok(ground) = scenario.ground.build(run.seed) else {
        return String::new();
    };
    let frame = around(track);
    let [width, height] = frame.page(KEY_PT);
    let mut out = format!(
        "<svg viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" class=\"map\">\n\
         <title>Map: relief of the ground, the track coloured by slip</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    let contour = shape(&frame, &ground, &mut out);
    way(&frame, scenario, track, &mut out);
    marks(&frame, run, track, &mut out);
    out.push_str(&frame.axes());
    key(&frame, scenario, contour, &mut out);
    out.push_str("</svg>\n");
    out
}

/// The ground around a track.
fn around(track: &Track) -> MapFrame {
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
    MapFrame::new(
        low.map(|side| side - margin),
        high.map(|side| side + margin),
        MAX_SIZE_PT,
    )
}

/// Relief and contours; gives their distance in height.
fn shape(frame: &MapFrame, ground: &Ground, out: &mut String) -> Option<f64> {
    if let Ok(picture) = relief(ground, frame).png() {
        out.push_str(&frame.ground(&picture, ""));
    }
    let (step, lines) = contours(ground, frame)?;
    let mut path = String::new();
    for [from, to] in lines {
        let ([x1, y1], [x2, y2]) = (frame.at(from), frame.at(to));
        let _ = write!(path, "M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}");
    }
    let _ = writeln!(
        out,
        "<path d=\"{path}\" fill=\"none\" stroke=\"#6b5a3a\" stroke-opacity=\".45\" stroke-width=\".8\"/>"
    );
    Some(step)
}

/// The track, dark below so that every colour stands out.
fn way(frame: &MapFrame, scenario: &Scenario, track: &Track, out: &mut String) {
    let mut stretches: Vec<([f64; 2], [f64; 2], Option<f64>)> = Vec::new();
    let mut from: Option<[f64; 2]> = None;
    for point in &track.points {
        let to = frame.at([point.place[0], point.place[1]]);
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
fn marks(frame: &MapFrame, run: &Run, track: &Track, out: &mut String) {
    let ends = [track.points.first(), track.points.last()];
    for (end, word) in ends.into_iter().flatten().zip(["A", "B"]) {
        out.push_str(&frame.mark([end.place[0], end.place[1]], word));
    }
    for (number, decision) in notable(run) {
        let (x, y) = decision.place;
        out.push_str(&frame.mark([x, y], &number.to_string()));
    }
}

/// What colours, lines and letters mean.
fn key(frame: &MapFrame, scenario: &Scenario, contour: Option<f64>, out: &mut String) {
    let [left, top] = frame.key();
    let labels = [
        (-1.0, "−1"),
        (-0.5, "−0.5"),
        (0.0, "0"),
        (0.5, "0.5"),
        (1.0, "1"),
    ];
    out.push_str(&SCALE.bar("slip-scale", [left, top], BAR_WIDTH_PT, &labels));
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
            left + BAR_WIDTH_PT + 26.0,
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

fn colour(slip: Option<f64>) -> Colour {
    slip.filter(|slip| slip.is_finite())
        .map_or(NO_SLIP, |slip| SCALE.at(slip))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_of_slip_meet_the_scale_and_stay_in_it() {
        assert_eq!(colour(Some(0.0)).to_string(), "#f7f4ea");
        assert_eq!(colour(Some(1.0)).to_string(), "#5e0d22");
        assert_eq!(colour(Some(7.0)), colour(Some(1.0)));
        assert_eq!(colour(Some(-1.0)).to_string(), "#0b2a5c");
        assert_eq!(colour(Some(f64::NAN)), colour(None));
        // half of the way between 0.2 and 0.4
        assert_eq!(colour(Some(0.3)).to_string(), "#f4b453");
    }
}
