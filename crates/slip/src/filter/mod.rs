//! Slip of every wheel online, from all sensors together: the model of the motion under several modes of the slip.
//!
//! | file | knows |
//! |---|---|
//! | `input`, `reorder_buffer`, `sensor_clocks` | samples checked by their sensors' clocks, in the order of their time |
//! | `gather` | samples as steps of time: how far wheels, gyro and accelerometer went over each |
//! | `references` | readings of places, headings and speeds, and the frame in which they are |
//! | `gyro`, `free_wheel`, `checks`, `repeats` | monitors: sensors that contradict the others, miss pulses or repeat themselves |
//! | `steps` | steps through the filter over the modes ([`modes`](crate::modes)), and what follows them |
//! | `wheel_health` | each wheel's estimate, and how far it can be trusted |
//! | `output`, `learnt`, `settings` | what leaves, what outlasts a restart, what is set |
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

mod checks;
mod free_wheel;
mod gather;
mod gyro;
pub(crate) mod input;
mod learnt;
mod output;
mod pulse_check;
mod radius_check;
mod rates;
mod references;
mod reorder_buffer;
mod repeats;
pub(crate) mod sensor_clocks;
mod settings;
mod steps;
mod wheel_health;

use crate::error::{Error, Result, check_range};
use crate::fault::Fault;
use crate::robot::Robot;
use crate::sample::Sample;
use crate::state::Health;
pub use checks::WheelCheck;
use input::Input;
pub use learnt::Learnt;
pub use output::{BodyEstimate, FilterOutput, Odometry};
use sensor_clocks::ClockOutcome;
pub use settings::{FilterSettings, SlipPrior};
use steps::Core;
pub use steps::Recorder;

/// The largest number of waiting samples that one update uses, so that its cost is bounded.
const MAX_RELEASED_PER_UPDATE: usize = 4;

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
    /// Length of the steps in which the motion is estimated, s; longer where the wheels are read less often.
    pub const STEP_S: f64 = gather::MIN_STEP_S;

    /// A filter for `robot`. Only this allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a setting outside its limits.
    pub fn new(robot: &Robot, settings: FilterSettings) -> Result<Self> {
        settings.check()?;
        Ok(Self {
            input: Input::new(robot.wheels().len(), settings.horizon),
            core: Core::new(robot, settings),
        })
    }

    /// Uses one sample of one sensor and returns the output after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample (or one that waited before it): it is counted and changes no estimate.
    pub fn update(&mut self, sample: Sample) -> ::core::result::Result<FilterOutput<'_>, Fault> {
        let outcome = self.push(sample);
        outcome.map(|()| self.latest())
    }

    /// [`SlipFilter::update`] without an output.
    pub(crate) fn push(&mut self, sample: Sample) -> ::core::result::Result<(), Fault> {
        self.update_recorded(sample, &mut |_, _, _| {})
    }

    /// As [`SlipFilter::update`]; `record` is shown each step of the motion once its readings are complete, with the time of its end,
    /// ns, and the filter after it. The steps are what [`fit`](crate::smooth::fit) takes for a whole log.
    ///
    /// # Errors
    /// As [`SlipFilter::update`].
    pub fn update_recorded(
        &mut self,
        sample: Sample,
        record: &mut Recorder<'_>,
    ) -> ::core::result::Result<(), Fault> {
        let outcome = if sample.measurement.is_raw() {
            Ok(())
        } else {
            self.accept(sample, record)
        };
        if let Err(fault) = &outcome {
            self.input.rejected.count(fault);
        }
        outcome
    }

    /// The log is over: `record` is shown the steps that waited for readings.
    pub fn finish_recorded(&mut self, record: &mut Recorder<'_>) {
        self.core.finish(record);
    }

    /// The output after the last sample.
    #[must_use]
    pub fn latest(&self) -> FilterOutput<'_> {
        self.core.output(&self.input)
    }

    /// The robot's forward speed, where any wheel shows it, m/s.
    pub(crate) fn forward_speed(&self) -> Option<f64> {
        let is_known = (self.core.estimates.iter())
            .any(|wheel| !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised));
        is_known.then(|| self.core.filter().motion().velocity[0])
    }

    /// Its yaw rate, rad/s.
    pub(crate) fn yaw_rate(&self) -> f64 {
        self.core.filter().motion().velocity[2]
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
        self.core.update_health(now_ns);
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
        self.core.set_prior(slip);
        Ok(())
    }

    /// Sets the steering angle of a wheel (rad, to the left, relative to its heading in the description).
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
        let wheels = self.core.estimates.len();
        let steered = self.core.gather.steer(wheel, angle);
        steered.then_some(()).ok_or(Error::UnknownWheel {
            index: wheel,
            wheels,
        })
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
    fn accept(
        &mut self,
        sample: Sample,
        record: &mut Recorder<'_>,
    ) -> ::core::result::Result<(), Fault> {
        if self.input.check_clock(&sample)? == ClockOutcome::Set {
            self.input.clear();
            self.core.restart_clock(record);
        }
        sample.measurement.check_finite()?;
        if self.input.is_late(&sample) {
            // a measured motion carries its time of capture
            return self.core.take(&sample, record);
        }
        let mut outcome = Ok(());
        if self.input.is_full()
            && let Some(oldest) = self.input.release(true)
        {
            outcome = self.core.take(&oldest, record);
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
            outcome = outcome.and(self.core.take(&next, record));
        }
        outcome
    }
}
