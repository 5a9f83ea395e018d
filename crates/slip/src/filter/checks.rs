//! The checks of each wheel's encoder and radius, by its own readings.

use alloc::{boxed::Box, vec, vec::Vec};

use super::pulse_check::PulseCheck;
use super::radius_check::RadiusCheck;
use crate::history::seconds_between;
use crate::robot::{Robot, WheelRole};
use crate::speed::Measured;
use crate::state::Health;
use crate::wheel_estimate::WheelEstimate;

/// The checks of a wheel's encoder and radius by its own readings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WheelCheck {
    /// The share of pulses that its counter misses at random, by the unevenness of its ticks (a little below 0 by chance);
    /// `None` where the wheel has hardly turned, too slowly or too fast for its ticks, or has no counter.
    pub pulses_missed: Option<f64>,
    /// It misses more than 0.022 beyond the share that rough ground makes all wheels seem to miss: its slip is too low by that,
    /// and its health `Degraded(Suspect)`.
    pub misses_pulses: bool,
    /// A tick is missing at the same angle of each turn: a slot or a magnet is broken.
    pub broken_slot: bool,
    /// The share by which its described radius is too large, by its slip at no torque. `None` without torques, and until
    /// they have changed enough, driving and braking.
    pub radius_excess: Option<Measured>,
}

/// Pulses and radii are checked this often, s: their statistics change over seconds.
const CHECK_PERIOD_S: f64 = 0.1;

/// What is gathered of one wheel.
#[derive(Clone, Debug)]
struct WheelChecks {
    /// `None` for a sensor without ticks.
    pulses: Option<PulseCheck>,
    radius: RadiusCheck,
    is_free: bool,
}

/// The checks of all wheels.
#[derive(Clone, Debug)]
pub(super) struct Checks {
    wheels: Box<[WheelChecks]>,
    found: Box<[WheelCheck]>,
    shares: Vec<f64>,
    checked_ns: Option<i64>,
}

impl Checks {
    pub(super) fn new(robot: &Robot) -> Self {
        let wheels = robot.wheels();
        let of = |wheel: &crate::robot::Wheel| {
            let tick = wheel.travel_per_tick();
            let turn = wheel.radius * core::f64::consts::TAU;
            WheelChecks {
                pulses: tick.map(|tick| PulseCheck::new(tick, turn / tick)),
                radius: RadiusCheck::default(),
                is_free: wheel.role == WheelRole::Free,
            }
        };
        Self {
            wheels: wheels.iter().map(of).collect(),
            found: vec![WheelCheck::default(); wheels.len()].into_boxed_slice(),
            shares: Vec::with_capacity(wheels.len()),
            checked_ns: None,
        }
    }

    /// A counter has run `travel` (m) in all by `time_ns`.
    pub(super) fn count(&mut self, wheel: usize, time_ns: i64, travel: f64) {
        let of = self.wheels.get_mut(wheel);
        if let Some(pulses) = of.and_then(|of| of.pulses.as_mut()) {
            pulses.update(time_ns, travel);
        }
    }

    /// The torque of a wheel, N m.
    pub(super) fn torque(&mut self, wheel: usize, torque: f64) {
        if let Some(of) = self.wheels.get_mut(wheel) {
            of.radius.push(torque);
        }
    }

    /// The clock was set.
    pub(super) fn restart_clock(&mut self) {
        self.checked_ns = None;
        let pulses = self.wheels.iter_mut().filter_map(|of| of.pulses.as_mut());
        pulses.for_each(PulseCheck::restart_clock);
    }

    /// Checks each wheel where the last check is old enough; `skid` is the variance of a free wheel's slip.
    pub(super) fn update(&mut self, now_ns: i64, estimates: &[WheelEstimate], skid: f64) {
        let is_due = |then| seconds_between(then, now_ns) >= CHECK_PERIOD_S;
        if !self.checked_ns.is_none_or(is_due) {
            return;
        }
        self.checked_ns = Some(now_ns);
        for (index, estimate) in estimates.iter().enumerate() {
            let others = self.usual_missed_share(index);
            let of = &mut self.wheels[index];
            let is_ok = estimate.health == Health::Ok && !of.is_free;
            let slip = estimate.slip.filter(|_| is_ok).zip(estimate.sigma);
            of.radius.update(slip.map(|(slip, sigma)| Measured {
                value: slip.value(),
                variance: sigma * sigma,
            }));
            let found = &mut self.found[index];
            found.radius_excess = of.radius.excess(skid);
            if let Some(pulses) = of.pulses.as_mut() {
                found.pulses_missed = pulses.share();
                found.misses_pulses = pulses.misses(others);
                found.broken_slot = pulses.has_broken_slot();
            }
        }
    }

    pub(super) const fn found(&self) -> &[WheelCheck] {
        &self.found
    }

    /// The median share of pulses that the other wheels seem to miss.
    fn usual_missed_share(&mut self, index: usize) -> f64 {
        self.shares.clear();
        let others = self.wheels.iter().enumerate().filter(|of| of.0 != index);
        let shares = others.filter_map(|(_, of)| of.pulses.as_ref()?.share());
        self.shares.extend(shares);
        self.shares.sort_unstable_by(f64::total_cmp);
        self.shares
            .get(self.shares.len() / 2)
            .copied()
            .unwrap_or(0.0)
    }
}
