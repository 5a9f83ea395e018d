//! Does the robot turn as its wheels are steered?

use std::ops::RangeInclusive;

use crate::turn_pair::TurnPair;

/// A robot turns by such multiples of what its steering says at the speed over ground: wheels skid sideways in bends.
const SCALES: RangeInclusive<f64> = 0.65..=1.5;

/// How a steering angle disagrees with the robot's turns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SteeringFault {
    /// Its sign.
    Reversed,
    /// Its unit, or it is not that of the wheels.
    Unit,
}

/// The fault of a steering, and the scale of a gyro that alone disagrees with it, by the turns of gyro, pose and course of the
/// places, each beside those by the steering.
pub(crate) fn steering_fault(turns: [&TurnPair; 3]) -> (Option<SteeringFault>, Option<f64>) {
    let (mut fault, mut gyro_scale, mut agrees) = (None, None, false);
    for (index, of) in turns.into_iter().enumerate() {
        if !of.is_known() {
            continue;
        }
        let found = if of.agrees_but_for_scale() {
            let scale = of.inverse_scale();
            if SCALES.contains(&scale) {
                agrees = true;
                continue;
            }
            gyro_scale = gyro_scale.or((index == 0).then_some(scale));
            if SCALES.contains(&-scale) {
                SteeringFault::Reversed
            } else {
                SteeringFault::Unit
            }
        } else if of.is_unlike() && (index < 2 || of.has_bends()) {
            SteeringFault::Unit
        } else {
            continue;
        };
        fault = fault.or(Some(found));
    }
    if agrees {
        (None, gyro_scale)
    } else {
        (fault, None)
    }
}
