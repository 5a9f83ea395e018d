//! Where the reference is mounted, taken out of its readings: a pose, a displacement or a speed becomes that of the robot's origin
//! on the ground.
//! In an estimate a displacement without a turn has that of the gyro.

use grouser_files::robot::Corrections;
use grouser_real::Real;
use grouser_slip::{Measurement, Reference, Sample};

use crate::choice::Inputs;
use crate::suspension::Tilt;

/// The mounting of the reference, and how the robot turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mounting {
    reference: Reference,
    /// Forwards and to the left, m.
    place: [f64; 2],
    /// Above the ground, m.
    height: f64,
    /// How far the robot's tilt had moved it at the last displacement, forwards and to the left, m.
    last_lean: Option<[f64; 2]>,
    yaw: f64,
    yaw_rate_scale: f64,
    rate: f64,
    read_ns: Option<i64>,
    /// The turn by the gyro since the last displacement, rad.
    turn: f64,
    /// The same up to the last displacement.
    last_turn: f64,
    goes_by_places: bool,
}

impl Mounting {
    pub(crate) fn new(corrections: &Corrections, inputs: &Inputs) -> Self {
        let [x, y, height] = corrections.reference_place;
        Self {
            reference: inputs.reference,
            place: if [x, y] == [0.0; 2] {
                inputs.speed_place
            } else {
                [x, y]
            },
            height,
            last_lean: None,
            yaw: corrections.pose_yaw_offset,
            yaw_rate_scale: corrections.yaw_rate_scale,
            rate: 0.0,
            read_ns: None,
            turn: 0.0,
            last_turn: 0.0,
            goes_by_places: inputs.position_sigma.is_some(),
        }
    }

    /// Takes scale and mounting out of a reading.
    pub(crate) fn correct(&mut self, sample: &mut Sample) {
        let ([ahead, aside], mounted) = (self.place, self.yaw);
        let turned = |angle: f64, [x, y]: [f64; 2]| {
            let (sin, cos) = Real::sin_cos(angle);
            [cos * x - sin * y, sin * x + cos * y]
        };
        match (&mut sample.measurement, self.reference) {
            (Measurement::YawRate { rate }, _) => {
                *rate *= self.yaw_rate_scale;
                let before = std::mem::replace(&mut self.rate, *rate);
                let last_ns = self.read_ns.replace(sample.time_ns);
                let passed_ns = sample
                    .time_ns
                    .saturating_sub(last_ns.unwrap_or(sample.time_ns));
                self.turn += 0.5 * (before + *rate) * passed_ns as f64 * 1e-9;
            }
            (Measurement::Pose { x, y, yaw }, Reference::Pose) => {
                *yaw -= mounted;
                let [dx, dy] = turned(*yaw, [ahead, aside]);
                (*x, *y) = (*x - dx, *y - dy);
            }
            (
                Measurement::Displacement {
                    forward,
                    left,
                    turn,
                },
                Reference::Displacement,
            ) => {
                self.last_turn = std::mem::take(&mut self.turn);
                let chord = 2.0 * Real::sin(0.5 * turn.unwrap_or(self.last_turn));
                let [along, across] = turned(mounted, [*forward, *left]);
                (*forward, *left) = (along + chord * aside, across - chord * ahead);
            }
            (Measurement::Speed { forward, left }, Reference::Speed) => {
                let of_place = turned(mounted, [*forward, left.unwrap_or(0.0)]);
                // along its own axis alone: the origin does not move to the left
                let (sin, cos) = Real::sin_cos(mounted);
                let along = (*forward - sin * self.rate * ahead) / cos;
                *forward = left.map_or(along, |_| of_place[0]) + self.rate * aside;
                *left = left.map(|_| of_place[1] - self.rate * ahead);
            }
            _ => {}
        }
    }
}

impl Mounting {
    /// Takes out of a corrected reading what the robot's tilt moves the reference over the ground.
    pub(crate) fn level(&mut self, sample: &mut Sample, tilt: &Tilt) {
        if self.height == 0.0 {
            return;
        }
        let ahead = self.height * Real::sin(tilt.pitch);
        let aside = -self.height * Real::cos(tilt.pitch) * Real::sin(tilt.roll);
        match (&mut sample.measurement, self.reference) {
            (Measurement::Pose { x, y, yaw }, Reference::Pose) => {
                let (sin, cos) = Real::sin_cos(*yaw);
                *x -= cos * ahead - sin * aside;
                *y -= sin * ahead + cos * aside;
            }
            (Measurement::Displacement { forward, left, .. }, Reference::Displacement) => {
                let last = self.last_lean.replace([ahead, aside]);
                let [before, before_aside] = last.unwrap_or([ahead, aside]);
                *forward -= ahead - before;
                *left -= aside - before_aside;
            }
            (Measurement::Speed { forward, left }, Reference::Speed) => {
                let [roll_rate, pitch_rate] = tilt.rates;
                *forward -= self.height * pitch_rate;
                *left = left.map(|left| left + self.height * roll_rate);
            }
            _ => {}
        }
    }

    /// The reading that was corrected last for an estimate; displacements between places have no turn.
    pub(crate) const fn with_turn(&self, mut sample: Sample) -> Sample {
        if let Measurement::Displacement { turn, .. } = &mut sample.measurement
            && turn.is_none()
            && self.read_ns.is_some()
            && !self.goes_by_places
        {
            *turn = Some(self.last_turn);
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use grouser_files::robot::{Corrections, WheelSensor};
    use grouser_slip::{Measurement, Reference, Sample};

    use super::{Mounting, Tilt};
    use crate::choice::Inputs;

    fn corrected(reference: Reference, measurement: Measurement) -> Measurement {
        let mut corrections = Corrections::default();
        corrections.pose_yaw_offset = std::f64::consts::FRAC_PI_2;
        corrections.reference_place = [0.3, 0.4, 0.0];
        let inputs = Inputs {
            wheel_sensor: WheelSensor::Angle,
            reference,
            speed_place: [0.0; 2],
            position_sigma: None,
            is_acceleration_forward_only: false,
        };
        let mut mounting = Mounting::new(&corrections, &inputs);
        // 0.2 s at 0.5 rad/s
        for time_ns in [0, 200_000_000] {
            let measurement = Measurement::YawRate { rate: 0.5 };
            mounting.correct(&mut Sample {
                time_ns,
                measurement,
            });
        }
        let mut sample = Sample {
            time_ns: 200_000_000,
            measurement,
        };
        mounting.correct(&mut sample);
        sample.measurement
    }

    /// A sensor 0.8 m above the ground on a robot that rolls and pitches in its place.
    #[test]
    fn a_robot_that_tilts_in_its_place_does_not_move() {
        let (height, tilt) = (
            0.8,
            Tilt {
                roll: 0.05,
                pitch: -0.1,
                rates: [0.3, 0.2],
            },
        );
        let level = Tilt {
            roll: 0.0,
            pitch: 0.0,
            ..tilt
        };
        // nose down moves it forwards, the right side down to the right
        let ahead = height * (-0.1_f64).sin();
        let aside = -height * 0.1_f64.cos() * 0.05_f64.sin();
        let (x, y, yaw) = (-aside, ahead, std::f64::consts::FRAC_PI_2);
        let read = [
            (Reference::Pose, Measurement::Pose { x, y, yaw }),
            (
                Reference::Displacement,
                Measurement::Displacement {
                    forward: ahead,
                    left: aside,
                    turn: Some(0.0),
                },
            ),
            (
                Reference::Speed,
                Measurement::Speed {
                    forward: height * 0.2,
                    left: Some(-height * 0.3),
                },
            ),
        ];
        for (reference, measurement) in read {
            let mut corrections = Corrections::default();
            corrections.reference_place = [0.0, 0.0, height];
            let inputs = Inputs {
                wheel_sensor: WheelSensor::Angle,
                reference,
                speed_place: [0.0; 2],
                position_sigma: None,
                is_acceleration_forward_only: false,
            };
            let mut mounting = Mounting::new(&corrections, &inputs);
            let mut first = Sample {
                time_ns: 0,
                measurement: Measurement::Displacement {
                    forward: 0.0,
                    left: 0.0,
                    turn: None,
                },
            };
            mounting.level(&mut first, &level);
            let mut sample = Sample {
                time_ns: 1,
                measurement,
            };
            mounting.level(&mut sample, &tilt);
            let (a, b) = match sample.measurement {
                Measurement::Pose { x, y, .. } => (x, y),
                Measurement::Displacement { forward, left, .. } => (forward, left),
                Measurement::Speed { forward, left } => (forward, left.unwrap()),
                other => panic!("{other:?}"),
            };
            assert!(
                a.abs() < 1e-15 && b.abs() < 1e-15,
                "{:?}",
                sample.measurement
            );
        }
    }

    /// A sensor 0.3 m ahead and 0.4 m to the left that looks to the left, on a robot that turns on the spot at 0.5 rad/s.
    #[test]
    fn a_robot_that_turns_on_the_spot_does_not_move() {
        // the sensor moves by (-0.2, 0.15) m/s in the robot's frame, (0.15, 0.2) in its own
        let speed = Measurement::Speed {
            forward: 0.15,
            left: Some(0.2),
        };
        let speed = corrected(Reference::Speed, speed);
        let chord = 2.0 * f64::sin(0.05);
        for turn in [Some(0.1), None] {
            let displacement = Measurement::Displacement {
                forward: chord * 0.3,
                left: chord * 0.4,
                turn,
            };
            let displacement = corrected(Reference::Displacement, displacement);
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
}
