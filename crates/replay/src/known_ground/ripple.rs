//! The ripple of rollers in a motor's current.

use std::f64::consts::TAU;

use grouser_real::Real;

/// The ripple is looked for between these frequencies, Hz, in steps of this share.
const RIPPLE: (f64, f64) = (0.25, 2.4);
const FREQUENCY_RATIO: f64 = 1.04;
/// Shorter series hold too few ripples, s.
const MIN_SERIES_S: f64 = 6.0;

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
    if !(last - first >= MIN_SERIES_S) {
        return None;
    }
    let count = series.len() as f64;
    let middle = series.iter().map(|s| s.0).sum::<f64>() / count;
    let mean = series.iter().map(|s| s.1).sum::<f64>() / count;
    let (mut product, mut square) = (0.0, 0.0);
    for &(time, value) in series {
        product += (time - middle) * (value - mean);
        square += Real::powi(time - middle, 2);
    }
    let slope = product / square;
    let tapered: Vec<(f64, f64)> = series
        .iter()
        .map(|&(time, value)| {
            // Hann's taper: the ends of the series are no ripple
            let taper = 0.5 - 0.5 * Real::cos(TAU * (time - first) / (last - first));
            (time, taper * (value - mean - slope * (time - middle)))
        })
        .collect();
    let power = |frequency: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for &(time, value) in &tapered {
            let (sin, cos) = Real::sin_cos(TAU * frequency * (time - first));
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
