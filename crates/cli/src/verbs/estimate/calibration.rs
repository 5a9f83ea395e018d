//! `estimate --calibrate…`: what runs with a reference show of the robot file.

use std::collections::BTreeSet;
use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::path::{Path, PathBuf};

use grouser_doctor::ReferenceDelay;
use grouser_files::Document;
use grouser_files::robot::{Revision, revised};
use grouser_log::Log;
use grouser_replay::Error::{NoReference, NoWheels, WheelNotMeasured};
use grouser_replay::{
    Calibration, Factor, GeometryCalibration, Inputs, IntervalCalibration, calibrate_geometry,
    calibrate_intervals, calibrate_radius, calibrate_reference_delay, run_into,
};
use grouser_report::{Fields, fields};
use grouser_slip::WheelRole;

use super::object::reference_delay;
use super::request::Request;
use super::reservations::inconsistent;
use super::row_watch::RowWatch;
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;

/// Runs with a shorter distance by the wheels in sum do not show a radius well, m: the reference is some millimetres off, and starts and
/// stops some centimetres.
const MIN_WAY_M: f64 = 2.0;
/// A radius with a wider interval (95 %, half of it over the radius) is doubtful: slips are then known to no better than that.
const MAX_HALF_WIDTH: f64 = 0.1;
/// Wear, tyre pressure and a radius measured by hand explain a smaller change of the radius, and a radius varies less along a run. Prior.
const MAX_RADIUS_CHANGE: f64 = 0.05;

/// What is calibrated.
#[derive(Clone, Copy)]
pub(super) enum Job {
    Radius,
    Geometry,
    Intervals,
}

/// The files of a calibration.
pub(super) struct Files<'a> {
    /// Each log is a run of its own.
    pub(super) logs: &'a [PathBuf],
    pub(super) robot: &'a Path,
    pub(super) target: &'a Path,
}

pub(super) fn run(
    job: Job,
    files: &Files<'_>,
    request: &Request,
    session: &mut Session,
) -> Result<Report> {
    let mut output = OutputFile::create(files.target)?;
    let logs = read_runs(files, request, session)?;
    let Calibrated {
        revision,
        found,
        text,
        doubt,
        caution,
    } = match job {
        Job::Radius => radius(&logs, request)?,
        Job::Geometry => geometry(&logs, request)?,
        Job::Intervals => intervals(&logs, request)?,
    };
    let Runs {
        mut doubts,
        travel_m,
    } = doubts_of(&logs, files, request)?;
    // What is wrong in a log would be hidden in the robot file; a short log alone is only known badly.
    let is_written = doubts.is_empty();
    doubts.extend(doubt);
    if !matches!(job, Job::Intervals) && !(travel_m >= MIN_WAY_M) {
        doubts.push(format!(
            "the wheels ran {travel_m:.1} m: less than {MIN_WAY_M} m do not show the radius well"
        ));
    }
    let mut shown_text = String::new();
    for doubt in &doubts {
        let _ = writeln!(shown_text, "WARNING: {doubt}");
    }
    shown_text.push_str(&text);
    if is_written {
        let rewritten = revised(&Document::read(files.robot)?, &revision)?;
        let written = output.write_all(rewritten.as_bytes());
        written.map_err(|error| Error::file("write", files.target, &error))?;
        output.finish()?;
        let _ = writeln!(shown_text, "wrote {}", shown(files.target));
    } else {
        let _ = writeln!(
            shown_text,
            "{} is not written: correct the robot file or the logs, and calibrate then",
            shown(files.target)
        );
    }
    let output = Written {
        target: is_written.then_some(files.target),
        doubts: &doubts,
    };
    let object = match &found {
        Found::Radius(found, radii) => of_radius().object((found, radii, output)),
        Found::Geometry(found, delay) => of_geometry().object((found, *delay, output)),
        Found::Intervals(found) => of_intervals().object((found, output)),
    };
    Ok(Report {
        outcome: if doubts.is_empty() {
            Outcome::Done
        } else {
            Outcome::Doubtful
        },
        warnings: doubts
            .into_iter()
            .chain(caution.map(str::to_owned))
            .collect(),
        ..Report::done(object, shown_text)
    })
}

/// What `estimate` finds in the runs of a calibration.
struct Runs {
    /// What would make its result doubtful, or a wheel `Invalid`.
    doubts: Vec<String>,
    /// The distance driven by the wheels in all runs, m.
    travel_m: f64,
}

fn doubts_of(logs: &[Log], files: &Files<'_>, request: &Request) -> Result<Runs> {
    let mut runs = Runs {
        doubts: Vec::new(),
        travel_m: 0.0,
    };
    for (log, path) in logs.iter().zip(files.logs) {
        let mut watch = RowWatch::new(request.robot.robot.wheels().len());
        let summary = run_into(log, &request.robot, &request.options, &mut watch)?;
        runs.travel_m += summary.along.travel_wheels.abs();
        let doubts = summary.doubts().into_iter().map(|doubt| doubt.to_string());
        let all = doubts.chain(inconsistent(&summary, &watch.rows));
        runs.doubts.extend(all.map(|doubt| match logs {
            [_] => doubt,
            _ => format!("{}: {doubt}", shown(path)),
        }));
    }
    Ok(runs)
}

/// The log of each run.
pub(super) fn read_runs(
    files: &Files<'_>,
    request: &Request,
    session: &mut Session,
) -> Result<Vec<Log>> {
    let mut logs = Vec::new();
    let mut read = BTreeSet::new();
    for path in files.logs {
        let log = request.log(std::slice::from_ref(path))?;
        let of_log: Vec<PathBuf> = log
            .files()
            .filter_map(|file| file.canonicalize().ok())
            .collect();
        if let Some(twice) = of_log.iter().find(|file| read.contains(*file)) {
            return Err(Error::usage(
                format!("{} belongs to two LOGs", shown(twice)),
                "each LOG is a run of its own here: one that is counted twice would agree with itself",
            ));
        }
        read.extend(of_log);
        let is_one_of_several = files.logs.len() > 1;
        if let Err(error @ (NoWheels { .. } | WheelNotMeasured { .. } | NoReference { .. })) =
            Inputs::of(&log, &request.robot, &request.options)
            && is_one_of_several
        {
            return Err(Error::usage(
                format!("{}: {error}", shown(path)),
                "each LOG is a run of its own here: of a run in several files name the folder, or the beginning that their \
                 names share",
            ));
        }
        for file in log.files() {
            session.used_file(file)?;
        }
        logs.push(log);
    }
    Ok(logs)
}

/// What changes in the robot file, and what is said of it.
struct Calibrated {
    revision: Revision,
    found: Found,
    text: String,
    /// Why it is known badly.
    doubt: Option<String>,
    /// What else it may be.
    caution: Option<&'static str>,
}

enum Found {
    /// With the radius of each powered wheel, m.
    Radius(Calibration, Vec<(String, f64)>),
    Geometry(GeometryCalibration, Option<ReferenceDelay>),
    Intervals(IntervalCalibration),
}

fn radius(logs: &[Log], request: &Request) -> Result<Calibrated> {
    let found = calibrate_radius(logs, &request.robot, &request.options)?;
    let each: Vec<String> = found
        .factors
        .iter()
        .map(|factor| format!("{factor:.4}"))
        .collect();
    let mut text = format!(
        "effective radius: {:.4} × that of the robot file",
        found.factor
    );
    if let Some(half) = found.half_spread() {
        let _ = write!(text, " ± {half:.4} (runs: {})", each.join(", "));
    }
    text.push('\n');
    let radii = radii(request, found.factor);
    let over_blocks = calibrate_geometry(logs, &request.robot, &request.options).ok();
    let half = over_blocks.and_then(|found| found.radius.half_width);
    let doubt = looks_like_slip(found.factor, half);
    Ok(Calibrated {
        revision: Revision {
            radius: Some(found.factor),
            ..Revision::default()
        },
        caution: steady_change(found.factor, doubt.as_deref()),
        found: Found::Radius(found, radii),
        text,
        doubt,
    })
}

/// A radius that is off by more than wear explains, and that varies within the runs or between them, as slip does.
fn looks_like_slip(factor: f64, half: Option<f64>) -> Option<String> {
    let is_far = (factor - 1.0).abs() > MAX_RADIUS_CHANGE;
    let half = half.filter(|half| is_far && *half > MAX_RADIUS_CHANGE * factor)?;
    Some(format!(
        "radius x {factor:.3} ± {half:.3}: wheels that slip look like this; use a run without slip"
    ))
}

/// What a larger change of the radius may be where nothing else shows it.
fn steady_change(factor: f64, doubt: Option<&str>) -> Option<&'static str> {
    let is_far = (factor - 1.0).abs() > MAX_RADIUS_CHANGE;
    (is_far && doubt.is_none()).then_some(
        "wear and tyre pressure change a radius by less than 5 %; slip in the whole run looks the same",
    )
}

/// The radius of each powered wheel times a factor.
fn radii(request: &Request, factor: f64) -> Vec<(String, f64)> {
    let powered = request.robot.robot.wheels().iter();
    powered
        .filter(|wheel| wheel.role == WheelRole::Powered)
        .map(|wheel| (wheel.name.clone(), wheel.radius * factor))
        .collect()
}

fn geometry(logs: &[Log], request: &Request) -> Result<Calibrated> {
    let found = calibrate_geometry(logs, &request.robot, &request.options)?;
    let mut text = String::new();
    for (name, factor) in [
        ("radius", Some(found.radius)),
        ("track", found.track),
        ("yaw rate", found.yaw_rate),
    ] {
        let _ = match factor {
            None => writeln!(text, "{name}: not observable in these logs, unchanged"),
            Some(Factor {
                value,
                half_width: Some(half),
            }) => writeln!(
                text,
                "{name}: {value:.4} ± {half:.4} × that of the robot file (95 %)"
            ),
            Some(Factor { value, .. }) => {
                writeln!(
                    text,
                    "{name}: {value:.4} × that of the robot file (no interval)"
                )
            }
        };
    }
    let delay = calibrate_reference_delay(logs, &request.robot, &request.options)?;
    let clear = delay.filter(|delay| delay.is_clear);
    let _ = match delay {
        None => writeln!(
            text,
            "reference: its delay is not observable in these logs, unchanged"
        ),
        Some(delay) => {
            let (value, half) = (delay.delay_s, delay.half_width_s);
            let end = match (clear, value < 0.0) {
                (None, _) => ", unchanged",
                (Some(delay), _) if delay.is_beyond_correction() => {
                    ": too much for a delay, unchanged; do the clocks of two computers disagree?"
                }
                (Some(_), false) => "",
                (Some(_), true) => {
                    ": it is stamped early, `offset_s` in `time` of its table states it"
                }
            };
            writeln!(
                text,
                "reference: late by {value:.3} ± {half:.3} s (95 %){end}"
            )
        }
    };
    let doubt = match found.radius.half_width {
        None => Some("one run of less than 25 s shows no interval of the radius".to_owned()),
        Some(half) if half > MAX_HALF_WIDTH * found.radius.value => Some(format!(
            "the radius is known to ± {:.0} % only: it differs between the runs, or within them",
            100.0 * half / found.radius.value
        )),
        half => looks_like_slip(found.radius.value, half),
    };
    Ok(Calibrated {
        caution: steady_change(found.radius.value, doubt.as_deref()),
        revision: Revision {
            radius: Some(found.radius.value),
            track: found.track.map(|factor| factor.value),
            yaw_rate: found.yaw_rate.map(|factor| factor.value),
            reference_latency: clear
                .filter(|delay| delay.delay_s > 0.0 && !delay.is_beyond_correction())
                .map(|delay| delay.delay_s),
            ..Revision::default()
        },
        found: Found::Geometry(found, delay),
        text,
        doubt,
    })
}

fn intervals(logs: &[Log], request: &Request) -> Result<Calibrated> {
    let found = calibrate_intervals(logs, &request.robot, &request.options)?;
    let text = format!(
        "interval factor: {:.3}\n90 % intervals contain {:.1} % of the slips by the reference in runs that the factor was not taken \
         from ({:.1} % without it), median half-width {:.3}\nnot observable: errors of radii, axes or of the reference's scale that \
         the runs share\n",
        found.factor,
        100.0 * found.coverage,
        100.0 * found.coverage_before,
        found.half_width,
    );
    Ok(Calibrated {
        caution: None,
        revision: Revision {
            interval: Some(found.factor),
            ..Revision::default()
        },
        found: Found::Intervals(found),
        text,
        doubt: None,
    })
}

/// What became of the robot file.
#[derive(Clone, Copy)]
struct Written<'a> {
    target: Option<&'a Path>,
    doubts: &'a [String],
}

fn written<'a>() -> Fields<'a, Written<'a>> {
    fields! { |written: Written<'a>|
        "doubts" "why the result is uncertain" = written.doubts.to_vec();
        "output" "the file that was written; null of logs in which something is wrong" =
            written.target.map(|target| target.display().to_string());
    }
}

type Radius<'a> = (&'a Calibration, &'a Vec<(String, f64)>, Written<'a>);

/// The JSON object of a calibrated radius.
fn of_radius<'a>() -> Fields<'a, Radius<'a>> {
    fields! { |found: Radius<'a>|
        "radius_factor" "effective radius over that of the robot file" = found.0.factor;
        "radius_factors" "the same of each run" = found.0.factors.clone();
        "half_spread" "half of their spread" = found.0.half_spread();
        "radii_m" "effective radius of each powered wheel" values = Some(found.1.iter().cloned());
        join(written()) = found.2;
    }
}

type Geometry<'a> = (&'a GeometryCalibration, Option<ReferenceDelay>, Written<'a>);

fn of_geometry<'a>() -> Fields<'a, Geometry<'a>> {
    fn factor<'a>() -> Fields<'a, Factor> {
        fields! { |factor: Factor|
            "value" "right value over that of the robot file" = factor.value;
            "half_width" "half of its 95 % interval; null of one run of less than 25 s" = factor.half_width;
        }
    }
    fields! { |found: Geometry<'a>|
        "radius" "radii of the powered wheels" group(factor()) = found.0.radius;
        "track" "distance of left and right wheels; null where it is not observable" group(factor()) = found.0.track;
        "yaw_rate" "yaw rate; null where it is not observable" group(factor()) = found.0.yaw_rate;
        "reference_delay" "delay of the reference's stamps to wheels and gyro; null where it is not observable"
            group(reference_delay()) = found.1;
        join(written()) = found.2;
    }
}

type Intervals<'a> = (&'a IntervalCalibration, Written<'a>);

fn of_intervals<'a>() -> Fields<'a, Intervals<'a>> {
    fields! { |found: Intervals<'a>|
        "interval_factor" "factor on the standard deviations of the slips" = found.0.factor;
        "coverage" "share of the 90 % intervals that hold the slip by the reference, in runs left out of the calibration" =
            found.0.coverage;
        "coverages" "the same of each run" = found.0.coverages.clone();
        "coverage_before" "the same without a factor" = found.0.coverage_before;
        "half_width" "median half-width of the 90 % intervals" = found.0.half_width;
        join(written()) = found.1;
    }
}

/// The JSON schemas of the calibrations.
pub(super) fn schemas() -> [serde_json::Value; 3] {
    [
        of_radius().schema(),
        of_geometry().schema(),
        of_intervals().schema(),
    ]
}
