//! Slip where nothing measures the ground: by what the motors draw, and by the rollers of the wheel across the way.

use std::f64::consts::TAU;

use crate::error::{Error, Result};

/// The ripple is looked for between these frequencies, Hz, in steps of this share.
const RIPPLE: (f64, f64) = (0.25, 2.4);
const FREQUENCY_RATIO: f64 = 1.04;
/// The logarithm of a roller's way per ripple is no better known than this.
const LEAST_SPREAD: f64 = 0.2;
/// On one ground the same robot draws the same current within this share of it, and slips the same within this.
const CURRENT_SCATTER: f64 = 0.1;
const SLIP_SCATTER: f64 = 0.05;
/// A ground that was never seen draws anything between these, as shares of the maximum and minimum current of those that
/// were.
const UNSEEN_CURRENT_FACTOR: f64 = 2.0;
/// Points of the distribution over slip in (0, 1).
const POINTS: usize = 500;

/// A stretch of straight drive of an omni-wheeled robot, by its motors alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Sum of what the motors draw, A; any other unit if it is always the same.
    pub current: f64,
    /// Speed by the wheels, m/s.
    pub speed: f64,
    /// Share of the robot's speed at which the rollers of the most crosswise wheel roll, 1.
    pub across: f64,
    /// The strongest ripple in that wheel's current, Hz.
    pub ripple: f64,
}

/// A stretch whose slip was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownGround {
    /// What its motors showed.
    pub stretch: Stretch,
    /// Its slip.
    pub slip: f64,
    /// Standard deviation of the slip from one second to the next.
    pub scatter: f64,
}

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
}

/// The strongest ripple (Hz, from 0.25 to 2.4) in a series of (s, value): the maximum of its periodogram, its straight line
/// taken out. `None` of less than 6 s.
///
/// An omni wheel that stands across the way hardly turns, but its rollers roll at the robot's own speed, and no motor drives
/// them: they are free wheels. Each of their turns shows as a ripple in what holds the wheel.
///
/// ```
/// use grouser_replay::roller_ripple;
///
/// let series: Vec<(f64, f64)> = (0..500)
///     .map(|i| 0.02 * f64::from(i))
///     .map(|time| (time, 0.3 + 0.1 * (std::f64::consts::TAU * 1.2 * time).sin()))
///     .collect();
/// assert!((roller_ripple(&series).unwrap() - 1.2).abs() < 0.05); // Hz
/// assert_eq!(roller_ripple(&series[..100]), None); // 2 s are too short
/// ```
#[must_use]
pub fn roller_ripple(series: &[(f64, f64)]) -> Option<f64> {
    let (first, last) = (series.first()?.0, series.last()?.0);
    if !(last - first >= 6.0) {
        return None;
    }
    let count = series.len() as f64;
    let middle = series.iter().map(|s| s.0).sum::<f64>() / count;
    let mean = series.iter().map(|s| s.1).sum::<f64>() / count;
    let (mut product, mut square) = (0.0, 0.0);
    for &(time, value) in series {
        product += (time - middle) * (value - mean);
        square += (time - middle).powi(2);
    }
    let slope = product / square;
    let tapered: Vec<(f64, f64)> = series
        .iter()
        .map(|&(time, value)| {
            // Hann's taper: the ends of the series are no ripple
            let taper = 0.5 - 0.5 * (TAU * (time - first) / (last - first)).cos();
            (time, taper * (value - mean - slope * (time - middle)))
        })
        .collect();
    let power = |frequency: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for &(time, value) in &tapered {
            let (sin, cos) = (TAU * frequency * (time - first)).sin_cos();
            re += cos * value;
            im += sin * value;
        }
        re * re + im * im
    };
    let mut best = (0.0, None);
    let mut frequency = RIPPLE.0;
    while frequency < RIPPLE.1 {
        let here = power(frequency);
        if here > best.0 {
            best = (here, Some(frequency));
        }
        frequency *= FREQUENCY_RATIO;
    }
    best.1
}

/// The slip of any one second of a stretch, from stretches of known slip and nothing that measures the ground.
///
/// The ground is one of the known ones, or, with the weight of one of them, another on which any slip and any current may
/// be. A known one draws its current within 10 %. On each, the rollers' way per ripple λ = (1 − s) u a/f (u the speed by
/// the wheels, a the share across, f the ripple) is spread as over the known stretches: log λ by Student's t. Bayes' rule
/// over s in (0, 1); the scatter from second to second is added.
///
/// Assumes: straight, steady drive; slip between 0 and 1; the known grounds were driven by the same robot.
///
/// # Errors
/// [`Error::TooFewGrounds`] for less than three known stretches or numbers that are not positive.
///
/// ```
/// use grouser_replay::{KnownGround, Stretch, slip_without_reference};
///
/// // Three runs with known slip, and one whose current is that of the first.
/// let known = [(1.0, 0.1), (1.4, 0.3), (1.9, 0.5)].map(|(current, slip)| {
///     let ripple = 2.0 * (1.0 - slip); // the rollers follow the true speed
///     KnownGround { stretch: Stretch { current, speed: 0.2, across: 0.5, ripple }, slip, scatter: 0.02 }
/// });
/// let range = slip_without_reference(&known[0].stretch, &known)?;
/// assert!(range.low < 0.1 && 0.1 < range.high && range.median < 0.3);
/// # Ok::<(), grouser_replay::Error>(())
/// ```
pub fn slip_without_reference(stretch: &Stretch, known: &[KnownGround]) -> Result<SlipRange> {
    let is_sound = |s: &Stretch| {
        [s.current, s.speed, s.across, s.ripple]
            .iter()
            .all(|x| *x > 0.0 && x.is_finite())
    };
    let sound = known
        .iter()
        .all(|ground| is_sound(&ground.stretch) && ground.slip < 1.0 && ground.scatter >= 0.0);
    if known.len() < 3 || !sound || !is_sound(stretch) {
        return Err(Error::TooFewGrounds { known: known.len() });
    }
    let count = known.len() as f64;
    let way = |s: &Stretch, slip: f64| ((1.0 - slip) * s.speed * s.across / s.ripple).ln();
    let ways: Vec<f64> = known.iter().map(|k| way(&k.stretch, k.slip)).collect();
    let mean = ways.iter().sum::<f64>() / count;
    let variance = ways.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let spread = variance.sqrt().max(LEAST_SPREAD) * (1.0 + 1.0 / count).sqrt();
    let freedom = count - 1.0;
    let currents = || known.iter().map(|ground| ground.stretch.current);
    let most = UNSEEN_CURRENT_FACTOR * currents().fold(0.0, f64::max);
    let least = currents().fold(f64::INFINITY, f64::min) / UNSEEN_CURRENT_FACTOR;
    let unseen = 1.0 / (most / least).ln();
    let normal = |x: f64, sigma: f64| (-0.5 * (x / sigma).powi(2)).exp() / (sigma * TAU.sqrt());
    let grid: Vec<f64> = (0..POINTS)
        .map(|i| (i as f64 + 0.5) / POINTS as f64)
        .collect();
    let believed = grid.iter().map(|&slip| {
        let of_known = known.iter().map(|ground| {
            let current = (stretch.current / ground.stretch.current).ln();
            normal(current, CURRENT_SCATTER) * normal(slip - ground.slip, SLIP_SCATTER)
        });
        let z = (way(stretch, slip) - mean) / spread;
        let ripple = (1.0 + z * z / freedom).powf(-0.5 * (freedom + 1.0));
        (of_known.sum::<f64>() + unseen) * ripple
    });
    let believed: Vec<f64> = believed.collect();
    let scatter = known.iter().map(|k| k.scatter.powi(2)).sum::<f64>() / count;
    let scatter = scatter.sqrt().max(1e-3);
    let blurred = grid.iter().map(|&at| {
        let near = grid.iter().zip(&believed);
        near.map(|(&slip, weight)| weight * normal(at - slip, scatter))
            .sum::<f64>()
    });
    let blurred: Vec<f64> = blurred.collect();
    let total: f64 = blurred.iter().sum();
    let quantile = |share: f64| {
        let mut below = 0.0;
        for (&slip, weight) in grid.iter().zip(&blurred) {
            below += weight / total;
            if below >= share {
                return slip;
            }
        }
        1.0
    };
    Ok(SlipRange {
        median: quantile(0.5),
        low: quantile(0.025),
        high: quantile(0.975),
    })
}
