//! The filter behind its input: parts that own their state, and the order in which they work.

use alloc::boxed::Box;

use super::accelerometer::Accelerometer;
use super::ground_track::GroundTrack;
use super::gyro_monitor::GyroMonitor;
use super::inertial_path::InertialPath;
use super::input::{Input, rotation_of};
use super::kalman::Kalman;
use super::motion_model::{self, COMMON_SLIP, FORWARD, GYRO_BIAS, YAW, own_slip, radius};
use super::output::Outputs;
use super::recovery::Recovery;
use super::reference_sensor::ReferenceSensor;
use super::settings::{FilterSettings, SlipPrior};
use super::start_shear::StartShear;
use super::wheel_bank::WheelBank;
use super::{CLOCK_STEP_S, PSEUDO_MEASUREMENT_PERIOD_S};
use crate::fault::Fault;
use crate::history::seconds_between;
use crate::measured_slip::SlipLimits;
use crate::robot::{Robot, WheelRole};
use crate::sample::{Measurement, Sample};

/// Standard deviation of a free wheel's radius: its skid holds all of its error.
const FREE_RADIUS_SIGMA: f64 = 1e-6;
/// No wheel has a larger torque, N m.
const MAX_TORQUE_N_M: f64 = 1e7;

/// State and parts of the filter.
#[derive(Clone, Debug)]
pub(super) struct Core {
    pub(super) settings: FilterSettings,
    pub(super) limits: SlipLimits,
    /// Means and covariance of the numbers of [`motion_model`].
    pub(super) state: Kalman,
    pub(super) wheels: WheelBank,
    pub(super) path: InertialPath,
    pub(super) accelerometer: Accelerometer,
    pub(super) gyro: GyroMonitor,
    pub(super) reference: ReferenceSensor,
    /// The motion over the ground by an absolute reference; `None` where free wheels measure it.
    pub(super) ground: Option<Box<GroundTrack>>,
    /// Does the motion over the ground lead the state?
    pub(super) is_led: bool,
    pub(super) recovery: Recovery,
    /// The start on unsheared soil; `None` without a free wheel, which measures the slip there.
    start: Option<StartShear>,
    /// Tangent of the robot's roll, either side down; 0 where it is not known.
    pub(super) cross_slope: f64,
    pub(super) output: Outputs,
    /// The time up to which samples have been used.
    pub(super) now_ns: Option<i64>,
    /// Have readings changed estimates that are not updated yet?
    pub(super) has_news: bool,
    pseudo_measured_ns: Option<i64>,
    /// The last time at which any reference measured the robot's speed.
    pub(super) speed_known_ns: Option<i64>,
    /// Normalised innovation squared of the last measurement.
    pub(super) nis: f64,
}

impl Core {
    pub(super) fn new(robot: &Robot, settings: FilterSettings) -> Self {
        let count = robot.wheels().len();
        let span = settings.reference_latency + settings.horizon + CLOCK_STEP_S;
        let mut core = Self {
            limits: SlipLimits {
                standstill_speed: settings.standstill_speed,
                low_speed: settings.low_speed,
                max_sigma: settings.max_sigma,
            },
            state: Kalman::new(motion_model::size(count)),
            wheels: WheelBank::new(robot, &settings),
            path: InertialPath::new(span, settings.max_rate),
            accelerometer: Accelerometer::default(),
            gyro: GyroMonitor::default(),
            reference: ReferenceSensor::default(),
            ground: robot
                .wheels()
                .iter()
                .all(|wheel| wheel.role == WheelRole::Powered)
                .then(|| GroundTrack::boxed(&settings)),
            is_led: false,
            recovery: Recovery::default(),
            start: StartShear::of(robot),
            cross_slope: 0.0,
            output: Outputs::new(count),
            now_ns: None,
            has_news: false,
            pseudo_measured_ns: None,
            speed_known_ns: None,
            nis: 0.0,
            settings,
        };
        core.reset_state();
        core
    }

    /// One cycle: predict, pseudo-measurements, gate and update. The estimates of one moment are updated once, after the last
    /// of its readings ([`Core::settle_estimates`]).
    pub(super) fn step(&mut self, sample: &Sample, input: &Input) -> Result<(), Fault> {
        let Sample {
            time_ns,
            measurement,
        } = *sample;
        let moves_on = self.now_ns != Some(time_ns);
        if moves_on {
            self.settle_rims();
            self.settle_estimates(input);
        }
        self.predict(time_ns);
        if !self.wheels.measure_ways() && !self.is_sparse(time_ns) {
            self.predict_ground_motion(time_ns);
        }
        let due = self
            .pseudo_measured_ns
            .is_none_or(|then| seconds_between(then, time_ns) >= PSEUDO_MEASUREMENT_PERIOD_S);
        if due {
            self.pseudo_measured_ns = Some(time_ns);
            self.apply_pseudo_measurements(time_ns);
            self.recover_from_runaway(time_ns);
            self.check_sensors(time_ns);
            self.state.limit_correlations();
        }
        let outcome = self.update(time_ns, &measurement);
        if moves_on || self.changes_estimate(time_ns, &measurement) {
            self.update_disputes(time_ns);
            self.has_news = true;
        }
        outcome
    }

    /// Uses a reading of the reference that was stamped before the time up to which samples have been used.
    pub(super) fn update_late(&mut self, sample: &Sample, input: &Input) -> Result<(), Fault> {
        let outcome = self.update_by_reference(sample.time_ns, &sample.measurement);
        if let Some(now_ns) = self.now_ns {
            self.update_health(now_ns, input);
        }
        outcome
    }

    /// Predicts the state at `time_ns`.
    fn predict(&mut self, time_ns: i64) {
        let last = self.now_ns.unwrap_or(time_ns);
        let dt = seconds_between(last, time_ns).clamp(0.0, CLOCK_STEP_S);
        self.now_ns = Some(time_ns);
        if dt > 0.0 {
            let force = self.accelerometer.current(time_ns, &self.settings);
            let density = self.process_noise_density();
            let (state, settings) = (&mut self.state, &self.settings);
            let gained = motion_model::predict(state, settings, dt, force, density);
            let wheels = self
                .wheels
                .iter()
                .map(|wheel| (wheel.free, wheel.noise_scale));
            motion_model::predict_slips(state, settings, dt, wheels);
            if let Some(start) = &mut self.start {
                let rims = self.wheels.mean_powered_rim(time_ns, settings.dropout);
                start.predict(state, dt, rims, settings.low_speed);
            }
            self.path.advance(dt, gained);
            let by_wheels = self.wheels.forward_speed(time_ns, settings.dropout);
            self.output.distance += state.mean(FORWARD) * dt;
            self.output.distance_of_wheels += by_wheels * dt;
        }
        self.path.record(time_ns);
    }

    /// Gates a measurement and updates the state by it.
    fn update(&mut self, time_ns: i64, measurement: &Measurement) -> Result<(), Fault> {
        match *measurement {
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelEdge { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => {
                self.update_wheel(time_ns, wheel, measurement)
            }
            Measurement::WheelTorque { wheel, torque } => {
                Fault::check_range("torque", torque, -MAX_TORQUE_N_M, MAX_TORQUE_N_M, "N m")?;
                self.wheels.get_mut(wheel)?.radius.push(torque);
                Ok(())
            }
            Measurement::Carrier {
                wheel,
                turn,
                forward,
                up,
            } => {
                let carrier = &mut self.wheels.get_mut(wheel)?.carrier;
                carrier.update(time_ns, [turn, forward, up])
            }
            Measurement::YawRate { rate } => {
                let (settings, wheels) = (&self.settings, &self.wheels);
                let is_confirmed = self.gyro.is_trusted(time_ns, settings)
                    && self
                        .ground
                        .as_ref()
                        .is_some_and(|ground| ground.confirms_turn());
                let beside = (wheels, is_confirmed);
                let (state, path) = (&mut self.state, &mut self.path);
                let nis = (self.gyro).update((time_ns, rate), settings, beside, state, path)?;
                self.nis = nis.unwrap_or(self.nis);
                Ok(())
            }
            Measurement::Acceleration { forward, left } => {
                self.accelerometer.update(time_ns, [forward, left])?;
                if let Some(ground) = &mut self.ground {
                    ground.force.observe(time_ns, [forward, left]);
                }
                self.settle_whole_row(time_ns);
                Ok(())
            }
            Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Position { .. }
            | Measurement::Speed { .. } => {
                self.settle_rims();
                self.update_by_reference(time_ns, measurement)
            }
            Measurement::Command { .. }
            | Measurement::Inertial { .. }
            | Measurement::JointAngle { .. }
            | Measurement::Steering { .. }
            | Measurement::Sinkage { .. }
            | Measurement::EntryAngle { .. }
            | Measurement::MotorCurrent { .. } => Ok(()),
            Measurement::SteeringAngle { wheel, angle } => {
                Fault::check_range("steering angle", angle, -7.0, 7.0, "rad")?;
                self.wheels.steer(wheel, angle)
            }
        }
    }

    /// Updates the state by a reading of the reference, which may have been stamped before the present time.
    pub(super) fn update_by_reference(
        &mut self,
        stamp_ns: i64,
        measurement: &Measurement,
    ) -> Result<(), Fault> {
        if self.ground.is_some() {
            self.update_ground_motion(stamp_ns, measurement)
        } else {
            self.update_reference(stamp_ns, measurement)
        }
    }

    /// Does a measurement change any estimate? That of a wheel does only when its window ends or it is received again.
    fn changes_estimate(&self, time_ns: i64, measurement: &Measurement) -> bool {
        match *measurement {
            Measurement::Acceleration { .. }
            | Measurement::WheelTorque { .. }
            | Measurement::Command { .. } => false,
            _ => rotation_of(measurement)
                .and_then(|wheel| self.wheels.channels.get(wheel))
                .is_none_or(|wheel| wheel.has_news(time_ns)),
        }
    }

    /// The clock was set: the motion is forgotten, what was learnt of the sensors is not.
    pub(super) fn restart_clock(&mut self) {
        self.path.restart_clock();
        self.now_ns = None;
        self.has_news = false;
        self.pseudo_measured_ns = None;
        self.output.checked_ns = None;
        self.accelerometer.last = None;
        self.gyro.restart_clock();
        self.speed_known_ns = None;
        self.is_led = false;
        if let Some(ground) = &mut self.ground {
            ground.restart_clock();
        }
        self.reference = ReferenceSensor::default();
        for wheel in &mut self.wheels.channels {
            wheel.restart_clock();
        }
        let bias = self.state.mean(GYRO_BIAS);
        let [moved, turned] =
            [FORWARD, YAW].map(|i| (self.state.mean(i).abs() + self.state.sigma(i)) * CLOCK_STEP_S);
        motion_model::reset_place(&mut self.state, moved, turned);
        self.reset_state();
        self.state.set_mean(GYRO_BIAS, bias);
    }

    /// Sets motion, slips and radii to their priors.
    fn reset_state(&mut self) {
        let Self {
            state, settings, ..
        } = self;
        let square = |x: f64| x * x;
        motion_model::reset(state, settings);
        state.reset(COMMON_SLIP, settings.slip.mean, square(settings.slip.sigma));
        for (i, wheel) in self.wheels.iter().enumerate() {
            let SlipPrior { mean, sigma } = settings.own_slip_prior(wheel.free);
            state.reset(own_slip(i), mean, square(sigma));
            // A larger radius and a smaller slip cannot be distinguished: the radius is not estimated.
            state.set_considered(radius(i), true);
            let sigma = if wheel.free {
                FREE_RADIUS_SIGMA
            } else {
                settings.radius_sigma
            };
            state.reset(radius(i), 0.0, square(sigma));
        }
    }
}

#[cfg(test)]
mod tests;
