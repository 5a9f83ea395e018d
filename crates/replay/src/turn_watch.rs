//! Compares the turn by the wheels with the turn by the gyro. Where they differ a wheel slips; which one is named where
//! the turns show it.

use grouser_slip::window::WindowBody;
use grouser_slip::{Robot, WheelRole};

/// What wheels and gyro may differ by for other reasons than slip: tyres, ticks, clocks, as a speed between the outermost
/// wheels, m/s.
const SLACK_M_PER_S: f64 = 0.002;
/// They have gone apart when they differ by this way beyond the slack, m: quiet runs of a Kobuki come to 0.003 m.
const APART_M: f64 = 0.004;
/// A wheel is named when it is this much likelier than anything else: 20 to 1.
const NAMED_LOG_ODDS: f64 = 3.0;

/// What turns by wheels and by gyro say together.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnCheck {
    /// When the robot first drove, s from the log's start.
    pub first_motion_s: Option<f64>,
    /// When wheels and gyro had first gone apart, s from the log's start; `None`: never.
    pub alarm_s: Option<f64>,
    /// How often.
    pub alarms: u64,
    /// The wheel that slips, where it is far likelier than every other explanation; an index in the robot's order.
    pub wheel: Option<usize>,
    /// The logarithm of how much likelier the best explanation is than the next.
    pub likelier: f64,
    /// Its slip, if it alone explains the turns; or that of all wheels alike, if that is the best explanation.
    pub slip: Option<f64>,
}

/// The check while it runs, of a robot whose powered wheels all point one way.
#[derive(Clone, Debug)]
pub(crate) struct TurnWatch {
    /// How much of the turn each powered wheel's rim makes, rad/m.
    shares: Vec<f64>,
    /// From the outermost wheel on one side to that on the other, m.
    track: f64,
    least: f64,
    window: f64,
    until_ns: Option<i64>,
    sums: [f64; 2],
    /// Σ e², and of each explanation Σ e x and Σ x²: a slip of each wheel alone, at last of all alike.
    squares: f64,
    fits: Vec<[f64; 2]>,
    windows: f64,
    found: TurnCheck,
}

impl TurnWatch {
    /// `None` for a robot that turns otherwise than by its wheels' sides.
    pub(crate) fn new(robot: &Robot, low_speed: f64, window: f64) -> Option<Self> {
        let powered = |wheel: &&grouser_slip::Wheel| wheel.role == WheelRole::Powered;
        let rows: Vec<_> = robot
            .wheels()
            .iter()
            .filter(powered)
            .map(grouser_slip::Wheel::speed_row)
            .collect();
        let first = rows.first()?;
        let parallel = rows
            .iter()
            .all(|row| (row[0] - first[0]).hypot(row[1] - first[1]) < 0.02);
        let mean = rows.iter().map(|row| row[2]).sum::<f64>() / rows.len() as f64;
        let square: f64 = rows.iter().map(|row| (row[2] - mean).powi(2)).sum();
        if !(parallel && square > 1e-6) {
            return None;
        }
        let arms = rows.iter().map(|row| row[2] - mean);
        let most = arms.clone().fold(f64::NEG_INFINITY, f64::max);
        let least_arm = arms.fold(f64::INFINITY, f64::min);
        let shares = robot.wheels().iter().map(|wheel| {
            if wheel.role == WheelRole::Powered {
                (wheel.speed_row()[2] - mean) / square
            } else {
                0.0
            }
        });
        let shares: Vec<f64> = shares.collect();
        Some(Self {
            fits: vec![[0.0; 2]; shares.len() + 1],
            shares,
            track: most - least_arm,
            least: low_speed,
            window,
            until_ns: None,
            sums: [0.0; 2],
            squares: 0.0,
            windows: 0.0,
            found: TurnCheck {
                first_motion_s: None,
                alarm_s: None,
                alarms: 0,
                wheel: None,
                likelier: 0.0,
                slip: None,
            },
        })
    }

    /// What is known over the window that ended at `body.until_ns`, `time_s` from the log's start; `rim` gives each
    /// wheel's rim speed over it, m/s.
    pub(crate) fn take(&mut self, time_s: f64, body: &WindowBody, rim: impl Fn(usize) -> f64) {
        let (Some(until_ns), Some(gyro)) = (body.until_ns, body.yaw_rate) else {
            return;
        };
        let last_ns = self.until_ns.replace(until_ns).unwrap_or(until_ns);
        let seconds = (until_ns.saturating_sub(last_ns) as f64 * 1e-9).min(self.window);
        if !(seconds > 0.0) {
            return;
        }
        let rims: Vec<f64> = (0..self.shares.len()).map(rim).collect();
        let turns: Vec<f64> = rims.iter().zip(&self.shares).map(|(u, a)| u * a).collect();
        let powered = self.shares.iter().filter(|share| **share != 0.0).count();
        let of_powered = rims
            .iter()
            .zip(&self.shares)
            .filter(|(_, share)| **share != 0.0);
        let speed = of_powered.map(|(rim, _)| rim).sum::<f64>() / powered as f64;
        // a robot that turns on the spot scrubs its wheels
        if !(speed.abs() > self.least) {
            return;
        }
        self.found.first_motion_s.get_or_insert(time_s);
        let turn: f64 = turns.iter().sum();
        let apart = turn - gyro.value;
        for (sum, sign) in self.sums.iter_mut().zip([1.0, -1.0]) {
            *sum = (*sum + (sign * apart * self.track - SLACK_M_PER_S) * seconds).max(0.0);
            if *sum > APART_M {
                *sum = 0.0;
                self.found.alarms += 1;
                self.found.alarm_s.get_or_insert(time_s);
            }
        }
        // the turn that is not there: Σ s_i of each wheel's share
        let weight = seconds / self.window;
        self.windows += weight;
        self.squares += weight * apart * apart;
        for (fit, x) in self.fits.iter_mut().zip(turns.into_iter().chain([turn])) {
            fit[0] += weight * apart * x;
            fit[1] += weight * x * x;
        }
    }

    pub(crate) fn summary(&self) -> TurnCheck {
        let left = |&[product, square]: &[f64; 2]| {
            let explained = if square > 0.0 {
                product * product / square
            } else {
                0.0
            };
            (self.squares - explained).max(1e-12)
        };
        let mut ranked: Vec<(f64, usize)> = self.fits.iter().map(left).zip(0..).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found = self.found.clone();
        if let [best, next, ..] = ranked[..] {
            found.likelier = 0.5 * self.windows * (next.0 / best.0).ln();
            let [product, square] = self.fits[best.1];
            found.slip = (square > 0.0).then(|| product / square);
            let is_wheel = best.1 < self.shares.len();
            let slips = found.slip.is_some_and(|slip| slip > 0.0);
            if found.alarms > 0 && is_wheel && slips && found.likelier > NAMED_LOG_ODDS {
                found.wheel = Some(best.1);
            }
        }
        found
    }
}
