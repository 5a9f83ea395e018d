//! Typed views of the messages that robots commonly send.
//!
//! Frames and units by REP 103 and REP 105: SI, radians, x forwards, y left, z up.

use super::covariance::Trust;
use super::definition::short;
use super::elements::Elements;
use super::types::{Layout, TYPES, layout};
use super::{Value, known};

/// A view of a well-known message. Texts and arrays stay in the message's [`Value`]: a view allocates nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum View<'a> {
    /// `sensor_msgs/JointState`.
    JointState(JointState<'a>),
    /// `sensor_msgs/Imu`.
    Imu(Imu<'a>),
    /// `nav_msgs/Odometry`.
    Odometry(Odometry<'a>),
    /// `geometry_msgs/Twist`, `TwistStamped` or `TwistWithCovarianceStamped`: linear m/s, angular rad/s.
    Twist {
        /// m/s.
        linear: [f64; 3],
        /// rad/s.
        angular: [f64; 3],
        /// What the variances say of the speed forwards, to the left, and of the yaw rate.
        trust: [Trust; 3],
    },
    /// `sensor_msgs/NavSatFix`.
    NavSatFix(NavSatFix),
    /// `geometry_msgs/PoseStamped`, `PoseWithCovarianceStamped` or `TransformStamped`.
    Pose {
        /// m.
        position: [f64; 3],
        /// x, y, z, w.
        orientation: [f64; 4],
        /// What the variances say of x, y and yaw.
        trust: [Trust; 3],
    },
    /// `geometry_msgs/PointStamped`, m.
    Point([f64; 3]),
    /// `tf2_msgs/TFMessage` or `tf/tfMessage`.
    Transforms(Elements<'a, Transform<'a>>),
    /// `grouser_msgs/WheelTicks`: counters by joint, their bits as 64-bit numbers without sign.
    WheelTicks {
        /// Names.
        names: Elements<'a, &'a str>,
        /// Counters.
        ticks: Elements<'a, u64>,
    },
    /// `control_msgs/DynamicJointState` with the state interfaces `sinkage`, `entry_angle` or `edge`; one without them has no
    /// view.
    WheelContacts {
        /// Names.
        names: Elements<'a, &'a str>,
        /// Sinkage (m), entry angle (rad) and edge (1 or -1) of each.
        contacts: Elements<'a, [Option<f64>; 3]>,
    },
    /// `grouser_msgs/Displacement`: way since the message before, in the robot's frame halfway.
    Displacement {
        /// m.
        forward: f64,
        /// m.
        left: f64,
        /// rad; `None` where it was not measured.
        turn: Option<f64>,
    },
}

/// Joints by name; an array that the message leaves empty is empty here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointState<'a> {
    /// Names.
    pub names: Elements<'a, &'a str>,
    /// rad.
    pub position: Elements<'a, f64>,
    /// rad/s.
    pub velocity: Elements<'a, f64>,
    /// N m.
    pub effort: Elements<'a, f64>,
}

/// An inertial reading in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Imu<'a> {
    /// The frame in which it is given.
    pub frame: &'a str,
    /// x, y, z, w; `None` where the covariance begins with -1.
    pub orientation: Option<[f64; 4]>,
    /// rad/s; `None` where the covariance begins with -1.
    pub angular_rate: Option<[f64; 3]>,
    /// What the variances on the covariance's diagonal say of each rate.
    pub angular_rate_trust: [Trust; 3],
    /// m/s², gravity included; `None` where the covariance begins with -1.
    pub acceleration: Option<[f64; 3]>,
    /// What the variances say of each acceleration.
    pub acceleration_trust: [Trust; 3],
}

/// A fix of a satellite receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NavSatFix {
    /// deg, north positive.
    pub latitude_deg: f64,
    /// deg, east positive.
    pub longitude_deg: f64,
    /// m above the ellipsoid.
    pub altitude: f64,
    /// Is there a fix?
    pub is_fixed: bool,
    /// 0: satellites alone, 1: with augmentation, 2: with a ground station.
    pub status: i8,
    /// The larger of the variances to the east and to the north, m²; `None` where it is not known, or 0.
    pub variance: Option<f64>,
}

/// A pose and a twist; the twist is in the child frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Odometry<'a> {
    /// The fixed frame.
    pub frame: &'a str,
    /// The frame of the robot.
    pub child_frame: &'a str,
    /// m.
    pub position: [f64; 3],
    /// x, y, z, w.
    pub orientation: [f64; 4],
    /// m/s.
    pub linear: [f64; 3],
    /// rad/s.
    pub angular: [f64; 3],
    /// What the variances say of x, y and yaw.
    pub pose_trust: [Trust; 3],
    /// What the variances say of the speed forwards, to the left, and of the yaw rate.
    pub twist_trust: [Trust; 3],
}

/// One transform of a tree of frames.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Transform<'a> {
    /// When it was taken, ns; `None` of a stamp of 0.
    pub stamp_ns: Option<i64>,
    /// The parent.
    pub frame: &'a str,
    /// The child.
    pub child_frame: &'a str,
    /// m.
    pub translation: [f64; 3],
    /// x, y, z, w.
    pub rotation: [f64; 4],
}

/// What is at a path; an empty one is the value itself.
fn inside<'a>(value: &'a Value, path: &str) -> Option<&'a Value> {
    if path.is_empty() {
        Some(value)
    } else {
        value.at(path)
    }
}

fn vector(value: &Value, path: &str) -> Option<[f64; 3]> {
    let at = |name| value.at(path)?.at(name)?.number();
    Some([at("x")?, at("y")?, at("z")?])
}

fn quaternion(value: &Value, path: &str) -> Option<[f64; 4]> {
    let [x, y, z] = vector(value, path)?;
    Some([x, y, z, value.at(path)?.at("w")?.number()?])
}

/// What the variances at these places of a covariance say; a covariance that is not there says nothing.
fn trust(value: &Value, path: &str, places: [usize; 3]) -> [Trust; 3] {
    let covariance = value.at(path).and_then(Value::elements).unwrap_or_default();
    places.map(|place| {
        let variance = covariance.get(place).and_then(Value::number);
        Trust::from_variance(variance.unwrap_or(0.0))
    })
}

fn texts<'a>(value: &'a Value, path: &str) -> Option<Elements<'a, &'a str>> {
    Elements::new(value.at(path)?, Value::text)
}

fn numbers<'a>(value: &'a Value, path: &str) -> Option<Elements<'a, f64>> {
    Elements::new(value.at(path)?, Value::number)
}

fn text<'a>(value: &'a Value, path: &str) -> &'a str {
    value.at(path).and_then(Value::text).unwrap_or_default()
}

fn transform(value: &Value) -> Option<Transform<'_>> {
    let stamp_ns = value.at("header.stamp").and_then(Value::time_ns);
    Some(Transform {
        stamp_ns: stamp_ns.filter(|stamp| *stamp > 0),
        frame: text(value, "header.frame_id"),
        child_frame: text(value, "child_frame_id"),
        translation: vector(value, "transform.translation")?,
        rotation: quaternion(value, "transform.rotation")?,
    })
}

/// A counter's bits.
const fn count(value: &Value) -> Option<u64> {
    match value {
        Value::UInt(value) => Some(*value),
        Value::Int(value) => Some(value.cast_unsigned()),
        _ => None,
    }
}

/// Sinkage, entry angle and edge of one joint's interfaces; `None` where an interface's value is no number.
fn contact(state: &Value) -> Option<[Option<f64>; 3]> {
    let interfaces = state.at("interface_names")?.elements()?;
    let values = numbers(state, "values")?;
    Some(known::CONTACT_INTERFACES.map(|wanted| {
        let is_it = |name: &Value| name.text() == Some(wanted);
        values.get(interfaces.iter().position(is_it)?)
    }))
}

impl<'a> View<'a> {
    /// The types that have a view.
    pub fn types() -> impl Iterator<Item = &'static str> {
        TYPES.iter().map(|(name, _)| *name)
    }

    /// Is there a view for messages of that type?
    ///
    /// ```
    /// use grouser_log::message::View;
    ///
    /// assert!(View::exists_for("nav_msgs/msg/Odometry") && !View::exists_for("sensor_msgs/msg/Image"));
    /// ```
    #[must_use]
    pub fn exists_for(type_name: &str) -> bool {
        layout(&short(type_name)).is_some()
    }

    /// The view of a message; `None` for a type without one, or a message that lacks what its type has.
    #[must_use]
    #[allow(clippy::too_many_lines, reason = "one arm a layout")]
    pub fn new(type_name: &str, value: &'a Value) -> Option<Self> {
        match layout(&short(type_name))? {
            Layout::Joints(names, [position, velocity, effort]) => {
                Some(Self::JointState(JointState {
                    names: texts(value, names)?,
                    position: numbers(value, position)?,
                    velocity: numbers(value, velocity)?,
                    effort: numbers(value, effort).unwrap_or_default(),
                }))
            }
            Layout::Twist(twist, around) => Some(Self::Twist {
                linear: vector(inside(value, twist)?, "linear")?,
                angular: vector(inside(value, twist)?, "angular")?,
                trust: trust(inside(value, around)?, "covariance", [0, 7, 35]),
            }),
            Layout::Pose([position, orientation], around) => Some(Self::Pose {
                position: vector(value, position)?,
                orientation: quaternion(value, orientation)?,
                trust: trust(inside(value, around)?, "covariance", [0, 7, 35]),
            }),
            Layout::Point(point) => vector(value, point).map(Self::Point),
            Layout::Transforms(all) => {
                Elements::new(value.at(all)?, transform).map(Self::Transforms)
            }
            Layout::Counters(names, counts) => Some(Self::WheelTicks {
                names: texts(value, names)?,
                ticks: Elements::new(value.at(counts)?, count)?,
            }),
            Layout::CounterFields(names, fields) => Some(Self::WheelTicks {
                names: Elements::given(names),
                ticks: Elements::of_fields(value, fields, count)?,
            }),
            Layout::Contacts(names, interfaces) => {
                let contacts = Elements::new(value.at(interfaces)?, contact)?;
                let measures = contacts.iter().flatten().any(|value| value.is_some());
                measures.then_some(Self::WheelContacts {
                    names: texts(value, names)?,
                    contacts,
                })
            }
            Layout::Displacement([forward, left, turn]) => Some(Self::Displacement {
                forward: value.number_at(forward)?,
                left: value.number_at(left)?,
                turn: value.number_at(turn).filter(|turn| !turn.is_nan()),
            }),
            Layout::Imu => {
                let is_there = |name: &str| trust(value, name, [0; 3])[0] != Trust::Absent;
                let given = |name, covariance| {
                    if is_there(covariance) {
                        vector(value, name)
                    } else {
                        None
                    }
                };
                Some(Self::Imu(Imu {
                    frame: text(value, "header.frame_id"),
                    orientation: quaternion(value, "orientation")
                        .filter(|_| is_there("orientation_covariance")),
                    angular_rate: given("angular_velocity", "angular_velocity_covariance"),
                    angular_rate_trust: trust(value, "angular_velocity_covariance", [0, 4, 8]),
                    acceleration: given("linear_acceleration", "linear_acceleration_covariance"),
                    acceleration_trust: trust(value, "linear_acceleration_covariance", [0, 4, 8]),
                }))
            }
            Layout::Odometry => Some(Self::Odometry(Odometry {
                frame: text(value, "header.frame_id"),
                child_frame: text(value, "child_frame_id"),
                position: vector(value, "pose.pose.position")?,
                orientation: quaternion(value, "pose.pose.orientation")?,
                linear: vector(value, "twist.twist.linear")?,
                angular: vector(value, "twist.twist.angular")?,
                pose_trust: trust(value, "pose.covariance", [0, 7, 35]),
                twist_trust: trust(value, "twist.covariance", [0, 7, 35]),
            })),
            Layout::NavSatFix => {
                let at = |name| value.at(name)?.number();
                let status = at("status.status")?;
                let [east, north] =
                    [0, 4].map(
                        |place| match trust(value, "position_covariance", [place; 3])[0] {
                            Trust::Variance(variance) => Some(variance),
                            Trust::DoNotUse => Some(f64::INFINITY),
                            _ => None,
                        },
                    );
                let known = at("position_covariance_type").is_none_or(|kind| kind > 0.0);
                Some(Self::NavSatFix(NavSatFix {
                    latitude_deg: at("latitude")?,
                    longitude_deg: at("longitude")?,
                    altitude: at("altitude")?,
                    is_fixed: status >= 0.0,
                    #[allow(clippy::cast_possible_truncation, reason = "the cast saturates")]
                    status: status as i8,
                    variance: east.zip(north).map(|(a, b)| a.max(b)).filter(|_| known),
                }))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::build;

    /// A transform of 1970 has no stamp: the message's time counts.
    #[test]
    fn a_transform_without_a_stamp() {
        let of = |stamp_ns: i64| {
            let shift = build::message([
                ("translation", build::vector([1.0, 2.0, 3.0])),
                ("rotation", build::turn(0.0)),
            ]);
            let value = build::message([
                ("header", build::header(stamp_ns, "map")),
                ("child_frame_id", Value::Text("odom".into())),
                ("transform", shift),
            ]);
            transform(&value).unwrap().stamp_ns
        };
        assert_eq!(
            [of(0), of(1), of(2_000_000_000)],
            [None, Some(1), Some(2_000_000_000)]
        );
    }
}
