//! What `optimize` found, as a list of fields: every key, `null` where it does not apply.

use grouser_design::{Answer, Compromise, Design, FrontProof, Optimum, Start, Trade};
use grouser_opt::{Certificate, Counts, Kkt, Status};
use grouser_report::{Fields, fields};
use grouser_terra::Caution;

use super::certificate::Certified;

/// Values by name.
type Named = Vec<(String, f64)>;

/// A problem and its answer.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    pub(super) design: &'a Design,
    pub(super) answer: &'a Answer,
    pub(super) certified: Option<&'a Certified>,
}

/// A part of the answer beside the problem, which has the names.
#[derive(Clone, Copy)]
struct Part<'a, P> {
    design: &'a Design,
    part: &'a P,
}

impl<'a> Solved<'a> {
    fn part<P>(self, part: &'a P) -> Part<'a, P> {
        Part {
            design: self.design,
            part,
        }
    }

    fn optimum(self) -> Option<&'a Optimum> {
        match self.answer {
            Answer::Optimum(optimum) => Some(optimum),
            _ => None,
        }
    }

    fn trade(self) -> Option<&'a Trade> {
        match self.answer {
            Answer::Trade(trade) => Some(trade),
            _ => None,
        }
    }

    /// The point that stands for a front: its knee.
    fn knee(self) -> Option<Part<'a, Compromise>> {
        let trade = self.trade()?;
        Some(self.part(trade.points.get(trade.knee?)?))
    }

    fn status(self) -> &'static str {
        match (self.optimum(), self.trade()) {
            (Some(optimum), _) => optimum.status.name(),
            (_, Some(trade)) if !trade.points.is_empty() => "converged",
            _ => "no_feasible_point",
        }
    }

    /// A value of the optimum, else of the knee.
    fn of<V>(
        self,
        optimum: impl Fn(&'a Optimum) -> V,
        knee: impl Fn(Part<'a, Compromise>) -> Option<V>,
    ) -> Option<V> {
        self.optimum().map(optimum).or_else(|| knee(self.knee()?))
    }

    fn counts(self) -> Counts {
        let optimum = self.optimum().map(|optimum| optimum.counts);
        let counts = optimum.or_else(|| Some(self.trade()?.counts));
        counts.unwrap_or_default()
    }

    fn starts(self) -> impl Iterator<Item = Part<'a, Start>> {
        let starts = self.optimum().map_or(&[][..], |optimum| &optimum.starts);
        starts.iter().map(move |start| self.part(start))
    }

    fn front(self) -> Option<Vec<Part<'a, Compromise>>> {
        Some(
            self.trade()?
                .points
                .iter()
                .map(|point| self.part(point))
                .collect(),
        )
    }

    fn violated(self) -> Option<Named> {
        match &self.optimum()?.status {
            Status::NoFeasiblePoint(list) => {
                Some(list.iter().map(|v| (v.name.clone(), v.amount)).collect())
            }
            _ => None,
        }
    }

    fn bound_multipliers(self) -> Option<Vec<(String, (f64, f64))>> {
        let multipliers = self.optimum()?.bound_multipliers.iter().copied();
        let names = self
            .design
            .variables
            .iter()
            .map(|variable| variable.name.clone());
        Some(names.zip(multipliers).collect())
    }
}

fn variables(design: &Design, x: &[f64]) -> Named {
    let names = design
        .variables
        .iter()
        .map(|variable| variable.name.clone());
    names.zip(x.iter().copied()).collect()
}

fn objectives(design: &Design, values: &[f64]) -> Named {
    let names = design
        .objectives
        .iter()
        .map(|objective| objective.name.clone());
    names.zip(values.iter().copied()).collect()
}

impl Part<'_, Compromise> {
    fn multipliers(&self) -> Option<Named> {
        Some(objectives(self.design, self.part.multipliers.as_ref()?))
    }

    fn maximum(&self) -> f64 {
        self.design.deciding(&self.part.objectives)
    }
}

pub(super) fn fields<'a>() -> Fields<'a, Solved<'a>> {
    fields! { |solved: Solved<'a>|
        "method" "the task" = solved.design.task.name();
        "status" "how the solve ended" = solved.status();
        "x" "the variables; of a front those of its best trade-off (knee point)" values =
            solved.of(|o| variables(solved.design, &o.x), |p| Some(variables(p.design, &p.part.x)));
        "cautions" "cautions about the wheel there" =
            solved.of(|o| keys(solved.design, &o.x), |p| Some(keys(p.design, &p.part.x)));
        "objectives" "the objectives there, without scaling" values =
            solved.of(|o| o.objectives.clone(), |p| Some(objectives(p.design, &p.part.objectives)));
        "max" "the worst objective, without its scale; where all are maximised, the minimum" =
            solved.of(|o| o.maximum, |p| Some(p.maximum()));
        "deciding" "its name" = solved.optimum().map(|o| o.deciding.as_str());
        "utility" "what was minimised" = solved.optimum().map(|o| o.utility);
        "attainment" "attainment factor" = solved.optimum().and_then(|o| o.attainment);
        "objective_multipliers" "local trade-off between the objectives" values =
            solved.of(|o| o.objective_multipliers.clone(), |p| p.multipliers());
        "constraint_multipliers" "cost of each constraint" values =
            solved.optimum().map(|o| o.constraint_multipliers.clone());
        "bound_multipliers" "cost of the bounds of each variable" maybe_named(bounds()) = solved.bound_multipliers();
        "active" "active constraints and bounds" = solved.optimum().map(|o| o.active.clone());
        "violated" "constraints that no point meets, and by how much" values = solved.violated();
        "kkt" "how well the optimality conditions hold" group(kkt()) = solved.optimum().map(|o| &o.kkt);
        "iterations" "iterations" = solved.counts().iterations;
        "values" "evaluations" = solved.counts().values;
        "jacobians" "evaluations with derivatives" = solved.counts().jacobians;
        "starts" "every start" rows(start()) = solved.starts();
        "optima" "the different optima, best first" rows(reached()) =
            solved.optimum().map_or(&[][..], |o| &o.optima).iter().copied();
        "front" "the points of a front" maybe_rows(compromise()) = solved.front();
        "certificate" "what is proved about the best point, with --certify" group(certificate()) =
            solved.certified.and_then(|certified| Some((certified, certified.certificate()?)));
        "front_certificate" "what is proved about a front of two objectives, with --certify" group(front_certificate()) =
            solved.certified.and_then(|certified| Some((solved.design, certified, certified.front()?)));
        "knee" "index of the best trade-off (knee point) in the front" = solved.trade().and_then(|trade| trade.knee);
    }
}

fn bounds<'a>() -> Fields<'a, (f64, f64)> {
    fields! { |cost: (f64, f64)|
        "lower" "of the lower bound" = cost.0;
        "upper" "of the upper bound" = cost.1;
    }
}

fn kkt<'a>() -> Fields<'a, &'a Kkt> {
    fields! { |kkt: &'a Kkt|
        "stationarity" "maximum component of the Lagrangian's gradient" = kkt.stationarity;
        "gradient_scale" "maximum gradient of an objective" = kkt.gradient_scale;
        "complementarity" "maximum of multiplier times distance" = kkt.complementarity;
        "violation" "maximum violation" = kkt.violation;
    }
}

/// The keys of the cautions at a point.
fn keys(design: &Design, x: &[f64]) -> Vec<&'static str> {
    design.cautions(x).iter().map(Caution::key).collect()
}

fn certificate<'a>() -> Fields<'a, (&'a Certified, &'a Certificate)> {
    fields! { |of: (&'a Certified, &'a Certificate)|
        "status" "how the search for a proof ended" = of.1.status.name();
        "lower" "no feasible point has a lower utility" = finite(of.1.lower);
        "upper" "the utility of the best point, rounded up" = finite(of.1.upper);
        "gap" "upper - lower" = finite(of.1.gap());
        "violation" "by how much the best point violates a constraint at most" = of.1.violation;
        "remainder" "share of a force that the rule of integration may leave out" = of.0.remainder.map(|r| r.share);
        "remainder_is_proved" "that share is proved over the whole box; else it is measured" = of.0.remainder.map(|r| r.is_proved);
        "pull_model_error_per_load" "half of the interval about a pull that holds 90 % of measurements, over the load" = of.0.pull_error();
        "boxes" "boxes examined" = of.1.boxes;
        "seconds" "time taken, s" = of.1.seconds;
    }
}

type ProvedFront<'a> = (&'a Design, &'a Certified, &'a FrontProof);

fn front_certificate<'a>() -> Fields<'a, ProvedFront<'a>> {
    fields! { |of: ProvedFront<'a>|
        "status" "how the search for a proof ended" = of.2.status.name();
        "tolerance" "for every feasible point one of `points` is worse by at most this in each objective" values =
            Some(objectives(of.0, &of.2.tolerance)).filter(|_| of.2.share.is_finite());
        "share" "the same as a share of the ranges of the points" = finite(of.2.share);
        "points" "the points that the proof is about, none better than another" rows(compromise()) =
            of.2.points.iter().map(move |part| Part { design: of.0, part });
        "corners" "every feasible point is no better than one of these in both objectives" rows(corner()) =
            of.2.corners.iter().map(move |at| (of.0, at.as_slice()));
        "remainder" "share of a force that the rule of integration may leave out" = of.1.remainder.map(|r| r.share);
        "remainder_is_proved" "that share is proved over the whole box; else it is measured" = of.1.remainder.map(|r| r.is_proved);
        "pull_model_error_per_load" "half of the interval about a pull that holds 90 % of measurements, over the load" = of.1.pull_error();
        "proofs" "proofs by branch and bound" = of.2.proofs;
        "boxes" "boxes examined" = of.2.boxes;
        "seconds" "time taken, s" = of.2.seconds;
    }
}

fn corner<'a>() -> Fields<'a, (&'a Design, &'a [f64])> {
    fields! { |of: (&'a Design, &'a [f64])|
        "objectives" "the objectives" values = Some(objectives(of.0, of.1));
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn start<'a>() -> Fields<'a, Part<'a, Start>> {
    fields! { |start: Part<'a, Start>|
        "x" "where it ended" values = Some(variables(start.design, &start.part.x));
        "max" "the objective that decides there" = start.part.maximum;
        "utility" "what was minimised" = start.part.utility;
        "status" "how it ended" = start.part.status.name();
    }
}

fn reached<'a>() -> Fields<'a, (usize, usize)> {
    fields! { |optimum: (usize, usize)|
        "start" "the first start that led there" = optimum.0;
        "reached_by" "how many starts led there" = optimum.1;
    }
}

fn compromise<'a>() -> Fields<'a, Part<'a, Compromise>> {
    fields! { |point: Part<'a, Compromise>|
        "x" "the variables" values = Some(variables(point.design, &point.part.x));
        "objectives" "the objectives" values = Some(objectives(point.design, &point.part.objectives));
        "objective_multipliers" "local trade-off between the objectives" values = point.multipliers();
    }
}
