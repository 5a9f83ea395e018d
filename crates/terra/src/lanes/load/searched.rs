//! One group's search for its sinkage: two steps by a coarse rule, and the fine rule from there.

use crate::contact::ladder::{Closeness, Step};
use crate::contact::lean::{MAX_SINKAGE_PER_RADIUS, MIN_SINKAGE_PER_RADIUS, versine};
use crate::lanes::columns::{BatchColumns, Inputs};
use crate::lanes::plan::{ABREAST, Exponents, Group, Prepared, step_of, within};
use crate::lanes::vector::Vector;
use crate::status::SolveStatus;

use super::{Found, LoadSheet, Loaded, held, secant, stiffness};

/// Where a lane may end: residual ln(W/load) times the last step in ln θ_1. The slopes were found over that
/// step, on which they change by no more than its own length, so this bounds the error of going straight.
const STRAIGHT_RESIDUAL: f64 = 2e-10;
/// Most further passes of the fine rule.
const MAX_FINE_PASSES: usize = 6;

/// A group of the chunk and the state of its search.
#[derive(Clone, Copy)]
pub(super) struct Searched<V: Vector> {
    /// Its place among those side by side.
    pub(super) place: usize,
    group: Group,
    pub(super) loaded: Loaded<V>,
    x: V,
    per_slope: V,
    /// Those of DP/W and T/(r W).
    slopes: [V; 2],
    /// The last step.
    step: V,
    found: Found<V>,
}

impl<V: Vector> Searched<V> {
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        let zero = V::ZERO;
        Self {
            place: 0,
            group: Group {
                step: Step::at(0),
                places: [0; 8],
                count: 0,
            },
            loaded: Loaded::nothing(),
            x: zero,
            per_slope: zero,
            slopes: [zero; 2],
            step: zero,
            found: Found {
                off: zero,
                pull: zero,
                turn: zero,
            },
        }
    }

    #[inline(always)]
    pub(super) fn begin(
        &mut self,
        (prepared, inputs): (&Prepared, &Inputs<'_>),
        sheet: &LoadSheet,
        group: Group,
    ) {
        let places = group.places;
        self.group = group;
        self.loaded = Loaded::<V>::gather((prepared, inputs), sheet, places);
        self.x = sheet.x.gather(places);
        self.per_slope = sheet.per_slope.gather(places);
    }

    #[inline(always)]
    fn found(
        &self,
        exponents: &mut Exponents<'_, V, ABREAST>,
        closeness: Closeness,
        x: V,
    ) -> Found<V> {
        let rules = exponents.rules(self.place, &self.loaded.n, closeness);
        match closeness {
            Closeness::Fine(_) => self.loaded.found::<false>(&rules, x),
            Closeness::First | Closeness::Coarse(_) => self.loaded.found::<true>(&rules, x),
        }
    }

    /// The first step by a coarse rule from where the coarsest ended.
    #[inline(always)]
    pub(super) fn first(&mut self, exponents: &mut Exponents<'_, V, ABREAST>) {
        self.found = self.found(exponents, Closeness::Coarse(self.group.step), self.x);
    }

    /// The second one, and the slopes that both show.
    #[inline(always)]
    pub(super) fn second(&mut self, exponents: &mut Exponents<'_, V, ABREAST>) {
        let (first, at_first) = (self.x, self.found);
        let x = held(first - at_first.off * self.per_slope);
        let found = self.found(exponents, Closeness::Coarse(self.group.step), x);
        let step = x - first;
        let known = V::from_f64(1e-10).lt(step.abs());
        let per_step = V::select(known, V::ONE / step, V::ZERO);
        let per_slope = secant(step, found.off - at_first.off, self.per_slope);
        self.per_slope = V::select(known, per_slope, self.per_slope);
        self.x = held(x - found.off * self.per_slope);
        self.slopes = [
            (found.pull - at_first.pull) * per_step,
            (found.turn - at_first.turn) * per_step,
        ];
        // a step too short for a slope counts as a long one
        self.step = V::select(known, step, V::ONE);
    }

    /// The fine rule's first evaluation.
    #[inline(always)]
    pub(super) fn fine(&mut self, exponents: &mut Exponents<'_, V, ABREAST>) {
        self.found = self.found(exponents, Closeness::Fine(self.group.step), self.x);
    }

    /// Further evaluations where they are needed, and the outcomes.
    #[inline(always)]
    pub(super) fn finish(
        &mut self,
        (inputs, exponents): (&Inputs<'_>, &mut Exponents<'_, V, ABREAST>),
        out: &mut BatchColumns<'_>,
    ) {
        for _ in 0..MAX_FINE_PASSES {
            let found = self.found;
            let open = !((found.off * self.step)
                .abs()
                .le(V::from_f64(STRAIGHT_RESIDUAL)));
            if !V::any(open) {
                break;
            }
            let next = held(self.x - found.off * self.per_slope);
            let again = self.found(exponents, Closeness::Fine(self.group.step), next);
            let dx = next - self.x;
            let per_step = V::ONE / dx;
            let slope = secant(dx, again.off - found.off, self.per_slope);
            self.per_slope = V::select(open, slope, self.per_slope);
            let slopes = [
                (again.pull - found.pull) * per_step,
                (again.turn - found.turn) * per_step,
            ];
            self.slopes = [0, 1].map(|k| V::select(open, slopes[k], self.slopes[k]));
            self.step = V::select(open, dx, self.step);
            self.x = V::select(open, next, self.x);
            self.found = Found {
                off: V::select(open, again.off, found.off),
                pull: V::select(open, again.pull, found.pull),
                turn: V::select(open, again.turn, found.turn),
            };
        }
        let Self {
            group,
            loaded,
            found,
            slopes,
            ..
        } = self;
        let dx = -found.off * self.per_slope;
        let theta_1 = (self.x + dx).exp();
        let z_over_r = versine(theta_1);
        let stiffness = stiffness(theta_1, z_over_r, loaded.q, loaded.r_over_k);
        let served = step_of(stiffness).le(step_number(group.step));
        let fits = (found.off * self.step)
            .abs()
            .le(V::from_f64(STRAIGHT_RESIDUAL))
            & found.off.abs().le(V::from_f64(1e-4))
            & within(z_over_r, MIN_SINKAGE_PER_RADIUS, MAX_SINKAGE_PER_RADIUS)
            & served;
        let fits = V::select(fits, V::ONE, V::ZERO).to_array();
        let pull = slopes[0].mul_add(dx, found.pull).to_array();
        let turn = slopes[1].mul_add(dx, found.turn).to_array();
        let z_over_r = z_over_r.to_array();
        for (k, &place) in group.places.iter().enumerate().take(group.count) {
            let place = usize::from(place);
            let (radius, load) = (inputs.radius[place], inputs.given[place]);
            if fits[k] > 0.0 {
                let numbers = [
                    z_over_r[k] * radius,
                    load,
                    pull[k] * load,
                    turn[k] * load * radius,
                ];
                out.set(place, SolveStatus::Solved, numbers);
            } else {
                out.set(place, SolveStatus::NotConverged, [f64::NAN; 4]);
            }
        }
    }
}

#[inline(always)]
fn step_number<V: Vector>(step: Step) -> V {
    V::from_f64(f64::from(u32::try_from(step.index()).unwrap_or(u32::MAX)))
}

#[cfg(test)]
mod tests;
