//! The model of the motion: how a belief passes over one step.

use grouser_real::{Real, wrap_angle};

use super::belief::{Belief, Row};
use super::evidence::{Evidence, log_density, surprise};
use super::noise::{Levels, Noise};
use super::state::{DRIFT, FORCE_BIAS, HEADING, MAX_LOG_SLIP, SIZE, SLIP, SPEED, TURN_BIAS, X, Y};
use super::step::{NewFrame, Reading, Step, Value, WheelStep};
use super::tape::{Entry, Tape};
use super::wheels::{CommonMotion, JITTER, common_motion};

/// Wheels change the robot's speed by this at most, m/s²: half of gravity, what they carry on firm ground.
pub const MAX_ACCELERATION: f64 = 5.0;
/// Slower wheels change their slip by distance and not by time, m/s.
pub const SLOW: f64 = 0.05;
/// Wheel speed and speed over ground differ by this for other reasons than slip, m/s: what a count or a rate of a slow wheel leaves
/// open at the usual resolution.
pub const CREEP: f64 = 5e-4;
/// A robot whose wheels are stationary turns by this at most (it settles, it is pushed), rad/s.
const STATIONARY_TURN: f64 = 0.01;
/// A wheel is stationary where its distance over a step is within this many sigma.
const STATIONARY_SIGMAS: f64 = 2.0;
/// Measured and predicted speeds whose ratio is beyond this are not alike.
const MAX_RATIO: f64 = 3.0;

/// Sigma of each number before the first step: place (m), heading (rad), speed (m/s), logarithmic slip, drift, turn bias (rad/s),
/// accelerometer's bias (m/s², a slope of 6°). A gyro's bias is that of a cheap one; turns by wheels are wrong by tenths of a rad/s.
const START_SIGMA: [f64; SIZE] = [5.0, 5.0, 3.0, 3.0, 0.4, 0.1, 0.02, 1.0];
const TURN_SIGMA_BY_WHEELS: f64 = 0.1;
/// The logarithmic slip before the first step: wheels on soft ground slip by a tenth.
const START_SLIP: f64 = 0.1;

/// Sigma of the heading in a frame that begins within the step, rad: a robot that turns by a radian a second.
const FRAME_TURN: f64 = 0.1;

/// What one pass keeps from step to step.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The belief at the last step's end.
    pub belief: Belief,
    /// The wheels' common motion in the last step.
    pub common: CommonMotion,
}

/// The belief before the first step, from a place (m) and a heading (rad).
#[must_use]
pub fn start(place: [f64; 2], heading: f64, has_gyro: bool) -> Belief {
    let mut mean = [0.0; SIZE];
    (mean[X], mean[Y], mean[HEADING]) = (place[0], place[1], heading);
    mean[SLIP] = START_SLIP;
    let mut sigma = START_SIGMA;
    if !has_gyro {
        sigma[TURN_BIAS] = TURN_SIGMA_BY_WHEELS;
    }
    Belief::independent(mean, sigma)
}

/// The belief as operations pass over it, each written to the tape where there is one.
struct Pass<'a> {
    belief: &'a mut Belief,
    levels: &'a Levels,
    record: Record<'a>,
}

/// What a pass leaves behind.
#[derive(Debug)]
pub enum Record<'a> {
    /// Nothing.
    Nothing,
    /// The operations, for the pass back.
    Tape(&'a mut Tape),
    /// What the step shows of a mode; readings may be outliers then.
    Evidence(&'a mut Evidence),
}

impl Pass<'_> {
    fn write(&mut self, entry: Entry) {
        if let Record::Tape(tape) = &mut self.record {
            tape.entries.push(entry);
        }
    }

    fn noise(&mut self, noise: Noise, index: usize, exposure: f64, extra: f64) {
        let variance = self.levels.of(noise) * exposure + extra;
        self.belief.add_noise(index, variance);
        self.write(Entry::Noise {
            noise,
            index,
            exposure,
        });
    }

    fn propagate(&mut self, index: usize, row: Row) {
        self.belief.propagate(index, &row);
        self.write(Entry::Propagate { index, row });
    }

    /// Corrects the belief and returns the innovation's variance.
    fn correct(
        &mut self,
        noise: Noise,
        row: &Row,
        innovation: f64,
        variance: f64,
        reading: Option<usize>,
    ) -> f64 {
        let correction = self.belief.update(row, innovation, variance);
        self.write(Entry::Update {
            noise,
            correction,
            variance,
            reading,
        });
        correction.variance
    }
}

impl Motion {
    /// From a belief.
    #[must_use]
    pub fn new(belief: Belief) -> Self {
        Self {
            belief,
            common: CommonMotion::default(),
        }
    }

    /// Passes over one step. `extra` is a variance that the slip has besides its level's.
    pub fn advance(
        &mut self,
        step: &Step,
        levels: &Levels,
        extra: f64,
        scratch: &mut [f64],
        tape: Option<&mut Tape>,
    ) {
        let record = tape.map_or(Record::Nothing, Record::Tape);
        self.pass(step, levels, extra, scratch, record);
    }

    /// Passes over one step and leaves a record.
    pub fn pass(
        &mut self,
        step: &Step,
        levels: &Levels,
        extra: f64,
        scratch: &mut [f64],
        record: Record<'_>,
    ) {
        let dt = step.dt;
        let share = Real::exp(-self.belief.mean[SLIP]);
        let turn = step
            .turn
            .map(|turn| turn - self.belief.mean[TURN_BIAS] * dt);
        let found = common_motion(&step.wheels, turn, share, self.common.direction, scratch);
        let mut pass = Pass {
            belief: &mut self.belief,
            levels,
            record,
        };
        if let Some(frame) = step.frame {
            pass.begin_frame(frame);
        }
        let common = found.unwrap_or(CommonMotion {
            distance: 0.0,
            turn: None,
            ..self.common
        });
        let moves = (common.distance.abs() / SLOW).min(dt);
        // online the slip itself is the random walk: dλ = ds e^|λ|; of a whole log the level is learnt
        let stretch = match pass.record {
            Record::Evidence(_) => Real::exp(2.0 * pass.belief.mean[SLIP].abs()),
            Record::Nothing | Record::Tape(_) => 1.0,
        };
        pass.noise(Noise::Slip, SLIP, moves * stretch, extra);
        pass.noise(Noise::Drift, DRIFT, moves, 0.0);
        pass.noise(Noise::TurnBias, TURN_BIAS, dt, 0.0);
        if let Some([forward, _]) = step.force {
            pass.noise(Noise::ForceBias, FORCE_BIAS, dt, 0.0);
            pass.belief.mean[SPEED] += (forward - pass.belief.mean[FORCE_BIAS]) * dt;
            let mut row = [0.0; SIZE];
            row[SPEED] = 1.0;
            row[FORCE_BIAS] = -dt;
            pass.propagate(SPEED, row);
            pass.noise(Noise::Speed, SPEED, dt, 0.0);
        } else {
            let limit = MAX_ACCELERATION * dt;
            pass.noise(Noise::Speed, SPEED, 0.0, limit * limit);
        }
        if found.is_some() {
            pass.wheels(&common, dt);
            if let (Some(turn), true) = (step.turn, is_stationary(step)) {
                pass.stationary(turn, dt);
            }
        }
        let bias = pass.belief.mean[TURN_BIAS] * dt;
        let turned = turn
            .or(common.turn.map(|turn| turn - bias))
            .unwrap_or(-bias);
        for wheel in step.wheels.iter().filter(|wheel| wheel.is_free) {
            pass.free_wheel(wheel, common.direction, turned, dt);
        }
        let along = pass.move_place(&common, turned, dt);
        let by_wheels = turn.map_or(common.turn_variance, |_| 0.0);
        pass.noise(Noise::Turn, HEADING, dt, by_wheels);
        pass.noise(Noise::Wander, X, dt, 0.0);
        pass.noise(Noise::Wander, Y, dt, 0.0);
        for (index, reading) in step.readings.iter().enumerate() {
            pass.read(reading, index, along, turned / dt);
        }
        let mean = &mut pass.belief.mean;
        mean[SLIP] = mean[SLIP].clamp(-MAX_LOG_SLIP, MAX_LOG_SLIP);
        if let Record::Tape(tape) = pass.record {
            tape.entries.push(Entry::End);
            tape.ends.push(*pass.belief);
        }
        self.common = CommonMotion {
            turned: turned + bias,
            ..common
        };
    }
}

/// Has no wheel turned over the step, by its own resolution?
fn is_stationary(step: &Step) -> bool {
    step.wheels.iter().all(|wheel| {
        wheel.distance.is_some_and(|distance| {
            distance * distance
                <= STATIONARY_SIGMAS
                    * STATIONARY_SIGMAS
                    * wheel.variance.max(CREEP * CREEP * step.dt * step.dt)
        })
    })
}

/// Innovation of the powered wheels and its derivative by the logarithmic slip: `measured` is u e^−λ, `share` the part of the
/// innovation's variance that is the speed's.
///
/// Where measured and predicted speed are alike the innovation is v x, of which the speed takes the share κ and λ the rest, so that
/// the constraint e^(ε − (1 − κ) x) = 1 + κ x holds, ε = ln(measured/predicted). It is linearised at the predicted speed: at the
/// measured one the gain would follow the noise, and the scale that speed and slip share would drift.
fn wheel_innovation(measured: f64, predicted: f64, share: impl Fn(f64) -> f64) -> (f64, f64) {
    let ratio = measured / predicted;
    if !(ratio > 1.0 / MAX_RATIO && ratio < MAX_RATIO) {
        return (measured - predicted, measured);
    }
    let log = Real::ln(ratio);
    let share = share(predicted);
    let power = Real::exp(share * log);
    let x = log - (1.0 + share * log - power) / (share + (1.0 - share) * power);
    (predicted * x, predicted)
}

impl Pass<'_> {
    /// Place and heading lie in a new frame.
    fn begin_frame(&mut self, frame: NewFrame) {
        let [x, y] = frame.place;
        let heading = frame.heading.map(|heading| (HEADING, heading, FRAME_TURN));
        let place = [(X, x, START_SIGMA[X]), (Y, y, START_SIGMA[Y])];
        for (index, value, sigma) in place.into_iter().chain(heading) {
            self.belief.mean[index] = value;
            self.propagate(index, [0.0; SIZE]);
            self.noise(Noise::Wander, index, 0.0, sigma * sigma);
        }
    }

    /// The powered wheels: v = u e^−λ.
    fn wheels(&mut self, common: &CommonMotion, dt: f64) {
        let belief = &*self.belief;
        let measured = common.distance / dt * Real::exp(-belief.mean[SLIP]);
        let p = &belief.covariance;
        let (innovation, slope) = wheel_innovation(measured, belief.mean[SPEED], |slope| {
            let own = p[SPEED][SPEED] + slope * p[SPEED][SLIP];
            let all = own + slope * p[SPEED][SLIP] + slope * slope * p[SLIP][SLIP];
            (own / all).clamp(0.0, 1.0)
        });
        let mut row = [0.0; SIZE];
        row[SPEED] = 1.0;
        row[SLIP] = slope;
        let jitter = JITTER * measured;
        let noise = common.variance / (dt * dt) + CREEP * CREEP + jitter * jitter;
        let variance = self.levels.of(Noise::Wheel) * noise;
        let expected = self.correct(Noise::Wheel, &row, innovation, variance, None);
        if let Record::Evidence(evidence) = &mut self.record {
            evidence.likelihood += surprise(innovation, expected);
        }
    }

    /// A robot whose wheels are all stationary does not turn: the gyro shows its bias.
    fn stationary(&mut self, turn: f64, dt: f64) {
        let mut row = [0.0; SIZE];
        row[TURN_BIAS] = 1.0;
        let variance = self.levels.of(Noise::Turn) / dt + STATIONARY_TURN * STATIONARY_TURN;
        self.correct(
            Noise::Wheel,
            &row,
            turn / dt - self.belief.mean[TURN_BIAS],
            variance,
            None,
        );
    }

    /// A free wheel reads the speed. Its skid is no state: nothing else shows it where a free wheel is needed, and a product of two
    /// unknowns, 1 − skid and v, has a scale that drifts.
    fn free_wheel(&mut self, wheel: &WheelStep, direction: f64, turned: f64, dt: f64) {
        let Some(distance) = wheel.distance else {
            return;
        };
        let mut row = [0.0; SIZE];
        let (sin, cos) = Real::sin_cos(direction);
        let [ahead, left, lever] = wheel.row;
        let (speed, drift) = (self.belief.mean[SPEED], self.belief.mean[DRIFT]);
        row[SPEED] = ahead * (cos - drift * sin) + left * (sin + drift * cos);
        row[DRIFT] = speed * (left * cos - ahead * sin);
        let variance = wheel.variance / (dt * dt) + CREEP * CREEP;
        let innovation = (distance - wheel.swing - lever * turned) / dt - row[SPEED] * speed;
        let expected = self.correct(Noise::Wheel, &row, innovation, variance, None);
        if let Record::Evidence(evidence) = &mut self.record {
            evidence.likelihood += log_density(innovation, expected);
        }
    }

    /// Moves the place by the speed; returns the direction of motion in the reference's frame.
    fn move_place(&mut self, common: &CommonMotion, turned: f64, dt: f64) -> [f64; 2] {
        let mean = &mut self.belief.mean;
        let (sin, cos) = Real::sin_cos(mean[HEADING] + 0.5 * turned + common.direction);
        let (speed, drift) = (mean[SPEED], mean[DRIFT]);
        let along = [cos - drift * sin, sin + drift * cos];
        let moved = [dt * speed * along[0], dt * speed * along[1]];
        mean[X] += moved[0];
        mean[Y] += moved[1];
        mean[HEADING] += turned;
        let mut rows = [[0.0; SIZE]; 3];
        rows[0][X] = 1.0;
        rows[0][HEADING] = -moved[1];
        rows[0][SPEED] = dt * along[0];
        rows[0][DRIFT] = -dt * speed * sin;
        rows[1][Y] = 1.0;
        rows[1][HEADING] = moved[0];
        rows[1][SPEED] = dt * along[1];
        rows[1][DRIFT] = dt * speed * cos;
        rows[2][HEADING] = 1.0;
        rows[2][TURN_BIAS] = -dt;
        for (index, row) in [X, Y, HEADING].into_iter().zip(rows) {
            self.propagate(index, row);
        }
        along
    }

    /// A reading of a reference, taken `since` before the step's end.
    fn read(&mut self, reading: &Reading, index: usize, along: [f64; 2], rate: f64) {
        let mut row = [0.0; SIZE];
        match reading.value {
            Value::Place(place) => {
                let rows = [X, Y].map(|axis| {
                    let mut row = [0.0; SIZE];
                    row[axis] = 1.0;
                    row[SPEED] = -reading.since * along[axis - X];
                    row
                });
                self.observe(reading, index, &rows, place);
            }
            Value::Heading(heading) => {
                row[HEADING] = 1.0;
                let now = self.belief.mean[HEADING];
                let before = now - rate * reading.since;
                self.observe(reading, index, &[row], [now + wrap_angle(heading - before)]);
            }
            Value::Speed(speed) => {
                row[SPEED] = 1.0;
                self.observe(reading, index, &[row], [speed]);
            }
        }
    }

    /// The numbers of a reading, each with its row.
    fn observe<const N: usize>(
        &mut self,
        reading: &Reading,
        index: usize,
        rows: &[Row; N],
        values: [f64; N],
    ) {
        let noise = reading.value.noise();
        let variance = self.levels.of(noise) * reading.scale;
        let Record::Evidence(evidence) = &mut self.record else {
            for (row, value) in rows.iter().zip(values) {
                let innovation = value - self.belief.mean_of(row);
                self.correct(noise, row, innovation, variance, Some(index));
            }
            return;
        };
        let found = self.belief.update_mixed(rows, &values, variance);
        evidence.likelihood += found.likelihood;
        let sums = &mut evidence.noise[noise as usize];
        sums[0] += found.good * N as f64;
        sums[1] += found.good * found.square / reading.scale;
    }
}
