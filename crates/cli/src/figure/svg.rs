//! The page as SVG 1.1.

use std::fmt::Write as _;

use super::geometry::Rect;
use super::page::{Item, Page};
use super::path::{Path, Step};
use super::style::Colour;

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
    let clips = clips(page);
    for (i, clip) in clips.iter().enumerate() {
        let shape = data(&Path::rect(clip));
        let _ = writeln!(
            svg,
            "<clipPath id=\"clip{i}\"><path d=\"{shape}\"/></clipPath>"
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
                hex(*colour),
                if *opacity < 1.0 {
                    format!(" fill-opacity=\"{}\"", number(*opacity))
                } else {
                    String::new()
                },
                reference(&clips, *clip)
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
                hex(*colour),
                number(*width),
                dashes(dash),
                reference(&clips, *clip)
            ),
            Item::Text {
                path,
                colour,
                words,
            } => writeln!(
                svg,
                "<path d=\"{}\" fill=\"{}\" role=\"img\" aria-label=\"{}\"/>",
                data(path),
                hex(*colour),
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

fn reference(clips: &[Rect], clip: Option<Rect>) -> String {
    let index = clip.and_then(|clip| clips.iter().position(|other| *other == clip));
    index.map_or_else(String::new, |i| format!(" clip-path=\"url(#clip{i})\""))
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

fn hex(Colour(red, green, blue): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '"' => escaped.push_str("&quot;"),
            // XML has no place for most control characters, not even escaped.
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}
