//! Draws a scene.

use super::geometry::{Point, Rect, distance};
use super::labels::{self, LABEL_SIZE_PT, Label};
use super::page::Page;
use super::path::Path;
use super::place::{Obstacles, Target};
use super::scale::Scale;
use super::scene::{Scene, Shape};
use super::style::{Colour, Dash, Style};
use super::text::{Anchor, Line};

/// Between two lines of the notes.
const NOTE_LEADING_PT: f64 = 13.0;
/// The middle of small letters above the baseline, as a share of the text's size.
const TEXT_RISE: f64 = 0.33;
/// Length and half width of an arrow's head.
const HEAD: [f64; 2] = [4.4, 1.7];

/// Draws the scene in `area`, as large as it fits, one unit of length the same in both directions.
pub(super) fn draw(page: &mut Page, scene: &Scene, area: Rect) {
    let scale = fitted(scene, area);
    let mut obstacles = Obstacles::default();
    for shape in &scene.shapes {
        draw_shape(page, &mut obstacles, shape, &scale);
    }
    draw_notes(page, &mut obstacles, &scene.notes, area);
    let labels: Vec<Label> = scene
        .labels
        .iter()
        .map(|label| {
            let at = scale.place(label.at);
            Label::new(&label.text, label.colour, Target::Spot(at, 1.0), at)
        })
        .collect();
    let arrangement = labels::arrange(&labels, area, &obstacles);
    labels::draw(page, &labels, &arrangement, &area);
}

/// Writes the notes into the first corner where they touch nothing: upper left, upper right, lower left,
/// lower right.
fn draw_notes(page: &mut Page, obstacles: &mut Obstacles, notes: &[String], area: Rect) {
    let lines: Vec<Line> = notes
        .iter()
        .map(|note| Line::set(note, LABEL_SIZE_PT))
        .collect();
    let width = lines.iter().map(|line| line.width).fold(0.0, f64::max);
    let height = lines.len() as f64 * NOTE_LEADING_PT;
    let inner = area.grown(-4.0);
    let corners = [inner.top, inner.bottom - height].map(|top| {
        [inner.left, inner.right - width].map(|left| Rect::at([left, top], width, height))
    });
    let free = corners
        .iter()
        .flatten()
        .find(|block| obstacles.leave_free(block, 2.4));
    let block = *free.unwrap_or(&corners[0][0]);
    for (index, line) in lines.iter().enumerate() {
        let at = [
            block.left,
            block.top + LABEL_SIZE_PT + index as f64 * NOTE_LEADING_PT,
        ];
        page.text(line.placed(at, Anchor::Start), Colour::INK, &line.words);
    }
    obstacles.boxes.push(block);
}

/// The scale that shows the view in the middle of the area; what lies outside the view is shown as far
/// as the area reaches.
fn fitted(scene: &Scene, area: Rect) -> Scale {
    let [a, b] = scene.view;
    let span = [(b[0] - a[0]).abs(), (b[1] - a[1]).abs()];
    let centre = [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])];
    let unit = (span[0] / area.width()).max(span[1] / area.height());
    let unit = if unit > 0.0 && unit.is_finite() {
        unit
    } else {
        1.0
    };
    let around =
        |centre: f64, length: f64| [centre - unit * length / 2.0, centre + unit * length / 2.0];
    Scale {
        x: around(centre[0], area.width()),
        y: around(centre[1], area.height()),
        frame: area,
    }
}

fn draw_shape(page: &mut Page, obstacles: &mut Obstacles, shape: &Shape, scale: &Scale) {
    let clip = Some(scale.frame);
    match shape {
        Shape::Line(points, style) => {
            let mut path = Path::default();
            for piece in scale.pieces(points) {
                path.append(&Path::line(piece.iter().copied()));
                obstacles.lines.push((piece, style.width / 2.0));
            }
            page.stroke(path, *style, clip);
        }
        Shape::Filled(points, colour, opacity) => {
            page.fill(
                Path::polygon(scale.outline(points)),
                *colour,
                *opacity,
                clip,
            );
        }
        Shape::Circle(centre, radius, style) => {
            let (at, length) = (scale.place(*centre), length(scale, *radius));
            page.stroke(Path::circle(at, length), *style, clip);
            obstacles.lines.push((ring(at, length), style.width / 2.0));
        }
        Shape::Disc(centre, radius, colour) => {
            let (at, length) = (scale.place(*centre), length(scale, *radius));
            page.fill(Path::circle(at, length), *colour, 1.0, clip);
            let corner = [at[0] - length, at[1] - length];
            obstacles
                .boxes
                .push(Rect::at(corner, 2.0 * length, 2.0 * length));
        }
        Shape::Text(centre, text, colour) => {
            let line = Line::set(text, LABEL_SIZE_PT);
            let [x, y] = scale.place(*centre);
            let baseline = [x, y + TEXT_RISE * LABEL_SIZE_PT];
            page.text(line.placed(baseline, Anchor::Middle), *colour, &line.words);
            let corner = [x - line.width / 2.0, y - LABEL_SIZE_PT / 2.0];
            (obstacles.boxes).push(Rect::at(corner, line.width, LABEL_SIZE_PT));
        }
        Shape::Arrow(from, to, style) => {
            let (from, to) = (scale.place(*from), scale.place(*to));
            obstacles.lines.push((vec![from, to], HEAD[1]));
            draw_arrow(page, from, to, *style, clip);
        }
    }
}

/// A length of the scene on the page.
fn length(scale: &Scale, length: f64) -> f64 {
    (length / (scale.x[1] - scale.x[0]) * scale.frame.width()).abs()
}

fn ring(centre: Point, radius: f64) -> Vec<Point> {
    let angle = |i: u16| f64::from(i) * std::f64::consts::TAU / 120.0;
    let at = |i| {
        [
            centre[0] + radius * angle(i).cos(),
            centre[1] + radius * angle(i).sin(),
        ]
    };
    (0..=120).map(at).collect()
}

fn draw_arrow(page: &mut Page, from: Point, to: Point, style: Style, clip: Option<Rect>) {
    let whole = distance(from, to);
    if !(whole > 0.3) {
        return; // nothing to be seen
    }
    let ahead = [(to[0] - from[0]) / whole, (to[1] - from[1]) / whole];
    let across = [-ahead[1], ahead[0]];
    // A short arrow has a small head.
    let size = (whole / (1.6 * HEAD[0])).min(1.0);
    let [head, half] = [HEAD[0] * size, HEAD[1] * size];
    let back = |along: f64, aside: f64| {
        [
            to[0] - along * ahead[0] + aside * across[0],
            to[1] - along * ahead[1] + aside * across[1],
        ]
    };
    let shaft = Style {
        dash: Dash::Solid,
        ..style
    };
    page.stroke(Path::line([from, back(0.7 * head, 0.0)]), shaft, clip);
    page.fill(
        Path::polygon([to, back(head, half), back(head, -half)]),
        style.colour,
        1.0,
        clip,
    );
}
