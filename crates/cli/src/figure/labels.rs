//! The labels of a panel: set, placed, and drawn.

use super::geometry::{Point, Rect};
use super::page::Page;
use super::path::Path;
use super::place::{self, Obstacles, Placed, Target, Wanted};
use super::style::{Colour, Dash, Style};
use super::text::{Anchor, Line};

/// The size of labels in points.
pub(super) const LABEL_SIZE: f64 = 9.5;
/// Between the frame and a label that stands outside.
const OUTSIDE: f64 = 12.0;
/// Between the baselines of two labels outside.
const LEADING: f64 = 11.5;

/// One label and what it names.
#[derive(Clone, Debug)]
pub(super) struct Label {
    line: Line,
    colour: Colour,
    target: Target,
    /// Where what it names ends on the right: labels outside the frame stand at this height.
    end: Point,
}

impl Label {
    pub(super) fn new(markup: &str, colour: Colour, target: Target, end: Point) -> Self {
        let line = Line::set(markup, LABEL_SIZE);
        Self {
            line,
            colour,
            target,
            end,
        }
    }
}

/// Where the labels of a panel stand.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Arrangement {
    /// Inside the frame, in the order of the labels.
    Inside(Vec<Placed>),
    /// To the right of the frame, at the ends of what they name: there was no room inside.
    Outside,
}

/// Looks for a place for each label inside the frame.
pub(super) fn arrange(labels: &[Label], frame: Rect, obstacles: &Obstacles) -> Arrangement {
    let wanted: Vec<Wanted> = labels
        .iter()
        .map(|label| Wanted {
            target: label.target,
            width: label.line.ink.width(),
            height: label.line.ink.height(),
        })
        .collect();
    place::place(frame, obstacles, &wanted).map_or(Arrangement::Outside, Arrangement::Inside)
}

/// How much room the labels need on the right of the frame.
pub(super) fn width_outside(labels: &[Label]) -> f64 {
    let widest = labels
        .iter()
        .map(|label| label.line.width)
        .fold(0.0, f64::max);
    OUTSIDE + widest + 2.0
}

/// Draws the labels as arranged.
pub(super) fn draw(page: &mut Page, labels: &[Label], arrangement: &Arrangement, frame: &Rect) {
    match arrangement {
        Arrangement::Inside(placed) => {
            for (label, placed) in labels.iter().zip(placed) {
                if let Some(leader) = placed.leader {
                    page.stroke(Path::line(leader), leader_style(label.colour), None);
                }
                let ink = &label.line.ink;
                let origin = [placed.rect.left - ink.left, placed.rect.top - ink.top];
                let outline = label.line.placed(origin, Anchor::Start);
                page.text(outline, label.colour, &label.line.words);
            }
        }
        Arrangement::Outside => draw_outside(page, labels, frame),
    }
}

fn draw_outside(page: &mut Page, labels: &[Label], frame: &Rect) {
    let mut order: Vec<&Label> = labels.iter().collect();
    order.sort_by(|a, b| a.end[1].total_cmp(&b.end[1]));
    let wanted: Vec<f64> = order.iter().map(|label| label.end[1]).collect();
    for (label, y) in order.into_iter().zip(spread(&wanted, LEADING, frame)) {
        let x = frame.right + OUTSIDE;
        let from = [frame.right.min(label.end[0]) + 1.5, label.end[1]];
        let leader = [from, [x - 2.0, y]];
        page.stroke(Path::line(leader), leader_style(label.colour), None);
        // Half the height of a small letter below the middle.
        let outline = label.line.placed([x, y + 0.23 * LABEL_SIZE], Anchor::Start);
        page.text(outline, label.colour, &label.line.words);
    }
}

/// Heights as near to the `wanted` ones (ascending) as a distance of `leading` between them allows.
fn spread(wanted: &[f64], leading: f64, frame: &Rect) -> Vec<f64> {
    // Pools of labels that have been pushed together, each at the mean of what its labels want.
    let mut pools: Vec<(f64, usize)> = Vec::new(); // (sum of wanted tops, labels)
    let top = |(sum, count): (f64, usize)| sum / count as f64;
    for y in wanted {
        let mut pool = (y.clamp(frame.top, frame.bottom), 1);
        while let Some(previous) = pools.pop() {
            let previous_end = top(previous) + leading * previous.1 as f64;
            if previous_end <= top(pool) {
                pools.push(previous);
                break;
            }
            // Seen from the top of the joined pool, the later labels want to stand higher.
            let shift = leading * (previous.1 * pool.1) as f64;
            pool = (previous.0 + pool.0 - shift, previous.1 + pool.1);
        }
        pools.push(pool);
    }
    let mut heights = Vec::with_capacity(wanted.len());
    for pool in pools {
        let start = top(pool);
        heights.extend((0..pool.1).map(|i| start + leading * i as f64));
    }
    heights
}

fn leader_style(colour: Colour) -> Style {
    Style {
        width: 0.5,
        ..Style::thin(colour, Dash::Solid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_outside_keep_their_distance() {
        let frame = Rect::at([0.0, 0.0], 100.0, 100.0);
        assert_eq!(spread(&[10.0, 50.0], 11.0, &frame), [10.0, 50.0]);
        // Three that want the same height stand around it.
        assert_eq!(
            spread(&[50.0, 50.0, 50.0], 10.0, &frame),
            [40.0, 50.0, 60.0]
        );
        let crowded = spread(&[48.0, 50.0, 51.0, 90.0], 10.0, &frame);
        assert!(
            crowded
                .windows(2)
                .all(|pair| pair[1] - pair[0] >= 10.0 - 1e-12),
            "{crowded:?}"
        );
    }
}
