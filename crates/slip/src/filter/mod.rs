//! Slip of every wheel online, from all sensors together.
//!
//! What is unknown: the robot's speeds and yaw rate, the biases of gyro and accelerometer, the powered wheels' common
//! slip (the soil's doing), each wheel's own part of it, each free wheel's skid, each wheel's radius. Every reading is one
//! linear statement about a few of these. For a wheel whose rim runs at u (1 + ρ) and whose centre goes at v = e · (v + Ω × p):
//!
//! ```text
//! u (1 + ρ) = v + s m,   m = the faster of u and v,   s = s_common + s_own
//! ```
//!
//! so the robot's speed is known as well as its best reference says, and where there is none, as well as the prior of the
//! slip says. Slips are drawn towards their prior; a wheel that breaks away changes its own slip and nothing else.
//!
//! Promises: [`SlipFilter::update`] never panics for any input bits; its outputs are finite; its cost does not depend on
//! the data; it allocates nothing; the same samples give the same bits; a sample that is refused is counted; samples within
//! the horizon may come in any order.

mod body;
mod kalman;
mod order;
mod reference;
mod settings;
mod turn;
mod watch;
mod wheel;

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;
use grouser_terra::Slip;

use crate::error::{Error, Result};
use crate::estimate::WheelEstimate;
use crate::fault::{Fault, Rejected};
use crate::history::{History, nanoseconds, seconds_between};
use crate::measured_slip::MeasuredSlip;
use crate::robot::Robot;
use crate::sample::{Measurement, Sample};
use crate::settings::Settings;
use crate::speed::Measured;
use crate::state::{Degraded, Health, Invalid, Motion};
use body::{
    COMMON_SLIP, FORWARD, GYRO_BIAS, Heard, LEFT, PER_WHEEL, YAW, along, own_slip, radius,
    remainder,
};
use kalman::{Kalman, Scalar};
use order::{Offered, Order};
use reference::{Reference, Seen};
pub use settings::{FilterSettings, SlipPrior};
use turn::Turn;
use watch::Watch;
use wheel::{LONGEST, Tracked};

/// The most wheels that the filter takes: its cost grows with their square.
pub const MAX_FILTER_WHEELS: usize = 8;
/// Samples that can wait for earlier ones.
const QUEUE: usize = 256;
/// At most this many samples are worked off by one update.
const AT_ONCE: usize = 4;
/// A clock that goes further than this at once has been set, s.
const CLOCK_STEP: f64 = 1.0;
/// When all samples have come too late for this long, the clock has been set back, s.
const LATE: f64 = 0.1;
/// A wheel that stands while the robot moves for this long is stuck, or turns against it: its encoder is wrong, s.
const WRONG: f64 = 0.25;
/// All wheels still for this long: the robot stands, s.
const STANDS: f64 = 0.2;
/// Pseudo-measurements come this often, s.
const EVERY: f64 = 0.02;
/// Independent statements of a pseudo-measurement come this often, s.
const APART: f64 = 0.5;
/// Without a reference for this long the speed follows the wheels, s; how much looser it is then.
const ALONE: f64 = 0.5;
const LOOSE: f64 = 10.0;
/// Wheels whose readings are off to one side by this much in the mean, in sigma, break away together; how fast that mean
/// forgets, a reading; and the most that one reading says.
const PULLED: f64 = 0.7;
const TOGETHER: f64 = 0.2;
const BREAKS: f64 = 4.0;
/// How fast a wheel's unrest is learnt, a reading, and its limits.
const LEARNING: f64 = 0.005;
const UNREST: (f64, f64) = (0.1, 100.0);
/// What a rim and the robot may differ by for other reasons than slip, m/s.
const CREEP: f64 = 5e-4;
const MAX_YAW_RATE: f64 = 100.0;
/// No wheeled robot is pushed harder than this, m/s²: an accelerometer that shows more has been hit.
const MAX_FORCE: f64 = 20.0;
/// A gyro that shows the same to the bit for this long while the wheels turn is stuck, s.
const SAME: f64 = 0.5;
/// A free wheel that failed is believed again when it is within this share of the robot's speed.
const RETURNS: f64 = 0.15;
/// A free wheel whose skid is less certain than this is no reference.
const SKID_KNOWN: f64 = 0.1;
/// How fast the accelerometer's unrest is learnt, a reading of a reference, and its limits.
const FELT: f64 = 0.01;
const FELT_UNREST: (f64, f64) = (1.0, 40.0);
/// How far the yaw rate is from what the powered wheels would give, as a share and rad/s.
const BY_WHEELS: (f64, f64) = (0.3, 0.05);
/// How fast the mean residual of a camera or its like forgets, a reading, and from where on it is a contradiction, in sigma.
const ONE_SIDE: f64 = 0.3;
const ONE_SIDED: f64 = 2.0;
/// A robot this much faster than its fastest wheel (as a share, and m/s) for long is an error of the filter.
const RUNAWAY: (f64, f64) = (1.5, 0.05);

/// A speed that was seen: slopes, residual, variance.
type Statement = ([(usize, f64); 3], f64, f64);

/// What the filter knows of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FusedBody {
    /// Speed forwards, m/s.
    pub forward: Measured,
    /// Speed to the left, m/s.
    pub left: Measured,
    /// Yaw rate, rad/s, positive to the left.
    pub yaw_rate: Measured,
    /// The powered wheels' common slip.
    pub common_slip: Measured,
    /// Way since the start along the robot's own forward direction, m, and what the powered wheels alone would say.
    pub distance: f64,
    /// The same without compensation of slip, m.
    pub distance_of_wheels: f64,
    /// Squared residual of the last measurement over its variance.
    pub nis: f64,
}

/// What is known after a sample.
#[derive(Clone, Copy, Debug)]
pub struct Fused<'a> {
    /// Up to when the readings have been used, ns: the horizon behind the newest.
    pub time_ns: i64,
    /// Each wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// The robot.
    pub body: FusedBody,
    /// Samples refused so far.
    pub rejected: Rejected,
    /// Seconds since a reference for the robot's speed was last believed; `None` before the first.
    pub reference_age: Option<f64>,
}

/// Slip of every wheel from all sensors together: encoders, free wheels, gyro, accelerometer, and measured motion.
///
/// ```
/// use grouser_slip::filter::{FilterSettings, SlipFilter};
/// # use grouser_slip::{CounterWidth, Drive, Encoder, Measurement, Robot, Sample, Shaft, Wheel};
/// # use grouser_terra::Angle;
/// # let encoder = Encoder { shaft: Shaft::Wheel, gear: 1.0, ticks_per_turn: Some(1000.0),
/// #     counter: CounterWidth::new(16)?, reversed: false, rate_step: 0.0 };
/// # let wheel = |name: &str, x, drive| Wheel { name: name.into(), x, y: 0.0,
/// #     heading: Angle::from_deg(0.0), radius: 0.1, drive, encoder, width: None, load: None };
/// # let robot = Robot::new("bicycle".into(),
/// #     vec![wheel("drive", 0.3, Drive::Powered), wheel("fifth", -0.3, Drive::Free)])?;
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
    settings: FilterSettings,
    limits: Settings,
    state: Kalman,
    order: Order,
    wheels: Box<[Tracked]>,
    estimates: Box<[WheelEstimate]>,
    sideways: Option<[f64; 3]>,
    /// How much the accelerometer has changed the speeds (m/s), and how far the gyro has turned (rad): what a measurement
    /// over a past time needs to be one of the present.
    path: History<3>,
    turning: f64,
    totals: [f64; 3],
    now_ns: Option<i64>,
    held_ns: Option<i64>,
    heard: Option<Heard>,
    gyro: Watch,
    gyro_ns: Option<i64>,
    /// The gyro's last reading to the bit, and since when.
    gyro_same: Option<(u64, i64)>,
    turn: Turn,
    turned_ns: Option<i64>,
    contradicted: Watch,
    runaway: Watch,
    /// How much worse than told the accelerometer foresees the speed, as a share of that variance.
    felt_unrest: f64,
    reference: Reference,
    reference_ns: Option<i64>,
    suspect_ns: Option<i64>,
    /// Nothing but samples that came too late, since this one.
    late_from_ns: Option<i64>,
    /// Mean of the powered wheels' residuals, in sigma.
    pull: f64,
    distances: [f64; 2],
    nis: f64,
    rejected: Rejected,
}

impl SlipFilter {
    /// A filter for `robot`. This is the only place that allocates.
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
        let wheels: Vec<_> = Tracked::all(robot, &settings).collect();
        let longest = settings.reference_latency + settings.horizon + CLOCK_STEP;
        let mut filter = Self {
            limits: Settings {
                standstill_speed: settings.standstill_speed,
                low_speed: settings.low_speed,
                max_sigma: settings.max_sigma,
                ..Settings::default()
            },
            state: Kalman::new(COMMON_SLIP + 1 + PER_WHEEL * count),
            order: Order::new(QUEUE, nanoseconds(settings.horizon)),
            estimates: alloc::vec![WheelEstimate::NOTHING; count].into_boxed_slice(),
            sideways: sideways(&wheels),
            wheels: wheels.into_boxed_slice(),
            path: History::new(512, nanoseconds(longest)),
            totals: [0.0; 3],
            turning: 0.0,
            now_ns: None,
            held_ns: None,
            heard: None,
            gyro: Watch::default(),
            gyro_ns: None,
            gyro_same: None,
            turn: Turn::default(),
            turned_ns: None,
            contradicted: Watch::default(),
            runaway: Watch::default(),
            felt_unrest: 1.0,
            reference: Reference::default(),
            reference_ns: None,
            suspect_ns: None,
            late_from_ns: None,
            pull: 0.0,
            distances: [0.0; 2],
            nis: 0.0,
            rejected: Rejected::default(),
            settings,
        };
        filter.start();
        Ok(filter)
    }

    /// Takes one sample of one sensor and gives what is known after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample (or one that waited before it): it is counted and enters no estimate.
    pub fn update(&mut self, sample: Sample) -> core::result::Result<Fused<'_>, Fault> {
        let taken = self.accept(sample);
        if let Err(fault) = &taken {
            self.rejected.count(fault);
        }
        taken.map(|()| self.latest())
    }

    /// What is known now.
    #[must_use]
    pub fn latest(&self) -> Fused<'_> {
        let speed = |i: usize| Measured {
            value: self.state.mean(i),
            variance: self.state.covariance(i, i),
        };
        let time_ns = self.now_ns.unwrap_or(0);
        Fused {
            time_ns,
            wheels: &self.estimates,
            body: FusedBody {
                forward: speed(FORWARD),
                left: speed(LEFT),
                yaw_rate: speed(YAW),
                common_slip: speed(COMMON_SLIP),
                distance: self.distances[0],
                distance_of_wheels: self.distances[1],
                nis: self.nis,
            },
            rejected: self.rejected,
            reference_age: self.reference_ns.map(|then| seconds_between(then, time_ns)),
        }
    }

    /// What can be said of the wheels if it is `now_ns` and no sample has come since: silence is a fault too.
    pub fn at(&mut self, now_ns: i64) -> Fused<'_> {
        self.judge(now_ns);
        self.latest()
    }

    /// The soil has another slip demand than was believed: the prior of the powered wheels' common slip.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a mean outside [−1, 1] or a sigma outside [1e-6, 2].
    pub fn believe(&mut self, slip: SlipPrior) -> Result<()> {
        let settings = FilterSettings {
            slip,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        Ok(())
    }

    /// The free wheels skid otherwise than was believed: on another soil, or under another load.
    ///
    /// # Errors
    /// As [`SlipFilter::believe`].
    pub fn believe_free_wheels(&mut self, free_slip: SlipPrior) -> Result<()> {
        let settings = FilterSettings {
            free_slip,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        for index in 0..self.wheels.len() {
            if self.wheels[index].free {
                let SlipPrior { mean, sigma } = free_slip.by_rim();
                self.state.restart(own_slip(index), mean, sigma * sigma);
            }
        }
        Ok(())
    }

    fn start(&mut self) {
        let Self {
            state, settings, ..
        } = self;
        body::start(state, settings);
        let square = |x: f64| x * x;
        state.restart(COMMON_SLIP, settings.slip.mean, square(settings.slip.sigma));
        for (i, wheel) in self.wheels.iter().enumerate() {
            let (mean, sigma) = if wheel.free {
                let SlipPrior { mean, sigma } = settings.free_slip.by_rim();
                (mean, sigma)
            } else {
                (0.0, settings.wheel_slip_sigma)
            };
            state.restart(own_slip(i), mean, square(sigma));
            // Nothing tells a larger radius from a smaller slip.
            state.consider(radius(i), true);
            state.restart(
                radius(i),
                0.0,
                square(if wheel.free {
                    1e-6
                } else {
                    settings.radius_sigma
                }),
            );
        }
    }

    fn accept(&mut self, sample: Sample) -> core::result::Result<(), Fault> {
        self.check_clock(sample.time_ns)?;
        let mut outcome = Ok(());
        if self.order.is_full()
            && let Some(oldest) = self.order.release(true)
        {
            outcome = self.work_off(oldest);
        }
        if self.order.offer(sample) == Offered::TooLate {
            let last_ns = self.now_ns.unwrap_or(sample.time_ns);
            let from = *self.late_from_ns.get_or_insert(sample.time_ns);
            if seconds_between(from, sample.time_ns) < LATE {
                return Err(Fault::NotLater {
                    time_ns: sample.time_ns,
                    last_ns,
                });
            }
            // nothing but late samples: the clock was set back
            self.restart_clock();
            self.order.offer(sample);
        }
        self.late_from_ns = None;
        for _ in 0..AT_ONCE {
            let Some(next) = self.order.release(false) else {
                break;
            };
            outcome = outcome.and(self.work_off(next));
        }
        outcome
    }

    /// A time far from the last one is refused once; a second one beside it is a clock that was set.
    fn check_clock(&mut self, time_ns: i64) -> core::result::Result<(), Fault> {
        let Some(newest) = self.order.newest_ns() else {
            return Ok(());
        };
        let gap = seconds_between(newest, time_ns);
        if gap.abs() <= CLOCK_STEP {
            return Ok(());
        }
        let follows = self.suspect_ns.is_some_and(|suspect| {
            let step = seconds_between(suspect, time_ns);
            (0.0..=CLOCK_STEP).contains(&step)
        });
        if !follows {
            self.suspect_ns = Some(time_ns);
            return Err(Fault::ClockStep {
                time_ns,
                last_ns: newest,
            });
        }
        self.restart_clock();
        Ok(())
    }

    fn restart_clock(&mut self) {
        self.suspect_ns = None;
        self.late_from_ns = None;
        self.order.clear();
        self.path.clear();
        self.now_ns = None;
        self.held_ns = None;
        self.heard = None;
        self.reference = Reference::default();
        // the gyro's bias outlasts a pause, speeds and slips do not
        let bias = self.state.mean(GYRO_BIAS);
        self.start();
        self.state.set_mean(GYRO_BIAS, bias);
    }

    fn work_off(&mut self, sample: Sample) -> core::result::Result<(), Fault> {
        let time_ns = sample.time_ns;
        self.advance(time_ns);
        let taken = match sample.measurement {
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelEdge { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => {
                self.take_wheel(time_ns, wheel, &sample.measurement)
            }
            Measurement::WheelTorque { wheel, torque } => self.take_torque(time_ns, wheel, torque),
            Measurement::YawRate { rate } => self.take_yaw_rate(time_ns, rate),
            Measurement::Acceleration { forward, left } => {
                self.take_acceleration(time_ns, [forward, left])
            }
            Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Speed { .. } => self.take_reference(time_ns, &sample.measurement),
            Measurement::Command { .. } => Ok(()),
        };
        self.judge(time_ns);
        taken
    }

    /// Moves everything on to `time_ns`.
    fn advance(&mut self, time_ns: i64) {
        let last = self.now_ns.unwrap_or(time_ns);
        let dt = seconds_between(last, time_ns).clamp(0.0, CLOCK_STEP);
        self.now_ns = Some(time_ns);
        if dt > 0.0 {
            let silent =
                |heard: &Heard| seconds_between(heard.time_ns, time_ns) <= self.settings.dropout;
            let heard = self.heard.filter(silent).filter(|_| self.feels());
            let walk = self.walk();
            let felt = body::advance(&mut self.state, &self.settings, dt, heard, walk);
            let wheels = self.wheels.iter().map(|wheel| (wheel.free, wheel.unrest));
            body::advance_slips(&mut self.state, &self.settings, dt, wheels);
            self.totals[0] += felt[0];
            self.totals[1] += felt[1];
            self.totals[2] += self.turning * dt;
            self.distances[0] += self.state.mean(FORWARD) * dt;
        }
        self.path.push(time_ns, self.totals);
        let due = self
            .held_ns
            .is_none_or(|held| seconds_between(held, time_ns) >= EVERY);
        if due {
            self.held_ns = Some(time_ns);
            self.assume(time_ns);
            self.catch_runaway(time_ns);
            self.state.tidy();
        }
    }

    /// What needs no sensor: a robot whose wheels all point one way does not drift far, and one whose wheels all stand,
    /// stands.
    fn assume(&mut self, time_ns: i64) {
        let weight = Real::sqrt(APART / EVERY);
        if let Some(row) = self.sideways {
            let sigma = weight * self.settings.lateral_sigma;
            body::hold(&mut self.state, row, 0.0, sigma);
        }
        let heard = self
            .gyro_ns
            .is_some_and(|then| seconds_between(then, time_ns) <= self.settings.dropout);
        let believed = !self.gyro.has_failed() && !self.contradicted.has_failed();
        if !(heard && believed)
            && let Some(turn) = self.turn_by_wheels()
        {
            // nothing else tells how the robot turns
            let sigma = BY_WHEELS.0 * turn.abs() + BY_WHEELS.1;
            body::hold(&mut self.state, [0.0, 0.0, 1.0], turn, weight * sigma);
        }
        for wheel in self.wheels.iter().filter(|wheel| wheel.free) {
            let still = wheel.stillness(time_ns);
            if still >= STANDS && wheel.watch.is_clean() {
                // it has gone less than a tick since
                let sigma = (0.6 * wheel.tick / still).max(0.002);
                body::hold(&mut self.state, wheel.row, 0.0, weight * sigma);
            }
        }
        let stand = self
            .wheels
            .iter()
            .all(|wheel| wheel.stillness(time_ns) >= STANDS && !wheel.watch.has_failed());
        if stand {
            for wheel in &mut self.wheels {
                wheel.has_turned = false;
            }
            // without a free wheel it may still slide with its wheels locked
            let rolls = self.wheels.iter().any(|wheel| wheel.free);
            let sigma = if rolls { 0.002 } else { 0.02 };
            let variance = self.state.variance_of(&[(FORWARD, 1.0)]) + sigma * sigma;
            self.learn_felt(self.state.mean(FORWARD), variance);
            for row in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
                body::hold(&mut self.state, row, 0.0, weight * sigma);
            }
            body::hold(&mut self.state, [0.0, 0.0, 1.0], 0.0, weight * 0.002);
        }
    }

    fn take_yaw_rate(&mut self, time_ns: i64, rate: f64) -> core::result::Result<(), Fault> {
        Fault::check_range("yaw rate", rate, -MAX_YAW_RATE, MAX_YAW_RATE, "rad/s")?;
        let sigma = self.settings.yaw_rate_sigma;
        let seen = Scalar {
            slopes: &[(YAW, 1.0), (GYRO_BIAS, 1.0)],
            residual: rate - self.state.mean(YAW) - self.state.mean(GYRO_BIAS),
            variance: sigma * sigma,
        };
        let (residual, variance) = self.state.innovation(&seen);
        let agreed = residual.abs() <= self.settings.gate * Real::sqrt(variance)
            && !self.is_stuck(time_ns, rate);
        let believed = self.gyro.judge(time_ns, agreed, self.settings.failure);
        self.gyro_ns = Some(time_ns);
        if let Some(wheels) = self.turn_by_wheels() {
            let dt = seconds_between(self.turned_ns.replace(time_ns).unwrap_or(time_ns), time_ns);
            self.turn.take(rate, wheels, dt);
        }
        let same_way = !self.turn.contradicts();
        self.contradicted
            .judge(time_ns, same_way, self.settings.failure);
        if !agreed || !believed || self.contradicted.has_failed() {
            self.turning = self.state.mean(YAW);
            return Ok(());
        }
        self.turning = rate;
        self.nis = self.state.take(&seen);
        Ok(())
    }

    /// Has the gyro shown the same to the bit for long, while wheels turn?
    fn is_stuck(&mut self, time_ns: i64, rate: f64) -> bool {
        let same = rate.to_bits();
        let moves = self.wheels.iter().any(|wheel| wheel.turns());
        match self.gyro_same {
            Some((bits, since)) if bits == same && moves => seconds_between(since, time_ns) >= SAME,
            _ => {
                self.gyro_same = Some((same, time_ns));
                false
            }
        }
    }

    /// The yaw rate that the powered wheels would give without slip, where all point one way.
    fn turn_by_wheels(&self) -> Option<f64> {
        self.sideways?;
        let powered = || self.wheels.iter().filter(|wheel| !wheel.free);
        let count = powered().count() as f64;
        let (mut rims, mut arms) = (0.0, 0.0);
        for wheel in powered() {
            rims += wheel.rim?.0.value;
            arms += wheel.row[2];
        }
        let (mut product, mut square) = (0.0, 0.0);
        for wheel in powered() {
            let arm = wheel.row[2] - arms / count;
            product += arm * (wheel.rim?.0.value - rims / count);
            square += arm * arm;
        }
        (square > 1e-6).then(|| product / square)
    }

    fn take_acceleration(
        &mut self,
        time_ns: i64,
        force: [f64; 2],
    ) -> core::result::Result<(), Fault> {
        for (field, value) in [
            ("acceleration forward", force[0]),
            ("acceleration left", force[1]),
        ] {
            Fault::check_range(field, value, -MAX_FORCE, MAX_FORCE, "m/s²")?;
        }
        self.heard = Some(Heard { time_ns, force });
        Ok(())
    }

    fn take_torque(
        &mut self,
        time_ns: i64,
        wheel: usize,
        torque: f64,
    ) -> core::result::Result<(), Fault> {
        Fault::check_range("torque", torque, -1e7, 1e7, "N m")?;
        let wheels = self.wheels.len();
        let tracked = self.wheels.get_mut(wheel).ok_or(Fault::UnknownWheel {
            index: wheel,
            wheels,
        })?;
        tracked.torque = Some((time_ns, torque));
        Ok(())
    }

    fn take_wheel(
        &mut self,
        time_ns: i64,
        index: usize,
        measurement: &Measurement,
    ) -> core::result::Result<(), Fault> {
        let wheels = self.wheels.len();
        let wheel = self
            .wheels
            .get_mut(index)
            .ok_or(Fault::UnknownWheel { index, wheels })?;
        wheel.track.take(time_ns, measurement)?;
        let Some((rim, from_ns)) = wheel.window(time_ns, self.settings.wheel_window) else {
            return Ok(());
        };
        self.take_rim(index, rim, from_ns, time_ns);
        Ok(())
    }

    /// The robot's mean speed along `row` from `from_ns` to `to_ns` by the filter itself: what it is now, less what was
    /// felt of its change since. Past estimates would bring back what the measurements since have put right.
    fn mean_along(&self, row: [f64; 3], from_ns: i64, to_ns: i64) -> f64 {
        let mut mean = [FORWARD, LEFT, YAW].map(|i| self.state.mean(i));
        let window = seconds_between(from_ns, to_ns);
        let middle = to_ns.saturating_sub(nanoseconds(0.5 * window));
        if let Some(then) = self.path.at(middle) {
            mean[0] -= self.totals[0] - then[0];
            mean[1] -= self.totals[1] - then[1];
        }
        if let Some([_, _, turned]) = self.path.between(from_ns, to_ns)
            && window > 0.0
        {
            mean[2] += turned / window - self.turning;
        }
        crate::body::dot(row, mean)
    }

    fn take_rim(&mut self, index: usize, rim: Measured, from_ns: i64, to_ns: i64) {
        let Tracked { row, free, .. } = self.wheels[index];
        let forward = self.mean_along(row, from_ns, to_ns);
        let grown = self.state.mean(radius(index));
        let u = rim.value * (1.0 + grown);
        let slip = self.slip_mean(index);
        // the branch goes by the slip, not by which of two noisy speeds happens to be greater, unless they leave no doubt
        let excess = forward.abs() - u.abs();
        let doubt = 3.0 * (self.state.sigma(FORWARD) + rim.sigma());
        let braking = !free && (excess > doubt || (slip < 0.0 && excess > -doubt));
        let faster = if braking { forward } else { u };
        // what the rim has beyond the robot, as a share of the faster of the two
        let by_speed = if braking {
            1.0 + slip.clamp(-1.0, 0.0)
        } else {
            1.0
        };
        // near standstill a slip is no number
        let shows = faster.abs() > self.settings.low_speed;
        // The slope by the slip comes from the readings before: that of this one would share its error, and its square
        // would draw the slip upwards reading by reading.
        let usual = if braking {
            forward
        } else {
            self.wheels[index].usual_rim()
        };
        self.wheels[index].remember(u);
        let mut slopes = [(FORWARD, 0.0); 8];
        slopes[..3].copy_from_slice(&along(row.map(|part| by_speed * part)));
        slopes[3] = (COMMON_SLIP, if free { 0.0 } else { usual });
        slopes[4] = (own_slip(index), usual);
        slopes[5] = (radius(index), -rim.value);
        // the mean over the window, where the robot's speed has wandered since
        let walk = self.walk();
        let wandered = walk * walk * seconds_between(from_ns, to_ns) / 3.0;
        let window = seconds_between(from_ns, to_ns);
        let (odd, begun) = self.remainders(index);
        slopes[6] = (remainder(index, odd), -1.0 / window);
        slopes[7] = (remainder(index, !odd), 1.0 / window);
        let remainders = self.state.mean(remainder(index, !odd)) / window;
        let tick = self.wheels[index].tick;
        let counted = begun * tick * tick / 6.0 / (window * window);
        let seen = Scalar {
            slopes: &slopes,
            residual: u - forward - slip * faster - remainders,
            variance: (rim.variance - counted).max(0.0) + wandered + CREEP * CREEP,
        };
        if free {
            // Nor a free wheel's skid from the robot's speed, unless something else tells that.
            let told = self.reference.accepted_ns;
            let alone = told.is_none_or(|then| seconds_between(then, to_ns) > ALONE);
            self.state.consider(own_slip(index), alone);
        }
        let (residual, variance) = self.state.innovation(&seen);
        self.wheels[index].remainder = Some(odd);
        let off = residual.abs() > self.settings.gate * Real::sqrt(variance);
        let still = self.wheels[index].stillness(to_ns) >= WRONG;
        let against = rim.value * forward < 0.0
            && forward.abs() > 3.0 * self.state.sigma(FORWARD) + self.settings.low_speed
            && rim.value.abs() > self.settings.low_speed;
        let wheel = &mut self.wheels[index];
        if against {
            wheel.against_since_ns.get_or_insert(to_ns);
        } else {
            wheel.against_since_ns = None;
        }
        if free {
            // One that failed comes back where it is near what the others say. Where these know the speed only by what is
            // believed of slip, that is far; then its skid stays in doubt for a while.
            let gap = (u - forward).abs() - self.settings.low_speed;
            let near = gap <= RETURNS * faster.abs();
            let possible = gap <= (2.5 * self.settings.slip.sigma).max(RETURNS) * faster.abs();
            let had_failed = wheel.watch.has_failed();
            let agreed = if had_failed { possible } else { !off };
            let believed = wheel.watch.judge(to_ns, agreed, self.settings.failure);
            if had_failed && believed && !near {
                let doubt = 1.5 * SKID_KNOWN * SKID_KNOWN;
                self.state.widen(own_slip(index), doubt, doubt);
            }
            let was_off = core::mem::replace(&mut wheel.was_off, off);
            if off && was_off && shows && rim.value != 0.0 {
                // The robot's speed has changed unfelt, or the wheel skids: from now on both are less certain. That the
                // wheel runs ahead of the robot cannot be: nothing drives it.
                self.state.widen(FORWARD, residual * residual, 1e4);
                if residual * u < 0.0 {
                    let step = residual / faster;
                    self.state.widen(own_slip(index), step * step, step * step);
                }
            }
            self.learn_felt(residual, variance);
            if !agreed || !believed {
                return;
            }
            if self.state.sigma(own_slip(index)) < SKID_KNOWN {
                self.reference_ns = Some(to_ns);
            }
        } else if against || (still && off) {
            return;
        } else if shows {
            if off && !core::mem::replace(&mut self.wheels[index].was_off, true) {
                // once may be the play of its gears
                return;
            }
            let expected = Real::sqrt(variance);
            let r = (residual / expected).clamp(-BREAKS, BREAKS);
            self.pull += TOGETHER * (r - self.pull);
            // sigmas that fit what is seen: residuals larger than they should be are slips that wander more
            let learnt = Real::exp(LEARNING * (r * r - 1.0));
            let unrest = &mut self.wheels[index].unrest;
            *unrest = (*unrest * learnt).clamp(UNREST.0, UNREST.1);
            let step = residual / faster;
            if self.pull.abs() > PULLED {
                // they break away together: the ground is another one
                self.state.widen(COMMON_SLIP, step * step, 4.0);
            }
            if off {
                // It has broken away: its own slip is another one, and its rim says nothing of the robot's speed.
                let own = self.state.mean(own_slip(index)) + step;
                let spread = 2.0 * self.settings.wheel_slip_sigma;
                self.state
                    .restart(own_slip(index), own.clamp(-2.0, 2.0), spread * spread);
                self.nis = residual * residual / variance;
                return;
            }
            self.wheels[index].was_off = false;
        }
        self.nis = self.state.take(&seen);
        let held = self.state.mean(own_slip(index)).clamp(-2.0, 2.0);
        self.state.set_mean(own_slip(index), held);
    }

    /// The counter shows whole ticks: what it does not show at a window's end it shows in the next. Gives which remainder
    /// is the new one, and 1 where remainders stand for the ticks' share of the variance, else 0.
    fn remainders(&mut self, index: usize) -> (bool, f64) {
        let wheel = &self.wheels[index];
        let tick = if wheel.track.counts() {
            wheel.tick
        } else {
            0.0
        };
        let variance = tick * tick / 12.0;
        let odd = wheel.remainder.is_some_and(|last| !last);
        if wheel.remainder.is_none() {
            self.state.restart(remainder(index, !odd), 0.0, variance);
        }
        self.state.restart(remainder(index, odd), 0.0, variance);
        (odd, f64::from(u8::from(tick > 0.0)))
    }

    /// Has no free wheel turned since the robot stood, and does nothing else tell its speed? Then either the robot is stuck
    /// or they are.
    fn is_blocked(&self, now_ns: i64) -> bool {
        let told = self.reference.accepted_ns;
        let alone = told.is_none_or(|then| seconds_between(then, now_ns) > ALONE);
        let mut free = self.wheels.iter().filter(|wheel| wheel.free).peekable();
        alone && free.peek().is_some() && free.all(|wheel| !wheel.has_turned)
    }

    /// Is the accelerometer better than nothing?
    fn feels(&self) -> bool {
        self.settings.accelerometer_noise * Real::sqrt(self.felt_unrest) < self.settings.speed_walk
    }

    /// A filter that has lost its way: the robot would be much faster than the fastest of its wheels. It begins again from
    /// these.
    fn catch_runaway(&mut self, time_ns: i64) {
        let rims = || {
            self.wheels
                .iter()
                .filter_map(|wheel| Some(wheel.rim?.0.value))
        };
        let Some(fastest) = rims().reduce(|a, b| if b.abs() > a.abs() { b } else { a }) else {
            return;
        };
        let speed = self.state.mean(FORWARD);
        let runs = speed.abs() > RUNAWAY.0 * fastest.abs() + RUNAWAY.1;
        if self.runaway.judge(time_ns, !runs, self.settings.failure) {
            return;
        }
        self.runaway = Watch::default();
        self.felt_unrest = FELT_UNREST.1;
        let sigma = 0.5 * fastest.abs() + RUNAWAY.1;
        self.state.restart(FORWARD, fastest, sigma * sigma);
        self.state.restart(
            COMMON_SLIP,
            self.settings.slip.mean,
            self.settings.slip.sigma * self.settings.slip.sigma,
        );
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.watch = Watch::default();
            if wheel.free {
                let SlipPrior { mean, sigma } = self.settings.free_slip.by_rim();
                self.state.restart(own_slip(index), mean, sigma * sigma);
            } else {
                let sigma = self.settings.wheel_slip_sigma;
                self.state.restart(own_slip(index), 0.0, sigma * sigma);
            }
        }
    }

    /// A speed that comes out otherwise than the accelerometer foresaw makes that less certain.
    fn learn_felt(&mut self, residual: f64, variance: f64) {
        let r = (residual / Real::sqrt(variance)).clamp(-BREAKS, BREAKS);
        let learnt = Real::exp(FELT * (r * r - 1.0));
        self.felt_unrest = (self.felt_unrest * learnt).clamp(FELT_UNREST.0, FELT_UNREST.1);
    }

    fn slip_slopes(&self, index: usize) -> [(usize, f64); 2] {
        let common = if self.wheels[index].free { 0.0 } else { 1.0 };
        [(COMMON_SLIP, common), (own_slip(index), 1.0)]
    }

    fn slip_mean(&self, index: usize) -> f64 {
        self.slip_slopes(index)
            .iter()
            .map(|&(i, a)| a * self.state.mean(i))
            .sum()
    }

    fn take_reference(
        &mut self,
        time_ns: i64,
        measurement: &Measurement,
    ) -> core::result::Result<(), Fault> {
        let Some(seen) = self.reference.take(time_ns, measurement, &self.settings)? else {
            return Ok(());
        };
        let moving = seen.speed[0].is_some_and(|v| v != 0.0);
        let frozen = self.reference.is_frozen(&seen, self.settings.failure) && moving;
        let statements = self.statements(&seen, time_ns);
        let mut agreed = !frozen;
        let mut first = None;
        for (slopes, residual, variance) in statements.iter().flatten() {
            let (residual, variance) = self.state.innovation(&Scalar {
                slopes,
                residual: *residual,
                variance: *variance,
            });
            let r = residual / Real::sqrt(variance);
            agreed &= r.abs() <= self.settings.gate;
            first.get_or_insert(r);
        }
        // one side for long is a scale or a delay, though no single reading is far off
        let r = first.unwrap_or(0.0).clamp(-BREAKS, BREAKS);
        self.reference.pull += ONE_SIDE * (r - self.reference.pull);
        agreed &= self.reference.pull.abs() <= ONE_SIDED;
        if self.reference.watch.has_failed()
            && let Some((_, residual, _)) = statements[0]
        {
            // Without it the speed is known so badly that anything would agree.
            let near = RETURNS * self.state.mean(FORWARD).abs() + self.settings.low_speed;
            agreed &= residual.abs() <= near;
        }
        let believed = self
            .reference
            .watch
            .judge(time_ns, agreed, self.settings.failure);
        if !agreed || !believed {
            return Ok(());
        }
        for (slopes, residual, variance) in statements.iter().flatten() {
            self.nis = self.state.take(&Scalar {
                slopes,
                residual: *residual,
                variance: *variance,
            });
        }
        self.reference.accepted_ns = Some(time_ns);
        self.reference_ns = Some(time_ns);
        Ok(())
    }

    /// How the speed wanders between readings, m/s per √s. With nothing but the wheels it goes where they go: a speed that
    /// were slow to change would make slip of every start.
    fn walk(&self) -> f64 {
        let now_ns = self.now_ns.unwrap_or(0);
        let alone = self
            .reference_ns
            .is_none_or(|then| seconds_between(then, now_ns) > ALONE);
        if alone {
            LOOSE * self.settings.speed_walk
        } else if self.heard.is_some() && self.feels() {
            (self.settings.accelerometer_noise * Real::sqrt(self.felt_unrest))
                .min(LOOSE * self.settings.speed_walk)
        } else {
            self.settings.speed_walk
        }
    }

    /// A measured motion as statements about the present: what has changed since is added to its variance.
    fn statements(&self, seen: &Seen, now_ns: i64) -> [Option<Statement>; 3] {
        let age =
            seconds_between(seen.to_ns, now_ns) + 0.5 * seconds_between(seen.from_ns, seen.to_ns);
        let walk = self.walk();
        let since = walk * walk * age;
        let turned = self.settings.yaw_rate_sigma * self.settings.yaw_rate_sigma;
        let variance = seen.sigma * seen.sigma;
        let one = |row: [f64; 3], value: Option<f64>, variance: f64| {
            value.map(|value| {
                let predicted = self.mean_along(row, seen.from_ns, seen.to_ns);
                (along(row), value - predicted, variance)
            })
        };
        [
            one([1.0, 0.0, 0.0], seen.speed[0], variance + since),
            one([0.0, 1.0, 0.0], seen.speed[1], variance + since),
            one([0.0, 0.0, 1.0], seen.turn, 25.0 * variance + turned),
        ]
    }

    /// What can be said of each wheel now.
    fn judge(&mut self, now_ns: i64) {
        for index in 0..self.wheels.len() {
            let estimate = self.judged(index, now_ns);
            let before = self.wheels[index].estimate;
            let good = if estimate.health == Health::Ok {
                Some(now_ns)
            } else {
                before.until_ns
            };
            self.wheels[index].estimate = WheelEstimate {
                until_ns: good,
                ..estimate
            };
            self.estimates[index] = WheelEstimate {
                last_good_age: good.map(|then| seconds_between(then, now_ns)),
                ..estimate
            };
        }
    }

    fn judged(&self, index: usize, now_ns: i64) -> WheelEstimate {
        let wheel = &self.wheels[index];
        let nothing = |health| WheelEstimate {
            health,
            ..WheelEstimate::NOTHING
        };
        let (Some((rim, until_ns)), Some(silence)) = (wheel.rim, wheel.silence(now_ns)) else {
            return WheelEstimate::NOTHING;
        };
        if silence > self.settings.dropout {
            return nothing(Health::Invalid(Invalid::Dropout));
        }
        let slopes = along(wheel.row);
        let forward = Measured {
            value: slopes.iter().map(|&(i, a)| a * self.state.mean(i)).sum(),
            variance: self.state.variance_of(&slopes),
        };
        let measured = MeasuredSlip::from_speeds(forward, rim, &self.limits);
        let slips = self.slip_slopes(index);
        let kept = SlipPrior {
            mean: self.slip_mean(index),
            sigma: Real::sqrt(self.state.variance_of(&slips)),
        };
        let SlipPrior { mean, sigma } = if wheel.free { kept.by_faster() } else { kept };
        let slip = mean.clamp(-1.0, 1.0);
        let shows = measured.slip.is_some();
        let mut estimate = WheelEstimate {
            slip: Slip::new(slip).ok().filter(|_| shows),
            sigma: shows.then_some(sigma),
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(measured.motion),
            health: measured.health,
            until_ns: Some(until_ns),
            last_good_age: None,
        };
        estimate.health = self.health(index, now_ns, &measured, sigma);
        if matches!(estimate.health, Health::Invalid(_)) {
            estimate.slip = None;
            estimate.sigma = None;
        }
        estimate
    }

    fn health(&self, index: usize, now_ns: i64, measured: &MeasuredSlip, sigma: f64) -> Health {
        let wheel = &self.wheels[index];
        let for_long =
            |since: Option<i64>| since.is_some_and(|since| seconds_between(since, now_ns) >= WRONG);
        let moves = measured.motion != Motion::Standstill;
        let stuck = wheel.stillness(now_ns) >= WRONG && moves;
        if stuck || for_long(wheel.against_since_ns) || (wheel.free && wheel.watch.has_failed()) {
            return Health::Invalid(Invalid::Inconsistent);
        }
        if measured.slip.is_none() {
            return measured.health;
        }
        let blocked = self.is_blocked(now_ns) && !wheel.free;
        if blocked || self.contradicted.has_failed() || (moves && wheel.stillness(now_ns) > 0.0) {
            return Health::Degraded(Degraded::Suspect);
        }
        let age = self.reference_ns.map(|then| seconds_between(then, now_ns));
        match age {
            None => Health::Degraded(Degraded::Relative),
            Some(age) if age > self.settings.dropout + LONGEST * self.settings.wheel_window => {
                Health::Degraded(Degraded::ReferenceLost)
            }
            Some(_) if sigma > self.settings.max_sigma => Health::Degraded(Degraded::Quantised),
            Some(_) if wheel.watch.is_suspect() => Health::Degraded(Degraded::ReferenceLost),
            Some(_) => Health::Ok,
        }
    }
}

/// The direction in which a robot whose powered wheels all point one way cannot move.
fn sideways(wheels: &[Tracked]) -> Option<[f64; 3]> {
    let mut powered = wheels.iter().filter(|wheel| !wheel.free);
    let [x, y, _] = powered.next()?.row;
    let parallel = powered.all(|wheel| (x * wheel.row[1] - y * wheel.row[0]).abs() < 0.02);
    parallel.then_some([-y, x, 0.0])
}
