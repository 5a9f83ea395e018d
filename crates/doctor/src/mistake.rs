//! What is described wrongly, in words.

use std::fmt;

/// How a pose disagrees with the robot's other sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PoseFault {
    /// Its yaw is constant while the robot turns.
    YawConstant,
    /// Its yaw turns against gyro or wheels.
    YawMirrored,
    /// Its yaw turns by this multiple of the gyro's or the wheels' turn.
    YawUnit(f64),
    /// Its place turns against its yaw: an axis is mirrored, or both are exchanged.
    PlaceMirrored,
    /// Its distances are this multiple of those of the wheels.
    Unit(f64),
}

/// How a steering angle disagrees with the robot's turns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SteeringFault {
    /// Its sign.
    Reversed,
    /// Its unit, or it is not that of the wheels.
    Unit,
}

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
    /// The wheels never turn backwards, though the robot drove this far backwards, m.
    WheelsWithoutSign(f64),
    /// In bends wheels of both sides show the speeds of the other side.
    Exchanged {
        /// The wheels, bit by bit in the robot's order.
        wheels: u64,
        /// Is it certain that they are exchanged, and not the sign of the gyro?
        is_certain: bool,
        /// Are all wheels concerned? Then the frame of gyro and reference may be mirrored instead.
        is_whole: bool,
    },
    /// The log goes on elsewhere after a silence that ended at this time, s.
    SecondDrive(f64),
    /// The reference is constant while the wheels turn.
    Frozen {
        /// The first span, s from the start of the log.
        span_s: [f64; 2],
        /// Further spans.
        more: usize,
        /// Were its readings left out?
        is_left_out: bool,
    },
    /// Readings of a wheel, by its place in the robot's order, or of the reference alternate between two series.
    TwoSources(Option<usize>),
    /// Wheels of both sides show equal readings, bit by bit in the robot's order.
    SameSensor(u64),
    /// The reference follows the wheels without noise and slip.
    Derived,
    /// The gyro shows no turn while pose and wheels do.
    YawRateConstant,
    /// The robot goes this many times as far as its wheels everywhere, or less; or it slips so much.
    Scale(f64),
    /// The wheels turn the robot by this multiple of its turn; or they scrub.
    Track(f64),
    /// The pose disagrees with gyro or wheels.
    Pose(PoseFault),
    /// The gyro turns by this multiple of what pose and wheels turn by.
    YawRateScale(f64),
    /// The robot turns otherwise than as it is steered.
    Steering(SteeringFault),
    /// These wheels turn against the motion by the reference, bit by bit in the robot's order, and others with it.
    Reversed(u64),
    /// The reference's motion is turned by this angle against the direction in which the wheels drive, rad, positive to the
    /// left, with half of its interval: its axes, its yaw or the wheels' headings are described wrongly.
    ReferenceTurned([f64; 2]),
    /// In bends the reference moves as a sensor at this place does, forwards and to the left of the origin, m, with half of its
    /// interval.
    ReferencePlace([[f64; 2]; 2]),
    /// The same of the accelerations that go with speeding up.
    AccelerationTurned(f64),
}

impl fmt::Display for Mistake {
    #[allow(clippy::too_many_lines, reason = "one arm a mistake")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SpeedWithoutSign(way) => write!(
                f,
                "the speed over ground is never negative, but the wheels ran {way:.1} m backwards: it is the size of the speed. \
                 `meaning = \"speed_size\"` (of its column, or under `[[topics.field]]`) gives it the sign of the wheels"
            ),
            Self::WheelsWithoutSign(way) => write!(
                f,
                "the wheels never turn backwards, but the robot drove {way:.1} m backwards: their encoders have no sign; \
                 `--from-s` and `--to-s` select a span without reverse"
            ),
            Self::Exchanged {
                is_certain,
                is_whole,
                ..
            } => write!(
                f,
                "in bends wheels show the speeds of the other side: left and right encoders are exchanged{}",
                match (is_certain, is_whole) {
                    (true, false) => "",
                    (true, true) => {
                        ", or the frame is mirrored: y, yaw and gyro count to the right, as in NED (`scale = -1.0` in their \
                         columns turns them round)"
                    }
                    (false, _) => {
                        ", or the yaw rate has the wrong sign, as in a mirrored frame (NED)"
                    }
                }
            ),
            Self::SecondDrive(time_s) => write!(
                f,
                "at {time_s:.1} s, after a silence of all sensors, the robot is elsewhere or its counters begin again: the log \
                 holds more than one drive (`--from-s` and `--to-s` select one)"
            ),
            Self::Frozen {
                span_s: [from_s, to_s],
                more,
                is_left_out,
            } => {
                write!(f, "from {from_s:.1} s to {to_s:.1} s")?;
                if *more > 0 {
                    write!(f, " (and {more} times later)")?;
                }
                write!(
                    f,
                    " the reference is constant while the wheels turn: it was frozen or lost, and {}",
                    if *is_left_out {
                        "its readings of that time are left out"
                    } else {
                        "slips of that time do not hold"
                    }
                )
            }
            Self::TwoSources(wheel) => {
                let of_wheel =
                    |wheel: &usize| format!("readings of wheel {} of the robot file", wheel + 1);
                let places = || "places of the reference".to_owned();
                write!(
                    f,
                    "the {} alternate between two series: two programs publish on one topic (commands beside measurements, a second \
                     robot), or two sensors share a column",
                    wheel.as_ref().map_or_else(places, of_wheel)
                )
            }
            Self::SameSensor(wheels) => write!(
                f,
                "{} {} of the robot file always shows the speed of the other side, in bends too: it shows another wheel's \
                 sensor",
                if wheels.count_ones() > 1 {
                    "one of the wheels"
                } else {
                    "wheel"
                },
                places(*wheels)
            ),
            Self::Derived => write!(
                f,
                "the reference follows the wheels without noise and without any slip: it is derived from the wheels (wheel \
                 odometry, or a filter that uses it), and no slip is observable by it; name a sensor of the ground"
            ),
            Self::YawRateConstant => write!(
                f,
                "the gyro shows no turn while pose and wheels do: another axis of the IMU points up (`imu_up`, or another \
                 column), or its rate is not measured"
            ),
            Self::Scale(scale) if *scale < 1.0 => write!(
                f,
                "the wheels run at least {:.2} times as far as the robot goes at any time: is `gear` or `ticks_per_turn` that of \
                 another shaft (the motor's), or `radius_m` the diameter, or do the wheels slip by {:.2} and more?",
                1.0 / scale,
                1.0 - scale
            ),
            Self::Scale(scale) => write!(
                f,
                "the robot goes at least {scale:.2} times as far as its wheels run at any time: is `gear` or `ticks_per_turn` that \
                 of another shaft (the motor's), or `radius_m` too small, or is the reference in another unit?"
            ),
            Self::Track(scale) => write!(
                f,
                "the wheels turn the robot {scale:.2} times as much as it turns: is the track (`y_m` of the wheels) described \
                 too {}, or do the wheels scrub in turns (skid steering)?",
                if *scale > 1.0 { "small" } else { "large" }
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
                let (noun, verb) = match wheels.count_ones() {
                    1 => ("wheel", "turns"),
                    _ => ("wheels", "turn"),
                };
                write!(
                    f,
                    "{noun} {} of the robot file {verb} against the robot's motion and others with it: `reversed = true` says so \
                     of an encoder",
                    places(*wheels)
                )
            }
            Self::ReferenceTurned([angle, half_width]) => write!(
                f,
                "the reference moves {:.0}° (± {:.0}°) to the left of the direction in which the wheels drive: its axes or its yaw \
                 are described wrongly (`pose_yaw_offset_deg` in the robot file corrects it: {:.0} more than there)",
                angle.to_degrees(),
                half_width.to_degrees(),
                -angle.to_degrees()
            ),
            Self::ReferencePlace([[x, y], [of_x, of_y]]) => write!(
                f,
                "in bends the reference moves as a sensor {y:.2} m (± {of_y:.2} m) to the left of the robot's origin and {x:.2} m \
                 (± {of_x:.2} m) ahead of it: `reference_x_m` and `reference_y_m` in `[estimator]` (of positions without a heading, \
                 `antenna_y_m` in `[topics]`) state that; or do the wheels slip more on one side, or skid?"
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

/// The places of wheels in the robot file, counted from 1.
fn places(wheels: u64) -> String {
    let places = (0..u64::BITS).filter(|index| wheels >> index & 1 == 1);
    let places: Vec<String> = places.map(|index| (index + 1).to_string()).collect();
    places.join(", ")
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
