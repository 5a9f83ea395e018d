//! One belief a mode: mixed, passed over a step, weighed.

use alloc::vec;
use alloc::vec::Vec;
use core::array;

use grouser_real::Real;

use super::learnt::LEARNT as READINGS;
use super::learnt::LearntNoise;
use super::refused::Refused;
use super::table::{MODES, WALKS, mixed, weighed};
use super::wheel::{OwnSlip, WheelSlip};
use crate::body::BodyMotion;
use crate::motion::{
    Belief, CommonMotion, DRIFT, Evidence, Levels, Motion, Noise, Reading, Record, Row, SLOW,
    SPEED, Step, TURN_BIAS, dot,
};

/// Turns by wheels in place of a gyro: white noise of the turn, rad/√s, and random walk of its error, rad/s/√s. A prior: wheels of a
/// differential robot scrub by tenths of a rad/s.
const TURN_BY_WHEELS: [f64; 2] = [0.02, 0.04];

/// The filter over the modes. Its size is fixed once it is made.
#[derive(Clone, Debug)]
pub struct ModeFilter {
    motions: [Motion; MODES],
    weights: [f64; MODES],
    belief: Belief,
    noise: LearntNoise,
    own: Vec<OwnSlip>,
    scratch: Vec<f64>,
    /// Number of readings in the last step, and how many of them are probably good; the same of those that show the speed.
    trusted: [f64; 2],
    of_speed: [f64; 2],
    /// Length of the last step, and for how much of it the slip may change, s.
    dt: f64,
    moved: f64,
}

impl ModeFilter {
    /// Before the first step. The slip's random walk is each mode's own: its entry in the levels is the share of it, 0 while held.
    #[must_use]
    pub fn new(start: Belief, mut levels: Levels, wheels: usize) -> Self {
        levels.0[Noise::Slip as usize] = 1.0;
        Self {
            motions: array::from_fn(|_| Motion::new(start)),
            weights: [1.0 / MODES as f64; MODES],
            belief: start,
            noise: LearntNoise::new(levels),
            own: vec![OwnSlip::default(); wheels],
            scratch: vec![0.0; wheels],
            trusted: [0.0; 2],
            of_speed: [0.0; 2],
            dt: 1.0,
            moved: 0.0,
        }
    }

    /// Becomes a copy of another filter of the same robot, in its own memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.motions.clone_from(&other.motions);
        self.weights = other.weights;
        self.belief = other.belief;
        self.noise = other.noise;
        self.own.copy_from_slice(&other.own);
        (self.trusted, self.of_speed) = (other.trusted, other.of_speed);
        (self.dt, self.moved) = (other.dt, other.moved);
    }

    /// Sets the level of the reference's own wandering, m²/s.
    pub const fn set_wander(&mut self, level: f64) {
        self.noise.set_level(Noise::Wander, level);
    }

    /// Sets the level of the speed's random walk next to an accelerometer, (m/s)²/s.
    pub const fn set_speed_noise(&mut self, level: f64) {
        self.noise.set_level(Noise::Speed, level);
    }

    /// Holds the slip's random walk where nothing measures the speed over ground: the caller's prior then states how the slip changes.
    pub const fn hold(&mut self, is_held: bool) {
        let walks = if is_held { 0.0 } else { 1.0 };
        self.noise.set_level(Noise::Slip, walks);
    }

    /// Restarts from a belief: what was learnt of motion, slips and noise is forgotten.
    pub fn begin(&mut self, start: Belief) {
        for motion in &mut self.motions {
            motion.belief = start;
        }
        self.weights = [1.0 / MODES as f64; MODES];
        self.belief = start;
        self.noise.begin();
        self.own.fill(OwnSlip::default());
    }

    /// Changes the belief of every mode; the merged one follows.
    pub fn change(&mut self, change: impl Fn(&mut Belief)) {
        for motion in &mut self.motions {
            change(&mut motion.belief);
        }
        self.belief = self.merged(&self.weights);
    }

    /// Passes over one step. A step that is refused changes nothing.
    ///
    /// # Errors
    /// [`Refused`] where a number is not finite or not positive, or the number of wheels is another one.
    pub fn advance(&mut self, step: &Step) -> Result<(), Refused> {
        Refused::check(step, self.own.len())?;
        // where wheels are slow or stationary, slip does not change by time
        let powered = step.wheels.iter().filter(|wheel| !wheel.is_free);
        let distances = powered.filter_map(|wheel| wheel.distance);
        let farthest = distances.fold(0.0, |most: f64, distance| most.max(distance.abs()));
        self.moved = (farthest / SLOW).min(step.dt);
        let (weights, shares) = mixed(&self.weights, self.moved);
        let beliefs: [Belief; MODES] = array::from_fn(|to| self.merged(&shares[to]));
        let mut evidence = [Evidence::default(); MODES];
        for (mode, motion) in self.motions.iter_mut().enumerate() {
            motion.belief = beliefs[mode];
            let mut levels = *self.noise.levels();
            levels.0[Noise::Slip as usize] *= WALKS[mode] * WALKS[mode];
            if step.turn.is_none() {
                let [turn, bias] = TURN_BY_WHEELS;
                levels.0[Noise::Turn as usize] = turn * turn;
                levels.0[Noise::TurnBias as usize] = bias * bias;
            }
            let record = Record::Evidence(&mut evidence[mode]);
            motion.pass(step, &levels, 0.0, &mut self.scratch, record);
            motion.belief.floor_variances();
        }
        self.weights = weighed(&weights, &evidence.map(|of| of.likelihood));
        // a robot that slides on stationary wheels is no noise of its reference
        if self.moved > 0.0 {
            self.noise.learn(&evidence, &self.weights);
        }
        self.belief = self.merged(&self.weights);
        let good = |kind: Noise| -> f64 {
            let of = evidence.iter().zip(&self.weights);
            of.map(|(of, weight)| weight * of.noise[kind as usize][0])
                .sum()
        };
        let count = |kind: Noise| -> f64 {
            let numbers = |of: &Reading| if kind == Noise::Place { 2.0 } else { 1.0 } * f64::from(u8::from(of.value.noise() == kind));
            step.readings.iter().map(numbers).sum()
        };
        (self.trusted, self.of_speed) = ([0.0; 2], [0.0; 2]);
        for kind in READINGS {
            let found = [count(kind), good(kind)];
            let add = |to: &mut [f64; 2]| *to = [to[0] + found[0], to[1] + found[1]];
            add(&mut self.trusted);
            if kind != Noise::Heading {
                add(&mut self.of_speed);
            }
        }
        self.dt = step.dt;
        let common = *self.common();
        // without a gyro the turn is that of the wheels themselves
        let turn = if step.turn.is_some() {
            [self.noise.levels().of(Noise::Turn) / step.dt, 0.0]
        } else {
            [0.0, common.turn_variance / (step.dt * step.dt)]
        };
        for (own, wheel) in self.own.iter_mut().zip(&step.wheels) {
            own.advance(wheel, step.dt, &self.belief, &common, turn);
        }
        Ok(())
    }

    /// The Gaussian with the moments of the modes' mixture by weights.
    fn merged(&self, weights: &[f64; MODES]) -> Belief {
        let beliefs = self.motions.iter().map(|motion| &motion.belief);
        Belief::mixture(weights.iter().copied().zip(beliefs))
    }

    /// The belief with the moments of all modes.
    #[must_use]
    pub const fn belief(&self) -> &Belief {
        &self.belief
    }

    /// The probability of each mode.
    #[must_use]
    pub const fn weights(&self) -> &[f64; MODES] {
        &self.weights
    }

    /// The levels of noise as they are learnt.
    #[must_use]
    pub const fn levels(&self) -> &Levels {
        self.noise.levels()
    }

    /// The wheels' common motion in the last step, by the likeliest mode.
    #[must_use]
    pub fn common(&self) -> &CommonMotion {
        let likeliest = (1..MODES).fold(0, |best, mode| {
            if self.weights[mode] > self.weights[best] {
                mode
            } else {
                best
            }
        });
        &self.motions[likeliest].common
    }

    /// Number of scalars that references read in the last step, and how many of them are probably no outliers.
    #[must_use]
    pub const fn trusted(&self) -> [f64; 2] {
        self.trusted
    }

    /// The same of places and speeds: a heading says nothing of the speed.
    #[must_use]
    pub const fn trusted_of_speed(&self) -> [f64; 2] {
        self.of_speed
    }

    /// For how much of the last step the slip may have changed, s: slow wheels change it by distance.
    #[must_use]
    pub const fn moved(&self) -> f64 {
        self.moved
    }

    /// The robot's motion over the last step.
    #[must_use]
    pub fn motion(&self) -> BodyMotion {
        body_motion(&self.belief, self.common(), self.dt)
    }

    /// The slip of a wheel at the last step's end; `None` where it did not move in that step, or there is no such wheel.
    #[must_use]
    pub fn wheel_slip(&self, wheel: usize) -> Option<WheelSlip> {
        self.own.get(wheel)?.slip(&self.belief)
    }

    /// The probability that the slip of a wheel exceeds a limit; `None` as in [`Self::wheel_slip`], and for a limit outside [−1, 1].
    #[must_use]
    pub fn exceeds(&self, wheel: usize, limit: f64) -> Option<f64> {
        let own = self.own.get(wheel)?;
        own.slip(&self.belief)?;
        let of_modes = self.weights.iter().zip(&self.motions);
        let probability = of_modes
            .map(|(weight, motion)| weight * own.exceeds(&motion.belief, limit))
            .sum();
        (-1.0..=1.0).contains(&limit).then_some(probability)
    }
}

/// The robot's motion over a step of `dt` (s) by a belief and the wheels' common motion.
#[must_use]
pub fn body_motion(belief: &Belief, common: &CommonMotion, dt: f64) -> BodyMotion {
    let mean = &belief.mean;
    let (sin, cos) = Real::sin_cos(common.direction);
    let (speed, drift) = (mean[SPEED], mean[DRIFT]);
    let along = [cos - drift * sin, sin + drift * cos];
    let mut rows = [Row::default(); 3];
    (rows[0][SPEED], rows[0][DRIFT]) = (along[0], -speed * sin);
    (rows[1][SPEED], rows[1][DRIFT]) = (along[1], speed * cos);
    rows[2][TURN_BIAS] = -1.0;
    let turn = common.turned / dt - mean[TURN_BIAS];
    BodyMotion {
        velocity: [speed * along[0], speed * along[1], turn],
        covariance: rows.map(|a| {
            let spread = belief.spread(&a);
            rows.map(|b| dot(&b, &spread))
        }),
    }
}
