//! A prior over one variable, between points linear.

use alloc::{boxed::Box, vec::Vec};

use crate::filter::SlipPrior;

/// Points at rising places. Where the model gave nothing there is no point.
#[derive(Clone, Debug)]
pub(super) struct Table {
    points: Box<[(f64, SlipPrior)]>,
}

impl Table {
    pub(super) fn new(points: impl Iterator<Item = (f64, Option<SlipPrior>)>) -> Self {
        let points: Vec<_> = points
            .filter_map(|(place, prior)| prior.map(|prior| (place, prior)))
            .collect();
        Self {
            points: points.into_boxed_slice(),
        }
    }

    /// The points, at rising places.
    pub(super) fn points(&self) -> &[(f64, SlipPrior)] {
        &self.points
    }

    /// The prior at a place; `None` outside the table, and for NaN.
    pub(super) fn at(&self, place: f64) -> Option<SlipPrior> {
        let first = self.points.first()?;
        if !(place >= first.0) {
            return None;
        }
        let mut last = first;
        for point in &self.points {
            if place <= point.0 {
                let step = point.0 - last.0;
                let share = if step > 0.0 {
                    (place - last.0) / step
                } else {
                    0.0
                };
                let between = |a: f64, b: f64| a + share * (b - a);
                return Some(SlipPrior {
                    mean: between(last.1.mean, point.1.mean),
                    sigma: between(last.1.sigma, point.1.sigma),
                });
            }
            last = point;
        }
        None
    }
}
