//! Outlines on the page.

use super::geometry::{Point, Rect};

/// One step of an outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    Move(Point),
    Line(Point),
    /// A quadratic Bézier curve: its control point and its end.
    Curve(Point, Point),
    Close,
}

/// An outline: lines and curves, open or closed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path(pub(super) Vec<Step>);

impl Path {
    /// The open line through `points`.
    pub(super) fn line(points: impl IntoIterator<Item = Point>) -> Self {
        let steps = points.into_iter().enumerate();
        Self(
            steps
                .map(|(i, point)| {
                    if i == 0 {
                        Step::Move(point)
                    } else {
                        Step::Line(point)
                    }
                })
                .collect(),
        )
    }

    /// The closed outline through `points`.
    pub(super) fn polygon(points: impl IntoIterator<Item = Point>) -> Self {
        let mut path = Self::line(points);
        path.0.push(Step::Close);
        path
    }

    pub(super) fn rect(rect: &Rect) -> Self {
        Self::polygon([
            [rect.left, rect.top],
            [rect.right, rect.top],
            [rect.right, rect.bottom],
            [rect.left, rect.bottom],
        ])
    }

    /// A circle, of 16 curves: off by less than 10⁻⁵ of its radius.
    pub(super) fn circle(centre: Point, radius: f64) -> Self {
        const ARCS: u8 = 16;
        let step = std::f64::consts::TAU / f64::from(ARCS);
        let outer = radius / (step / 2.0).cos();
        let at = |angle: f64, radius: f64| {
            [
                centre[0] + radius * angle.cos(),
                centre[1] + radius * angle.sin(),
            ]
        };
        let mut steps = vec![Step::Move(at(0.0, radius))];
        steps.extend((1..=ARCS).map(|i| {
            let end = f64::from(i) * step;
            Step::Curve(at(end - step / 2.0, outer), at(end, radius))
        }));
        steps.push(Step::Close);
        Self(steps)
    }

    /// Appends another outline.
    pub(super) fn append(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
    }

    /// The outline with each point sent through `map`.
    pub(super) fn mapped(&self, map: impl Fn(Point) -> Point) -> Self {
        let step = |step: &Step| match *step {
            Step::Move(point) => Step::Move(map(point)),
            Step::Line(point) => Step::Line(map(point)),
            Step::Curve(control, point) => Step::Curve(map(control), map(point)),
            Step::Close => Step::Close,
        };
        Self(self.0.iter().map(step).collect())
    }

    pub(super) fn moved(&self, by: Point) -> Self {
        self.mapped(|point| [point[0] + by[0], point[1] + by[1]])
    }

    /// The box around all points (control points included); `None` for an empty outline.
    pub(super) fn bounds(&self) -> Option<Rect> {
        let points = self.0.iter().flat_map(|step| match *step {
            Step::Move(point) | Step::Line(point) => vec![point],
            Step::Curve(control, point) => vec![control, point],
            Step::Close => Vec::new(),
        });
        points.fold(None, |bounds: Option<Rect>, [x, y]| {
            Some(bounds.map_or(
                Rect {
                    left: x,
                    top: y,
                    right: x,
                    bottom: y,
                },
                |b| Rect {
                    left: b.left.min(x),
                    top: b.top.min(y),
                    right: b.right.max(x),
                    bottom: b.bottom.max(y),
                },
            ))
        })
    }
}
