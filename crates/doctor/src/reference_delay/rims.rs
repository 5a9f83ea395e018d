//! The way of the rims along the robot.

use grouser_files::robot::RobotFile;
use grouser_real::{Real, solve};
use grouser_slip::{Measurement, Sample, Wheel, WheelRole};

use super::Passed;
use super::track::Track;
use crate::motion::{common_heading, wheel_travel};

/// A wheel that is read less often is not known in between, s.
const MAX_GAP_S: f64 = 0.5;
/// A forgotten gear makes wheels faster than a robot; this many times its speed is a counter that was reset.
const MAX_GEAR: f64 = 50.0;
/// Wheels whose headings differ by less (cosine) drive one way.
const PARALLEL_COSINE: f64 = 0.98;
/// Added to sums of squares of which some may be 0: a trick, small against squares of arms in m.
const UNSEEN: f64 = 1e-9;
/// Turns by the wheels are summed over this time, s.
const TURN_S: f64 = 0.2;

/// The mean way of the powered wheels along their heading. Steered ones count by the cosine of their angle.
#[derive(Clone, Debug)]
pub(crate) struct Rims {
    pub(crate) track: Track,
    /// Cosine and sine of the heading; `None` of a robot whose wheels point apart.
    pub(crate) along: Option<[f64; 2]>,
    wheels: Vec<Rim>,
    /// Of a wheel in the mean.
    share: f64,
    max_speed: f64,
    /// The turn by the wheels since the last step of it.
    turn: Option<Passed>,
}

#[derive(Clone, Debug)]
struct Rim {
    wheel: Wheel,
    cosine: f64,
    /// How much of the robot's turn it makes, rad/m.
    turn_share: f64,
    last: Option<(f64, Measurement)>,
}

impl Rims {
    pub(super) fn new(file: &RobotFile) -> Self {
        let all = file.robot.wheels().iter();
        let powered = all.filter(|wheel| wheel.role == WheelRole::Powered);
        let mut normal = [[0.0; 3]; 3];
        for row in powered.map(Wheel::speed_row) {
            for (line, a) in normal.iter_mut().zip(row) {
                for (sum, b) in line.iter_mut().zip(row) {
                    *sum += a * b;
                }
            }
        }
        // a motion that no wheel shows is none
        for (index, line) in normal.iter_mut().enumerate() {
            line[index] += UNSEEN;
        }
        let of = |wheel: &Wheel| Rim {
            wheel: wheel.clone(),
            cosine: 1.0,
            turn_share: solve(normal, wheel.speed_row()).map_or(f64::NAN, |motion| motion[2]),
            last: None,
        };
        let wheels: Vec<Rim> = file.robot.wheels().iter().map(of).collect();
        let powered = wheels
            .iter()
            .filter(|rim| rim.wheel.role == WheelRole::Powered);
        Self {
            track: Track::default(),
            along: common_heading(&file.robot, PARALLEL_COSINE),
            share: 1.0 / (powered.count().max(1) as f64),
            wheels,
            max_speed: MAX_GEAR * file.settings.max_speed,
            turn: None,
        }
    }

    /// Takes a reading of a wheel or of its steering; others have no effect. Returns the turn by the wheels where a step of it ends.
    pub(super) fn take(&mut self, time_s: f64, sample: &Sample) -> Option<Passed> {
        if let Measurement::SteeringAngle { wheel, angle } = sample.measurement
            && let Some(rim) = self.wheels.get_mut(wheel)
        {
            rim.cosine = Real::cos(angle);
        }
        let rim = self.wheels.get_mut(sample.measurement.wheel()?)?;
        if rim.wheel.role != WheelRole::Powered || !sample.measurement.is_rotation() {
            return None;
        }
        let (last_s, last) = rim.last.replace((time_s, sample.measurement))?;
        let passed_s = time_s - last_s;
        let way = wheel_travel(&rim.wheel, &last, &sample.measurement, passed_s) * rim.cosine;
        if !(passed_s <= MAX_GAP_S && way.abs() <= self.max_speed * passed_s) {
            self.track.interrupt(time_s);
            self.turn = None;
            return None;
        }
        let turn = rim.turn_share * way;
        if self.along.is_some() {
            self.track.add(time_s, self.share * way);
        }
        let open = self.turn.get_or_insert(Passed::begins(last_s));
        // the first wheel of a row ends the step of the rows before
        let is_whole = time_s > open.to_s && open.to_s - open.from_s >= TURN_S;
        let done = is_whole.then(|| std::mem::replace(open, Passed::begins(open.to_s)));
        open.to_s = time_s;
        open.amount += turn;
        done
    }
}
