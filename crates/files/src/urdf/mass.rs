//! Masses gathered into one.

use super::frame::{Frame, Matrix, Vector, add, dot, scaled};

/// kg, m, kg m² about its own centre, all in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Mass {
    pub(super) kilograms: f64,
    pub(super) centre: Vector,
    pub(super) inertia: Matrix,
}

impl Mass {
    /// Of a link whose frame is `frame`.
    pub(super) fn seen_from(&self, frame: &Frame) -> Self {
        Self {
            kilograms: self.kilograms,
            centre: frame.point(self.centre),
            inertia: frame.tensor(&self.inertia),
        }
    }

    /// Both as one body: Steiner's theorem.
    pub(super) fn with(&self, other: &Self) -> Self {
        let kilograms = self.kilograms + other.kilograms;
        if !(kilograms > 0.0) {
            return *self;
        }
        let moment = add(
            scaled(self.centre, self.kilograms),
            scaled(other.centre, other.kilograms),
        );
        let centre = scaled(moment, 1.0 / kilograms);
        let mut inertia = [[0.0; 3]; 3];
        for part in [self, other] {
            let arm = add(part.centre, scaled(centre, -1.0));
            let square = dot(arm, arm);
            for (i, row) in inertia.iter_mut().enumerate() {
                for (j, value) in row.iter_mut().enumerate() {
                    let own = if i == j { square } else { 0.0 };
                    *value += part.inertia[i][j] + part.kilograms * (own - arm[i] * arm[j]);
                }
            }
        }
        Self {
            kilograms,
            centre,
            inertia,
        }
    }

    /// About an axis through its centre, kg m².
    pub(super) fn about(&self, axis: Vector) -> f64 {
        dot(axis, self.inertia.map(|row| dot(row, axis)))
    }

    /// The maximum of its products of inertia over the minimum of its moments: a robot file has no products.
    pub(super) fn skewness(&self) -> f64 {
        let i = &self.inertia;
        let product = i[0][1].abs().max(i[0][2].abs()).max(i[1][2].abs());
        let least = i[0][0].min(i[1][1]).min(i[2][2]);
        if least > 0.0 { product / least } else { 0.0 }
    }
}
