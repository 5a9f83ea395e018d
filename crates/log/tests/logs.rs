//! What a log says of itself: files, clocks, bytes, wheels and meanings; and what errors advise.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;

use grouser_files::Document;
use grouser_files::columns::{self, Meaning};
use grouser_files::topics::Topics;
use grouser_log::container::{Container, Format};
use grouser_log::message::{Value, build};
use grouser_log::{Cell, Error, Log, Measures, run_files};

use crate::choosing::topics;
use crate::recordings::write;
use crate::scratch::Folder;

const TABLE: &str = "t,n,g\n0,1,0.5\n0.1,2,0.25\n";

fn map(options: &str) -> columns::ColumnMap {
    let text = format!(
        "format = 1\n[[table]]\nfile = \"*.csv\"\n{options}\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n\
         {{ column = \"n\", meaning = \"wheel_count\", wheel = \"w\", unit = \"tick\" }},\n\
         {{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }},\n]\n"
    );
    columns::parse(&Document::from_text("map.toml", text).unwrap()).unwrap()
}

/// Two messages of each of two topics.
fn messages() -> Vec<(&'static str, &'static str, i64, Value)> {
    let mut all = Vec::new();
    for time in [0, 100_000_000] {
        let header = build::header(time, "imu");
        all.push((
            "/imu",
            "sensor_msgs/Imu",
            time,
            build::planar_imu(header, Some(0.1), None),
        ));
        let twist = build::twist([0.2, 0.0, 0.0], [0.0; 3]);
        all.push(("/cmd_vel", "geometry_msgs/Twist", time, twist));
    }
    all
}

#[test]
fn a_log_of_a_table_and_a_recording() {
    let folder = Folder::new("logs");
    let table = folder.file("log.csv", TABLE.as_bytes());
    let other = folder.file("notes.txt", b"nothing");
    let recording = write(&folder.0.join("run.mcap"), &messages());
    let paths = [table.clone(), other.clone(), recording.clone()];
    let log = |options: &str, wanted: &str| {
        Log::find_any(&paths, Some(map(options)), &topics(wanted)).unwrap()
    };
    let both = log("", "");
    assert_eq!(both.files().collect::<Vec<_>>(), [&table, &recording]);
    assert_eq!(both.unused(), [other]);
    // the table's, and one of each topic
    assert_eq!((both.clocks(), both.unaligned_clocks()), (3, vec![]));
    assert_eq!(log("align_clock = true", "").unaligned_clocks(), [0]);
    assert_eq!(log("", "align_clock = true").unaligned_clocks(), [1]);
    let bytes = (TABLE.len() as u64) + fs::metadata(&recording).unwrap().len();
    assert_eq!((both.bytes(), both.bytes_read()), (bytes, 0));
    assert_eq!(both.samples(&[]).unwrap().count(), 8);
    assert_eq!(both.bytes_read(), bytes);
    both.samples(&[]).unwrap().for_each(drop);
    assert_eq!(both.bytes_read(), 2 * bytes);
    let measures: &dyn Measures = &both;
    assert_eq!(measures.wheels(), ["left", "right", "w"]);
    assert_eq!(both.wheels(), measures.wheels());
    let found = [
        Meaning::WheelCount,
        Meaning::CommandForward,
        Meaning::YawRate,
        Meaning::PoseX,
    ]
    .map(|meaning| measures.measures(meaning));
    assert_eq!(found, [true, true, true, false]);
    for (meaning, wheel, is_measured) in [
        (Meaning::WheelCount, "w", true),
        (Meaning::WheelCount, "left", false),
        (Meaning::WheelAngle, "w", false),
        (Meaning::YawRate, "w", false),
    ] {
        assert_eq!(
            measures.measures_wheel(meaning, wheel),
            is_measured,
            "{meaning:?} {wheel}"
        );
    }
    assert_eq!(measures.position_sigma(), None);
}

#[test]
fn a_table_needs_its_columns_and_a_recording_does_not() {
    let folder = Folder::new("needs");
    let table = folder.file("log.csv", TABLE.as_bytes());
    assert!(Log::needs_columns(std::slice::from_ref(&table)).unwrap());
    let recording = write(&folder.0.join("run.mcap"), &messages());
    assert!(!Log::needs_columns(&[table, recording]).unwrap());
    let kinds = [
        folder.0.join("run.mcap"),
        folder.0.join("log.csv"),
        folder.file("run.bag", b"#ROSBAG V2.0"),
    ];
    let kinds = kinds.map(|path| Container::kind(&path).unwrap());
    assert_eq!(kinds, [Some(Format::Mcap), None, Some(Format::Bag)]);
    let database = folder.file("run.db3", b"SQLite format 3\0 and more");
    assert_eq!(Container::kind(&database).unwrap(), Some(Format::Rosbag2));
}

#[test]
fn two_files_of_one_table_and_none_at_all() {
    let folder = Folder::new("two");
    let [a, b] = ["a.csv", "b.csv"].map(|name| folder.file(name, TABLE.as_bytes()));
    let error = Log::find(&[a, b], map("")).unwrap_err().to_string();
    assert!(error.contains("both fit the table \"*.csv\""), "{error}");
    let other = folder.file("a.txt", TABLE.as_bytes());
    let error = Log::find(&[other], map("")).unwrap_err().to_string();
    assert!(
        error.ends_with("no file fits the column map (*.csv)"),
        "{error}"
    );
    let any = crate::scratch::map("");
    let nothing = Log::find(&[folder.0.join("a")], any);
    assert!(nothing.is_err_and(|error| error.to_string().contains("the table \"*\"")));
}

#[test]
fn a_kind_of_file_is_known_by_sixteen_bytes() {
    let wait = || panic!("there are sixteen");
    let input = Cursor::new(b"t,n,g\n0,1,0.125\n");
    assert_eq!(input.get_ref().len(), 16);
    let log = Log::growing(
        "a.csv".as_ref(),
        input,
        wait,
        Some(map("")),
        &Topics::default(),
    );
    assert!(log.is_ok());
}

#[test]
fn a_name_may_be_the_beginning_of_one_here() {
    // tests run in the crate's folder
    assert_eq!(
        run_files("Cargo.tom".as_ref()).unwrap(),
        ["./Cargo.toml"].map(PathBuf::from)
    );
    assert!(run_files("Cargo.xyz".as_ref()).is_err());
}

#[test]
#[allow(clippy::too_many_lines, reason = "one entry an error")]
fn errors_say_where_and_what_to_do() {
    let cell = |column, name: Option<&str>| Cell {
        file: "a.csv".into(),
        line: 3,
        column,
        name: name.map(Into::into),
    };
    assert_eq!(cell(None, None).to_string(), "a.csv: line 3");
    assert_eq!(cell(Some(2), None).to_string(), "a.csv: line 3, column 2");
    assert_eq!(
        cell(Some(2), Some("n")).to_string(),
        "a.csv: line 3, column 2 `n`"
    );
    let text = || "x".to_owned();
    let no_topic = |meant: Option<&str>| Error::NoTopic {
        file: text(),
        topic: text(),
        meant: meant.map(Into::into),
    };
    let no_named = |meant: Option<&str>| Error::NoNamedTopic {
        file: text(),
        key: "pose",
        topic: text(),
        meant: meant.map(Into::into),
    };
    let no_column = |meant: Option<&str>| Error::NoColumn {
        at: cell(None, None),
        column: text(),
        meant: meant.map(Into::into),
    };
    let unfit = Error::UnfitTopic {
        file: text(),
        key: "pose",
        topic: text(),
        type_name: text(),
        wanted: "a pose",
    };
    let no_joints = Error::NoJoints {
        file: text(),
        topic: text(),
        joints: text(),
    };
    let not_a_number = Error::NotANumber {
        at: cell(None, None),
        found: text(),
        expected: "a number",
        hint: Some("write one"),
    };
    let two_files = Error::TwoFiles {
        first: text(),
        second: text(),
        pattern: text(),
    };
    let late = Error::OutOfOrder {
        at: cell(None, None),
        by_s: 1.0,
        look_ahead: 5,
    };
    let set_back = Error::SetBack {
        at: cell(None, None),
        by_s: 100.0,
    };
    for (error, hint) in [
        (no_column(Some("meant")), "did you mean `meant`?"),
        (no_topic(Some("meant")), "did you mean `meant`?"),
        (no_named(Some("meant")), "did you mean `meant`?"),
        (
            no_topic(None),
            "`grouser log info` lists the topics of a file",
        ),
        (
            no_named(None),
            "`grouser log info` lists the topics of a file",
        ),
        (
            unfit,
            "any number of a message can be named under `[[topics.field]]`",
        ),
        (
            Error::Mixed { path: text() },
            "name the files that are meant",
        ),
        (no_joints, "`joint` of a `[[wheel]]` names its joint"),
        (not_a_number, "write one"),
        (
            two_files,
            "name the files of one run, or the beginning that their names share",
        ),
        (set_back, "split the log where its clock was set"),
        (
            late,
            "sort the log by time, or split it; a column of the nanoseconds within a second is named with that of the seconds: \
             `time = { column = \"sec\", unit = \"s\", nanoseconds = \"nanosec\" }`",
        ),
    ] {
        assert_eq!(error.hint().as_deref(), Some(hint), "{error}");
    }
    let later = Document::from_text("map.toml", "format = 9\n".to_owned());
    let later = later
        .and_then(|document| columns::parse(&document))
        .unwrap_err();
    assert!(Error::from(later).hint().unwrap().contains("newer version"));
    assert_eq!(Error::NotALog { file: text() }.hint(), None);
    assert_eq!(no_column(None).hint(), None);
}
