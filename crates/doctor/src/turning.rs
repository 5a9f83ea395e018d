//! Turns over blocks of some seconds: by the gyro, by the yaw of the reference, by the wheels together, and by each of them.

use grouser_real::{Real, wrap_angle};
use grouser_slip::{Measurement, Robot, Sample, WheelRole};

use crate::comparison::{Comparison, PART_S};

/// Blocks that last longer than this multiple of a part have a gap. Limit.
const MAX_BLOCK_PARTS: f64 = 2.0;
/// Nothing is known of a turn between two readings of a gyro that are further apart, s. Limit.
const MAX_GYRO_GAP_S: f64 = 0.5;
/// No robot turns by more between two poses, rad: a yaw that was turned round does. Limit.
const MAX_JUMP_RAD: f64 = 2.5;
/// A turn over a block is a bend beyond this, rad: the bias of a gyro is below. Sensor noise.
pub(crate) const MIN_BEND_RAD: f64 = 0.15;
/// The robot must turn by this to each side, rad. Limit.
const MIN_TURN_RAD: f64 = 0.5;
/// Slips of wheels are of the order of 1: squares of a distance that this is worth, m². Prior.
const SLIP_PRIOR_M2: f64 = 1e-4;
/// A wheel nearer to the middle than this, as a share of the outermost one's distance, shows no side. Limit.
const MIN_SIDE_SHARE: f64 = 0.25;

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

/// A wheel of a side: how far it runs more than the mean of all by a turn, m/rad, how far it ran in the block, m, and its turns compared.
#[derive(Clone, Debug)]
pub(crate) struct SideWheel {
    pub(crate) wheel: usize,
    pub(crate) arm: f64,
    ran: f64,
    /// By gyro and yaw.
    pub(crate) own_turns: [Comparison; 2],
}

/// The turns of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turning {
    last_rate: Option<(i64, f64)>,
    /// Yaw of the last reading; sums of displacements count from 0.
    pub(crate) yaw: Option<f64>,
    stepped_ns: Option<i64>,
    /// Turns of the open block by gyro, yaw and wheels, rad, the distance by the wheels, m, and its begin.
    gyro_turn: f64,
    yaw_turn: f64,
    wheels_turn: f64,
    ran: f64,
    begun_ns: Option<i64>,
    /// Wheels on the sides of a robot whose wheels point one way.
    pub(crate) sides: Vec<SideWheel>,
    /// |Turn| in bends since it was taken last, rad.
    turned: f64,
    /// Turn in bends to the left and to the right, by gyro and yaw, rad.
    bends: [[f64; 2]; 2],
    pub(crate) yaw_gyro: Comparison,
    pub(crate) gyro_wheels: Comparison,
    pub(crate) yaw_wheels: Comparison,
}

impl Turning {
    /// `is_steered`: does the robot turn as its wheels are steered?
    pub(crate) fn new(robot: &Robot, is_steered: bool) -> Self {
        let arms = parallel_arms(robot).filter(|_| !is_steered);
        let arms = arms.unwrap_or_default();
        let reach = (arms.iter()).fold(0.0, |reach: f64, (_, arm)| reach.max(arm.abs()));
        let sided = (arms.into_iter())
            .filter(|(_, arm)| arm.abs() > 1e-3 && arm.abs() > MIN_SIDE_SHARE * reach);
        let of = |(wheel, arm)| SideWheel {
            wheel,
            arm,
            ran: 0.0,
            own_turns: [Comparison::with_prior(SLIP_PRIOR_M2); 2],
        };
        Self {
            sides: sided.map(of).collect(),
            yaw_gyro: Comparison::with_bias(),
            gyro_wheels: Comparison::with_bias(),
            yaw_wheels: Comparison::with_bias(),
            ..Self::default()
        }
    }

    pub(crate) fn take(&mut self, sample: &Sample) {
        let now_ns = sample.time_ns;
        match sample.measurement {
            Measurement::YawRate { rate } => {
                if let Some((last_ns, last)) = self.last_rate.replace((now_ns, rate)) {
                    let passed = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
                    // NaN: a block with a gap is left out
                    let is_known = passed < MAX_GYRO_GAP_S;
                    if is_known && rate.abs() > MIN_BEND_RAD / PART_S {
                        self.bends[0][usize::from(rate < 0.0)] += rate.abs() * passed;
                    }
                    self.gyro_turn += if is_known {
                        0.5 * (last + rate) * passed
                    } else {
                        f64::NAN
                    };
                }
            }
            Measurement::Pose { x, y, yaw } if (x + y + yaw).is_finite() => {
                let last = self.yaw.replace(yaw).unwrap_or(yaw);
                let turn = wrap_angle(yaw - last);
                self.turn_yaw(now_ns, turn);
            }
            Measurement::Displacement {
                turn: Some(turn), ..
            } if turn.is_finite() => {
                self.yaw = Some(self.yaw.unwrap_or(0.0) + turn);
                self.turn_yaw(now_ns, turn);
            }
            _ => {}
        }
    }

    fn turn_yaw(&mut self, now_ns: i64, turn: f64) {
        self.yaw_turn += if turn.abs() < MAX_JUMP_RAD {
            turn
        } else {
            f64::NAN
        };
        self.compare(now_ns);
    }

    /// Takes the mean speed of the wheels, m/s, the turn by them, rad/s, and each wheel's speed.
    pub(crate) fn step(&mut self, now_ns: i64, [speed, turn]: [f64; 2], wheels: &[Option<f64>]) {
        let last_ns = self.stepped_ns.replace(now_ns).unwrap_or(now_ns);
        let passed = now_ns.saturating_sub(last_ns) as f64 * 1e-9;
        if passed > 0.0 {
            self.wheels_turn += turn * passed;
            self.ran += speed * passed;
            for side in &mut self.sides {
                let of = wheels.get(side.wheel).copied().flatten();
                side.ran += of.unwrap_or(f64::NAN) * passed;
            }
        }
        if self.yaw.is_none() {
            self.compare(now_ns);
        }
    }

    /// Compares the turns of a block where it ends.
    fn compare(&mut self, now_ns: i64) {
        let seconds = (self.begun_ns).map_or(f64::INFINITY, |from| {
            now_ns.saturating_sub(from) as f64 * 1e-9
        });
        if seconds < PART_S {
            return;
        }
        self.begun_ns = Some(now_ns);
        let [gyro, yaw, wheels, ran] = [
            &mut self.gyro_turn,
            &mut self.yaw_turn,
            &mut self.wheels_turn,
            &mut self.ran,
        ]
        .map(std::mem::take);
        let turn = if self.last_rate.is_some() { gyro } else { yaw };
        if turn.abs() > MIN_BEND_RAD {
            self.turned += turn.abs();
        }
        if yaw.abs() > MIN_BEND_RAD {
            self.bends[1][usize::from(yaw < 0.0)] += yaw.abs();
        }
        let is_whole = seconds < MAX_BLOCK_PARTS * PART_S;
        let bias = [seconds];
        if is_whole && self.last_rate.is_some() {
            if self.yaw.is_some() {
                self.yaw_gyro.add(seconds, yaw, bias, gyro);
            }
            self.gyro_wheels.add(seconds, gyro, bias, wheels);
        }
        if is_whole && self.yaw.is_some() {
            self.yaw_wheels.add(seconds, yaw, bias, wheels);
        }
        for side in &mut self.sides {
            let own = std::mem::take(&mut side.ran) - ran;
            for (compared, turn) in side.own_turns.iter_mut().zip([gyro, yaw]) {
                if is_whole && turn.abs() > MIN_BEND_RAD {
                    // a slip of the wheel, and one of the inner wheels, which makes them faster than the outer ones
                    let slips = [ran, ran * turn.signum()];
                    compared.add(seconds, turn, slips, own / side.arm);
                }
            }
        }
    }

    /// Did the robot turn to both sides by gyro and by yaw? A wheel that slips in bends to one side alone looks like an exchanged one.
    pub(crate) fn has_both_bends(&self) -> [bool; 2] {
        (self.bends).map(|of| of.iter().all(|turned| *turned > MIN_TURN_RAD))
    }

    /// |Turn| in bends since the last call, rad.
    pub(crate) fn take_turned(&mut self) -> f64 {
        std::mem::take(&mut self.turned)
    }
}
