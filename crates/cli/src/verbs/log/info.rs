//! `log info`: what a recorded log holds.

use std::path::PathBuf;

use grouser_log::container::Container;
use grouser_log::{Sheet, Survey, Topic, Use, suggest_for_sheet, suggest_for_survey};
use grouser_report::{Fields, fields};
use serde_json::{Value, json};

use super::copied::{damage, damages_text};
use super::sheet;
use crate::error::Result;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;

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
    let is_table = Container::kind(file)?.is_none();
    let progress = Progress::of_bytes(std::fs::metadata(file).ok().map(|found| found.len()));
    let (mut report, robot) = if is_table {
        let sheet = Sheet::read(file, |read| progress.reach(read))?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        (sheet::report(&sheet), suggest_for_sheet(&sheet, &name))
    } else {
        let survey = Survey::read(file, |offset| progress.reach(offset))?;
        let mut report = Report::done(fields().object(&survey), text(&survey));
        if survey.damage_count > 0 {
            report.warnings.push(format!(
                "{} places are damaged, {} bytes are lost in them",
                survey.damage_count, survey.bytes_lost
            ));
        }
        (report, suggest_for_survey(&survey))
    };
    drop(progress);
    session.used_file(file)?;
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

fn topic<'a>() -> Fields<'a, &'a Topic> {
    fn use_for(topic: &Topic) -> String {
        match (&topic.problem, topic.use_for) {
            (Some(problem), _) => format!("{} not decoded: {problem}", topic.undecoded),
            (None, Some(use_for)) => use_for.words().to_owned(),
            (None, None) => "–".to_owned(),
        }
    }
    fields! { |topic: &'a Topic|
        "type" "type" .shown("") = topic.channel.type_name.as_str();
        "encoding" "encoding of its messages" = topic.channel.encoding_name.as_str();
        "messages" "messages" .shown("") = topic.messages;
        "bytes" "bytes" = topic.bytes;
        "rate_hz" "rate" .shown("").label("Hz").decimals(2) = topic.rate_hz;
        "intervals_of" "what intervals are measured by" = if topic.stamped { "header.stamp" } else { "log_time" };
        "longest_interval_s" "longest interval" .shown("s").label("longest").decimals(3) = topic.longest_s;
        "gaps" "gaps" .shown("") = topic.gaps;
        "clock_jumps" "clock jumps" .shown("").label("jumps") = topic.jumps;
        "undecoded" "messages that could not be decoded" = topic.undecoded;
        "problem" "why they could not" = topic.problem.as_deref();
        "use" "what Grouser uses it for" = topic.use_for.map(Use::words);
        remark "use" = use_for(topic);
        "joints" "joints that it names" = topic.joints.clone();
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

/// Of an MCAP file or a bag, or of a table; with `--suggest-robot` the proposed file too.
pub(super) fn schema() -> Value {
    let schemas = [fields().schema(), sheet::fields().schema()].map(|mut schema| {
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
    let mut lines = vec![
        format!("{}, {duration}", survey.format.name()),
        String::new(),
    ];
    lines.push(
        topic()
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
            .table(&survey.topics),
    );
    let missing = lacks(survey);
    if missing.is_empty() {
        lines.push("has wheels, yaw rate and motion".to_owned());
    } else {
        lines.push(format!("for slip it lacks {}", missing.join("; ")));
    }
    lines.join("\n") + "\n" + &damages_text(&survey.damages)
}
