//! Where the reference is mounted, taken out of its readings: a pose, a displacement or a speed becomes that of the robot's origin.

use grouser_files::robot::Corrections;
use grouser_real::Real;
use grouser_slip::Measurement;

/// The mounting of the reference, and the last yaw rate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mounting {
    corrections: Corrections,
    rate: f64,
}

impl Mounting {
    pub(crate) const fn new(corrections: Corrections) -> Self {
        Self {
            corrections,
            rate: 0.0,
        }
    }

    /// Takes scale and mounting out of a reading.
    pub(crate) fn correct(&mut self, measurement: &mut Measurement) {
        let [ahead, aside] = self.corrections.reference_place;
        let mounted = self.corrections.pose_yaw_offset;
        let turned = |angle: f64, [x, y]: [f64; 2]| {
            let (sin, cos) = Real::sin_cos(angle);
            [cos * x - sin * y, sin * x + cos * y]
        };
        match measurement {
            Measurement::YawRate { rate } => {
                *rate *= self.corrections.yaw_rate_scale;
                self.rate = *rate;
            }
            Measurement::Pose { x, y, yaw } => {
                *yaw -= mounted;
                let [dx, dy] = turned(*yaw, [ahead, aside]);
                (*x, *y) = (*x - dx, *y - dy);
            }
            Measurement::Displacement {
                forward,
                left,
                turn: Some(turn),
            } => {
                let chord = 2.0 * Real::sin(0.5 * *turn);
                let [along, across] = turned(mounted, [*forward, *left]);
                (*forward, *left) = (along + chord * aside, across - chord * ahead);
            }
            Measurement::Speed { forward, left } => {
                let [along, across] = turned(mounted, [*forward, left.unwrap_or(0.0)]);
                let is_whole = left.is_some();
                // the size of a speed along its own axis is not turned
                *forward = if is_whole { along } else { *forward } + self.rate * aside;
                *left = is_whole.then_some(across - self.rate * ahead);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use grouser_files::robot::Corrections;
    use grouser_slip::Measurement;

    use super::Mounting;

    /// A sensor 0.3 m ahead and 0.4 m to the left that looks to the left, on a robot that turns on the spot at 0.5 rad/s.
    #[test]
    fn a_robot_that_turns_on_the_spot_does_not_move() {
        let mut corrections = Corrections::default();
        corrections.reference_place = [0.3, 0.4];
        corrections.pose_yaw_offset = std::f64::consts::FRAC_PI_2;
        let mut mounting = Mounting::new(corrections);
        mounting.correct(&mut Measurement::YawRate { rate: 0.5 });
        // the sensor moves by (−0.2, 0.15) m/s in the robot's frame, (0.15, 0.2) in its own
        let mut speed = Measurement::Speed {
            forward: 0.15,
            left: Some(0.2),
        };
        mounting.correct(&mut speed);
        let turn = 0.1;
        let chord = 2.0 * f64::sin(0.5 * turn);
        let mut displacement = Measurement::Displacement {
            forward: chord * 0.3,
            left: chord * 0.4,
            turn: Some(turn),
        };
        mounting.correct(&mut displacement);
        let (
            Measurement::Speed {
                forward,
                left: Some(left),
            },
            Measurement::Displacement {
                forward: ahead,
                left: aside,
                ..
            },
        ) = (speed, displacement)
        else {
            panic!("{speed:?} {displacement:?}");
        };
        for zero in [forward, left, ahead, aside] {
            assert!(zero.abs() < 1e-15, "{speed:?} {displacement:?}");
        }
    }
}
