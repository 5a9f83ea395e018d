//! Where the shear stress stops being smooth along the contact, or grows too fast for one rule.

use grouser_real::{Real, Scalar};

use super::Contact;
use super::crossing::crossing;
use crate::shear::{Restart, ShearState};

/// How closely the growth of the shear is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Detail {
    Standard,
    Fine,
    Finer,
}

impl Detail {
    /// Multiples of K of displacement at which a panel ends. Between two of them 1 − e^(−|j|/K) is tame;
    /// after the last it is 1 within the accuracy.
    const fn levels(self) -> &'static [f64] {
        match self {
            Self::Standard => &[2.0, 6.0, 13.0, 26.0],
            Self::Fine => &[1.5, 4.0, 9.0, 18.0, 42.0],
            Self::Finer => &[0.5, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 30.0, 45.0],
        }
    }
}

/// How closely a cut at a level of displacement is found, relatively: where exactly a panel ends does not matter there.
const LEVEL_CLOSE: f64 = 0.1;

/// How closely a cut is found where it has to be exact: rounding of an arc of 1 rad.
const EXACT_RAD: f64 = 1e-15;

/// Most cuts there can be: at most three monotone stretches of j, each with every level on both sides.
const CAPACITY: usize = 96;

/// Arcs behind the entry, ascending, rad.
pub(crate) struct Breakpoints {
    cuts: [f64; CAPACITY],
    len: usize,
}

impl Breakpoints {
    /// Every cut of `contact`.
    pub(crate) fn new<R: Scalar>(contact: &Contact<R>, detail: Detail) -> Self {
        let shear = contact.shear.values();
        let arc: f64 = Scalar::value(contact.arc());
        let mut cuts = Self {
            cuts: [0.0; CAPACITY],
            len: 0,
        };
        if detail > Detail::Standard {
            // the trigonometric factors over a long arc
            let halves = if detail == Detail::Fine { 2 } else { 4 };
            for i in 1..halves {
                cuts.push(arc * f64::from(i) / f64::from(halves));
            }
        }
        if !shear.locked {
            cuts.add_shear(&shear, arc, detail);
        }
        let live = &mut cuts.cuts[..cuts.len];
        live.sort_unstable_by(f64::total_cmp);
        cuts
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        &self.cuts[..self.len]
    }

    fn push(&mut self, w: f64) {
        if let Some(slot) = self.cuts.get_mut(self.len) {
            *slot = w;
            self.len += 1;
        }
    }

    fn add_shear(&mut self, shear: &ShearState<f64>, arc: f64, detail: Detail) {
        let stretches = shear.monotone_stretches(arc);
        // Across, displacement grows in proportion to the arc.
        if shear.sideways {
            let per_arc = shear.across(1.0).abs();
            let k = if shear.law.is_independent() {
                shear.k_side
            } else {
                shear.k_shear
            };
            for level in detail.levels() {
                self.push_inside(level * k / per_arc, arc);
            }
        }
        for &(from, to) in stretches.as_slice() {
            self.push_inside(from, arc);
            let (j_from, j_to) = (shear.along(from.next_up()), shear.along(to));
            let mut add = |j: f64, close: f64| {
                if (j_from < j && j < j_to) || (j_to < j && j < j_from) {
                    let off = |w: f64| shear.along(w) - j;
                    let ends = [from.next_up(), to].map(|w| (w, off(w)));
                    self.push_inside(crossing(off, ends, (close, EXACT_RAD)), arc);
                }
            };
            // there the stress changes its sign
            add(0.0, 0.0);
            let close = match detail {
                Detail::Standard => LEVEL_CLOSE,
                Detail::Fine | Detail::Finer => 0.0,
            };
            for level in detail.levels() {
                let j = level * shear.k_shear;
                add(j, close * j);
                add(-j, close * j);
            }
        }
    }

    fn push_inside(&mut self, w: f64, arc: f64) {
        if w > 0.0 && w < arc {
            self.push(w);
        }
    }
}

/// Up to five stretches of the arc on each of which j only grows or only falls.
#[derive(Clone, Copy)]
pub(crate) struct Stretches {
    ranges: [(f64, f64); 6],
    len: usize,
}

impl Stretches {
    pub(crate) fn as_slice(&self) -> &[(f64, f64)] {
        &self.ranges[..self.len]
    }
}

impl<R: Scalar> ShearState<R> {
    /// The same state in plain numbers: the cuts depend on the point, not on its derivatives.
    pub(crate) fn values(&self) -> ShearState<f64> {
        ShearState {
            law: self.law,
            displacement: crate::shear::Displacement {
                theta_1: self.displacement.theta_1.value(),
                q: self.displacement.q.value(),
                one_minus_q: self.displacement.one_minus_q.value(),
            },
            radius: self.radius.value(),
            k_shear: self.k_shear.value(),
            k_side: self.k_side.value(),
            q_y: self.q_y.value(),
            locked: self.locked,
            sideways: self.sideways,
            restart: self.restart.map(|restart| Restart {
                arc: restart.arc.value(),
                displacement: restart.displacement.value(),
                front: restart.front.map(Scalar::value),
            }),
            lugs: self.lugs.value(),
        }
    }

    /// Can the stress change its sign (or turn) between entry and exit? j is stationary where
    /// cos θ = 1/q, so for q ≤ 1 it never turns, and for q cos θ > 1 all over the arc neither.
    pub(crate) fn is_one_signed(&self, arc: R) -> bool {
        if self.locked {
            return true;
        }
        let state = self.values();
        let arc = arc.value();
        state.monotone_stretches(arc).as_slice().len() <= 1
    }

    /// Does j change its sign between entry and exit?
    pub(crate) fn reverses(&self, arc: R) -> bool {
        if self.locked {
            return false;
        }
        let state = self.values();
        let (mut some_forwards, mut some_backwards) = (false, false);
        for &(_, to) in state.monotone_stretches(arc.value()).as_slice() {
            let j = state.along(to);
            some_forwards |= j > 0.0;
            some_backwards |= j < 0.0;
        }
        some_forwards && some_backwards
    }

    /// Does the stress turn too sharply along the contact for a fixed rule? With |q_y| small against some
    /// of 1 − q cos θ and not against all of it, the direction swings within a part of the arc that no
    /// level of displacement shows.
    pub(crate) fn swings(&self, arc: R) -> bool {
        if self.law.is_regular() && self.locked {
            return true;
        }
        let turns = (self.sideways && !self.locked) || self.law.is_regular();
        if self.law.is_independent() || !turns {
            return false;
        }
        !self.values().speeds_are_steady(arc.value())
    }

    /// How fast the shear grows along the contact, in multiples of K over its whole arc if it went on
    /// at its fastest: r·arc·max|1 − q cos θ|/K, both directions together. At small slip max|j|/K is far
    /// less and would promise too much, since j then grows near the entry and hardly any more behind.
    pub(crate) fn stiffness(&self, arc: R) -> f64 {
        let state = self.values();
        let arc = arc.value();
        let (least, most) = state.slope_range(arc);
        let fastest = least.abs().max(most.abs());
        let along = state.radius * arc * fastest;
        Real::hypot(along, state.across(arc)) / state.k_shear.min(state.k_side)
    }
}

impl ShearState<f64> {
    /// Do the slip speeds of the arc keep their sense, or turn little beside the drift?
    pub(crate) fn speeds_are_steady(&self, arc: f64) -> bool {
        let (least, most) = self.slope_range(arc);
        // a direction that is that of the slip speed turns with all of it, one of displacements with its mean
        let share = if self.law.is_by_slip_velocity() {
            0.5
        } else {
            0.25
        };
        let steady = least > share * most || most < share * least;
        let across = self.q_y.abs() > 2.0 * least.abs().max(most.abs());
        across || steady
    }

    /// The least and the greatest of 1 − q cos θ over the arc, with lugs: at its ends or at θ = 0.
    fn slope_range(&self, arc: f64) -> (f64, f64) {
        let bottom = self.displacement.theta_1.min(arc);
        let slopes = [0.0, bottom, arc].map(|w| self.with_lugs(self.displacement.slope(w)));
        slopes
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), slope| {
                (low.min(slope), high.max(slope))
            })
    }

    /// The arc cut where d j/dθ = 0, at θ = ±acos(1/q), and where j starts anew.
    pub(crate) fn monotone_stretches(&self, arc: f64) -> Stretches {
        let theta_1 = self.displacement.theta_1;
        let mut cuts = [arc; 5];
        if self.displacement.q > 1.0 {
            let turn = Real::acos(1.0 / self.displacement.q);
            cuts[0] = theta_1 - turn;
            cuts[1] = theta_1 + turn;
        }
        if let Some(restart) = self.restart {
            cuts[2] = restart.arc;
            if let Some(front) = restart.front {
                // dj/dw = 1 + K_v q − q cos θ = 0
                let cosine = (1.0 + front) / self.displacement.q;
                cuts[3] = theta_1 - Real::acos(cosine.clamp(-1.0, 1.0));
            }
        }
        cuts.sort_unstable_by(f64::total_cmp);
        let mut stretches = Stretches {
            ranges: [(0.0, 0.0); 6],
            len: 0,
        };
        let mut from = 0.0;
        for to in cuts {
            let to = to.min(arc);
            if to > from {
                stretches.ranges[stretches.len] = (from, to);
                stretches.len += 1;
                from = to;
            }
        }
        stretches
    }
}

#[cfg(test)]
mod tests;
