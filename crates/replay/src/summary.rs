//! What a whole log says.

use std::collections::BTreeMap;

use grouser_doctor::{Findings, HeldReference, ReferenceDelay};
use grouser_slip::detect::Change;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::{Health, Motion, Reference, Rejected, Slip};

use crate::checks::{Doubt, MAX_GAP_S, ReferenceUse, WayCheck};
use crate::odometry::Odometry;
use crate::quantiles::Quantiles;

/// Median and the middle 90 % of something; `None` where there was nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Spread {
    /// How many values there were.
    pub count: u64,
    /// Median.
    pub median: Option<f64>,
    /// The value below which 5 % lie.
    pub p5: Option<f64>,
    /// The value below which 95 % lie.
    pub p95: Option<f64>,
}

impl From<&Quantiles> for Spread {
    fn from(values: &Quantiles) -> Self {
        Self {
            count: values.count(),
            median: values.at(0.5),
            p5: values.at(0.05),
            p95: values.at(0.95),
        }
    }
}

/// What the log says of one wheel.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelSummary {
    /// Its name.
    pub name: String,
    /// Is it a free wheel that the others are measured against?
    pub is_reference: bool,
    /// Its slip.
    pub slip: Spread,
    /// The angle from its heading to the way of its centre, to the left positive, rad.
    pub side_slip_angle: Spread,
    /// Share of time in each motion, in [`Motion::ALL`]'s order, and under [`UNKNOWN`] where the motion
    /// was not known; they add up to 1.
    pub states: Vec<(&'static str, f64)>,
    /// Share of time in each health, by its name; they add up to 1.
    pub healths: BTreeMap<String, f64>,
}

/// What the log says of the robot along its track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct AlongSummary {
    /// Slip over each half second in which the wheels turned faster than the robot's `low_speed_m_per_s` on average.
    pub slip: Spread,
    /// Slip over the total distance: 1 − distance over ground / distance by the wheels (or its braking branch).
    pub overall: Option<f64>,
    /// Its 90 % interval; `None` of what was known at its time only.
    pub overall_90: Option<[f64; 2]>,
    /// Distance by the wheels, m, forwards and backwards added up: without compensation of slip.
    pub travel_wheels: f64,
    /// Distance over ground in the direction in which the wheels ran, m; `None` without an absolute reference.
    pub travel_reference: Option<f64>,
    /// Its 90 % interval; `None` likewise.
    pub travel_reference_90: Option<[f64; 2]>,
}

/// What the log says of the yaw rate: the powered wheels against the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct YawSummary {
    /// |turn by the wheels − turn by the gyro| in half a second while the powered wheels ran faster
    /// than the robot's `low_speed_m_per_s` on average, rad.
    pub residual: Spread,
    /// That time, s.
    pub window: f64,
}

/// What [`WheelSummary::states`] calls a motion that is not known.
pub const UNKNOWN: &str = "Unknown";

/// How a replay ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// With slips.
    Done,
    /// Without a slip of any wheel: the log is too short, or nothing moved enough.
    NoSlip,
}

impl Status {
    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::NoSlip => "no slip",
        }
    }
}

/// What the filter says of itself after a log.
#[derive(Clone, Debug, PartialEq)]
pub struct FusedSummary {
    /// Does every slip use the whole log?
    pub is_offline: bool,
    /// How much of the reference was used, where a sensor measures the robot's motion.
    pub reference: Option<ReferenceUse>,
    /// The filter's way beside the reference's.
    pub ways: WayCheck,
    /// Why the result is doubtful; empty where its checks passed.
    pub doubts: Vec<Doubt>,
    /// Samples missing between those that came, by each sensor's usual period.
    pub dropped: u64,
    /// How often the clock was set.
    pub clock_steps: u64,
    /// What began and ended: the first ten thousand of it.
    pub events: Vec<EventAt>,
    /// How many more there were.
    pub more_events: u64,
    pub(crate) rejected: Rejected,
}

/// An event that began or ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EventAt {
    /// When it was called, s from the log's start.
    pub time_s: f64,
    /// What happened.
    pub change: Change,
}

/// What a whole log says.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// How the replay ended.
    pub status: Status,
    /// What measured how fast the robot travels.
    pub reference: Reference,
    /// By which sensor the wheels were measured.
    pub wheel_sensor: &'static str,
    /// From the first record to the last, s.
    pub duration_s: f64,
    /// The longest time between two samples, s.
    pub longest_gap_s: f64,
    /// One per wheel, in the robot's order.
    pub wheels: Vec<WheelSummary>,
    /// The robot along its track.
    pub along: AlongSummary,
    /// Wheels against gyro, where there is one.
    pub yaw: Option<YawSummary>,
    /// What was found of how the sensors are described.
    pub findings: Findings,
    /// When torques or motor currents and the speed of the wheels showed another ground under one command, s from the log's
    /// start; a change between grounds that draw the same current is not observable.
    pub ground_changes_s: Vec<f64>,
    /// How much later the gyro's clock stamps the same moment than the encoders', s, where it was
    /// estimated.
    pub clock_offset_s: Option<f64>,
    /// By how much the reference's stamps are later than those of wheels and gyro, where the log shows it.
    pub reference_delay: Option<ReferenceDelay>,
    /// The reference's rows and readings, where a logger repeats it between its updates.
    pub held_reference: Option<HeldReference>,
    /// Where the robot was at the end, counted from the beginning of the span, and the ways that led there.
    pub odometry: Option<Odometry>,
    /// What the filter says of itself.
    pub fused: FusedSummary,
    /// What was learnt of the soil, where that was wanted.
    pub soil: Option<SoilEstimate>,
    /// Samples that were refused.
    pub rejected: Rejected,
}

impl Summary {
    /// Why the result is doubtful; empty where all checks passed.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let of_filter = self.fused.doubts.iter().copied();
        let is_far = |delay: &ReferenceDelay| delay.is_clear && delay.is_beyond_correction();
        let apart = self.reference_delay.filter(is_far).map(Doubt::ClocksApart);
        let has_jump = self.longest_gap_s > MAX_GAP_S;
        let jump = has_jump.then_some(Doubt::ClockJump(self.longest_gap_s));
        // what the filter finds is often the consequence of a description
        let causes = self.findings.mistakes.iter().copied();
        let all = causes.map(Doubt::Description).chain(of_filter);
        all.chain(apart).chain(jump).collect()
    }
}

impl Summary {
    /// Why the result is doubtful, in words.
    #[must_use]
    pub fn doubts_in_words(&self) -> Vec<String> {
        self.doubts().iter().map(ToString::to_string).collect()
    }

    /// What may be described wrongly, or may be real as well (slip), in words.
    #[must_use]
    pub fn reservations(&self) -> Vec<String> {
        let possible = self.findings.possible();
        possible.iter().map(ToString::to_string).collect()
    }
}

/// The states of one wheel over time.
#[derive(Clone, Debug)]
pub(crate) struct Shares {
    motions: [f64; Motion::ALL.len()],
    unknown: f64,
    healths: Vec<(Health, f64)>,
    total: f64,
}

impl Shares {
    pub(crate) fn new() -> Self {
        Self {
            motions: [0.0; Motion::ALL.len()],
            unknown: 0.0,
            healths: Vec::new(),
            total: 0.0,
        }
    }

    pub(crate) fn add(&mut self, motion: Option<Motion>, health: Health, seconds: f64) {
        match motion.and_then(|motion| Motion::ALL.iter().position(|m| *m == motion)) {
            Some(index) => self.motions[index] += seconds,
            None => self.unknown += seconds,
        }
        match self.healths.iter_mut().find(|(known, _)| *known == health) {
            Some((_, sum)) => *sum += seconds,
            None => self.healths.push((health, seconds)),
        }
        self.total += seconds;
    }

    pub(crate) fn motions(&self) -> Vec<(&'static str, f64)> {
        let named = Motion::ALL.iter().zip(self.motions);
        named
            .map(|(motion, seconds)| (motion.name(), seconds))
            .chain([(UNKNOWN, self.unknown)])
            .filter(|(_, seconds)| *seconds > 0.0)
            .map(|(name, seconds)| (name, seconds / self.total))
            .collect()
    }

    pub(crate) fn healths(&self) -> BTreeMap<String, f64> {
        let positive = self.healths.iter().filter(|(_, seconds)| *seconds > 0.0);
        positive
            .map(|(health, seconds)| (health.to_string(), seconds / self.total))
            .collect()
    }
}

/// Slip of a whole way.
pub(crate) fn overall(reference: f64, wheels: f64) -> Option<f64> {
    Slip::from_speeds(reference, wheels).ok().map(Slip::value)
}
