//! Profile-likelihood intervals: how far a parameter can go while the others make the best of it.

use grouser_opt::{Jacobian, Model};
use grouser_real::Real;

use super::fit::Fit;
use super::marquardt::{Settings, fit};
use super::student::student_quantile;
use super::{Bounded, Uncertainty};
use crate::error::Result;

/// An interval; an end is `None` where the bounds are reached before the data object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: Option<f64>,
    /// The upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// Its ends `factor` times as far from `value`.
    pub(crate) fn widened(self, value: f64, factor: f64) -> Self {
        let wide = |end: f64| value + factor * (end - value);
        Self {
            low: self.low.map(wide),
            high: self.high.map(wide),
        }
    }

    /// Its ends about `value` with an independent half width `added` to each: roots of sums of squares. An end that meets
    /// `bound` is none.
    pub(crate) fn with_added(self, value: f64, added: f64, bound: &Bounded) -> Self {
        let wide = |end: Option<f64>| {
            let reach = end? - value;
            let end = value + Real::hypot(reach, added).copysign(reach);
            (end > bound.lower && end < bound.upper).then_some(end)
        };
        Self {
            low: wide(self.low),
            high: wide(self.high),
        }
    }
}

/// A model with one variable held at a value.
struct Held<'a, M> {
    model: &'a M,
    index: usize,
    value: f64,
}

impl<M: Model> Held<'_, M> {
    fn whole(&self, x: &[f64]) -> Vec<f64> {
        let mut whole = x.to_vec();
        whole.insert(self.index, self.value);
        whole
    }
}

impl<M: Model> Model for Held<'_, M> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.model.values(&self.whole(x), values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        let mut all = Jacobian::zeros(values.len(), x.len() + 1);
        self.model.derivatives(&self.whole(x), values, &mut all);
        for row in 0..values.len() {
            let kept = all.row(row).iter().enumerate();
            let kept = kept.filter(|(column, _)| *column != self.index);
            for (slot, (_, entry)) in jacobian.row_mut(row).iter_mut().zip(kept) {
                *slot = *entry;
            }
        }
    }
}

/// The confidence interval of parameter `index` by profile likelihood: the values at which the least cost
/// that the other parameters reach stays below cost + t² s²/2.
///
/// Unlike ± t times the standard error it follows curved valleys and stops at bounds. Source: Venzon &
/// Moolgavkar, Applied Statistics 37 (1988). Assumes the fit is the best one.
///
/// # Errors
/// As [`fit`].
pub fn profile(
    model: &impl Model,
    best: &Fit,
    index: usize,
    confidence: f64,
    settings: &Settings,
) -> Result<Interval> {
    let uncertainty = Uncertainty::from_fit(best, settings.loss);
    let t = student_quantile(0.5 + 0.5 * confidence, uncertainty.freedom);
    let limit = best.cost + 0.5 * Real::powi(t * uncertainty.residual_deviation, 2);
    let guess = t * uncertainty.standard_errors[index];
    let bound = &best.bounds[index];
    let width = bound.upper - bound.lower;
    let step = if guess.is_finite() {
        guess.min(width)
    } else {
        let size = best.x[index].abs().max(1e-6);
        0.1 * if width.is_finite() { width } else { size }
    };
    Ok(Interval {
        low: end(model, best, index, (-step, limit), settings)?,
        high: end(model, best, index, (step, limit), settings)?,
    })
}

/// One end: walks until the cost passes the limit, then closes in.
fn end(
    model: &impl Model,
    best: &Fit,
    index: usize,
    (step, limit): (f64, f64),
    settings: &Settings,
) -> Result<Option<f64>> {
    let bound = best.bounds[index];
    let mut others: Vec<Bounded> = best
        .bounds
        .iter()
        .zip(&best.x)
        .map(|(bounded, &start)| Bounded { start, ..*bounded })
        .collect();
    others.remove(index);
    let mut cost_at = |value: f64| -> Result<f64> {
        let held = Held {
            model,
            index,
            value,
        };
        let found = fit(&held, best.residuals.len(), &others, settings)?;
        // the next one begins where this one ended
        for (other, x) in others.iter_mut().zip(&found.x) {
            other.start = *x;
        }
        Ok(found.cost)
    };
    let is_met = |cost: f64| (cost - limit).abs() <= 1e-3 * (limit - best.cost);
    let (mut inside, mut inside_cost) = (best.x[index], best.cost);
    let mut stride = step;
    let (mut outside, mut outside_cost) = loop {
        let value = (inside + stride).clamp(bound.lower, bound.upper);
        let cost = cost_at(value)?;
        if is_met(cost) {
            return Ok(Some(value));
        }
        if cost > limit {
            break (value, cost);
        }
        if value <= bound.lower || value >= bound.upper || !(stride.abs() < 1e3 * step.abs()) {
            return Ok(None);
        }
        (inside, inside_cost) = (value, cost);
        stride *= 1.6;
    };
    // the secant of the cost, kept inside the bracket
    for _ in 0..12 {
        let share = ((limit - inside_cost) / (outside_cost - inside_cost)).clamp(0.05, 0.95);
        let value = inside + share * (outside - inside);
        let cost = cost_at(value)?;
        if is_met(cost) {
            return Ok(Some(value));
        }
        if cost > limit {
            (outside, outside_cost) = (value, cost);
        } else {
            (inside, inside_cost) = (value, cost);
        }
    }
    Ok(Some(0.5 * (inside + outside)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_added_half_width_ends_before_a_bound() {
        let at = |lower, upper| {
            let interval = Interval {
                low: Some(7.0),
                high: Some(14.0),
            };
            let start = 10.0;
            let bound = Bounded {
                start,
                lower,
                upper,
            };
            let found = interval.with_added(10.0, 3.0, &bound);
            (found.low, found.high)
        };
        // 10 - sqrt(9 + 9) and 10 + sqrt(16 + 9)
        let low = 10.0 - 18_f64.sqrt();
        assert_eq!(at(0.0, 20.0), (Some(low), Some(15.0)));
        assert_eq!(at(low, 15.0), (None, None));
        assert_eq!(at(6.0, 15.1), (None, Some(15.0)));
        assert_eq!(at(5.0, 14.5), (Some(low), None));
        let open = Interval {
            low: None,
            high: None,
        };
        assert_eq!(open.with_added(10.0, 3.0, &Bounded::free(10.0)), open);
    }
}
