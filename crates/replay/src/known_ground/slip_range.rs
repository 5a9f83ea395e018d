//! The distribution of the slip of a stretch, given stretches of known slip.

use std::f64::consts::TAU;

use grouser_real::Real;

use super::stretch::{KnownGround, KnownGrounds, Roller, Stretch};
use crate::error::{Error, Result};

/// The logarithm of a roller's way per ripple is no better known than this.
const MIN_WAY_SPREAD: f64 = 0.2;
/// On one ground the same robot draws the same current within this share of it, and slips the same within this: three runs of
/// a Robotino on a table draw 0.74 A to 0.82 A, two on a carpet slip by 0.31 and 0.36 (`currents_hold_the_cameras_slip`).
const EFFORT_SCATTER: f64 = 0.05;
const SLIP_SCATTER: f64 = 0.05;
/// The scatter of the slip from second to second is no less than this: the step of the grid is 0.002.
const MIN_SECOND_SCATTER: f64 = 1e-3;
/// A ground that was never met draws anything between these, as shares of the maximum and minimum effort of those that
/// were.
const UNKNOWN_EFFORT_FACTOR: f64 = 2.0;
/// Points of the distribution over slip in (0, 1).
const POINTS: usize = 500;
/// Fewer stretches do not show how much grounds differ.
pub(crate) const MIN_KNOWN: usize = 3;

/// A slip with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SlipRange {
    /// Median.
    pub median: f64,
    /// 2.5 %.
    pub low: f64,
    /// 97.5 %.
    pub high: f64,
    /// Probability that the ground is one of the known ones.
    pub known_share: f64,
    /// The index of the known stretch that it resembles most.
    pub nearest: usize,
}

/// The slip of any one second of a stretch: [`KnownGrounds::slip`](super::KnownGrounds::slip).
///
/// The ground is one of the known ones, or, with the weight of one of them, another on which any slip and any effort may
/// be. On each, the rollers' way per ripple λ = (1 − s) u a/f (u the speed by the wheels, a the share across, f the ripple) is
/// spread as over the known stretches: log λ by Student's t. Bayes' rule over s in (0, 1); the scatter from second to second
/// is added.
///
/// # Errors
/// [`Error::TooFewGrounds`] for less than three known stretches or numbers that are not positive.
pub(crate) fn slip_of(stretch: &Stretch, known: &[&KnownGround]) -> Result<SlipRange> {
    let is_sound = |ground: &&KnownGround| {
        is_positive(&ground.stretch) && ground.slip < 1.0 && ground.scatter >= 0.0
    };
    if known.len() < MIN_KNOWN || !known.iter().all(is_sound) || !is_positive(stretch) {
        return Err(Error::TooFewGrounds { known: known.len() });
    }
    let efforts = || known.iter().map(|ground| ground.stretch.effort);
    let max = UNKNOWN_EFFORT_FACTOR * efforts().fold(0.0, f64::max);
    let min = efforts().fold(f64::INFINITY, f64::min) / UNKNOWN_EFFORT_FACTOR;
    // The logarithm of its effort is evenly spread.
    let unknown = 1.0 / Real::ln(max / min);
    let ways = RollerWays::of(known);
    let by_rollers = |slip: f64| match (&ways, stretch.roller) {
        (Some(ways), Some(roller)) => ways.likelihood(way(stretch.speed, roller, slip)),
        _ => 1.0,
    };
    let mut density: Vec<f64> = (0..POINTS)
        .map(|point| unknown * by_rollers(slip_at(point)))
        .collect();
    let of_unknown: f64 = density.iter().sum();
    let mut nearest = (0.0, 0);
    for (index, ground) in known.iter().enumerate() {
        let effort = Real::ln(stretch.effort / ground.stretch.effort);
        let prior = normal(effort, EFFORT_SCATTER);
        let mut weight = 0.0;
        for (point, slot) in density.iter_mut().enumerate() {
            let slip = slip_at(point);
            let here = prior * normal(slip - ground.slip, SLIP_SCATTER) * by_rollers(slip);
            *slot += here;
            weight += here;
        }
        if weight > nearest.0 {
            nearest = (weight, index);
        }
    }
    let known_share = 1.0 - of_unknown / density.iter().sum::<f64>();
    let scatter = known.iter().map(|k| Real::powi(k.scatter, 2)).sum::<f64>() / known.len() as f64;
    let density = blurred(&density, scatter.sqrt().max(MIN_SECOND_SCATTER));
    let quantile = |share: f64| {
        let mut below = 0.0;
        for (point, weight) in density.iter().enumerate() {
            below += weight;
            if below >= share {
                return slip_at(point);
            }
        }
        1.0
    };
    Ok(SlipRange {
        median: quantile(0.5),
        low: quantile(0.025),
        high: quantile(0.975),
        known_share,
        nearest: nearest.1,
    })
}

fn slip_at(point: usize) -> f64 {
    (point as f64 + 0.5) / POINTS as f64
}

fn is_positive(stretch: &Stretch) -> bool {
    let roller = stretch.roller.map_or([1.0; 2], |r| [r.across, r.ripple]);
    let all = [stretch.effort, stretch.speed, roller[0], roller[1]];
    all.iter().all(|x| *x > 0.0 && x.is_finite())
}

/// The logarithm of the rollers' way per ripple at a slip.
fn way(speed: f64, roller: Roller, slip: f64) -> f64 {
    Real::ln((1.0 - slip) * speed * roller.across / roller.ripple)
}

/// Student's t of the logarithm of the rollers' way per ripple.
struct RollerWays {
    mean: f64,
    spread: f64,
    freedom: f64,
}

impl RollerWays {
    fn of(known: &[&KnownGround]) -> Option<Self> {
        let ways = known.iter().filter_map(|ground| {
            Some(way(
                ground.stretch.speed,
                ground.stretch.roller?,
                ground.slip,
            ))
        });
        let ways: Vec<f64> = ways.collect();
        if ways.len() < MIN_KNOWN {
            return None;
        }
        let count = ways.len() as f64;
        let mean = ways.iter().sum::<f64>() / count;
        let variance = ways.iter().map(|w| Real::powi(w - mean, 2)).sum::<f64>() / (count - 1.0);
        Some(Self {
            mean,
            spread: variance.sqrt().max(MIN_WAY_SPREAD) * (1.0 + 1.0 / count).sqrt(),
            freedom: count - 1.0,
        })
    }

    fn likelihood(&self, way: f64) -> f64 {
        let z = (way - self.mean) / self.spread;
        Real::powf(1.0 + z * z / self.freedom, -0.5 * (self.freedom + 1.0))
    }
}

fn normal(x: f64, sigma: f64) -> f64 {
    Real::exp(-0.5 * Real::powi(x / sigma, 2)) / (sigma * TAU.sqrt())
}

/// The density of the sum with a normal variable of this standard deviation, of sum 1.
fn blurred(density: &[f64], sigma: f64) -> Vec<f64> {
    let near = |at: f64| {
        let all = density.iter().enumerate();
        all.map(|(point, weight)| weight * normal(at - slip_at(point), sigma))
            .sum()
    };
    let mut out: Vec<f64> = (0..density.len())
        .map(|point| near(slip_at(point)))
        .collect();
    let total: f64 = out.iter().sum();
    for slot in &mut out {
        *slot /= total;
    }
    out
}

impl KnownGrounds {
    /// The slip of any one second of a stretch, by Bayes' rule over these grounds and one that was never met.
    ///
    /// A known ground draws its effort within 5 %. Rollers count if the stretch and at least three grounds have them: their
    /// way per ripple is spread as over the known stretches.
    ///
    /// Assumes: straight, steady drive; slip between 0 and 1; the same robot with the same load on the same slope.
    ///
    /// # Errors
    /// [`Error::TooFewGrounds`](crate::Error::TooFewGrounds) for less than three grounds or numbers that are not positive.
    ///
    /// ```
    /// use grouser_replay::{EffortUnit, KnownGround, KnownGrounds, Roller, Stretch};
    ///
    /// // Three runs with known slip, and one whose current is that of the first.
    /// let grounds = [(1.0, 0.1), (1.4, 0.3), (1.9, 0.5)].map(|(effort, slip)| {
    ///     let ripple = 2.0 * (1.0 - slip); // the rollers follow the true speed
    ///     let roller = Some(Roller { across: 0.5, ripple });
    ///     let stretch = Stretch { from_s: 2.0, to_s: 12.0, effort, speed: 0.2, roller };
    ///     KnownGround { run: effort.to_string(), stretch, slip, scatter: 0.02 }
    /// });
    /// let known = KnownGrounds {
    ///     robot: "omni".into(),
    ///     unit: EffortUnit::Ampere,
    ///     grounds: grounds.to_vec(),
    ///     coverage: None,
    ///     half_width: None,
    /// };
    /// let range = known.slip(&known.grounds[0].stretch)?;
    /// assert!(range.low < 0.1 && 0.1 < range.high && range.median < 0.3);
    /// assert_eq!(range.nearest, 0);
    /// # Ok::<(), grouser_replay::Error>(())
    /// ```
    pub fn slip(&self, stretch: &Stretch) -> Result<SlipRange> {
        let grounds: Vec<&KnownGround> = self.grounds.iter().collect();
        slip_of(stretch, &grounds)
    }
}
