//! The drives of a scenario, as a list of fields.

use grouser_report::{Fields, fields};
use grouser_rover::drive::{NamedDecision, Scenario, SlipScore};

use grouser_terrain::learn::TileSummary;
use grouser_terrain::mission::PlannedDrive;

use super::comparison::{self, Comparison};
use super::run::Run;

/// The columns of a table of drives; people do not see the bias.
pub(super) const COLUMNS: [&str; 10] = [
    "controller",
    "seed",
    "outcome",
    "distance_m",
    "duration_s",
    "energy_j",
    "energy_j_per_m",
    "worst_slip",
    "slip_rmse",
    "slip_bias",
];

/// The drives and what they share.
#[derive(Clone, Copy)]
pub(super) struct Drives<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) optimum: f64,
    pub(super) seed: u64,
    pub(super) runs: &'a [Run],
}

pub(super) fn fields<'a>() -> Fields<'a, Drives<'a>> {
    fields! { |drives: Drives<'a>|
        "scenario" "name of the scenario" = drives.scenario.name.as_str();
        "title" "its title" = drives.scenario.title.as_str();
        "seed" "first seed" = drives.seed;
        "optimum_slip" "slip setpoint" = drives.optimum;
        "optimum_slip_meaning" "which optimal slip that is" = super::optimum::meaning(drives.scenario);
        "world_laws" "law of shear of the ground; null: the estimator's own" =
            drives.scenario.ground.world_laws.map(grouser_terra::ShearLaw::key);
        "comparison" "the controller compared with open loop at the same mean speed; null for one driver" group(comparison::fields()) =
            Comparison::of(drives.runs);
        "runs" "the drives" rows(run()) = drives.runs.iter().map(move |run| (drives.scenario, run));
    }
}

pub(super) fn run<'a>() -> Fields<'a, (&'a Scenario, &'a Run)> {
    fields! { |of: (&'a Scenario, &'a Run)|
        "controller" "driver" .shown("") = of.1.pilot.name();
        "seed" "seed" .shown("") = of.1.seed;
        "speed_share" "share of the requested speeds that it was driven at: 1, in open loop that with the controller's mean speed" =
            of.1.pace;
        "distance_m" "distance along the legs" .shown("m").label("distance") = of.1.result.distance;
        "way_m" "distance driven by the robot" = of.1.result.way;
        "duration_s" "duration" .shown("s").label("time") = of.1.result.duration;
        "outcome" "how the drive ended" .shown("").label("outcome") = of.1.result.outcome.name();
        "refusal" "why the drive could not begin on the ground of its seed; null where it did" = of.1.refusal.as_deref();
        "energy_j" "electrical energy" .shown("J").label("energy") = of.1.result.energy;
        "energy_j_per_m" "energy per metre" .shown("J/m").label("energy") = of.1.result.energy_per_metre();
        "energy_in_soil_j" "energy that the soil took" = of.1.result.ledger.soil;
        "actuator_energy_j" "what of the energy the actuators of the chassis drew" = of.1.result.ledger.actuators;
        "min_tip_over_margin_deg" "minimum margin against tipping over; null for a chassis without actuators" =
            of.1.result.min_tip_over_margin.map(f64::to_degrees);
        "energy_books_error" "share of the energy that the balance leaves" = of.1.result.energy_error;
        "slip_rmse" "root mean square error of the slip" .shown("").label("slip RMSE").decimals(3) = of.1.result.slip.rmse;
        "slip_rmse_without_starts" "the same without starts" = of.1.result.slip.settled;
        "slip_bias" "mean error of the slip" = of.1.result.slip.bias;
        "slip_squared_error_over_variance" "squared error over variance" = of.1.result.slip.nees;
        "slip_wrong_longest_s" "longest time that a slip was wrong" = of.1.result.slip.longest_wrong;
        "own_laws" "the slips of the same drive where the ground obeys the estimator's own laws" group(score()) =
            of.1.own_laws;
        "planned" "planned routes and learnt soil; null for a drive along legs" group(planned()) =
            of.1.planned.as_ref();
        "soil" "what was learnt of the soil; null where it is not learnt" group(crate::soil_text::soil()) =
            of.1.result.soil.as_ref();
        "worst_slip" "maximum slip" .shown("").label("maximum slip").decimals(2) = of.1.result.worst_slip;
        "deep_share" "maximum share of the time in which a loaded wheel sank by more than a sixth of its diameter" =
            of.1.result.deep_share;
        "refused_samples" "samples that the estimator rejected" = of.1.result.refused;
        "decision_count" "decisions" = of.1.result.decision_count;
        "decisions" "the first decisions" rows(decision()) =
            of.1.result.decisions.iter().map(move |named| (of.0, named));
    }
}

pub(super) fn planned<'a>() -> Fields<'a, &'a PlannedDrive> {
    fields! { |planned: &'a PlannedDrive|
        "replans" "routes planned after the first" = planned.planning.count;
        "replanning_longest_s" "longest replanning, by the wall clock" =
            planned.planning.times.iter().max().map(std::time::Duration::as_secs_f64);
        "risk" "maximum probability of immobilisation on a planned route" = planned.planning.risk;
        "risk_bound" "maximum bound on the risk that was needed to find a route" = planned.planning.bound;
        "held" "times that the robot made no progress, or found no route, and backed out" = planned.held;
        "goal_distance_m" "true distance to the goal at the end" = planned.to_goal;
        "place_error_m" "error of the robot's own place at the end" = planned.place_error;
        "learnt" "tiles with readings" rows(tile()) = planned.learnt.iter();
    }
}

pub(super) fn tile<'a>() -> Fields<'a, &'a TileSummary> {
    fields! { |tile: &'a TileSummary|
        "x_m" "centre of the tile" .shown("m").label("x") = tile.place.0;
        "y_m" "centre of the tile" .shown("m").label("y") = tile.place.1;
        "steepest_deg" "slope that the robot can climb on the soil, median" .shown("deg").label("slope") = tile.steepest.to_degrees();
        "steepest_low_deg" "lower end of its 90 % interval" .shown("deg").label("from") = tile.low.to_degrees();
        "steepest_high_deg" "upper end" .shown("deg").label("to") = tile.high.to_degrees();
        "readings" "readings" .shown("") = tile.readings;
    }
}

pub(super) fn score<'a>() -> Fields<'a, SlipScore> {
    fields! { |score: SlipScore|
        "slip_rmse" "root mean square error of the slip" .shown("").label("RMSE").decimals(3) = score.rmse;
        "slip_rmse_without_starts" "the same without starts" = score.settled;
        "slip_bias" "mean error of the slip" = score.bias;
        "slip_squared_error_over_variance" "squared error over variance" .shown("").decimals(2) = score.nees;
        "slip_wrong_longest_s" "longest time that a slip was wrong" = score.longest_wrong;
    }
}

fn decision<'a>() -> Fields<'a, (&'a Scenario, &'a NamedDecision)> {
    fields! { |of: (&'a Scenario, &'a NamedDecision)|
        "time_s" "time" = of.1.time;
        "action" "action" = of.1.decision.action.name();
        "reason" "reason" = of.1.decision.reason.name();
        "wheel" "wheel; null for the whole robot" =
            of.1.decision.wheel.and_then(|index| Some(of.0.robot.robot.wheels().get(index)?.name.as_str()));
        "value" "what was measured" = of.1.decision.value;
        "limit" "the limit that it passed" = of.1.decision.limit;
        "x_m" "place" = of.1.place.0;
        "y_m" "place" = of.1.place.1;
    }
}
