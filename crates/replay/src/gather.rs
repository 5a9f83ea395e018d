//! Measured places that come so fast that each says little: several become one.

use grouser_real::Real;
use grouser_slip::{Measurement, Sample};

/// Displacements and poses, no more than one in a time of `least` seconds.
///
/// The error of a place comes back with the other sign in the next displacement: over many short ones it all but
/// cancels, but a filter that takes each for itself does not know that, and believes them together far less than they
/// deserve. Displacements are added up, poses left out.
#[derive(Clone, Debug)]
pub(crate) struct Gather {
    least_ns: i64,
    last_ns: Option<i64>,
    /// Forwards and to the left in the frame of the first, m, and the turn since, rad.
    passed: [f64; 3],
    turns: bool,
}

/// The filter takes its reference for lost after half a second.
const MAX_GATHER_TIME_S: f64 = 0.25;

impl Gather {
    pub(crate) fn over(seconds: f64) -> Self {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "a quarter of a second at the most"
        )]
        let least_ns = (seconds.clamp(0.0, MAX_GATHER_TIME_S) * 1e9).round() as i64;
        Self {
            least_ns,
            last_ns: None,
            passed: [0.0; 3],
            turns: true,
        }
    }

    /// The sample to be taken in this one's place, if it is time.
    pub(crate) fn take(&mut self, sample: Sample) -> Option<Sample> {
        let is_due = |last: i64| sample.time_ns.saturating_sub(last) >= self.least_ns;
        match sample.measurement {
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                let Some(last) = self.last_ns else {
                    self.last_ns = Some(sample.time_ns);
                    return Some(sample);
                };
                if !(forward.is_finite() && left.is_finite()) {
                    return Some(sample);
                }
                let (sin, cos) = Real::sin_cos(self.passed[2] + 0.5 * turn.unwrap_or(0.0));
                self.passed[0] += cos * forward - sin * left;
                self.passed[1] += sin * forward + cos * left;
                self.passed[2] += turn.unwrap_or(0.0);
                self.turns &= turn.is_some();
                if !is_due(last) {
                    return None;
                }
                self.last_ns = Some(sample.time_ns);
                let [x, y, turn] = std::mem::take(&mut self.passed);
                // the robot's frame is that of halfway
                let (sin, cos) = Real::sin_cos(0.5 * turn);
                let turns = std::mem::replace(&mut self.turns, true);
                Some(Sample {
                    time_ns: sample.time_ns,
                    measurement: Measurement::Displacement {
                        forward: cos * x + sin * y,
                        left: cos * y - sin * x,
                        turn: turns.then_some(turn),
                    },
                })
            }
            Measurement::Pose { .. } => {
                if self.last_ns.is_some_and(|last| !is_due(last)) {
                    return None;
                }
                self.last_ns = Some(sample.time_ns);
                Some(sample)
            }
            _ => Some(sample),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Gather;
    use grouser_slip::{Measurement, Sample};

    #[test]
    fn a_circle_in_small_steps_is_one_in_large_steps() {
        // 0.01 m and 0.01 rad a step of 10 ms: a circle of radius 1 m
        let mut gather = Gather::over(0.1);
        let mut whole = Vec::new();
        for step in 0..=100 {
            let sample = Sample {
                time_ns: 10_000_000 * step,
                measurement: Measurement::Displacement {
                    forward: 0.01,
                    left: 0.0,
                    turn: Some(0.01),
                },
            };
            whole.extend(gather.take(sample));
        }
        assert_eq!(whole.len(), 11);
        for sample in &whole[1..] {
            let Measurement::Displacement {
                forward,
                left,
                turn,
            } = sample.measurement
            else {
                panic!()
            };
            // the chord of 0.1 rad is 2 sin 0.05
            assert!((forward - 2.0 * f64::sin(0.05)).abs() < 1e-5, "{forward}");
            assert!(left.abs() < 1e-12, "{left}");
            assert!((turn.unwrap() - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn displacements_that_come_seldom_stay_as_they_are() {
        let mut gather = Gather::over(0.1);
        for step in 0..4 {
            let sample = Sample {
                time_ns: 1_000_000_000 * step,
                measurement: Measurement::Displacement {
                    forward: 0.9,
                    left: 0.1,
                    turn: Some(0.8),
                },
            };
            let Some(taken) = gather.take(sample) else {
                panic!("every second one is due")
            };
            let Measurement::Displacement { forward, left, .. } = taken.measurement else {
                panic!()
            };
            assert!((forward - 0.9).abs() < 1e-12, "{forward}");
            assert!((left - 0.1).abs() < 1e-12, "{left}");
        }
    }
}
