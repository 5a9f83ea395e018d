//! An encoder: the wheel's angle as whole ticks of a counter of finite width.

use grouser_slip::{Shaft, Wheel};

use super::fault::{FaultKind, Schedule};
use crate::ground::Noise;

/// An encoder with what its faults have done to it so far.
#[derive(Clone, Debug)]
pub(super) struct Encoder {
    ticks_per_radian: f64,
    ticks_per_turn: f64,
    reversed: bool,
    bits: u32,
    noise: Noise,
    /// Whole ticks of the shaft at the last reading.
    seen: i64,
    /// What the counter shows, unwrapped.
    shown: i64,
    /// Where in its gear's play it stands, ticks.
    play: i64,
    was_reset: bool,
    was_jumped: bool,
    /// Where its edges were last looked for, ticks, and the time of the last one, s.
    edge_angle: Option<f64>,
    edge_time: f64,
}

impl Encoder {
    pub(super) fn new(wheel: &Wheel, seed: u64, index: usize) -> Self {
        let e = &wheel.encoder;
        let ticks = e.ticks_per_turn.unwrap_or(1000.0);
        let gear = match e.shaft {
            Shaft::Wheel => 1.0,
            Shaft::Motor => e.gear,
        };
        Self {
            ticks_per_radian: ticks * gear / std::f64::consts::TAU,
            ticks_per_turn: ticks,
            reversed: e.reversed,
            bits: e.counter.bits(),
            noise: Noise::new(seed, 100 + index as u64),
            seen: 0,
            shown: 0,
            play: 0,
            was_reset: false,
            was_jumped: false,
            edge_angle: None,
            edge_time: 0.0,
        }
    }

    /// What the counter shows at the wheel's angle (rad); `None` while it is silent.
    pub(super) fn count(
        &mut self,
        angle: f64,
        schedule: &Schedule,
        wheel: usize,
        time: f64,
    ) -> Option<u64> {
        let active = |kind| schedule.active(kind, Some(wheel), time);
        let scale = active(FaultKind::RadiusError).unwrap_or(1.0);
        #[allow(
            clippy::cast_possible_truncation,
            reason = "an angle of 9e18 ticks is never turned"
        )]
        let now = (angle * self.ticks_per_radian).floor() as i64;
        let turned = now - self.seen;
        let before = self.seen;
        self.seen = now;
        let mut ticks = turned;
        if active(FaultKind::EncoderStuck).is_some() {
            ticks = 0;
        }
        if let Some(share) = active(FaultKind::PulseLoss) {
            ticks = self.lose(ticks, share);
        }
        if active(FaultKind::BrokenSlot).is_some() {
            ticks -= self.slots_passed(before, now);
        }
        if let Some(width) = active(FaultKind::Backlash) {
            ticks = self.through_play(ticks, width);
        }
        if active(FaultKind::EncoderReversed).is_some() {
            ticks = -ticks;
        }
        if scale != 1.0 {
            #[allow(clippy::cast_possible_truncation, reason = "a few ticks")]
            let scaled = (ticks as f64 * scale + self.noise.uniform() - 0.5).round() as i64;
            ticks = scaled;
        }
        self.shown += if self.reversed { -ticks } else { ticks };
        self.jump(&active);
        if active(FaultKind::EncoderSilent).is_some() {
            return None;
        }
        let raw = self.shown.cast_unsigned();
        Some(if self.bits >= 64 {
            raw
        } else {
            raw & ((1 << self.bits) - 1)
        })
    }

    /// Each edge between two angles of the wheel (rad) at two times (s): its time, to the `clock`'s resolution, and whether it
    /// is forwards. An edge that falls into the same step of the clock as the one before is lost, as in hardware.
    pub(super) fn edges(
        &mut self,
        angle: f64,
        [from, to]: [f64; 2],
        clock: f64,
        mut take: impl FnMut(f64, bool),
    ) {
        let now = angle * self.ticks_per_radian;
        let before = self.edge_angle.replace(now).unwrap_or(now);
        let (low, high) = (before.min(now).floor(), before.max(now).floor());
        let is_forward = now > before;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few edges a step"
        )]
        let count = (high - low).min(1e4) as u32;
        for index in 1..=count {
            let edge = if is_forward {
                low + f64::from(index)
            } else {
                high + 1.0 - f64::from(index)
            };
            let time = from + (to - from) * ((edge - before) / (now - before)).clamp(0.0, 1.0);
            let stamp = (time / clock).floor() * clock;
            if stamp > self.edge_time {
                self.edge_time = stamp;
                take(stamp, is_forward != self.reversed);
            }
        }
    }

    /// Resets and jumps happen once, where their window begins.
    fn jump(&mut self, active: &impl Fn(FaultKind) -> Option<f64>) {
        let reset = active(FaultKind::CounterReset).is_some();
        if reset && !self.was_reset {
            self.shown = 0;
        }
        self.was_reset = reset;
        let jump = active(FaultKind::TickJump);
        if let (Some(size), false) = (jump, self.was_jumped) {
            #[allow(clippy::cast_possible_truncation, reason = "saturates")]
            let size = size as i64;
            self.shown = self.shown.wrapping_add(size);
        }
        self.was_jumped = jump.is_some();
    }

    /// Each tick is lost with probability `share`.
    fn lose(&mut self, ticks: i64, share: f64) -> i64 {
        let kept = (0..ticks.unsigned_abs().min(100_000))
            .filter(|_| self.noise.uniform() >= share)
            .count();
        i64::try_from(kept).unwrap_or(0) * ticks.signum()
    }

    /// How often the broken slot, one tick of each turn of the shaft, passed.
    fn slots_passed(&self, before: i64, now: i64) -> i64 {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "at most 1e9 ticks per turn"
        )]
        let turn = (self.ticks_per_turn.round() as i64).max(1);
        now.div_euclid(turn) - before.div_euclid(turn)
    }

    /// The shaft moves only once its play is used up.
    fn through_play(&mut self, ticks: i64, width: f64) -> i64 {
        #[allow(clippy::cast_possible_truncation, reason = "a few dozen ticks")]
        let width = width.max(0.0) as i64;
        let at = self.play + ticks;
        self.play = at.clamp(0, width);
        at - self.play
    }
}
