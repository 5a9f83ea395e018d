//! The page as PNG.

use tiny_skia::{FillRule, Mask, Paint, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use super::error::Error;
use super::geometry::Rect;
use super::page::{Item, Page};
use super::path::{Path, Step};
use super::style::Colour;

/// The greatest number of pixels in one direction: the canvas then takes 1.6 GB.
pub(crate) const MAX_SIDE_PX: f64 = 20_000.0;

/// Draws the page at `dots_per_inch` on white.
pub(super) fn write(page: &Page, dots_per_inch: f64) -> Result<Vec<u8>, Error> {
    let dots = dots_per_inch / 72.0;
    draw(page, dots).ok_or(Error::PictureSize {
        width: page.width * dots,
        height: page.height * dots,
        limit: MAX_SIDE_PX,
    })
}

fn draw(page: &Page, dots: f64) -> Option<Vec<u8>> {
    let mut canvas = Pixmap::new(side(page.width * dots)?, side(page.height * dots)?)?;
    canvas.fill(tiny_skia::Color::WHITE);
    let transform = Transform::from_scale(single(dots), single(dots));
    let mut masks: Vec<(Rect, Mask)> = Vec::new();
    for item in &page.items {
        let (Item::Fill { clip, .. } | Item::Stroke { clip, .. }) = item else {
            continue;
        };
        if let Some(clip) = clip
            && !masks.iter().any(|(other, _)| other == clip)
        {
            let mut mask = Mask::new(canvas.width(), canvas.height())?;
            mask.fill_path(
                &outline(&Path::rect(clip))?,
                FillRule::Winding,
                true,
                transform,
            );
            masks.push((*clip, mask));
        }
    }
    let mask = |clip: &Option<Rect>| {
        let clip = (*clip)?;
        masks
            .iter()
            .find(|(other, _)| *other == clip)
            .map(|(_, mask)| mask)
    };
    for item in &page.items {
        match item {
            Item::Fill {
                path,
                colour,
                opacity,
                clip,
            } => {
                let Some(path) = outline(path) else { continue };
                let paint = paint(*colour, *opacity);
                canvas.fill_path(&path, &paint, FillRule::Winding, transform, mask(clip));
            }
            Item::Text { path, colour, .. } => {
                let Some(path) = outline(path) else { continue };
                canvas.fill_path(
                    &path,
                    &paint(*colour, 1.0),
                    FillRule::Winding,
                    transform,
                    None,
                );
            }
            Item::Stroke {
                path,
                colour,
                width,
                dash,
                clip,
            } => {
                let Some(path) = outline(path) else { continue };
                let stroke = Stroke {
                    width: single(*width),
                    line_join: tiny_skia::LineJoin::Round,
                    dash: StrokeDash::new(dash.iter().map(|part| single(*part)).collect(), 0.0),
                    ..Stroke::default()
                };
                canvas.stroke_path(&path, &paint(*colour, 1.0), &stroke, transform, mask(clip));
            }
        }
    }
    canvas.encode_png().ok()
}

fn paint(Colour(red, green, blue): Colour, opacity: f64) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: true,
        ..Paint::default()
    };
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 255 after the clamp"
    )]
    let alpha = (opacity.clamp(0.0, 1.0) * 255.0).round() as u8;
    paint.set_color_rgba8(red, green, blue, alpha);
    paint
}

fn outline(path: &Path) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for step in &path.0 {
        match *step {
            Step::Move([x, y]) => builder.move_to(single(x), single(y)),
            Step::Line([x, y]) => builder.line_to(single(x), single(y)),
            Step::Curve([a, b], [x, y]) => {
                builder.quad_to(single(a), single(b), single(x), single(y));
            }
            Step::Close => builder.close(),
        }
    }
    builder.finish()
}

fn side(pixels: f64) -> Option<u32> {
    if (1.0..=MAX_SIDE_PX).contains(&pixels) {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 1 and 20 000 after the check"
        )]
        let whole = pixels.round() as u32;
        Some(whole)
    } else {
        None
    }
}

/// The rasteriser works in single precision; a page is a few hundred points wide.
fn single(value: f64) -> f32 {
    #[allow(
        clippy::cast_possible_truncation,
        reason = "rounded on purpose, see above"
    )]
    let rounded = value as f32;
    rounded
}
