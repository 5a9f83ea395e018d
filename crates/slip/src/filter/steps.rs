//! Steps through the filter over the modes, and what is known after them.

use alloc::{boxed::Box, vec, vec::Vec};

use grouser_real::Real;

use super::free_wheel::FreeWheelMonitor;
use super::gather::{Gather, MIN_STEP_S};
use super::references::{BURST, References};
use super::settings::{FilterSettings, SlipPrior, log_prior};
use super::wheel_health::WheelWatch;
use crate::fault::Fault;
use crate::history::{seconds_between, whole};
use crate::measured_slip::SlipLimits;
use crate::modes::ModeFilter;
use crate::motion::{Belief, CommonMotion, HEADING, Levels, Noise, SLIP, SPEED, Step, X, Y, start};
use crate::robot::Robot;
use crate::sample::{Measurement, Sample};
use crate::wheel_estimate::WheelEstimate;

/// Is shown each step whose readings are complete, with its end, ns, and the filter after it.
pub type Recorder<'a> = dyn FnMut(i64, &Step, &ModeFilter) + 'a;

/// Steps that one sample closes at most, so that its cost is bounded.
const MAX_STEPS_PER_SAMPLE: usize = 4;
/// Readings of references in one step: places and headings of those that can wait.
const READINGS: usize = 2 * BURST;
/// A reference is lost after this time without a reading, s, or after this number of its periods if that is longer. A prior: slips of
/// soft ground change within half a second, and one lost reading is usual.
const REFERENCE_TIMEOUT_S: f64 = 0.5;
const REFERENCE_TIMEOUT_PERIODS: f64 = 3.0;
/// Maximum period of a reference, s: that of slow GNSS receivers.
const MAX_REFERENCE_PERIOD_S: f64 = 2.0;
/// Weight of a new period in the mean one: that of about ten readings.
const PERIOD_WEIGHT: f64 = 0.1;
/// Time constant with which the slip returns to its prior without a reading of the speed, s. A prior: 6 m at 0.3 m/s, a patch of ground.
const SLIP_MEMORY_S: f64 = 20.0;
/// Random walks of the reference's frame, m/√s, and of its heading, rad/√s, where it is a sum: a sum of displacements of 10 Hz visual odometry wanders by
/// a centimetre in a second or two, a pose does not.
const WANDER: [f64; 2] = [1e-5, 6e-3];
/// Priors of the other random walks: random walks of slip and drift (1/√s), of the speed next to an accelerometer (m/s/√s), of a
/// gyro's turn (rad/√s) and its bias (rad/s/√s).
const WALKS: [f64; 5] = [0.03, 0.03, 0.03, 2e-3, 2e-4];
/// Weight of a step in the mean share of good readings: that of about ten steps with readings.
const TRUST_WEIGHT: f64 = 0.1;
/// Fewer good readings than this share, a half: most readings contradict what is believed.
pub(super) const MIN_TRUST: f64 = 0.5;
/// Sigma of the logarithmic slip where what was believed of it is wrong: from braked wheels to wheels that spin.
const ANY_SLIP: f64 = 1.0;
/// The filter begins anew once within this time, s. A prior: the share of good readings follows what it believes within ten steps with
/// readings, half a second at 20 Hz.
const RECOVERY_S: f64 = 1.0;

/// A step whose readings may still come.
#[derive(Clone, Debug)]
struct Pending {
    end_ns: i64,
    step: Step,
    /// What the accelerometer measured, where the step itself goes without it.
    force: Option<[f64; 2]>,
}

/// What estimates, step by step.
#[derive(Clone, Debug)]
pub(super) struct Core {
    pub(super) gather: Gather,
    pub(super) references: References,
    /// The filter after the last step whose readings are complete, and after the last step.
    settled: ModeFilter,
    ahead: ModeFilter,
    /// The steps between the two, in a ring.
    pending: Box<[Pending]>,
    first: usize,
    count: usize,
    prior: SlipPrior,
    pub(super) settings: FilterSettings,
    /// The end of the last step of each.
    pub(super) settled_ns: Option<i64>,
    pub(super) now_ns: Option<i64>,
    /// When the speed over ground was measured last.
    pub(super) speed_known_ns: Option<i64>,
    /// When a reference other than a free wheel measured it last.
    reference_known_ns: Option<i64>,
    /// The usual time between readings of the speed, s.
    reference_period: f64,
    /// Usual share of good readings, and when the filter began anew because it was low.
    pub(super) trust: f64,
    pub(super) free_wheel: FreeWheelMonitor,
    begun_ns: Option<i64>,
    pub(super) readings: [f64; 2],
    /// The last step's wheels.
    pub(super) last: Step,
    pub(super) distance: f64,
    pub(super) distance_of_wheels: f64,
    pub(super) wheels: Box<[WheelWatch]>,
    pub(super) estimates: Box<[WheelEstimate]>,
}

fn step_for(wheels: usize) -> Step {
    Step {
        wheels: Vec::with_capacity(wheels),
        readings: Vec::with_capacity(READINGS),
        ..Step::default()
    }
}

fn copy(from: &Step, to: &mut Step) {
    (to.time, to.dt, to.turn, to.force) = (from.time, from.dt, from.turn, from.force);
    to.wheels.clear();
    to.wheels.extend_from_slice(&from.wheels);
    to.frame = None;
    to.readings.clear();
}

impl Core {
    pub(super) fn new(robot: &Robot, settings: FilterSettings) -> Self {
        let count = robot.wheels().len();
        let mut begin = start([0.0; 2], 0.0, true);
        // the start is where it is
        for i in [X, Y, HEADING] {
            begin.covariance[i][i] = 0.0;
        }
        begin.floor_variances();
        set_slip(&mut begin, settings.slip);
        let [slip, drift, speed, turn, turn_bias] = WALKS;
        let sigmas = [
            slip,
            drift,
            speed,
            turn,
            turn_bias,
            settings.accelerometer_drift,
            WANDER[0],
            settings.position_sigma,
            settings.yaw_sigma,
            settings.speed_sigma,
            1.0,
        ];
        let filter = ModeFilter::new(begin, Levels(sigmas.map(|of| of * of)), count);
        let waiting = || Pending {
            end_ns: 0,
            step: step_for(count),
            force: None,
        };
        let delay = usize::try_from(whole(settings.reference_latency / MIN_STEP_S)).unwrap_or(0);
        Self {
            gather: Gather::new(robot, &settings),
            references: References::new(settings.reference_latency),
            ahead: filter.clone(),
            settled: filter,
            pending: (0..delay + 2).map(|_| waiting()).collect(),
            first: 0,
            count: 0,
            prior: settings.slip,
            settings,
            settled_ns: None,
            now_ns: None,
            speed_known_ns: None,
            reference_known_ns: None,
            reference_period: 0.0,
            trust: 1.0,
            free_wheel: FreeWheelMonitor::default(),
            begun_ns: None,
            readings: [0.0; 2],
            last: step_for(count),
            distance: 0.0,
            distance_of_wheels: 0.0,
            wheels: vec![WheelWatch::default(); count].into_boxed_slice(),
            estimates: vec![WheelEstimate::NOTHING; count].into_boxed_slice(),
        }
    }

    /// The filter at the end of the last step.
    pub(super) const fn filter(&self) -> &ModeFilter {
        if self.count == 0 {
            &self.settled
        } else {
            &self.ahead
        }
    }

    /// Uses one sample, in the order of time; `record` is shown each step whose readings are complete.
    pub(super) fn take(&mut self, sample: &Sample, record: &mut Recorder<'_>) -> Result<(), Fault> {
        if super::input::is_reference(&sample.measurement) {
            let still = SlipLimits::default().standstill_speed * self.last.dt;
            let mut wheels = self.last.wheels.iter();
            let is_stationary = wheels.all(|of| of.distance.is_none_or(|of| of.abs() <= still));
            self.references
                .take(sample, self.settled_ns, is_stationary)?;
        } else if matches!(sample.measurement, Measurement::Command { .. }) {
            return Ok(());
        } else {
            self.gather.take(sample)?;
        }
        self.advance(sample.time_ns, record);
        Ok(())
    }

    /// Closes the steps that are complete.
    fn advance(&mut self, now_ns: i64, record: &mut Recorder<'_>) {
        for _ in 0..MAX_STEPS_PER_SAMPLE {
            if self.count == self.pending.len() {
                self.settle(record);
            }
            let place = (self.first + self.count) % self.pending.len();
            let has_reference = !self.is_older(self.reference_known_ns, now_ns);
            let is_lost = self.is_lost(now_ns);
            // headings of a reference confirm the gyro: then it is the wheels that turn otherwise
            let is_confirmed = self.trust >= MIN_TRUST && self.references.has_headings(now_ns);
            let Some((step, end_ns)) = self.gather.close(now_ns, is_confirmed) else {
                return;
            };
            let slot = &mut self.pending[place];
            slot.end_ns = end_ns;
            slot.force = step.force;
            copy(step, &mut slot.step);
            copy(step, &mut self.last);
            if is_lost {
                // an accelerometer bridges short gaps: it measures slopes as well
                slot.step.force = None;
            }
            if has_reference {
                for (wheel, check) in slot.step.wheels.iter_mut().zip(self.gather.checks.found()) {
                    // a free wheel that misses pulses shows nothing next to a reference
                    wheel.distance = wheel
                        .distance
                        .filter(|_| !(wheel.is_free && check.misses_pulses));
                }
            }
            let filter = if self.count == 0 {
                &self.settled
            } else {
                &self.ahead
            };
            self.free_wheel
                .judge(&mut slot.step, filter.belief(), has_reference);
            self.count += 1;
            self.now_ns = Some(end_ns);
            while self.count > 0 {
                let wait = seconds_between(self.pending[self.first].end_ns, end_ns);
                if wait < self.settings.reference_latency {
                    break;
                }
                self.settle(record);
            }
            if self.count > 0 {
                self.ahead.copy_from(&self.settled);
                for i in 0..self.count {
                    let place = (self.first + i) % self.pending.len();
                    // limits were checked as the samples came
                    let _ = self.ahead.advance(&self.pending[place].step);
                }
            }
            self.sum_ways();
            let skid = self.settings.free_slip.sigma;
            self.gather
                .checks
                .update(end_ns, &self.estimates, skid * skid);
            self.update_estimates(end_ns);
        }
    }

    /// Passes over the oldest step with the readings of references in it.
    fn settle(&mut self, record: &mut Recorder<'_>) {
        let first = self.first;
        let end_ns = self.pending[first].end_ns;
        let levels = self.settled.levels();
        let place_sigma = Real::sqrt(levels.of(Noise::Place));
        let sigmas = [place_sigma, self.settings.yaw_sigma];
        let belief = self.settled.belief();
        let found = self
            .references
            .give(end_ns, belief, sigmas, &mut self.pending[first].step);
        if let Some([place, heading]) = found {
            self.settled.change(|belief| {
                belief.add_noise(X, place);
                belief.add_noise(Y, place);
                belief.add_noise(HEADING, heading);
            });
        }
        let step = &self.pending[first].step;
        let wander = WANDER[usize::from(self.references.is_by_displacements())];
        self.settled.set_wander(wander * wander);
        if self.references.is_by_displacements() {
            self.settled
                .change(|belief| belief.add_noise(HEADING, wander * wander * step.dt));
        }
        let [_, _, drift, ..] = WALKS;
        let drift = drift * Real::sqrt(self.free_wheel.force_scale());
        self.settled.set_speed_noise(drift * drift);
        self.settled.hold(self.is_lost(end_ns));
        let before = *self.settled.belief();
        // limits were checked as the samples came
        let _ = self.settled.advance(step);
        self.free_wheel
            .watch(&before, self.settled.belief(), step, drift);
        let has_free_wheel = (step.wheels.iter()).any(|of| of.is_free && of.distance.is_some())
            && !self.free_wheel.is_doubted();
        let Pending { step, force, .. } = &mut self.pending[first];
        let dt = step.dt;
        core::mem::swap(&mut step.force, force);
        record(end_ns, step, &self.settled);
        let [readings, good] = self.settled.trusted();
        self.readings = [
            self.readings[0] + readings,
            self.readings[1] + readings - good,
        ];
        let [of_speed, good_of_speed] = self.settled.trusted_of_speed();
        if of_speed > 0.0 {
            self.trust += TRUST_WEIGHT * (good_of_speed / of_speed - self.trust);
            if self.trust < MIN_TRUST
                && age_of(self.begun_ns, end_ns).is_none_or(|age| age > RECOVERY_S)
            {
                self.begin_again(dt);
                self.begun_ns = Some(end_ns);
            }
        }
        let has_reference = good > MIN_TRUST * readings && readings > 0.0;
        if has_reference {
            self.reference_known_ns = Some(end_ns);
        }
        if has_free_wheel || has_reference {
            if let Some(passed) = age_of(self.speed_known_ns, end_ns) {
                let passed = passed.min(MAX_REFERENCE_PERIOD_S);
                self.reference_period += PERIOD_WEIGHT * (passed - self.reference_period);
            }
            self.speed_known_ns = Some(end_ns);
        } else if self.is_lost(end_ns) {
            let prior = log_prior(self.prior);
            let kept = Real::exp(-self.settled.moved() / SLIP_MEMORY_S);
            self.settled.change(|belief| {
                let mut row = [0.0; crate::motion::SIZE];
                row[SLIP] = kept;
                belief.mean[SLIP] = prior.mean + kept * (belief.mean[SLIP] - prior.mean);
                belief.propagate(SLIP, &row);
                belief.add_noise(SLIP, (1.0 - kept * kept) * prior.sigma * prior.sigma);
            });
        }
        self.settled_ns = Some(end_ns);
        self.first = (self.first + 1) % self.pending.len();
        self.count -= 1;
    }

    /// Most readings contradict what is believed, so that it is wrong: all but the place begins anew, at the speed of the wheels.
    fn begin_again(&mut self, dt: f64) {
        let mean = &self.settled.belief().mean;
        let mut begin = start([mean[X], mean[Y]], mean[HEADING], true);
        begin.mean[SPEED] = self.settled.common().distance / dt;
        reset(&mut begin, SLIP, 0.0, ANY_SLIP * ANY_SLIP);
        self.settled.begin(begin);
    }

    /// Has the speed not been measured for long?
    pub(super) fn is_lost(&self, now_ns: i64) -> bool {
        self.is_older(self.speed_known_ns, now_ns)
    }

    fn is_older(&self, then_ns: Option<i64>, now_ns: i64) -> bool {
        let timeout = REFERENCE_TIMEOUT_S.max(REFERENCE_TIMEOUT_PERIODS * self.reference_period);
        age_of(then_ns, now_ns).is_none_or(|age| age > timeout + self.settings.reference_latency)
    }

    /// Does a free wheel miss pulses, or is its speed not that of the robot?
    pub(super) fn is_skidding(&self, wheel: usize) -> bool {
        let is_free = self.last.wheels.get(wheel).is_some_and(|of| of.is_free);
        is_free && (self.free_wheel.is_skidding() || self.misses_pulses(wheel))
    }

    pub(super) fn misses_pulses(&self, wheel: usize) -> bool {
        self.gather.checks.found()[wheel].misses_pulses
    }

    /// Is the free wheel that alone shows the speed not to be trusted?
    pub(super) fn is_misled(&self, now_ns: i64) -> bool {
        (self.free_wheel.is_doubted()
            || (0..self.wheels.len()).any(|wheel| self.is_skidding(wheel)))
            && self.is_older(self.reference_known_ns, now_ns)
    }

    /// How long ago the speed was measured, s.
    pub(super) fn speed_age(&self, now_ns: i64) -> Option<f64> {
        age_of(self.speed_known_ns, now_ns)
    }

    fn sum_ways(&mut self) {
        let filter = self.filter();
        let motion = filter.motion();
        let CommonMotion {
            distance,
            direction,
            ..
        } = *filter.common();
        self.distance += motion.velocity[0] * self.last.dt;
        self.distance_of_wheels += distance * Real::cos(direction);
    }

    /// No more readings of the open steps come.
    pub(super) fn finish(&mut self, record: &mut Recorder<'_>) {
        while self.count > 0 {
            self.settle(record);
        }
    }

    /// The clock was set: the motion goes on from where it was.
    pub(super) fn restart_clock(&mut self, record: &mut Recorder<'_>) {
        self.finish(record);
        self.free_wheel.restart_clock();
        self.gather.restart_clock();
        self.references.restart_clock();
        (self.settled_ns, self.now_ns, self.speed_known_ns) = (None, None, None);
        (self.reference_known_ns, self.begun_ns) = (None, None);
        for (wheel, estimate) in self.wheels.iter_mut().zip(&mut self.estimates) {
            *wheel = WheelWatch::default();
            *estimate = WheelEstimate::NOTHING;
        }
    }

    pub(super) fn set_prior(&mut self, prior: SlipPrior) {
        self.prior = prior;
        if self.now_ns.is_none() {
            self.settled.change(|belief| set_slip(belief, prior));
            self.ahead.copy_from(&self.settled);
        }
    }

    /// Changes what is believed.
    pub(super) fn change(&mut self, change: impl Fn(&mut Belief)) {
        self.settled.change(&change);
        self.ahead.change(&change);
    }
}

fn age_of(then_ns: Option<i64>, now_ns: i64) -> Option<f64> {
    then_ns.map(|then| seconds_between(then, now_ns))
}

fn set_slip(belief: &mut Belief, prior: SlipPrior) {
    let prior = log_prior(prior);
    reset(belief, SLIP, prior.mean, prior.sigma * prior.sigma);
}

/// Sets one number of a belief, independent of the others.
pub(super) fn reset(belief: &mut Belief, index: usize, mean: f64, variance: f64) {
    belief.mean[index] = mean;
    for other in 0..crate::motion::SIZE {
        belief.covariance[index][other] = 0.0;
        belief.covariance[other][index] = 0.0;
    }
    belief.covariance[index][index] = variance;
}
