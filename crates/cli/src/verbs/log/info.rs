//! `log info`: what a recorded log holds.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::{Path, PathBuf};

use grouser_log::container::Container;
use grouser_log::{Sheet, Survey, Topic, Use, run_files, suggest_for_sheets, suggest_for_survey};
use grouser_report::{Fields, fields, printable};
use serde_json::{Value, json};

use super::copied::{damage, damages_text};
use super::sheet;
use crate::error::{Error, Result, shown};
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::{Medium, Report};

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Example:\n  grouser log info examples/five-wheel/log.csv --suggest-robot > robot.toml\n"
)]
pub(super) struct Arguments {
    /// The log: an MCAP file, a ROS 1 bag, a table (CSV, plain or gzip), a folder of them (such as rosbag2 writes), or the
    /// beginning that the names of one run's files share
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Print a robot file to start from instead: what the log cannot tell is marked in it
    #[arg(long)]
    suggest_robot: bool,
}

/// Endings of names of tables: in a folder, other text is not read as one.
const TABLES: [&str; 3] = ["csv", "tsv", "txt"];

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let (run, unread) = Run::read(&arguments.log)?;
    for file in &run.files {
        session.used_file(file)?;
    }
    let mut report = run.report();
    if !unread.is_empty() {
        let _ = writeln!(report.text, "\nnot read: {}", unread.join(", "));
    }
    if arguments.suggest_robot {
        let robot = run.suggestion();
        report.text.clone_from(&robot);
        report.medium = Medium::File;
        report.object.insert("suggested_robot".into(), robot.into());
    }
    Ok(report)
}

/// The files of one run, read whole.
struct Run {
    /// MCAP files or bags.
    survey: Option<Survey>,
    /// Tables, each with its file name.
    sheets: Vec<(String, Sheet)>,
    files: Vec<PathBuf>,
}

impl Run {
    /// Reads the files that a path means; returns the names of those that are no log too.
    fn read(path: &Path) -> Result<(Self, Vec<String>)> {
        let found = run_files(path)?;
        let is_named = found.as_slice() == [path.to_owned()];
        let (mut recordings, mut tables, mut unread) = (Vec::new(), Vec::new(), Vec::new());
        for file in found {
            if Container::kind(&file)?.is_some() {
                recordings.push(file);
            } else if is_named || is_table(&file) {
                tables.push(file);
            } else {
                unread.push(file_name(&file));
            }
        }
        if recordings.is_empty() && tables.is_empty() {
            return Err(Error::usage(
                format!("{} holds no log", shown(path)),
                "a log is an MCAP file, a ROS 1 bag, or a table (.csv, .tsv, .txt; plain or gzip)",
            ));
        }
        let files: Vec<PathBuf> = recordings.iter().chain(&tables).cloned().collect();
        let length = |file: &PathBuf| std::fs::metadata(file).map_or(0, |found| found.len());
        let progress = Progress::of_bytes(Some(files.iter().map(length).sum()));
        let survey = if recordings.is_empty() {
            None
        } else {
            Some(Survey::read_run(&recordings, |offset| {
                progress.reach(offset);
            })?)
        };
        let mut before: u64 = recordings.iter().map(length).sum();
        let mut sheets = Vec::new();
        for file in tables {
            let sheet = Sheet::read(&file, |read| progress.reach(before + read))?;
            before += length(&file);
            sheets.push((file_name(&file), sheet));
        }
        let run = Self {
            survey,
            sheets,
            files,
        };
        Ok((run, unread))
    }

    fn report(&self) -> Report {
        let survey = self.survey.as_ref();
        match (survey, self.sheets.as_slice()) {
            (Some(survey), []) => recording_report(survey),
            (None, [(_, sheet)]) => sheet::report(sheet),
            (survey, sheets) => {
                let mut report = Report::done(of_run().object(self), String::new());
                let mut add = |title: &str, part: Report| {
                    let _ = writeln!(report.text, "{title}\n{}", part.text);
                    report.warnings.extend(part.warnings);
                };
                if let Some(survey) = survey {
                    add("MCAP files and bags:", recording_report(survey));
                }
                for (name, sheet) in sheets {
                    add(&format!("{}:", printable(name)), sheet::report(sheet));
                }
                report
            }
        }
    }

    fn suggestion(&self) -> String {
        if let Some(survey) = &self.survey {
            return suggest_for_survey(survey);
        }
        let sheets = self.sheets.iter();
        suggest_for_sheets(sheets.map(|(name, sheet)| (sheet, name.as_str())))
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn is_table(path: &Path) -> bool {
    let name = file_name(path).to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.')
        .is_some_and(|(_, ending)| TABLES.contains(&ending))
}

fn recording_report(survey: &Survey) -> Report {
    let mut report = Report::done(fields().object(survey), text(survey));
    if survey.damage_count > 0 {
        report.warnings.push(format!(
            "{} places are damaged, {} bytes are lost in them",
            survey.damage_count, survey.bytes_lost
        ));
    }
    report
}

/// What an estimate of slip needs and the log does not have.
fn lacks(survey: &Survey) -> Vec<&'static str> {
    let needs = [
        (
            &[Use::Wheels][..],
            "wheel angles or rates (sensor_msgs/JointState)",
        ),
        (
            &[Use::YawRate, Use::Motion, Use::Transforms],
            "a yaw rate or a heading (sensor_msgs/Imu, or a pose)",
        ),
        (
            &[Use::Motion, Use::Position, Use::Transforms],
            "a pose, place or speed over ground (nav_msgs/Odometry, geometry_msgs/PoseStamped, PointStamped or others)",
        ),
    ];
    let missing =
        (needs.into_iter()).filter(|(wanted, _)| !wanted.iter().any(|wanted| survey.has(*wanted)));
    missing.map(|(_, words)| words).collect()
}

fn topic<'a>() -> Fields<'a, &'a Topic> {
    fn use_for(topic: &Topic) -> String {
        match (&topic.problem, topic.use_for) {
            (Some(problem), _) => format!("{} not decoded: {problem}", topic.undecoded),
            (None, Some(use_for)) => {
                let moves = topic.moves.as_ref();
                let frames = moves.map(|(base, fixed)| format!(" ({base} in {fixed})"));
                format!("{}{}", use_for.words(), frames.unwrap_or_default())
            }
            (None, None) => "-".to_owned(),
        }
    }
    fields! { |topic: &'a Topic|
        "type" "type" .shown("") = topic.channel.type_name.as_str();
        "encoding" "encoding of its messages" = topic.channel.encoding_name.as_str();
        "messages" "messages" .shown("") = topic.messages;
        "bytes" "bytes" = topic.bytes;
        "rate_hz" "rate" .shown("Hz") = topic.rate_hz;
        "intervals_of" "what intervals are measured by" = if topic.stamped { "header.stamp" } else { "log_time" };
        "longest_interval_s" "longest interval" .shown("s").label("longest") = topic.longest_s;
        "gaps" "gaps" .shown("") = topic.gaps;
        "clock_jumps" "clock jumps" .shown("").label("jumps") = topic.jumps;
        "undecoded" "messages that could not be decoded" = topic.undecoded;
        "problem" "why they could not" = topic.problem.as_deref();
        "use" "what Grouser uses it for" = topic.use_for.map(Use::words);
        remark "use" = use_for(topic);
        "joints" "joints that it names" = topic.joints.clone();
        "moves" "of transforms that move a robot: its frame" = topic.moves.as_ref().map(|(base, _)| base.as_str());
        "moves_in" "and the frame in which it moves" = topic.moves.as_ref().map(|(_, fixed)| fixed.as_str());
        "topic" "topic" .shown("") = topic.channel.topic.as_str();
    }
}

fn fields<'a>() -> Fields<'a, &'a Survey> {
    fields! { |survey: &'a Survey|
        "format" "format" = survey.format.name();
        "duration_s" "time from the first message to the last" = survey.duration_s();
        "first_ns" "time of the first message" = survey.first_ns;
        "last_ns" "time of the last message" = survey.last_ns;
        "topics" "topics" rows(topic()) = &survey.topics;
        "lacks" "what an estimate of slip needs and the log does not have" = lacks(survey);
        "damage_count" "damaged places" = survey.damage_count;
        "bytes_lost" "bytes that are lost" = survey.bytes_lost;
        "damages" "the damaged places" rows(damage()) = &survey.damages;
    }
}

/// Several tables, or tables and recordings.
fn of_run<'a>() -> Fields<'a, &'a Run> {
    let table = fields! { |of: &'a (String, Sheet)|
        "file" "name of the file" = of.0.as_str();
        join(sheet::fields()) = &of.1;
    };
    fields! { |run: &'a Run|
        "recording" "MCAP files and bags, as one" group(fields()) = run.survey.as_ref();
        "tables" "tables" rows(table) = run.sheets.iter();
    }
}

/// Of MCAP files and bags, of a table, or of several files; with `--suggest-robot` the proposed file too.
pub(super) fn schema() -> Value {
    let schemas = [
        fields().schema(),
        sheet::fields().schema(),
        of_run().schema(),
    ]
    .map(|mut schema| {
        schema["properties"]["suggested_robot"] =
            json!({"type": "string", "description": "proposed robot file"});
        schema
    });
    json!({"anyOf": schemas})
}

fn text(survey: &Survey) -> String {
    let duration = survey
        .duration_s()
        .map_or_else(|| "no messages".to_owned(), |s| format!("{s:.3} s"));
    let missing = lacks(survey);
    let verdict = if missing.is_empty() {
        "slip can be estimated: wheels, turn and motion are there".to_owned()
    } else {
        format!("for slip this log lacks {}", missing.join("; "))
    };
    let format = survey.format.name();
    let table = topic()
        .pick(&[
            "topic",
            "type",
            "messages",
            "rate_hz",
            "longest_interval_s",
            "gaps",
            "clock_jumps",
            "use",
        ])
        .table(&survey.topics);
    format!(
        "{verdict}\n{format}, {duration}\n\n{table}{}",
        damages_text(&survey.damages)
    )
}
