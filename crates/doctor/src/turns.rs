//! Compares the turn by the wheels with the turn by the gyro. Where they differ a wheel slips; which one is named where
//! the turns show it.

use grouser_real::Real;
use grouser_slip::{Measured, Robot};

use crate::turning::parallel_arms;
use crate::window::Window;

/// What wheels and gyro may differ by for other reasons than slip: tyres, ticks, clocks, as a speed between the outermost
/// wheels, m/s.
const SLACK_M_PER_S: f64 = 0.002;
/// They have gone apart when they differ by this way beyond the slack, m: quiet runs of a Kobuki come to 0.003 m.
const APART_M: f64 = 0.004;
/// Track and radii are described within this share, one standard deviation: what it explains is geometry and no slip.
const GEOMETRY_SIGMA: f64 = 0.02;
/// A larger error of track or radii is no error of a description, but slip.
const MAX_GEOMETRY: f64 = 0.05;
/// A difference within this many standard deviations of the geometry raises no alarm.
const GEOMETRY_BAND_SIGMA: f64 = 2.0;
/// A wheel is named when it is this much likelier than anything else: 20 to 1.
const NAMED_LOG_ODDS: f64 = 3.0;

/// What turns by wheels and by gyro say together.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TurnCheck {
    /// When the robot first drove, s from the log's start.
    pub first_motion_s: Option<f64>,
    /// When wheels and gyro had first gone apart, s from the log's start; `None`: never.
    pub alarm_s: Option<f64>,
    /// How often.
    pub alarms: u64,
    /// How often beyond what an error of track or radii explains.
    pub alarms_beyond_geometry: u64,
    /// The wheel that slips, where it is far likelier than every other explanation; an index in the robot's order.
    pub wheel: Option<usize>,
    /// The logarithm of how much likelier the best explanation is than the next.
    pub likelier: f64,
    /// The error of the geometry, as far as the turns show it: the share by which the track is described too small, and
    /// the one by which the right radii are described too large against the left ones.
    pub geometry: [Measured; 2],
    /// Its slip, if it alone explains the turns; or that of all wheels alike, if that is the best explanation.
    pub slip: Option<f64>,
}

/// The check while it runs, of a robot whose powered wheels all point one way.
#[derive(Clone, Debug, Default)]
pub(crate) struct TurnWatch {
    /// How much of the turn each powered wheel's rim makes, rad/m.
    shares: Vec<f64>,
    /// From the outermost wheel on one side to that on the other, m.
    track: f64,
    least: f64,
    sums: [f64; 2],
    sums_beyond: [f64; 2],
    /// Σ e², and of each explanation Σ e x and Σ x²: a slip of each wheel alone, at last of all alike.
    squares: f64,
    fits: Vec<[f64; 2]>,
    windows: f64,
    geometry: Geometry,
    found: TurnCheck,
}

impl TurnWatch {
    /// `None` for a robot that turns otherwise than by its wheels' sides.
    pub(crate) fn new(robot: &Robot, low_speed: f64) -> Option<Self> {
        let arms = parallel_arms(robot)?;
        let square: f64 = arms.iter().map(|(_, arm)| arm * arm).sum();
        if !(square > 1e-6) {
            return None;
        }
        let (mut most, mut least_arm) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut shares = vec![0.0; robot.wheels().len()];
        for (wheel, arm) in arms {
            (most, least_arm) = (most.max(arm), least_arm.min(arm));
            shares[wheel] = arm / square;
        }
        Some(Self {
            fits: vec![[0.0; 2]; shares.len() + 1],
            shares,
            track: most - least_arm,
            least: low_speed,
            ..Self::default()
        })
    }

    /// What is known over a window that ended `time_s` from the log's start.
    pub(crate) fn take(&mut self, time_s: f64, window: &Window) {
        let (seconds, yaw_rate) = (window.seconds, window.yaw_rate());
        if yaw_rate.is_nan() {
            return;
        }
        // a wheel that is not measured is one at rest
        let rim = |speed: f64| if speed.is_nan() { 0.0 } else { speed };
        let rims = window.speeds().map(rim).zip(&self.shares);
        let turns = rims.clone().map(|(rim, share)| rim * share);
        let powered = self.shares.iter().filter(|share| **share != 0.0).count();
        let of_powered = rims.filter(|(_, share)| **share != 0.0);
        let speed = of_powered.map(|(rim, _)| rim).sum::<f64>() / powered as f64;
        // a robot that turns on the spot scrubs its wheels
        if !(speed.abs() > self.least) {
            return;
        }
        self.found.first_motion_s.get_or_insert(time_s);
        let turn: f64 = turns.clone().sum();
        let all = turn - yaw_rate;
        // Errors of track and radii are constant shares of turn and speed; slip is the difference beyond them.
        let noise = SLACK_M_PER_S / self.track;
        let row = [turn, speed / self.track];
        let (apart, doubt) = self.geometry.update(row, all, noise);
        let slack = SLACK_M_PER_S + GEOMETRY_BAND_SIGMA * doubt * self.track;
        if crosses(&mut self.sums, all * self.track, SLACK_M_PER_S, seconds) {
            self.found.alarms += 1;
            self.found.alarm_s.get_or_insert(time_s);
        }
        if crosses(&mut self.sums_beyond, apart * self.track, slack, seconds) {
            self.found.alarms_beyond_geometry += 1;
        }
        // the turn that is not there: Σ s_i of each wheel's share
        self.windows += 1.0;
        self.squares += apart * apart;
        for (fit, x) in self.fits.iter_mut().zip(turns.chain([turn])) {
            fit[0] += apart * x;
            fit[1] += x * x;
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
        found.geometry = self.geometry.errors();
        if let [best, next, ..] = ranked[..] {
            found.likelier = 0.5 * self.windows * Real::ln(next.0 / best.0);
            let [product, square] = self.fits[best.1];
            found.slip = (square > 0.0).then(|| product / square);
            let is_wheel = best.1 < self.shares.len();
            let slips = found.slip.is_some_and(|slip| slip > 0.0);
            if found.alarms_beyond_geometry > 0
                && is_wheel
                && slips
                && found.likelier > NAMED_LOG_ODDS
            {
                found.wheel = Some(best.1);
            }
        }
        found
    }
}

/// Adds a difference of speeds (m/s) over `seconds` to a sum for each sign; does one come to a whole way?
fn crosses(sums: &mut [f64; 2], apart: f64, slack: f64, seconds: f64) -> bool {
    let mut crossed = false;
    for (sum, sign) in sums.iter_mut().zip([1.0, -1.0]) {
        *sum = (*sum + (sign * apart - slack) * seconds).max(0.0);
        if *sum > APART_M {
            *sum = 0.0;
            crossed = true;
        }
    }
    crossed
}

/// Recursive least squares for the constant errors of track and radii.
#[derive(Clone, Copy, Debug)]
struct Geometry {
    mean: [f64; 2],
    covariance: [[f64; 2]; 2],
}

impl Default for Geometry {
    fn default() -> Self {
        let variance = GEOMETRY_SIGMA * GEOMETRY_SIGMA;
        Self {
            mean: [0.0; 2],
            covariance: [[variance, 0.0], [0.0, variance]],
        }
    }
}

impl Geometry {
    /// Adds a difference of turns (rad/s) of standard deviation `noise`; returns the part that geometry does not explain,
    /// and the standard deviation of the part that it does.
    fn update(&mut self, row: [f64; 2], apart: f64, noise: f64) -> (f64, f64) {
        let spread = self
            .covariance
            .map(|line| line[0] * row[0] + line[1] * row[1]);
        let variance = row[0] * spread[0] + row[1] * spread[1];
        let innovation = apart - row[0] * self.mean[0] - row[1] * self.mean[1];
        let inverse = 1.0 / (variance + noise * noise);
        for i in 0..2 {
            let moved = self.mean[i] + spread[i] * inverse * innovation;
            self.mean[i] = moved.clamp(-MAX_GEOMETRY, MAX_GEOMETRY);
            for j in 0..2 {
                self.covariance[i][j] -= spread[i] * inverse * spread[j];
            }
        }
        (innovation, variance.max(0.0).sqrt())
    }

    fn errors(&self) -> [Measured; 2] {
        [0, 1].map(|i| Measured {
            value: self.mean[i],
            variance: self.covariance[i][i],
        })
    }
}
