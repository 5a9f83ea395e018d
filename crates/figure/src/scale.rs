//! From data to the page.

use super::geometry::{Point, Rect};

/// The map from an axis' range to the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    pub(super) frame: Rect,
}

impl Scale {
    /// Where a data point stands on the page; not finite when the point is not.
    pub(super) fn place(&self, [x, y]: Point) -> Point {
        let frame = &self.frame;
        [
            frame.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * frame.width(),
            frame.bottom - (y - self.y[0]) / (self.y[1] - self.y[0]) * frame.height(),
        ]
    }

    /// The pieces of a line on the page that lie in the frame or a little outside. What is not finite
    /// breaks the line.
    pub(super) fn pieces(&self, points: &[Point]) -> Vec<Vec<Point>> {
        let near = self.frame.grown(10.0);
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        for pair in points.windows(2) {
            let (from, to) = (self.place(pair[0]), self.place(pair[1]));
            if !(from.into_iter().chain(to).all(f64::is_finite)) {
                continue;
            }
            let Some([from, to]) = near.clipped(from, to) else {
                continue;
            };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&from) => piece.push(to),
                _ => pieces.push(vec![from, to]),
            }
        }
        pieces
    }

    /// An outline on the page; corners far outside the frame are brought nearer, so that no writer meets
    /// numbers beyond its range.
    pub(super) fn outline(&self, points: &[Point]) -> Vec<Point> {
        const MAX_COORDINATE_PT: f64 = 1e5;
        let placed = points.iter().map(|point| self.place(*point));
        placed
            .map(|[x, y]| {
                [
                    x.clamp(-MAX_COORDINATE_PT, MAX_COORDINATE_PT),
                    y.clamp(-MAX_COORDINATE_PT, MAX_COORDINATE_PT),
                ]
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_breaks_at_nan_and_is_cut_near_the_frame() {
        let frame = Rect::at([0.0, 0.0], 100.0, 100.0);
        let scale = Scale {
            x: [0.0, 1.0],
            y: [0.0, 1.0],
            frame,
        };
        let line = [
            [0.0, 0.5],
            [0.2, 0.5],
            [0.3, f64::NAN],
            [0.4, 0.5],
            [0.4, 1e300],
        ];
        let pieces = scale.pieces(&line);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0], [[0.0, 50.0], [20.0, 50.0]]);
        // Straight up, cut 10 points above the frame.
        assert!((pieces[1][1][1] + 10.0).abs() < 1e-9 && (pieces[1][1][0] - 40.0).abs() < 1e-9);
    }
}
