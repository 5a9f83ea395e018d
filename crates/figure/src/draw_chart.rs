//! Draws a chart.

use super::chart::{Area, AreaShape, Axis, Chart, Measured, Points};
use super::geometry::{Point, Rect};
use super::labels::{self, Label};
use super::page::Page;
use super::path::Path;
use super::place::{Obstacles, Target};
use super::scale::Scale;
use super::sizes::{TICK_GAP_PT, TICK_SIZE_PT, TITLE_GAP_PT, TITLE_SIZE_PT};
use super::style::{Colour, Dash, Marker, Style};
use super::text::{Anchor, Line};
use super::thin::thin;
use super::ticks::{Ticks, Widen, ticks};

/// Length of a tick.
const TICK_PT: f64 = 3.6;
/// Width of the frame's line.
const FRAME_WIDTH_PT: f64 = 0.8;
/// Radius of a marker.
const MARKER_PT: f64 = 2.3;
/// Columns in which a line is thinned: a twelfth of a millimetre.
const COLUMN_PT: f64 = 0.24;

/// The ticks of both axes of a chart.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    x: Ticks,
    y: Ticks,
}

impl Axes {
    /// Ticks for a frame of about `width` points, at most `max_y` intervals up.
    pub(super) fn new(chart: &Chart, width: f64, max_y: u8) -> Self {
        let all = data(chart);
        let x_range = chart
            .x
            .range
            .unwrap_or_else(|| extent(all.iter().map(|point| point[0])));
        let seen = |point: &&Point| {
            chart
                .x
                .range
                .is_none_or(|[a, b]| point[0] >= a.min(b) && point[0] <= a.max(b))
        };
        let y_range = chart
            .y
            .range
            .unwrap_or_else(|| extent(all.iter().filter(seen).map(|point| point[1])));
        // Fewer ticks until their labels stand well apart.
        let fits = |ticks: &Ticks| {
            let widths = ticks
                .marks
                .iter()
                .map(|(_, label)| Line::set(label, TICK_SIZE_PT).width + 9.0);
            widths.sum::<f64>() <= width
        };
        let x = (2..=6)
            .rev()
            .map(|most| ticks(x_range, free(chart.x.range, Widen::ToTicks), most))
            .find(fits)
            .unwrap_or_else(|| ticks(x_range, free(chart.x.range, Widen::ToTicks), 1));
        let y = ticks(y_range, free(chart.y.range, Widen::ToTicksWithRoom), max_y);
        Self { x, y }
    }

    pub(super) fn widest_y_label(&self) -> f64 {
        let labels = self
            .y
            .marks
            .iter()
            .map(|(_, label)| Line::set(label, TICK_SIZE_PT).width);
        labels.fold(0.0, f64::max)
    }
}

/// A range that was given stays as it is.
fn free(given: Option<[f64; 2]>, widen: Widen) -> Widen {
    if given.is_some() { Widen::No } else { widen }
}

/// All points that the axes must show.
fn data(chart: &Chart) -> Vec<Point> {
    let mut all: Vec<Point> = Vec::new();
    for curve in &chart.curves {
        all.extend(&curve.points);
    }
    for area in &chart.areas {
        if let AreaShape::Polygon(outline) = &area.shape {
            all.extend(outline);
        }
    }
    for Measured {
        at,
        x_error,
        y_error,
    } in chart.points.iter().flat_map(|set| &set.measured)
    {
        all.push([at[0] - x_error[0], at[1] - y_error[0]]);
        all.push([at[0] + x_error[1], at[1] + y_error[1]]);
    }
    all.extend(chart.marks.iter().map(|mark| mark.at));
    all.retain(|[x, y]| x.is_finite() && y.is_finite());
    all
}

fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    });
    if low <= high { [low, high] } else { [0.0, 1.0] }
}

/// Draws the chart with its frame at `frame`; gives the room that labels take on the right of it.
pub(super) fn draw(page: &mut Page, chart: &Chart, axes: &Axes, frame: Rect) -> f64 {
    let scale = Scale {
        x: axes.x.range,
        y: axes.y.range,
        frame,
    };
    let mut content = Content {
        page,
        scale,
        obstacles: Obstacles::default(),
        labels: Vec::new(),
    };
    for area in &chart.areas {
        content.area(area);
    }
    if axes.y.range[0] < 0.0 && axes.y.range[1] > 0.0 {
        content.line(&zero_line(&scale), Style::thin(Colour::GREY, Dash::Dotted));
    }
    for rule in &chart.rules {
        let ends = if rule.vertical {
            [[rule.at, scale.y[0]], [rule.at, scale.y[1]]]
        } else {
            [[scale.x[0], rule.at], [scale.x[1], rule.at]]
        };
        let drawn = content.line(&ends, rule.style);
        if let (Some(label), Some((target, end))) = (&rule.label, drawn) {
            content
                .labels
                .push(Label::new(label, rule.style.colour, target, end));
        }
    }
    for curve in &chart.curves {
        let drawn = content.line(&curve.points, curve.style);
        if let (Some(label), Some((target, end))) = (&curve.label, drawn) {
            content
                .labels
                .push(Label::of_curve(label, curve.style.colour, target, end));
        }
    }
    for set in &chart.points {
        content.points(set);
    }
    for mark in &chart.marks {
        let set = Points::new([mark.at]).look(mark.marker, mark.colour);
        content.points(&Points {
            label: mark.label.clone(),
            ..set
        });
    }
    let Content {
        obstacles, labels, ..
    } = content;
    draw_axes(page, chart, axes, &scale);
    let arrangement = labels::arrange(&labels, frame.grown(-TICK_PT), &obstacles);
    labels::draw(page, &labels, &arrangement, &frame);
    labels::width_outside(&labels, &arrangement)
}

fn zero_line(scale: &Scale) -> [Point; 2] {
    [[scale.x[0], 0.0], [scale.x[1], 0.0]]
}

struct Content<'a> {
    page: &'a mut Page,
    scale: Scale,
    obstacles: Obstacles,
    labels: Vec<Label>,
}

impl Content<'_> {
    fn area(&mut self, area: &Area) {
        let [low, high] = self.scale.y;
        let outline = match &area.shape {
            AreaShape::Polygon(outline) => outline.clone(),
            AreaShape::Columns([from, to]) => {
                vec![[*from, low], [*to, low], [*to, high], [*from, high]]
            }
        };
        let path = Path::polygon(self.scale.outline(&outline));
        self.page
            .fill(path, area.colour, area.opacity, Some(self.scale.frame));
    }

    /// Draws a line; gives what a label of it names (its longest piece) and where it ends.
    fn line(&mut self, points: &[Point], style: Style) -> Option<(Target, Point)> {
        let pieces = self.scale.pieces(points);
        let pieces: Vec<Vec<Point>> = pieces.iter().map(|piece| thin(piece, COLUMN_PT)).collect();
        let longest = (0..pieces.len()).max_by_key(|index| pieces[*index].len())?;
        let target = Target::Line(self.obstacles.lines.len() + longest);
        let end = pieces.last()?.last().copied()?;
        let mut path = Path::default();
        for piece in pieces {
            path.append(&Path::line(piece.iter().copied()));
            self.obstacles.lines.push((piece, style.width / 2.0));
        }
        self.page.stroke(path, style, Some(self.scale.frame));
        Some((target, end))
    }

    fn points(&mut self, set: &Points) {
        let bar = Style::thin(set.colour, Dash::Solid);
        let mut last: Option<Point> = None;
        for Measured {
            at,
            x_error,
            y_error,
        } in &set.measured
        {
            let centre = self.scale.place(*at);
            if !(self.scale.frame.grown(0.5).distance(centre) <= 0.0) {
                continue; // outside, or not a number
            }
            for (axis, error) in [x_error, y_error].into_iter().enumerate() {
                let end = |sign: f64, reach: f64| {
                    let mut end = *at;
                    end[axis] += sign * reach;
                    end
                };
                if error.iter().any(|reach| *reach > 0.0) {
                    let ends = [end(-1.0, error[0]), end(1.0, error[1])];
                    for piece in self.scale.pieces(&ends) {
                        self.page.stroke(
                            Path::line(piece.iter().copied()),
                            bar,
                            Some(self.scale.frame),
                        );
                        self.obstacles.lines.push((piece, bar.width / 2.0));
                    }
                }
            }
            self.marker(set.marker, centre, set.colour);
            let square = [centre[0] - MARKER_PT, centre[1] - MARKER_PT];
            self.obstacles
                .boxes
                .push(Rect::at(square, 2.0 * MARKER_PT, 2.0 * MARKER_PT));
            if last.is_none_or(|last| centre[0] >= last[0]) {
                last = Some(centre);
            }
        }
        if let (Some(label), Some(end)) = (&set.label, last) {
            let target = Target::Spot(end, MARKER_PT);
            self.labels.push(Label::new(label, set.colour, target, end));
        }
    }

    fn marker(&mut self, marker: Marker, [x, y]: Point, colour: Colour) {
        let corners = |corners: &[Point]| {
            Path::polygon(
                corners
                    .iter()
                    .map(|[dx, dy]| [x + MARKER_PT * dx, y + MARKER_PT * dy]),
            )
        };
        let shape = match marker {
            Marker::Disc | Marker::Circle => Path::circle([x, y], MARKER_PT),
            Marker::Square => corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            Marker::Triangle => corners(&[[0.0, -1.15], [1.05, 0.75], [-1.05, 0.75]]),
            Marker::Diamond => corners(&[[0.0, -1.25], [1.1, 0.0], [0.0, 1.25], [-1.1, 0.0]]),
        };
        if marker == Marker::Disc {
            self.page.fill(shape, colour, 1.0, None);
        } else {
            // White inside: the curve behind does not cross the marker.
            self.page
                .fill(shape.clone(), Colour(255, 255, 255), 1.0, None);
            self.page.stroke(
                shape,
                Style {
                    width: 0.8,
                    ..Style::thin(colour, Dash::Solid)
                },
                None,
            );
        }
    }
}

fn draw_axes(page: &mut Page, chart: &Chart, axes: &Axes, scale: &Scale) {
    let frame = scale.frame;
    let ink = |width| Style {
        width,
        ..Style::thin(Colour::INK, Dash::Solid)
    };
    let mut marks = Path::default();
    let below = frame.bottom + TICK_GAP_PT + 0.66 * TICK_SIZE_PT;
    for (value, label) in &axes.x.marks {
        let [x, _] = scale.place([*value, 0.0]);
        marks.append(&Path::line([
            [x, frame.bottom],
            [x, frame.bottom - TICK_PT],
        ]));
        marks.append(&Path::line([[x, frame.top], [x, frame.top + TICK_PT]]));
        write(page, label, TICK_SIZE_PT, [x, below], Anchor::Middle);
    }
    for (value, label) in &axes.y.marks {
        let [_, y] = scale.place([0.0, *value]);
        marks.append(&Path::line([[frame.left, y], [frame.left + TICK_PT, y]]));
        marks.append(&Path::line([[frame.right, y], [frame.right - TICK_PT, y]]));
        let at = [frame.left - TICK_GAP_PT, y + 0.33 * TICK_SIZE_PT];
        write(page, label, TICK_SIZE_PT, at, Anchor::End);
    }
    page.stroke(marks, ink(0.6), None);
    page.stroke(Path::rect(&frame), ink(FRAME_WIDTH_PT), None);
    if axes.x.power != 0 {
        let at = [frame.right, below + TITLE_GAP_PT + TITLE_SIZE_PT];
        write(page, &power(axes.x.power), TICK_SIZE_PT, at, Anchor::End);
    }
    if axes.y.power != 0 {
        write(
            page,
            &power(axes.y.power),
            TICK_SIZE_PT,
            [frame.left, frame.top - 4.0],
            Anchor::Start,
        );
    }
    let [x, y] = frame.centre();
    write(
        page,
        title(&chart.x),
        TITLE_SIZE_PT,
        [x, below + TITLE_GAP_PT + TITLE_SIZE_PT],
        Anchor::Middle,
    );
    let line = Line::set(title(&chart.y), TITLE_SIZE_PT);
    let left = frame.left - TICK_GAP_PT - axes.widest_y_label() - TITLE_GAP_PT;
    let outline = line.placed_upwards([left, y], Anchor::Middle);
    page.text(outline, Colour::INK, &line.words);
}

fn title(axis: &Axis) -> &str {
    &axis.title
}

/// What tick labels are to be multiplied with.
fn power(power: i32) -> String {
    format!("×10^{{{}}}", power.to_string().replace('-', "−"))
}

fn write(page: &mut Page, markup: &str, size: f64, at: Point, anchor: Anchor) {
    let line = Line::set(markup, size);
    page.text(line.placed(at, anchor), Colour::INK, &line.words);
}
