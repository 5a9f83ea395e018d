//! The slips of a log by all of its samples: the one model of the motion, forwards and back, over the steps of the online filter.

mod path;
mod prior;
mod smoothed;

use std::collections::VecDeque;

use grouser_doctor::KnownStep;
use grouser_files::robot::RobotFile;
use grouser_slip::filter::SlipFilter;
use grouser_slip::motion::{Reading, Step};
use grouser_slip::smooth::fit;

use self::path::Path;
use self::prior::{Prior, begin};
use self::smoothed::Smoothed;
use crate::choice::Inputs;
use crate::moment::{Moment, seconds};
use crate::options::Options;
use crate::record::Record;

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
            frame: step.frame.filter(|_| left == count),
            readings: readings.collect(),
            ..step.clone()
        }
    })
}

/// Smooths a log block by block: steps and moments in, moments with the slips and motions of the whole log out.
#[derive(Debug)]
pub(crate) struct Offline {
    prior: Prior,
    /// Steps since a minute before the present block, by their time since the log's start.
    steps: Vec<Step>,
    moments: VecDeque<Moment>,
    begin_ns: Option<i64>,
    /// What is used of the present block begins here, s.
    from: f64,
    /// Length of the last step, s.
    usual: f64,
    /// The span that counts, s.
    span: [f64; 2],
    path: Path,
    /// Variance of the distance, m²; distance by the fits, m, and how far those with the other prior are from it, m.
    travel_variance: f64,
    travel: [f64; 2],
}

impl Offline {
    pub(crate) fn new(file: &RobotFile, inputs: &Inputs, options: &Options) -> Self {
        Self {
            prior: Prior::new(file, inputs),
            steps: Vec::new(),
            moments: VecDeque::new(),
            begin_ns: None,
            from: 0.0,
            usual: SlipFilter::STEP_S,
            span: [
                options.from_s.unwrap_or(f64::NEG_INFINITY),
                options.to_s.unwrap_or(f64::INFINITY),
            ],
            path: Path::default(),
            travel_variance: 0.0,
            travel: [0.0; 2],
        }
    }

    /// The log begins at this time, if it has not begun.
    pub(crate) fn begin(&mut self, start_ns: i64) {
        self.begin_ns.get_or_insert(start_ns);
    }

    /// A step that is complete, of which the wheels that are `left_out` (bit by bit) contradict the others.
    pub(crate) fn take(&mut self, end_ns: i64, step: &Step, left_out: u64) {
        let mut step = step.clone();
        step.time = seconds(*self.begin_ns.get_or_insert(end_ns), end_ns);
        for (index, wheel) in step.wheels.iter_mut().enumerate() {
            wheel.distance = wheel.distance.filter(|_| left_out >> index & 1 == 0);
        }
        // in a silence of all sensors speed and slip change: it is passed in steps of the usual length
        let last_end = (self.steps.last()).map_or(step.time - step.dt, |last| last.time);
        let usual = std::mem::replace(&mut self.usual, step.dt);
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
                frame: None,
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

    /// A moment as it was known at its time; gives moments that are done.
    pub(crate) fn push(&mut self, moment: Moment, record: &mut Record) -> Vec<Moment> {
        let now = seconds(*self.begin_ns.get_or_insert(moment.time_ns), moment.time_ns);
        self.moments.push_back(moment);
        if now < self.from + BLOCK_S + BEYOND_S {
            return Vec::new();
        }
        let until = self.from + BLOCK_S;
        let done = self.smooth(until, record);
        self.from = until;
        self.steps.retain(|step| step.time > until - BEYOND_S);
        done
    }

    /// The log is over: gives what is left.
    pub(crate) fn finish(&mut self, record: &mut Record) -> Vec<Moment> {
        self.smooth(f64::INFINITY, record)
    }

    /// Variance of the distance over the span, m².
    pub(crate) fn travel_variance(&self) -> f64 {
        let [distance, off] = self.travel;
        let of_scale = self.prior.scale_sigma() * distance;
        self.travel_variance + off * off + of_scale * of_scale
    }

    /// Moments before `until` by all steps so far; their distances are counted.
    fn smooth(&mut self, until: f64, record: &mut Record) -> Vec<Moment> {
        let first = begin(&self.steps);
        let (levels, learn) = self.prior.levels(&self.steps);
        let counted = self.from.max(self.span[0])..until.min(self.span[1]);
        let found = fit(&mut self.steps, first, levels, learn, counted);
        let other = found.other.as_ref().map_or(found.travel, |of| of.travel);
        self.travel_variance += found.travel.variance;
        self.travel[0] += found.travel.value;
        self.travel[1] += other.value - found.travel.value;
        let begin_ns = self.begin_ns.unwrap_or_default();
        self.path.begin(&self.steps);
        let mut odometry = Vec::with_capacity(self.steps.len());
        for (index, step) in self.steps.iter().enumerate() {
            let known = KnownStep {
                step,
                belief: &found.smoothed[index],
                common: &found.common[index],
            };
            if step.time > self.from && step.time <= until {
                record.count(begin_ns.saturating_add(nanoseconds(step.time)), &known);
                odometry.push(Some(self.path.step(&known, record.travel())));
            } else {
                odometry.push(None);
            }
        }
        let smoothed = Smoothed::new(&found, &self.steps, odometry, self.prior.scale_sigma());
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

#[allow(
    clippy::cast_possible_truncation,
    reason = "times of a log are far from the limit"
)]
fn nanoseconds(of: f64) -> i64 {
    (1e9 * of).round() as i64
}
