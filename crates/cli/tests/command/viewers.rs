//! Layouts for other programs' viewers name topics and fields that our recordings have.

use std::collections::BTreeSet;

use grouser_log::message::known;
use serde_json::Value;

use super::program::{Folder, grouser};

/// What stands between two marks of quotation, from `/` on.
fn paths(text: &str) -> BTreeSet<String> {
    let quoted = text.split('"');
    let quoted = quoted.filter(|part| part.starts_with('/') && !part.contains(char::is_whitespace));
    quoted.map(str::to_owned).collect()
}

#[test]
fn a_layout_names_what_a_recording_has() {
    let folder = Folder::new();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let recording = folder.path("slip.mcap").display().to_string();
    let [log, robot] = ["log.csv", "robot.toml"].map(|name| format!("{root}/five-wheel/{name}"));
    grouser(["estimate", &log, "--robot", &robot, "-o", &recording]).assert_done();
    let drive = folder.path("drive.mcap").display().to_string();
    let scenario = format!("{root}/scenarios/soft-patch.toml");
    grouser(["drive", &scenario, "-o", &drive]).assert_done();
    let topics = |recording: &str| -> Vec<Value> {
        let info = grouser(["log", "info", recording, "--json"]).assert_done();
        info.json()["topics"].as_array().unwrap().clone()
    };
    // layouts with a scene show drives as well, whose recordings have ruts and the truth
    let of_estimate = topics(&recording);
    let of_both = [of_estimate.clone(), topics(&drive)].concat();
    let mut named = 0;
    for (layout, topics) in [
        ("foxglove.json", &of_both),
        ("plotjuggler.xml", &of_estimate),
        ("rerun_blueprint.py", &of_both),
    ] {
        let text = std::fs::read_to_string(format!("{root}/viewers/{layout}")).unwrap();
        for path in paths(&text) {
            let topic = topics.iter().find(|topic| {
                let rest = path.strip_prefix(topic["topic"].as_str().unwrap());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '/']))
            });
            let topic = topic.unwrap_or_else(|| panic!("{layout}: {path} is no topic"));
            assert!(topic["messages"].as_u64() > Some(0), "{path}");
            let kind = topic["type"].as_str().unwrap().replace("/msg/", "/");
            let definition = known::definition(&kind).unwrap();
            let rest = &path[topic["topic"].as_str().unwrap().len()..];
            for field in rest.split(['.', '/']).filter(|field| !field.is_empty()) {
                let field = field.split('[').next().unwrap();
                let declares = |line: &str| line.split(' ').nth(1) == Some(field);
                assert!(
                    definition.lines().any(declares),
                    "{layout}: {path}: {field}"
                );
                named += 1;
            }
        }
    }
    assert!(named > 40, "{named}");
}
