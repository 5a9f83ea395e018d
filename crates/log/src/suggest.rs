//! A robot file to start from, by what a log holds.
//!
//! Values that no log holds: places are round numbers with a comment to measure them; radii and ticks per turn, which scale
//! every slip, are placeholders, with which the file is refused.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::{Read, Seek};
use std::path::PathBuf;

use grouser_files::columns::Meaning;
use grouser_files::{PLACEHOLDER, TomlText};

use crate::container::Container;
use crate::error::Result;
use crate::message::short;
use crate::recording::speed_of_number;
use crate::sheet::{
    Guess, Sheet, SheetColumn, guess, is_beyond_radians, is_second_clock, open_question, perhaps,
};
use crate::source::Source;
use crate::survey::{Survey, Topic, Use};

/// More wheels than a robot has.
const WHEELS: usize = 16;

/// A robot file for the files of one run, each with its name: recordings, or tables.
///
/// ```
/// let bytes = std::fs::read("../../examples/five-wheel/log.csv")?;
/// let robot = grouser_log::suggest_robot([("log.csv".into(), std::io::Cursor::new(bytes))])?;
/// assert!(robot.contains("radius_m = \"measure\"") && robot.contains("meaning = \"yaw_rate\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Of a file that is no log, or cannot be read.
pub fn suggest_robot(
    files: impl IntoIterator<Item = (PathBuf, impl Read + Seek + Send + 'static)>,
) -> Result<String> {
    let (mut recordings, mut tables) = (Vec::new(), Vec::new());
    for (name, source) in files {
        let source = Source::over(&name, source);
        if Container::kind_of(&source)?.is_some() {
            recordings.push(source);
        } else {
            tables.push((Sheet::from_source(&source, |_| ())?, source.name()));
        }
    }
    if recordings.is_empty() {
        let tables = tables.iter().map(|(sheet, name)| (sheet, name.as_str()));
        return Ok(suggest_for_sheets(tables));
    }
    Survey::from_sources(&recordings, |_| ()).map(|survey| suggest_for_survey(&survey))
}

/// A robot file for a bag or an MCAP file.
#[must_use]
pub fn suggest_for_survey(survey: &Survey) -> String {
    let of = |wanted: Use| {
        let mut topics = survey.topics.iter();
        topics.find(move |topic| topic.use_for == Some(wanted))
    };
    let mut topics = String::new();
    let name = |topic: &Topic| TomlText::quoted(&topic.channel.topic);
    let joints = of(Use::Wheels);
    if let Some(topic) = joints {
        let _ = writeln!(topics, "wheels = {}", name(topic));
    }
    if let Some(topic) = of(Use::YawRate) {
        let _ = writeln!(topics, "yaw_rate = {}", name(topic));
    }
    if let Some(topic) = of(Use::Command) {
        let _ = writeln!(topics, "command = {}", name(topic));
    }
    let motions = survey
        .topics
        .iter()
        .filter(|topic| topic.use_for == Some(Use::Motion));
    let odometry = |topic: &&Topic| topic.channel.type_name.ends_with("Odometry");
    let mut numbers = wheel_numbers(survey);
    numbers.retain(|_| joints.is_none());
    // Without joints and numbers of wheels, an odometry of the wheels stands for them.
    let is_without = joints.is_none() && numbers.is_empty();
    let stand_in = motions.clone().find(odometry).filter(|_| is_without);
    if let Some(topic) = stand_in {
        let _ = writeln!(
            topics,
            "wheel_odometry = {}\nwheel_odometry_track_m = 0.4  # the distance of left and right wheels in the \
             driver that made it: look it up",
            name(topic)
        );
    }
    for topic in motions.filter(|topic| !stand_in.is_some_and(|other| std::ptr::eq(other, *topic)))
    {
        let _ = writeln!(
            topics,
            "# pose = {}  # if it measures the ground (camera, GNSS, lidar); not if it was made of the wheels",
            name(topic)
        );
    }
    for topic in &survey.topics {
        if let Some((base, fixed)) = &topic.moves {
            let says = match topic.use_for {
                Some(Use::Transforms) => {
                    "used without this line where nothing else measures where the robot is"
                }
                _ => {
                    "if it measures the ground; not if it was made of the wheels, as most odometry is"
                }
            };
            let [base, fixed] = [base, fixed].map(|frame| TomlText::quoted(frame));
            let _ = writeln!(
                topics,
                "# pose = {}  # {base} in {fixed}: {says}",
                name(topic)
            );
        }
    }
    let mut wheels = joints.map_or_else(Vec::new, |topic| wheel_joints(&topic.joints));
    let mut counter = String::new();
    if joints.is_some_and(|topic| topic.channel.type_name.ends_with("/WheelTicks")) {
        counter = line(
            "counter_bits = 64",
            "look it up, or wheels whose counter wraps jump",
        );
    }
    for (topic, guess) in &numbers {
        let wheel = guess.wheel.clone().unwrap_or_default();
        let _ = write!(
            topics,
            "\n[[topics.field]]\ntopic = {}\nfield = \"data\"\nmeaning = \"{}\"\nwheel = {}\nunit = \"{}\"\n",
            name(topic),
            guess.meaning.name(),
            TomlText::quoted(&wheel),
            guess.unit
        );
        if guess.meaning == Meaning::WheelCount {
            let bits = (topic.channel.type_name)
                .trim_start_matches(|letter: char| !letter.is_ascii_digit());
            counter = line(
                &format!("counter_bits = {bits}"),
                "by the type of its topic",
            );
        }
        if !wheels.iter().any(|(own, _)| *own == wheel) {
            wheels.push((wheel, None));
        }
    }
    topics.push_str(&speed_fields(survey));
    robot(&topics, "", &wheels, true, &counter)
}

/// Topics of a number that may be the speed over ground, as comments.
fn speed_fields(survey: &Survey) -> String {
    let mut fields = String::new();
    for topic in &survey.topics {
        let name = &topic.channel.topic;
        if let Some(meaning) = speed_of_number(name, &topic.channel.type_name) {
            let _ = write!(
                fields,
                "\n# [[topics.field]]  # if it is the speed over ground, in m/s; not if it was made of the wheels\n# topic = \
                 {}\n# field = \"data\"\n# meaning = \"{}\"\n# unit = \"m/s\"\n",
                TomlText::quoted(name),
                meaning.name()
            );
        }
    }
    fields
}

/// Topics of one number each that their names call the sensor of a wheel, one of each wheel.
fn wheel_numbers(survey: &Survey) -> Vec<(&Topic, Guess)> {
    let mut found: Vec<(&Topic, Guess)> = Vec::new();
    for topic in &survey.topics {
        let type_name = short(&topic.channel.type_name);
        let Some(kind) = type_name.strip_prefix("std_msgs/") else {
            continue;
        };
        let is_whole = ["Int", "UInt"].iter().any(|whole| {
            let bits = kind.strip_prefix(whole);
            bits.is_some_and(|bits| ["8", "16", "32", "64"].contains(&bits))
        });
        // `lwheel` is how rosserial's examples name the left one
        let glued = [("lwheel", "wheel_l"), ("rwheel", "wheel_r")];
        let name = glued
            .iter()
            .fold(topic.channel.topic.clone(), |name, (glued, words)| {
                name.replace(glued, words)
            });
        let is_number = is_whole || matches!(kind, "Float32" | "Float64");
        let guess = guess(&name, None, is_whole).filter(|guess| {
            let same = |(_, other): &(&Topic, Guess)| other.wheel == guess.wheel;
            is_number && guess.wheel.is_some() && !found.iter().any(same)
        });
        found.extend(guess.map(|guess| (topic, guess)));
    }
    found
}

/// A robot file with its column map for the tables of a run, each with its file name.
#[must_use]
pub fn suggest_for_sheets<'a>(sheets: impl IntoIterator<Item = (&'a Sheet, &'a str)>) -> String {
    let mut tables = Vec::new();
    let mut wheels: Vec<(String, Option<String>)> = Vec::new();
    let (mut counts, mut bits) = (false, None);
    let mut needs_reference = true;
    for (sheet, file_name) in sheets {
        tables.push(table(sheet, file_name));
        let open = sheet.columns.iter().filter(|column| column.guess.is_none());
        let open = open.filter_map(|column| Some(open_question(column)?.0));
        for wheel in sheet.wheels().into_iter().chain(open) {
            if !wheels.iter().any(|(other, _)| *other == wheel) {
                wheels.push((wheel, None));
            }
        }
        let counters = sheet.columns.iter().filter(|column| {
            let guess = column.guess.as_ref();
            guess.is_some_and(|guess| guess.meaning == Meaning::WheelCount)
        });
        counts |= counters.clone().count() > 0;
        bits = bits.max(counters.filter_map(SheetColumn::wraps_at_bits).max());
        let motion = [
            Meaning::PoseX,
            Meaning::Latitude,
            Meaning::SpeedForward,
            Meaning::SpeedSize,
            Meaning::DisplacementForward,
        ];
        needs_reference &= !motion.into_iter().any(|meaning| sheet.has(meaning));
    }
    let counter = match (counts, bits) {
        (false, _) => String::new(),
        (true, Some(bits)) => line(
            &format!("counter_bits = {bits}"),
            "the counters wrap in this log",
        ),
        (true, None) => line(
            "counter_bits = 64",
            "look it up: the counters do not wrap in this log",
        ),
    };
    robot("", &tables.join("\n"), &wheels, needs_reference, &counter)
}

/// The column map of one table.
fn table(sheet: &Sheet, file_name: &str) -> String {
    let mut table = String::from("[[table]]\n");
    let _ = writeln!(table, "file = {}", TomlText::quoted(file_name));
    let byte = |byte: u8| TomlText::quoted(&char::from(byte).to_string());
    if sheet.separator != b',' {
        let separator = if sheet.separator == b'\t' {
            TomlText::quoted("tab")
        } else {
            byte(sheet.separator)
        };
        let _ = writeln!(table, "separator = {separator}");
    }
    if sheet.decimal != b'.' {
        let _ = writeln!(table, "decimal = {}", byte(sheet.decimal));
    }
    if (sheet.header_lines, sheet.names_line) != (1, 1) {
        let _ = writeln!(table, "header_lines = {}", sheet.header_lines);
    }
    if sheet.header_lines > 0 && (sheet.header_lines, sheet.names_line) != (1, 1) {
        let _ = writeln!(table, "names_line = {}", sheet.names_line);
    }
    match &sheet.time {
        Some(time) => {
            let _ = writeln!(
                table,
                "time = {{ column = {}, unit = \"{}\"{} }}",
                TomlText::quoted(&sheet.columns[time.column].name),
                time.unit,
                time.nanoseconds.map_or_else(String::new, |column| format!(
                    ", {} = {}",
                    if time.unit == "date" {
                        "time_of_day"
                    } else {
                        "nanoseconds"
                    },
                    TomlText::quoted(&sheet.columns[column].name)
                ))
            );
        }
        None => {
            table.push_str("time = { column = \"time\", unit = \"s\" }  # not found: name it\n");
        }
    }
    table.push_str(&missing(sheet));
    table.push_str("columns = [\n");
    let has_heading = sheet.has(Meaning::PoseYaw) || sheet.has(Meaning::OrientationZ);
    let lacks_yaw = sheet.has(Meaning::PoseX) && !has_heading;
    let time = sheet.time.as_ref().map(|time| time.column);
    for (index, column) in sheet.columns.iter().enumerate() {
        let Some(guess) = &column.guess else {
            if let Some((wheel, question)) = open_question(column).filter(|_| Some(index) != time) {
                let _ = writeln!(
                    table,
                    "    # {{ column = {}, meaning = \"\", wheel = {}, unit = \"\" }},  # {question}",
                    TomlText::quoted(&column.name),
                    TomlText::quoted(&wheel)
                );
            } else if let Some((guess, condition)) = perhaps(column)
                && (guess.meaning != Meaning::PoseYaw || lacks_yaw || column.name.starts_with('/'))
            {
                let _ = writeln!(table, "    # {}  # {condition}", entry(column, &guess));
            } else if sheet.header_lines == 0 && Some(index) != time && column.numbers > 0 {
                let counts = if column.whole {
                    "; of a counter the sum since the start is read, not the ticks since the row before"
                } else {
                    ""
                };
                let _ = writeln!(
                    table,
                    "    # {{ column = {}, meaning = \"\", unit = \"\" }},  # from {} to {}: what is it, in which unit?{counts}",
                    TomlText::quoted(&column.name),
                    column.min,
                    column.max
                );
            } else if sheet.time.is_some() && Some(index) != time && is_second_clock(column) {
                let _ = writeln!(
                    table,
                    "    # {}: another clock; columns that are stamped by it need a file of their own",
                    TomlText::quoted(&column.name)
                );
            }
            continue;
        };
        let is_by_size = guess.meaning == Meaning::YawRate && is_beyond_radians(column);
        let comment = if is_by_size {
            "  # its numbers are more than a robot turns in rad/s"
        } else {
            ""
        };
        let _ = writeln!(table, "    {}{comment}", entry(column, guess));
    }
    table.push_str("]\n");
    if sheet.columns.iter().all(|column| column.guess.is_none()) {
        // Nothing was recognised: a pattern to fill in.
        let lines = table.lines().map(|line| format!("# {line}\n"));
        table = lines.collect();
    }
    table
}

/// The words for numbers that are missing, as a column map lists them.
fn missing(sheet: &Sheet) -> String {
    let words = sheet.columns.iter();
    let mut words: Vec<&str> = words
        .filter_map(|column| column.missing.as_deref())
        .collect();
    words.sort_unstable();
    words.dedup();
    let quoted: Vec<String> = words.into_iter().map(TomlText::quoted).collect();
    if quoted.is_empty() {
        return String::new();
    }
    format!("missing = [{}]\n", quoted.join(", "))
}

/// What a column map says of a column.
fn entry(column: &SheetColumn, guess: &Guess) -> String {
    let wheel = guess.wheel.as_ref();
    let wheel = wheel.map_or_else(String::new, |wheel| {
        format!(", wheel = {}", TomlText::quoted(wheel))
    });
    format!(
        "{{ column = {}, meaning = \"{}\"{wheel}, unit = \"{}\" }},",
        TomlText::quoted(&column.name),
        guess.meaning.name(),
        guess.unit
    )
}

/// The joints that are wheels: those that say so, else all.
fn wheel_joints(joints: &[String]) -> Vec<(String, Option<String>)> {
    let says = |joint: &&String| joint.to_lowercase().contains("wheel");
    let mut wheels: Vec<&String> = joints.iter().filter(|joint| !joint.is_empty()).collect();
    if wheels.iter().any(says) {
        wheels.retain(says);
    }
    wheels.sort_unstable();
    wheels.dedup();
    let name = |joint: &&String| {
        let parts = joint
            .split('_')
            .filter(|part| !matches!(*part, "joint" | "wheel" | "link"));
        let bare = parts.collect::<Vec<_>>().join("_");
        if bare.is_empty() {
            (*joint).clone()
        } else {
            bare
        }
    };
    let names: Vec<String> = wheels.iter().map(name).collect();
    // A short name that is another joint's, or another's short name, would be two wheels of one name.
    let unique = |own: &String| names.iter().filter(|other| *other == own).count() == 1;
    wheels
        .iter()
        .zip(&names)
        .take(WHEELS)
        .map(|(joint, own)| {
            let own = if unique(own) {
                own.clone()
            } else {
                (*joint).clone()
            };
            (own, Some((*joint).clone()))
        })
        .collect()
}

/// The whole file.
fn robot(
    topics: &str,
    table: &str,
    wheels: &[(String, Option<String>)],
    needs_reference: bool,
    counter: &str,
) -> String {
    let mut out = String::from(
        "# Proposed by `grouser log info --suggest-robot`: replace \"measure\" by numbers and check the others.\n\
         format = 1\nname = \"robot\"\n",
    );
    let both = [("left".to_owned(), None), ("right".to_owned(), None)];
    let wheels = if wheels.is_empty() { &both } else { wheels };
    let free = wheels.iter().any(|(name, _)| is_free(name));
    if !free && needs_reference {
        out.push_str(
            "\n[estimator]\n# reference = \"speed\"  # or pose, displacement, free-wheel: nothing that surely measures the \
             ground was found, so only the wheels' differences of slip are observable\n",
        );
    }
    if !topics.is_empty() {
        let _ = write!(out, "\n[topics]\n{topics}");
    }
    for (index, (name, joint)) in wheels.iter().take(WHEELS).enumerate() {
        let (x, y) = place(name, index);
        let _ = write!(out, "\n[[wheel]]\nname = {}\n", TomlText::quoted(name));
        if let Some(joint) = joint.as_ref().filter(|joint| *joint != name) {
            let _ = writeln!(out, "joint = {}", TomlText::quoted(joint));
        }
        let drive = if is_free(name) { "free" } else { "powered" };
        out.push_str(&line(
            &format!("x_m = {x:?}"),
            "forwards of the robot's origin: measure",
        ));
        out.push_str(&line(&format!("y_m = {y:?}"), "to the left of it: measure"));
        let placeholder = |key: &str| format!("{key} = \"{PLACEHOLDER}\"");
        out.push_str(&line(&placeholder("radius_m"), "on which it rolls"));
        let _ = writeln!(out, "drive = \"{drive}\"");
        if !counter.is_empty() {
            out.push_str(&line(
                &placeholder("ticks_per_turn"),
                "of the wheel: look it up",
            ));
            out.push_str(counter);
        }
    }
    if !table.is_empty() {
        let _ = write!(out, "\n{table}");
    }
    out
}

/// An entry with its comment.
fn line(entry: &str, comment: &str) -> String {
    format!("{entry:<22} # {comment}\n")
}

fn name_words(name: &str) -> Vec<String> {
    let parts = name.split(|letter: char| !letter.is_alphanumeric());
    parts.map(str::to_lowercase).collect()
}

fn is_free(name: &str) -> bool {
    let words = name_words(name);
    let free = [
        "free", "fifth", "caster", "castor", "dead", "odometry", "pod",
    ];
    words.iter().any(|word| free.contains(&word.as_str()))
}

/// Where a wheel of that name probably is.
fn place(name: &str, index: usize) -> (f64, f64) {
    let words = name_words(name);
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let x = if is(&["front", "fl", "fr", "lf", "rf", "f"]) {
        0.2
    } else if is(&["rear", "back", "rl", "rr", "bl", "br", "lr", "rb", "lb"]) || is_free(name) {
        -0.2
    } else {
        0.0
    };
    let y = if is(&["left", "l", "fl", "rl", "bl", "lf", "lr", "lb"]) {
        0.2
    } else if is(&["right", "r", "fr", "rr", "br", "rf", "rb"]) {
        -0.2
    } else if is_free(name) {
        0.0
    } else if index.is_multiple_of(2) {
        0.2
    } else {
        -0.2
    };
    (x, y)
}
