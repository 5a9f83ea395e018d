//! Does each wheel turn in the direction in which the reference moves it?

use grouser_slip::window::WindowBody;
use grouser_slip::{Robot, Wheel, WheelRole};

/// Rims must have run this far while the reference moved their wheel, m, and this share of it one way.
const MIN_WAY_M: f64 = 1.0;
const MIN_SHARE: f64 = 0.8;

/// Compares the signs over a log.
#[derive(Clone, Debug)]
pub(crate) struct EncoderSigns {
    /// The row of each powered wheel that is not steered: its speed of a motion.
    rows: Vec<Option<[f64; 3]>>,
    low_speed: f64,
    /// Ways of the rims of each wheel along the motion, and in all, m.
    ways: Vec<[f64; 2]>,
    until_ns: Option<i64>,
}

impl EncoderSigns {
    pub(crate) fn new(robot: &Robot, low_speed: f64) -> Self {
        let is_fixed =
            |wheel: &&Wheel| wheel.role == WheelRole::Powered && wheel.steers_about.is_none();
        let wheels = robot.wheels().iter();
        let rows: Vec<_> = wheels
            .map(|wheel| Some(wheel).filter(is_fixed).map(Wheel::speed_row))
            .collect();
        Self {
            ways: vec![[0.0; 2]; rows.len()],
            rows,
            low_speed,
            until_ns: None,
        }
    }

    /// Takes the window that ended at `body.until_ns`, once; `rims` are the wheels' rim speeds over it, m/s.
    pub(crate) fn step(&mut self, body: &WindowBody, rims: &[Option<f64>]) {
        let last_ns = std::mem::replace(&mut self.until_ns, body.until_ns);
        let (Some(last_ns), Some(until_ns), Some(motion)) = (last_ns, body.until_ns, &body.motion)
        else {
            return;
        };
        let passed = (until_ns.saturating_sub(last_ns) as f64 * 1e-9).min(1.0);
        for ((row, rim), way) in self.rows.iter().zip(rims).zip(&mut self.ways) {
            let (Some(row), Some(rim)) = (row, rim) else {
                continue;
            };
            let speed = motion.along(*row).value;
            if speed.abs() > self.low_speed && rim.abs() > self.low_speed {
                way[0] += rim * speed.signum() * passed;
                way[1] += rim.abs() * passed;
            }
        }
    }

    /// The wheels that turn against the motion, bit by bit in the robot's order, where others turn with it.
    pub(crate) fn reversed(&self) -> Option<u64> {
        let turns =
            |sign: f64, way: &[f64; 2]| way[1] > MIN_WAY_M && sign * way[0] > MIN_SHARE * way[1];
        let mut reversed = 0;
        for (index, way) in self.ways.iter().enumerate() {
            if turns(-1.0, way) {
                reversed |= 1 << index;
            }
        }
        let is_sound = self.ways.iter().any(|way| turns(1.0, way));
        (reversed != 0 && is_sound).then_some(reversed)
    }
}
