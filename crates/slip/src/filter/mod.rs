//! Slip of every wheel online, from all sensors together: a Kalman filter with sequential scalar updates.
//!
//! The state: speeds and yaw rate of the robot; biases of gyro and accelerometer; the powered wheels' common slip, which the
//! soil causes; of each wheel its own slip (of a free wheel: its skid), its radius, and the remainders of its ticks. Radii
//! and place are considered parameters. A wheel whose rim runs at u (1 + ρ) and whose centre travels at v = e · (v + Ω × p)
//! is one linear measurement:
//!
//! ```text
//! u (1 + ρ) = v + s m,   m = the faster of u and v,   s = s_common + s_own
//! ```
//!
//! The robot's speed is known as well as its best reference measures it; without a reference, as well as the prior of the
//! slip. Slips decay to their prior; a wheel that breaks away changes its own slip and nothing else.
//!
//! Each sample passes the input (clocks, reorder buffer) and then one cycle: predict, pseudo-measurements, gate and update,
//! health. Each part owns its state: the input, the Kalman filter with its process model, the wheel bank, the inertial path,
//! the monitors of gyro, accelerometer and reference sensor, and recovery.
//!
//! What the filter guarantees, each with a test of its name (`tests/filter_promises.rs`, `tests/filter_outputs.rs`; long runs
//! in the generator's crate):
//!
//! | | |
//! |---|---|
//! | R1 total | [`SlipFilter::update`] never panics, for any bits |
//! | R2 finite | every output is finite, slip in [−1, 1], sigma > 0 |
//! | R3 bounded | no loop depends on the data; a gap of years costs one update |
//! | R4 | it allocates nothing after construction and reads no clock |
//! | R5 deterministic | the same samples give the same bits; within the horizon in any order |
//! | R6 honest | every refusal is counted by its reason; health names what cannot be trusted |
//! | R7 recovers | two seconds after a fault the estimate is as before |
//! | R8 observable | `time_slip`, `dropped`, `rejected`, `last_good_age` in every estimate |
//! | R9 | sigma grows under faults, and is right without them |

mod accelerometer;
mod carrier;
mod estimator;
mod force_integral;
mod free_wheel_update;
mod ground_motion;
mod ground_track;
mod gyro_monitor;
mod health;
mod inertial_path;
pub(crate) mod input;
mod kalman;
mod learnt;
mod mean_rims;
mod monitor;
mod motion_model;
mod multiple_model;
mod output;
mod pseudo_measurements;
mod pulse_check;
mod radius_check;
mod recovery;
mod reference_sensor;
mod reference_update;
mod reorder_buffer;
mod repeated_rate;
mod rolling_history;
mod sensor_checks;
pub(crate) mod sensor_clocks;
mod settings;
mod stamp_scatter;
mod start_shear;
mod turn_agreement;
mod wheel_bank;
mod wheel_channel;
mod wheel_update;

use grouser_real::Real;

use crate::error::{Error, Result, check_range};
use crate::fault::Fault;
use crate::robot::Robot;
use crate::sample::Sample;
use crate::state::Health;
use estimator::Core;
use input::Input;
pub use learnt::{Learnt, LearntWheel};
use motion_model::{FORWARD, YAW};
pub use output::{BodyEstimate, FilterOutput, Odometry, RimPath, WheelCheck};
use sensor_clocks::ClockOutcome;
pub use settings::{FilterSettings, SlipPrior};

/// The largest number of wheels of the filter: its cost grows with their square.
pub const MAX_FILTER_WHEELS: usize = 8;
/// The largest number of waiting samples that one update uses, so that its cost is bounded.
const MAX_RELEASED_PER_UPDATE: usize = 4;
/// A clock that goes further than this at once has been set, s.
const CLOCK_STEP_S: f64 = 1.0;
/// A wheel that stands while the robot moves, or turns against it, for this long has a wrong encoder, s.
const WRONG_ENCODER_TIME_S: f64 = 0.25;
/// Pseudo-measurements come this often, s.
const PSEUDO_MEASUREMENT_PERIOD_S: f64 = 0.02;
/// Without a reference for this long the speed follows the wheels, s.
const REFERENCE_TIMEOUT_S: f64 = 0.5;
/// Process noise density of the speed without a reference, as a multiple of the one with it.
const UNAIDED_NOISE_FACTOR: f64 = 10.0;
/// One innovation counts for at most this many sigma where something is learnt from it.
const INNOVATION_CLAMP_SIGMA: f64 = 4.0;
/// A robot that has rolled further than this has fallen over, rad.
const MAX_ROLL_RAD: f64 = 1.2;
/// A reference that failed is readmitted when it is within this share of the robot's speed.
const READMIT_SPEED_SHARE: f64 = 0.15;

/// Slip of every wheel from all sensors together: encoders, free wheels, gyro, accelerometer, and measured motion.
///
/// ```
/// use grouser_slip::filter::{FilterSettings, SlipFilter};
/// use grouser_slip::{Measurement, Robot, Sample, Wheel};
///
/// let wheels = vec![
///     Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000),
///     Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
/// ];
/// let robot = Robot::new("bicycle".into(), wheels)?;
/// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
/// for step in 0..300_u64 {
///     let time_ns = step as i64 * 10_000_000;
///     // The powered wheel turns 10 ticks a step, the free one 8: the robot travels at 80 % of the rim.
///     for (wheel, raw) in [(0, 10 * step), (1, 8 * step)] {
///         filter.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } })?;
///     }
///     filter.update(Sample { time_ns, measurement: Measurement::YawRate { rate: 0.0 } })?;
/// }
/// let wheel = filter.latest().wheels[0];
/// assert!((wheel.slip.unwrap().value() - 0.2).abs() < 2.0 * wheel.sigma.unwrap());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SlipFilter {
    input: Input,
    core: Core,
}

impl SlipFilter {
    /// A filter for `robot`. Only this allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a setting outside its limits, [`Error::WheelCount`] for more than
    /// [`MAX_FILTER_WHEELS`] wheels.
    pub fn new(robot: &Robot, settings: FilterSettings) -> Result<Self> {
        settings.check()?;
        let count = robot.wheels().len();
        if count > MAX_FILTER_WHEELS {
            return Err(Error::WheelCount {
                count,
                limit: MAX_FILTER_WHEELS,
            });
        }
        Ok(Self {
            input: Input::new(count, &settings),
            core: Core::new(robot, settings),
        })
    }

    /// Uses one sample of one sensor and returns the output after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample (or one that waited before it): it is counted and changes no estimate.
    pub fn update(&mut self, sample: Sample) -> ::core::result::Result<FilterOutput<'_>, Fault> {
        let outcome = self.push(sample);
        let output = self.settled();
        outcome.map(|()| output)
    }

    /// [`SlipFilter::latest`] after [`SlipFilter::push`].
    pub(crate) fn settled(&mut self) -> FilterOutput<'_> {
        self.core.settle_estimates(&self.input);
        self.latest()
    }

    /// [`SlipFilter::update`] without an output: the wheels' estimates follow with the next time of a reading, or when they
    /// are requested.
    pub(crate) fn push(&mut self, sample: Sample) -> ::core::result::Result<(), Fault> {
        let outcome = if sample.measurement.is_raw() {
            Ok(())
        } else {
            self.accept(sample)
        };
        if let Err(fault) = &outcome {
            self.input.rejected.count(fault);
        }
        outcome
    }

    /// The output after the last sample.
    #[must_use]
    pub fn latest(&self) -> FilterOutput<'_> {
        self.core.output(&self.input)
    }

    /// The robot's forward speed, where any wheel shows it, m/s.
    pub(crate) fn forward_speed(&self) -> Option<f64> {
        let is_known = self
            .core
            .output
            .estimates
            .iter()
            .any(|wheel| !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised));
        is_known.then(|| self.core.state.mean(FORWARD))
    }

    /// Its yaw rate, rad/s.
    pub(crate) fn yaw_rate(&self) -> f64 {
        self.core.state.mean(YAW)
    }

    /// The output if it is `now_ns` and no sample has come since: silence is a fault too.
    ///
    /// ```
    /// use grouser_slip::filter::{FilterSettings, SlipFilter};
    /// use grouser_slip::{Health, Measurement, Robot, Sample, Wheel};
    ///
    /// let wheels = vec![
    ///     Wheel::powered("drive").at(0.3, 0.0).ticks_per_turn(1000),
    ///     Wheel::free("fifth").at(-0.3, 0.0).ticks_per_turn(1000),
    /// ];
    /// let mut filter = SlipFilter::new(&Robot::new("bicycle".into(), wheels)?, FilterSettings::default())?;
    /// for step in 0..200_u64 {
    ///     for wheel in [0, 1] {
    ///         let measurement = Measurement::WheelCount { wheel, raw: 10 * step };
    ///         filter.update(Sample { time_ns: step as i64 * 10_000_000, measurement })?;
    ///     }
    /// }
    /// // Ten seconds of silence: no slip is claimed any more.
    /// let silent = filter.estimate_at(12_000_000_000);
    /// assert!(matches!(silent.wheels[0].health, Health::Invalid(_)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn estimate_at(&mut self, now_ns: i64) -> FilterOutput<'_> {
        self.core.update_health(now_ns, &self.input);
        self.latest()
    }

    /// Sets the prior of the powered wheels' common slip, where the soil's slip demand has changed.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a mean outside [−1, 1] or a sigma outside [1e-6, 2].
    ///
    /// ```
    /// use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
    /// filter.set_slip_prior(SlipPrior { mean: 0.25, sigma: 0.1 })?; // uphill
    /// assert!(filter.set_slip_prior(SlipPrior { mean: f64::NAN, sigma: 0.1 }).is_err());
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn set_slip_prior(&mut self, slip: SlipPrior) -> Result<()> {
        let settings = FilterSettings {
            slip,
            ..self.core.settings
        };
        settings.check()?;
        self.core.settings = settings;
        Ok(())
    }

    /// Sets the steering angle of a wheel (rad, to the left, beside its heading in the description).
    ///
    /// # Errors
    /// [`Error::UnknownWheel`] for a wheel that the robot does not have, [`Error::OutOfRange`] for an angle outside
    /// [−7, 7] rad.
    ///
    /// ```
    /// use grouser_slip::filter::{FilterSettings, SlipFilter};
    /// use grouser_slip::{Error, Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
    /// filter.set_steering_angle(0, 0.3)?;
    /// assert!(matches!(filter.set_steering_angle(1, 0.3), Err(Error::UnknownWheel { .. })));
    /// # Ok::<(), Error>(())
    /// ```
    pub fn set_steering_angle(&mut self, wheel: usize, angle: f64) -> Result<()> {
        check_range("steering", "angle", angle, (-7.0, 7.0), "rad")?;
        let wheels = self.core.wheels.channels.len();
        let steered = self.core.wheels.steer(wheel, angle);
        steered.map_err(|_| Error::UnknownWheel {
            index: wheel,
            wheels,
        })
    }

    /// Sets the robot's roll (rad, either side down): across a slope it drifts downhill, which a steered wheel takes for
    /// slip. Beyond 1.2 rad it counts as 1.2; a number that is not finite changes nothing.
    ///
    /// ```
    /// use grouser_slip::filter::{FilterSettings, SlipFilter};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
    /// filter.set_roll(0.2);
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn set_roll(&mut self, roll: f64) {
        if roll.is_finite() {
            self.core.cross_slope = Real::tan(roll.abs().min(MAX_ROLL_RAD));
        }
    }

    /// What the filter has learnt so far.
    #[must_use]
    pub fn learnt(&self) -> Learnt {
        self.core.learnt()
    }

    /// Continues with what was learnt before a restart, in place of the priors of the settings.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its limits; nothing changes then.
    ///
    /// ```
    /// use grouser_slip::filter::{FilterSettings, SlipFilter};
    /// use grouser_slip::{Robot, Wheel};
    ///
    /// let robot = Robot::new("cart".into(), vec![Wheel::powered("left").ticks_per_turn(100)])?;
    /// let before = SlipFilter::new(&robot, FilterSettings::default())?;
    /// let mut after = SlipFilter::new(&robot, FilterSettings::default())?;
    /// after.restore(&before.learnt())?; // what was learnt survives a restart of the computer
    /// assert_eq!(after.learnt(), before.learnt());
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        self.core.restore(learnt)
    }

    /// Puts a sample in order, and uses those whose time has come.
    fn accept(&mut self, sample: Sample) -> ::core::result::Result<(), Fault> {
        if self.input.check_clock(&sample)? == ClockOutcome::Set {
            self.input.clear();
            self.core.restart_clock();
        }
        sample.measurement.check_finite()?;
        if self.input.is_late(&sample) {
            // A measured motion carries its time of capture: it is applied through the history.
            return self.core.update_late(&sample, &self.input);
        }
        let mut outcome = Ok(());
        if self.input.is_full()
            && let Some(oldest) = self.input.release(true)
        {
            outcome = self.core.step(&oldest, &self.input);
        }
        if !self.input.offer(sample) {
            return Err(Fault::NotLater {
                time_ns: sample.time_ns,
                last_ns: self.core.now_ns.unwrap_or(sample.time_ns),
            });
        }
        for _ in 0..MAX_RELEASED_PER_UPDATE {
            let Some(next) = self.input.release(false) else {
                break;
            };
            outcome = outcome.and(self.core.step(&next, &self.input));
        }
        outcome
    }
}

#[cfg(test)]
mod tests;
