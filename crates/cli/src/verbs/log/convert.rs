//! `log convert`: a log in another format.

use std::path::{Path, PathBuf};

use grouser_files::columns::{self, ColumnMap, Meaning};
use grouser_log::Log;
use grouser_log::container::{Container, Event, Format};
use grouser_log::write::{SampleWriter, Table, copy, verify, write_table};
use grouser_report::{Fields, fields};
use grouser_slip::MeasurementKind;
use serde_json::{Value, json};

use super::copied::{self, Copy, copy_error, target};
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::files_in_use;
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;
use crate::verbs::estimate::cut_off;

#[derive(clap::Args, Debug)]
#[command(
    after_help = "A bag becomes MCAP with its messages as they are (encoding `ros1`), and back. One topic \
        becomes a table. A table becomes MCAP of ROS 2 messages through its column map.\n\nExamples:\n  \
        grouser log convert examples/five-wheel/log.mcap imu.csv --topic /imu\n  grouser log convert \
        examples/five-wheel/log.csv run.mcap"
)]
pub(super) struct Arguments {
    /// The log: MCAP, a ROS 1 bag, or a table with a column map
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The new file: .mcap, .bag, or .csv for one topic
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// The topic that becomes a table; needed where there are several
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,
    /// What the columns of a table mean [default: `columns.toml` next to the log]
    #[arg(long, value_name = "C.toml")]
    map: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let (file, path) = (&arguments.file, &arguments.output);
    let format = target(path)?;
    files_in_use::reads(file);
    // What is not there may be the beginning of several names, of tables.
    let kind = if file.exists() {
        Container::kind(file)?
    } else if begins_a_name(file) {
        None
    } else {
        let reason = std::io::Error::from_raw_os_error(2);
        return Err(Error::file("read", file, &reason));
    };
    if kind.is_some() && arguments.map.is_some() {
        return Err(Error::usage_without_hint(
            "`--map` is for tables: an MCAP file or a bag says itself what it holds",
        ));
    }
    match (kind, format) {
        (Some(_), Some(format)) => {
            if arguments.topic.is_some() {
                return Err(Error::usage_without_hint(
                    "`--topic` chooses the topic of a table",
                ));
            }
            whole(file, path, format, session)
        }
        (Some(_), None) => table(arguments, session),
        (None, Some(Format::Mcap)) => readings(arguments, session),
        (None, _) => Err(Error::usage(
            format!("a table does not become {}", shown(path)),
            "through its column map it becomes `.mcap`",
        )),
    }
}

/// Message by message.
fn whole(file: &Path, path: &Path, format: Format, session: &mut Session) -> Result<Report> {
    let mut output = OutputFile::create(path)?;
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let copied = copy(file, &mut output, format, |offset| progress.reach(offset));
    let copied = copied.map_err(|error| copy_error(error, path))?;
    drop(progress);
    verify(output.unfinished()?, &copied).map_err(|error| copy_error(error, path))?;
    output.finish()?;
    session.used_file(file)?;
    let object = copied::fields().object(Copy {
        copied: &copied,
        output: Some(path),
    });
    let mut report = Report::done(object, copied::text(&copied, path));
    if copied.is_partial() {
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}

/// One topic as a table.
fn table(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let (file, path) = (&arguments.file, &arguments.output);
    let topic = match &arguments.topic {
        Some(topic) => topic.clone(),
        None => only_topic(file)?,
    };
    let mut output = OutputFile::create(path)?;
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let written = write_table(file, &topic, &mut output, |offset| progress.reach(offset));
    let written = written.map_err(|error| copy_error(error, path))?;
    drop(progress);
    output.finish()?;
    session.used_file(file)?;
    let left_out = &written.left_out;
    let mut report = Report::done(
        table_fields().object((path, &topic, &written)),
        format!(
            "wrote {}: {} rows of {} columns\n",
            shown(path),
            written.rows,
            written.columns
        ),
    );
    let lost = [
        (
            written.without_column,
            "values have no column: the first message says which there are",
        ),
        (left_out.undecoded, "messages could not be decoded"),
        (
            left_out.late,
            "messages came too late for the order of time",
        ),
        (
            left_out.damages,
            "places of the file are damaged; `log info` lists them",
        ),
    ];
    for (count, what) in lost.into_iter().filter(|(count, _)| *count > 0) {
        report.warnings.push(format!("{count} {what}"));
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}

/// A topic as a table: the file, the topic, what was written.
type Written<'a> = (&'a Path, &'a str, &'a Table);

fn table_fields<'a>() -> Fields<'a, Written<'a>> {
    fields! { |table: Written<'a>|
        "output" "the file that was written" = table.0.display().to_string();
        "topic" "the topic" = table.1;
        "rows" "rows of the table" = table.2.rows;
        "columns" "columns of the table" = table.2.columns;
        "values_without_column" "values that the first message did not have" = table.2.without_column;
        "undecoded" "messages that could not be decoded" = table.2.left_out.undecoded;
        "late" "messages that came too late for the order of time" = table.2.left_out.late;
        "damage_count" "damaged places of the input" = table.2.left_out.damages;
        "bytes_lost" "bytes that are lost" = table.2.left_out.bytes_lost;
    }
}

fn readings_fields<'a>() -> Fields<'a, (&'a Path, u64, u64)> {
    fields! { |written: (&'a Path, u64, u64)|
        "output" "the file that was written" = written.0.display().to_string();
        "records" "rows that were read" = written.1;
        "messages" "messages that were written" = written.2;
    }
}

/// Of a copy, of a table, or of messages out of a table.
pub(super) fn schema() -> Value {
    json!({"anyOf": [copied::fields().schema(), table_fields().schema(), readings_fields().schema()]})
}

/// The topic of a file that has only one.
fn only_topic(file: &Path) -> Result<String> {
    let mut container = Container::open(file)?;
    let mut topics: Vec<String> = Vec::new();
    while let Some(event) = container.next() {
        if let Event::Message(message) = event
            && !topics.contains(&message.of.topic)
        {
            topics.push(message.of.topic.clone());
        }
    }
    match topics.as_slice() {
        [one] => Ok(one.clone()),
        [] => Err(Error::usage_without_hint(format!(
            "{} holds no messages",
            shown(file)
        ))),
        several => Err(Error::usage(
            format!(
                "{} holds {} topics, but a table is of one",
                shown(file),
                several.len()
            ),
            format!("`--topic` chooses one of {}", several.join(", ")),
        )),
    }
}

/// Is there a file beside it whose name begins with this one's?
fn begins_a_name(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().as_encoded_bytes();
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new(".")));
    let mut names = entries.into_iter().flatten().flatten();
    names.any(|entry| entry.file_name().as_encoded_bytes().starts_with(name))
}

/// A reading of a wheel that joints of a message have once its radius or its motor is known.
fn of_robot_file(log: &Log) -> Option<(Meaning, &String)> {
    let all = [
        Meaning::WheelDistance,
        Meaning::WheelSpeed,
        Meaning::MotorCurrent,
    ];
    all.into_iter().find_map(|meaning| {
        let mut wheels = log.wheels().iter();
        Some((
            meaning,
            wheels.find(|wheel| log.measures_wheel(meaning, wheel))?,
        ))
    })
}

/// What the columns have of places that are not poses, whose ways alone are read.
fn places(map: &ColumnMap) -> Option<Meaning> {
    let columns = || map.tables.iter().flat_map(|table| &table.columns);
    let has = |meaning: &Meaning| columns().any(|column| column.meaning == *meaning);
    let has_heading = columns().any(|column| column.meaning.is_heading());
    let is_place = |meaning: &Meaning| has(meaning) && !has_heading;
    [Meaning::Latitude, Meaning::PoseX]
        .into_iter()
        .find(is_place)
}

/// A table through its column map.
fn readings(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let (file, path) = (&arguments.file, &arguments.output);
    let beside = file.with_file_name("columns.toml");
    let map = arguments.map.as_deref().unwrap_or(&beside);
    if arguments.map.is_none() && !beside.exists() {
        return Err(Error::usage(
            format!(
                "{} is a table, but no column map is given and there is no `columns.toml` next to it",
                shown(file)
            ),
            "`--map C.toml` says what the log's columns mean",
        ));
    }
    let columns = columns::read(map)?;
    session.used_file(map)?;
    let places = places(&columns);
    let log = Log::find(std::slice::from_ref(file), columns)?;
    if let Some((meaning, wheel)) = of_robot_file(&log) {
        return Err(Error::usage(
            format!(
                "`{}` of wheel `{wheel}` is in no unit of a joint: radius and motor are in the robot file",
                meaning.name()
            ),
            "`grouser estimate` reads the table without conversion",
        ));
    }
    let mut output = OutputFile::create(path)?;
    let written = |error| Error::file("write", path, &error);
    let mut writer = SampleWriter::new(&mut output, log.wheels()).map_err(written)?;
    let progress = Progress::of_bytes(Some(log.bytes()));
    let mut records = 0_u64;
    for sample in log.samples(&[])? {
        writer.sample(&sample?).map_err(written)?;
        records += 1;
        progress.reach(log.bytes_read());
    }
    drop(progress);
    let unwritten = writer.unwritten().clone();
    let (_, messages) = writer.finish().map_err(written)?;
    output.finish()?;
    for file in log.files() {
        session.used_file(file)?;
    }
    let mut report = Report::done(
        readings_fields().object((path, records, messages)),
        format!(
            "wrote {}: {messages} messages of {records} readings\n",
            shown(path)
        ),
    );
    if let Some(place) = places {
        report.warnings.push(format!(
            "the places (`{}`) are written as displacements from one to the next: the new file does not have the places",
            place.name()
        ));
    }
    // of places their displacements are written
    for kind in unwritten
        .into_iter()
        .filter(|kind| *kind != MeasurementKind::Position)
    {
        report.warnings.push(format!(
            "`{}` is not written: no message holds it",
            kind.name()
        ));
        report.outcome = Outcome::Doubtful;
    }
    for at in log.left_out().cut_off {
        report.warnings.push(cut_off(&at));
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}
