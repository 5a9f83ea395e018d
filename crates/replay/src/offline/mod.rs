//! The slips of a log by all of its samples: the one model of the motion, forwards and back, over the steps of the online filter.

mod prior;
mod smoothed;

use std::collections::VecDeque;

use grouser_files::robot::RobotFile;
use grouser_slip::motion::{Reading, Step};
use grouser_slip::smooth::fit;

use self::prior::{Prior, begin};
use self::smoothed::Smoothed;
use crate::choice::Inputs;
use crate::moment::{Moment, seconds};

/// A log is smoothed in blocks of this time, which bounds the memory to about 80 MB, s; each begins and ends this time beyond what
/// is used of it, which is more than the slip remembers.
const BLOCK_S: f64 = 400.0;
const BEYOND_S: f64 = 60.0;

/// A longer step spans a silence of all sensors, s: the filter's own are as long as the period of the wheels, at most this.
const SILENT_S: f64 = 1.0;
/// Of a longer silence the end is passed over, s: by then nothing is known of the speed.
const MAX_SILENCE_S: f64 = 60.0;

/// A step as steps of the usual length (s), each with its readings.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a step is at most a minute long"
)]
fn parts(step: &Step, usual: f64) -> impl Iterator<Item = Step> {
    let count = (step.dt / usual).ceil() as usize;
    let dt = step.dt / count as f64;
    (1..=count).rev().map(move |left| {
        let to_end = dt * (left - 1) as f64;
        let is_own = |of: &Reading| of.since >= to_end && (of.since < to_end + dt || left == count);
        let own = step.readings.iter().filter(|of| is_own(of));
        let readings = own.map(|of| Reading {
            since: of.since - to_end,
            ..*of
        });
        Step {
            time: step.time - to_end,
            dt,
            turn: step.turn.map(|turn| turn / count as f64),
            readings: readings.collect(),
            ..step.clone()
        }
    })
}

/// Smooths a log block by block: steps and moments in, moments with the slips and motions of the whole log out.
#[derive(Debug)]
pub(crate) struct Offline {
    prior: Prior,
    /// Steps since a minute before the present block, by their time since the first moment.
    steps: Vec<Step>,
    moments: VecDeque<Moment>,
    begin_ns: Option<i64>,
    /// What is used of the present block begins here, s.
    from: f64,
    /// The wheels that contradict the others, bit by bit.
    left_out: u64,
}

impl Offline {
    pub(crate) fn new(file: &RobotFile, inputs: &Inputs) -> Self {
        Self {
            prior: Prior::new(file, inputs),
            steps: Vec::new(),
            moments: VecDeque::new(),
            begin_ns: None,
            from: 0.0,
            left_out: 0,
        }
    }

    /// A step that is complete.
    pub(crate) fn take(&mut self, end_ns: i64, step: &Step) {
        let mut step = step.clone();
        step.time = seconds(*self.begin_ns.get_or_insert(end_ns), end_ns);
        for (index, wheel) in step.wheels.iter_mut().enumerate() {
            wheel.distance = wheel.distance.filter(|_| self.left_out >> index & 1 == 0);
        }
        // in a silence of all sensors speed and slip change: it is passed in steps of the usual length
        let last = self
            .steps
            .last()
            .map_or([step.time - step.dt, step.dt], |last| [last.time, last.dt]);
        let [last_end, usual] = last;
        let begin = step.time - step.dt;
        let silence = |step: &Step| {
            let mut silent = step.clone();
            (silent.wheels.iter_mut()).for_each(|wheel| wheel.distance = None);
            silent
        };
        if begin - last_end > usual {
            let hole = Step {
                time: begin,
                dt: (begin - last_end).min(MAX_SILENCE_S),
                turn: None,
                force: None,
                readings: Vec::new(),
                ..silence(&step)
            };
            self.steps.extend(parts(&hole, usual));
        }
        if step.dt > SILENT_S.max(usual) {
            self.steps.extend(parts(&silence(&step), usual));
        } else {
            self.steps.push(step);
        }
    }

    /// A moment as it was known at its time, and the wheels that contradicted the others then; gives moments that are done.
    pub(crate) fn push(&mut self, moment: Moment, contradicting: u64) -> Vec<Moment> {
        self.left_out = contradicting;
        let now = seconds(*self.begin_ns.get_or_insert(moment.time_ns), moment.time_ns);
        self.moments.push_back(moment);
        if now < self.from + BLOCK_S + BEYOND_S {
            return Vec::new();
        }
        let until = self.from + BLOCK_S;
        let done = self.smooth(until);
        self.from = until;
        self.steps.retain(|step| step.time > until - BEYOND_S);
        done
    }

    /// The log is over: gives what is left.
    pub(crate) fn finish(mut self) -> Vec<Moment> {
        self.smooth(f64::INFINITY)
    }

    /// Moments before `until` by all steps so far.
    fn smooth(&mut self, until: f64) -> Vec<Moment> {
        let first = begin(&self.steps);
        let (levels, learn) = self.prior.levels(&self.steps);
        let found = fit(&mut self.steps, first, levels, learn);
        let smoothed = Smoothed::new(&found, &self.steps, self.prior.scale_sigma());
        let begin_ns = self.begin_ns.unwrap_or_default();
        let mut done = Vec::new();
        while let Some(mut moment) = self.moments.pop_front() {
            let time = seconds(begin_ns, moment.time_ns);
            if time >= until {
                self.moments.push_front(moment);
                break;
            }
            smoothed.enter(time, &mut moment);
            done.push(moment);
        }
        done
    }
}
