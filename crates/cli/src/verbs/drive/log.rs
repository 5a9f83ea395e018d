//! The log of a drive's sensors, written while it drives: what `estimate` reads.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use grouser_rover::drive::{Frame, Scenario};
use grouser_slip::Measurement;
use grouser_slip::onboard::SoilEstimate;

use super::mcap::Recording;
use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::output::OutputFile;
use grouser_report::number::exact;

/// The file in the making.
pub(super) struct Log {
    kind: Kind,
    path: PathBuf,
}

enum Kind {
    Table(Box<Table>),
    Recording(Box<Recording>),
}

impl Log {
    /// Begins the file; its ending says its kind.
    pub(super) fn begin(path: &Path, scenario: &Scenario) -> Result<Self> {
        let refused = |error: io::Error| Error::file("write", path, &error);
        let kind = match ending(path).as_deref() {
            Some("csv") => Table::begin(OutputFile::create(path)?, scenario)
                .map(|table| Kind::Table(Box::new(table))),
            Some("mcap") => Recording::begin(OutputFile::create(path)?, scenario)
                .map(|recording| Kind::Recording(Box::new(recording))),
            _ => {
                return Err(Error::usage_without_hint(format!(
                    "the log {} does not end in `.csv` or `.mcap`",
                    shown(path)
                )));
            }
        };
        Ok(Self {
            kind: kind.map_err(refused)?,
            path: path.to_owned(),
        })
    }

    /// What arrived in one period of the control loop.
    pub(super) fn add(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        match &mut self.kind {
            Kind::Table(table) => table.add(frame),
            Kind::Recording(recording) => recording.add(frame),
        }
    }

    /// Puts the complete file in its place; gives a line that says so.
    pub(super) fn finish(self) -> Result<String> {
        let out = match self.kind {
            Kind::Table(table) => Ok(table.out),
            Kind::Recording(recording) => recording.finish(),
        };
        out.map_err(|error| Error::file("write", &self.path, &error))?
            .finish()?;
        Ok(format!("wrote {}\n", shown(&self.path)))
    }

    /// What the system says when a write fails.
    pub(super) fn refused(&self, error: &io::Error) -> Error {
        Error::file("write", &self.path, error)
    }
}

/// A table: `time_ms`, the counter of each wheel with an encoder, the torque of each with a motor, gyro, accelerometer,
/// angles of rockers and arms, sinkages, entry angles and encoder edges where they are measured, the soil where it is learnt, and
/// tip-over margin, energy and positions of a chassis with actuators.
struct Table {
    out: OutputFile,
    last_ns: i64,
    counts: Vec<Option<u64>>,
    /// Angles of the suspension's joints.
    angles: Vec<Option<f64>>,
    torques: Vec<Option<f64>>,
    /// Sinkage and entry angle of each wheel.
    contacts: Vec<[Option<f64>; 2]>,
    /// Which of both is measured.
    measures_contact: [bool; 2],
    /// Torque on each wheel for its motor's greatest current, N m; `None` without a motor.
    max_torques: Vec<Option<f64>>,
    /// Each wheel whose encoder stamps its edges, and the column of these: an edge is a row of its own.
    edges: Vec<(usize, usize)>,
    columns: usize,
    /// Does the robot learn its soil?
    has_soil: bool,
}

impl Table {
    fn begin(mut out: OutputFile, scenario: &Scenario) -> io::Result<Self> {
        let wheels = scenario.robot.robot.wheels();
        let mut names = String::from("time_ms");
        for wheel in wheels {
            let _ = write!(names, ",{}_ticks", wheel.name);
        }
        let mounts = &scenario.robot.wheels;
        for mount in mounts.iter().filter(|mount| mount.motor.is_some()) {
            let _ = write!(names, ",{}_torque_nm", mount.name);
        }
        names.push_str(",gyro_x_rad_per_s,gyro_y_rad_per_s,gyro_z_rad_per_s");
        for direction in ["forward", "left", "up"] {
            let _ = write!(names, ",acceleration_{direction}_m_per_s2");
        }
        let links = scenario.robot.turned_links();
        for link in &links {
            let _ = write!(names, ",{link}_angle_rad");
        }
        let sensors = &scenario.sensors;
        let measures_contact =
            [sensors.sinkage_rate, sensors.entry_angle_rate].map(|rate| rate > 0.0);
        for (unit, _) in ["sinkage_m", "entry_angle_rad"]
            .into_iter()
            .zip(measures_contact)
            .filter(|(_, measured)| *measured)
        {
            for wheel in wheels {
                let _ = write!(names, ",{}_{unit}", wheel.name);
            }
        }
        let mut edges = Vec::new();
        for (index, mount) in mounts.iter().enumerate() {
            if mount.motor.is_none() && sensors.edge_clock > 0.0 {
                let _ = write!(names, ",{}_edge", mount.name);
                edges.push((index, names.matches(',').count()));
            }
        }
        let has_soil = scenario.learns_on_board();
        if has_soil {
            names.push_str(",soil_strength,soil_strength_low,soil_strength_high,soil_stiffness,soil_stiffness_low");
            names.push_str(",soil_stiffness_high,soil_phi_deg,soil_phi_low_deg,soil_phi_high_deg");
        }
        if !scenario.robot.actuators.is_empty() {
            names.push_str(",tip_over_margin_deg,used_energy_j");
            for own in &scenario.robot.actuators {
                let unit = if own.is_angle() { "deg" } else { "m" };
                let _ = write!(names, ",{}_{unit}", own.name);
            }
        }
        let columns = names.matches(',').count() + 1;
        writeln!(out, "{names}")?;
        Ok(Self {
            out,
            last_ns: 0,
            edges,
            columns,
            has_soil,
            angles: vec![None; links.len()],
            contacts: vec![[None; 2]; wheels.len()],
            measures_contact,
            counts: vec![None; wheels.len()],
            torques: vec![None; wheels.len()],
            max_torques: mounts
                .iter()
                .map(|mount| mount.motor.map(|motor| motor.max_torque()))
                .collect(),
        })
    }

    /// A row with an edge alone.
    fn edge(&mut self, time_ns: i64, wheel: usize, forward: bool) -> io::Result<()> {
        let Some((_, column)) = self.edges.iter().find(|(own, _)| *own == wheel) else {
            return Ok(());
        };
        write!(self.out, "{}", exact(time_ns as f64 * 1e-6))?;
        for cell in 1..self.columns {
            let value = match (cell == *column, forward) {
                (false, _) => "",
                (true, true) => "1",
                (true, false) => "-1",
            };
            write!(self.out, ",{value}")?;
        }
        self.out.write_all(b"\n")
    }

    fn add(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        self.counts.fill(None);
        self.torques.fill(None);
        self.contacts.fill([None; 2]);
        let mut time_ns = 0;
        self.angles.fill(None);
        let mut inertial = [None; 6];
        for sample in frame.samples {
            match sample.measurement {
                Measurement::WheelEdge { wheel, forward } => {
                    self.edge(sample.time_ns, wheel, forward)?;
                    continue;
                }
                Measurement::WheelCount { wheel, raw } => {
                    if let Some(slot) = self.counts.get_mut(wheel) {
                        *slot = Some(raw);
                    }
                }
                Measurement::Inertial { force, rate } => {
                    let ([roll, pitch, yaw], [forward, left, up]) = (rate, force);
                    inertial = [roll, pitch, yaw, forward, left, up].map(Some);
                }
                Measurement::JointAngle { joint, angle } => {
                    if let Some(slot) = self.angles.get_mut(joint) {
                        *slot = Some(angle);
                    }
                }
                Measurement::MotorCurrent { wheel, share } => {
                    if let Some(slot) = self.torques.get_mut(wheel) {
                        *slot = self.max_torques[wheel].map(|most| share * most);
                    }
                }
                Measurement::Sinkage { wheel, depth } => {
                    if let Some(slot) = self.contacts.get_mut(wheel) {
                        slot[0] = Some(depth);
                    }
                }
                Measurement::EntryAngle { wheel, angle } => {
                    if let Some(slot) = self.contacts.get_mut(wheel) {
                        slot[1] = Some(angle);
                    }
                }
                _ => continue,
            }
            time_ns = time_ns.max(sample.time_ns);
        }
        if time_ns <= self.last_ns {
            return Ok(());
        }
        self.last_ns = time_ns;
        write!(self.out, "{}", time_ns / 1_000_000)?;
        for count in &self.counts {
            match count {
                Some(count) => write!(self.out, ",{count}")?,
                None => self.out.write_all(b",")?,
            }
        }
        let torques = self.torques.iter().zip(&self.max_torques);
        let torques = torques.filter_map(|(torque, most)| most.map(|_| *torque));
        let soil = self
            .has_soil
            .then(|| frame.soil.as_ref().map_or([None; 9], soil_columns));
        let contacts = (0..2).filter(|sensor| self.measures_contact[*sensor]);
        let contacts = contacts.flat_map(|sensor| self.contacts.iter().map(move |own| own[sensor]));
        for value in torques
            .chain(inertial)
            .chain(self.angles.iter().copied())
            .chain(contacts)
            .chain(self.edges.iter().map(|_| None))
            .chain(soil.into_iter().flatten())
            .chain(posture_columns(frame))
        {
            // a table holds numbers; what a broken sensor shows instead is an empty cell
            match value.filter(|value| value.is_finite()) {
                Some(value) => write!(self.out, ",{}", exact(value))?,
                None => self.out.write_all(b",")?,
            }
        }
        self.out.write_all(b"\n")
    }
}

/// Margin (°), energy (J) and positions (° or m) of a chassis with actuators.
fn posture_columns(frame: &Frame<'_>) -> impl Iterator<Item = Option<f64>> {
    let positions = frame.actuators.iter().map(|own| {
        Some(if own.is_angle() {
            own.position.to_degrees()
        } else {
            own.position
        })
    });
    let margin = frame.tip_over_margin.map(f64::to_degrees);
    let first = (!frame.actuators.is_empty()).then_some([margin, Some(frame.energy)]);
    first.into_iter().flatten().chain(positions)
}

/// Strength, stiffness and friction angle (°), each with its interval.
fn soil_columns(soil: &SoilEstimate) -> [Option<f64>; 9] {
    let (strength, stiffness, angle) = (soil.strength, soil.stiffness, soil.friction_angle);
    [
        strength.mean,
        strength.low,
        strength.high,
        stiffness.mean,
        stiffness.low,
        stiffness.high,
        angle.mean.to_degrees(),
        angle.low.to_degrees(),
        angle.high.to_degrees(),
    ]
    .map(Some)
}
