//! `estimate`: slip per wheel from a recorded log.

mod calibration;
mod figure;
mod mcap;
mod object;
mod output;
mod request;
mod reservations;
mod row_watch;
mod text;
mod truth;

use std::ffi::OsString;
use std::fmt::Write as _; // writing to a string cannot fail
use std::io;
use std::path::PathBuf;

use grouser_doctor::StartOutcome;
use grouser_files::columns::{self, ColumnMap};
use grouser_files::robot::{self, RobotFile, WheelSensor};
use grouser_log::{Cell, LOOK_AHEAD, LeftOut, Log, UsedTopic};
use grouser_page::run::LogRecorder;
use grouser_replay::{
    Compared, Doubt, Inputs, Options, Row, Sink, Status, Step, Summary, Truth, check_start,
    run_into, soil_readings, unused_currents,
};
use grouser_slip::{Reference, Rejected};

use self::calibration::Job;
use self::object::{Found, is_other_reference};
use self::output::Outputs;
use self::request::Request;
use self::row_watch::RowWatch;
use self::text::text;
use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::progress::Progress;
use crate::report_file::ReportFlag;
use crate::session::Session;
use crate::soil_choice::{self, Chosen, Overrides};
use crate::soil_text;
use crate::verb_report::{Medium, Report};
use grouser_report::number::parse_finite;
use grouser_report::{Layout, Object, printable};

#[derive(clap::Args, Debug)]
#[command(
    about = "Estimate the slip of every wheel from a recorded log",
    after_help = "A LOG is a file (MCAP, a ROS 1 bag, or CSV, plain or gzip), a folder, or the beginning that the names of one \
        run's files share.\n\nExample:\n  grouser estimate examples/five-wheel/log.csv --robot \
        examples/five-wheel/robot.toml --soil dry-sand -o slip.svg"
)]
pub(crate) struct Arguments {
    /// The log: files of one run, a folder, or the beginning of several names
    #[arg(required = true, value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// The robot file
    #[arg(long, value_name = "R.toml")]
    robot: PathBuf,
    /// The column map of a CSV log [default: the robot file's, or `columns.toml` next to it]
    #[arg(long, value_name = "C.toml")]
    map: Option<PathBuf>,
    /// Write slip against time: a table (.csv), a figure (.svg, .png) or messages of ROS 2 with odometry and diagnostics (.mcap); may be given again
    #[arg(short, long, value_name = "OUT")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    report: ReportFlag,
    /// Put the slips on this soil: a key of the catalogue, or a file when it contains `/` or `.`
    #[arg(long, value_name = "KEY|FILE")]
    soil: Option<OsString>,
    #[command(flatten)]
    overrides: Overrides,
    /// Learn the soil from slips, accelerations, torques and sinkages; the one of `--soil` is what is known of it
    #[arg(long, requires = "soil")]
    learn_soil: bool,
    /// What measures how fast the robot travels [default: the robot file's]
    #[arg(long, value_name = "NAME", value_parser = reference)]
    reference: Option<Reference>,
    /// Slips as the robot would have known them at their time; else each slip uses the whole log
    #[arg(long)]
    online: bool,
    #[arg(long, hide = true, value_parser = smooth, num_args = 0, default_missing_value = "")]
    smooth: Option<()>,
    #[arg(long, hide = true, value_parser = by_filter)]
    method: Option<()>,
    #[arg(long, hide = true, value_parser = by_filter, allow_hyphen_values = true)]
    window_s: Option<()>,
    /// What measures the wheels [default: the robot file's]
    #[arg(long, value_name = "count|angle|rate", value_parser = sensor)]
    wheel_sensor: Option<WheelSensor>,
    /// Leave out what comes before this time in s
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_hyphen_values = true)]
    from_s: Option<f64>,
    /// Leave out what comes after this time in s
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_hyphen_values = true)]
    to_s: Option<f64>,
    /// Check units, signs and axes of the sensors against each other; exit code 3 where they disagree
    #[arg(long)]
    check: bool,
    /// Compare with true slips: a CSV table (`time_s`, `NAME_slip` of each wheel), or a topic of the log
    #[arg(long, value_name = "FILE.csv|/TOPIC")]
    truth: Option<PathBuf>,
    /// Write the robot file with the radius at which these logs, runs without slip, show none
    #[arg(long, value_name = "OUT.toml", conflicts_with_all = ["output", "soil"])]
    calibrate_radius: Option<PathBuf>,
    /// Write the robot file with radii, track and scale of the yaw rate with which these logs, runs without slip, agree with their reference
    #[arg(long, value_name = "OUT.toml", conflicts_with_all = ["output", "soil", "calibrate_radius"])]
    calibrate: Option<PathBuf>,
    /// Write the robot file with the factor with which 90 % intervals hold in these reference runs, each LOG a run
    #[arg(long, value_name = "OUT.toml", conflicts_with_all = ["output", "soil", "calibrate_radius", "calibrate"])]
    calibrate_intervals: Option<PathBuf>,
}

fn reference(name: &str) -> std::result::Result<Reference, String> {
    one_of(
        name,
        &Reference::ALL.map(|reference| (reference.name(), reference)),
    )
}

/// A flag of the past.
fn smooth(_: &str) -> std::result::Result<(), String> {
    Err("slips use the whole log without it; `--online` gives those that the robot would have known".into())
}

/// And two of them.
fn by_filter(_: &str) -> std::result::Result<(), String> {
    Err("the slip filter replaces means over windows, and follows wheels by the period of their readings".into())
}

fn sensor(name: &str) -> std::result::Result<WheelSensor, String> {
    one_of(name, &WheelSensor::NAMES)
}

fn one_of<T: Copy>(name: &str, all: &[(&str, T)]) -> std::result::Result<T, String> {
    let found = all.iter().find(|(other, _)| *other == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        format!("must be one of {}", names.join(", "))
    })
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    run_compared(arguments, session).map(|(report, _)| report)
}

/// The report, and with `--truth` every slip next to the true one.
pub(super) fn run_compared(
    arguments: &Arguments,
    session: &mut Session,
) -> Result<(Report, Option<Compared>)> {
    let mut request = request(arguments, session)?;
    if let Some(report) = job_beside(arguments, &request, session)? {
        return Ok((report, None));
    }
    let soil = known_soil(arguments, session)?;
    let known = soil.as_ref().filter(|_| arguments.learn_soil);
    request.options.learn_soil = known.map(|known| known.soil);
    let log = request.log(&arguments.logs)?;
    // The gyro's clock is aligned in a pass before, and the delay of the reference is found in another.
    let inputs = Inputs::of(&log, &request.robot, &request.options)?;
    let is_absolute = !matches!(inputs.reference, Reference::FreeWheel | Reference::Grip);
    let is_unaligned = !log.unaligned_clocks().is_empty();
    let passes = 1 + u64::from(is_unaligned) + u64::from(is_absolute);
    let wheels = request.robot.robot.wheels();
    let mut outputs = Outputs::begin(&arguments.output, wheels)?;
    let report = arguments.report.begin()?;
    let progress = Progress::of_bytes(Some(log.bytes() * passes));
    let mut watched = Watched {
        log: &log,
        progress: &progress,
        outputs: &mut outputs,
        seen: report.as_ref().map(|_| LogRecorder::new(wheels.len())),
        compared: truth::source(arguments, &log, &request.robot, session)?.map(Truth::compare),
        watch: RowWatch::new(wheels.len()),
    };
    let summary = run_into(&log, &request.robot, &request.options, &mut watched);
    let Watched {
        compared,
        seen,
        watch: RowWatch { rows, .. },
        ..
    } = watched;
    let errors = compared.as_ref().map(Compared::errors);
    let truths = compared.as_ref().map(Compared::lines).unwrap_or_default();
    drop(progress);
    let summary = summary.map_err(|error| outputs.error(error))?;
    for file in log.files() {
        session.used_file(file)?;
    }
    let start = arguments
        .check
        .then(|| check_start(&log, &request.robot, &request.options))
        .transpose()?
        .map(|start| start.beside(&summary.findings));
    let readings = match &soil {
        Some(chosen) => soil_readings(&summary, &request.robot.robot, &chosen.soil)?,
        None => Vec::new(),
    };
    let found = Found {
        summary: &summary,
        log: &log,
        readings: &readings,
        rows: &rows,
        start,
        errors: errors.as_deref(),
    };
    let mut text = text(
        &request.robot,
        found,
        soil.as_ref().map(|s| s.name.as_str()),
        &request.options,
    );
    if let Some(soil) = &summary.soil {
        text.push('\n');
        text.push_str(&soil_text::words(soil));
        text.push('\n');
    }
    if let Some(start) = &start {
        let _ = writeln!(text, "sensors: {}", start_words(start));
    }
    if let Some(errors) = &errors {
        text.push_str(&truth::text(errors, &summary));
    }
    text.push_str(&topics(&log, summary.reference));
    text.push_str(&outputs.finish(&request.robot, &summary, &truths)?);
    if let (Some(file), Some(seen)) = (report, seen) {
        let title = title(&log);
        let known = soil.as_ref().map(|known| known.name.as_str());
        let shown = on_page(seen.object(&title, &summary), found, known);
        text.push_str(&file.write(&title, shown, session)?);
    }
    let is_implausible = matches!(
        start,
        Some(StartOutcome::Implausible { .. } | StartOutcome::Contradicted(_))
    );
    let report = Report {
        outcome: match summary.status {
            Status::Done if object::doubts(found).is_empty() && !is_implausible => Outcome::Done,
            Status::Done => Outcome::Doubtful,
            _ => Outcome::NoResult,
        },
        object: object::fields().object(found),
        text,
        medium: Medium::Text,
        failure: failure(&summary),
        warnings: warnings(found, &request, &arguments.logs),
    };
    Ok((report, compared))
}

/// The run of a log as the page takes it, with what the log says of the whole of it.
fn on_page(mut run: serde_json::Value, found: Found<'_>, known_soil: Option<&str>) -> Object {
    run["known_soil"] = known_soil.into();
    run["slip_overall"] = found.summary.along.overall.into();
    run["doubts"] = object::doubts(found).into();
    let hidden = object::not_observable(found.summary.reference).to_owned();
    run["reservations"] = [reservations::reservations(found), vec![hidden]]
        .concat()
        .into();
    Object::from_iter([("runs".to_owned(), vec![run].into())])
}

/// The soil of `--soil`.
fn known_soil(arguments: &Arguments, session: &mut Session) -> Result<Option<Chosen>> {
    let soil = arguments.soil.as_deref().map(|soil| {
        let chosen = soil_choice::choose(soil, &arguments.overrides)?;
        chosen.note(&arguments.overrides, session);
        Ok(chosen)
    });
    soil.transpose()
}

/// A calibration instead of an estimate.
fn job_beside(
    arguments: &Arguments,
    request: &Request,
    session: &mut Session,
) -> Result<Option<Report>> {
    let jobs = [
        (&arguments.calibrate_radius, Job::Radius),
        (&arguments.calibrate, Job::Geometry),
        (&arguments.calibrate_intervals, Job::Intervals),
    ];
    if let Some((target, job)) = jobs
        .into_iter()
        .find_map(|(target, job)| Some((target.as_ref()?, job)))
    {
        let files = calibration::Files {
            logs: &arguments.logs,
            robot: &arguments.robot,
            target,
        };
        return calibration::run(job, &files, request, session).map(Some);
    }
    Ok(None)
}

/// The names of a log's files, as its report is called.
fn title(log: &Log) -> String {
    let names = log.files().filter_map(|file| file.file_name());
    let names: Vec<String> = names
        .map(|name| printable(&name.to_string_lossy()))
        .collect();
    names.join(", ")
}

/// The outputs, with the progress shown on the way.
struct Watched<'a> {
    log: &'a Log,
    progress: &'a Progress,
    outputs: &'a mut Outputs,
    seen: Option<LogRecorder>,
    compared: Option<Compared>,
    watch: RowWatch,
}

impl Sink for Watched<'_> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        self.progress.reach(self.log.bytes_read());
        self.watch.row(row)?;
        if let Some(compared) = &mut self.compared {
            compared.row(row)?;
        }
        if let Some(seen) = &mut self.seen {
            seen.row(row)?;
        }
        self.outputs.row(row)
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        if let Some(compared) = &mut self.compared {
            compared.step(step)?;
        }
        if let Some(seen) = &mut self.seen {
            seen.step(step)?;
        }
        self.outputs.step(step)
    }
}

fn request(arguments: &Arguments, session: &mut Session) -> Result<Request> {
    let robot = robot::read(&arguments.robot)?;
    session.used_file(&arguments.robot)?;
    let map = column_map(arguments, &robot, session)?;
    Ok(Request {
        robot,
        map,
        options: Options {
            offline: !arguments.online,
            reference: arguments.reference,
            wheel_sensor: arguments.wheel_sensor,
            from_s: arguments.from_s,
            to_s: arguments.to_s,
            learn_soil: None,
        },
    })
}

/// The column map: the flag's, else the robot file's own, else the one beside it; bags need none.
fn column_map(
    arguments: &Arguments,
    robot: &RobotFile,
    session: &mut Session,
) -> Result<Option<ColumnMap>> {
    let beside = arguments.robot.with_file_name("columns.toml");
    let path = match &arguments.map {
        Some(path) => path,
        None if robot.columns.is_some() => return Ok(robot.columns.clone()),
        None if beside.exists() => &beside,
        None if !Log::needs_columns(&arguments.logs)? => return Ok(None),
        None => {
            return Err(Error::usage(
                "no column map is given, and there is no `columns.toml` next to the robot file",
                "`--map C.toml` says what the log's columns mean; `grouser log info LOG --suggest-robot` \
                 proposes one",
            ));
        }
    };
    let columns = columns::read(path)?;
    session.used_file(path)?;
    Ok(Some(columns))
}

/// The topics that were used of bags and MCAP files; of tables the column map says it.
fn topics(log: &Log, reference: Reference) -> String {
    let one = |used: UsedTopic| {
        let unused = if is_other_reference(&used, reference) {
            format!(" (not used: the reference is `{}`)", reference.name())
        } else {
            String::new()
        };
        format!("{}: {}{unused}\n", printable(&used.topic), used.used_for)
    };
    // a reference that is not used is a reservation
    let is_seen =
        |used: &UsedTopic| Layout::current().details || is_other_reference(used, reference);
    let lines: Vec<String> = log.topics().filter(is_seen).map(one).collect();
    if lines.is_empty() {
        return String::new();
    }
    format!("\n{}", lines.concat())
}

fn start_words(start: &StartOutcome) -> String {
    match start {
        StartOutcome::Plausible => "units, signs and axes agree".to_owned(),
        StartOutcome::Contradicted(doubt) => doubt.to_string(),
        StartOutcome::Implausible { fault, time_s } => format!("{fault} (at {time_s:.1} s)"),
        _ => "not every sensor was exercised: the robot has to rest, drive, turn and speed up"
            .to_owned(),
    }
}

fn failure(summary: &Summary) -> Option<String> {
    let is_unused = summary.doubts().contains(&Doubt::ReferenceUnused);
    (summary.status == Status::NoSlip).then(|| {
        if is_unused {
            "no wheel has a slip: no reading of the reference could be used".to_owned()
        } else {
            format!(
                "no wheel has a slip: in {:.3} s nothing moved enough",
                summary.duration_s
            )
        }
    })
}

fn warnings(found: Found<'_>, request: &Request, named: &[PathBuf]) -> Vec<String> {
    let (summary, log, readings) = (found.summary, found.log, found.readings);
    let mut out = object::doubts(found);
    let delay = summary
        .reference_delay
        .filter(|delay| delay.is_clear && !delay.is_applied && !delay.is_beyond_correction());
    out.extend(delay.map(|delay| delay.to_string()));
    out.extend(summary.held_reference.map(|held| held.to_string()));
    if summary.reference == Reference::Grip {
        out.push(
            "the slip common to all wheels is not observable: it is that of the prior, and only differences are measured"
                .to_owned(),
        );
    } else if request.robot.reference == Some(Reference::Grip)
        && request.options.reference.is_none()
    {
        out.push(format!(
            "the robot file names `grip`, but the log measures the robot's motion: `{}` is used",
            summary.reference.name()
        ));
    }
    let currents = unused_currents(log, &request.robot);
    if !currents.is_empty() {
        out.push(format!(
            "the motor currents of {} show changes of ground only: `torque_per_ampere_nm` of the wheel converts them to torques",
            currents.join(", ")
        ));
    }
    let left_out = log.left_out();
    let steps = summary.fused.clock_steps;
    let at_steps = steps.saturating_mul(summary.wheels.len() as u64 + OTHER_SENSORS);
    out.extend(rejected(&summary.rejected, at_steps, &left_out));
    out.extend(log.notes().iter().cloned());
    if left_out.zero_poses > 0 {
        out.push(format!(
            "{} poses of 0, 0 in tables are not used: their logger had no new pose in these rows",
            left_out.zero_poses
        ));
    }
    if left_out.damages > 0 {
        out.push(format!(
            "{} places of the log are damaged, {} bytes are lost in them",
            left_out.damages, left_out.bytes_lost
        ));
    }
    if left_out.undecoded > 0 {
        out.push(format!(
            "{} messages or rows of tables could not be read: {}",
            left_out.undecoded,
            left_out.problem.unwrap_or_default()
        ));
    }
    if left_out.late > 0 {
        out.push(format!(
            "{} messages came more than {LOOK_AHEAD} messages too late and were left out",
            left_out.late
        ));
    }
    out.extend(left_out.cut_off.iter().map(cut_off));
    if left_out.excluded > 0 {
        out.push(format!(
            "{} readings are not used: {}",
            left_out.excluded,
            left_out.exclusion.unwrap_or_default()
        ));
    }
    // What else lies in a folder is no matter.
    for file in log.unused().iter().filter(|file| named.contains(file)) {
        out.push(format!(
            "{} fits no table of the column map",
            file.display()
        ));
    }
    for reading in readings {
        for caution in &reading.cautions {
            out.push(format!("{}: {caution}", reading.wheel));
        }
    }
    out
}

/// Sensors that are stamped with the wheels: gyro, accelerometer, reference, command.
const OTHER_SENSORS: u64 = 4;

/// How many samples were rejected, and why. As many as `at_steps` may be those of the times at which the clock stepped: the
/// filter begins anew behind these.
fn rejected(rejected: &Rejected, at_steps: u64, left_out: &LeftOut) -> Option<String> {
    let not_later = if 2 * left_out.same_time > left_out.rows {
        format!(
            "not later than the one before, since {} of {} rows of the tables have the time of the row before (if it is rounded, to \
             whole seconds say: name a finer column; `nanoseconds` in `time` adds one of the nanoseconds)",
            left_out.same_time, left_out.rows
        )
    } else {
        "not later than the one before (is the time rounded, to whole seconds say?)".to_owned()
    };
    let reasons = [
        (rejected.bad_value, "with a value that no sensor has"),
        (
            rejected.not_later.saturating_sub(at_steps),
            not_later.as_str(),
        ),
        (
            rejected.not_later.min(at_steps),
            "at the first time after a pause of the recording or a jump of its clock",
        ),
        (rejected.jump, "faster than the robot moves"),
        (rejected.unknown, "of no wheel of the robot"),
    ];
    let reasons: Vec<String> = reasons
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, why)| format!("{count} {why}"))
        .collect();
    let total = rejected.total();
    let were = if total == 1 {
        "sample was"
    } else {
        "samples were"
    };
    (total > 0).then(|| format!("{total} {were} rejected: {}", reasons.join(", ")))
}

/// The last line of a table is cut off.
pub(crate) fn cut_off(at: &Cell) -> String {
    format!("{at}: is cut off at the end of the file, and left out")
}

/// The JSON schema: of an estimate, or of a calibration.
pub(crate) fn schema() -> serde_json::Value {
    let calibrations = calibration::schemas();
    let all: Vec<_> = std::iter::once(object::fields().schema())
        .chain(calibrations)
        .collect();
    serde_json::json!({ "anyOf": all })
}
