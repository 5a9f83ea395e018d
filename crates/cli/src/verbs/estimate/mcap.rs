//! `estimate -o OUT.mcap`: slip, odometry and diagnostics as messages of ROS 2.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/grouser/slip` | `grouser_msgs/WheelSlip` | whenever a wheel was read |
//! | `/grouser/odom` | `nav_msgs/Odometry`, the slip in its covariance | likewise |
//! | `/grouser/way` | `visualization_msgs/Marker`, the way coloured by slip | every second of motion |
//! | `/grouser/robot` | `visualization_msgs/MarkerArray`, body and wheels coloured by slip | five times a second |
//! | `/grouser/pose` | `geometry_msgs/PoseStamped` | with it |
//! | `/grouser/points` | `sensor_msgs/PointCloud2`, where wheels touched the ground, with slips | every second of motion |
//! | `/grouser/soil` | `grouser_msgs/Soil`, what is learnt with `--learn-soil` | every second |
//! | `/diagnostics` | `diagnostic_msgs/DiagnosticArray` | every second |

use std::io;
use std::path::Path;

use grouser_log::message::{Header, build, known};
use grouser_log::write::{McapWriter, Topic};
use grouser_replay::messages::{
    DrawnWheel, WayMarkers, WheelPoints, diagnostics, robot_markers, soil_message, write_odometry,
    write_wheel_slip,
};
use grouser_replay::{Odometry, Step};
use grouser_slip::{Wheel, WheelEstimate};

use crate::error::{Error, Result, shown};
use crate::output::OutputFile;

/// Between two messages of diagnostics, ns.
const DIAGNOSTICS_NS: i64 = 1_000_000_000;

/// Between two pictures of the robot, ns.
const PICTURE_NS: i64 = 200_000_000;
/// Width of a wheel of which the robot file has none, as a share of its radius.
const DRAWN_WIDTH_SHARE: f64 = 0.6;

/// The file in the making.
pub(super) struct Recording {
    writer: McapWriter<OutputFile>,
    slip: Topic,
    odometry: Topic,
    way: Topic,
    robot: Topic,
    pose: Topic,
    points: Topic,
    diagnostics: Topic,
    /// From the first soil that was learnt.
    soil: Option<Topic>,
    markers: WayMarkers,
    wheel_points: WheelPoints,
    wheels: Vec<Wheel>,
    names: Vec<String>,
    /// The message at hand.
    message: Vec<u8>,
    drawn_ns: Option<i64>,
    reported_ns: Option<i64>,
    path: std::path::PathBuf,
}

impl Recording {
    /// Begins the file.
    pub(super) fn begin(path: &Path, wheels: &[Wheel]) -> Result<Self> {
        let refused = |error: io::Error| Error::file("write", path, &error);
        let output = OutputFile::create(path)?;
        let mut writer = McapWriter::new(output, "ros2").map_err(refused)?;
        let mut topic = |name, type_name| writer.topic(name, type_name).map_err(refused);
        Ok(Self {
            slip: topic("/grouser/slip", known::WHEEL_SLIP)?,
            odometry: topic("/grouser/odom", "nav_msgs/Odometry")?,
            way: topic("/grouser/way", "visualization_msgs/Marker")?,
            robot: topic("/grouser/robot", "visualization_msgs/MarkerArray")?,
            pose: topic("/grouser/pose", "geometry_msgs/PoseStamped")?,
            points: topic("/grouser/points", "sensor_msgs/PointCloud2")?,
            markers: WayMarkers::default(),
            wheel_points: WheelPoints::new(wheels.len()),
            diagnostics: topic("/diagnostics", "diagnostic_msgs/DiagnosticArray")?,
            soil: None,
            writer,
            wheels: wheels.to_vec(),
            names: wheels.iter().map(|wheel| wheel.name.clone()).collect(),
            message: Vec::new(),
            drawn_ns: None,
            reported_ns: None,
            path: path.to_owned(),
        })
    }

    /// What is known after the records of one time.
    pub(super) fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let time_ns = step.time_ns;
        let wheels = step.wheels;
        let header = |frame| build::header(time_ns, frame);
        let stamped = |frame| Header { time_ns, frame };
        let message = &mut self.message;
        write_wheel_slip(message, stamped("base_link"), &self.names, wheels)
            .map_err(io::Error::other)?;
        self.writer.send_encoded(&mut self.slip, time_ns, message)?;
        if let Some(odometry) = step.odometry {
            write_odometry(message, stamped("odom"), "base_link", &odometry)
                .map_err(io::Error::other)?;
            (self.writer).send_encoded(&mut self.odometry, time_ns, message)?;
            let marker = self
                .markers
                .add(time_ns, &odometry, wheels, || header("odom"));
            if let Some(marker) = marker {
                self.writer.send(&mut self.way, time_ns, &marker)?;
            }
            let due = |drawn: i64| time_ns.saturating_sub(drawn) >= PICTURE_NS;
            if self.drawn_ns.is_none_or(due) {
                self.drawn_ns = Some(time_ns);
                let drawn = drawn(&self.wheels, wheels, &odometry);
                let angles = [0.0, 0.0, odometry.pose[2]];
                let picture = robot_markers(&header("odom"), angles, &drawn);
                self.writer.send(&mut self.robot, time_ns, &picture)?;
                let [x, y, yaw] = odometry.pose;
                let pose =
                    build::message([("header", header("odom")), ("pose", build::pose(x, y, yaw))]);
                self.writer.send(&mut self.pose, time_ns, &pose)?;
                for (number, wheel) in drawn.iter().enumerate() {
                    let [x, y, z] = wheel.centre;
                    let bottom = [x, y, z - wheel.radius];
                    self.wheel_points.add(number, bottom, wheel.slip);
                }
                let cloud = self.wheel_points.piece(time_ns, || header("odom"));
                if let Some(cloud) = cloud {
                    self.writer.send(&mut self.points, time_ns, &cloud)?;
                }
            }
        }
        let due = |last: i64| time_ns.saturating_sub(last) >= DIAGNOSTICS_NS;
        if self.reported_ns.is_none_or(due) {
            self.reported_ns = Some(time_ns);
            let message = diagnostics(header(""), &self.names, wheels);
            self.writer.send(&mut self.diagnostics, time_ns, &message)?;
            if let Some(soil) = &step.soil {
                if self.soil.is_none() {
                    self.soil = Some(self.writer.topic("/grouser/soil", known::SOIL)?);
                }
                if let Some(topic) = &mut self.soil {
                    let message = soil_message(header("base_link"), soil);
                    self.writer.send(topic, time_ns, &message)?;
                }
            }
        }
        Ok(())
    }

    /// Where it will stand.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the complete file in its place; gives a line that says so.
    pub(super) fn finish(self) -> Result<String> {
        let output = self.writer.finish();
        let output = output.map_err(|error| Error::file("write", &self.path, &error))?;
        output.finish()?;
        Ok(format!("wrote {}\n", shown(&self.path)))
    }
}

/// The wheels on level ground under the robot's pose, straight ahead: the steering is not in the odometry.
fn drawn(wheels: &[Wheel], estimates: &[WheelEstimate], odometry: &Odometry) -> Vec<DrawnWheel> {
    let [x, y, yaw] = odometry.pose;
    let (sin, cos) = yaw.sin_cos();
    let pairs = wheels.iter().zip(estimates);
    pairs
        .map(|(wheel, estimate)| DrawnWheel {
            centre: [
                x + cos * wheel.x - sin * wheel.y,
                y + sin * wheel.x + cos * wheel.y,
                wheel.radius,
            ],
            heading: yaw + wheel.heading.rad(),
            radius: wheel.radius,
            width: wheel.width.unwrap_or(DRAWN_WIDTH_SHARE * wheel.radius),
            slip: estimate.slip.map(grouser_slip::Slip::value),
        })
        .collect()
}
