//! What is described wrongly, in words.

use std::fmt;

use crate::pose::PoseFault;
use crate::steering::SteeringFault;

/// A sensor that is described wrongly: its unit, its sign, its axes or its place among others.
///
/// ```
/// let mistake = grouser_doctor::Mistake::YawRateScale(57.3);
/// assert!(mistake.to_string().contains("57.30 times"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mistake {
    /// The speed over ground is never negative, though the wheels ran this far backwards, m.
    SpeedWithoutSign(f64),
    /// In bends wheels of both sides show the speeds of the other side.
    Exchanged {
        /// Is it certain that they are exchanged, and not the sign of the gyro?
        is_certain: bool,
    },
    /// The pose disagrees with gyro or wheels.
    Pose(PoseFault),
    /// The gyro turns by this multiple of what pose and wheels turn by.
    YawRateScale(f64),
    /// The robot turns otherwise than as it is steered.
    Steering(SteeringFault),
    /// These wheels turn against the motion by the reference, bit by bit in the robot's order, and others with it.
    Reversed(u64),
    /// The reference's motion is turned by this angle against the direction in which the wheels drive, rad, positive to the
    /// left: its axes, its yaw or the wheels' headings are described wrongly.
    ReferenceTurned(f64),
    /// The same of the accelerations that go with speeding up.
    AccelerationTurned(f64),
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SpeedWithoutSign(way) => write!(
                f,
                "the speed over ground is never negative, but the wheels ran {way:.1} m backwards: it is the size of the speed. \
                 `meaning = \"speed_size\"` (of its column, or under `[[topics.field]]`) gives it the sign of the wheels"
            ),
            Self::Exchanged { is_certain } => write!(
                f,
                "in bends wheels show the speeds of the other side: left and right encoders are exchanged{}",
                if *is_certain {
                    ""
                } else {
                    ", or the yaw rate has the wrong sign"
                }
            ),
            Self::Pose(fault) => pose_fault(f, *fault),
            Self::YawRateScale(scale) => write!(
                f,
                "the gyro turns by {scale:.2} times what pose and wheels turn by: its unit or its sign is described wrongly"
            ),
            Self::Steering(fault) => {
                let why = match fault {
                    SteeringFault::Reversed => "is its sign wrong (`scale = -1.0` in its column)",
                    SteeringFault::Unit => {
                        "is its unit another (rad, deg), or does it stay the same"
                    }
                };
                write!(
                    f,
                    "the robot does not turn as its steering angle says: {why}?"
                )
            }
            Self::Reversed(wheels) => {
                let places = (0..u64::BITS).filter(|index| wheels >> index & 1 == 1);
                let places: Vec<String> = places.map(|index| (index + 1).to_string()).collect();
                let (noun, verb) = match places.len() {
                    1 => ("wheel", "turns"),
                    _ => ("wheels", "turn"),
                };
                write!(
                    f,
                    "{noun} {} of the robot file {verb} against the robot's motion and others with it: `reversed = true` says so \
                     of an encoder",
                    places.join(", ")
                )
            }
            Self::ReferenceTurned(angle) => write!(
                f,
                "the reference moves {:.0}° to the left of the direction in which the wheels drive: its axes or its yaw \
                 are described wrongly (`pose_yaw_offset_deg` in the robot file corrects a pose: {:.0} more than there; of fixes and \
                 places without a heading the robot's first way counts as forwards)",
                angle.to_degrees(),
                -angle.to_degrees()
            ),
            Self::AccelerationTurned(angle) => write!(
                f,
                "where the robot speeds up, the accelerations point {:.0}° to the left of forwards: the mounting of the IMU \
                 is described wrongly",
                angle.to_degrees()
            ),
        }
    }
}

fn pose_fault(f: &mut fmt::Formatter<'_>, fault: PoseFault) -> fmt::Result {
    match fault {
        PoseFault::YawConstant => write!(
            f,
            "`pose_yaw` stays the same while the robot turns: the orientation is not measured (an identity), or another \
             axis of the pose points up"
        ),
        PoseFault::YawMirrored => write!(
            f,
            "`pose_yaw` turns against gyro or wheels: it counts to the right (`scale = -1.0` in its column turns it round), \
             or the axis that points up is another"
        ),
        PoseFault::YawUnit(scale) => write!(
            f,
            "`pose_yaw` turns by {scale:.1} times what gyro or wheels turn by: is its unit another than described (rad, deg)?"
        ),
        PoseFault::PlaceMirrored => write!(
            f,
            "the places of the pose turn against its yaw: `pose_x` and `pose_y` are exchanged, or one of them has the wrong \
             sign (`scale = -1.0` in its column)"
        ),
        PoseFault::Unit(scale) => write!(
            f,
            "the pose moves {scale:.3} times as far as the wheels: is it in another unit than described (cm, mm){}?",
            if scale < 1.0 {
                ", or do the wheels slip so much"
            } else {
                ""
            }
        ),
    }
}
