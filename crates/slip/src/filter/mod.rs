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
//! Promises, each with a test of its name (`tests/filter_promises.rs`, `tests/filter_outputs.rs`; long runs in the generator's crate):
//!
//! | | |
//! |---|---|
//! | R1 total | [`SlipFilter::update`] never panics, for any bits |
//! | R2 finite | what it gives is finite, slip in [−1, 1], sigma > 0 |
//! | R3 bounded | no loop depends on the data; a gap of years costs one update |
//! | R4 | it allocates nothing after construction, reads no clock |
//! | R5 deterministic | the same samples give the same bits; within the horizon in any order |
//! | R6 honest | every refusal is counted by its reason; health says what is not to be trusted |
//! | R7 recovers | two seconds after a fault all is as before |
//! | R8 observable | `time_slip`, `dropped`, `rejected`, `last_good_age` in every estimate |
//! | R9 | sigma grows under faults, and is right without them |

mod assume;
mod body;
mod carrier;
mod clocks;
mod free_wheel;
mod imu;
mod kalman;
mod order;
mod pulses;
mod radius;
mod recover;
mod reference;
mod report;
mod rim;
mod settings;
mod told;
mod turn;
mod verdict;
mod watch;
mod wheel;

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;

use crate::error::{Error, Result, check_range};
use crate::fault::{Fault, Rejected};
use crate::history::{History, nanoseconds, seconds_between};
use crate::measured_slip::SlipLimits;
use crate::robot::Robot;
use crate::sample::{Measurement, Sample};
use crate::speed::Measured;
use crate::wheel_estimate::WheelEstimate;
use body::{COMMON_SLIP, FORWARD, GYRO_BIAS, Heard, YAW, own_slip, radius};
use clocks::{Clocks, Told};
use kalman::Kalman;
use order::{Offered, Order};
use reference::Reference;
pub use report::{BodyEstimate, FilterOutput, Odometry, WheelCheck};
pub use settings::{FilterSettings, SlipPrior};
use turn::Turn;
use watch::Watch;
use wheel::Tracked;

/// The most wheels that the filter takes: its cost grows with their square.
pub const MAX_FILTER_WHEELS: usize = 8;
/// Samples that can wait for earlier ones.
const QUEUE: usize = 256;
/// At most this many samples are worked off by one update.
const AT_ONCE: usize = 4;
/// A clock that goes further than this at once has been set, s.
const CLOCK_STEP: f64 = 1.0;
/// A wheel that stands while the robot moves for this long is stuck, or turns against it: its encoder is wrong, s.
const WRONG: f64 = 0.25;
/// Pseudo-measurements come this often, s.
const EVERY: f64 = 0.02;
/// Without a reference for this long the speed follows the wheels, s; how much looser it is then.
const ALONE: f64 = 0.5;
const LOOSE: f64 = 10.0;
/// Wheels whose readings are off to one side by this much, the middle one, in sigma, break away together; how fast that mean
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
/// How fast the accelerometer's unrest is learnt, a reading of a reference, and its limits.
const FELT: f64 = 0.03;
const FELT_UNREST: (f64, f64) = (1.0, 40.0);
/// How fast the mean residual of a camera or its like forgets, a reading, and from where on it is a contradiction, in sigma.
const ONE_SIDE: f64 = 0.3;
const ONE_SIDED: f64 = 2.0;
/// A speed that was seen: slopes, residual, variance.
type Statement = ([(usize, f64); 3], f64, f64);

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
    settings: FilterSettings,
    limits: SlipLimits,
    state: Kalman,
    order: Order,
    wheels: Box<[Tracked]>,
    estimates: Box<[WheelEstimate]>,
    side_slip_angles: Box<[Option<Measured>]>,
    checks: Box<[WheelCheck]>,
    checked_ns: Option<i64>,
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
    clocks: Clocks,
    /// The robot or its free wheels are stuck; references contradict each other.
    blocked: bool,
    disputed: bool,
    /// How much of a reading's residual enters its wheel's mean, 1.
    sharing: f64,
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
        let powered = wheels.iter().filter(|wheel| !wheel.free).count();
        let longest = settings.reference_latency + settings.horizon + CLOCK_STEP;
        let mut filter = Self {
            limits: SlipLimits {
                standstill_speed: settings.standstill_speed,
                low_speed: settings.low_speed,
                max_sigma: settings.max_sigma,
            },
            state: Kalman::new(body::size(count)),
            order: Order::new(QUEUE, nanoseconds(settings.horizon)),
            estimates: alloc::vec![WheelEstimate::NOTHING; count].into_boxed_slice(),
            side_slip_angles: alloc::vec![None; count].into_boxed_slice(),
            checks: alloc::vec![WheelCheck::default(); count].into_boxed_slice(),
            checked_ns: None,
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
            clocks: Clocks::new(count),
            blocked: false,
            disputed: false,
            sharing: 1.0 - Real::powi(1.0 - TOGETHER, i32::try_from(powered).unwrap_or(1)),
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
    pub fn update(&mut self, sample: Sample) -> core::result::Result<FilterOutput<'_>, Fault> {
        let taken = self.accept(sample);
        if let Err(fault) = &taken {
            self.rejected.count(fault);
        }
        taken.map(|()| self.latest())
    }

    /// What can be said of the wheels if it is `now_ns` and no sample has come since: silence is a fault too.
    pub fn estimate_at(&mut self, now_ns: i64) -> FilterOutput<'_> {
        self.judge(now_ns);
        self.latest()
    }

    /// The soil has another slip demand than was believed: the prior of the powered wheels' common slip.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a mean outside [−1, 1] or a sigma outside [1e-6, 2].
    pub fn set_slip_prior(&mut self, slip: SlipPrior) -> Result<()> {
        let settings = FilterSettings {
            slip,
            ..self.settings
        };
        settings.check()?;
        self.settings = settings;
        Ok(())
    }

    /// Sets the steering angle of a wheel (rad, to the left, beside its heading in the description).
    ///
    /// # Errors
    /// [`Error::UnknownWheel`] for a wheel that the robot does not have, [`Error::OutOfRange`] for an angle outside
    /// [−7, 7] rad.
    pub fn set_steering_angle(&mut self, wheel: usize, angle: f64) -> Result<()> {
        let wheels = self.wheels.len();
        let tracked = self.wheels.get_mut(wheel).ok_or(Error::UnknownWheel {
            index: wheel,
            wheels,
        })?;
        check_range("steering", "angle", angle, (-7.0, 7.0), "rad")?;
        tracked.steer(angle);
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
        let (newest, used) = (self.order.newest_ns(), self.order.released_ns());
        if self.clocks.take(&sample, newest, used)? == Told::Set {
            self.restart_clock();
        }
        let mut outcome = Ok(());
        if self.order.is_full()
            && let Some(oldest) = self.order.release(true)
        {
            outcome = self.work_off(oldest);
        }
        if self.order.offer(sample) == Offered::TooLate {
            return Err(Fault::NotLater {
                time_ns: sample.time_ns,
                last_ns: self.now_ns.unwrap_or(sample.time_ns),
            });
        }
        if let Some(wheel) = wheel_of(&sample.measurement) {
            self.wheels[wheel].waiting += 1;
        }
        for _ in 0..AT_ONCE {
            let Some(next) = self.order.release(false) else {
                break;
            };
            outcome = outcome.and(self.work_off(next));
        }
        outcome
    }

    /// Time begins anew. What was learnt of sensors outlasts it, what was known of the motion does not.
    fn restart_clock(&mut self) {
        self.order.clear();
        self.path.clear();
        self.now_ns = None;
        self.held_ns = None;
        self.checked_ns = None;
        self.heard = None;
        self.gyro_ns = None;
        self.gyro_same = None;
        self.turned_ns = None;
        self.reference_ns = None;
        self.reference = Reference::default();
        for wheel in &mut self.wheels {
            wheel.restart_clock();
        }
        let bias = self.state.mean(GYRO_BIAS);
        let [apart, turned] =
            [FORWARD, YAW].map(|i| (self.state.mean(i).abs() + self.state.sigma(i)) * CLOCK_STEP);
        body::restart_place(&mut self.state, apart, turned);
        self.start();
        self.state.set_mean(GYRO_BIAS, bias);
    }

    fn work_off(&mut self, sample: Sample) -> core::result::Result<(), Fault> {
        let time_ns = sample.time_ns;
        if let Some(wheel) = wheel_of(&sample.measurement) {
            let waiting = &mut self.wheels[wheel].waiting;
            *waiting = waiting.saturating_sub(1);
        }
        let moves_on = self.now_ns != Some(time_ns);
        self.advance(time_ns);
        let taken = match sample.measurement {
            Measurement::WheelCount { wheel, .. }
            | Measurement::WheelEdge { wheel, .. }
            | Measurement::WheelAngle { wheel, .. }
            | Measurement::WheelRate { wheel, .. } => {
                self.take_wheel(time_ns, wheel, &sample.measurement)
            }
            Measurement::WheelTorque { wheel, torque } => self.take_torque(time_ns, wheel, torque),
            Measurement::Carrier {
                wheel,
                turn,
                forward,
                up,
            } => {
                let wheels = self.wheels.len();
                self.wheels
                    .get_mut(wheel)
                    .ok_or(Fault::UnknownWheel {
                        index: wheel,
                        wheels,
                    })
                    .and_then(|wheel| wheel.carrier.take(time_ns, [turn, forward, up]))
            }
            Measurement::YawRate { rate } => self.take_yaw_rate(time_ns, rate),
            Measurement::Acceleration { forward, left } => {
                self.take_acceleration(time_ns, [forward, left])
            }
            Measurement::Displacement { .. }
            | Measurement::Pose { .. }
            | Measurement::Speed { .. } => self.take_reference(time_ns, &sample.measurement),
            Measurement::Command { .. } => Ok(()),
        };
        // most readings of a moment change nothing that is said: a wheel's only when its window ends, or when it comes back
        let says_more = match sample.measurement {
            Measurement::Acceleration { .. }
            | Measurement::WheelTorque { .. }
            | Measurement::Command { .. } => false,
            _ => wheel_of(&sample.measurement)
                .and_then(|wheel| self.wheels.get(wheel))
                .is_none_or(|wheel| wheel.has_news(time_ns)),
        };
        if moves_on || says_more {
            self.judge(time_ns);
        }
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
            self.distances[1] += self.speed_of_wheels(time_ns) * dt;
        }
        self.path.push(time_ns, self.totals);
        let due = self
            .held_ns
            .is_none_or(|held| seconds_between(held, time_ns) >= EVERY);
        if due {
            self.held_ns = Some(time_ns);
            self.assume(time_ns);
            self.catch_runaway(time_ns);
            self.check_wheels(time_ns);
            self.state.tidy();
        }
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
        tracked.radius.push(torque);
        Ok(())
    }
}

/// The wheel whose rotation a measurement tells of.
const fn wheel_of(measurement: &Measurement) -> Option<usize> {
    match *measurement {
        Measurement::WheelCount { wheel, .. }
        | Measurement::WheelEdge { wheel, .. }
        | Measurement::WheelAngle { wheel, .. }
        | Measurement::WheelRate { wheel, .. } => Some(wheel),
        _ => None,
    }
}

/// The direction in which a robot whose powered wheels all point one way cannot move.
fn sideways(wheels: &[Tracked]) -> Option<[f64; 3]> {
    let mut powered = wheels.iter().filter(|wheel| !wheel.free);
    let [x, y, _] = powered.next()?.row;
    let parallel = powered.all(|wheel| (x * wheel.row[1] - y * wheel.row[0]).abs() < 0.02);
    parallel.then_some([-y, x, 0.0])
}
