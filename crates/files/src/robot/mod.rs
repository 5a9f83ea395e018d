//! Robot files: the wheels, and how their slip is to be estimated.
//!
//! ```toml
//! format = 1
//! name = "two wheels and a free one"
//! gravity_m_per_s2 = "mars"   # where it drives: a number, or "earth" (the default), "moon", "mars"
//!
//! [estimator]                 # all optional
//! reference = "free-wheel"    # or displacement, pose, speed, grip
//! position_sigma_m = 0.001    # standard deviation of a measured position
//!
//! [filter]                    # all optional: settings of the slip filter beyond [estimator]
//! slip_mean = 0.1             # what is believed of the powered wheels' slip before it is measured
//! slip_sigma = 0.2
//!
//! [[wheel]]
//! name = "left"
//! x_m = 0.0                   # forwards of the robot's origin
//! y_m = 0.15                  # to the left of it
//! heading_deg = 0.0           # the direction in which it drives, from x towards y
//! radius_m = 0.05
//! drive = "powered"           # or "free"
//! encoder_on = "motor"        # or "wheel"
//! gear = 16.0                 # motor turns per wheel turn
//! ticks_per_turn = 2000       # of the encoder's shaft
//! counter_bits = 32           # the counter's width, 8 to 64
//! joint = "left_wheel_joint"  # its joint in messages, where its name is not enough
//! width_m = 0.05              # for the soil model, with load_n and the lugs, if it has some:
//! grouser_height_m = 0.005
//! grouser_count = 24
//! grouser_thickness_m = 0.0015  # along the rim; 0 by default
//! ```
//!
//! `[topics]` says what the topics of a bag mean ([`crate::topics`]); `[[table]]` what the columns of a
//! table mean, as in a column map ([`crate::columns`]), for those who want one file.

mod revision;
mod write;

use std::path::Path;

use grouser_slip::SensorSettings;
use grouser_slip::filter::FilterSettings;
use grouser_slip::onboard::SoilLearnSettings;
use grouser_slip::{CounterWidth, Encoder, Measurement, Reference, Robot, Shaft, Wheel, WheelRole};
use grouser_terra::Angle;

use crate::body::{self, BodyFile};
use crate::columns::{ColumnMap, read_table, resolve_links};
use crate::document::Document;
use crate::error::{Error, Result};
use crate::fields::read_fields;
use crate::gravity::read_gravity;
use crate::section::Section;
use crate::steering::{Steering, put_joint, read_section, resolve};
use crate::topics::{Topics, put_wheels, read_topics};
use crate::wheel_sizes::read_grousers;

pub use revision::{Revision, revised};
pub use write::to_toml;

/// Which of a wheel's sensors is to be used where a log holds several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelSensor {
    /// Tick counters.
    Count,
    /// Angles.
    Angle,
    /// Rates.
    Rate,
}

impl WheelSensor {
    /// Every sensor with its name in files and flags.
    pub const NAMES: [(&'static str, Self); 3] = [
        ("count", Self::Count),
        ("angle", Self::Angle),
        ("rate", Self::Rate),
    ];

    /// Its name in files and flags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Count => "count",
            Self::Angle => "angle",
            Self::Rate => "rate",
        }
    }

    /// Is a measurement used where wheels are measured by this sensor? One sensor of the wheels is, and everything else.
    #[must_use]
    pub const fn uses(self, measurement: &Measurement) -> bool {
        match measurement {
            Measurement::WheelCount { .. } => matches!(self, Self::Count),
            Measurement::WheelAngle { .. } => matches!(self, Self::Angle),
            Measurement::WheelRate { .. } => matches!(self, Self::Rate),
            _ => true,
        }
    }
}

/// What a robot file says.
///
/// ```
/// let file = grouser_files::robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
/// assert_eq!(file.robot.wheels().len(), 5);
/// assert!(file.body.is_none()); // an estimator needs no masses
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RobotFile {
    /// The robot.
    pub robot: Robot,
    /// Settings of the means that check the slips, and of the sensors; its `reference` counts only where [`RobotFile::reference`] does
    /// not say otherwise.
    pub settings: SensorSettings,
    /// Settings of the slip filter, with the values of `settings` where both have one.
    pub filter: FilterSettings,
    /// Does the file state `reference_latency_s`, be it 0? If not, a log may show the delay.
    pub is_reference_latency_stated: bool,
    /// The reference that the file names, if it names one.
    pub reference: Option<Reference>,
    /// The wheel sensor that the file names, if it names one.
    pub wheel_sensor: Option<WheelSensor>,
    /// Corrections of sensors and intervals, as calibrations find them.
    pub corrections: Corrections,
    /// Torque on each wheel per ampere of its motor, N m/A, where the file says it.
    pub torque_per_ampere: Vec<Option<f64>>,
    /// How one angle steers several wheels, if the file says it.
    pub steering: Option<Steering>,
    /// What the topics of a bag mean.
    pub topics: Topics,
    /// What the columns of a table mean, if the file says it.
    pub columns: Option<ColumnMap>,
    /// Masses, links and motors, if the file describes them.
    pub body: Option<BodyFile>,
    /// Gravity where the robot drives, m/s², if the file says it.
    pub gravity: Option<f64>,
    /// Standard deviations of a wheel's sinkage (m) and entry angle (rad), lasting errors included.
    pub contact_sigmas: [f64; 2],
}

/// Corrections of sensors and intervals, in `[estimator]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Corrections {
    /// Yaw of what measures the pose in the robot's frame (the markers of motion capture), rad.
    pub pose_yaw_offset: f64,
    /// Position of what measures the pose, the displacement or the speed in the robot's frame, forwards, to the left and above the ground, m.
    pub reference_place: [f64; 3],
    /// Factor on every yaw rate.
    pub yaw_rate_scale: f64,
    /// Factor on the standard deviation of every slip.
    pub interval_factor: f64,
}

impl Default for Corrections {
    fn default() -> Self {
        Self {
            pose_yaw_offset: 0.0,
            reference_place: [0.0; 3],
            yaw_rate_scale: 1.0,
            interval_factor: 1.0,
        }
    }
}

impl Corrections {
    const FACTOR: (f64, f64) = (0.01, 100.0);

    fn read(section: &Section<'_>) -> Result<Self> {
        let offset = section.optional_number("pose_yaw_offset_deg", (-360.0, 360.0))?;
        let scale = section.optional_number("yaw_rate_scale", (0.2, 5.0))?;
        let mut reference_place = [0.0; 3];
        for (place, key) in reference_place.iter_mut().zip(REFERENCE_PLACE_KEYS) {
            *place = section
                .optional_number(key, (-100.0, 100.0))?
                .unwrap_or(0.0);
        }
        let factor = section.optional_number("interval_factor", Self::FACTOR)?;
        Ok(Self {
            pose_yaw_offset: offset.map_or(0.0, f64::to_radians),
            reference_place,
            yaw_rate_scale: scale.unwrap_or(1.0),
            interval_factor: factor.unwrap_or(1.0),
        })
    }
}

pub(crate) const REFERENCE_PLACE_KEYS: [&str; 3] =
    ["reference_x_m", "reference_y_m", "reference_z_m"];
/// The key of [`FilterSettings::reference_latency`].
const REFERENCE_LATENCY_KEY: &str = "reference_latency_s";
const POSITION_SIGMA_KEY: &str = "position_sigma_m";

/// Wide enough for any sensible value; the robot itself checks more closely.
const POSITIVE: (f64, f64) = (1e-12, 1e12);

/// Reads a robot file.
///
/// # Errors
/// What the file lacks or says wrong, with its place.
///
/// ```
/// let file = grouser_files::robot::read("../../examples/five-wheel/robot.toml".as_ref())?;
/// assert!(file.robot.wheels()[0].radius > 0.0); // m
/// # Ok::<(), grouser_files::Error>(())
/// ```
pub fn read(path: &Path) -> Result<RobotFile> {
    parse(&Document::read(path)?)
}

/// Reads a robot out of a document.
///
/// # Errors
/// As [`read`].
pub fn parse(document: &Document) -> Result<RobotFile> {
    document.parse(|root| {
        let name = root.text("name")?;
        let gravity = read_gravity(root)?;
        let mut settings = SensorSettings::default();
        let mut reference = None;
        let mut wheel_sensor = None;
        let mut corrections = Corrections::default();
        let mut contact_sigmas = default_contact_sigmas();
        let mut is_position_sigma_stated = false;
        root.section("estimator", |section| {
            (reference, corrections) = read_estimator(section, &mut settings)?;
            is_position_sigma_stated = section.has(POSITION_SIGMA_KEY);
            wheel_sensor = section.optional_choice("wheel_sensor", &WheelSensor::NAMES)?;
            if let Some(sigma) = section.optional_number("sinkage_sigma_m", (1e-6, 1.0))? {
                contact_sigmas[0] = sigma;
            }
            if let Some(sigma) = section.optional_number("entry_angle_sigma_deg", (1e-4, 57.0))? {
                contact_sigmas[1] = sigma.to_radians();
            }
            Ok(())
        })?;
        let at = root.place_of("estimator");
        settings
            .check()
            .map_err(|source| Error::Robot { at, source })?;
        let position_sigma = is_position_sigma_stated.then_some(settings.position_sigma);
        let filter = filter_of(&settings, position_sigma);
        let (filter, is_reference_latency_stated) = read_filter(root, filter)?;
        let (mut topics, mut columns) = read_meanings(root)?;
        topics.position_sigma = position_sigma;
        topics.is_mounting_stated =
            corrections.reference_place[..2] != [0.0; 2] || corrections.pose_yaw_offset != 0.0;
        let steering = root.section("steering", read_section)?;
        let (mut joints, mut torque_per_ampere) = (Vec::new(), Vec::new());
        let wheels = root.sections("wheel", |section| {
            joints.push(section.optional_text("joint")?.map(str::to_owned));
            torque_per_ampere.push(section.optional_number("torque_per_ampere_nm", POSITIVE)?);
            Ok((read_wheel(section)?, body::read_wheel(section)?))
        })?;
        let (mut wheels, bodies): (Vec<Wheel>, Vec<_>) = wheels.into_iter().unzip();
        put_joint(steering.as_ref(), &mut wheels);
        let body = body::read(root, bodies)?;
        topics.suspension = body.as_ref().map(BodyFile::suspension);
        let tables = columns.iter_mut().flat_map(|map| &mut map.tables);
        let fields = topics.fields.iter_mut().map(|of| &mut of.fields);
        for columns in tables.map(|table| &mut table.columns).chain(fields) {
            let links = topics.suspension.as_deref().unwrap_or_default();
            resolve_links(columns, links).map_err(|message| Error::Contradiction {
                at: root.place_of("table"),
                message,
            })?;
        }
        let robot = Robot::new(name.into(), wheels).map_err(|source| Error::Robot {
            at: root.place_of("wheel"),
            source,
        })?;
        let steering = steering
            .map(|section| resolve(&section, &robot))
            .transpose();
        let steering = steering.map_err(|message| Error::Contradiction {
            at: root.place_of("steering"),
            message,
        })?;
        put_wheels(&mut topics, &robot, joints).map_err(|message| Error::Contradiction {
            at: root.place_of("topics"),
            message,
        })?;
        Ok(RobotFile {
            robot,
            settings,
            filter,
            is_reference_latency_stated,
            reference,
            wheel_sensor,
            corrections,
            torque_per_ampere,
            steering,
            topics,
            columns,
            body,
            gravity,
            contact_sigmas,
        })
    })
}

/// Those of sensors that the file does not describe.
pub(crate) fn default_contact_sigmas() -> [f64; 2] {
    let usual = SoilLearnSettings::default();
    [usual.sinkage_sigma, usual.entry_angle_sigma]
}

/// What the file says of topics and of columns.
fn read_meanings(root: &Section<'_>) -> Result<(Topics, Option<ColumnMap>)> {
    let topics = root.section("topics", read_topics)?.unwrap_or_default();
    let tables = root.sections("table", read_table)?;
    let columns = (!tables.is_empty()).then_some(ColumnMap { tables });
    Ok((topics, columns))
}

fn read_estimator(
    section: &Section<'_>,
    settings: &mut SensorSettings,
) -> Result<(Option<Reference>, Corrections)> {
    refuse_removed(section, "[estimator]", &REMOVED_ESTIMATOR_KEYS)?;
    read_fields(section, settings, SensorSettings::FIELDS)?;
    let references = Reference::ALL.map(|reference| (reference.name(), reference));
    let corrections = Corrections::read(section)?;
    let reference = section.optional_choice("reference", &references)?;
    Ok((reference, corrections))
}

/// The settings of the slip filter without `[filter]`: the defaults, then the values of `[estimator]`, of which that of a position
/// counts only where the file states it.
pub(crate) fn filter_of(settings: &SensorSettings, position_sigma: Option<f64>) -> FilterSettings {
    let usual = FilterSettings::default();
    FilterSettings {
        position_sigma: position_sigma.unwrap_or(usual.position_sigma),
        yaw_sigma: settings.yaw_sigma,
        speed_sigma: settings.speed_sigma,
        max_speed: settings.max_speed,
        dropout: settings.dropout,
        ..usual
    }
}

/// Keys that `[estimator]` had, with what replaced each of them.
const REMOVED_ESTIMATOR_KEYS: [(&str, &str); 4] = [
    (
        "window_s",
        "the slip filter replaces means over windows, and follows wheels by the period of their readings",
    ),
    (
        "max_slip_sigma",
        "a slip is `Degraded(Quantised)` from a standard deviation of 0.25 on",
    ),
    (
        "yaw_rate_sigma_deg_per_s",
        "the model of the motion replaces it",
    ),
    (
        "lateral_sigma_m_per_s",
        "the model of the motion replaces it",
    ),
];

/// Keys that `[filter]` had, with what replaced each of them.
const REMOVED_FILTER_KEYS: [(&str, &str); 10] = [
    (
        "wheel_window_s",
        "wheels are read over steps of 50 ms, or of the slowest wheel's period",
    ),
    (
        "speed_walk_m_per_s_sqrt_s",
        "the model of the motion replaces it",
    ),
    (
        "accelerometer_noise_m_per_s_sqrt_s",
        "the model of the motion replaces it",
    ),
    (
        "accelerometer_bias_m_per_s2",
        "`accelerometer_drift_m_per_s2_sqrt_s` alone describes the accelerometer",
    ),
    (
        "yaw_walk_deg_per_s_sqrt_s",
        "the model of the motion replaces it",
    ),
    (
        "gyro_bias_deg_per_s",
        "the bias of the gyro is learnt without a prior",
    ),
    (
        "slip_memory_s",
        "modes of the slip that are weighed by the readings replace it",
    ),
    (
        "wheel_slip_sigma",
        "modes of the slip that are weighed by the readings replace it",
    ),
    (
        "wheel_slip_memory_s",
        "modes of the slip that are weighed by the readings replace it",
    ),
    (
        "radius_sigma",
        "radii are not learnt online; `estimate --calibrate-radius` finds them",
    ),
];

/// Refuses a key that a section no longer has.
fn refuse_removed(
    section: &Section<'_>,
    name: &'static str,
    removed: &[(&'static str, &'static str)],
) -> Result<()> {
    match removed.iter().find(|(key, _)| section.has(key)) {
        Some((key, instead)) => Err(Error::RemovedKey {
            at: section.place_of(key),
            section: name,
            key,
            instead,
        }),
        None => Ok(()),
    }
}

/// Reads the keys of `[filter]`; one that it no longer has is refused.
pub(crate) fn read_filter_fields(section: &Section<'_>, filter: &mut FilterSettings) -> Result<()> {
    refuse_removed(section, "[filter]", &REMOVED_FILTER_KEYS)?;
    read_fields(section, filter, FilterSettings::FIELDS)
}

/// The settings of the slip filter, and whether the file states the reference's delay.
fn read_filter(root: &Section<'_>, mut filter: FilterSettings) -> Result<(FilterSettings, bool)> {
    let mut is_latency_stated = false;
    root.section("filter", |section| {
        is_latency_stated = section.has(REFERENCE_LATENCY_KEY);
        read_filter_fields(section, &mut filter)
    })?;
    filter.check().map_err(|source| Error::Robot {
        at: root.place_of("filter"),
        source,
    })?;
    Ok((filter, is_latency_stated))
}

fn read_wheel(section: &Section<'_>) -> Result<Wheel> {
    let anywhere = (-1e6, 1e6);
    let name = section.text("name")?;
    let shafts = [("wheel", Shaft::Wheel), ("motor", Shaft::Motor)];
    let drives = [("powered", WheelRole::Powered), ("free", WheelRole::Free)];
    let gear = section.optional_number("gear", POSITIVE)?;
    let shaft = section.optional_choice("encoder_on", &shafts)?;
    if gear.is_none() && shaft == Some(Shaft::Motor) {
        return Err(Error::Contradiction {
            at: section.place_of("encoder_on"),
            message: format!("wheel \"{name}\" has its encoder on the motor, but no `gear`"),
        });
    }
    let bits = section.optional_integer("counter_bits")?.unwrap_or(64);
    let counter = CounterWidth::new(u32::try_from(bits).unwrap_or(u32::MAX)).map_err(|source| {
        Error::Robot {
            at: section.place_of("counter_bits"),
            source,
        }
    })?;
    let (x, y) = (
        section.number("x_m", anywhere)?,
        section.number("y_m", anywhere)?,
    );
    let heading = section.optional_number("heading_deg", (-360.0, 360.0))?;
    let radius = section.number("radius_m", POSITIVE)?;
    let role = section.choice("drive", &drives)?;
    let mut encoder = Encoder::default().counter(counter);
    encoder.shaft = shaft.unwrap_or(Shaft::Wheel);
    encoder.gear = gear.unwrap_or(1.0);
    encoder.ticks_per_turn = section.optional_number("ticks_per_turn", POSITIVE)?;
    encoder.reversed = section.flag("reversed")?;
    let rate_step = section.optional_number("rate_step_rad_per_s", (0.0, 1e6))?;
    encoder.rate_step = rate_step.unwrap_or(0.0);
    // Rollers at an angle: the wheel drives along their axes, by the share of its rim's speed along them.
    let roller = section
        .optional_number("roller_deg", (-80.0, 80.0))?
        .unwrap_or(0.0);
    let mut wheel = match role {
        WheelRole::Powered => Wheel::powered(name),
        WheelRole::Free => Wheel::free(name),
    };
    let share = Angle::from_deg(roller).cos();
    wheel = wheel.at(x, y).radius(radius * share).encoder(encoder);
    wheel = wheel.heading(Angle::from_deg(heading.unwrap_or(0.0) + roller));
    wheel.width = section.optional_number("width_m", POSITIVE)?;
    wheel.load = section.optional_number("load_n", (0.0, 1e12))?;
    wheel.grousers = read_grousers(section)?;
    // One wheel alone is checked here, so that a bad number is reported at its own wheel.
    match Robot::new(String::new(), vec![wheel]) {
        Ok(robot) => Ok(robot.wheels()[0].clone()),
        Err(source) => Err(refused(section, source)),
    }
}

/// What a robot's description refuses, at the key that gave the number where there is one.
fn refused(section: &Section<'_>, source: grouser_slip::Error) -> Error {
    use grouser_slip::Error as Robot;
    let known = match &source {
        Robot::OutOfRange { range, .. }
        | Robot::Law {
            source: grouser_terra::Error::OutOfRange(range),
            ..
        } => section.refused(range),
        _ => None,
    };
    known.unwrap_or_else(|| Error::Robot {
        at: section.place(),
        source,
    })
}
