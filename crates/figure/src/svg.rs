//! The page as SVG 1.1.

use std::fmt::Write as _;

use super::geometry::Rect;
use super::page::{Item, Page};
use super::path::{Path, Step};
use crate::page_text::escaped;

/// Writes the page.
pub(super) fn write(page: &Page) -> String {
    let mut svg = String::new();
    let (width, height) = (number(page.width), number(page.height));
    let description = escaped(&page.description);
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}pt\" height=\"{height}pt\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{description}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"
    );
    for clip in clips(page) {
        let shape = data(&Path::rect(&clip));
        let _ = writeln!(
            svg,
            "<clipPath id=\"{}\"><path d=\"{shape}\"/></clipPath>",
            name(&clip)
        );
    }
    for item in &page.items {
        let _ = match item {
            Item::Fill {
                path,
                colour,
                opacity,
                clip,
            } => writeln!(
                svg,
                "<path d=\"{}\" fill=\"{}\"{}{}/>",
                data(path),
                colour,
                if *opacity < 1.0 {
                    format!(" fill-opacity=\"{}\"", number(*opacity))
                } else {
                    String::new()
                },
                reference(*clip)
            ),
            Item::Stroke {
                path,
                colour,
                width,
                dash,
                clip,
            } => writeln!(
                svg,
                "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" \
                 stroke-linejoin=\"round\"{}{}/>",
                data(path),
                colour,
                number(*width),
                dashes(dash),
                reference(*clip)
            ),
            Item::Text {
                path,
                colour,
                words,
            } => writeln!(
                svg,
                "<path d=\"{}\" fill=\"{}\" role=\"img\" aria-label=\"{}\"/>",
                data(path),
                colour,
                escaped(words)
            ),
        };
    }
    svg.push_str("</svg>\n");
    svg
}

fn clips(page: &Page) -> Vec<Rect> {
    let mut clips: Vec<Rect> = Vec::new();
    for item in &page.items {
        if let Item::Fill {
            clip: Some(clip), ..
        }
        | Item::Stroke {
            clip: Some(clip), ..
        } = item
            && !clips.contains(clip)
        {
            clips.push(*clip);
        }
    }
    clips
}

/// The name of a clip says its shape: figures that stand in one page share names only where they share shapes.
fn name(clip: &Rect) -> String {
    let sides = [clip.left, clip.top, clip.right, clip.bottom].map(number);
    format!("clip_{}", sides.join("_"))
}

fn reference(clip: Option<Rect>) -> String {
    clip.map_or_else(String::new, |clip| {
        format!(" clip-path=\"url(#{})\"", name(&clip))
    })
}

fn dashes(dash: &[f64]) -> String {
    if dash.is_empty() {
        return String::new();
    }
    let parts: Vec<String> = dash.iter().map(|part| number(*part)).collect();
    format!(" stroke-dasharray=\"{}\"", parts.join(" "))
}

fn data(path: &Path) -> String {
    let mut text = String::new();
    for step in &path.0 {
        match step {
            Step::Move([x, y]) => text.extend(["M", &number(*x), " ", &number(*y)]),
            Step::Line([x, y]) => text.extend(["L", &number(*x), " ", &number(*y)]),
            Step::Curve([a, b], [x, y]) => {
                text.extend([
                    "Q",
                    &number(*a),
                    " ",
                    &number(*b),
                    " ",
                    &number(*x),
                    " ",
                    &number(*y),
                ]);
            }
            Step::Close => text.push('Z'),
        }
    }
    text
}

/// A coordinate to a hundredth of a point: finer than any printer.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}
