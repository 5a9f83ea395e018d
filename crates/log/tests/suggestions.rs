//! What is proposed for a log is a robot file that is read, whatever the names in the log are.

use std::fs::File;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_files::{Document, Error, robot};
use grouser_log::message::build;
use grouser_log::write::McapWriter;
use grouser_log::{Log, Sheet, Survey, suggest_for_sheets, suggest_for_survey};
use proptest::prelude::*;

use crate::scratch::Folder;

/// Each case has a folder of its own.
static CASE: AtomicUsize = AtomicUsize::new(0);

fn folder() -> Folder {
    Folder::new(&format!("suggest{}", CASE.fetch_add(1, Ordering::Relaxed)))
}

/// The file as it is proposed is refused; with numbers in place of the placeholders it is read.
fn read(text: &str) -> Result<robot::RobotFile, TestCaseError> {
    let proposed =
        Document::from_text("robot.toml", text.to_owned()).and_then(|d| robot::parse(&d));
    prop_assert!(
        matches!(&proposed, Err(Error::Placeholder { key, .. }) if key == "radius_m"),
        "{proposed:?}"
    );
    let text = text.replace("= \"measure\"", "= 2.0");
    let shown = text.clone();
    Document::from_text("robot.toml", text)
        .and_then(|document| robot::parse(&document))
        .map_err(|error| TestCaseError::fail(format!("{error}\n{shown}")))
}

/// Names as robots have them, and as nobody should.
fn names() -> impl Strategy<Value = Vec<String>> {
    let name = prop_oneof![
        "(front|rear|free)_(left|right)_wheel(_joint)?",
        "(wheel|joint|left|arm)",
        "\\PC{0,12}",
        "[\"\\\\\n\r\t\u{7f}a]{0,6}",
    ];
    prop::collection::vec(name, 0..20)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn for_any_joints(joints in names(), topic in "\\PC{1,20}") {
        let folder = folder();
        let path = folder.0.join("log.mcap");
        let mut writer = McapWriter::new(File::create(&path).unwrap(), "ros2").unwrap();
        let mut to = writer.topic(&topic, "sensor_msgs/JointState").unwrap();
        let given: Vec<&str> = joints.iter().map(String::as_str).collect();
        let angles = vec![0.5; given.len()];
        let message = build::joint_state(build::header(5, ""), &given, [&angles, &[], &[]]);
        writer.send(&mut to, 5, &message).unwrap();
        writer.finish().unwrap();
        let file = read(&suggest_for_survey(&Survey::read(&path, |_| ()).unwrap()))?;
        // And where there are wheels, the log is read with it.
        if joints.iter().any(|joint| !joint.is_empty()) {
            let log = Log::find_any(&[path], None, &file.topics);
            prop_assert!(log.unwrap().samples(&[]).unwrap().count() > 0);
        }
    }

    #[test]
    fn for_any_columns(mut columns in names(), file in "[^/\0]{1,12}") {
        columns.retain(|name| !name.contains(['\n', '\r', ',', '"', '\0']));
        let folder = folder();
        let mut text = ["time"].into_iter().chain(columns.iter().map(String::as_str)).collect::<Vec<_>>().join(",");
        for row in ["0", "1", "2", "3"] {
            text.push('\n');
            text.push_str(&[row].repeat(1 + columns.len()).join(","));
        }
        let path = folder.file("log.csv", text.as_bytes());
        if let Ok(sheet) = Sheet::read(&path, |_| ()) {
            read(&suggest_for_sheets([(&sheet, file.as_str())]))?;
        }
    }

    #[test]
    fn any_bytes_are_a_table_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = folder();
        for start in [&b""[..], b"time,left_ticks,yaw_rate\n0,1,2\n"] {
            let path = folder.file("log.csv", &[start, &bytes].concat());
            if let Ok(sheet) = Sheet::read(&path, |_| ()) {
                read(&suggest_for_sheets([(&sheet, "log.csv")]))?;
            }
        }
    }
}
