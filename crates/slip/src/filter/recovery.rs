//! When the filter itself has lost its way, or two references contradict each other: what is plausible, and how it begins
//! again.

use super::motion_model::{COMMON_SLIP, FORWARD, own_slip};
use super::settings::SlipPrior;
use super::monitor::Watch;
use super::{ALONE, FELT_UNREST, RETURNS, SlipFilter};
use crate::history::seconds_between;

/// A robot this much faster than its fastest wheel (as a share, and m/s) for long is an error of the filter.
const RUNAWAY: (f64, f64) = (1.5, 0.05);
/// A speed is plausible when the slip that it means is within this many sigma of what is believed of slip.
const PLAUSIBLE: f64 = 2.5;
/// How well a speed is known from which the filter begins again, as a share and m/s.
const BEGINNING: (f64, f64) = (0.05, 0.02);

impl SlipFilter {
    /// Has nothing told the robot's speed for long?
    pub(super) fn is_lost(&self, now_ns: i64) -> bool {
        self.reference_ns
            .is_none_or(|then| seconds_between(then, now_ns) > ALONE)
    }

    /// The powered wheels' mean rim speed, m/s; `None` where none is heard.
    fn powered_rim(&self) -> Option<f64> {
        let heard = || {
            let now_ns = self.now_ns.unwrap_or(0);
            self.wheels.iter().filter_map(move |wheel| {
                let silent = wheel.silence(now_ns)? > self.settings.dropout;
                (!wheel.free && !silent).then_some(wheel.rim?.0.value)
            })
        };
        let count = heard().count();
        (count > 0).then(|| heard().sum::<f64>() / count as f64)
    }

    /// How far, in sigma of what is believed of it, the powered wheels' slip would be if the robot went at `speed` (m/s);
    /// `None` where they hardly turn.
    fn surprise(&self, speed: f64) -> Option<f64> {
        let rim = self.powered_rim()?;
        let SlipPrior { mean, sigma } = self.settings.slip;
        let faster = if rim.abs() >= speed.abs() { rim } else { speed };
        let shows = faster.abs() > 2.0 * self.settings.low_speed;
        shows.then(|| ((rim - speed) / faster - mean).abs() / sigma)
    }

    /// Could the robot go at `speed` (m/s) for all that is believed of its wheels' slip?
    pub(super) fn is_plausible(&self, speed: f64) -> bool {
        self.surprise(speed).is_some_and(|off| off <= PLAUSIBLE)
    }

    /// Does a camera or its like tell the same speed as `speed` (m/s) now?
    pub(super) fn agrees_with_camera(&self, speed: f64, now_ns: i64) -> bool {
        self.reference.speed.is_some_and(|(told, then)| {
            let gap = (told - speed).abs() - self.settings.low_speed;
            seconds_between(then, now_ns) <= ALONE && gap <= RETURNS * speed.abs()
        })
    }

    /// Does a free wheel that turns tell the same speed as `speed` (m/s) now?
    pub(super) fn agrees_with_free_wheel(&self, speed: f64, now_ns: i64) -> bool {
        self.wheels.iter().any(|wheel| {
            let speaks = wheel
                .silence(now_ns)
                .is_some_and(|silence| silence <= self.settings.dropout);
            let rim = wheel.rim.map_or(0.0, |(rim, _)| rim.value);
            let gap = (rim - speed).abs() - self.settings.low_speed;
            wheel.free && speaks && wheel.turns() && gap <= RETURNS * speed.abs()
        })
    }

    /// Do a free wheel and what the filter goes by contradict each other, and is the filter's speed the stranger of the
    /// two? Then neither is to be trusted, until one of them shows what is wrong with it.
    pub(super) fn is_disputed(&self, now_ns: i64) -> bool {
        let own = self.state.mean(FORWARD);
        let strange = |claim: f64| {
            let (Some(ours), Some(theirs)) = (self.surprise(own), self.surprise(claim)) else {
                return false;
            };
            (own - claim).abs() > RETURNS * claim.abs().max(own.abs()) && ours > theirs
        };
        let by_wheel = self.wheels.iter().any(|wheel| {
            let speaks = wheel
                .silence(now_ns)
                .is_some_and(|silence| silence <= self.settings.dropout);
            let suspect = wheel.watch.has_failed() || wheel.watch.is_suspect();
            wheel.free
                && suspect
                && speaks
                && wheel.turns()
                && wheel.rim.is_some_and(|(rim, _)| strange(rim.value))
        });
        let by_camera = !self.reference.watch.is_clean()
            && self.reference.speed.is_some_and(|(told, then)| {
                seconds_between(then, now_ns) <= ALONE && strange(told)
            });
        by_wheel || by_camera
    }

    /// Has no free wheel turned since the robot stood, or has one stopped unforeseen, and does nothing else tell the
    /// robot's speed? Then either the robot is stuck or they are.
    pub(super) fn is_blocked(&self, now_ns: i64) -> bool {
        let told = self.reference.accepted_ns;
        let alone = told.is_none_or(|then| seconds_between(then, now_ns) > ALONE);
        let mut free = self.wheels.iter().filter(|wheel| wheel.free).peekable();
        let blocked = |wheel: &super::wheel_channel::Tracked| {
            !wheel.rolling.has_turned || !wheel.turns() && !wheel.rolling.stop_known
        };
        alone && free.peek().is_some() && free.all(blocked)
    }

    /// A filter that has lost its way: the robot would be much faster than the fastest of its wheels. It begins again from
    /// these.
    pub(super) fn catch_runaway(&mut self, time_ns: i64) {
        let rims = || {
            self.wheels
                .iter()
                .filter_map(|wheel| Some(wheel.rim?.0.value))
        };
        let Some(fastest) = rims().reduce(|a, b| if b.abs() > a.abs() { b } else { a }) else {
            return;
        };
        let speed = self.state.mean(FORWARD);
        let runs = speed.abs() > RUNAWAY.0 * fastest.abs() + RUNAWAY.1;
        if self.runaway.judge(time_ns, !runs, self.settings.failure) {
            return;
        }
        self.runaway = Watch::default();
        self.felt_unrest = FELT_UNREST.1;
        self.begin_again(fastest, 0.5 * fastest.abs() + RUNAWAY.1);
        for wheel in &mut self.wheels {
            wheel.watch = Watch::default();
        }
    }

    /// Begins again from a speed that is told (m/s).
    pub(super) fn begin_from(&mut self, speed: f64) {
        self.begin_again(speed, BEGINNING.0 * speed.abs() + BEGINNING.1);
    }

    /// The robot's speed and all slips are known anew.
    fn begin_again(&mut self, speed: f64, sigma: f64) {
        self.state.reset(FORWARD, speed, sigma * sigma);
        let SlipPrior { mean, sigma } = self.settings.slip;
        self.state.reset(COMMON_SLIP, mean, sigma * sigma);
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.pull = 0.0;
            wheel.was_off = false;
            let SlipPrior { mean, sigma } = if wheel.free {
                self.settings.free_slip.by_rim()
            } else {
                SlipPrior {
                    mean: 0.0,
                    sigma: self.settings.wheel_slip_sigma,
                }
            };
            self.state.reset(own_slip(index), mean, sigma * sigma);
        }
    }
}
