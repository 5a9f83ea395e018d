//! The labels of a panel: set, placed, and drawn.

use super::choose::Placed;
use super::geometry::{Point, Rect};
use super::page::Page;
use super::path::Path;
use super::place::{self, Obstacles, Target, Wanted};
use super::style::{Colour, Dash, Style};
use super::text::{Anchor, Line};

/// The size of labels in points.
pub(super) const LABEL_SIZE_PT: f64 = 9.5;
/// Between the frame and a label that stands outside.
const OUTSIDE_PT: f64 = 12.0;
/// Between the baselines of two labels outside.
const LEADING_PT: f64 = 11.5;

/// One label and what it names.
#[derive(Clone, Debug)]
pub(super) struct Label {
    line: Line,
    colour: Colour,
    target: Target,
    /// Where what it names ends on the right: labels outside the frame stand at this height.
    end: Point,
    /// A curve's label may stand outside, at its end; a mark's had better not.
    may_leave: bool,
}

impl Label {
    pub(super) fn new(markup: &str, colour: Colour, target: Target, end: Point) -> Self {
        let line = Line::set(markup, LABEL_SIZE_PT);
        Self {
            line,
            colour,
            target,
            end,
            may_leave: false,
        }
    }

    /// The label of a curve.
    pub(super) fn of_curve(markup: &str, colour: Colour, target: Target, end: Point) -> Self {
        Self {
            may_leave: true,
            ..Self::new(markup, colour, target, end)
        }
    }

    fn wanted(&self) -> Wanted {
        Wanted {
            target: self.target,
            width: self.line.ink.width(),
            height: self.line.ink.height(),
        }
    }
}

/// Where the labels of a panel stand: inside the frame, or (`None`) to the right of it, at the end of
/// what they name, where there was no room inside.
pub(super) type Arrangement = Vec<Option<Placed>>;

/// Looks for a place for each label inside the frame. When there is none for all, those that `may_leave`
/// go outside together; when that is not enough, all do.
pub(super) fn arrange(labels: &[Label], frame: Rect, obstacles: &Obstacles) -> Arrangement {
    let inside = |stays: &dyn Fn(&Label) -> bool| {
        let wanted: Vec<Wanted> = labels
            .iter()
            .filter(|label| stays(label))
            .map(Label::wanted)
            .collect();
        let mut placed = place::place(frame, obstacles, &wanted)?.into_iter();
        let take = |label| if stays(label) { placed.next() } else { None };
        Some(labels.iter().map(take).collect())
    };
    inside(&|_| true)
        .or_else(|| inside(&|label| !label.may_leave))
        .unwrap_or_else(|| vec![None; labels.len()])
}

/// How much room the labels take on the right of the frame.
pub(super) fn width_outside(labels: &[Label], arrangement: &Arrangement) -> f64 {
    let outside = labels
        .iter()
        .zip(arrangement)
        .filter(|(_, placed)| placed.is_none());
    let widths = outside.map(|(label, _)| OUTSIDE_PT + label.line.width + 2.0);
    widths.fold(0.0, f64::max)
}

/// Draws the labels as arranged.
pub(super) fn draw(page: &mut Page, labels: &[Label], arrangement: &Arrangement, frame: &Rect) {
    let mut outside = Vec::new();
    for (label, placed) in labels.iter().zip(arrangement) {
        let Some(placed) = placed else {
            outside.push(label);
            continue;
        };
        if let Some(leader) = placed.leader {
            page.stroke(Path::line(leader), leader_style(label.colour), None);
        }
        let ink = &label.line.ink;
        let origin = [placed.rect.left - ink.left, placed.rect.top - ink.top];
        page.text(
            label.line.placed(origin, Anchor::Start),
            label.colour,
            &label.line.words,
        );
    }
    draw_outside(page, outside, frame);
}

fn draw_outside(page: &mut Page, mut order: Vec<&Label>, frame: &Rect) {
    order.sort_by(|a, b| a.end[1].total_cmp(&b.end[1]));
    let wanted: Vec<f64> = order.iter().map(|label| label.end[1]).collect();
    for (label, y) in order.into_iter().zip(spread(&wanted, LEADING_PT, frame)) {
        let x = frame.right + OUTSIDE_PT;
        let from = [frame.right.min(label.end[0]) + 1.5, label.end[1]];
        let leader = [from, [x - 2.0, y]];
        page.stroke(Path::line(leader), leader_style(label.colour), None);
        // Half the height of a small letter below the middle.
        let outline = label
            .line
            .placed([x, y + 0.23 * LABEL_SIZE_PT], Anchor::Start);
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
