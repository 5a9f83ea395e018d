//! `estimate -o OUT.mcap`: slip, odometry and diagnostics as messages of ROS 2.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/grouser/slip` | `grouser_msgs/WheelSlip` | whenever a wheel was read |
//! | `/grouser/odom` | `nav_msgs/Odometry`, the slip in its covariance | likewise |
//! | `/grouser/way` | `visualization_msgs/Marker`, the way coloured by slip | every second of motion |
//! | `/diagnostics` | `diagnostic_msgs/DiagnosticArray` | every second |

use std::io;
use std::path::Path;

use grouser_log::message::{build, known};
use grouser_log::write::{McapWriter, Topic};
use grouser_replay::Step;
use grouser_replay::messages::{WayMarkers, diagnostics, odometry_message, wheel_slip};
use grouser_slip::Wheel;

use crate::error::{Error, Result, shown};
use crate::output::OutputFile;

/// Between two messages of diagnostics, ns.
const DIAGNOSTICS_NS: i64 = 1_000_000_000;

/// The file in the making.
pub(super) struct Recording {
    writer: McapWriter<OutputFile>,
    slip: Topic,
    odometry: Topic,
    way: Topic,
    diagnostics: Topic,
    markers: WayMarkers,
    names: Vec<String>,
    told_ns: Option<i64>,
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
            markers: WayMarkers::default(),
            diagnostics: topic("/diagnostics", "diagnostic_msgs/DiagnosticArray")?,
            writer,
            names: wheels.iter().map(|wheel| wheel.name.clone()).collect(),
            told_ns: None,
            path: path.to_owned(),
        })
    }

    /// What is known after the records of one time.
    pub(super) fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let time_ns = step.time_ns;
        let wheels = step.wheels;
        let header = |frame| build::header(time_ns, frame);
        let slip = wheel_slip(header("base_link"), &self.names, wheels);
        self.writer.send(&mut self.slip, time_ns, &slip)?;
        if let Some(odometry) = step.odometry {
            let message = odometry_message(header("odom"), "base_link", &odometry);
            self.writer.send(&mut self.odometry, time_ns, &message)?;
            let marker = self
                .markers
                .add(time_ns, &odometry, wheels, || header("odom"));
            if let Some(marker) = marker {
                self.writer.send(&mut self.way, time_ns, &marker)?;
            }
        }
        let due = |told: i64| time_ns.saturating_sub(told) >= DIAGNOSTICS_NS;
        if self.told_ns.is_none_or(due) {
            self.told_ns = Some(time_ns);
            let message = diagnostics(header(""), &self.names, wheels);
            self.writer.send(&mut self.diagnostics, time_ns, &message)?;
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
