//! `drive -o DRIVE.mcap`: what the sensors showed, as messages of ROS 2, beside what the robot made of it and what
//! was true.
//!
//! | topic | type | holds |
//! |---|---|---|
//! | `/wheel_ticks` | `grouser_msgs/WheelTicks` | counters as the hardware shows them |
//! | `/joint_states` | `sensor_msgs/JointState` | angle of the encoder's shaft since the first reading (rad), torque on the wheel by its motor's current (N m); angle of each rocker and arm (rad) |
//! | `/wheel_contacts` | `control_msgs/DynamicJointState` | sinkages (m) and entry angles (rad), where they are measured |
//! | `/wheel_edges` | `control_msgs/DynamicJointState` | encoder edges of free wheels at their own times (1 forwards, -1 backwards), where they are stamped |
//! | `/imu`, `/tf_static` | `sensor_msgs/Imu`, `tf2_msgs/TFMessage` | angular velocity and specific force, no orientation; how it is mounted |
//! | `/camera/displacement` | `grouser_msgs/Displacement` | way since the last picture |
//! | `/gnss/pose` | `geometry_msgs/PoseStamped` | fixes |
//! | `/grouser/slip` | `grouser_msgs/WheelSlip` | what the estimator in the loop said |
//! | `/grouser/soil` | `grouser_msgs/Soil` | what it has learnt of the soil, where it learns |
//! | `/grouser/robot` | `visualization_msgs/MarkerArray` | body and wheels where they were, coloured by the estimated slip |
//! | `/grouser/points` | `sensor_msgs/PointCloud2` | where wheels touched the ground, with slips, each second |
//! | `/grouser/way`, `/grouser/ruts` | `visualization_msgs/Marker` | way and ruts, a piece for each second |
//! | `/simulation/truth/pose` | `geometry_msgs/PoseStamped` | where the robot was |
//! | `/simulation/truth/slip` | `grouser_msgs/WheelSlip` | slips that the wheels had |
//!
//! Stamps are the sensors', times of recording those of arrival. Nothing under `/simulation/truth/` is read by
//! `estimate`.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io;

use grouser_log::message::{Value, build, known};
use grouser_log::write::{McapWriter, Topic};
use grouser_replay::messages::{
    DrawnWheel, RutMarkers, WayMarkers, WheelPoints, robot_markers, soil_message,
};
use grouser_rover::drive::{Frame, Scenario, WheelFrame};
use grouser_slip::{Counter, Health, Measurement};

use crate::output::OutputFile;

/// Between two pictures of the robot, ns.
const PICTURE_NS: i64 = 200_000_000;

/// A joint: a wheel's encoder shaft.
struct Joint {
    /// The wheel's name.
    wheel: String,
    /// The joint's name, by which `estimate` finds the wheel.
    name: String,
    counter: Counter,
    /// rad.
    per_tick: f64,
    /// Torque on the wheel for the motor's greatest current, N m; 0 without a motor.
    max_torque: f64,
}

/// What arrived of the wheels with one stamp.
#[derive(Default)]
struct Wheels {
    stamp_ns: i64,
    counts: Vec<(usize, u64)>,
    shares: Vec<(usize, f64)>,
    /// Angles of the suspension's joints, rad.
    angles: Vec<(usize, f64)>,
    contacts: BTreeMap<usize, [Option<f64>; 2]>,
}

/// The file in the making.
pub(super) struct Recording {
    writer: McapWriter<OutputFile>,
    joints: Vec<Joint>,
    /// The link that each joint of the suspension turns.
    links: Vec<String>,
    open: Wheels,
    ticks: Topic,
    states: Topic,
    contacts: Option<Topic>,
    edges: Option<Topic>,
    imu: Topic,
    camera: Option<Topic>,
    gnss: Option<Topic>,
    seen: Topic,
    soil: Option<Topic>,
    pose: Topic,
    slip: Topic,
    scene: Scene,
}

/// The pictures of robot, way and ruts.
struct Scene {
    robot: Topic,
    way: Topic,
    ruts: Topic,
    points: Topic,
    /// Radius and width of each wheel, m.
    sizes: Vec<[f64; 2]>,
    way_markers: WayMarkers,
    rut_markers: RutMarkers,
    wheel_points: WheelPoints,
    drawn_ns: Option<i64>,
}

impl Recording {
    /// Begins the file.
    pub(super) fn begin(out: OutputFile, scenario: &Scenario) -> io::Result<Self> {
        let mut writer = McapWriter::new(out, "ros2")?;
        let joints = scenario
            .robot
            .robot
            .wheels()
            .iter()
            .zip(&scenario.robot.wheels);
        let joints = joints.map(|(wheel, mount)| {
            let encoder = &wheel.encoder;
            Joint {
                wheel: wheel.name.clone(),
                name: mount.joint.clone(),
                counter: Counter::new(encoder.counter),
                per_tick: encoder.ticks_per_turn.map_or(0.0, |ticks| TAU / ticks),
                max_torque: mount.motor.map_or(0.0, |motor| motor.max_torque()),
            }
        });
        let sensors = &scenario.sensors;
        let wheels = || scenario.robot.wheels.iter();
        let mut mounting = writer.topic("/tf_static", "tf2_msgs/TFMessage")?;
        writer.send(&mut mounting, 0, &straight_mounting())?;
        let mut topic = |name: &str, type_name| writer.topic(name, type_name);
        Ok(Self {
            joints: joints.collect(),
            links: scenario.robot.turned_links(),
            open: Wheels::default(),
            ticks: topic("/wheel_ticks", known::WHEEL_TICKS)?,
            states: topic("/joint_states", "sensor_msgs/JointState")?,
            contacts: (sensors.sinkage_rate.max(sensors.entry_angle_rate) > 0.0)
                .then(|| topic("/wheel_contacts", known::JOINT_INTERFACES))
                .transpose()?,
            edges: (sensors.edge_clock > 0.0)
                .then(|| topic("/wheel_edges", known::JOINT_INTERFACES))
                .transpose()?,
            imu: topic("/imu", "sensor_msgs/Imu")?,
            camera: (sensors.camera_rate > 0.0)
                .then(|| topic("/camera/displacement", known::DISPLACEMENT))
                .transpose()?,
            gnss: (sensors.gnss_rate > 0.0)
                .then(|| topic("/gnss/pose", "geometry_msgs/PoseStamped"))
                .transpose()?,
            seen: topic("/grouser/slip", known::WHEEL_SLIP)?,
            soil: scenario
                .learns_on_board()
                .then(|| topic("/grouser/soil", known::SOIL))
                .transpose()?,
            pose: topic(
                &format!("{}pose", known::TRUTH),
                "geometry_msgs/PoseStamped",
            )?,
            slip: topic(&format!("{}slip", known::TRUTH), known::WHEEL_SLIP)?,
            scene: Scene {
                robot: topic("/grouser/robot", "visualization_msgs/MarkerArray")?,
                way: topic("/grouser/way", "visualization_msgs/Marker")?,
                ruts: topic("/grouser/ruts", "visualization_msgs/Marker")?,
                points: topic("/grouser/points", "sensor_msgs/PointCloud2")?,
                wheel_points: WheelPoints::new(wheels().count()),
                way_markers: WayMarkers::default(),
                rut_markers: RutMarkers::new(
                    wheels().map(|wheel| (wheel.name.as_str(), wheel.wheel.width())),
                ),
                sizes: wheels()
                    .map(|wheel| [wheel.wheel.radius(), wheel.wheel.width()])
                    .collect(),
                drawn_ns: None,
            },
            writer,
        })
    }

    /// What arrived in one period, and what was true at its end.
    pub(super) fn add(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        let arrived_ns = nanoseconds(frame.time);
        for sample in frame.samples {
            // a stamp of 0 would be none: readers take the time of recording for it, which is that of the second reading
            let time_ns = sample.time_ns.max(1);
            match sample.measurement {
                Measurement::WheelCount { wheel, raw } => {
                    self.at(time_ns, arrived_ns)?;
                    self.open.counts.push((wheel, raw));
                }
                Measurement::Displacement {
                    forward,
                    left,
                    turn,
                } => {
                    if let Some(topic) = &mut self.camera {
                        let header = build::header(time_ns, "base_link");
                        let value = build::displacement(header, forward, left, turn);
                        self.writer.send(topic, arrived_ns, &value)?;
                    }
                }
                Measurement::Pose { x, y, yaw } => {
                    if let Some(topic) = &mut self.gnss {
                        let header = build::header(time_ns, "map");
                        let pose = build::pose(x, y, yaw);
                        let value = build::message([("header", header), ("pose", pose)]);
                        self.writer.send(topic, arrived_ns, &value)?;
                    }
                }
                Measurement::Inertial { force, rate } => {
                    let value = imu(time_ns, rate, force);
                    self.writer.send(&mut self.imu, arrived_ns, &value)?;
                }
                Measurement::WheelEdge { wheel, forward } => {
                    if let Some(topic) = &mut self.edges {
                        let header = build::header(time_ns, "base_link");
                        let names = [self.joints[wheel].name.as_str()];
                        let edge = Some(if forward { 1.0 } else { -1.0 });
                        let value = build::wheel_contacts(header, &names, &[[None, None, edge]]);
                        self.writer.send(topic, arrived_ns, &value)?;
                    }
                }
                Measurement::Sinkage { wheel, depth } => {
                    self.at(time_ns, arrived_ns)?;
                    self.open.contacts.entry(wheel).or_default()[0] = Some(depth);
                }
                Measurement::EntryAngle { wheel, angle } => {
                    self.at(time_ns, arrived_ns)?;
                    self.open.contacts.entry(wheel).or_default()[1] = Some(angle);
                }
                Measurement::JointAngle { joint, angle } => {
                    self.at(time_ns, arrived_ns)?;
                    self.open.angles.push((joint, angle));
                }
                Measurement::MotorCurrent { wheel, share } => {
                    self.at(time_ns, arrived_ns)?;
                    self.open.shares.push((wheel, share));
                }
                _ => {}
            }
        }
        self.flush(arrived_ns)?;
        self.state(frame, arrived_ns)?;
        self.picture(frame, arrived_ns)
    }

    /// Ends the file and gives it back.
    pub(super) fn finish(self) -> io::Result<OutputFile> {
        self.writer.finish()
    }

    /// Readings of another stamp belong into another message.
    fn at(&mut self, stamp_ns: i64, arrived_ns: i64) -> io::Result<()> {
        if self.open.stamp_ns != stamp_ns {
            self.flush(arrived_ns)?;
            self.open.stamp_ns = stamp_ns;
        }
        Ok(())
    }

    fn flush(&mut self, arrived_ns: i64) -> io::Result<()> {
        let open = std::mem::take(&mut self.open);
        if let Some(topic) = self.contacts.as_mut().filter(|_| !open.contacts.is_empty()) {
            let (wheels, values): (Vec<usize>, Vec<_>) = open.contacts.into_iter().unzip();
            let names = wheels.iter().map(|wheel| self.joints[*wheel].name.as_str());
            let names: Vec<&str> = names.collect();
            let header = build::header(open.stamp_ns, "base_link");
            let value = build::wheel_contacts(header, &names, &values);
            self.writer.send(topic, arrived_ns, &value)?;
        }
        if open.counts.is_empty() {
            return Ok(());
        }
        let names: Vec<&str> = open
            .counts
            .iter()
            .map(|(wheel, _)| self.joints[*wheel].name.as_str())
            .collect();
        let header = || build::header(open.stamp_ns, "base_link");
        let raw: Vec<u64> = open.counts.iter().map(|(_, raw)| *raw).collect();
        let value = build::wheel_ticks(header(), &names, &raw);
        self.writer.send(&mut self.ticks, arrived_ns, &value)?;
        let effort = open.counts.iter().map(|(wheel, _)| {
            let most = self.joints[*wheel].max_torque;
            let share = open.shares.iter().find(|(own, _)| own == wheel);
            match share {
                Some((_, share)) => share * most,
                None if most == 0.0 => 0.0,
                None => f64::NAN,
            }
        });
        let mut effort: Vec<f64> = effort.collect();
        let mut position = Vec::with_capacity(open.counts.len());
        for (wheel, raw) in &open.counts {
            let joint = &mut self.joints[*wheel];
            joint.counter.advance(*raw);
            position.push(joint.counter.total() as f64 * joint.per_tick);
        }
        let wheels = (open.counts.iter()).map(|(wheel, _)| self.joints[*wheel].name.as_str());
        let mut names: Vec<&str> = wheels.collect();
        for (joint, angle) in open.angles {
            if let Some(link) = self.links.get(joint) {
                names.push(link);
                position.push(angle);
                effort.push(f64::NAN);
            }
        }
        let names = build::texts(&names);
        let value = build::message([
            ("header", header()),
            ("name", names),
            ("position", build::numbers(&position)),
            ("velocity", build::numbers(&[])),
            ("effort", build::numbers(&effort)),
        ]);
        self.writer.send(&mut self.states, arrived_ns, &value)
    }

    fn state(&mut self, frame: &Frame<'_>, now_ns: i64) -> io::Result<()> {
        let [x, y, z] = frame.place;
        let pose = build::message([
            ("position", build::vector([x, y, z])),
            ("orientation", build::orientation(frame.angles)),
        ]);
        let header = build::header(now_ns, "map");
        let value = build::message([("header", header), ("pose", pose)]);
        self.writer.send(&mut self.pose, now_ns, &value)?;
        let truth = self.slips(frame, now_ns, |wheel| (wheel.slip, None, "", String::new()));
        self.writer.send(&mut self.slip, now_ns, &truth)?;
        let seen = self.slips(frame, now_ns, |wheel| {
            let motion = wheel
                .observation
                .motion
                .map_or("", grouser_slip::Motion::name);
            let health: Health = wheel.observation.health;
            (
                wheel.observation.slip,
                wheel.observation.sigma,
                motion,
                health.to_string(),
            )
        });
        self.writer.send(&mut self.seen, now_ns, &seen)?;
        if let (Some(topic), Some(soil)) = (&mut self.soil, &frame.soil) {
            self.writer.send(
                topic,
                now_ns,
                &soil_message(build::header(now_ns, "base_link"), soil),
            )?;
        }
        Ok(())
    }

    fn picture(&mut self, frame: &Frame<'_>, now_ns: i64) -> io::Result<()> {
        let Scene {
            robot,
            way,
            ruts,
            points,
            sizes,
            way_markers,
            rut_markers,
            wheel_points,
            drawn_ns,
        } = &mut self.scene;
        let header = || build::header(now_ns, "map");
        let wheels = || frame.wheels.iter().zip(sizes.iter().copied());
        for (wheel, (seen, [radius, _])) in wheels().enumerate() {
            let [x, y, z] = seen.place;
            let bottom = [x, y, z - radius];
            if let Some(marker) = rut_markers.add(now_ns, wheel, bottom, seen.sinkage, header) {
                self.writer.send(ruts, now_ns, &marker)?;
            }
            wheel_points.add(wheel, bottom, seen.observation.slip);
        }
        if let Some(cloud) = wheel_points.piece(now_ns, header) {
            self.writer.send(points, now_ns, &cloud)?;
        }
        let slips = frame.wheels.iter().map(|wheel| wheel.observation.slip);
        if let Some(marker) = way_markers.add_point(now_ns, frame.place, slips, header) {
            self.writer.send(way, now_ns, &marker)?;
        }
        if drawn_ns.is_none_or(|drawn| now_ns.saturating_sub(drawn) >= PICTURE_NS) {
            *drawn_ns = Some(now_ns);
            let wheels: Vec<DrawnWheel> = wheels()
                .map(|(wheel, [radius, width])| DrawnWheel {
                    centre: wheel.place,
                    heading: wheel.heading,
                    radius,
                    width,
                    slip: wheel.observation.slip,
                })
                .collect();
            let picture = robot_markers(&header(), frame.angles, &wheels);
            self.writer.send(robot, now_ns, &picture)?;
        }
        Ok(())
    }

    fn slips(
        &self,
        frame: &Frame<'_>,
        now_ns: i64,
        of: impl Fn(&WheelFrame) -> (Option<f64>, Option<f64>, &'static str, String),
    ) -> Value {
        let names: Vec<&str> = self
            .joints
            .iter()
            .map(|joint| joint.wheel.as_str())
            .collect();
        let (mut slips, mut sigmas) = (Vec::new(), Vec::new());
        let (mut motions, mut healths) = (Vec::new(), Vec::new());
        for wheel in frame.wheels {
            let (slip, sigma, motion, health) = of(wheel);
            slips.push(slip.unwrap_or(f64::NAN));
            sigmas.push(sigma.unwrap_or(f64::NAN));
            motions.push(motion);
            healths.push(health);
        }
        build::message([
            ("header", build::header(now_ns, "base_link")),
            ("name", build::texts(&names)),
            ("slip", build::numbers(&slips)),
            ("slip_sigma", build::numbers(&sigmas)),
            ("motion", build::texts(&motions)),
            ("health", build::texts(&healths)),
        ])
    }
}

/// `sensor_msgs/Imu` without an orientation; how good the rest is, is not said.
fn imu(stamp_ns: i64, turning: [f64; 3], force: [f64; 3]) -> Value {
    let absent = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    build::message([
        ("header", build::header(stamp_ns, "imu_link")),
        ("orientation", build::turn(0.0)),
        ("orientation_covariance", build::numbers(&absent)),
        ("angular_velocity", build::vector(turning)),
        ("angular_velocity_covariance", build::numbers(&[0.0; 9])),
        ("linear_acceleration", build::vector(force)),
        ("linear_acceleration_covariance", build::numbers(&[0.0; 9])),
    ])
}

/// `tf2_msgs/TFMessage`: the inertial unit's axes are the robot's.
fn straight_mounting() -> Value {
    let transform = build::message([
        ("translation", build::vector([0.0; 3])),
        ("rotation", build::turn(0.0)),
    ]);
    let stamped = build::message([
        ("header", build::header(0, "base_link")),
        ("child_frame_id", Value::Text("imu_link".into())),
        ("transform", transform),
    ]);
    build::message([("transforms", Value::Array(vec![stamped]))])
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a drive lasts 1e6 s at most, as the scenario is checked"
)]
fn nanoseconds(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}
