//! The five-wheeled robot's run step by step, and what the ground may do to it on the way.

use crate::five_wheel::{FiveWheel, Run, WHEELS};

/// What is true from one row to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Speed of the robot's origin, m/s.
    pub speed: f64,
    /// rad/s.
    pub yaw_rate: f64,
    /// Speed of each wheel's centre along its heading, m/s.
    pub forward: [f64; WHEELS],
    /// Speed of each rim, m/s.
    pub rim: [f64; WHEELS],
    /// Torque on each wheel, N m.
    pub torque: [f64; WHEELS],
}

/// What happens to the robot on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The wheel loses the ground: its rim runs faster by half its speed and 0.3 m/s, without torque.
    LiftOff {
        /// Which.
        wheel: usize,
    },
    /// The robot digs itself in within half a second, stays there while its powered wheels turn on, and comes free in the
    /// last half second.
    Immobilised,
    /// Robot and wheels stand; the motors push with this torque, N m.
    Stall {
        /// N m.
        torque: f64,
    },
    /// The free wheel does not turn.
    FreeWheelLocked,
    /// The free wheel turns by this share of the ground's speed.
    FreeWheelSkids {
        /// 1 without skid.
        share: f64,
    },
    /// The motor side turns this much, m of rim travel, before the wheel follows: a gear's play taken up at once.
    Backlash {
        /// m.
        play: f64,
    },
}

/// A run, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Rows per second.
    pub rate: u32,
    /// The rows: each holds until the next.
    pub steps: Vec<Step>,
}

/// Greatest torque over load and radius, and the slip at half of it: torque rises with slip, then levels off.
const PULL: (f64, f64) = (0.6, 0.1);
/// Load times radius of a powered wheel, N m.
const LOAD_TORQUE_N_M: f64 = 6.0;

/// Slip: 1 − v/u driving, u/v − 1 braking; `None` where both speeds are below 1 mm/s or of opposite sign.
#[must_use]
pub fn slip(forward: f64, rim: f64) -> Option<f64> {
    if forward.abs().max(rim.abs()) < 1e-3 || forward * rim < 0.0 {
        return None;
    }
    Some(if rim.abs() >= forward.abs() {
        1.0 - forward / rim
    } else {
        rim / forward - 1.0
    })
}

/// A robot that digs itself in comes to rest within this time, and free again, s.
const DIGGING_TIME_S: f64 = 0.5;

fn torque(forward: f64, rim: f64) -> f64 {
    let Some(slip) = slip(forward, rim) else {
        return 0.0;
    };
    let pull = LOAD_TORQUE_N_M * PULL.0 * slip / (slip.abs() + PULL.1);
    if rim < 0.0 { -pull } else { pull }
}

impl Course {
    /// The rows of a run.
    #[must_use]
    pub fn new(five_wheel: &FiveWheel, run: &Run) -> Self {
        let rate = f64::from(five_wheel.rate);
        let steps = run.truth.windows(2).map(|pair| {
            let (now, next) = (&pair[0], &pair[1]);
            let forward = std::array::from_fn(|i| (next.way[i] - now.way[i]) * rate);
            let rim: [f64; WHEELS] = std::array::from_fn(|i| (next.rim[i] - now.rim[i]) * rate);
            Step {
                speed: 0.5 * (now.speed + next.speed),
                yaw_rate: 0.5 * (now.yaw_rate + next.yaw_rate),
                forward,
                rim,
                torque: std::array::from_fn(|i| {
                    if five_wheel.wheels[i].free {
                        0.0
                    } else {
                        torque(forward[i], rim[i])
                    }
                }),
            }
        });
        Self {
            rate: five_wheel.rate,
            steps: steps.collect(),
        }
    }

    /// The slip of `wheel` at row `row`.
    #[must_use]
    pub fn slip(&self, row: usize, wheel: usize) -> Option<f64> {
        let step = &self.steps[row];
        slip(step.forward[wheel], step.rim[wheel])
    }

    /// Lets something happen from one time to another, s.
    #[must_use]
    pub fn with(mut self, event: Event, (from, to): (f64, f64)) -> Self {
        let rate = f64::from(self.rate);
        let fifth = WHEELS - 1;
        let mut first = true;
        for (row, step) in self.steps.iter_mut().enumerate() {
            let time = row as f64 / rate;
            if time < from || time >= to {
                continue;
            }
            match event {
                Event::LiftOff { wheel } => {
                    step.rim[wheel] = 1.5 * step.rim[wheel] + 0.3;
                    step.torque[wheel] = 0.02;
                }
                Event::Immobilised => {
                    let edge = (time - from).min(to - time) / DIGGING_TIME_S;
                    let left = (1.0 - edge).max(0.0);
                    step.speed *= left;
                    step.yaw_rate *= left;
                    step.rim[fifth] *= left;
                    for i in 0..WHEELS {
                        step.forward[i] *= left;
                        if i < fifth {
                            step.torque[i] = torque(step.forward[i], step.rim[i]);
                        }
                    }
                }
                Event::Stall { torque } => {
                    (step.speed, step.yaw_rate) = (0.0, 0.0);
                    (step.forward, step.rim) = ([0.0; WHEELS], [0.0; WHEELS]);
                    step.torque = std::array::from_fn(|i| if i < fifth { torque } else { 0.0 });
                }
                Event::FreeWheelLocked => step.rim[fifth] = 0.0,
                Event::FreeWheelSkids { share } => step.rim[fifth] = share * step.forward[fifth],
                Event::Backlash { play } => {
                    if std::mem::take(&mut first) {
                        for rim in &mut step.rim[..fifth] {
                            *rim += play * rate;
                        }
                    }
                }
            }
        }
        self
    }
}
