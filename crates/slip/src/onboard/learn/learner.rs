//! Bayes' rule over the family, and what the belief says of slip, pull and torque.

use grouser_real::Real;

use super::super::settings::WheelSetup;
use super::belief::{ERROR_SCALE_LIMITS, SoilBelief, SoilEstimate, SoilInterval};
use super::contact::ContactKind;
use super::family::{LEVELS, SLIP_POINTS, SoilFamily, slip_at, value_at};
use super::readings::{SoilReading, SoilReadings};
use super::settings::SoilLearnSettings;
use crate::control::WheelObservation;
use crate::error::Result;
use crate::fault::Fault;
use crate::filter::SlipPrior;
use crate::robot::Robot;
use crate::sample::Measurement;

/// No reading is taken for less likely than one this many sigma away: soil has surprises that no family holds.
const MAX_SIGMA: f64 = 3.0;
/// Sigmas on either side of an interval of 90 %.
const INTERVAL_SIGMA: f64 = 1.645;
/// Share of readings that an interval of 90 % misses.
const MISS_SHARE: f64 = 0.1;
/// How fast the intervals follow their misses, per reading: a miss widens them by 57 %, nine readings within narrow them by
/// as much. In the long run a tenth of the readings is missed whatever the soil, as in adaptive conformal inference (Gibbs &
/// Candès 2021). Set by `tests/learnt_soil.rs` of `grouser-rover`.
const ERROR_SCALE_GAIN: f64 = 0.5;
/// The number of readings from which the ground is compared with the learnt soil: before, the prior may be a wrong soil.
const MIN_READINGS: u32 = 3;
/// Beliefs that are kept, at most.
const MAX_LAG: usize = 8;
/// Way of the rims over which a reading is the mean, in radii: half a turn.
const READING_WAY_RADII: f64 = core::f64::consts::PI;
/// Greatest standard deviation of one soil's slip demand: that of a slip of which nothing is known, in [0, 1].
const MAX_DEMAND_SIGMA: f64 = 0.3;
/// Below this derivative of the pull by slip the slip is not determined by the pull.
const MIN_PULL_SLOPE: f64 = 0.05;
/// 1/(1 + exp(−1.702 x)) lies within 0.01 of the normal distribution (Haley 1952, by way of item response theory).
const LOGISTIC_FACTOR: f64 = 1.702;
/// Limits of the slip setpoint, as those of a scenario's computed one.
const RUNNING_SLIP_LIMITS: (f64, f64) = (0.05, 0.8);
/// Limits of the believed torque over the known soil's.
const TORQUE_RATIO_LIMITS: (f64, f64) = (0.1, 10.0);

/// The slip that a slope demands.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilDemand {
    /// Mean and standard deviation over the soils that hold the slope; `None` where probably none does.
    pub slip: Option<SlipPrior>,
    /// Probability that no slip holds the slope.
    pub fails: f64,
}

/// Learns the soil. It allocates nothing after construction, reads no clock and never panics.
///
/// [`OnBoard`](crate::onboard::OnBoard) feeds its own. Whoever has slips from elsewhere feeds one by hand: samples as they
/// come, and a tick whenever slips, torques and a specific force are known.
#[derive(Clone, Debug)]
pub struct SoilLearner {
    family: SoilFamily,
    settings: SoilLearnSettings,
    readings: SoilReadings,
    prior: SoilBelief,
    belief: SoilBelief,
    /// `None`: the known soil, since too little has been learnt.
    in_use: Option<SoilBelief>,
    /// The beliefs in use after the last readings, the oldest first; from `MAX_LAG - lag` on they are kept.
    past: [Option<SoilBelief>; MAX_LAG],
    /// Age, in readings, of the belief that soft ground is compared with.
    lag: usize,
    count: u32,
    /// How many of them had a sinkage.
    contacts: u32,
    changes: u32,
}

impl SoilLearner {
    /// A learner for `robot`, whose wheels carry the loads of `setups`, among the soils of `family`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(
        robot: &Robot,
        setups: &[WheelSetup],
        family: SoilFamily,
        settings: SoilLearnSettings,
    ) -> Result<Self> {
        settings.check()?;
        let prior = SoilBelief::prior(&settings, &family);
        Ok(Self {
            readings: SoilReadings::new(robot, setups, &settings),
            family,
            settings,
            belief: prior,
            prior,
            in_use: None,
            past: [None; MAX_LAG],
            lag: lag(robot),
            count: 0,
            contacts: 0,
            changes: 0,
        })
    }

    /// A sample of the accelerometer in the robot's axes, m/s².
    pub fn add_force(&mut self, force: [f64; 3]) {
        self.readings.add_force(force);
    }

    /// A sinkage or an entry angle of a wheel; any other measurement changes nothing.
    ///
    /// # Errors
    /// [`Fault`] for a value that no wheel can have; it is counted.
    pub fn add_contact(&mut self, measurement: &Measurement) -> core::result::Result<(), Fault> {
        let contacts = &mut self.readings.contacts;
        match *measurement {
            Measurement::Sinkage { wheel, depth } => {
                contacts.add(wheel, ContactKind::Sinkage, depth)
            }
            Measurement::EntryAngle { wheel, angle } => {
                contacts.add(wheel, ContactKind::EntryAngle, angle)
            }
            _ => Ok(()),
        }
    }

    /// Drops what came since the last reading: the robot turns back, goes round or has stopped. The next reading begins once
    /// the soil is sheared again.
    pub fn discard(&mut self) {
        self.readings.discard();
    }

    /// One tick of `step` seconds at `motion`: forward speed (m/s) and yaw rate (rad/s). Torques are in N m. True where the
    /// belief in use has changed. What came since the last tick counts if the robot drives straight on.
    pub fn update(
        &mut self,
        observations: &[WheelObservation],
        torques: &[Option<f64>],
        motion: (f64, f64),
        step: f64,
    ) -> bool {
        let reading = self.readings.update(observations, torques, motion, step);
        reading.is_some_and(|reading| self.learn(&reading))
    }

    fn learn(&mut self, reading: &SoilReading) -> bool {
        let (slip, sigma) = reading.slip;
        let SoilInterval { low, high, .. } = self.predict_pull(slip, sigma);
        let is_missed = !(low <= reading.pull && reading.pull <= high);
        let off = if is_missed { 1.0 } else { 0.0 } - MISS_SHARE;
        let scale = self.belief.error_scale * Real::exp(ERROR_SCALE_GAIN * off);
        self.belief.error_scale = scale.clamp(ERROR_SCALE_LIMITS.0, ERROR_SCALE_LIMITS.1);
        let likelihoods = self.log_likelihoods(reading);
        let greatest = likelihoods
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let SoilLearnSettings { forget, weight, .. } = self.settings;
        for (index, own) in self.belief.weights.iter_mut().enumerate() {
            let held = (1.0 - forget) * *own + forget * self.prior.weights[index];
            *own = held * Real::exp(weight * (likelihoods[index] - greatest));
        }
        if !self.belief.normalise() {
            self.belief.weights = self.prior.weights;
        }
        self.count = self.count.saturating_add(1);
        self.contacts = self
            .contacts
            .saturating_add(u32::from(reading.sinkage.is_some()));
        let has_changed = self.use_belief();
        self.past.rotate_left(1);
        self.past[MAX_LAG - 1] = self.in_use;
        // what was believed before was no more than a guess
        if self.count <= MIN_READINGS {
            self.past = [self.in_use; MAX_LAG];
        }
        has_changed
    }

    /// The belief that was in use one robot length before. Soft ground is compared with it, since at the edge of soft
    /// ground the readings move the belief to softer soil, which then explains the slip.
    const fn before(&self) -> Option<&SoilBelief> {
        self.past[MAX_LAG - self.lag].as_ref()
    }

    /// Takes up the belief once it differs enough from the one in use.
    fn use_belief(&mut self) -> bool {
        let before = self.in_use.as_ref().unwrap_or(&self.prior);
        if self.belief.difference(before) <= self.settings.hysteresis {
            return false;
        }
        self.in_use = Some(self.belief);
        self.changes = self.changes.saturating_add(1);
        true
    }

    /// Pull and torque share the error of the slip, so that their difference, the resistance, is known better than either.
    fn log_likelihoods(&self, reading: &SoilReading) -> [f64; LEVELS] {
        let (slip, sigma) = reading.slip;
        let mut out = [0.0; LEVELS];
        for (out, member) in out.iter_mut().zip(self.family.members()) {
            let (pull, by_slip) = value_at(&member.pulls, slip);
            let a = self.model_variance(pull) + square(by_slip * sigma);
            let x = reading.pull - pull;
            let (distance, determinant) = match reading.torque {
                None => (x * x / a, a),
                Some(torque) => {
                    let (expected, torque_by_slip) = value_at(&member.torques, slip);
                    let b = self.model_variance(expected) + square(torque_by_slip * sigma);
                    let c = by_slip * torque_by_slip * sigma * sigma;
                    let y = torque - expected;
                    let determinant = a * b - c * c;
                    let distance = (b * x * x - 2.0 * c * x * y + a * y * y) / determinant;
                    (distance, determinant)
                }
            };
            *out = -0.5 * (distance.min(2.0 * MAX_SIGMA * MAX_SIGMA) + Real::ln(determinant));
            if let Some((depth, depth_sigma)) = reading.sinkage {
                let (expected, depth_by_slip) = value_at(&member.sinkages, slip);
                let variance = self.sinkage_variance(expected)
                    + square(depth_sigma)
                    + square(depth_by_slip * sigma);
                let distance = square(depth - expected) / variance;
                *out -= 0.5 * (distance.min(MAX_SIGMA * MAX_SIGMA) + Real::ln(variance));
            }
        }
        out
    }

    /// Variance of the model's own error in a sinkage over the radius.
    fn sinkage_variance(&self, value: f64) -> f64 {
        let [part, share] = self.settings.sinkage_error;
        square(part) + square(share * value)
    }

    /// Variance of the model's own error in a share of the load.
    fn model_variance(&self, value: f64) -> f64 {
        let [part, share] = self.settings.model_error;
        square(part) + square(share * value)
    }

    /// The pull of all wheels over their load where the powered ones run at a slip that is known up to `sigma`, with its interval of 90 %.
    #[must_use]
    pub fn predict_pull(&self, slip: f64, sigma: f64) -> SoilInterval {
        let (mut mean, mut second) = (0.0, 0.0);
        for (weight, member) in self.belief.weights.iter().zip(self.family.members()) {
            let (pull, by_slip) = value_at(&member.pulls, slip);
            let variance = self.model_variance(pull) + square(by_slip * sigma);
            mean += weight * pull;
            second += weight * (variance + pull * pull);
        }
        let scale = INTERVAL_SIGMA * self.belief.error_scale;
        let half = scale * Real::sqrt((second - mean * mean).max(0.0));
        SoilInterval {
            mean,
            low: mean - half,
            high: mean + half,
        }
    }

    /// The slip that the soil demands on a slope (rad, uphill positive) by the belief in use; `None` while that is the known
    /// soil.
    #[must_use]
    pub fn demand(&self, slope: f64) -> Option<SoilDemand> {
        Some(self.demand_by(self.in_use.as_ref()?, slope))
    }

    /// The same by the belief that was in use a length of the robot before: what the ground ahead is compared with.
    #[must_use]
    pub fn demand_before(&self, slope: f64) -> Option<SoilDemand> {
        Some(self.demand_by(self.before()?, slope))
    }

    fn demand_by(&self, belief: &SoilBelief, slope: f64) -> SoilDemand {
        let pull = Real::tan(slope);
        let (mut fails, mut held, mut mean, mut second) = (0.0, 0.0, 0.0, 0.0);
        for (weight, member) in belief.weights.iter().zip(self.family.members()) {
            let most = member.max_pull();
            let sigma = belief.error_scale * Real::sqrt(self.model_variance(most));
            fails += weight / (1.0 + Real::exp(-LOGISTIC_FACTOR * (pull - most) / sigma));
            if let Some((slip, by_slip)) = member.slip_of_pull(pull) {
                let sigma = Real::sqrt(self.model_variance(pull)) / by_slip.max(MIN_PULL_SLOPE);
                held += weight;
                mean += weight * slip;
                second += weight * (slip * slip + square(sigma.min(MAX_DEMAND_SIGMA)));
            }
        }
        let is_held = held > 0.5;
        let slip = is_held.then(|| {
            let mean = mean / held;
            SlipPrior {
                mean,
                sigma: belief.error_scale * Real::sqrt((second / held - mean * mean).max(1e-8)),
            }
        });
        SoilDemand { slip, fails }
    }

    /// The slip of the greatest tractive efficiency by the belief in use; `None` while that is the known soil, and where no
    /// slip pulls.
    #[must_use]
    pub fn running_slip(&self) -> Option<f64> {
        let belief = self.in_use.as_ref()?;
        let mut efficiencies = [0.0; SLIP_POINTS];
        for (index, efficiency) in efficiencies.iter_mut().enumerate() {
            let slip = slip_at(index);
            for (weight, member) in belief.weights.iter().zip(self.family.members()) {
                let (pull, torque) = (member.pulls[index], member.torques[index]);
                if slip > 0.0 && torque > 0.0 {
                    *efficiency += weight * (1.0 - slip) * pull.max(0.0) / torque;
                }
            }
        }
        let neighbours = efficiencies.array_windows().enumerate();
        let (below, [before, top, after]) = neighbours
            .max_by(|(_, [_, a, _]), (_, [_, b, _])| a.total_cmp(b))
            .filter(|(_, [_, top, _])| *top > 0.0)?;
        // the top of the parabola through the best point and its neighbours
        let bend = before - 2.0 * top + after;
        let off = if bend < 0.0 {
            0.5 * (before - after) / bend
        } else {
            0.0
        };
        let step = slip_at(1) - slip_at(0);
        let slip = slip_at(below + 1) + off.clamp(-0.5, 0.5) * step;
        Some(slip.clamp(RUNNING_SLIP_LIMITS.0, RUNNING_SLIP_LIMITS.1))
    }

    /// Torque that the belief in use a length of the robot before expects at a slip, over that of the known soil.
    #[must_use]
    pub fn torque_ratio(&self, slip: f64) -> f64 {
        let (Some(belief), Some(known)) = (self.before(), self.family.known()) else {
            return 1.0;
        };
        let members = belief.weights.iter().zip(self.family.members());
        let expected: f64 = members
            .map(|(weight, member)| weight * value_at(&member.torques, slip).0)
            .sum();
        let (known, _) = value_at(&known.torques, slip);
        let ratio = expected / known;
        if ratio.is_finite() {
            ratio.clamp(TORQUE_RATIO_LIMITS.0, TORQUE_RATIO_LIMITS.1)
        } else {
            1.0
        }
    }

    /// Is the soil known well enough to tell softer ground from it?
    #[must_use]
    pub const fn is_settled(&self) -> bool {
        self.count >= MIN_READINGS
    }

    /// What has been learnt.
    #[must_use]
    pub fn estimate(&self) -> SoilEstimate {
        let strength = self.belief.strength();
        let angle = |strength: f64| Real::atan(strength * self.family.friction());
        SoilEstimate {
            friction_angle: SoilInterval {
                mean: angle(strength.mean),
                low: angle(strength.low),
                high: angle(strength.high),
            },
            strength,
            stiffness: self.belief.stiffness(),
            readings: self.count,
            contact_readings: self.contacts,
            contacts_refused: self.readings.contacts.refused,
            contacts_stuck: self.readings.contacts.stuck,
            changes: self.changes,
            error_scale: self.belief.error_scale,
        }
    }

    /// The belief, for the next start.
    #[must_use]
    pub const fn belief(&self) -> &SoilBelief {
        &self.belief
    }

    /// Takes back the belief of before a restart: the soil counts as known at once.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for weights that are no probabilities, or whose sum is not 1; nothing
    /// changes then.
    pub fn restore(&mut self, belief: &SoilBelief) -> Result<()> {
        belief.check()?;
        self.belief = *belief;
        self.count = MIN_READINGS;
        self.use_belief();
        self.past = [self.in_use; MAX_LAG];
        Ok(())
    }
}

fn square(value: f64) -> f64 {
    value * value
}

/// Readings until all wheels stand on the ground that the first one has met, and one more.
fn lag(robot: &Robot) -> usize {
    let wheels = robot.wheels();
    let ends = wheels.iter().fold([f64::MAX, f64::MIN], |ends, wheel| {
        [ends[0].min(wheel.x), ends[1].max(wheel.x)]
    });
    let radius = wheels
        .iter()
        .fold(0.0, |most: f64, wheel| most.max(wheel.radius));
    let readings = (ends[1] - ends[0]) / (READING_WAY_RADII * radius);
    (1..MAX_LAG)
        .find(|lag| *lag as f64 > readings + 1.0)
        .unwrap_or(MAX_LAG)
}
