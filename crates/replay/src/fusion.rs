//! A log through the filter: all sensors together, each wheel's slip with its sigma.

use grouser_files::robot::RobotFile;
use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::{BodyMotion, Measurement, Reference, Sample, WheelEstimate};

use crate::error::Result;

/// 95 % of the squares of a normal deviate are below this (χ² of one degree of freedom).
const CHI_95: f64 = 3.841;

/// Of a robot on any ground: nobody has told what its wheels demand.
const NOTHING_KNOWN: SlipPrior = SlipPrior {
    mean: 0.2,
    sigma: 0.5,
};

/// How far the slips of its wheels are apart, and for how long, s: some may be in the soft patch that others are still before.
const WHEELS_APART: (f64, f64) = (0.3, 5.0);

/// What the filter said of a whole log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FusedSummary {
    /// Way forwards, m, by all sensors.
    pub distance: f64,
    /// The same by the powered wheels without compensation of their slip, m.
    pub distance_of_wheels: f64,
    /// Readings that were compared with what was expected.
    pub readings: u64,
    /// Mean of their squared residuals over the variance that was expected (NIS): 1 is honest.
    pub nis: Option<f64>,
    /// Share of them within the expected 95 %.
    pub within_95: Option<f64>,
    /// The longest time without a believed reference, s; `None` if there never was one.
    pub longest_alone_s: Option<f64>,
}

/// The filter with what it is given of a log.
pub(crate) struct Fusion {
    filter: SlipFilter,
    reference: Reference,
    readings: u64,
    sum: f64,
    within: u64,
    longest_alone: Option<f64>,
    last: f64,
}

impl Fusion {
    /// For a robot whose speed `reference` tells.
    pub(crate) fn new(file: &RobotFile, reference: Reference) -> Result<Self> {
        let own = &file.settings;
        let standard = FilterSettings::default();
        let settings = FilterSettings {
            standstill_speed: own.standstill_speed,
            low_speed: own.low_speed,
            max_sigma: own.max_sigma,
            max_speed: own.max_speed,
            dropout: own.dropout,
            position_sigma: own.position_sigma,
            speed_sigma: own.speed_sigma,
            yaw_rate_sigma: own.yaw_rate_sigma,
            lateral_sigma: own.lateral_sigma,
            slip: NOTHING_KNOWN,
            wheel_slip_sigma: WHEELS_APART.0,
            wheel_slip_memory: WHEELS_APART.1,
            ..standard
        };
        Ok(Self {
            filter: SlipFilter::new(&file.robot, settings)?,
            reference,
            readings: 0,
            sum: 0.0,
            within: 0,
            longest_alone: None,
            last: f64::NAN,
        })
    }

    /// Gives the filter a sample; of motion only that of the reference: a log's others may be made of the wheels.
    pub(crate) fn update(&mut self, sample: Sample) {
        let of = match sample.measurement {
            Measurement::Displacement { .. } => Some(Reference::Displacement),
            Measurement::Pose { .. } => Some(Reference::Pose),
            Measurement::Speed { .. } => Some(Reference::Speed),
            _ => None,
        };
        if of.is_some_and(|of| of != self.reference) {
            return;
        }
        // A refused sample is counted by the filter.
        let _refused = self.filter.update(sample);
        let latest = self.filter.latest();
        let nis = latest.body.nis;
        if nis.to_bits() != self.last.to_bits() {
            self.last = nis;
            self.readings += 1;
            self.sum += nis;
            self.within += u64::from(nis <= CHI_95);
        }
        if let Some(age) = latest.reference_age {
            self.longest_alone = Some(self.longest_alone.map_or(age, |longest| longest.max(age)));
        }
    }

    pub(crate) fn wheels(&self) -> &[WheelEstimate] {
        self.filter.latest().wheels
    }

    /// The robot's motion.
    pub(crate) fn motion(&self) -> BodyMotion {
        let body = self.filter.latest().body;
        let parts = [body.forward, body.left, body.yaw_rate];
        let mut covariance = [[0.0; 3]; 3];
        for (i, part) in parts.iter().enumerate() {
            covariance[i][i] = part.variance;
        }
        BodyMotion {
            velocity: parts.map(|part| part.value),
            covariance,
        }
    }

    pub(crate) fn rejected(&self) -> grouser_slip::Rejected {
        self.filter.latest().rejected
    }

    pub(crate) fn summary(&self) -> FusedSummary {
        let body = self.filter.latest().body;
        let count = (self.readings > 0).then_some(self.readings as f64);
        FusedSummary {
            distance: body.distance,
            distance_of_wheels: body.distance_of_wheels,
            readings: self.readings,
            nis: count.map(|count| self.sum / count),
            within_95: count.map(|count| self.within as f64 / count),
            longest_alone_s: self.longest_alone,
        }
    }
}
