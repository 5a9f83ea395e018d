//! What `estimate` found, as a list of fields.

use super::reservations::reservations;
use super::row_watch::WheelRows;
use super::truth;
use crate::soil_text;
use grouser_doctor::{Mistake, ReferenceDelay, StartOutcome, TurnCheck};
use grouser_log::{Log, UsedTopic};
use grouser_replay::{
    AlongSummary, EventAt, FusedSummary, Odometry, SoilReading, Spread, Summary, TruthError,
    WheelSummary, YawSummary,
};
use grouser_report::{Fields, fields};
use grouser_slip::Reference;
use grouser_slip::detect::Event;

/// All that was found.
#[derive(Clone, Copy)]
pub(super) struct Found<'a> {
    pub(super) summary: &'a Summary,
    pub(super) log: &'a Log,
    pub(super) readings: &'a [SoilReading],
    /// One per wheel.
    pub(super) rows: &'a [WheelRows],
    /// With `--check`.
    pub(super) start: Option<StartOutcome>,
    pub(super) errors: Option<&'a [TruthError]>,
}

/// A part of the summary with the whole, which has the names of the wheels.
#[derive(Clone, Copy)]
struct Part<'a, P> {
    of: &'a Summary,
    part: &'a P,
}

impl<'a> Part<'a, Summary> {
    fn with<P>(summary: &'a Summary, part: Option<&'a P>) -> Option<Part<'a, P>> {
        part.map(|part| Part { of: summary, part })
    }
}

impl<P> Part<'_, P> {
    fn wheel(&self, index: Option<usize>) -> Option<String> {
        Some(self.of.wheels.get(index?)?.name.clone())
    }
}

/// Errors that look like slip, with what measures the robot's motion.
pub(super) fn not_observable(reference: Reference) -> &'static str {
    match reference {
        Reference::Grip => {
            "no sensor measures the robot's motion: a slip common to all wheels is not observable"
        }
        Reference::FreeWheel => {
            "not observable: a constant scale error of the free wheel (counts, radius, skid) or of all powered \
             wheels, or exchanged counters: they look like slip"
        }
        _ => {
            "not observable: a constant scale error of the reference or of all powered wheels, or exchanged counters: \
             they look like slip"
        }
    }
}

pub(super) fn fields<'a>() -> Fields<'a, Found<'a>> {
    let shown = |path: &std::path::Path| path.display().to_string();
    fields! { |found: Found<'a>|
        "status" "how the job ended" = found.summary.status.name();
        "reference" "what measures the speed over ground" = found.summary.reference.name();
        "wheel_sensor" "what measures the wheels" = found.summary.wheel_sensor;
        "duration_s" "length of the log" = found.summary.duration_s;
        "longest_gap_s" "longest time between two samples" = found.summary.longest_gap_s;
        "wheels" "each wheel" named(wheel()) =
            found.summary.wheels.iter().zip(found.rows).map(move |(wheel, rows)| (wheel.name.as_str(), (wheel, rows, found.readings)));
        "along" "slip along the track" group(along()) = &found.summary.along;
        "yaw" "turn by the wheels compared with the turn as measured" group(yaw()) =
            Part::with(found.summary, found.summary.yaw.as_ref());
        "exchanged" "wheels whose encoders are exchanged between the sides" = exchanged(found.summary);
        "axes" "angles of sensors from the direction in which the wheels drive" group(axes()) = found.summary;
        "reference_delay" "delay of the reference's stamps to wheels and gyro; null where it is not observable"
            group(reference_delay()) = found.summary.reference_delay;
        "ground_changes_s" "times of ground changes, from torques or motor currents" =
            found.summary.ground_changes_s.clone();
        "not_observable" "errors that look like slip and that this log cannot show" =
            not_observable(found.summary.reference);
        "doubts" "why the result is uncertain" = doubts(found);
        "reservations" "what restricts parts of the result, or one wheel" = reservations(found);
        "odometry" "odometry" group(odometry()) = found.summary.odometry.as_ref();
        "soil" "what was learnt of the soil; null without `--learn-soil`" group(soil_text::soil()) =
            found.summary.soil.as_ref();
        "filter" "the filter's checks and events" group(filter()) = Part::with(found.summary, Some(&found.summary.fused));
        "truth" "errors compared with the true slips" rows(truth_errors()) = found.errors.unwrap_or_default().iter();
        "rejected" "samples that were rejected" group(rejected()) = found.summary;
        "files" "files that were read" = found.log.files().map(shown).collect::<Vec<_>>();
        "unused_files" "files that fit no table of the column map" =
            found.log.unused().iter().map(|path| shown(path)).collect::<Vec<_>>();
        "topics" "topics that were used of bags and MCAP files" rows(topic()) =
            found.log.topics().map(move |used| (used, found.summary.reference));
        "notes" "remarks about the log" = found.log.notes().to_vec();
        "left_out" "what was left out" group(left_out()) = found.log;
        "start_check" "whether units, signs and axes of the sensors agree" group(start_check()).optional() = found.start;
    }
}

/// Why the result, or the comparison with true slips, is doubtful.
pub(super) fn doubts(found: Found<'_>) -> Vec<String> {
    let of_result = found.summary.doubts().into_iter();
    let of_truth = truth::doubts(found.errors.unwrap_or_default());
    of_result
        .map(|doubt| doubt.to_string())
        .chain(of_truth)
        .collect()
}

fn wheel<'a>() -> Fields<'a, (&'a WheelSummary, &'a WheelRows, &'a [SoilReading])> {
    fields! { |of: (&'a WheelSummary, &'a WheelRows, &'a [SoilReading])|
        join(spread()) = &of.0.slip;
        "states" "share of the time in each motion" values = Some(of.0.states.iter().copied());
        "healths" "share of the time in each health" values =
            Some(of.0.healths.iter().map(|(name, share)| (name.as_str(), *share)));
        "healths_moving" "share of the time in which it moves in each health" values =
            Some(of.1.healths_moving().map(|(health, share)| (health.to_string(), share)));
        "inconsistent_s" "begin and end of the longest span in which it contradicts the others; null if none" =
            of.1.inconsistent_s().map(|span| span.to_vec());
        "period_s" "median time between its readings" = of.1.period_s();
        "side_slip_angle_deg" "side slip angle" group(angle()) = &of.0.side_slip_angle;
        "is_reference" "whether it measures the speed over ground for the others" = of.0.is_reference;
        "soil" "the wheel at its median slip and load on the soil" group(soil()) =
            of.2.iter().find(|reading| reading.wheel == of.0.name);
    }
}

/// The errors of one wheel against its truth.
pub(super) fn truth_errors<'a>() -> Fields<'a, &'a TruthError> {
    fields! { |of: &'a TruthError|
        "wheel" "the wheel" = of.wheel.as_str();
        "count" "estimates with a truth" = of.count;
        "estimates" "estimates, with a truth or without" = of.estimates;
        "rmse" "root of the mean squared error" = of.rmse;
        "bias" "mean error" = of.bias;
        "nees" "mean of the squared error over its variance" = of.nees;
        "coverage_90" "share of the 90 % intervals that hold the truth" = of.coverage_90;
        "lag_s" "how much later the estimate is; null where it is not observable within 1 s" = of.lag_s;
    }
}

fn spread<'a>() -> Fields<'a, &'a Spread> {
    fields! { |slip: &'a Spread|
        "median" "median" = slip.median;
        "p5" "5th percentile" = slip.p5;
        "p95" "95th percentile" = slip.p95;
    }
}

fn angle<'a>() -> Fields<'a, &'a Spread> {
    fields! { |angle: &'a Spread|
        "median" "median" = angle.median.map(f64::to_degrees);
        "p5" "5th percentile" = angle.p5.map(f64::to_degrees);
        "p95" "95th percentile" = angle.p95.map(f64::to_degrees);
    }
}

fn along<'a>() -> Fields<'a, &'a AlongSummary> {
    fields! { |along: &'a AlongSummary|
        join(spread()) = &along.slip;
        "overall" "slip over the total distance" = along.overall;
        "overall_90" "its 90 % interval; null online" = along.overall_90.map(Vec::from);
        "travel_wheels_m" "distance by the wheels, forwards and backwards added up" = along.travel_wheels;
        "travel_reference_m" "distance over ground in the direction in which the wheels ran" = along.travel_reference;
        "travel_reference_m_90" "its 90 % interval; null online" = along.travel_reference_90.map(Vec::from);
    }
}

fn yaw<'a>() -> Fields<'a, Part<'a, YawSummary>> {
    fields! { |yaw: Part<'a, YawSummary>|
        "residual_median_rad" "median difference" = yaw.part.residual.median;
        "residual_p5_rad" "its 5th percentile" = yaw.part.residual.p5;
        "residual_p95_rad" "its 95th percentile" = yaw.part.residual.p95;
        "clock_offset_s" "how far the gyro's clock runs ahead" = yaw.of.clock_offset_s;
        "apart" "whether wheels and gyro disagree" group(apart()) = Part::with(yaw.of, yaw.of.findings.turns.as_ref());
    }
}

fn apart<'a>() -> Fields<'a, Part<'a, TurnCheck>> {
    fields! { |turns: Part<'a, TurnCheck>|
        "first_motion_s" "when the robot first drove" = turns.part.first_motion_s;
        "alarm_s" "when wheels and gyro first disagreed" = turns.part.alarm_s;
        "alarms" "alarms" = turns.part.alarms;
        "wheel" "the wheel that slips" = turns.wheel(turns.part.wheel);
        "says" "the cause" = cause(turns.part, turns.of);
        "log_likelihood_ratio" "log likelihood ratio of that cause to the next" = turns.part.likelier;
    }
}

/// The names of the wheels whose encoders are exchanged.
pub(super) fn exchanged(summary: &Summary) -> Vec<String> {
    let exchanged = summary.findings.mistakes.iter().find_map(|of| match of {
        Mistake::Exchanged { wheels, .. } => Some(*wheels),
        _ => None,
    });
    let mask = exchanged.unwrap_or(0);
    let wheels = summary.wheels.iter().enumerate();
    let wheels = wheels.filter(|(index, _)| mask >> index & 1 == 1);
    wheels.map(|(_, wheel)| wheel.name.clone()).collect()
}

/// The wheel that slips, or that none can be named.
pub(super) fn cause(turns: &TurnCheck, summary: &Summary) -> String {
    let name = turns.wheel.and_then(|wheel| summary.wheels.get(wheel));
    name.map_or_else(
        || "left or right: not observable".to_owned(),
        |wheel| wheel.name.clone(),
    )
}

fn axes<'a>() -> Fields<'a, &'a Summary> {
    fields! { |summary: &'a Summary|
        "reference_deg" "of the reference; null where it agrees" = summary.findings.axes.reference.map(f64::to_degrees);
        "acceleration_deg" "of the accelerations; null where they agree" =
            summary.findings.axes.acceleration.map(f64::to_degrees);
    }
}

pub(super) fn reference_delay<'a>() -> Fields<'a, ReferenceDelay> {
    fields! { |delay: ReferenceDelay|
        "delay_s" "the delay; negative where wheels and gyro are late" = delay.delay_s;
        "half_width_s" "half of its 95 % interval" = delay.half_width_s;
        "stated_s" "what the robot file states; 0 where it states none" = delay.stated_s;
        "is_clear" "whether it differs from what is stated" = delay.is_clear;
        "is_applied" "whether the slips are estimated with it" = delay.is_applied;
    }
}

fn odometry<'a>() -> Fields<'a, &'a Odometry> {
    fn sigma(odometry: &Odometry, axis: usize) -> f64 {
        odometry.pose_covariance[axis][axis].max(0.0).sqrt()
    }
    fields! { |odometry: &'a Odometry|
        "x_m" "place at the end, along the first heading" = odometry.pose[0];
        "y_m" "place at the end, to the left of it" = odometry.pose[1];
        "yaw_rad" "heading at the end" = odometry.pose[2];
        "x_sigma_m" "standard deviation of x_m" = sigma(odometry, 0);
        "y_sigma_m" "standard deviation of y_m" = sigma(odometry, 1);
        "yaw_sigma_rad" "standard deviation of yaw_rad" = sigma(odometry, 2);
        "distance_m" "distance driven" = odometry.distance;
        "distance_without_compensation_m" "distance by the wheels, without slip compensation" = odometry.distance_of_wheels;
    }
}

fn filter<'a>() -> Fields<'a, Part<'a, FusedSummary>> {
    fields! { |filter: Part<'a, FusedSummary>|
        "offline" "whether every slip uses the whole log, not only the log before it" = filter.part.is_offline;
        "reference_readings" "readings of the reference" = filter.part.reference.map(|of| of.readings);
        "reference_used" "how many of them changed the filter's state" = filter.part.reference.map(|of| of.used);
        "way_slip" "slip over the total distance by the filter" = filter.part.ways.slip_by_filter();
        "way_slip_of_reference" "the same by the reference alone" = filter.part.ways.slip_by_reference();
        "dropped" "samples that are missing" = filter.part.dropped;
        "clock_steps" "clocks that were set" = filter.part.clock_steps;
        "events" "events" rows(event()) =
            filter.part.events.iter().map(move |part| Part { of: filter.of, part });
        "more_events" "events that are not listed" = filter.part.more_events;
    }
}

fn event<'a>() -> Fields<'a, Part<'a, EventAt>> {
    fields! { |at: Part<'a, EventAt>|
        "time_s" "time" = at.part.time_s;
        "event" "event" = event_name(at.part.change.event).0;
        "wheel" "wheel; null for the whole robot" = at.wheel(event_name(at.part.change.event).1);
        "begins" "whether it begins or ends" = at.part.change.begins;
    }
}

/// An event's name in files, and its wheel.
pub(super) const fn event_name(event: Event) -> (&'static str, Option<usize>) {
    match event {
        Event::HighSlip { wheel } => ("high slip", Some(wheel)),
        Event::Stall { wheel } => ("stall", Some(wheel)),
        Event::LiftOff { wheel } => ("lift-off", Some(wheel)),
        Event::DigIn => ("dig-in", None),
        Event::Immobilised => ("immobilised", None),
    }
}

fn rejected<'a>() -> Fields<'a, &'a Summary> {
    fields! { |summary: &'a Summary|
        "bad_value" "samples with an impossible value" = summary.rejected.bad_value;
        "not_later" "samples that are not later than the one before" = summary.rejected.not_later;
        "jump" "samples that jump" = summary.rejected.jump;
        "unknown" "samples of an unknown sensor" = summary.rejected.unknown;
    }
}

fn start_check<'a>() -> Fields<'a, StartOutcome> {
    fields! { |start: StartOutcome|
        "status" "`plausible`, `incomplete` or `implausible`" = match start {
            StartOutcome::Plausible => "plausible",
            StartOutcome::Implausible { .. } | StartOutcome::Contradicted(_) => "implausible",
            _ => "incomplete",
        };
        "message" "what disagrees" = match start {
            StartOutcome::Implausible { fault, .. } => Some(fault.to_string()),
            StartOutcome::Contradicted(doubt) => Some(doubt.to_string()),
            _ => None,
        };
        "time_s" "when that was certain" = match start {
            StartOutcome::Implausible { time_s, .. } => Some(time_s),
            _ => None,
        };
    }
}

/// A topic, and the reference of the estimate.
fn topic<'a>() -> Fields<'a, (UsedTopic, Reference)> {
    fields! { |of: (UsedTopic, Reference)|
        "topic" "topic" = of.0.topic;
        "type" "type" = of.0.type_name;
        "used_for" "what it is used for" = of.0.used_for;
        "is_other_reference" "whether it measures the motion of the robot but is not the reference in use" =
            is_other_reference(&of.0, of.1);
    }
}

/// Does a topic measure the robot's motion without being the reference in use?
pub(super) fn is_other_reference(used: &UsedTopic, reference: Reference) -> bool {
    !used.references.is_empty() && !used.references.contains(&reference)
}

fn left_out<'a>() -> Fields<'a, &'a Log> {
    fields! { |log: &'a Log|
        "damages" "damaged places" = log.left_out().damages;
        "bytes_lost" "bytes that are lost" = log.left_out().bytes_lost;
        "undecoded" "messages that could not be decoded, and rows of tables whose time is garbled" = log.left_out().undecoded;
        "late" "messages that came too late for the order of time" = log.left_out().late;
        "zero_poses" "poses of zeros in rows of tables whose logger had no new one" = log.left_out().zero_poses;
        "cut_off" "last lines of tables that are cut off" = log.left_out().cut_off.iter().map(ToString::to_string).collect::<Vec<_>>();
    }
}

/// A wheel at its median slip and load on the soil.
pub(super) fn soil<'a>() -> Fields<'a, &'a SoilReading> {
    fields! { |reading: &'a SoilReading|
        "slip" "slip" .shown("").decimals(3) = reading.slip;
        "load_n" "load" .shown("N") = reading.load;
        "sinkage_m" "sinkage" .shown("mm") = reading.sinkage;
        "drawbar_pull_n" "pull" .shown("N") = reading.drawbar_pull;
        "torque_nm" "torque" .shown("N m") = reading.torque;
        "tractive_efficiency" "efficiency" .shown("").decimals(3) = reading.efficiency;
        "slip_of_best_efficiency" "best slip" .shown("").decimals(3) = reading.best_slip;
        "best_efficiency" "efficiency at the best slip" = reading.best_efficiency;
        "slip_above_best" "slip minus best slip" .shown("").label("minus best").decimals(3) = reading.above_best;
        "slip_with_reference_skid" "slip if the reference skids" .shown("").label("slip with skid").decimals(3) = reading.slip_with_skid;
        "cautions" "cautions" = reading.cautions.clone();
    }
}
