//! What `optimize` found, as a list of fields: every key, `null` where it does not apply.

use grouser_design::{Answer, Compromise, Design, Optimum, Start, Trade};
use grouser_opt::{Counts, Kkt, Status};
use grouser_report::{Fields, fields};

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
        let objectives = self.design.objectives.iter().zip(&self.part.objectives);
        objectives
            .map(|(objective, f)| if objective.absolute { f.abs() } else { *f })
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

pub(super) fn fields<'a>() -> Fields<'a, Solved<'a>> {
    fields! { |solved: Solved<'a>|
        "method" "the task" = solved.design.task.name();
        "status" "how the solve ended" = solved.status();
        "x" "the variables; of a front those of its knee" values =
            solved.of(|o| variables(solved.design, &o.x), |p| Some(variables(p.design, &p.part.x)));
        "objectives" "the objectives there, without scaling" values =
            solved.of(|o| o.objectives.clone(), |p| Some(objectives(p.design, &p.part.objectives)));
        "max" "the greatest objective" = solved.of(|o| o.maximum, |p| Some(p.maximum()));
        "utility" "what was minimised" = solved.optimum().map(|o| o.utility);
        "attainment" "attainment factor" = solved.optimum().and_then(|o| o.attainment);
        "objective_multipliers" "local trade-off between the objectives" values =
            solved.of(|o| o.objective_multipliers.clone(), |p| p.multipliers());
        "constraint_multipliers" "cost of each constraint" values =
            solved.optimum().map(|o| o.constraint_multipliers.clone());
        "bound_multipliers" "cost of the bounds of each variable" maybe_named(bounds()) = solved.bound_multipliers();
        "active" "constraints and bounds that hold the point" = solved.optimum().map(|o| o.active.clone());
        "violated" "constraints that no point meets, and by how much" values = solved.violated();
        "kkt" "how well the optimality conditions hold" group(kkt()) = solved.optimum().map(|o| &o.kkt);
        "iterations" "iterations" = solved.counts().iterations;
        "values" "evaluations" = solved.counts().values;
        "jacobians" "evaluations with derivatives" = solved.counts().jacobians;
        "starts" "every start" rows(start()) = solved.starts();
        "optima" "the different optima, best first" rows(reached()) =
            solved.optimum().map_or(&[][..], |o| &o.optima).iter().copied();
        "front" "the points of a front" maybe_rows(compromise()) = solved.front();
        "certificate" "what is proved about the best point, with --certify" group(certificate()) = solved.certified;
        "knee" "place of the knee in the front" = solved.trade().and_then(|trade| trade.knee);
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
        "stationarity" "greatest component of the Lagrangian's gradient" = kkt.stationarity;
        "gradient_scale" "greatest gradient of an objective" = kkt.gradient_scale;
        "complementarity" "greatest multiplier times distance" = kkt.complementarity;
        "violation" "greatest violation" = kkt.violation;
    }
}

fn certificate<'a>() -> Fields<'a, &'a Certified> {
    fields! { |certified: &'a Certified|
        "status" "how the search for a proof ended" = certified.certificate.status.name();
        "lower" "no feasible point has a lower utility" = finite(certified.certificate.lower);
        "upper" "the utility of the best point, rounded up" = finite(certified.certificate.upper);
        "gap" "upper - lower" = finite(certified.certificate.gap());
        "violation" "by how much the best point violates a constraint at most" = certified.certificate.violation;
        "remainder" "share of a force that the rule of integration may leave out: measured, not proved" =
            certified.remainder;
        "boxes" "boxes examined" = certified.certificate.boxes;
        "seconds" "time taken, s" = certified.certificate.seconds;
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn start<'a>() -> Fields<'a, Part<'a, Start>> {
    fields! { |start: Part<'a, Start>|
        "x" "where it ended" values = Some(variables(start.design, &start.part.x));
        "max" "the greatest objective there" = start.part.maximum;
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
