//! All wheels of the filter, and what they show together.

use alloc::boxed::Box;

use grouser_real::Real;

use super::MAX_FILTER_WHEELS;
use super::kalman::Kalman;
use super::motion_model::own_slip;
use super::settings::FilterSettings;
use super::turn_agreement::UNIT_FACTOR;
use super::wheel_channel::WheelChannel;
use crate::body::Observations;
use crate::fault::Fault;
use crate::robot::Robot;
use crate::speed::Measured;

/// Wheels whose headings differ by less than this drive one way: the sine of the angle.
const PARALLEL_SINE: f64 = 0.02;
/// Wheels whose squared distances from the robot's middle add up to less show no yaw rate, m².
const MIN_SQUARED_ARMS_M2: f64 = 1e-6;
/// Steered wheels whose squared distances along the way from their mean add up to less show no yaw rate, m².
const MIN_SQUARED_STEERED_ARMS_M2: f64 = 1e-3;
/// Standard deviation of a side slip of steered wheels, as a share of the robot's speed: three degrees.
const SIDE_SLIP_SHARE: f64 = 0.05;
/// Standard deviation of the speed that a steered turn is of, m/s: small, since it is given.
const SPEED_SIGMA_M_PER_S: f64 = 1e-3;
/// Share of their turn by which wheels that skid sideways turn faster than the robot: a half where its effective track is twice the
/// described one.
const SKID_SHARE: f64 = 0.5;
/// Share of a rim's speed by which ground is faster or slower than a rim that a turn forces: beyond what wrong radii and rolling wheels
/// make.
const FORCED_SHARE: f64 = 1.0 / 3.0;
/// A wheel slips unlike the others where its own slip is beyond this many sigma of its prior.
const UNLIKE_SIGMA: f64 = 3.0;
/// Weight of one wheel's innovation in its mean, where it is the only powered one.
const MEAN_INNOVATION_WEIGHT: f64 = 0.2;
/// The common slip has changed when the median of the wheels' mean innovations is beyond this, in sigma.
const COMMON_CHANGE_SIGMA: f64 = 0.7;
/// Mean innovations beyond this are no noise, which gives them a standard deviation of 0.65 with four powered wheels, in sigma.
const OPPOSED_SIGMA: f64 = 1.3;
/// Standard deviation of the robot's speed by one rim where slip is not compensated, m/s.
const RIM_SIGMA_M_PER_S: f64 = 0.01;
/// How far that robot may drift sideways (m/s) and turn (rad/s) where its wheels do not show it.
const DRIFT_SIGMA_M_PER_S: f64 = 0.1;
const TURN_SIGMA_RAD_PER_S: f64 = 10.0;

/// The wheels in the robot's order.
#[derive(Clone, Debug)]
pub(super) struct WheelBank {
    pub(super) channels: Box<[WheelChannel]>,
    /// The direction in which a robot whose powered wheels all point one way cannot move, as a row of its speed; where all of them
    /// are steered, that of their mean sideways speed, as they stand now.
    pub(super) lateral: Option<[f64; 3]>,
    /// Weight of an innovation in its wheel's mean.
    pub(super) mean_weight: f64,
}

impl WheelBank {
    pub(super) fn new(robot: &Robot, settings: &FilterSettings) -> Self {
        let channels: Box<[_]> = WheelChannel::all(robot, settings).collect();
        let powered = channels.iter().filter(|wheel| !wheel.free).count();
        Self {
            lateral: lateral(&channels),
            mean_weight: 1.0
                - Real::powi(
                    1.0 - MEAN_INNOVATION_WEIGHT,
                    i32::try_from(powered).unwrap_or(1),
                ),
            channels,
        }
    }

    pub(super) fn get_mut(&mut self, index: usize) -> Result<&mut WheelChannel, Fault> {
        let wheels = self.channels.len();
        self.channels
            .get_mut(index)
            .ok_or(Fault::UnknownWheel { index, wheels })
    }

    /// Steers a wheel, rad.
    pub(super) fn steer(&mut self, index: usize, angle: f64) -> Result<(), Fault> {
        if !self.get_mut(index)?.steer(angle) {
            return Ok(());
        }
        let turned = |wheel: &WheelChannel| wheel.steering.has_turned();
        if self.lateral.is_some() && self.powered().any(turned) {
            // those that are not steered, where there are any, move along themselves
            let all_turned = self.powered().all(turned);
            let (mut sums, mut count) = ([0.0; 3], 0.0);
            for wheel in self.powered() {
                if all_turned || !wheel.steering.is_used() {
                    for (sum, part) in sums.iter_mut().zip(wheel.steering.across()) {
                        *sum += part;
                    }
                    count += 1.0;
                }
            }
            if count > 0.0 {
                self.lateral = Some(sums.map(|sum| sum / count));
            }
        }
        Ok(())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &WheelChannel> {
        self.channels.iter()
    }

    pub(super) fn powered(&self) -> impl Iterator<Item = &WheelChannel> {
        self.iter().filter(|wheel| !wheel.free)
    }

    pub(super) fn free(&self) -> impl Iterator<Item = &WheelChannel> {
        self.iter().filter(|wheel| wheel.free)
    }

    /// Have wheels been read at `now_ns`, and with them each that was read together with one of them before?
    pub(super) fn is_whole_row(&self, now_ns: i64) -> bool {
        let read = |wheel: &&WheelChannel| wheel.track.newest_time() == Some(now_ns);
        let is_awaited = |other: &WheelChannel| {
            let last = other.track.newest_time();
            last.is_some_and(|last| last != now_ns)
                && self
                    .iter()
                    .filter(read)
                    .any(|wheel| Some(wheel.read_before_ns) == last)
        };
        self.iter().any(|wheel| read(&wheel)) && !self.iter().any(is_awaited)
    }

    /// Do wheels measure ways? A rate says no more of the way until now than the rate before, and nothing waits for it.
    pub(super) fn measure_ways(&self) -> bool {
        self.iter().any(|wheel| wheel.track.measures_way())
    }

    pub(super) fn any_turns(&self) -> bool {
        self.iter().any(WheelChannel::turns)
    }

    /// The yaw rate that the powered wheels would give without slip, where all point one way. A wheel that turns against the
    /// robot's travel has a wrong encoder.
    pub(super) fn yaw_rate(&self) -> Option<f64> {
        self.turn_by_wheels(|wheel| wheel.against_since_ns.is_none())
    }

    /// Least squares over the rims of the powered wheels for which `is_used` holds.
    fn turn_by_wheels(&self, is_used: impl Fn(&WheelChannel) -> bool) -> Option<f64> {
        self.lateral?;
        let used = || self.powered().filter(|wheel| is_used(wheel));
        let count = used().count() as f64;
        let (mut rims, mut arms) = (0.0, 0.0);
        for wheel in used() {
            rims += wheel.rim?.0.value;
            arms += wheel.row[2];
        }
        let (mut product, mut square) = (0.0, 0.0);
        for wheel in used() {
            let arm = wheel.row[2] - arms / count;
            product += arm * (wheel.rim?.0.value - rims / count);
            square += arm * arm;
        }
        (square > MIN_SQUARED_ARMS_M2).then(|| product / square)
    }

    /// Would the wheels of one side be dragged over the ground by a third of their rims' speed, and those of the other held back by as
    /// much, if the robot travelled at `speed` (m/s) and turned at `turn` (rad/s), many times what their rims turn it? Nothing on the
    /// robot turns it so: where one side slips, the other rolls. Rims slower than `low_speed` (m/s) show nothing.
    pub(super) fn are_forced(&self, (speed, turn): (f64, f64), low_speed: f64) -> bool {
        let by_wheels = self.turn_by_wheels(|_| true);
        if by_wheels.is_none_or(|by_wheels| turn.abs() <= UNIT_FACTOR * by_wheels.abs()) {
            return false;
        }
        let (mut dragged, mut held_back) = (false, false);
        for wheel in self.powered() {
            let rim = wheel.rim.map_or(0.0, |(rim, _)| rim.value);
            if rim.abs() > low_speed {
                let excess = (wheel.row[0] * speed + wheel.row[2] * turn) / rim - 1.0;
                dragged |= excess > FORCED_SHARE;
                held_back |= excess < -FORCED_SHARE;
            }
        }
        dragged && held_back
    }

    /// The yaw rate at which a robot that travels at `speed` (m/s) moves least across its powered wheels as they are steered now,
    /// and its standard deviation, rad/s: slip does not change it. `None` where no wheel has been steered, or none stands off the
    /// others along the way.
    pub(super) fn steered_turn(&self, speed: f64, settings: &FilterSettings) -> Option<Measured> {
        if !self.powered().any(|wheel| wheel.steering.has_turned()) {
            return None;
        }
        let mut seen = Observations::default();
        let along = Measured {
            value: speed,
            variance: SPEED_SIGMA_M_PER_S * SPEED_SIGMA_M_PER_S,
        };
        seen.add([1.0, 0.0, 0.0], along);
        let sigma = Real::hypot(settings.lateral_sigma, SIDE_SLIP_SHARE * speed);
        for wheel in self.powered() {
            let across = Measured {
                value: 0.0,
                variance: sigma * sigma,
            };
            seen.add(wheel.steering.across(), across);
        }
        let motion = seen.solve()?;
        let arms = || self.powered().map(|wheel| wheel.steering.across()[2]);
        let count = arms().count() as f64;
        let mean = arms().sum::<f64>() / count;
        let square: f64 = arms().map(|arm| (arm - mean) * (arm - mean)).sum();
        (square > MIN_SQUARED_STEERED_ARMS_M2).then(|| Measured {
            value: motion.velocity[2],
            variance: sigma * sigma / square,
        })
    }

    /// Standard deviation of the error of a turn by the powered wheels, rad/s: they slip unlike, and skid sideways in a bend.
    pub(super) fn turn_sigma(&self, turn: f64, settings: &FilterSettings) -> f64 {
        let (mut sum, mut square) = (0.0, 0.0);
        for wheel in self.powered() {
            let arm = wheel.row[2];
            let unlike =
                arm * wheel.rim.map_or(0.0, |(rim, _)| rim.value) * settings.wheel_slip_sigma;
            sum += unlike * unlike;
            square += arm * arm;
        }
        let unlike = sum / (square * square).max(MIN_SQUARED_ARMS_M2 * MIN_SQUARED_ARMS_M2);
        let skid = SKID_SHARE * turn;
        Real::sqrt(unlike + skid * skid)
    }

    /// Standard deviation of the yaw rate by the powered wheels, as far as each slips unlike the others, rad/s.
    pub(super) fn yaw_rate_sigma(&self, state: &Kalman) -> f64 {
        let (mut sum, mut square) = (0.0, 0.0);
        for (i, wheel) in self.iter().enumerate().filter(|(_, wheel)| !wheel.free) {
            let arm = wheel.row[2];
            let unlike =
                arm * wheel.rim.map_or(0.0, |(rim, _)| rim.value) * state.mean(own_slip(i));
            sum += unlike * unlike;
            square += arm * arm;
        }
        if square > MIN_SQUARED_ARMS_M2 {
            Real::sqrt(sum) / square
        } else {
            0.0
        }
    }

    /// Do the powered wheels slip alike, as far as their prior has it? A wheel in the air, or one that has broken away, looks
    /// like a turn of the robot.
    pub(super) fn slip_alike(&self, state: &Kalman, settings: &FilterSettings) -> bool {
        let limit = UNLIKE_SIGMA * settings.wheel_slip_sigma;
        self.iter()
            .enumerate()
            .all(|(i, wheel)| wheel.free || state.mean(own_slip(i)).abs() <= limit)
    }

    /// The robot's speed forwards if its powered wheels did not slip, m/s: least squares over those that are received.
    pub(super) fn forward_speed(&self, now_ns: i64, dropout_s: f64) -> f64 {
        let of = |value: f64, sigma: f64| Measured {
            value,
            variance: sigma * sigma,
        };
        let mut seen = Observations::default();
        seen.add([0.0, 1.0, 0.0], of(0.0, DRIFT_SIGMA_M_PER_S));
        seen.add([0.0, 0.0, 1.0], of(0.0, TURN_SIGMA_RAD_PER_S));
        for wheel in self
            .powered()
            .filter(|wheel| wheel.is_received(now_ns, dropout_s))
        {
            if let Some((rim, _)) = wheel.rim {
                seen.add(wheel.row, of(rim.value, RIM_SIGMA_M_PER_S));
            }
        }
        seen.solve().map_or(0.0, |motion| motion.velocity[0])
    }

    /// The powered wheels' mean rim speed, m/s; `None` where none is received.
    pub(super) fn mean_powered_rim(&self, now_ns: i64, dropout_s: f64) -> Option<f64> {
        let rims = || {
            self.powered().filter_map(move |wheel| {
                wheel
                    .is_received(now_ns, dropout_s)
                    .then_some(wheel.rim?.0.value)
            })
        };
        let count = rims().count();
        (count > 0).then(|| rims().sum::<f64>() / count as f64)
    }

    /// How much the speeds of most powered rims change, as a process noise density, m/s per √s: so may the robot's. The median
    /// is neither a wheel that breaks away nor a turn.
    pub(super) fn pace(&self, now_ns: i64, dropout_s: f64) -> f64 {
        let paces = self
            .powered()
            .filter(|wheel| wheel.is_received(now_ns, dropout_s))
            .map(WheelChannel::pace);
        median(paces).map_or(0.0, f64::abs)
    }

    /// The rim that runs fastest, m/s.
    pub(super) fn fastest_rim(&self) -> Option<f64> {
        let rims = self.iter().filter_map(|wheel| Some(wheel.rim?.0.value));
        rims.reduce(|a, b| if b.abs() > a.abs() { b } else { a })
    }

    /// Are most powered wheels off to one side, and the median by much? One wheel alone, however far off, is its own slip.
    pub(super) fn slips_change_together(&self) -> bool {
        let means = || self.powered().map(|wheel| wheel.mean_innovation);
        let Some(median) = median(means()) else {
            return false;
        };
        let same_side =
            means().filter(|mean| *mean * median > 0.5 * COMMON_CHANGE_SIGMA * median.abs());
        median.abs() > COMMON_CHANGE_SIGMA && 2 * same_side.count() > means().count()
    }

    /// Do the powered wheels' mean innovations oppose that of the free wheel at `free`: half of them by much, or all of them?
    /// Then the common slip has changed: an error of the robot's speed has one sign in all of them.
    pub(super) fn slips_oppose(&self, free: usize) -> bool {
        let mean = self.channels[free].mean_innovation;
        let opposed = |limit: f64| {
            let off = |wheel: &&WheelChannel| -mean.signum() * wheel.mean_innovation > limit;
            self.powered().filter(off).count()
        };
        let count = self.powered().count();
        mean.abs() > OPPOSED_SIGMA
            && count > 0
            && (opposed(0.0) == count || 2 * opposed(OPPOSED_SIGMA) >= count)
    }

    /// The median of the shares of pulses that the other counters seem to miss: the effect of rough ground or a jittering
    /// clock.
    pub(super) fn usual_missed_share(&self, index: usize) -> f64 {
        let mut shares = [0.0; MAX_FILTER_WHEELS];
        let mut count = 0;
        for (i, wheel) in self.iter().enumerate() {
            if let Some(share) = wheel.pulses.share().filter(|_| i != index) {
                shares[count] = share;
                count += 1;
            }
        }
        let shares = &mut shares[..count];
        shares.sort_unstable_by(f64::total_cmp);
        shares.get(count / 2).copied().unwrap_or(0.0)
    }
}

fn lateral(channels: &[WheelChannel]) -> Option<[f64; 3]> {
    let mut powered = channels.iter().filter(|wheel| !wheel.free);
    let [x, y, _] = powered.next()?.row;
    let parallel = powered.all(|wheel| (x * wheel.row[1] - y * wheel.row[0]).abs() < PARALLEL_SINE);
    parallel.then_some([-y, x, 0.0])
}

/// The median of one number per wheel.
pub(super) fn median(of_wheels: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted = [0.0; MAX_FILTER_WHEELS];
    let mut count = 0;
    for (slot, value) in sorted.iter_mut().zip(of_wheels) {
        *slot = value;
        count += 1;
    }
    let sorted = &mut sorted[..count];
    sorted.sort_unstable_by(f64::total_cmp);
    Some(0.5 * (sorted.get(count / 2)? + sorted[count.div_ceil(2) - 1]))
}

#[cfg(test)]
mod tests;
