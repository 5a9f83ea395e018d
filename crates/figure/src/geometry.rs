//! Points, boxes and distances on the page, in points (1/72 inch), y downwards.

/// A place on the page.
pub(super) type Point = [f64; 2];

/// A box on the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rect {
    /// The box at `corner` (left, top).
    pub(super) fn at(corner: Point, width: f64, height: f64) -> Self {
        Self {
            left: corner[0],
            top: corner[1],
            right: corner[0] + width,
            bottom: corner[1] + height,
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn centre(&self) -> Point {
        [
            f64::midpoint(self.left, self.right),
            f64::midpoint(self.top, self.bottom),
        ]
    }

    /// The box grown by `margin` on every side.
    pub(super) fn grown(&self, margin: f64) -> Self {
        Self {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    pub(super) fn contains(&self, inner: &Self) -> bool {
        self.left <= inner.left
            && inner.right <= self.right
            && self.top <= inner.top
            && inner.bottom <= self.bottom
    }

    /// The point of the box nearest to `point`.
    pub(super) fn nearest(&self, point: Point) -> Point {
        [
            point[0].clamp(self.left, self.right),
            point[1].clamp(self.top, self.bottom),
        ]
    }

    /// How far `point` lies outside; 0 inside.
    pub(super) fn distance(&self, point: Point) -> f64 {
        self.square_distance(point).sqrt()
    }

    /// Its square.
    fn square_distance(&self, point: Point) -> f64 {
        square_distance(point, self.nearest(point))
    }

    /// How far the segment stays away; 0 where it enters.
    pub(super) fn distance_to_segment(&self, from: Point, to: Point) -> f64 {
        if self.is_crossed(from, to) {
            return 0.0;
        }
        let corners = [
            [self.left, self.top],
            [self.right, self.top],
            [self.right, self.bottom],
            [self.left, self.bottom],
        ];
        // Two convex sets that do not meet are nearest at a corner of one of them.
        corners
            .into_iter()
            .map(|corner| square_distance(corner, nearest_on_segment(corner, from, to)))
            .fold(
                self.square_distance(from).min(self.square_distance(to)),
                f64::min,
            )
            .sqrt()
    }

    /// Does the segment enter the box?
    fn is_crossed(&self, from: Point, to: Point) -> bool {
        self.clipped(from, to).is_some()
    }

    /// The part of a segment inside the box (Liang and Barsky's clipping).
    pub(super) fn clipped(&self, from: Point, to: Point) -> Option<[Point; 2]> {
        let step = [to[0] - from[0], to[1] - from[1]];
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (slope, room) in [
            (-step[0], from[0] - self.left),
            (step[0], self.right - from[0]),
            (-step[1], from[1] - self.top),
            (step[1], self.bottom - from[1]),
        ] {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                enter = enter.max(room / slope);
            } else {
                leave = leave.min(room / slope);
            }
        }
        let at = |share: f64| match share {
            0.0 => from,
            1.0 => to,
            _ => [from[0] + share * step[0], from[1] + share * step[1]],
        };
        (enter <= leave).then(|| [at(enter), at(leave)])
    }
}

/// Between two points.
pub(super) fn distance(a: Point, b: Point) -> f64 {
    square_distance(a, b).sqrt()
}

/// Its square, for comparisons: no root. Lengths on a page neither overflow nor vanish.
fn square_distance(a: Point, b: Point) -> f64 {
    let [x, y] = [a[0] - b[0], a[1] - b[1]];
    x * x + y * y
}

/// The point of a segment nearest to `point`.
pub(super) fn nearest_on_segment(point: Point, from: Point, to: Point) -> Point {
    let along = [to[0] - from[0], to[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    if square == 0.0 {
        return from;
    }
    let share = ((point[0] - from[0]) * along[0] + (point[1] - from[1]) * along[1]) / square;
    let share = share.clamp(0.0, 1.0);
    [from[0] + share * along[0], from[1] + share * along[1]]
}

/// Do two segments come nearer than half a point?
pub(super) fn cross(a: Point, b: Point, c: Point, d: Point) -> bool {
    const NEAR_PT: f64 = 0.5;
    let side = |from: Point, to: Point, point: Point| {
        (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0])
    };
    let parted = side(a, b, c) * side(a, b, d) > 0.0 || side(c, d, a) * side(c, d, b) > 0.0;
    // most pairs are far from each other, which needs no nearest point; a hair more than the limit, for rounding
    let far = |axis: usize| {
        let room = NEAR_PT + 1e-6;
        a[axis].max(b[axis]) + room < c[axis].min(d[axis])
            || c[axis].max(d[axis]) + room < a[axis].min(b[axis])
    };
    let near = |point: Point, from: Point, to: Point| {
        square_distance(point, nearest_on_segment(point, from, to)) < NEAR_PT * NEAR_PT
    };
    !parted
        || !(far(0) || far(1)) && (near(a, c, d) || near(b, c, d) || near(c, a, b) || near(d, a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_through_a_box_has_no_distance_to_it() {
        let square = Rect::at([0.0, 0.0], 2.0, 2.0);
        assert_eq!(square.distance_to_segment([-1.0, 1.0], [3.0, 1.0]), 0.0);
        assert_eq!(square.distance_to_segment([0.5, 0.5], [0.6, 0.5]), 0.0);
        // Cuts the corner at (2, 0) by √2/2: the line x − y = 3 against the corner (2, 0).
        let cut = square.distance_to_segment([2.0, -1.0], [4.0, 1.0]);
        assert!((cut - 0.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(square.distance_to_segment([5.0, 0.0], [5.0, 9.0]), 3.0);
    }

    #[test]
    fn segments_cross_where_they_come_nearer_than_half_a_point() {
        let (a, b) = ([0.0, 0.0], [10.0, 0.0]);
        for ([x, y], crosses) in [
            ([5.0, 0.49], true),
            ([5.0, 0.51], false),
            ([10.49, 0.0], true),
            // past both ends of the box by less than the limit, and by more along the diagonal
            ([10.3, 0.3], true),
            ([10.4, 0.4], false),
            ([40.0, 40.0], false),
        ] {
            // upwards from that point, and the same in the other order
            let (c, d) = ([x, y], [x, y + 20.0]);
            assert_eq!(cross(a, b, c, d), crosses, "{c:?}");
            assert_eq!(cross(d, c, b, a), crosses, "{c:?}");
        }
        assert!(cross(a, b, [5.0, -1.0], [5.0, 1.0]));
    }
}
