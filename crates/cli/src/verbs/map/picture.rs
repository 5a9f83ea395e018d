//! A map as a picture: the slip of the worst heading.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_figure::{Colour, ColourScale, MapFrame, Picture};
use grouser_terrain::MapLayout;

use super::summary::{Shades, Worst};
use crate::error::{Error, Result};
use crate::figure_file::ending;
use crate::output::OutputFile;

/// The greatest side of the frame.
const MAX_SIDE_PT: f64 = 640.0;
/// Width and height of the key.
const KEY_PT: [f64; 2] = [460.0, 56.0];
/// Colours of a slip's magnitude; they grow darker.
const SCALE: ColourScale<'_> = ColourScale(&[
    (0.0, Colour(247, 244, 234)),
    (0.15, Colour(249, 210, 107)),
    (0.35, Colour(238, 150, 58)),
    (0.6, Colour(207, 74, 50)),
    (0.9, Colour(94, 13, 34)),
]);
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
pub(in crate::verbs) fn frame(layout: &MapLayout) -> MapFrame {
    let [width, height] = [layout.columns, layout.rows].map(|cells| f64::from(cells) * layout.cell);
    let half = 0.5 * layout.cell;
    let [x, y] = layout.place_of(0, 0);
    let [left, top] = [x - half, y + half];
    MapFrame::new([left, top - height], [left + width, top], [MAX_SIDE_PT; 2])
}

fn colour(worst: &Worst) -> Colour {
    if worst.is_unknown() {
        UNKNOWN
    } else if worst.blocked == worst.headings {
        CLOSED
    } else if worst.blocked > 0 {
        PARTLY
    } else {
        SCALE.at(f64::from(worst.slip.abs()))
    }
}

/// The picture in a frame with the map's coordinates, what lies `over` it, and a key.
pub(in crate::verbs) fn figure(layout: &MapLayout, shades: &Shades, over: &str) -> Result<String> {
    let frame = frame(layout);
    let [width, height] = frame.page(KEY_PT);
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" \
         font-family=\"serif\" font-size=\"14\">\n<title>Slip of the worst heading on every cell of the map</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}{over}{}{}</svg>\n",
        frame.ground(&png(shades)?, "image-rendering:pixelated"),
        frame.axes(),
        key(frame.key())
    ))
}

/// What the colours mean.
fn key([left, top]: [f64; 2]) -> String {
    const WIDTH_PT: f64 = 200.0;
    let labels = [(0.0, "0"), (0.3, "0.3"), (0.6, "0.6"), (0.9, "0.9")];
    let mut out = SCALE.bar("slip", [left, top], WIDTH_PT, &labels);
    let _ = writeln!(
        out,
        "<text x=\"{left:.1}\" y=\"{:.1}\">slip of the worst heading</text>",
        top + 49.0
    );
    for (index, (colour, words)) in [
        (PARTLY, "some headings cannot be driven"),
        (CLOSED, "none can"),
        (UNKNOWN, "unknown"),
    ]
    .into_iter()
    .enumerate()
    {
        let (x, y) = (left + WIDTH_PT + 30.0, top + 18.0 * index as f64);
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"12\" height=\"11\" fill=\"{colour}\" stroke=\"{}\" \
             stroke-width=\"0.8\"/><text x=\"{:.1}\" y=\"{:.1}\">{words}</text>",
            Colour::INK,
            x + 18.0,
            y + 10.0
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_meet_the_scale_and_stay_in_it() {
        assert_eq!(SCALE.at(0.0), Colour(247, 244, 234));
        assert_eq!(SCALE.at(0.9), Colour(94, 13, 34));
        assert_eq!(SCALE.at(7.0), SCALE.at(0.9));
        assert_eq!(SCALE.at(0.25), Colour(244, 180, 83));
    }
}
