//! A plan, as a list of fields.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_report::number::shown;
use grouser_report::{Fields, Table, fields};
use grouser_terrain::plan::{Plan, PlanMap, Route, Waypoint};

/// A plan on its map.
pub(super) struct Planned<'a> {
    pub(super) map: &'a PlanMap,
    pub(super) plan: &'a Plan,
    pub(super) max_risk: f64,
}

/// A way on its map.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    map: &'a PlanMap,
    route: &'a Route,
}

impl<'a> Way<'a> {
    fn places(self) -> impl Iterator<Item = Place<'a>> {
        let place = move |point: &Waypoint| Place {
            map: self.map,
            point: *point,
        };
        self.route.waypoints.iter().map(place)
    }
}

/// A way as a table: one row a cell.
pub(super) fn csv(map: &PlanMap, route: &Route) -> String {
    place().csv(Way { map, route }.places())
}

/// A place on its map.
#[derive(Clone, Copy)]
struct Place<'a> {
    map: &'a PlanMap,
    point: Waypoint,
}

impl<'a> Planned<'a> {
    fn way(&self, route: &'a Route) -> Way<'a> {
        Way {
            map: self.map,
            route,
        }
    }

    fn route(&self) -> Option<&'a Route> {
        match self.plan {
            Plan::Found { route, .. } => Some(route),
            _ => None,
        }
    }

    fn others(&self) -> &'a [Route] {
        match self.plan {
            Plan::Found { alternatives, .. } => alternatives,
            _ => &[],
        }
    }

    fn least_risk(&self) -> Option<f64> {
        match self.plan {
            Plan::NoWay { least_risk } => *least_risk,
            _ => None,
        }
    }

    fn deciding(&self) -> Vec<(&'static str, Place<'a>)> {
        let map = self.map;
        let route = self.route();
        let places = route.into_iter().flat_map(|route| route.deciding(map));
        places
            .map(|(what, point)| (what, Place { map, point }))
            .collect()
    }

    /// What people read.
    pub(super) fn text(&self, route: &Route, alternatives: &[Route]) -> String {
        let mut out = format!(
            "route of {} J over {} m in {} s\nprobability of immobilisation at most {} in straight driving; {} turns not included\n",
            shown(route.energy),
            shown(route.length),
            shown(route.time),
            shown(route.risk),
            route.turns
        );
        if self.map.layout.draws > 0 {
            let _ = writeln!(
                out,
                "mean energy of the worst {} % of the soil draws (CVaR) at most {} J",
                shown(100.0 * (1.0 - self.map.layout.cvar_level)),
                shown(route.energy_cvar)
            );
        }
        out.push('\n');
        let mut table = Table::new()
            .text("place of")
            .number("x m")
            .number("y m")
            .number("slip")
            .number("risk")
            .number("J/m")
            .number("tip-over deg");
        for (what, Place { map, point }) in self.deciding() {
            let pose = point.cell * map.layout.headings.count() + point.heading;
            table.row([
                what.to_owned(),
                shown(point.x),
                shown(point.y),
                shown(point.slip),
                shown(point.risk),
                shown(map.energy[pose].into()),
                shown(map.tip_over[pose].into()),
            ]);
        }
        out.push_str(&table.render());
        for (index, other) in alternatives.iter().enumerate() {
            let _ = writeln!(
                out,
                "alternative {}: {} J over {} m in {} s, risk at most {}",
                index + 1,
                shown(other.energy),
                shown(other.length),
                shown(other.time),
                shown(other.risk)
            );
        }
        out
    }
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Planned<'a>> {
    fields! { |plan: &'a Planned<'a>|
        "status" "how planning ended" = if plan.route().is_some() { "found" } else { "no-way" };
        "max_risk" "bound on the probability of immobilisation" = plan.max_risk;
        "least_risk" "minimum bound that a route keeps, where none keeps the one given" = plan.least_risk();
        "soil_draws" "soil draws behind the probabilities; 0: the soil is treated as exactly known" =
            plan.map.layout.draws;
        "cvar_level" "share of the soil draws beyond which a CVaR is the mean" = plan.map.layout.cvar_level;
        "turning_radius_m" "minimum turning radius of the robot" = plan.map.layout.turning_radius;
        "route" "the route of minimum energy" group(way()) = plan.route().map(|route| plan.way(route));
        "deciding" "places of the maxima" maybe_named(place()) =
            plan.route().map(|_| plan.deciding());
        "alternatives" "alternative routes, by energy" rows(costs()) =
            plan.others().iter().map(|route| plan.way(route)).collect::<Vec<_>>();
        "map_job_sha256" "SHA-256 of all that the map was computed from" = plan.map.layout.job.as_str();
    }
}

fn costs<'a>() -> Fields<'a, Way<'a>> {
    fields! { |way: Way<'a>|
        "energy_j" "energy" = way.route.energy;
        "energy_cvar_j" "CVaR of the energy over the soil draws, at most" = way.route.energy_cvar;
        "time_s" "time" = way.route.time;
        "length_m" "length along the ground" = way.route.length;
        "risk" "probability of immobilisation anywhere on it in steady straight driving, at most" = way.route.risk;
        "tip_over_deg" "minimum tip-over margin" = way.route.tip_over_deg;
        "turns" "turns by one heading" = way.route.turns;
        "deep_share" "share of its cells in which a wheel sinks by more than a sixth of its diameter" = way.route.deep_share;
    }
}

fn way<'a>() -> Fields<'a, Way<'a>> {
    fields! { |way: Way<'a>|
        join(costs()) = way;
        "waypoints" "its cells" rows(place()) = way.places().collect::<Vec<_>>();
    }
}

fn place<'a>() -> Fields<'a, Place<'a>> {
    fields! { |place: Place<'a>|
        "x_m" "x" = place.point.x;
        "y_m" "y" = place.point.y;
        "heading_deg" "heading" = place.map.layout.headings.angle(place.point.heading).to_degrees();
        "slip" "slip" = place.point.slip;
        "risk" "probability of immobilisation, at most" = place.point.risk;
        "energy_j" "energy since the start" = place.point.energy;
        "time_s" "time since the start" = place.point.time;
        "length_m" "length since the start" = place.point.length;
    }
}
