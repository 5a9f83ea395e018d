//! The slips of a log by all of its samples: the one model of the motion, forwards and back.

mod gather;
mod prior;
mod smoothed;
mod track;

use std::collections::VecDeque;

use grouser_files::robot::RobotFile;
use grouser_slip::Sample;
use grouser_slip::smooth::fit;

use self::gather::Gathered;
use self::prior::{Prior, begin};
use self::smoothed::Smoothed;
use crate::choice::Inputs;
use crate::moment::Moment;

/// A log is smoothed in blocks of this time, which bounds the memory to about 80 MB, s; each begins and ends this time beyond what
/// is used of it, which is more than the slip remembers.
const BLOCK_S: f64 = 400.0;
const BEYOND_S: f64 = 60.0;

/// Smooths a log block by block: samples and moments in, moments with the slips and motions of the whole log out.
#[derive(Debug)]
pub(crate) struct Offline {
    gathered: Gathered,
    prior: Prior,
    moments: VecDeque<Moment>,
    /// What is used of the present block begins here, s from the first sample.
    from: f64,
}

impl Offline {
    pub(crate) fn new(file: &RobotFile, inputs: &Inputs) -> Self {
        Self {
            gathered: Gathered::new(file, inputs),
            prior: Prior::new(file, inputs),
            moments: VecDeque::new(),
            from: 0.0,
        }
    }

    /// A sample that is used.
    pub(crate) fn take(&mut self, sample: &Sample) {
        self.gathered.take(sample);
    }

    /// A moment as it was known at its time, and the wheels that contradicted the others then; gives moments that are done.
    pub(crate) fn push(&mut self, moment: Moment, contradicting: u64) -> Vec<Moment> {
        let now = self.gathered.seconds(moment.time_ns);
        self.gathered.contradict(now, contradicting);
        self.moments.push_back(moment);
        if now < self.from + BLOCK_S + BEYOND_S {
            return Vec::new();
        }
        let until = self.from + BLOCK_S;
        let done = self.smooth(now, until);
        self.from = until;
        self.gathered.forget(until - BEYOND_S);
        done
    }

    /// The log is over: gives what is left.
    pub(crate) fn finish(mut self) -> Vec<Moment> {
        let last = self
            .moments
            .back()
            .map_or(0.0, |moment| self.gathered.seconds(moment.time_ns));
        self.smooth(last, f64::INFINITY)
    }

    /// Moments before `until` by all samples up to `now`, s.
    fn smooth(&mut self, now: f64, until: f64) -> Vec<Moment> {
        let from = (self.from - BEYOND_S).max(0.0);
        let mut steps = self.gathered.steps(from, now);
        let first = begin(&steps);
        let (levels, learn) = self.prior.levels(&steps);
        let found = fit(&mut steps, first, levels, learn);
        let smoothed = Smoothed::new(&found, &steps, self.gathered.scale_sigma());
        let mut done = Vec::new();
        while let Some(mut moment) = self.moments.pop_front() {
            let time = self.gathered.seconds(moment.time_ns);
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
