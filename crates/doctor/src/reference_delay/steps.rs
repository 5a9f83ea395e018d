//! What the reference measured from one stamp to the next.

use grouser_slip::{Measurement, Reference};

use crate::motion::displacement;

/// Nothing is known between two readings that are further apart, s.
const MAX_GAP_S: f64 = 2.0;
/// Displacements are summed over at least this time, s: their noise is that of positions, and a change of speed takes longer.
const MIN_STEP_S: f64 = 0.38;
/// Speeds that follow sooner are left out, s: faster ones have errors alike.
const MIN_SPEED_PERIOD_S: f64 = 0.04;
/// A speed is compared with that of the rims over twice this time, s.
pub(super) const HALF_SPEED_S: f64 = 0.05;

/// Way forwards and to the left, m, and turn, rad, by the reference between two stamps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    pub(super) way: [f64; 2],
    pub(super) turn: Option<f64>,
}

impl Step {
    fn begins(time_s: f64) -> Self {
        Self {
            from_s: time_s,
            to_s: time_s,
            way: [0.0; 2],
            turn: Some(0.0),
        }
    }
}

/// The readings of a reference as steps.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    reference: Reference,
    pose: Option<[f64; 3]>,
    /// What passed since the last step; of speeds, the last.
    open: Option<Step>,
}

impl Steps {
    pub(super) const fn new(reference: Reference) -> Self {
        Self {
            reference,
            pose: None,
            open: None,
        }
    }

    /// Takes a reading; returns a step where it ends one.
    pub(super) fn take(&mut self, time_s: f64, measurement: &Measurement) -> Option<Step> {
        match *measurement {
            Measurement::Speed { forward, left } if self.reference == Reference::Speed => {
                let is_due = |last: Step| time_s - last.to_s >= MIN_SPEED_PERIOD_S;
                if !self.open.is_none_or(is_due) {
                    return None;
                }
                self.open = Some(Step::begins(time_s));
                Some(Step {
                    from_s: time_s - HALF_SPEED_S,
                    to_s: time_s + HALF_SPEED_S,
                    way: [forward, left.unwrap_or(0.0)].map(|speed| 2.0 * HALF_SPEED_S * speed),
                    turn: None,
                })
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } if self.reference == Reference::Displacement => {
                self.add(time_s, [forward, left], turn)
            }
            Measurement::Pose { x, y, yaw } if self.reference == Reference::Pose => {
                let last = self.pose.replace([x, y, yaw]).unwrap_or([x, y, yaw]);
                let (way, turn) = displacement(last, [x, y, yaw]);
                self.add(time_s, way, Some(turn))
            }
            _ => None,
        }
    }

    /// Adds what passed since the reading before.
    fn add(&mut self, time_s: f64, way: [f64; 2], turn: Option<f64>) -> Option<Step> {
        let is_finite = (way[0] + way[1] + turn.unwrap_or(0.0)).is_finite();
        let follows = |open: &Step| (0.0..MAX_GAP_S).contains(&(time_s - open.to_s));
        let Some(mut open) = self.open.filter(|open| is_finite && follows(open)) else {
            self.open = Some(Step::begins(time_s));
            return None;
        };
        open.to_s = time_s;
        open.way = [open.way[0] + way[0], open.way[1] + way[1]];
        open.turn = open.turn.zip(turn).map(|(sum, turn)| sum + turn);
        let is_whole = time_s - open.from_s >= MIN_STEP_S;
        self.open = Some(if is_whole { Step::begins(time_s) } else { open });
        is_whole.then_some(open)
    }
}
