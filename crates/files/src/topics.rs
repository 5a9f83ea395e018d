//! The section `[topics]` of a robot file: what the topics of an MCAP file or a ROS 1 bag mean.
//!
//! What it does not name is chosen by type and name.
//!
//! ```toml
//! [topics]                              # every key is optional
//! wheels = "/joint_states"              # sensor_msgs/JointState
//! contact = "/dynamic_joint_states"     # control_msgs/DynamicJointState with `sinkage` (m), `entry_angle` (rad) of wheels
//! yaw_rate = "/imu/data"                # sensor_msgs/Imu
//! imu_up = "z"                          # its axis that points up: x, y, z, -x, -y or -z
//! imu_forward = "x"                     # its axis that points forwards
//! # imu_roll_deg, imu_pitch_deg, imu_yaw_deg: instead of the axes, its turn in the robot's frame, as in a URDF
//! pose = "/vicon/pose"                  # where the robot is: nav_msgs/Odometry; geometry_msgs/PoseStamped,
//!                                       # PoseWithCovarianceStamped, TransformStamped, PointStamped; tf2_msgs/TFMessage
//! # pose_frame = "map"                  # of transforms: the fixed frame
//! # pose_child_frame = "base_link"      # and the robot's
//! speed = "/gps/velocity"               # speed over ground: nav_msgs/Odometry; geometry_msgs/TwistStamped,
//!                                       # TwistWithCovarianceStamped
//! fix = "/gps/fix"                      # sensor_msgs/NavSatFix
//! antenna_x_m = 0.2                     # its antenna, forwards of the robot's origin
//! antenna_y_m = 0.0                     # and to the left of it
//! command = "/cmd_vel"                  # geometry_msgs/Twist, TwistStamped
//! wheel_odometry = "/controller/odom"   # nav_msgs/Odometry that a driver made of the wheels alone
//! wheel_odometry_track_m = 0.38         # the distance of left and right wheels that it was made with
//! time = "header"                       # stamps of the headers; "log": times of recording
//! align_clock = false                   # does the IMU's clock differ by a constant, to be estimated?
//! ignore = ["/odom"]                    # not to be used
//!
//! [[topics.field]]                      # a number of any message, as a column of a table is
//! topic = "/encoders"
//! field = "ticks[0]"
//! meaning = "wheel_count"
//! wheel = "left"
//! unit = "tick"
//! ```

use grouser_real::Real;
use grouser_slip::{Robot, WheelRole};

use crate::columns::{Column, check_together, read_meaning};
use crate::error::{Error, Result};
use crate::section::Section;
use crate::suspension::SuspensionJoint;

/// The numbers of one topic's messages.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TopicFields {
    /// The topic.
    pub topic: String,
    /// The fields; [`Column::column`] is the path of each, such as `twist.linear.x` or `ticks[0]`.
    pub fields: Vec<Column>,
}

/// Which joint a wheel is in messages that name joints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joint {
    /// The wheel.
    pub wheel: String,
    /// The joint that the robot file names for it.
    pub joint: Option<String>,
}

/// How a wheel's sensor turned, by an odometry that was made of the wheels:
/// rate = `per_speed` · v + `per_turn` · Ω.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OdometryWheel {
    /// The wheel.
    pub wheel: String,
    /// rad/s of its sensor's shaft for 1 m/s forwards.
    pub per_speed: f64,
    /// rad/s of its sensor's shaft for 1 rad/s to the left.
    pub per_turn: f64,
}

/// An odometry that was made of the wheels alone, and the wheels' rates out of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelOdometry {
    /// The topic.
    pub topic: String,
    /// The distance of left and right wheels that it was made with, m.
    pub track: f64,
    /// Its wheels: the powered ones.
    pub wheels: Vec<OdometryWheel>,
}

/// What the section says.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Topics {
    /// The topic of the wheels' angles, rates or counts, by joint.
    pub wheels: Option<String>,
    /// The topic of the wheels' sinkages and entry angles, by joint.
    pub contact: Option<String>,
    /// The topic of the yaw rate.
    pub yaw_rate: Option<String>,
    /// The direction in the IMU's own frame that points up.
    pub imu_up: Option<[f64; 3]>,
    /// The direction in the IMU's own frame that points forwards.
    pub imu_forward: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the IMU in the robot's frame, rad, where the file gives them: `imu_up` and `imu_forward` follow.
    pub imu_mounting: Option<[f64; 3]>,
    /// The topic of the robot's pose.
    pub pose: Option<String>,
    /// Of a pose by transforms: the fixed frame.
    pub pose_frame: Option<String>,
    /// Of a pose by transforms: the robot's frame.
    pub pose_child_frame: Option<String>,
    /// The topic of its speed over ground.
    pub speed: Option<String>,
    /// The topic of a satellite receiver's fixes.
    pub fix: Option<String>,
    /// Position of the receiver's antenna in the robot's frame, forwards and to the left, m.
    pub antenna: [f64; 2],
    /// The topic of its commanded speed.
    pub command: Option<String>,
    /// An odometry that stands for wheels that were not recorded.
    pub wheel_odometry: Option<WheelOdometry>,
    /// Do times of recording count, not the headers' stamps?
    pub recorder_clock: bool,
    /// Does the IMU's clock differ from the others' by an unknown constant?
    pub align_clock: bool,
    /// Topics not to be used.
    pub ignore: Vec<String>,
    /// Topics that are read by their fields.
    pub fields: Vec<TopicFields>,
    /// The wheels' joints, in the robot's order.
    pub joints: Vec<Joint>,
    /// The joints of the suspension, where the file describes the robot's body.
    pub suspension: Option<Vec<SuspensionJoint>>,
    /// Does `[estimator]` state where the reference is mounted? Then transforms do not.
    pub is_mounting_stated: bool,
    /// The standard deviation of a place by the reference, m, where `[estimator]` states it.
    pub position_sigma: Option<f64>,
}

impl Topics {
    /// Every topic that the file names for a use.
    pub fn named(&self) -> impl Iterator<Item = &str> {
        let fields = self.fields.iter().map(|fields| fields.topic.as_str());
        self.named_whole().chain(fields)
    }

    /// Those that are not named by a field.
    pub fn named_whole(&self) -> impl Iterator<Item = &str> {
        let one = [
            &self.wheels,
            &self.contact,
            &self.yaw_rate,
            &self.pose,
            &self.speed,
            &self.fix,
            &self.command,
        ];
        let odometry = self.wheel_odometry.iter().map(|odometry| &odometry.topic);
        let all = one.into_iter().flatten().chain(odometry);
        all.map(String::as_str)
    }
}

pub(crate) const AXES: [(&str, [f64; 3]); 6] = [
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
    ("-x", [-1.0, 0.0, 0.0]),
    ("-y", [0.0, -1.0, 0.0]),
    ("-z", [0.0, 0.0, -1.0]),
];

/// Reads the section; the robot's wheels are put in later, when they are known.
pub(crate) fn read_topics(section: &Section<'_>) -> Result<Topics> {
    let text = |key| Ok::<_, Error>(section.optional_text(key)?.map(str::to_owned));
    let wheel_odometry = text("wheel_odometry")?;
    let track = section.optional_number("wheel_odometry_track_m", (1e-3, 100.0))?;
    if wheel_odometry.is_some() != track.is_some() {
        return Err(Error::Contradiction {
            at: section.place(),
            message:
                "`wheel_odometry` and `wheel_odometry_track_m` belong together: the track is the \
                      distance of left and right wheels that the odometry was made with"
                    .into(),
        });
    }
    let mut fields: Vec<TopicFields> = Vec::new();
    section.sections("field", |field| {
        let topic = field.text("topic")?;
        let column = read_meaning(field, field.text("field")?.into())?;
        match fields.iter_mut().find(|other| other.topic == topic) {
            Some(same) => same.fields.push(column),
            None => fields.push(TopicFields {
                topic: topic.into(),
                fields: vec![column],
            }),
        }
        Ok::<_, Error>(())
    })?;
    for topic in &fields {
        check_together(&section.place_of("field"), &topic.fields)?;
    }
    let imu_mounting = read_mounting(section)?;
    let [imu_forward, imu_up] = match imu_mounting {
        Some(angles) => mounted_axes(angles).map(Some),
        None => [
            section.optional_choice("imu_forward", &AXES)?,
            section.optional_choice("imu_up", &AXES)?,
        ],
    };
    let [pose_frame, pose_child_frame] = read_pose_frames(section)?;
    let clocks = [("header", false), ("log", true)];
    let ignore = section.texts("ignore")?;
    let topics = Topics {
        wheels: text("wheels")?,
        contact: text("contact")?,
        yaw_rate: text("yaw_rate")?,
        imu_up,
        imu_forward,
        imu_mounting,
        pose: text("pose")?,
        pose_frame,
        pose_child_frame,
        speed: text("speed")?,
        fix: text("fix")?,
        antenna: [
            section
                .optional_number("antenna_x_m", (-100.0, 100.0))?
                .unwrap_or(0.0),
            section
                .optional_number("antenna_y_m", (-100.0, 100.0))?
                .unwrap_or(0.0),
        ],
        command: text("command")?,
        wheel_odometry: wheel_odometry
            .zip(track)
            .map(|(topic, track)| WheelOdometry {
                topic,
                track,
                wheels: Vec::new(),
            }),
        recorder_clock: section.optional_choice("time", &clocks)?.unwrap_or(false),
        align_clock: section.flag("align_clock")?,
        ignore: ignore.into_iter().map(str::to_owned).collect(),
        fields,
        joints: Vec::new(),
        suspension: None,
        is_mounting_stated: false,
        position_sigma: None,
    };
    if let (Some(up), Some(forward)) = (topics.imu_up, topics.imu_forward)
        && topics.imu_mounting.is_none()
        && up.iter().zip(forward).any(|(a, b)| a * b != 0.0)
    {
        return Err(Error::Contradiction {
            at: section.place_of("imu_forward"),
            message: "`imu_forward` and `imu_up` are one axis of the IMU".into(),
        });
    }
    if let Some(ignored) = topics
        .named()
        .find(|topic| topics.ignore.iter().any(|other| other == topic))
    {
        return Err(Error::Contradiction {
            at: section.place_of("ignore"),
            message: format!("`{ignored}` is named for a use and under `ignore`"),
        });
    }
    Ok(topics)
}

/// The frames of a pose by transforms, which `pose` names.
fn read_pose_frames(section: &Section<'_>) -> Result<[Option<String>; 2]> {
    let keys = ["pose_frame", "pose_child_frame"];
    let key = keys.into_iter().find(|key| section.has(key));
    if let Some(key) = key.filter(|_| !section.has("pose")) {
        return Err(Error::Contradiction {
            at: section.place_of(key),
            message: format!("`{key}` belongs to a topic of transforms that `pose` names"),
        });
    }
    let [fixed, base] = keys.map(|key| section.optional_text(key));
    Ok([fixed?.map(str::to_owned), base?.map(str::to_owned)])
}

pub(crate) const MOUNTING_KEYS: [&str; 3] = ["imu_roll_deg", "imu_pitch_deg", "imu_yaw_deg"];

/// Roll, pitch and yaw of the IMU, rad; an angle that is not given is 0.
fn read_mounting(section: &Section<'_>) -> Result<Option<[f64; 3]>> {
    let mut angles = [0.0; 3];
    for (angle, key) in angles.iter_mut().zip(MOUNTING_KEYS) {
        *angle = section
            .optional_number(key, (-360.0, 360.0))?
            .map_or(0.0, f64::to_radians);
    }
    if !MOUNTING_KEYS.iter().any(|key| section.has(key)) {
        return Ok(None);
    }
    if let Some(axis) = ["imu_up", "imu_forward"]
        .into_iter()
        .find(|key| section.has(key))
    {
        return Err(Error::Contradiction {
            at: section.place_of(axis),
            message: format!("the mounting of the IMU is given by its angles and by `{axis}`"),
        });
    }
    Ok(Some(angles))
}

/// The directions forwards and up in the frame of an IMU that is turned by roll, pitch and yaw (about x, then the fixed y,
/// then the fixed z axis, as in a URDF): rows of `R_z(yaw) R_y(pitch) R_x(roll)`.
fn mounted_axes([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 2] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (
        Real::sin_cos(roll),
        Real::sin_cos(pitch),
        Real::sin_cos(yaw),
    );
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Puts the robot's wheels into the section: its joints, and the rates that an odometry of the wheels
/// says: v_i = v − Ω · t/2 on the left, v + Ω · t/2 on the right.
pub(crate) fn put_wheels(
    topics: &mut Topics,
    robot: &Robot,
    joints: Vec<Option<String>>,
) -> std::result::Result<(), String> {
    let wheels = robot.wheels();
    topics.joints = wheels
        .iter()
        .zip(joints)
        .map(|(wheel, joint)| Joint {
            wheel: wheel.name.clone(),
            joint,
        })
        .collect();
    let Some(odometry) = &mut topics.wheel_odometry else {
        return Ok(());
    };
    for wheel in wheels
        .iter()
        .filter(|wheel| wheel.role == WheelRole::Powered)
    {
        if wheel.heading.rad() != 0.0 || wheel.y == 0.0 {
            return Err(format!(
                "`wheel_odometry` is for robots whose wheels are at the left and the right and drive forwards, \
                 but wheel \"{}\" has heading {} deg and y {} m",
                wheel.name,
                wheel.heading.deg(),
                wheel.y
            ));
        }
        let per_metre = 1.0 / wheel.travel_per_radian();
        odometry.wheels.push(OdometryWheel {
            wheel: wheel.name.clone(),
            per_speed: per_metre,
            per_turn: -0.5 * odometry.track * wheel.y.signum() * per_metre,
        });
    }
    Ok(())
}
