//! The points of the slip model: three quantities, each one number, a list or a range.

use crate::error::{Error, Result};
use crate::values::Values;

/// More points than this are a mistake.
const MAX_POINTS: usize = 1_000_000;

/// The quantities of the model, in the order of its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Theta,
    Sinkage,
    Radius,
}

/// What varies, and how.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axes {
    values: [Vec<f64>; 3],
    /// The quantity that was given as a range.
    pub(super) swept: Option<Quantity>,
}

impl Axes {
    /// All combinations; at most one quantity is a range, of `points` points.
    pub(super) fn new(
        theta: &Values,
        sinkage: &Values,
        radius: &Values,
        points: u32,
    ) -> Result<Self> {
        let quantities = [Quantity::Theta, Quantity::Sinkage, Quantity::Radius];
        let given = [theta, sinkage, radius];
        let ranges = || {
            quantities
                .into_iter()
                .zip(given)
                .filter(|(_, values)| matches!(values, Values::Range(_)))
                .map(|(quantity, _)| quantity)
        };
        if ranges().count() > 1 {
            return Err(Error::usage(
                "more than one of `--theta-deg`, `--sinkage-m` and `--radius-m` is a range",
                "give one as a range `from:to` and the others as numbers or lists `a,b,c`",
            ));
        }
        let axes = Self {
            values: given.map(|values| values.spread(points)),
            swept: ranges().next(),
        };
        let count = axes
            .values
            .iter()
            .map(Vec::len)
            .fold(1_usize, usize::saturating_mul);
        if count > MAX_POINTS {
            return Err(Error::usage_without_hint(format!(
                "the lists and `--points` make {count} points, but at most {MAX_POINTS} are possible"
            )));
        }
        Ok(axes)
    }

    /// (θ in degrees, sinkage, radius): the swept quantity runs fastest.
    pub(super) fn points(&self) -> impl Iterator<Item = [f64; 3]> {
        // The quantities from the slowest to the fastest.
        let order = match self.swept {
            Some(Quantity::Theta) => [1, 2, 0],
            Some(Quantity::Sinkage) => [0, 2, 1],
            Some(Quantity::Radius) | None => [0, 1, 2],
        };
        let lengths = order.map(|quantity| self.values[quantity].len());
        (0..lengths.iter().product()).map(move |index: usize| {
            let places = [
                index / lengths[2] / lengths[1],
                index / lengths[2] % lengths[1],
                index % lengths[2],
            ];
            let mut point = [0.0; 3];
            for (quantity, place) in order.into_iter().zip(places) {
                point[quantity] = self.values[quantity][place];
            }
            point
        })
    }

    /// Points of the swept quantity; 1 when nothing is swept.
    pub(super) fn run_length(&self) -> usize {
        self.swept
            .map_or(1, |quantity| self.values[quantity as usize].len())
    }

    /// Does a quantity take several values without being swept?
    pub(super) fn varies(&self, quantity: Quantity) -> bool {
        self.swept != Some(quantity) && self.values[quantity as usize].len() > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_runs_fastest() {
        let [theta, z, r] = ["0:10", "1,2", "5"].map(|text| text.parse::<Values>().unwrap());
        let axes = Axes::new(&theta, &z, &r, 2).unwrap();
        let points: Vec<_> = axes.points().collect();
        assert_eq!(
            points,
            [[0., 1., 5.], [10., 1., 5.], [0., 2., 5.], [10., 2., 5.]]
        );
        assert!(axes.varies(Quantity::Sinkage) && !axes.varies(Quantity::Radius));
    }
}
