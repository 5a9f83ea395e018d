//! `log info`: what a recorded log holds.

use std::path::PathBuf;

use grouser_log::container::Container;
use grouser_log::{Sheet, Survey, Use, suggest_for_sheet, suggest_for_survey};
use serde_json::Value;

use super::sheet;
use super::{damages_object, damages_text, keyed, printable};
use crate::error::Result;
use crate::progress::Progress;
use crate::report::{Object, Report};
use crate::session::Session;
use crate::verbs::estimate::{log_error, note_input};
use grouser_report::Table;

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Example:\n  grouser log info examples/five-wheel/log.csv --suggest-robot > robot.toml\n  grouser \
        estimate examples/five-wheel/log.csv --robot robot.toml"
)]
pub(super) struct Arguments {
    /// The log: an MCAP file, a ROS 1 bag, or a table (CSV, plain or gzip)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Print a robot file to start from instead: what the log cannot tell is marked in it
    #[arg(long)]
    suggest_robot: bool,
}

pub(super) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let file = &arguments.file;
    let is_table = Container::kind(file).map_err(log_error)?.is_none();
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let (mut report, robot) = if is_table {
        let sheet = Sheet::read(file, |read| progress.reach(read)).map_err(log_error)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        (sheet::report(&sheet), suggest_for_sheet(&sheet, &name))
    } else {
        let survey = Survey::read(file, |offset| progress.reach(offset)).map_err(log_error)?;
        let mut report = Report::done(object(&survey), text(&survey));
        if survey.damage_count > 0 {
            report.warnings.push(format!(
                "{} places are damaged, {} bytes are lost in them",
                survey.damage_count, survey.bytes_lost
            ));
        }
        (report, suggest_for_survey(&survey))
    };
    drop(progress);
    note_input(session, file)?;
    if arguments.suggest_robot {
        report.text.clone_from(&robot);
        report.object.insert("suggested_robot".into(), robot.into());
    }
    Ok(report)
}

/// What an estimate of slip needs and the log does not have.
fn lacks(survey: &Survey) -> Vec<&'static str> {
    let needs = [
        (
            Use::Wheels,
            "wheel angles or rates (sensor_msgs/JointState)",
        ),
        (Use::YawRate, "a yaw rate (sensor_msgs/Imu)"),
        (
            Use::Motion,
            "a pose or speed over ground (nav_msgs/Odometry, geometry_msgs/PoseStamped)",
        ),
    ];
    let missing = needs.into_iter().filter(|(wanted, _)| !survey.has(*wanted));
    missing.map(|(_, words)| words).collect()
}

fn object(survey: &Survey) -> Object {
    let topics = survey.topics.iter().map(|topic| {
        let fields = [
            ("type", Value::from(topic.channel.type_name.as_str())),
            (
                "encoding",
                Value::from(topic.channel.encoding_name.as_str()),
            ),
            ("messages", Value::from(topic.messages)),
            ("bytes", Value::from(topic.bytes)),
            ("rate_hz", Value::from(topic.rate_hz)),
            (
                "intervals_of",
                Value::from(if topic.stamped {
                    "header.stamp"
                } else {
                    "log_time"
                }),
            ),
            ("longest_interval_s", Value::from(topic.longest_s)),
            ("gaps", Value::from(topic.gaps)),
            ("clock_jumps", Value::from(topic.jumps)),
            ("undecoded", Value::from(topic.undecoded)),
            ("problem", Value::from(topic.problem.as_deref())),
            ("use", Value::from(topic.use_for.map(Use::words))),
            ("joints", Value::from(topic.joints.clone())),
        ];
        let mut object = keyed(fields);
        object.insert("topic".into(), topic.channel.topic.as_str().into());
        Value::Object(object)
    });
    keyed([
        ("format", Value::from(survey.format.name())),
        ("duration_s", Value::from(survey.duration_s())),
        ("first_ns", Value::from(survey.first_ns)),
        ("last_ns", Value::from(survey.last_ns)),
        ("topics", topics.collect()),
        ("lacks", lacks(survey).into()),
        ("damage_count", Value::from(survey.damage_count)),
        ("bytes_lost", Value::from(survey.bytes_lost)),
        ("damages", damages_object(&survey.damages)),
    ])
}

fn text(survey: &Survey) -> String {
    let mut table = Table::new()
        .text("topic")
        .text("type")
        .number("messages")
        .number("Hz")
        .number("longest s")
        .number("gaps")
        .number("jumps")
        .text("use");
    for topic in &survey.topics {
        let rate = topic
            .rate_hz
            .map_or_else(|| "–".into(), |rate| format!("{rate:.2}"));
        let use_for = match (&topic.problem, topic.use_for) {
            (Some(problem), _) => format!("{} not decoded: {problem}", topic.undecoded),
            (None, Some(use_for)) => use_for.words().to_owned(),
            (None, None) => "–".to_owned(),
        };
        table.row([
            printable(&topic.channel.topic),
            printable(&topic.channel.type_name),
            topic.messages.to_string(),
            rate,
            format!("{:.3}", topic.longest_s),
            topic.gaps.to_string(),
            topic.jumps.to_string(),
            printable(&use_for),
        ]);
    }
    let duration = survey
        .duration_s()
        .map_or_else(|| "no messages".to_owned(), |s| format!("{s:.3} s"));
    let mut lines = vec![
        format!("{}, {duration}", survey.format.name()),
        String::new(),
    ];
    lines.push(table.render());
    let missing = lacks(survey);
    if missing.is_empty() {
        lines.push("has wheels, yaw rate and motion".to_owned());
    } else {
        lines.push(format!("for slip it lacks {}", missing.join("; ")));
    }
    lines.join("\n") + "\n" + &damages_text(&survey.damages)
}
