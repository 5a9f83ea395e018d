//! Are left and right encoders exchanged? In a bend the outer wheels run faster; exchanged ones show the other side's bends.

use grouser_real::{Real, solve};
use grouser_slip::window::WindowBody;
use grouser_slip::{Robot, WheelRole};

/// Slower turns are no bends, rad/s: a gyro's bias and noise lie below.
const MIN_BEND_RAD_PER_S: f64 = 0.05;
/// The robot must turn by this to each side, rad: a wheel that slips in bends to one side alone looks like an exchanged one.
const MIN_TURN_RAD: f64 = 0.5;
/// An exchanged wheel's arm has the other side's sign and at least this share of its length; slip in bends changes the length.
const MIN_ARM_SHARE: f64 = 0.5;
/// The other side's bends explain at least this share of what is left of the wheel's speeds. A choice: with 0.5, two of 220 right logs
/// were called exchanged.
const MIN_EXPLAINED_SHARE: f64 = 0.7;
/// Slips explain all but this share of the yaw rates at most: bends that are all alike show no arms.
const MIN_FREE_SHARE: f64 = 0.05;
/// Slips are of the order of 1: this times their square is added to the squares of speeds, m²/s. A robot that turns on the spot
/// has no other.
const SLIP_RIDGE: f64 = 1e-4;
/// A wheel nearer to the middle than this, as a share of the outermost one's distance, shows no side.
const MIN_SIDE_SHARE: f64 = 0.25;
/// Wheels that show the bends of the other side.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ExchangeCheck {
    /// Their indices in the robot's order: wheels of both sides.
    pub wheels: Vec<usize>,
    /// Is it certain that they are exchanged, because other wheels or the reference turn with the gyro? If not, the sign of the
    /// gyro may be wrong instead.
    pub is_certain: bool,
    /// Are they all wheels that have a side? Then the frame of gyro and reference may be mirrored instead.
    pub is_whole: bool,
}

/// Regression of each wheel's speed against the mean of all, in bends, on the robot's speed (its slip), the same with the sign
/// of the bend (a slip of the inner wheels, which can make them faster than the outer ones), and the yaw rate (its arm).
#[derive(Clone, Debug, Default)]
pub(crate) struct ExchangeWatch {
    /// The powered wheels, and the described arm of each: d(speed against the mean)/d(yaw rate), m.
    wheels: Vec<usize>,
    arms: Vec<f64>,
    window: f64,
    until_ns: Option<i64>,
    /// Σ x xᵀ of x = (v, v sign Ω, Ω).
    moments: [[f64; 3]; 3],
    /// Of each wheel Σ d x and Σ d².
    sums: Vec<([f64; 3], f64)>,
    /// Turns to the left and to the right, rad.
    turned: [f64; 2],
}

/// The powered wheels of a robot, where all of them point one way, each with its arm: d(speed against the mean)/d(yaw rate), m.
pub(crate) fn parallel_arms(robot: &Robot) -> Option<Vec<(usize, f64)>> {
    let mut arms: Vec<(usize, f64)> = Vec::new();
    let (mut first, mut sum) = (None, 0.0);
    for (index, wheel) in robot.wheels().iter().enumerate() {
        if wheel.role != WheelRole::Powered {
            continue;
        }
        let [x, y, arm] = wheel.speed_row();
        let [first_x, first_y] = *first.get_or_insert([x, y]);
        if !(Real::hypot(x - first_x, y - first_y) < 0.02) {
            return None;
        }
        sum += arm;
        arms.push((index, arm));
    }
    let mean = sum / arms.len() as f64;
    for (_, arm) in &mut arms {
        *arm -= mean;
    }
    first.map(|_| arms)
}

impl ExchangeWatch {
    /// `None` for a robot whose wheels do not all point one way, or that has none beside another.
    pub(crate) fn new(robot: &Robot, window: f64) -> Option<Self> {
        let (wheels, arms): (Vec<usize>, Vec<f64>) = parallel_arms(robot)?.into_iter().unzip();
        arms.iter().any(|arm| arm.abs() > 1e-3).then(|| Self {
            wheels,
            window,
            sums: vec![([0.0; 3], 0.0); arms.len()],
            arms,
            ..Self::default()
        })
    }

    /// What is known over the window that ended at `body.until_ns`; `rim` yields each wheel's rim speed over it, m/s.
    pub(crate) fn step(&mut self, body: &WindowBody, rim: impl Fn(usize) -> Option<f64>) {
        let (Some(until_ns), Some(yaw_rate)) = (body.until_ns, body.yaw_rate) else {
            return;
        };
        let last_ns = self.until_ns.replace(until_ns).unwrap_or(until_ns);
        let seconds = until_ns.saturating_sub(last_ns) as f64 * 1e-9;
        if !(seconds > 0.0) {
            return;
        }
        let rate = yaw_rate.value;
        let rims = self.wheels.iter().map(|wheel| rim(*wheel));
        let sum = (rims.clone()).try_fold(0.0, |sum, rim| Some(sum + rim?));
        let Some(sum) = sum.filter(|_| rate.abs() > MIN_BEND_RAD_PER_S && seconds < self.window)
        else {
            return;
        };
        let speed = sum / self.wheels.len() as f64;
        let row = [speed, speed * rate.signum(), rate];
        for (line, x) in self.moments.iter_mut().zip(row) {
            add(line, seconds * x, row);
        }
        for ((sums, square), rim) in self.sums.iter_mut().zip(rims.flatten()) {
            let beside = rim - speed;
            add(sums, seconds * beside, row);
            *square += seconds * beside * beside;
        }
        self.turned[usize::from(rate < 0.0)] += seconds * rate.abs();
    }

    /// The exchanged wheels, if there are any: never without bends to both sides. Is the sign of the yaw rate certain?
    pub(crate) fn found(&self, is_sign_certain: bool) -> Option<ExchangeCheck> {
        if self.turned.iter().any(|turned| *turned < MIN_TURN_RAD) {
            return None;
        }
        let reach = self
            .arms
            .iter()
            .fold(0.0, |reach: f64, arm| reach.max(arm.abs()));
        let has_side = |wheel: &usize| self.arms[*wheel].abs() > MIN_SIDE_SHARE * reach;
        let sided = (0..self.arms.len()).filter(has_side);
        let (wheels, others): (Vec<usize>, Vec<usize>) =
            sided.partition(|wheel| self.shows_the_other_side(*wheel));
        let is_left = |wheel: &usize| self.arms[*wheel] < 0.0;
        let (left, right) = (wheels.iter().any(is_left), !wheels.iter().all(is_left));
        (left && right).then(|| ExchangeCheck {
            is_certain: is_sign_certain || !others.is_empty(),
            is_whole: others.is_empty(),
            wheels: wheels.iter().map(|place| self.wheels[*place]).collect(),
        })
    }

    fn shows_the_other_side(&self, wheel: usize) -> bool {
        let (sums, square) = self.sums[wheel];
        let mut moments = self.moments;
        for (place, line) in moments.iter_mut().enumerate().take(2) {
            line[place] += SLIP_RIDGE;
        }
        let unit = solve(moments, [0.0, 0.0, 1.0]);
        let (Some(unit), Some(fit)) = (unit, solve(moments, sums)) else {
            return false;
        };
        // What slips leave of the yaw rate.
        let left = 1.0 / unit[2];
        if !(left > MIN_FREE_SHARE * self.moments[2][2]) {
            return false;
        }
        let arm = fit[2];
        let explained = arm * arm * left;
        let residual = square - fit.iter().zip(sums).map(|(a, b)| a * b).sum::<f64>();
        let share = explained / (explained + residual.max(0.0));
        arm / self.arms[wheel] < -MIN_ARM_SHARE && share > MIN_EXPLAINED_SHARE
    }
}

fn add(sums: &mut [f64; 3], factor: f64, row: [f64; 3]) {
    for (sum, x) in sums.iter_mut().zip(row) {
        *sum += factor * x;
    }
}
