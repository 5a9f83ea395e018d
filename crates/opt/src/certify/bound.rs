//! A lower bound over a box from multipliers.
//!
//! For any multipliers λ, at least 0 where a row is an inequality, every point of the box that meets all rows has
//! γ Σ_objectives λ ≥ Σ λ_r row_r(x). The sum is bounded in two ways, and the better one counts:
//!
//! ```text
//! natural:      Σ λ_r [row_r](box)
//! mean value:   F(c) + Σ_d G_d (x_d − c_d),   F = Σ λ_r row_r,   G = Σ λ_r [∇row_r](box)
//! ```
//! where c is the point of the box that makes the second greatest if F is taken as constant (Baumann 1988, BIT 28).
//! If no objective has a multiplier and the sum is positive, the box holds no feasible point.

use grouser_real::Interval;

use super::rows::Rows;
use crate::sqp::LinearKind;
use crate::tape::Enclosures;

/// Rows with their multipliers.
pub(super) type Weights = Vec<(usize, f64)>;

/// Memory for bounds, one per thread.
#[derive(Default)]
pub(super) struct Bounder {
    over: Enclosures,
    at: Enclosures,
    gradient: Vec<Interval>,
}

/// What the rows of a certificate are over a box.
struct Sum {
    natural: Interval,
    gradient: Option<Vec<Interval>>,
}

/// The lower bound of γ that the lower end of Σ λ row gives.
fn level(rows: &Rows, weights: &[(usize, f64)], low: f64) -> f64 {
    let share = weights
        .iter()
        .filter(|(row, _)| rows.list[*row].kind == LinearKind::Objective)
        .fold(Interval::ZERO, |sum, (_, w)| sum + Interval::point(*w));
    if share.high() > 0.0 {
        let level = (Interval::point(low) / share).low();
        if level.is_nan() {
            f64::NEG_INFINITY
        } else {
            level
        }
    } else if low > 0.0 {
        f64::INFINITY
    } else {
        f64::NEG_INFINITY
    }
}

/// The point from which the mean value form has the greatest lower end.
pub(super) fn centre(x: Interval, slope: Interval) -> f64 {
    let (low, high) = (slope.low(), slope.high());
    if low >= 0.0 || high.is_infinite() {
        x.low()
    } else if high <= 0.0 || low.is_infinite() {
        x.high()
    } else {
        let c = (x.high() * high - x.low() * low) / (high - low);
        if c.is_finite() {
            c.clamp(x.low(), x.high())
        } else {
            x.middle()
        }
    }
}

impl Bounder {
    fn sum(&mut self, rows: &Rows, weights: &[(usize, f64)], x: &[Interval]) -> Sum {
        let mut natural = Interval::ZERO;
        let mut total = vec![Interval::ZERO; x.len()];
        self.gradient.resize(x.len(), Interval::ZERO);
        let mut regular = true;
        for &(index, weight) in weights {
            let row = &rows.list[index];
            self.over.forward(&rows.tape, x, &row.needed, true);
            let weight = Interval::point(weight);
            natural += weight * self.over.values[row.node as usize];
            regular = regular
                && self
                    .over
                    .gradient(&rows.tape, &row.needed, &mut self.gradient);
            if regular {
                for (total, g) in total.iter_mut().zip(&self.gradient) {
                    *total += weight * *g;
                }
            }
        }
        Sum {
            natural,
            gradient: regular.then_some(total),
        }
    }

    /// Σ λ row at one point; empty where a row has no value.
    fn at(&mut self, rows: &Rows, weights: &[(usize, f64)], c: &[f64]) -> Interval {
        let point: Vec<Interval> = c.iter().map(|c| Interval::point(*c)).collect();
        let mut sum = Interval::ZERO;
        for &(index, weight) in weights {
            let row = &rows.list[index];
            self.at.forward(&rows.tape, &point, &row.needed, false);
            sum += Interval::point(weight) * self.at.values[row.node as usize];
        }
        sum
    }

    /// The lower bound of γ over a box; ∞ where the box holds no feasible point.
    pub(super) fn bound(&mut self, rows: &Rows, weights: &[(usize, f64)], x: &[Interval]) -> f64 {
        let sum = self.sum(rows, weights, x);
        if sum.natural.is_empty() {
            // a row has a value nowhere in the box
            return f64::INFINITY;
        }
        let mut low = sum.natural.low();
        if let Some(gradient) = sum.gradient {
            let c: Vec<f64> = x
                .iter()
                .zip(&gradient)
                .map(|(x, g)| centre(*x, *g))
                .collect();
            let form = x.iter().zip(&gradient).zip(&c).fold(
                self.at(rows, weights, &c),
                |sum, ((x, g), c)| {
                    // an unbounded slope times 0 is 0 only where the box is one point
                    sum + *g * (*x - Interval::point(*c))
                },
            );
            if form.low() > low {
                low = form.low();
            }
        }
        level(rows, weights, low)
    }
}
