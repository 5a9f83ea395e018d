//! What `estimate` found, as a list of fields.

use grouser_log::{Log, UsedTopic};
use grouser_replay::{
    AlongSummary, Consistency, EventAt, FusedSummary, Odometry, SoilReading, Spread, Summary,
    TurnCheck, WheelSummary, YawSummary,
};
use grouser_report::Fields;
use grouser_slip::detect::Event;

/// All that was found.
#[derive(Clone, Copy)]
pub(super) struct Found<'a> {
    pub(super) summary: &'a Summary,
    pub(super) log: &'a Log,
    pub(super) readings: &'a [SoilReading],
}

/// A part of the summary beside the whole, which has the names of the wheels.
type Part<'a, P> = (&'a P, &'a Summary);

pub(super) fn fields<'a>() -> Fields<'a, Found<'a>> {
    let rejected = Fields::new()
        .field(
            "bad_value",
            "samples with an impossible value",
            |s: &Summary| s.rejected.bad_value,
        )
        .field(
            "not_later",
            "samples that are not later than the one before",
            |s| s.rejected.not_later,
        )
        .field("jump", "samples that jump", |s| s.rejected.jump)
        .field("unknown", "samples of an unknown sensor", |s| {
            s.rejected.unknown
        });
    let topic = Fields::new()
        .field("topic", "topic", |used: UsedTopic| used.topic)
        .field("type", "type", |used| used.type_name)
        .field("used_for", "what it is used for", |used| used.used_for);
    let left_out = Fields::new()
        .field("damages", "damaged places", |log: &'a Log| {
            log.left_out().damages
        })
        .field("bytes_lost", "bytes that are lost", |log| {
            log.left_out().bytes_lost
        })
        .field("undecoded", "messages that could not be decoded", |log| {
            log.left_out().undecoded
        })
        .field(
            "late",
            "messages that came too late for the order of time",
            |log| log.left_out().late,
        );
    let shown = |path: &std::path::Path| path.display().to_string();
    Fields::new()
        .field("status", "how the job ended", |f: Found<'a>| {
            f.summary.status.name()
        })
        .field("method", "what found the slips", |f| {
            f.summary.method.name()
        })
        .field("reference", "what measures the speed over ground", |f| {
            f.summary.reference.name()
        })
        .field("wheel_sensor", "what measures the wheels", |f| {
            f.summary.wheel_sensor
        })
        .field("duration_s", "length of the log", |f| f.summary.duration_s)
        .field("window_s", "time over which means are taken", |f| {
            f.summary.window_s
        })
        .named("wheels", "each wheel", wheel(), |f| {
            f.summary
                .wheels
                .iter()
                .map(move |wheel| (wheel.name.as_str(), (wheel, f.readings)))
        })
        .group("along", "slip along the track", along(), |f| {
            &f.summary.along
        })
        .group(
            "yaw",
            "turn by the wheels beside the turn as measured",
            yaw(),
            |f| Some((f.summary.yaw.as_ref()?, f.summary)),
        )
        .group("odometry", "odometry", odometry(), |f| {
            f.summary.odometry.as_ref()
        })
        .group("filter", "the filter's checks and events", filter(), |f| {
            Some((f.summary.fused.as_ref()?, f.summary))
        })
        .group("rejected", "samples that were rejected", rejected, |f| {
            f.summary
        })
        .field("files", "files that were read", move |f| {
            f.log.files().map(shown).collect::<Vec<_>>()
        })
        .field(
            "unused_files",
            "files that fit no table of the column map",
            move |f| {
                f.log
                    .unused()
                    .iter()
                    .map(|path| shown(path))
                    .collect::<Vec<_>>()
            },
        )
        .rows(
            "topics",
            "topics that were used of bags and MCAP files",
            topic,
            |f| f.log.topics(),
        )
        .field("notes", "remarks about the log", |f| f.log.notes().to_vec())
        .group("left_out", "what was left out", left_out, |f| f.log)
}

fn wheel<'a>() -> Fields<'a, (&'a WheelSummary, &'a [SoilReading])> {
    let angle = Fields::new()
        .field("median", "median", |angle: &Spread| {
            angle.median.map(f64::to_degrees)
        })
        .field("p5", "5th percentile", |angle| {
            angle.p5.map(f64::to_degrees)
        })
        .field("p95", "95th percentile", |angle| {
            angle.p95.map(f64::to_degrees)
        });
    Fields::new()
        .join(
            spread(),
            |(wheel, _): (&'a WheelSummary, &'a [SoilReading])| &wheel.slip,
        )
        .values(
            "states",
            "share of the time in each motion",
            |(wheel, _)| Some(wheel.states.iter().copied()),
        )
        .values(
            "healths",
            "share of the time in each health",
            |(wheel, _)| {
                Some(
                    wheel
                        .healths
                        .iter()
                        .map(|(name, share)| (name.as_str(), *share)),
                )
            },
        )
        .group(
            "side_slip_angle_deg",
            "side slip angle",
            angle,
            |(wheel, _)| &wheel.side_slip_angle,
        )
        .field(
            "is_reference",
            "whether the others are measured by it",
            |(wheel, _)| wheel.is_reference,
        )
        .group(
            "soil",
            "the wheel at its median slip and load on the soil",
            soil(),
            |(wheel, readings)| readings.iter().find(|reading| reading.wheel == wheel.name),
        )
}

/// The median and the 5th and 95th percentile of a slip.
pub(super) fn spread<'a>() -> Fields<'a, &'a Spread> {
    Fields::new()
        .field("median", "median", |slip: &Spread| slip.median)
        .field("p5", "5th percentile", |slip| slip.p5)
        .field("p95", "95th percentile", |slip| slip.p95)
}

fn along<'a>() -> Fields<'a, &'a AlongSummary> {
    Fields::new()
        .join(spread(), |along: &'a AlongSummary| &along.slip)
        .field("overall", "slip of the whole way", |along| along.overall)
        .field("travel_wheels_m", "way by the wheels", |along| {
            along.travel_wheels
        })
        .field("travel_reference_m", "way by the reference", |along| {
            along.travel_reference
        })
}

fn yaw<'a>() -> Fields<'a, Part<'a, YawSummary>> {
    let apart = Fields::new()
        .field(
            "first_motion_s",
            "when the robot first drove",
            |(turns, _): Part<'a, TurnCheck>| turns.first_motion_s,
        )
        .field(
            "alarm_s",
            "when wheels and gyro first disagreed",
            |(turns, _)| turns.alarm_s,
        )
        .field("alarms", "alarms", |(turns, _)| turns.alarms)
        .field("wheel", "the wheel that slips", |(turns, summary)| {
            turns
                .wheel
                .and_then(|wheel| summary.wheels.get(wheel))
                .map(|wheel| wheel.name.as_str())
        })
        .field("says", "the cause", |(turns, summary)| {
            cause(turns, summary)
        })
        .field(
            "log_likelihood_ratio",
            "how much likelier that cause is than the next",
            |(turns, _)| turns.likelier,
        );
    Fields::new()
        .field(
            "residual_median_rad",
            "median difference",
            |(yaw, _): Part<'a, YawSummary>| yaw.residual.median,
        )
        .field("residual_p5_rad", "its 5th percentile", |(yaw, _)| {
            yaw.residual.p5
        })
        .field("residual_p95_rad", "its 95th percentile", |(yaw, _)| {
            yaw.residual.p95
        })
        .field(
            "clock_offset_s",
            "how far the gyro's clock runs ahead",
            |(_, summary)| summary.clock_offset_s,
        )
        .group(
            "apart",
            "whether wheels and gyro disagree",
            apart,
            |(_, summary)| Some((summary.turns.as_ref()?, summary)),
        )
}

/// The wheel that slips, or that none can be named.
pub(super) fn cause(turns: &TurnCheck, summary: &Summary) -> String {
    let name = turns.wheel.and_then(|wheel| summary.wheels.get(wheel));
    name.map_or_else(
        || "left or right: not observable".to_owned(),
        |wheel| wheel.name.clone(),
    )
}

fn odometry<'a>() -> Fields<'a, &'a Odometry> {
    fn sigma(odometry: &Odometry, axis: usize) -> f64 {
        odometry.pose_covariance[axis][axis].max(0.0).sqrt()
    }
    Fields::new()
        .field(
            "x_m",
            "place at the end, along the first heading",
            |o: &Odometry| o.pose[0],
        )
        .field("y_m", "place at the end, to the left of it", |o| o.pose[1])
        .field("yaw_rad", "heading at the end", |o| o.pose[2])
        .field("x_sigma_m", "standard deviation of x_m", |o| sigma(o, 0))
        .field("y_sigma_m", "standard deviation of y_m", |o| sigma(o, 1))
        .field("yaw_sigma_rad", "standard deviation of yaw_rad", |o| {
            sigma(o, 2)
        })
        .field("distance_m", "way", |o| o.distance)
        .field(
            "distance_without_compensation_m",
            "way by the wheels alone",
            |o| o.distance_of_wheels,
        )
}

fn filter<'a>() -> Fields<'a, Part<'a, FusedSummary>> {
    let nis = Fields::new()
        .field("count", "measurements", |nis: &Consistency| nis.count)
        .field("mean", "mean normalised innovation squared", |nis| nis.mean)
        .field(
            "share_in_95_band",
            "share within the filter's 95 %",
            |nis| nis.in_band,
        );
    let event = Fields::new()
        .field("time_s", "time", |(at, _): Part<'a, EventAt>| at.time_s)
        .field("event", "event", |(at, _)| event_name(at.change.event).0)
        .field(
            "wheel",
            "wheel; null for the whole robot",
            |(at, summary)| {
                let wheel = event_name(at.change.event).1;
                wheel
                    .and_then(|wheel| summary.wheels.get(wheel))
                    .map(|wheel| wheel.name.as_str())
            },
        )
        .field("begins", "whether it begins or ends", |(at, _)| {
            at.change.begins
        });
    Fields::new()
        .field(
            "smoothed",
            "whether the log was filtered both ways",
            |(f, _): Part<'a, FusedSummary>| f.is_smoothed,
        )
        .named(
            "nis",
            "consistency of each kind of measurement",
            nis,
            |(f, _)| f.consistency.iter().map(|(kind, nis)| (*kind, nis)),
        )
        .field("dropped", "samples that are missing", |(f, _)| f.dropped)
        .field("clock_steps", "clocks that were set", |(f, _)| {
            f.clock_steps
        })
        .rows("events", "events", event, |(f, summary)| {
            f.events.iter().map(move |at| (at, summary))
        })
        .field("more_events", "events that are not listed", |(f, _)| {
            f.more_events
        })
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

/// A wheel at its median slip and load on the soil.
pub(super) fn soil<'a>() -> Fields<'a, &'a SoilReading> {
    Fields::new()
        .field("slip", "slip", |r: &SoilReading| r.slip)
        .shown("")
        .decimals(3)
        .field("load_n", "load", |r| r.load)
        .shown("N")
        .all_digits()
        .field("sinkage_m", "sinkage", |r| r.sinkage)
        .shown("mm")
        .decimals(1)
        .field("drawbar_pull_n", "pull", |r| r.drawbar_pull)
        .shown("N")
        .decimals(2)
        .field("torque_nm", "torque", |r| r.torque)
        .shown("N m")
        .decimals(3)
        .field("tractive_efficiency", "efficiency", |r| r.efficiency)
        .shown("")
        .decimals(3)
        .field("slip_of_best_efficiency", "best slip", |r| r.best_slip)
        .shown("")
        .decimals(3)
        .field("best_efficiency", "efficiency at the best slip", |r| {
            r.best_efficiency
        })
        .field("slip_above_best", "above best", |r| r.above_best)
        .shown("")
        .decimals(3)
        .field(
            "slip_with_reference_skid",
            "slip if the reference skids",
            |r| r.slip_with_skid,
        )
        .shown("")
        .decimals(3)
        .field("cautions", "cautions", |r| r.cautions.clone())
}
