//! Cohesion, angle of friction and shear modulus of the ground, while driving.

mod covariance;
mod model;
mod settings;

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;
use grouser_terra::{RigidWheel, ShearLaw, Soil, WheelSize};

use super::entry::Uncertain;
use super::reading::WheelReading;
use super::stretch::Stretch;
use crate::error::Result;
use crate::fault::{Fault, Rejected};
use crate::history::seconds_between;
use covariance::Belief;
use model::{Prediction, predict};
use settings::hold;
pub use settings::{GroundSettings, SoilPrior};

/// Slips below this move too little soil, slips above this are where sinkage and stress laws end.
const USED_SLIP: (f64, f64) = (0.01, 0.95);
/// Gauss-Newton steps of one reading.
const STEPS: usize = 2;
/// A reading this many sigma off does not change the parameters.
const GATE_SIGMA: f64 = 4.0;
/// CUSUM of the innovations: slack and threshold, in sigma. A shift by 3 sigma is found in about four readings.
const CUSUM_SLACK_SIGMA: f64 = 0.75;
const CUSUM_THRESHOLD_SIGMA: f64 = 8.0;
/// From this sum on readings wait outside, so that a new ground is not learned as a little of both.
const CUSUM_SUSPICION_SIGMA: f64 = 3.0;
/// Slopes of first order make the filter too sure: without this factor on the noise's variance the squared error is
/// 1.4 times what the covariance says (`its_sigmas_are_those_of_its_errors`).
const LINEARISATION_FACTOR: f64 = 1.5;

/// Can the readings so far tell a parameter?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// The readings have at least halved its sigma.
    Observed,
    /// What is given for it is mostly the prior.
    NotObservable,
}

/// What is known of the ground now.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilEstimate {
    /// Cohesion, Pa.
    pub cohesion: (Uncertain, Knowledge),
    /// Angle of internal friction, rad.
    pub phi: (Uncertain, Knowledge),
    /// Shear deformation modulus, m; its sigma by the logarithm's.
    pub k_shear: (Uncertain, Knowledge),
    /// Covariance of (c in Pa, φ in rad, ln K).
    pub covariance: [[f64; 3]; 3],
    /// Stretches of readings that entered since the last change of ground.
    pub readings: u64,
    /// How often the ground was found to have changed.
    pub changes: u64,
}

impl SoilEstimate {
    /// Shear strength c + σ tan φ under the normal stress `pressure` (Pa), Pa: known well where c and φ
    /// apart may not be.
    #[must_use]
    pub fn shear_strength(&self, pressure: f64) -> Uncertain {
        let (tan, [[cc, cp, _], [_, pp, _], _]) = (Real::tan(self.phi.0.value), self.covariance);
        let by_phi = pressure * (1.0 + tan * tan);
        Uncertain {
            value: self.cohesion.0.value + pressure * tan,
            sigma: Real::sqrt((cc + 2.0 * by_phi * cp + by_phi * by_phi * pp).max(0.0)),
        }
    }
}

/// What became of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// It waits, to enter with those before it as their mean when the operating point changes or the stretch is over.
    Gathered,
    /// The stretch before it entered.
    Used {
        /// Measured less predicted torque, in sigma of both.
        innovation: f64,
        /// The modulus k of p = k zⁿ that carries this load at this sinkage, Pa/mⁿ.
        modulus: f64,
    },
    /// It or the stretch before it tells nothing of the strength: no load, no sinkage, braking, or a slip outside [0.01, 0.95].
    Silent,
    /// Too far off for noise, or among others that were; it counts towards a change of ground.
    Outlier {
        /// Measured less predicted torque, in sigma of both.
        innovation: f64,
    },
    /// The ground has changed: everything learned is forgotten and learning begins with this reading.
    Changed,
}

/// Learns the soil's strength from the wheels.
///
/// The pressure-sinkage modulus drops out: load and sinkage give it for any (c, φ, K), since the vertical force is
/// linear in it; the torque of that same contact is what is compared. An iterated extended Kalman filter in
/// (c, φ, ln K), with the errors of load, sinkage and slip carried into the torque's, and old knowledge
/// fading towards the prior.
///
/// What a torque can tell: at large slip c and φ together (`shear_strength`), apart only where loads differ; K only
/// where slips are small. The answer says so ([`Knowledge`]).
///
/// Source: after Iagnemma, Kang, Shibly & Dubowsky, IEEE Trans. Robotics 20 (2004), with the whole stress model in
/// the place of its linear one. Assumes: n, c_1, c_2 and λ are those of the soil given.
///
/// [`SoilIdentifier::update`] allocates nothing, never panics and costs a few evaluations of the stress model with
/// six derivatives: feed it at 10 Hz, not in the control loop.
///
/// ```
/// use grouser_slip::ground::{GroundSettings, Knowledge, SoilIdentifier, SoilPrior};
/// use grouser_terra::{RigidWheel, catalogue};
///
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let wheels = [RigidWheel::new(0.125, 0.1)?];
/// let identifier = SoilIdentifier::new(&wheels, &sand, SoilPrior::around(&sand), GroundSettings::default())?;
/// let (phi, knowledge) = identifier.estimate().phi;
/// assert!((phi.value - sand.params().phi.rad()).abs() < 1e-12);
/// assert_eq!(knowledge, Knowledge::NotObservable); // before any reading
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SoilIdentifier {
    wheels: Box<[(WheelSize<f64>, Option<Stretch>)]>,
    soil: Soil,
    law: ShearLaw,
    prior: SoilPrior,
    settings: GroundSettings,
    belief: Belief,
    shift: [f64; 2],
    last_ns: Option<i64>,
    readings: u64,
    changes: u64,
    rejected: Rejected,
}

impl SoilIdentifier {
    /// An identifier for these wheels. `soil` gives what is not identified (n, c_1, c_2, λ); `prior` what is
    /// believed of the rest.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a prior or a setting outside its limits.
    pub fn new(
        wheels: &[RigidWheel],
        soil: &Soil,
        prior: SoilPrior,
        settings: GroundSettings,
    ) -> Result<Self> {
        prior.check()?;
        settings.check()?;
        let wheels: Vec<_> = wheels.iter().map(|wheel| (wheel.size(), None)).collect();
        Ok(Self {
            wheels: wheels.into_boxed_slice(),
            soil: *soil,
            law: soil.params().laws.shear.unwrap_or_default(),
            belief: prior.belief(),
            prior,
            settings,
            shift: [0.0; 2],
            last_ns: None,
            readings: 0,
            changes: 0,
            rejected: Rejected::default(),
        })
    }

    /// Takes one reading.
    ///
    /// # Errors
    /// A [`Fault`] refuses it: it is counted and changes nothing.
    pub fn update(&mut self, reading: &WheelReading) -> core::result::Result<Taken, Fault> {
        let taken = self.take(reading);
        if let Err(fault) = &taken {
            self.rejected.count(fault);
        }
        taken
    }

    /// What is known of the ground now.
    #[must_use]
    pub fn estimate(&self) -> SoilEstimate {
        let Belief { mean, covariance } = self.belief;
        let prior = self.prior.belief();
        let of = |i: usize, value: f64, scale: f64| {
            let sigma = Real::sqrt(covariance[i][i].max(0.0));
            let known = sigma <= 0.5 * Real::sqrt(prior.covariance[i][i]);
            (
                Uncertain {
                    value,
                    sigma: sigma * scale,
                },
                if known {
                    Knowledge::Observed
                } else {
                    Knowledge::NotObservable
                },
            )
        };
        let k_shear = Real::exp(mean[2]);
        SoilEstimate {
            cohesion: of(0, mean[0], 1.0),
            phi: of(1, mean[1], 1.0),
            k_shear: of(2, k_shear, k_shear),
            covariance,
            readings: self.readings,
            changes: self.changes,
        }
    }

    /// Readings refused so far.
    #[must_use]
    pub const fn rejected(&self) -> &Rejected {
        &self.rejected
    }

    fn take(&mut self, reading: &WheelReading) -> core::result::Result<Taken, Fault> {
        let wheels = self.wheels.len();
        let (size, stretch) = self
            .wheels
            .get_mut(reading.wheel)
            .ok_or(Fault::UnknownWheel {
                index: reading.wheel,
                wheels,
            })?;
        reading.check(size.radius)?;
        if let Some(last_ns) = self.last_ns {
            // wheels are read one after the other at one moment
            if reading.time_ns < last_ns {
                return Err(Fault::NotLater {
                    time_ns: reading.time_ns,
                    last_ns,
                });
            }
            let fading = seconds_between(last_ns, reading.time_ns) / self.settings.memory;
            self.belief.fade(&self.prior.belief(), fading);
        }
        self.last_ns = Some(reading.time_ns);
        let size = *size;
        let speaks = speaks(&size, reading);
        if let Some(gathered) = stretch.as_mut() {
            let age = seconds_between(gathered.begun_ns(), reading.time_ns);
            if speaks && age < self.settings.stretch && gathered.holds(reading) {
                gathered.add(reading);
                return Ok(Taken::Gathered);
            }
        }
        let whole = core::mem::replace(stretch, speaks.then(|| Stretch::new(reading)));
        Ok(match whole {
            Some(whole) => self.learn(&size, &whole.reading()),
            None if speaks => Taken::Gathered,
            None => Taken::Silent,
        })
    }

    /// One stretch enters, waits outside, or shows that the ground has changed.
    fn learn(&mut self, size: &WheelSize<f64>, reading: &WheelReading) -> Taken {
        let Some(predicted) = self.predict(size, reading, &self.belief.mean) else {
            return Taken::Silent;
        };
        let spread =
            self.noise(reading, &predicted) + self.belief.variance_along(&predicted.by_strength);
        let innovation = (reading.torque.value - predicted.torque) / Real::sqrt(spread);
        if self.has_shifted(innovation) {
            self.forget();
            if let Some(predicted) = self.predict(size, reading, &self.belief.mean) {
                self.enter(size, reading, predicted);
            }
            return Taken::Changed;
        }
        if innovation.abs() > GATE_SIGMA
            || self.shift.iter().any(|sum| *sum > CUSUM_SUSPICION_SIGMA)
        {
            return Taken::Outlier { innovation };
        }
        match self.enter(size, reading, predicted) {
            Some(modulus) => Taken::Used {
                innovation,
                modulus,
            },
            None => Taken::Silent,
        }
    }

    /// The ground has changed.
    fn forget(&mut self) {
        self.shift = [0.0; 2];
        self.belief = self.prior.belief();
        self.changes = self.changes.saturating_add(1);
        self.readings = 0;
    }

    /// Two-sided CUSUM; one wild reading alone cannot cross the threshold.
    fn has_shifted(&mut self, innovation: f64) -> bool {
        let held = innovation.clamp(-GATE_SIGMA, GATE_SIGMA);
        for (sum, sign) in self.shift.iter_mut().zip([1.0, -1.0]) {
            *sum = (*sum + sign * held - CUSUM_SLACK_SIGMA).max(0.0);
        }
        self.shift.iter().any(|sum| *sum > CUSUM_THRESHOLD_SIGMA)
    }

    /// The reading enters: Gauss-Newton over the strength and the reading's own true load, sinkage and slip, all six
    /// of them with their errors. Slopes taken at the reading as it came would share its error and pull the strength
    /// aside; at the corrected one they do not. Gives the modulus.
    fn enter(
        &mut self,
        size: &WheelSize<f64>,
        reading: &WheelReading,
        first: Prediction,
    ) -> Option<f64> {
        let before = self.belief;
        let measured = [reading.load, reading.sinkage, reading.slip];
        let (mut mean, mut corrected) = (before.mean, *reading);
        let mut predicted = first;
        for step in 0..STEPS {
            if step > 0 {
                predicted = self.predict(size, &corrected, &mean)?;
            }
            let rest = self.rest(reading, &predicted);
            let mut residual = reading.torque.value - predicted.torque;
            for (i, slope) in predicted.by_strength.iter().enumerate() {
                residual -= slope * (before.mean[i] - mean[i]);
            }
            let now = [corrected.load, corrected.sinkage, corrected.slip];
            let mut latent = 0.0;
            for (i, slope) in predicted.by_reading.iter().enumerate() {
                residual -= slope * (measured[i].value - now[i].value);
                latent += (slope * measured[i].sigma) * (slope * measured[i].sigma);
            }
            let noise = LINEARISATION_FACTOR * (latent + rest);
            let total = before.variance_along(&predicted.by_strength) + noise;
            let gain = before.gain(&predicted.by_strength, noise);
            for (i, slot) in mean.iter_mut().enumerate() {
                *slot = before.mean[i] + gain[i] * residual;
            }
            hold(&mut mean);
            let moved = |i: usize| {
                let sigma = measured[i].sigma;
                measured[i].value + sigma * sigma * predicted.by_reading[i] / total * residual
            };
            corrected.load.value = moved(0).max(0.1 * measured[0].value);
            corrected.sinkage.value = moved(1).clamp(0.1 * measured[1].value, 0.95 * size.radius);
            corrected.slip.value = moved(2).clamp(USED_SLIP.0, USED_SLIP.1);
        }
        let noise = LINEARISATION_FACTOR * self.noise(reading, &predicted);
        let gain = before.gain(&predicted.by_strength, noise);
        self.belief = before.corrected(mean, &predicted.by_strength, &gain, noise);
        self.readings = self.readings.saturating_add(1);
        Some(predicted.modulus)
    }

    fn predict(
        &self,
        size: &WheelSize<f64>,
        reading: &WheelReading,
        mean: &[f64; 3],
    ) -> Option<Prediction> {
        predict(size, &self.soil, self.law, reading, mean)
    }

    /// Variance of measured less predicted torque for a strength that is right.
    fn noise(&self, reading: &WheelReading, predicted: &Prediction) -> f64 {
        let [by_load, by_sinkage, by_slip] = predicted.by_reading;
        let parts = [
            by_load * reading.load.sigma,
            by_sinkage * reading.sinkage.sigma,
            by_slip * reading.slip.sigma,
        ];
        parts.iter().map(|part| part * part).sum::<f64>() + self.rest(reading, predicted)
    }

    /// The torque's own part of it: the sensor's and the model's.
    fn rest(&self, reading: &WheelReading, predicted: &Prediction) -> f64 {
        let model = self.settings.model_error * predicted.torque;
        let sensor = reading.torque.sigma;
        (sensor * sensor + model * model).max(1e-18)
    }
}

/// Does a reading tell anything of the strength?
fn speaks(size: &WheelSize<f64>, reading: &WheelReading) -> bool {
    let WheelReading {
        slip,
        load,
        sinkage,
        ..
    } = reading;
    slip.value >= USED_SLIP.0
        && slip.value <= USED_SLIP.1
        && load.value > 2.0 * load.sigma
        && load.value > 0.0
        && sinkage.value > 2.0 * sinkage.sigma
        && sinkage.value >= 1e-6 * size.radius
        && sinkage.value < 0.95 * size.radius
}
