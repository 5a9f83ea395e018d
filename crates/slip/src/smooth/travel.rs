//! How far the robot went by all readings, and how well that is known.

use crate::motion::{Entry, Row, SIZE, SPEED, Tape, dot};
use crate::speed::Measured;

/// The distance Σ v t over the steps of a tape, t the `seconds` of each step (0: not counted), m.
///
/// The distance is a number that no reading shows. Its covariance with the state follows from the tape, so that later
/// readings correct it as they correct the state: no pass back is needed.
#[must_use]
pub fn travel(tape: &Tape, seconds: &[f64]) -> Measured {
    let mut out = Measured {
        value: 0.0,
        variance: 0.0,
    };
    let mut shared: Row = [0.0; SIZE];
    let mut steps = tape.ends.iter().zip(seconds);
    for entry in &tape.entries {
        match entry {
            Entry::Noise { .. } => {}
            Entry::Propagate { index, row } => shared[*index] = dot(row, &shared),
            Entry::Update { correction, .. } => {
                let seen = dot(&correction.row, &shared);
                let weight = seen / correction.variance;
                out.value += weight * correction.innovation;
                out.variance -= weight * seen;
                for (shared, gain) in shared.iter_mut().zip(&correction.gain) {
                    *shared -= seen * gain;
                }
            }
            Entry::End => {
                let Some((belief, t)) = steps.next() else {
                    break;
                };
                let with_speed = &belief.covariance[SPEED];
                out.value += t * belief.mean[SPEED];
                out.variance += t * (2.0 * shared[SPEED] + t * with_speed[SPEED]);
                for (shared, p) in shared.iter_mut().zip(with_speed) {
                    *shared += t * p;
                }
            }
        }
    }
    out.variance = out.variance.max(0.0);
    out
}
