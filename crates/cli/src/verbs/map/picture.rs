//! A map as a picture: the slip of the worst heading.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_figure::{Colour, Picture, even_ticks, png_address};
use grouser_terrain::MapLayout;

use super::summary::{Shades, Worst};
use crate::error::{Error, Result};
use crate::figure_file::ending;
use crate::output::OutputFile;

/// The frame: its greatest side, and what stands around it.
const MAX_SIDE_PT: f64 = 640.0;
const LEFT_MARGIN_PT: f64 = 90.0;
const TOP_MARGIN_PT: f64 = 14.0;
const RIGHT_MARGIN_PT: f64 = 24.0;
/// Below the frame: ticks, title and the key.
const BOTTOM_MARGIN_PT: f64 = 110.0;
/// Colours of a slip's magnitude; they grow darker.
const SCALE: [(f32, [f32; 3]); 5] = [
    (0.0, [247.0, 244.0, 234.0]),
    (0.15, [249.0, 210.0, 107.0]),
    (0.35, [238.0, 150.0, 58.0]),
    (0.6, [207.0, 74.0, 50.0]),
    (0.9, [94.0, 13.0, 34.0]),
];
/// Where some headings cannot be driven, where none can, and where nothing is known.
const PARTLY: Colour = Colour(0x8a, 0x6b, 0xb0);
const CLOSED: Colour = Colour(0x1f, 0x1f, 0x2b);
const UNKNOWN: Colour = Colour(0xc8, 0xc8, 0xc8);

/// Writes the figure; gives a line that says so.
pub(super) fn write(path: &Path, layout: &MapLayout, shades: &Shades) -> Result<String> {
    let bytes = if ending(path).as_deref() == Some("svg") {
        figure(layout, shades, "")?.into_bytes()
    } else {
        png(shades)?
    };
    OutputFile::create(path)?.write_whole(&bytes)
}

/// One pixel a cell, or the worst of the cells that share it.
fn png(shades: &Shades) -> Result<Vec<u8>> {
    let columns = shades.size[0];
    let picture = Picture::new(shades.size, |column, row| {
        let pixel = shades.pixels.get((row * columns + column) as usize);
        pixel.map_or(UNKNOWN, colour)
    });
    picture
        .png()
        .map_err(|error| Error::usage_without_hint(error.to_string()))
}

/// The frame of a map on its page.
pub(in crate::verbs) struct Frame {
    /// x of its left and y of its upper edge, m.
    corner: [f64; 2],
    /// m.
    extent: [f64; 2],
    /// Points a metre.
    scale: f64,
}

impl Frame {
    pub(in crate::verbs) fn of(layout: &MapLayout) -> Self {
        let extent = [layout.columns, layout.rows].map(|cells| f64::from(cells) * layout.cell);
        let half = 0.5 * layout.cell;
        let centre = layout.georeference.centre(0, 0);
        Self {
            corner: centre.map_or([0.0, extent[1]], |[x, y]| [x - half, y + half]),
            extent,
            scale: MAX_SIDE_PT / extent[0].max(extent[1]),
        }
    }

    /// Where a place of the map lies on the page.
    pub(in crate::verbs) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [
            LEFT_MARGIN_PT + (x - self.corner[0]) * self.scale,
            TOP_MARGIN_PT + (self.corner[1] - y) * self.scale,
        ]
    }
}

fn colour(worst: &Worst) -> Colour {
    if worst.is_unknown() {
        UNKNOWN
    } else if worst.blocked == worst.headings {
        CLOSED
    } else if worst.blocked > 0 {
        PARTLY
    } else {
        of_slip(worst.slip.abs())
    }
}

fn of_slip(slip: f32) -> Colour {
    let next = SCALE.iter().position(|(at, _)| *at >= slip);
    let next = next.unwrap_or(SCALE.len() - 1).max(1);
    let ((from, low), (to, high)) = (SCALE[next - 1], SCALE[next]);
    let share = ((slip - from) / (to - from)).clamp(0.0, 1.0);
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between two bytes"
    )]
    let mix = |axis: usize| (low[axis] + share * (high[axis] - low[axis])).round() as u8;
    Colour(mix(0), mix(1), mix(2))
}

/// The picture in a frame with the map's coordinates, what lies `over` it, and a key.
pub(in crate::verbs) fn figure(layout: &MapLayout, shades: &Shades, over: &str) -> Result<String> {
    let png = png(shades)?;
    let frame = Frame::of(layout);
    let Frame {
        corner: [left, top],
        extent,
        scale,
    } = frame;
    let [width, height] = extent.map(|length| length * scale);
    let bottom = TOP_MARGIN_PT + height;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" role=\"img\" font-family=\"serif\" \
         font-size=\"14\">\n<title>Slip of the worst heading on every cell of the map</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <image x=\"{LEFT_MARGIN_PT}\" y=\"{TOP_MARGIN_PT}\" width=\"{width:.2}\" height=\"{height:.2}\" \
         preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"{}\"/>\n\
         <rect x=\"{LEFT_MARGIN_PT}\" y=\"{TOP_MARGIN_PT}\" width=\"{width:.2}\" height=\"{height:.2}\" fill=\"none\" \
         stroke=\"#1a1a1e\" stroke-width=\"1.2\"/>\n",
        LEFT_MARGIN_PT + width.max(460.0) + RIGHT_MARGIN_PT,
        bottom + BOTTOM_MARGIN_PT,
        png_address(&png)
    );
    out.push_str(over);
    for (value, label) in even_ticks(left, left + extent[0], 5) {
        let [x, _] = frame.at(value, top);
        let _ = writeln!(
            out,
            "<path d=\"M{x:.1} {bottom:.1}v-6\" stroke=\"#1a1a1e\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            bottom + 19.0
        );
    }
    for (value, label) in even_ticks(top - extent[1], top, 5) {
        let [_, y] = frame.at(left, value);
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT_MARGIN_PT} {y:.1}h6\" stroke=\"#1a1a1e\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            LEFT_MARGIN_PT - 7.0,
            y + 4.5
        );
    }
    let middle = LEFT_MARGIN_PT + 0.5 * width;
    let _ = writeln!(
        out,
        "<text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\"><tspan font-style=\"italic\">x</tspan> (m), \
         upwards <tspan font-style=\"italic\">y</tspan> (m)</text>",
        bottom + 42.0
    );
    key(&mut out, bottom + 58.0);
    out.push_str("</svg>\n");
    Ok(out)
}

/// What the colours mean.
fn key(out: &mut String, top: f64) {
    const WIDTH_PT: f64 = 200.0;
    out.push_str("<defs><linearGradient id=\"slip\">");
    for (slip, _) in SCALE {
        let Colour(red, green, blue) = of_slip(slip);
        let _ = write!(
            out,
            "<stop offset=\"{:.3}\" stop-color=\"#{red:02x}{green:02x}{blue:02x}\"/>",
            slip / SCALE[SCALE.len() - 1].0
        );
    }
    let _ = writeln!(
        out,
        "</linearGradient></defs>\n<rect x=\"{LEFT_MARGIN_PT}\" y=\"{top:.1}\" width=\"{WIDTH_PT}\" height=\"11\" \
         fill=\"url(#slip)\" stroke=\"#1a1a1e\" stroke-width=\"0.8\"/>"
    );
    for (slip, label) in [(0.0, "0"), (0.3, "0.3"), (0.6, "0.6"), (0.9, "0.9")] {
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
            LEFT_MARGIN_PT + WIDTH_PT * slip / 0.9,
            top + 26.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{LEFT_MARGIN_PT}\" y=\"{:.1}\">slip of the worst heading</text>",
        top + 45.0
    );
    for (index, (colour, words)) in [
        (PARTLY, "some headings cannot be driven"),
        (CLOSED, "none can"),
        (UNKNOWN, "unknown"),
    ]
    .into_iter()
    .enumerate()
    {
        let Colour(red, green, blue) = colour;
        let (x, y) = (LEFT_MARGIN_PT + WIDTH_PT + 30.0, top + 18.0 * index as f64);
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"12\" height=\"11\" fill=\"#{red:02x}{green:02x}{blue:02x}\" \
             stroke=\"#1a1a1e\" stroke-width=\"0.8\"/><text x=\"{:.1}\" y=\"{:.1}\">{words}</text>",
            x + 18.0,
            y + 10.0
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_meet_the_scale_and_stay_in_it() {
        assert_eq!(of_slip(0.0), Colour(247, 244, 234));
        assert_eq!(of_slip(0.9), Colour(94, 13, 34));
        assert_eq!(of_slip(7.0), of_slip(0.9));
        assert_eq!(of_slip(0.25), Colour(244, 180, 83));
    }
}
