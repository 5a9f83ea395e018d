//! Where the panels of a figure stand.

use super::chart::Chart;
use super::draw_chart::{self, Axes};
use super::draw_scene;
use super::geometry::Rect;
use super::page::Page;
use super::style::Colour;
use super::text::{Anchor, Line};
use super::{Figure, Panel};

/// Sizes of text in points.
pub(super) const TITLE_SIZE: f64 = 10.5;
pub(super) const TICK_SIZE: f64 = 9.5;
const LETTER_SIZE: f64 = 10.5;
/// A panel's width: alone, and beside others.
const ALONE: f64 = 300.0;
const BESIDE: f64 = 255.0;
/// Height of a frame in parts of its width.
const ASPECT: f64 = 0.70;
/// Between the figure's edge and its content.
const EDGE: f64 = 4.0;
/// Between a frame and its tick labels, and between those and the axis title.
pub(super) const TICK_GAP: f64 = 5.0;
pub(super) const TITLE_GAP: f64 = 6.0;
/// Free on the right of a frame: half a tick label.
const RIGHT: f64 = 12.0;
/// Above a frame, with and without a letter.
const TOP_LETTERED: f64 = 22.0;
const TOP: f64 = 12.0;
/// Below a frame: tick labels and title.
const BOTTOM: f64 = TICK_GAP + TICK_SIZE + TITLE_GAP + TITLE_SIZE + 4.0;

/// Draws all panels on one page.
pub(super) fn page(figure: &Figure) -> Page {
    let columns = figure.columns.min(figure.panels.len()).max(1);
    let lettered = figure.panels.len() > 1;
    let cell = if columns == 1 { ALONE } else { BESIDE };
    let top = if lettered { TOP_LETTERED } else { TOP };

    // The widest tick label of all panels sets the left margin of all: equal frames.
    let axes: Vec<Option<Axes>> = figure
        .panels
        .iter()
        .map(|panel| match panel {
            Panel::Chart(chart) => Some(axes(chart, cell)),
            Panel::Scene(_) => None,
        })
        .collect();
    let widest = axes
        .iter()
        .flatten()
        .map(Axes::widest_y_label)
        .fold(0.0, f64::max);
    let left = TITLE_SIZE + TITLE_GAP + widest + TICK_GAP;
    let frame_width = cell - left - RIGHT;
    let frame = Rect::at([left, top], frame_width, frame_width * ASPECT);
    let height = frame.bottom + BOTTOM;

    let mut widths = vec![cell; columns];
    let mut parts = Vec::new();
    for (index, (panel, axes)) in figure.panels.iter().zip(&axes).enumerate() {
        let mut part = Page::default();
        match (panel, axes) {
            (Panel::Chart(chart), Some(axes)) => {
                let outside = draw_chart::draw(&mut part, chart, axes, frame);
                let width = &mut widths[index % columns];
                *width = width.max(frame.right + outside);
            }
            (Panel::Scene(scene), _) => {
                let area = Rect {
                    left: 0.0,
                    top,
                    right: cell - RIGHT,
                    bottom: height,
                };
                draw_scene::draw(&mut part, scene, area);
            }
            (Panel::Chart(_), None) => {}
        }
        parts.push(part);
    }

    let rows = figure.panels.len().div_ceil(columns);
    let mut page = Page {
        width: widths.iter().sum::<f64>() + 2.0 * EDGE,
        height: rows as f64 * height + 2.0 * EDGE,
        description: figure.description.clone(),
        items: Vec::new(),
    };
    for (index, part) in parts.into_iter().enumerate() {
        let corner = [
            EDGE + widths[..index % columns].iter().sum::<f64>(),
            EDGE + (index / columns) as f64 * height,
        ];
        page.put(part, corner);
        if lettered {
            let letter = Line::set_bold(&format!("({})", letter(index)), LETTER_SIZE);
            let outline = letter.placed([corner[0], corner[1] + LETTER_SIZE], Anchor::Start);
            page.text(outline, Colour::INK, &letter.words);
        }
    }
    page
}

/// Intervals of the vertical axis, at most: at first, and when that leaves no room for the labels.
const MOST: [u8; 2] = [6, 8];

/// The ticks of a chart: few, unless more of them, which fit the data more closely, let all labels stand
/// inside.
fn axes(chart: &Chart, cell: f64) -> Axes {
    let width = cell * 0.75;
    let [few, more] = MOST.map(|most| Axes::of(chart, width, most));
    // About where the frame will be.
    let frame = Rect::at([0.0, 0.0], width, width * ASPECT);
    let leaves = |axes: &Axes| draw_chart::draw(&mut Page::default(), chart, axes, frame) > 0.0;
    if leaves(&few) && !leaves(&more) {
        more
    } else {
        few
    }
}

/// a, b, …, z, then numbers.
fn letter(index: usize) -> String {
    let letter = u8::try_from(index)
        .ok()
        .filter(|i| *i < 26)
        .map(|i| char::from(b'a' + i));
    letter.map_or_else(|| (index + 1).to_string(), String::from)
}
