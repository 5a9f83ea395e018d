//! Each type of messages that has a view has a file in `message_types/`: messages, and the readings of them.

use std::fs;
use std::path::Path;

use grouser_files::{Document, robot};
use grouser_log::Preview;
use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{View, known};
use grouser_slip::Sample;
use serde_json::{Value, json};

/// `GROUSER_WRITE_CASES=1` writes the readings into the files.
#[test]
fn every_type_is_read_as_its_file_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/message_types");
    for name in View::types() {
        let path = folder.join(format!("{}.json", name.replace('/', ".")));
        let text = fs::read_to_string(&path);
        let text = text.unwrap_or_else(|_| panic!("{} is missing", path.display()));
        let mut case: Value = serde_json::from_str(&text).unwrap();
        let found = readings(name, &case);
        assert!(!found.is_empty(), "{name}: nothing is read");
        let found = json!(found);
        if std::env::var_os("GROUSER_WRITE_CASES").is_some() {
            case["readings"] = found;
            fs::write(&path, serde_json::to_string_pretty(&case).unwrap() + "\n").unwrap();
        } else {
            assert_eq!(case["readings"], found, "{name}");
        }
    }
}

/// A node decodes by these definitions, as ROS 2 sends none.
#[test]
fn every_type_is_known_to_the_node_and_to_its_documentation() {
    let page = include_str!("../../../docs/live.md");
    // that type is ROS 1's, which has no node
    for name in View::types().filter(|name| *name != "tf/tfMessage") {
        let is_defined = known::definition(name).is_some();
        assert!(is_defined, "{name} has no definition");
        let mut rows = page.lines().filter(|line| line.starts_with('|'));
        let is_listed = rows.any(|row| row.contains(&format!("`{name}`")));
        assert!(is_listed, "{name} has no row in docs/live.md");
    }
}

/// Of the messages of a file, one every 100 ms.
fn readings(name: &str, case: &Value) -> Vec<String> {
    let text = |key: &str| case[key].as_str().unwrap().to_owned();
    let wheel = |name| {
        format!(
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n"
        )
    };
    let file = format!(
        "format = 1\nname = \"cart\"\n[topics]\n{}\n{}{}",
        text("robot"),
        wheel("left"),
        wheel("right").replace("0.2", "-0.2")
    );
    let robot = robot::parse(&Document::from_text("robot.toml", file).unwrap()).unwrap();
    let channel = Channel {
        topic: text("topic"),
        type_name: name.to_owned(),
        encoding: Encoding::Json,
        encoding_name: "json".into(),
        definition_language: String::new(),
        definition: Vec::new().into(),
        metadata: std::collections::BTreeMap::new(),
    };
    let messages: Vec<Vec<u8>> = case["messages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|message| message.to_string().into_bytes())
        .collect();
    let timed = || messages.iter().zip((1..).map(|k| 100_000_000 * k));
    let mut preview = Preview::new(&robot.topics);
    let own = preview.channel(&channel);
    for (message, time_ns) in timed() {
        preview.push(own, message, time_ns);
    }
    let mut intake = preview.into_intake().unwrap();
    let own = intake.channel(&channel);
    for (message, time_ns) in timed() {
        intake.push(own, message, time_ns);
    }
    intake.finish();
    let mut found = Vec::new();
    while let Some(Sample {
        time_ns,
        measurement,
    }) = intake.pop()
    {
        found.push(format!("{time_ns} {measurement:.6?}"));
    }
    found
}
