//! Where the panels of a figure stand.

use super::chart::Chart;
use super::draw_chart::{self, Axes};
use super::draw_scene;
use super::geometry::Rect;
use super::page::Page;
use super::panel::Panel;
use super::sizes::{TICK_GAP_PT, TICK_SIZE_PT, TITLE_GAP_PT, TITLE_SIZE_PT};
use super::style::Colour;
use super::text::{Anchor, Line};

/// Size of a panel's letter.
const LETTER_SIZE_PT: f64 = 10.5;
/// Width of a panel that stands alone: a column of a journal.
const ALONE_WIDTH_PT: f64 = 300.0;
/// Width of a panel beside others: two fill a page.
const BESIDE_WIDTH_PT: f64 = 255.0;
/// Height of a frame over its width.
const FRAME_ASPECT: f64 = 0.70;
/// Between the figure's edge and its content.
const EDGE_PT: f64 = 4.0;
/// Free on the right of a frame: half a tick label.
const RIGHT_PT: f64 = 12.0;
/// Above a frame with a letter.
const TOP_LETTERED_PT: f64 = 22.0;
/// Above a frame without one.
const TOP_PT: f64 = 12.0;
/// Below a frame: tick labels and title.
const BOTTOM_PT: f64 = TICK_GAP_PT + TICK_SIZE_PT + TITLE_GAP_PT + TITLE_SIZE_PT + 4.0;

/// Draws all panels on one page.
pub(super) fn page(description: &str, columns: usize, panels: &[Panel]) -> Page {
    let columns = columns.min(panels.len()).max(1);
    let lettered = panels.len() > 1;
    let cell = if columns == 1 {
        ALONE_WIDTH_PT
    } else {
        BESIDE_WIDTH_PT
    };
    let top = if lettered { TOP_LETTERED_PT } else { TOP_PT };

    // The widest tick label of all panels sets the left margin of all: equal frames.
    let axes: Vec<Option<Axes>> = panels
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
    let left = TITLE_SIZE_PT + TITLE_GAP_PT + widest + TICK_GAP_PT;
    let frame_width = cell - left - RIGHT_PT;
    let frame = Rect::at([left, top], frame_width, frame_width * FRAME_ASPECT);
    let height = frame.bottom + BOTTOM_PT;

    let mut widths = vec![cell; columns];
    let mut parts = Vec::new();
    for (index, (panel, axes)) in panels.iter().zip(&axes).enumerate() {
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
                    right: cell - RIGHT_PT,
                    bottom: height,
                };
                draw_scene::draw(&mut part, scene, area);
            }
            (Panel::Chart(_), None) => {}
        }
        parts.push(part);
    }

    let rows = panels.len().div_ceil(columns);
    let mut page = Page {
        width: widths.iter().sum::<f64>() + 2.0 * EDGE_PT,
        height: rows as f64 * height + 2.0 * EDGE_PT,
        description: description.to_owned(),
        items: Vec::new(),
    };
    for (index, part) in parts.into_iter().enumerate() {
        let corner = [
            EDGE_PT + widths[..index % columns].iter().sum::<f64>(),
            EDGE_PT + (index / columns) as f64 * height,
        ];
        page.put(part, corner);
        if lettered {
            let letter = Line::set_bold(&format!("({})", letter(index)), LETTER_SIZE_PT);
            let outline = letter.placed([corner[0], corner[1] + LETTER_SIZE_PT], Anchor::Start);
            page.text(outline, Colour::INK, &letter.words);
        }
    }
    page
}

/// Intervals of the vertical axis, at most: at first, and when that leaves no room for the labels.
const MAX_INTERVALS: [u8; 2] = [6, 8];

/// The ticks of a chart: few, unless more of them, which fit the data more closely, let all labels stand
/// inside.
fn axes(chart: &Chart, cell: f64) -> Axes {
    let width = cell * 0.75;
    let [few, more] = MAX_INTERVALS.map(|most| Axes::new(chart, width, most));
    // About where the frame will be.
    let frame = Rect::at([0.0, 0.0], width, width * FRAME_ASPECT);
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
