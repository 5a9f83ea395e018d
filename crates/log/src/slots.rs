//! From the numbers of a row or a message to measurements.

use grouser_files::columns::{Column, Frame, Meaning};
use grouser_real::Real;

use grouser_slip::{Measurement, MeasurementKind, MeasurementPart, MeasurementParts};

use crate::error::BadField;
use crate::message::NavSatFix;
use crate::orientation::yaw;

/// The readings that a set of columns gives.
#[derive(Clone, Debug)]
pub(crate) struct Slots(Vec<Slot>);

#[derive(Clone, Copy, Debug)]
enum Slot {
    /// A measurement of one number or counter, and the wheel's index.
    One(MeasurementKind, usize, Part),
    /// An angle of the suspension: the joint, and its sense.
    Joint(Part, usize, f64),
    /// Specific force and angular rate forwards, to the left, upwards.
    Inertial([Part; 6]),
    /// Forwards, and to the left where that is measured.
    Acceleration(Part, Option<Part>),
    Displacement(Part, Part, Option<Part>, Frame),
    Pose(Part, Part, Heading),
    /// A place without a heading.
    Place(Part, Part),
    /// Latitude, longitude and altitude of a fix, its kind, and its standard deviation.
    Fix([Part; 2], Option<Part>, Option<FixKind>, Option<Part>),
    Speed(Part, Option<Part>),
    Command(Part, Option<Part>),
}

/// What has the heading of a pose.
#[derive(Clone, Copy, Debug)]
enum Heading {
    Yaw(Part),
    /// Parts x and y of a quaternion, where they are there, z and w.
    Orientation([Option<Part>; 2], [Part; 2]),
}

impl Heading {
    /// The yaw, rad; `None` where a part is missing or the parts are no rotation.
    fn yaw(
        self,
        number: &dyn Fn(Part) -> Result<Option<f64>, BadField>,
    ) -> Result<Option<f64>, BadField> {
        match self {
            Self::Yaw(part) => number(part),
            Self::Orientation([x, y], [z, w]) => {
                let flat = |part: Option<Part>| part.map_or(Ok(Some(0.0)), number);
                let (tilt, turn) = (flat(x)?.zip(flat(y)?), number(z)?.zip(number(w)?));
                let parts = tilt.zip(turn);
                Ok(parts.and_then(|((x, y), (z, w))| yaw([x, y, z, w])))
            }
        }
    }
}

/// What says whether a fix has a position.
#[derive(Clone, Copy, Debug)]
enum FixKind {
    Type(Part),
    Status(Part),
}

/// One of the columns, and what one of its unit is in SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) column: usize,
    pub(crate) factor: f64,
    /// What is added to it in SI.
    offset: f64,
}

impl Part {
    /// A number of the column in SI.
    pub(crate) fn si(self, number: f64) -> f64 {
        number * self.factor + self.offset
    }
}

/// A way (m, forwards and to the left) in the frame before a turn to the left (rad), in that of half the turn.
fn in_frame_halfway(((forward, left), turn): ((f64, f64), f64)) -> (f64, f64) {
    let (sin, cos) = Real::sin_cos(0.5 * turn);
    (cos * forward + sin * left, cos * left - sin * forward)
}

/// What a column of a table measures: places without a heading become displacements.
pub(crate) fn measured(columns: &[Column], column: &Column) -> Meaning {
    let has_heading = || columns.iter().any(|c| c.meaning.is_heading());
    match column.meaning {
        Meaning::PoseX if !has_heading() => Meaning::DisplacementForward,
        Meaning::PoseY if !has_heading() => Meaning::DisplacementLeft,
        Meaning::Latitude => Meaning::DisplacementForward,
        Meaning::Longitude => Meaning::DisplacementLeft,
        meaning => meaning,
    }
}

impl Slots {
    /// `wheels` are the wheels of the log, to which readings refer by index.
    pub(crate) fn new(columns: &[Column], wheels: &[String]) -> Self {
        let of = |column: usize| Part {
            column,
            factor: columns[column].factor,
            offset: columns[column].offset,
        };
        let part = |meaning: Meaning| {
            let at = columns.iter().position(|c| c.meaning == meaning)?;
            Some(of(at))
        };
        let orientation = || {
            let [x, y] = [Meaning::OrientationX, Meaning::OrientationY].map(part);
            let z_and_w = part(Meaning::OrientationZ).zip(part(Meaning::OrientationW));
            z_and_w.map(|(z, w)| Heading::Orientation([x, y], [z, w]))
        };
        let heading = || {
            part(Meaning::PoseYaw)
                .map(Heading::Yaw)
                .or_else(orientation)
        };
        let mut slots = Vec::new();
        for (index, column) in columns.iter().enumerate() {
            let own = of(index);
            let wheel = || {
                let Some(name) = &column.wheel else {
                    return Some(0);
                };
                wheels.iter().position(|wheel| wheel == name)
            };
            let slot = match column.meaning {
                Meaning::AccelerationForward => {
                    Some(Slot::Acceleration(own, part(Meaning::AccelerationLeft)))
                }
                Meaning::JointAngle => {
                    (column.joint.as_ref()).map(|joint| Slot::Joint(own, joint.joint, joint.sign))
                }
                Meaning::AccelerationUp => {
                    let all = [
                        Meaning::AccelerationForward,
                        Meaning::AccelerationLeft,
                        Meaning::AccelerationUp,
                        Meaning::RollRate,
                        Meaning::PitchRate,
                        Meaning::YawRate,
                    ];
                    let parts: Vec<Part> = all.into_iter().filter_map(part).collect();
                    parts.try_into().ok().map(Slot::Inertial)
                }
                Meaning::DisplacementForward => {
                    let turn = part(Meaning::DisplacementTurn);
                    part(Meaning::DisplacementLeft)
                        .map(|left| Slot::Displacement(own, left, turn, column.frame))
                }
                Meaning::PoseX => part(Meaning::PoseY).map(|y| match heading() {
                    Some(heading) => Slot::Pose(own, y, heading),
                    None => Slot::Place(own, y),
                }),
                Meaning::Latitude => part(Meaning::Longitude).map(|longitude| {
                    let status = part(Meaning::FixStatus).map(FixKind::Status);
                    Slot::Fix(
                        [own, longitude],
                        part(Meaning::Altitude),
                        part(Meaning::FixType).map(FixKind::Type).or(status),
                        part(Meaning::FixSigma),
                    )
                }),
                Meaning::SpeedForward => Some(Slot::Speed(own, part(Meaning::SpeedLeft))),
                Meaning::SpeedSize => Some(Slot::Speed(own, None)),
                Meaning::CommandForward => Some(Slot::Command(own, part(Meaning::CommandLeft))),
                // further parts of the above are read with the first
                meaning => wheel()
                    .filter(|_| meaning.kind().fields().len() == 1)
                    .map(|wheel| Slot::One(meaning.kind(), wheel, own)),
            };
            slots.extend(slot);
        }
        Self(slots)
    }

    /// Are the poses that it gives places without a heading? Their yaw is the standard deviation of a fix, m, or a mere 0.
    pub(crate) fn gives_places(&self) -> bool {
        let is_place = |slot: &Slot| matches!(slot, Slot::Place(..));
        self.gives_fixes() || self.0.iter().any(is_place)
    }

    pub(crate) fn gives_fixes(&self) -> bool {
        self.0.iter().any(|slot| matches!(slot, Slot::Fix(..)))
    }

    /// Gives every reading to `take`; one that lacks a part is left out. `number` gives a column in SI,
    /// `count` a column as the bits of a counter; `None` stands for no value. `fix` makes places of fixes.
    #[allow(clippy::too_many_lines, reason = "one arm a kind of reading")]
    pub(crate) fn readings(
        &self,
        number: &dyn Fn(Part) -> Result<Option<f64>, BadField>,
        count: &dyn Fn(Part) -> Result<Option<u64>, BadField>,
        fix: &mut dyn FnMut(NavSatFix) -> Option<Measurement>,
        take: &mut dyn FnMut(Measurement),
    ) -> Result<(), BadField> {
        let optional = |part: Option<Part>| part.map_or(Ok(None), number);
        for slot in &self.0 {
            let reading = match *slot {
                // A way is an angle once the radius is known, a current a torque once the motor is.
                Slot::One(kind, index, part) => {
                    let mut parts = MeasurementParts {
                        index,
                        ..MeasurementParts::default()
                    };
                    if kind.fields()[0].part == MeasurementPart::Count {
                        count(part)?.and_then(|count| {
                            parts.count = count;
                            Measurement::from_parts(kind, parts)
                        })
                    } else {
                        parts.numbers[0] = number(part)?;
                        Measurement::from_parts(kind, parts)
                    }
                }
                Slot::Joint(angle, joint, sign) => number(angle)?.map(|angle| {
                    let angle = sign * angle;
                    Measurement::JointAngle { joint, angle }
                }),
                Slot::Inertial(parts) => {
                    let mut all = [0.0; 6];
                    let mut is_complete = true;
                    for (slot, part) in all.iter_mut().zip(parts) {
                        match number(part)? {
                            Some(number) => *slot = number,
                            None => is_complete = false,
                        }
                    }
                    let [x, y, z, roll, pitch, yaw] = all;
                    is_complete.then_some(Measurement::Inertial {
                        force: [x, y, z],
                        rate: [roll, pitch, yaw],
                    })
                }
                Slot::Acceleration(forward, left) => {
                    // Where it is not measured at all, the run puts that of the robot's turn in its place.
                    let left = match left {
                        Some(left) => number(left)?,
                        None => Some(0.0),
                    };
                    number(forward)?
                        .zip(left)
                        .map(|(forward, left)| Measurement::Acceleration { forward, left })
                }
                Slot::Displacement(forward, left, turn, frame) => {
                    let turn = optional(turn)?;
                    let way = number(forward)?.zip(number(left)?);
                    let way = match frame {
                        Frame::Halfway => way,
                        Frame::Previous => way.zip(turn).map(in_frame_halfway),
                    };
                    way.map(|(forward, left)| Measurement::Displacement {
                        forward,
                        left,
                        turn,
                    })
                }
                Slot::Pose(x, y, heading) => {
                    let yaw = heading.yaw(number)?;
                    number(x)?
                        .zip(number(y)?)
                        .zip(yaw)
                        .map(|((x, y), yaw)| Measurement::Pose { x, y, yaw })
                }
                Slot::Place(x, y) => {
                    number(x)?
                        .zip(number(y)?)
                        .map(|(x, y)| Measurement::Pose { x, y, yaw: 0.0 })
                }
                Slot::Fix([latitude, longitude], altitude, kind, sigma) => {
                    let (altitude, sigma) = (optional(altitude)?, optional(sigma)?);
                    let (is_fixed, status) = match kind {
                        Some(FixKind::Type(part)) => (number(part)?.is_none_or(|n| n > 0.0), 0.0),
                        Some(FixKind::Status(part)) => {
                            let status = number(part)?.unwrap_or(0.0);
                            (status >= 0.0, status)
                        }
                        None => (true, 0.0),
                    };
                    number(latitude)?
                        .zip(number(longitude)?)
                        .and_then(|(latitude, longitude)| {
                            fix(NavSatFix {
                                latitude_deg: latitude.to_degrees(),
                                longitude_deg: longitude.to_degrees(),
                                altitude: altitude.unwrap_or(0.0),
                                is_fixed,
                                #[allow(
                                    clippy::cast_possible_truncation,
                                    reason = "the cast saturates"
                                )]
                                status: status as i8,
                                variance: sigma.filter(|s| *s > 0.0).map(|s| s * s),
                            })
                        })
                }
                Slot::Speed(forward, left) => {
                    let left = optional(left)?;
                    number(forward)?.map(|forward| Measurement::Speed { forward, left })
                }
                Slot::Command(forward, left) => {
                    let left = optional(left)?.unwrap_or(0.0);
                    number(forward)?.map(|forward| Measurement::Command { forward, left })
                }
            };
            reading.into_iter().for_each(&mut *take);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of a quarter turn to the left: what was ahead is ahead and to the right.
    #[test]
    fn a_way_is_turned_by_half_the_turn() {
        let quarter = core::f64::consts::FRAC_PI_2;
        let half = core::f64::consts::FRAC_1_SQRT_2;
        for (way, expected) in [
            ((2.0, 0.0), (2.0 * half, -2.0 * half)),
            ((0.0, 3.0), (3.0 * half, 3.0 * half)),
            ((2.0, 3.0), (5.0 * half, half)),
        ] {
            let (forward, left) = in_frame_halfway((way, quarter));
            let off = (forward - expected.0).abs() + (left - expected.1).abs();
            assert!(off < 1e-15, "{way:?}: {forward} {left}");
        }
        // a turn of which half has another sine than cosine
        let (sin, cos) = f64::sin_cos(0.5 * 0.8);
        let (forward, left) = in_frame_halfway(((2.0, 3.0), 0.8));
        assert!((forward - (2.0 * cos + 3.0 * sin)).abs() < 1e-15);
        assert!((left - (3.0 * cos - 2.0 * sin)).abs() < 1e-15);
    }
}
