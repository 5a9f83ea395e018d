//! The filter from a log's end to its beginning: what it knows of each moment from what came after.
//!
//! Backwards in time counters run down and every speed has the other sign; accelerations stay, and so do slips. The two
//! directions lag to two sides, and their mean lags to none.

use grouser_files::robot::{RobotFile, WheelSensor};
use grouser_log::Log;
use grouser_slip::{Measurement, Reference, Sample, Slip, WheelEstimate};

use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::samples::{sample, wheel_of};

/// The most samples that are held at once: about 1 GB.
const MOST_SAMPLES: usize = 20_000_000;

/// A slip and its sigma.
type Known = Option<(f64, f64)>;

/// What the run backwards says of the wheels whenever one was read.
pub(crate) struct Backward {
    /// The first of the log is the last here.
    groups: Vec<(i64, Box<[Known]>)>,
}

impl Backward {
    /// Runs the filter backwards over a log.
    pub(crate) fn new(
        log: &Log,
        file: &RobotFile,
        (wheels, sensor, reference): (&[usize], WheelSensor, Reference),
        shifts: &[i64],
    ) -> Result<Self> {
        let mut samples = Vec::new();
        for record in log.records(shifts)? {
            if let Some(sample) = sample(&record?, wheels, sensor) {
                if samples.len() == MOST_SAMPLES {
                    return Err(Error::TooLong {
                        limit: MOST_SAMPLES,
                    });
                }
                samples.push(sample);
            }
        }
        displacements_since_the_next(&mut samples);
        let mut filter = Fusion::new(file, reference)?;
        let mut groups = Vec::new();
        let mut rest = &samples[..];
        while let Some(last) = rest.last() {
            let time_ns = last.time_ns;
            let begin = rest.partition_point(|sample| sample.time_ns < time_ns);
            let mut any = false;
            for sample in &rest[begin..] {
                any |= wheel_of(&sample.measurement).is_some();
                if let Some(measurement) = reversed(sample.measurement) {
                    filter.update(Sample {
                        time_ns: time_ns.saturating_neg(),
                        measurement,
                    });
                }
            }
            if any {
                groups.push((time_ns, filter.wheels().iter().map(known).collect()));
            }
            rest = &rest[..begin];
        }
        Ok(Self { groups })
    }

    /// What was known at a time; times are asked for in their order.
    pub(crate) fn at(&mut self, time_ns: i64) -> Option<Box<[Known]>> {
        while self.groups.last().is_some_and(|(time, _)| *time < time_ns) {
            self.groups.pop();
        }
        let next = self.groups.last().is_some_and(|(time, _)| *time == time_ns);
        next.then(|| self.groups.pop().map(|(_, known)| known))?
    }
}

fn known(wheel: &WheelEstimate) -> Known {
    wheel.slip.map(Slip::value).zip(wheel.sigma)
}

/// Both directions together: their mean, weighted by what each knows. If they are further apart than their sigmas say,
/// the sigma is as much larger (Birge's ratio).
///
/// Assumes: their errors are independent. Of what was believed beforehand, which both hold, little is left in either.
pub(crate) fn joined((a, sigma_a): (f64, f64), (b, sigma_b): (f64, f64)) -> (f64, f64) {
    let (va, vb) = (sigma_a * sigma_a, sigma_b * sigma_b);
    let both = va + vb;
    if !(both > 0.0) {
        return (0.5 * (a + b), 0.0);
    }
    let mean = (a * vb + b * va) / both;
    let ratio = ((a - b) * (a - b) / both).max(1.0);
    (mean, f64::sqrt(va * vb / both * ratio))
}

/// Ways since the sample before become ways since the sample after.
fn displacements_since_the_next(samples: &mut [Sample]) {
    let is_way = |sample: &Sample| matches!(sample.measurement, Measurement::Displacement { .. });
    let mut later: Option<Measurement> = None;
    for sample in samples.iter_mut().rev().filter(|sample| is_way(sample)) {
        let none = Measurement::Displacement {
            forward: 0.0,
            left: 0.0,
            turn: None,
        };
        let own = std::mem::replace(&mut sample.measurement, later.unwrap_or(none));
        later = Some(own);
    }
}

/// The same, seen backwards in time; `None` where it has no such sense.
fn reversed(measurement: Measurement) -> Option<Measurement> {
    Some(match measurement {
        Measurement::WheelRate { wheel, rate } => Measurement::WheelRate { wheel, rate: -rate },
        Measurement::YawRate { rate } => Measurement::YawRate { rate: -rate },
        Measurement::Displacement {
            forward,
            left,
            turn,
        } => Measurement::Displacement {
            forward: -forward,
            left: -left,
            turn: turn.map(|turn| -turn),
        },
        Measurement::Speed { forward, left } => Measurement::Speed {
            forward: -forward,
            left: left.map(|left| -left),
        },
        Measurement::Command { forward, left } => Measurement::Command {
            forward: -forward,
            left: -left,
        },
        Measurement::WheelEdge { wheel, forward } => Measurement::WheelEdge {
            wheel,
            forward: !forward,
        },
        Measurement::WheelCount { .. }
        | Measurement::WheelAngle { .. }
        | Measurement::Pose { .. }
        | Measurement::Acceleration { .. } => measurement,
        // A wheel that is driven, seen backwards, is one that brakes.
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_directions_meet_between() {
        let (mean, sigma) = joined((0.3, 0.02), (0.32, 0.02));
        assert!((mean - 0.31).abs() < 1e-15 && (sigma - 0.02 / 2_f64.sqrt()).abs() < 1e-15);
        // five sigma apart: sigma as many times larger
        let (mean, sigma) = joined((0.3, 0.03), (0.55, 0.04));
        assert!((mean - (0.3 * 0.0016 + 0.55 * 0.0009) / 0.0025).abs() < 1e-15);
        assert!((sigma - 5.0 * 0.03 * 0.04 / 0.05).abs() < 1e-15);
    }

    #[test]
    fn ways_are_told_at_their_other_end() {
        let at = |time_ns, forward| Sample {
            time_ns,
            measurement: Measurement::Displacement {
                forward,
                left: 0.0,
                turn: None,
            },
        };
        let mut samples = [at(0, 9.0), at(1, 0.1), at(2, 0.2)];
        displacements_since_the_next(&mut samples);
        assert_eq!(samples, [at(0, 0.1), at(1, 0.2), at(2, 0.0)]);
    }
}
