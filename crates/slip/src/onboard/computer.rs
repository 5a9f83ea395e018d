//! The object that a robot's computer runs.

use alloc::{boxed::Box, vec, vec::Vec};

use grouser_terra::{Angle, Slip};

use super::attitude::AttitudeFilter;
use super::carrier::Carriers;
use super::clock::Clock;
use super::firmness::{Compared, Firmness};
use super::learn::{SoilDemand, SoilLearner};
use super::settings::OnBoardSettings;
use super::start_guard::StartGuard;
use super::state::OnBoardState;
use crate::control::{
    ControlInput, Controller, Decision, Mode, Request, WheelCommand, WheelObservation,
};
use crate::detect::Detector;
use crate::error::{Error, Result};
use crate::fault::Fault;
use crate::filter::{BodyEstimate, FilterOutput, SlipFilter, SlipPrior};
use crate::prior::SlipDemand;
use crate::robot::Robot;
use crate::sample::{Measurement, Sample};
use crate::start::StartCheck;
use crate::state::{Health, Invalid};

/// The slip that soil and slope demand is looked up this often, s: a robot of half a metre at 0.3 m/s moves by 3 cm.
const DEMAND_PERIOD_S: f64 = 0.1;
/// The torque of a wheel is compared at a slip that is lower by this number of its standard deviations: of 40 random drives
/// (`bench/random_drives.py`) 34 arrived with one and 35 with two.
const LEAST_SLIP_SIGMAS: f64 = 2.0;
/// The prior of the common slip is never surer than this: ruts, rocks and bends are not in the soil's model.
const MIN_PRIOR_SIGMA: f64 = 0.1;
/// A standing wheel with this share of the weakest motor's greatest torque is stalled, as the controller has it.
const STALL_TORQUE_SHARE: f64 = 0.8;
/// Sensors none of which has had a sample accepted for so long are silent, s: the filter's own limit for a reference.
const SILENCE_S: f64 = 0.5;
/// A step of the loop counts as at most this long, s.
const MAX_STEP_S: f64 = 0.1;

/// Filter, detector, attitude, suspension, soil's prior and controller of one robot.
///
/// ```
/// use grouser_slip::control::Request;
/// use grouser_slip::onboard::{OnBoard, OnBoardSettings};
/// use grouser_slip::{Measurement, Robot, Sample, Wheel};
///
/// let wheels = vec![
///     Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000).load(20.0),
///     Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000).load(2.0),
/// ];
/// let robot = Robot::new("bicycle".into(), wheels)?;
/// let mut on_board = OnBoard::new(&robot, OnBoardSettings::new(&robot))?;
/// for step in 0..300_u64 {
///     let time_ns = step as i64 * 10_000_000;
///     // The powered wheel turns 10 ticks a step, the free one 8: a slip of 0.2.
///     for (wheel, raw) in [(0, 10 * step), (1, 8 * step)] {
///         on_board.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } });
///     }
///     let commands = on_board.tick(time_ns, Request { speed: 0.5, ..Request::default() });
///     assert!(commands[0].rim_speed.is_finite());
/// }
/// assert!((on_board.observations()[0].slip.unwrap() - 0.2).abs() < 0.03);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct OnBoard {
    filter: SlipFilter,
    detector: Detector,
    attitude: AttitudeFilter,
    carriers: Carriers,
    firmness: Firmness,
    controller: Controller,
    start: StartGuard,
    demand: Option<SlipDemand>,
    learner: Option<Box<SoilLearner>>,
    /// The slip demand that soft ground is compared with: of the known soil, or of the belief one robot length before.
    demand_now: Option<SlipPrior>,
    demand_due: f64,
    /// +1 while the robot is to travel forwards, −1 backwards.
    direction: f64,
    clock: Clock,
    warm_up: f64,
    uses_poses: bool,
    /// When the loop ran last, s.
    last_tick: f64,
    /// Time of the loop since the filter accepted a sample, s: it passes even where clocks are set back.
    silence: f64,
    max_torques: Box<[Option<f64>]>,
    torques: Box<[Option<f64>]>,
    observations: Box<[WheelObservation]>,
    decision: Option<Decision>,
}

impl OnBoard {
    /// The computer of `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: OnBoardSettings) -> Result<Self> {
        settings.check(robot)?;
        let setups = &settings.wheels;
        let max_torques: Vec<_> = setups.iter().map(|setup| setup.max_torque).collect();
        let weakest = max_torques
            .iter()
            .flatten()
            .copied()
            .fold(f64::MAX, f64::min);
        let mut detect = settings.detect;
        detect.stall_torque = detect.stall_torque.min(STALL_TORQUE_SHARE * weakest);
        let mut filter = settings.filter;
        filter.free_slip = settings.soil.free_slip.unwrap_or(filter.free_slip);
        let angles: Vec<_> = setups
            .iter()
            .map(|setup| setup.max_steering_angle)
            .collect();
        let learner = match (settings.learn, settings.soil.family) {
            (Some(learn), Some(family)) => {
                Some(Box::new(SoilLearner::new(robot, setups, family, learn)?))
            }
            (Some(_), None) => {
                return Err(Error::MissingFamily);
            }
            _ => None,
        };
        let observations = setups
            .iter()
            .map(|setup| WheelObservation::unknown(setup.load));
        Ok(Self {
            filter: SlipFilter::new(robot, filter)?,
            detector: Detector::new(robot, detect)?,
            attitude: AttitudeFilter::new(settings.heading, settings.gravity),
            carriers: Carriers::new(setups.iter().map(|setup| setup.carrier)),
            firmness: Firmness::new(&settings.soil.torques, &max_torques),
            controller: Controller::new(robot, settings.control)?.with_steering(&angles),
            start: StartGuard::new(
                settings.start_policy,
                StartCheck::new(robot)?,
                settings.control.max_tilt,
                settings.gravity,
            ),
            demand: settings.soil.slip_demand,
            learner,
            demand_now: None,
            demand_due: 0.0,
            direction: 1.0,
            clock: Clock::default(),
            warm_up: settings.warm_up,
            uses_poses: settings.uses_poses,
            last_tick: 0.0,
            silence: 0.0,
            torques: vec![None; max_torques.len()].into_boxed_slice(),
            max_torques: max_torques.into_boxed_slice(),
            observations: observations.collect(),
            decision: None,
        })
    }

    /// Takes a sample that is stamped by the computer's own clock as it arrives.
    pub fn update(&mut self, sample: Sample) {
        self.update_at(sample.time_ns, sample);
    }

    /// Takes a sample that arrives at `now_ns` by the computer's clock and is stamped by another one. What is wrong with a
    /// sample the filter counts ([`FilterOutput::rejected`]).
    pub fn update_at(&mut self, now_ns: i64, sample: Sample) {
        let is_warm = self.clock.seconds(now_ns) >= self.warm_up;
        if is_warm {
            self.start.end_warm_up();
        }
        let is_accepted = match sample.measurement {
            Measurement::Inertial { force, rate } => {
                self.update_inertial(sample.time_ns, force, rate, is_warm)
            }
            Measurement::JointAngle { joint, angle } => {
                self.carriers.update(sample.time_ns, joint, angle);
                false
            }
            Measurement::MotorCurrent { wheel, share } => {
                self.update_current(wheel, share);
                false
            }
            Measurement::Sinkage { .. } | Measurement::EntryAngle { .. } => {
                if let Some(learner) = &mut self.learner {
                    // the learner counts what it refuses
                    let _ = learner.add_contact(&sample.measurement);
                }
                false
            }
            Measurement::Pose { .. } if !self.uses_poses => false,
            Measurement::WheelCount { .. }
            | Measurement::WheelEdge { .. }
            | Measurement::WheelAngle { .. }
            | Measurement::WheelRate { .. }
            | Measurement::YawRate { .. }
            | Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Position { .. }
            | Measurement::Speed { .. }
            | Measurement::Acceleration { .. }
            | Measurement::SteeringAngle { .. }
            | Measurement::Steering { .. }
            | Measurement::Carrier { .. }
            | Measurement::WheelTorque { .. }
            | Measurement::Command { .. } => self.filter_sample(sample, is_warm),
        };
        // the stamp of a refused sample does not tell the sensors' time: a wrong one would hide that they fall silent
        if is_accepted {
            self.silence = 0.0;
            self.clock.arrived(now_ns, sample.time_ns);
        }
    }

    /// Has the filter accepted a part of it?
    fn update_inertial(
        &mut self,
        time_ns: i64,
        force: [f64; 3],
        rate: [f64; 3],
        is_warm: bool,
    ) -> bool {
        self.attitude.update(time_ns, force, rate);
        if !is_warm {
            self.start.add_force(force);
            return false;
        }
        if let Some(learner) = &mut self.learner {
            learner.add_force(force);
        }
        for sample in self.carriers.samples(time_ns, rate[1]) {
            // a refusal is counted by the filter
            let _ = self.filter.push(sample);
        }
        let [forward, left] = self.attitude.without_gravity(force);
        let mut is_accepted = false;
        for measurement in [
            Measurement::Acceleration { forward, left },
            Measurement::YawRate { rate: rate[2] },
        ] {
            is_accepted |= self.filter_sample(
                Sample {
                    time_ns,
                    measurement,
                },
                is_warm,
            );
        }
        is_accepted
    }

    fn update_current(&mut self, wheel: usize, share: f64) {
        let max_torque = self.max_torques.get(wheel).copied().flatten();
        if let (Some(observation), Some(torque), Some(max_torque)) = (
            self.observations.get_mut(wheel),
            self.torques.get_mut(wheel),
            max_torque,
        ) {
            observation.torque_share = Some(share);
            *torque = Some(share * max_torque);
        }
    }

    /// Has the filter accepted it? A refusal is counted by the filter.
    fn filter_sample(&mut self, sample: Sample, is_warm: bool) -> bool {
        if !is_warm {
            return false;
        }
        if !self.start.is_looking() {
            return self.filter.push(sample).is_ok();
        }
        let is_accepted = self.filter.update(sample).is_ok();
        self.start.update(&sample, &self.filter.latest());
        is_accepted
    }

    /// A wheel is steered by `angle` (rad, to the left) from now on.
    ///
    /// # Errors
    /// As [`SlipFilter::set_steering_angle`].
    pub fn set_steering_angle(&mut self, wheel: usize, angle: f64) -> Result<()> {
        self.filter.set_steering_angle(wheel, angle)
    }

    /// Runs the control loop: what is known at `now_ns` by the computer's clock, and a command for each wheel in the robot's
    /// order. Call it at a steady rate of 20 to 200 Hz.
    pub fn tick(&mut self, now_ns: i64, request: Request) -> &[WheelCommand] {
        self.observe(now_ns);
        let request = if self.start.allows_driving() {
            request
        } else {
            Request {
                speed: 0.0,
                yaw_rate: None,
                ..request
            }
        };
        let is_settled = self.learner.as_deref().is_none_or(SoilLearner::is_settled);
        // a robot that is put down rocks on its wheels; a clock that was set back is no reason not to watch the tilt
        let is_warm = !(0.0..self.warm_up).contains(&self.clock.seconds(now_ns));
        let output = self.controller.step(&ControlInput {
            time_ns: now_ns,
            wheels: &self.observations,
            speed: self.speed(),
            heading: Some(self.attitude.heading()),
            pitch: is_warm.then(|| self.attitude.pitch()),
            roll: is_warm.then(|| self.attitude.roll()),
            slip_demand: self.demand_now.filter(|_| is_settled),
            request,
        });
        self.decision = output.decision;
        if request.speed != 0.0 {
            self.direction = direction(&request, output.mode);
        }
        output.commands
    }

    fn observe(&mut self, now_ns: i64) {
        let time = self.clock.seconds(now_ns);
        let step = (time - self.last_tick).clamp(0.0, MAX_STEP_S);
        self.last_tick = time;
        if time >= self.demand_due {
            self.demand_due = time + DEMAND_PERIOD_S;
            self.look_up_demand();
        }
        // silence is measured by the computer's clock: that of the sensors may have been set
        let Some(sensor_ns) = self.clock.sensor_time_ns(now_ns) else {
            return;
        };
        self.silence += step;
        let is_silent = self.silence > SILENCE_S;
        let wheels = self.filter.estimate_at(sensor_ns).wheels;
        let _ = self
            .detector
            .update(sensor_ns, wheels, &self.torques)
            .count();
        let learner = self.learner.as_deref();
        let is_settled = learner.is_none_or(SoilLearner::is_settled);
        for ((index, wheel), seen) in wheels.iter().enumerate().zip(&mut self.observations) {
            let slip = wheel.slip.map(Slip::value);
            let compared = match (learner, slip) {
                (Some(_), _) if !is_settled => Compared::Before,
                // soft is what is softer than both: that the soil learnt takes more torque is no alarm
                (Some(own), Some(slip)) => Compared::Soil(own.torque_ratio(slip).min(1.0)),
                _ => Compared::Soil(1.0),
            };
            // a slip that is found too high is no soft ground
            let doubt = LEAST_SLIP_SIGMAS * wheel.sigma.unwrap_or(0.0);
            let least_slip = slip.map(|slip| slip - doubt);
            let load = (self.torques[index], least_slip);
            *seen = WheelObservation {
                slip,
                sigma: wheel.sigma,
                health: if is_silent {
                    Health::Invalid(Invalid::Dropout)
                } else {
                    wheel.health
                },
                motion: self.detector.motion(index, wheel.motion),
                forward_speed: wheel.forward_speed.map(|speed| speed.value),
                rim_speed: wheel.rim_speed.map(|speed| speed.value),
                firmness: self.firmness.update(index, load, compared, step),
                ..*seen
            };
        }
        self.learn(step);
    }

    /// What slips, torques and specific force since the last tick show of the soil.
    fn learn(&mut self, step: f64) {
        let Some(learner) = &mut self.learner else {
            return;
        };
        // going round, back or aside a robot turns and stops, and soft ground is no ground to get used to
        if self.controller.mode() != Mode::Forward {
            learner.discard();
            return;
        }
        let motion = (
            self.filter.forward_speed().unwrap_or(0.0),
            self.filter.yaw_rate(),
        );
        let has_changed = learner.update(&self.observations, &self.torques, motion, step);
        if has_changed && let Some(slip) = learner.running_slip() {
            // the slip is held within the controller's limits
            let _ = self.controller.set_optimum(slip);
        }
    }

    /// What the soil demands on the slope that the robot drives up or down; the filter's prior follows it. What soft ground is
    /// compared with is the demand of the pull that a gain of speed needs besides.
    fn look_up_demand(&mut self) {
        // nose down is downhill, or uphill backwards
        let slope = -self.attitude.pitch() * self.direction;
        let pulled = slope.max(self.attitude.felt_slope() * self.direction);
        let known = |slope: f64| self.demand.as_ref()?.at(Angle::from_rad(slope));
        let learner = self.learner.as_deref();
        let by_belief = |learnt: Option<SoilDemand>, slope: f64| match learnt {
            Some(learnt) => learnt.slip,
            None => known(slope),
        };
        let before = learner.and_then(|own| own.demand_before(pulled));
        self.demand_now = by_belief(before, pulled);
        if let Some(prior) = by_belief(learner.and_then(|own| own.demand(slope)), slope) {
            let sigma = prior.sigma.max(MIN_PRIOR_SIGMA);
            // the table holds slips only, so that none is refused
            let _ = self.filter.set_slip_prior(SlipPrior { sigma, ..prior });
        }
    }

    /// What is known of the wheels since the last tick, in the robot's order.
    #[must_use]
    pub fn observations(&self) -> &[WheelObservation] {
        &self.observations
    }

    /// The filter's output by all readings so far.
    #[must_use]
    pub fn estimate(&self) -> FilterOutput<'_> {
        self.filter.latest()
    }

    /// The robot's motion and place by all readings so far.
    #[must_use]
    pub fn body(&self) -> BodyEstimate {
        self.filter.latest().body
    }

    /// Number of readings that the filter refused.
    #[must_use]
    pub fn refused(&self) -> u64 {
        self.filter.latest().rejected.total()
    }

    /// Forward speed of the robot, m/s; `None` while no wheel shows it.
    #[must_use]
    pub fn speed(&self) -> Option<f64> {
        self.filter.forward_speed()
    }

    /// The attitude.
    #[must_use]
    pub const fn attitude(&self) -> &AttitudeFilter {
        &self.attitude
    }

    /// Which events go on.
    #[must_use]
    pub const fn detector(&self) -> &Detector {
        &self.detector
    }

    /// What the robot does.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.controller.mode()
    }

    /// The decision of the last tick.
    #[must_use]
    pub const fn decision(&self) -> Option<Decision> {
        self.decision
    }

    /// What is learnt of the soil; `None` where it is not learnt.
    #[must_use]
    pub fn soil(&self) -> Option<&SoilLearner> {
        self.learner.as_deref()
    }

    /// What in the sensors contradicts the robot's description; `None` while nothing does.
    #[must_use]
    pub const fn start_fault(&self) -> Option<Fault> {
        self.start.fault()
    }

    /// What has been learnt, for the next start.
    #[must_use]
    pub fn state(&self) -> OnBoardState {
        OnBoardState {
            learnt: self.filter.learnt(),
            heading: self.attitude.heading(),
            soil: self.learner.as_ref().map(|learner| *learner.belief()),
        }
    }

    /// Takes back what was learnt before a restart; the controller and the attitude's tilt begin anew.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a number outside its limits; nothing changes then.
    ///
    /// ```
    /// use grouser_slip::onboard::{OnBoard, OnBoardSettings};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let before = OnBoard::new(&robot, OnBoardSettings::new(&robot))?;
    /// let mut after = OnBoard::new(&robot, OnBoardSettings::new(&robot))?;
    /// after.restore(&before.state())?;
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn restore(&mut self, state: &OnBoardState) -> Result<()> {
        crate::error::check_range("onboard", "heading", state.heading, (-1e6, 1e6), "rad")?;
        if let Some(belief) = &state.soil {
            belief.check()?;
        }
        self.filter.restore(&state.learnt)?;
        if let (Some(learner), Some(belief)) = (&mut self.learner, &state.soil) {
            learner.restore(belief)?;
            if let Some(slip) = learner.running_slip() {
                self.controller.set_optimum(slip)?;
            }
        }
        self.attitude.set_heading(state.heading);
        Ok(())
    }
}

/// Which way a robot drives along its nose in that mode, 1 or -1.
fn direction(request: &Request, mode: Mode) -> f64 {
    match mode {
        Mode::BackOut => -request.direction(),
        Mode::Forward | Mode::Traverse | Mode::Detour | Mode::Stopped => request.direction(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_backs_out_drives_the_other_way() {
        for speed in [0.3, -0.3] {
            let request = Request {
                speed,
                heading: 0.0,
                yaw_rate: None,
            };
            let along = |mode| direction(&request, mode) * speed;
            assert_eq!([Mode::Forward, Mode::Detour].map(along), [0.3; 2]);
            assert_eq!(along(Mode::BackOut), -0.3);
        }
    }
}
