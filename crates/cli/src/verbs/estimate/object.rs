//! The JSON object of `estimate`.

use grouser_log::{Log, UsedTopic};
use grouser_replay::{EventAt, FusedSummary, Odometry, SoilReading, Spread, Summary, WheelSummary};
use grouser_slip::detect::Event;
use serde_json::{Value, json};

use super::text::culprit;
use crate::report::Object;

pub(super) fn object(summary: &Summary, log: &Log, readings: &[SoilReading]) -> Object {
    let mut along = spread(&summary.along.slip);
    along.insert("overall".to_owned(), summary.along.overall.into());
    along.insert(
        "travel_wheels_m".to_owned(),
        summary.along.travel_wheels.into(),
    );
    along.insert(
        "travel_reference_m".to_owned(),
        summary.along.travel_reference.into(),
    );
    let rejected = summary.rejected;
    let files = |paths: &mut dyn Iterator<Item = &std::path::Path>| -> Value {
        paths
            .map(|path| Value::from(path.display().to_string()))
            .collect()
    };
    [
        ("status", Value::from(summary.status.name())),
        ("method", summary.method.name().into()),
        ("reference", Value::from(summary.reference.name())),
        ("wheel_sensor", Value::from(summary.wheel_sensor)),
        ("duration_s", Value::from(summary.duration_s)),
        ("window_s", Value::from(summary.window_s)),
        ("wheels", Value::Object(wheels(summary, readings))),
        ("along", Value::Object(along)),
        ("yaw", yaw(summary).unwrap_or(Value::Null)),
        (
            "odometry",
            summary.odometry.as_ref().map_or(Value::Null, odometry),
        ),
        (
            "filter",
            summary
                .fused
                .as_ref()
                .map_or(Value::Null, |f| filter(f, summary)),
        ),
        (
            "rejected",
            json!({
                "bad_value": rejected.bad_value,
                "not_later": rejected.not_later,
                "jump": rejected.jump,
                "unknown": rejected.unknown,
            }),
        ),
        ("files", files(&mut log.files())),
        (
            "unused_files",
            files(&mut log.unused().iter().map(std::path::PathBuf::as_path)),
        ),
        ("topics", topics(log)),
        ("notes", log.notes().into()),
        ("left_out", left_out(log)),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

fn wheels(summary: &Summary, readings: &[SoilReading]) -> Object {
    let one = |wheel: &WheelSummary| {
        let mut one = spread(&wheel.slip);
        one.insert(
            "states".to_owned(),
            shares(wheel.states.iter().map(|(n, s)| (*n, *s))),
        );
        let healths = wheel
            .healths
            .iter()
            .map(|(name, share)| (name.as_str(), *share));
        one.insert("healths".to_owned(), shares(healths));
        let angle = |value: Option<f64>| value.map(f64::to_degrees);
        one.insert(
            "side_slip_angle_deg".to_owned(),
            json!({
                "median": angle(wheel.side_slip_angle.median),
                "p5": angle(wheel.side_slip_angle.p5),
                "p95": angle(wheel.side_slip_angle.p95),
            }),
        );
        one.insert("is_reference".to_owned(), wheel.is_reference.into());
        let reading = readings.iter().find(|reading| reading.wheel == wheel.name);
        one.insert("soil".to_owned(), reading.map_or(Value::Null, soil));
        (wheel.name.clone(), Value::Object(one))
    };
    summary.wheels.iter().map(one).collect()
}

/// The turn by the wheels beside the turn as measured.
fn yaw(summary: &Summary) -> Option<Value> {
    let yaw = summary.yaw?;
    let apart = summary.turns.as_ref().map(|turns| {
        let named = turns.wheel.and_then(|wheel| summary.wheels.get(wheel));
        json!({
            "first_motion_s": turns.first_motion_s,
            "alarm_s": turns.alarm_s,
            "alarms": turns.alarms,
            "wheel": named.map(|wheel| wheel.name.as_str()),
            "says": culprit(turns, summary),
            "log_likelihood_ratio": turns.likelier,
        })
    });
    Some(json!({
        "residual_median_rad": yaw.residual.median,
        "residual_p5_rad": yaw.residual.p5,
        "residual_p95_rad": yaw.residual.p95,
        "clock_offset_s": summary.clock_offset_s,
        "apart": apart,
    }))
}

/// The topics that were used of bags and MCAP files.
fn topics(log: &Log) -> Value {
    let one = |used: UsedTopic| json!({"topic": used.topic, "type": used.type_name, "used_for": used.used_for});
    log.topics().map(one).collect()
}

fn odometry(odometry: &Odometry) -> Value {
    let [x, y, yaw] = odometry.pose;
    let sigma = |i: usize| odometry.pose_covariance[i][i].max(0.0).sqrt();
    json!({
        "x_m": x,
        "y_m": y,
        "yaw_rad": yaw,
        "x_sigma_m": sigma(0),
        "y_sigma_m": sigma(1),
        "yaw_sigma_rad": sigma(2),
        "distance_m": odometry.distance,
        "distance_without_compensation_m": odometry.distance_of_wheels,
    })
}

fn filter(fused: &FusedSummary, summary: &Summary) -> Value {
    let kinds = fused.consistency.iter().map(|(kind, nis)| {
        let one = json!({"count": nis.count, "mean": nis.mean, "share_in_95_band": nis.in_band});
        ((*kind).to_owned(), one)
    });
    let events = fused.events.iter().map(|at| event(at, summary));
    json!({
        "smoothed": fused.is_smoothed,
        "nis": Value::Object(kinds.collect()),
        "dropped": fused.dropped,
        "clock_steps": fused.clock_steps,
        "events": events.collect::<Vec<_>>(),
        "more_events": fused.more_events,
    })
}

fn event(at: &EventAt, summary: &Summary) -> Value {
    let (name, wheel) = event_name(at.change.event);
    let wheel = wheel.and_then(|wheel| summary.wheels.get(wheel));
    json!({
        "time_s": at.time_s,
        "event": name,
        "wheel": wheel.map(|wheel| wheel.name.as_str()),
        "begins": at.change.begins,
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

fn left_out(log: &Log) -> Value {
    let left_out = log.left_out();
    json!({
        "damages": left_out.damages,
        "bytes_lost": left_out.bytes_lost,
        "undecoded": left_out.undecoded,
        "late": left_out.late,
    })
}

fn spread(spread: &Spread) -> Object {
    [
        ("median", spread.median),
        ("p5", spread.p5),
        ("p95", spread.p95),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value.into()))
    .collect()
}

fn shares<'a>(shares: impl Iterator<Item = (&'a str, f64)>) -> Value {
    let named = shares.map(|(name, share)| (name.to_owned(), Value::from(share)));
    Value::Object(named.collect())
}

fn soil(reading: &SoilReading) -> Value {
    json!({
        "slip": reading.slip,
        "load_n": reading.load,
        "sinkage_m": reading.sinkage,
        "drawbar_pull_n": reading.drawbar_pull,
        "torque_nm": reading.torque,
        "tractive_efficiency": reading.efficiency,
        "slip_of_best_efficiency": reading.best_slip,
        "best_efficiency": reading.best_efficiency,
        "slip_above_best": reading.above_best,
        "slip_with_reference_skid": reading.slip_with_skid,
        "cautions": reading.cautions,
    })
}
