//! Does a counter miss pulses? Here and there by chance, or one slot of every turn.
//!
//! The second difference of the ticks of three equal windows, −½ S₁ + S₂ − ½ S₃, is blind to speed and acceleration. Whole ticks
//! alone give it the variance q(α) = 3.75 a₁ − 1.5 a₂ + .25 a₃ with aⱼ = fⱼ (1 − fⱼ), fⱼ the fraction of j α and α the ticks a
//! window; a share p of pulses lost at random adds 1.5 p (1 − p) α. A broken slot lacks a tick at the same place of each turn.

use crate::history::{seconds_between, whole};

/// A window has about as many ticks as the first, and at most as many readings as the second.
const WINDOW_TICKS: f64 = 12.0;
const MAX_WINDOW_READINGS: f64 = 50.0;
/// Windows with fewer or more ticks than this say nothing.
const USED: (f64, f64) = (4.0, 60.0);
/// Windows that differ in time by more than this share are not equal.
const MAX_WINDOW_DIFFERENCE: f64 = 0.1;
/// Ticks, and share of a window's, by which the first and the third of three windows may differ: where the speed changes more,
/// it changes unevenly as well.
const LEVEL: (f64, f64) = (1.0, 0.25);
/// The share that is lost is a mean over this long, s; it is known after so long.
const LOSS_MEMORY_S: f64 = 3.0;
const LOSS_KNOWN_TIME_S: f64 = 1.5;
/// How fast the usual ticks of a window are learnt, a window.
const USUAL_TICKS_SHARE: f64 = 0.15;
/// More than this share is missed, and less than this no longer.
const MISSED: (f64, f64) = (0.022, 0.012);
/// Ticks by which two windows, and twice the usual one, may differ where the speed is steady.
const STEADY: (f64, f64) = (2.0, 2.0);
/// Parts of a turn.
const PARTS: usize = 32;
/// A slot is broken when its part of the turn lacks more ticks a turn than the first, by more than the second times the scatter of the
/// other parts, over the third number of turns; what is older than the fourth counts half.
const MIN_LACKING_TICKS: f64 = 0.5;
const MIN_SCATTER_MULTIPLE: f64 = 6.0;
const TURNS: (f32, f32) = (8.0, 64.0);

/// One wheel's pulses.
#[derive(Clone, Debug)]
pub(super) struct PulseCheck {
    /// Rim travel of a tick (m), and ticks of a turn.
    tick: f64,
    turn: f64,
    last: Option<(i64, f64)>,
    /// The open window: how many readings it takes, how many there are, ticks and time.
    readings: f64,
    so_far: f64,
    ticks: f64,
    seconds: f64,
    /// The two windows before it.
    before: [Option<(f64, f64)>; 2],
    usual: f64,
    share: f64,
    seen: f64,
    missed: bool,
    /// Ticks by part of the turn beyond what was expected, and how often it was passed.
    beyond: [f32; PARTS],
    passed: [f32; PARTS],
    part: usize,
}

impl PulseCheck {
    pub(super) fn new(tick: f64, turn: f64) -> Self {
        Self {
            tick,
            turn,
            last: None,
            readings: 1.0,
            so_far: 0.0,
            ticks: 0.0,
            seconds: 0.0,
            before: [None; 2],
            usual: 0.0,
            share: 0.0,
            seen: 0.0,
            missed: false,
            beyond: [0.0; PARTS],
            passed: [0.0; PARTS],
            part: 0,
        }
    }

    /// The counter begins anew.
    pub(super) fn restart_clock(&mut self) {
        *self = Self::new(self.tick, self.turn);
    }

    /// The share of pulses that is missed at random, as far as this counter alone shows; `None` where it is not known.
    pub(super) fn share(&self) -> Option<f64> {
        (self.seen >= LOSS_KNOWN_TIME_S).then_some(self.share)
    }

    /// Does it miss more than it may, where other wheels seem to miss `others`? They cannot: it is the ground that is rough.
    pub(super) fn misses(&mut self, others: f64) -> bool {
        let beyond = self.share - 2.0 * others.max(0.0);
        let least = if self.missed { MISSED.1 } else { MISSED.0 };
        self.missed = self.seen >= LOSS_KNOWN_TIME_S && beyond > least;
        self.missed
    }

    /// The rim has run `travel` (m) in all by `time_ns`.
    pub(super) fn update(&mut self, time_ns: i64, travel: f64) {
        let Some((last_ns, last)) = self.last.replace((time_ns, travel)) else {
            return;
        };
        let (ticks, seconds) = (
            (travel - last) / self.tick,
            seconds_between(last_ns, time_ns),
        );
        if !(seconds > 0.0) || !ticks.is_finite() {
            return;
        }
        self.by_part(travel / self.tick, ticks, seconds);
        self.ticks += ticks;
        self.seconds += seconds;
        self.so_far += 1.0;
        if self.so_far >= self.readings {
            self.end_window();
        }
    }

    fn end_window(&mut self) {
        let (ticks, seconds) = (self.ticks, self.seconds);
        let size = ticks.abs();
        (self.ticks, self.seconds, self.so_far) = (0.0, 0.0, 0.0);
        let wanted = (self.readings * WINDOW_TICKS / size.max(0.1)).clamp(1.0, MAX_WINDOW_READINGS);
        if wanted > 2.0 * self.readings || 2.0 * wanted < self.readings {
            self.readings = whole(wanted + 0.5) as f64;
            self.before = [None; 2];
            self.usual = 0.0;
            return;
        }
        let [first, second] = self.before;
        self.before = [second, Some((ticks, seconds))];
        self.usual = if self.usual == 0.0 {
            ticks
        } else {
            self.usual + USUAL_TICKS_SHARE * (ticks - self.usual)
        };
        let (Some((s_1, t_1)), Some((s_2, t_2))) = (first, second) else {
            return;
        };
        let equal = (t_1 - t_2).abs().max((seconds - t_2).abs()) <= MAX_WINDOW_DIFFERENCE * t_2;
        let level = (s_1 - ticks).abs() <= LEVEL.0 + LEVEL.1 * size;
        if !(equal && level && size >= USED.0 && size <= USED.1) {
            return;
        }
        let bent = s_2 - 0.5 * (s_1 + ticks);
        let most = 6.0 * (1.0 + 0.3 * size);
        let beyond = ((bent * bent).min(most) - by_whole_ticks(self.usual)) / (1.5 * size);
        let weight = (seconds / LOSS_MEMORY_S)
            .max(seconds / (self.seen + seconds))
            .min(1.0);
        self.share += weight * (beyond - self.share);
        self.seen += seconds;
    }

    fn by_part(&mut self, now: f64, ticks: f64, seconds: f64) {
        // one tick of each turn is the one that is missed
        let turn = self.turn - 1.0;
        if self.usual == 0.0 || !(turn >= 2.0 * PARTS as f64) {
            return;
        }
        let [Some((s_1, t_1)), Some((s_2, t_2))] = self.before else {
            return;
        };
        // where the speed changes, what was expected is not to be had to a tick
        let steady =
            (s_1 - s_2).abs() <= STEADY.0 && (s_1 + s_2 - 2.0 * self.usual).abs() <= STEADY.1;
        if !steady {
            return;
        }
        let expected = self.usual * 2.0 * seconds / (t_1 + t_2);
        let place = fraction(now / turn);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of a turn in [0, 1)"
        )]
        let part = ((place * PARTS as f64) as usize).min(PARTS - 1);
        if part != self.part {
            self.passed[self.part] += 1.0;
            if self.passed[self.part] >= TURNS.1 {
                self.passed[self.part] *= 0.5;
                self.beyond[self.part] *= 0.5;
            }
            self.part = part;
        }
        #[allow(clippy::cast_possible_truncation, reason = "a few ticks")]
        let beyond = ((ticks - expected) * ticks.signum()).clamp(-3.0, 3.0) as f32;
        self.beyond[part] += beyond;
    }

    /// Does one part of the turn lack a tick every time?
    pub(super) fn has_broken_slot(&self) -> bool {
        if self.passed.iter().any(|&passed| passed < TURNS.0) {
            return false;
        }
        let of = |i: usize| f64::from(self.beyond[i] / self.passed[i]);
        let worst = (0..PARTS).fold(0, |a, b| if of(b) < of(a) { b } else { a });
        let others = || (0..PARTS).filter(|&i| i != worst).map(of);
        let count = (PARTS - 1) as f64;
        let mean = others().sum::<f64>() / count;
        let scatter = others().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count;
        let lacks = mean - of(worst);
        lacks > MIN_LACKING_TICKS
            && lacks > MIN_SCATTER_MULTIPLE * grouser_real::Real::sqrt(scatter)
    }
}

/// What a number has beyond the whole one below it, in [0, 1).
fn fraction(x: f64) -> f64 {
    let rest = x - whole(x) as f64;
    if rest < 0.0 { rest + 1.0 } else { rest }
}

/// The variance of −½ S₁ + S₂ − ½ S₃ by whole ticks alone, where α come in each.
fn by_whole_ticks(alpha: f64) -> f64 {
    let part = |j: f64| {
        let f = fraction(j * alpha);
        f * (1.0 - f)
    };
    3.75 * part(1.0) - 1.5 * part(2.0) + 0.25 * part(3.0)
}

#[cfg(test)]
pub(super) mod tests;
