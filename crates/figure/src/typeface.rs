//! The font: outlines, advances and kerning of STIX Two Text.
//!
//! `font/*.ttf` are the Latin, Latin-1 and Greek letters of the static fonts, without hints, the pair
//! kerning in a `kern` table (SIL Open Font License, `font/OFL.txt`; no reserved font name).

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

use super::path::{Path, Step};

/// Upright, italic or bold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    Regular,
    Italic,
    Bold,
}

static REGULAR: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("font/regular.ttf"), 0).ok());
static ITALIC: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("font/italic.ttf"), 0).ok());
static BOLD: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("font/bold.ttf"), 0).ok());

/// The face of a cut. A test holds that all three parse, so that nothing is ever drawn without letters.
fn face(cut: Cut) -> Option<&'static Face<'static>> {
    match cut {
        Cut::Regular => REGULAR.as_ref(),
        Cut::Italic => ITALIC.as_ref(),
        Cut::Bold => BOLD.as_ref(),
    }
}

/// The outlines of `text` at 1 point, from the origin to the right along the baseline, and how far it
/// advances. A letter that the font lacks is drawn as a box.
pub(super) fn outline(text: &str, cut: Cut) -> (Path, f64) {
    let Some(face) = face(cut) else {
        return (Path::default(), 0.0);
    };
    let unit = 1.0 / f64::from(face.units_per_em());
    let mut pen = Pen {
        path: Path::default(),
        at: 0.0,
        unit,
    };
    let mut previous: Option<GlyphId> = None;
    for letter in text.chars() {
        let glyph = face.glyph_index(letter).unwrap_or(GlyphId(0));
        if let Some(previous) = previous {
            pen.at += unit * kerning(face, previous, glyph);
        }
        face.outline_glyph(glyph, &mut pen);
        pen.at += unit * f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
        previous = Some(glyph);
    }
    (pen.path, pen.at)
}

fn kerning(face: &Face<'_>, left: GlyphId, right: GlyphId) -> f64 {
    let tables = face
        .tables()
        .kern
        .into_iter()
        .flat_map(|kern| kern.subtables);
    tables
        .filter(|table| table.horizontal)
        .find_map(|table| table.glyphs_kerning(left, right))
        .map_or(0.0, f64::from)
}

struct Pen {
    path: Path,
    at: f64,
    unit: f64,
}

impl Pen {
    fn point(&self, x: f32, y: f32) -> [f64; 2] {
        [
            self.at + self.unit * f64::from(x),
            -self.unit * f64::from(y),
        ]
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.0.push(Step::Move(self.point(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.0.push(Step::Line(self.point(x, y)));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path
            .0
            .push(Step::Curve(self.point(x1, y1), self.point(x, y)));
    }

    fn curve_to(&mut self, _: f32, _: f32, _: f32, _: f32, x: f32, y: f32) {
        // TrueType outlines have no cubic curves; the chord would stand in for one.
        self.line_to(x, y);
    }

    fn close(&mut self) {
        self.path.0.push(Step::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_that_figures_need_is_there() {
        for cut in [Cut::Regular, Cut::Italic, Cut::Bold] {
            let face = face(cut).unwrap();
            for letter in "AZaz09()[]%/.,:;=<>|+−×·°±–’θφστηωβλγκΩΔμ ".chars()
            {
                assert!(face.glyph_index(letter).is_some(), "{letter:?} of {cut:?}");
            }
        }
    }

    #[test]
    fn pairs_are_kerned() {
        let width = |text| outline(text, Cut::Regular).1;
        assert!(width("To") < width("T") + width("o") - 0.02);
        assert!((width("00") - 2.0 * width("0")).abs() < 1e-12);
    }
}
