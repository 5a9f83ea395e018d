//! A bag that is replayed through a transport gives the bits of `grouser estimate`.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::io;

use grouser_files::robot;
use grouser_log::Log;
use grouser_log::message::{Definition, Value, build, known};
use grouser_replay::messages::{odometry_message, wheel_slip};
use grouser_replay::{Options, Row, Sink, Step, run_into};
use peers::{Node, Peer, Place, bytes, example, python, read};
use serde_json::json;

/// The messages of `grouser estimate -o OUT.mcap`, as bytes.
struct Messages {
    names: Vec<String>,
    slips: Vec<Vec<u8>>,
    odometry: Vec<Vec<u8>>,
}

fn encode(type_name: &str, message: &Value) -> Vec<u8> {
    let definition = Definition::parse(type_name, &known::definition(type_name).unwrap()).unwrap();
    definition.encode(message).unwrap()
}

impl Sink for Messages {
    fn row(&mut self, _: &Row<'_>) -> io::Result<()> {
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let header = build::header(step.time_ns, "base_link");
        self.slips.push(encode(
            known::WHEEL_SLIP,
            &wheel_slip(header, &self.names, step.wheels),
        ));
        if let Some(odometry) = step.odometry {
            let header = build::header(step.time_ns, "odom");
            self.odometry.push(encode(
                "nav_msgs/Odometry",
                &odometry_message(header, "base_link", &odometry),
            ));
        }
        Ok(())
    }
}

fn same_bits(transport: &'static str) {
    let Some(python) = python() else { return };
    let (log, file) = (example().join("log.mcap"), example().join("robot.toml"));
    let robot = robot::read(&file).unwrap();
    let run = Log::find_any(&[log.clone()], None, &robot.topics).unwrap();
    let mut expected = Messages {
        names: robot
            .robot
            .wheels()
            .iter()
            .map(|wheel| wheel.name.clone())
            .collect(),
        slips: Vec::new(),
        odometry: Vec::new(),
    };
    run_into(&run, &robot, &Options::default(), &mut expected).unwrap();
    assert_eq!(expected.slips.len(), 2001);

    let place = Place::new(transport, "same-bits");
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "player"]));
    peer.call(&json!([
        "listen",
        "player",
        "/grouser/slip",
        "/grouser/odom"
    ]));
    // the messages of one stamp may arrive this far apart on a loaded machine
    let node = Node::start(&place, &file, &["--look-s", "1", "--hold-ms", "300"]);
    assert_eq!(
        peer.call(&json!(["play", "player", log, 2000.0])),
        json!(4002)
    );
    assert_eq!(
        peer.call(&json!(["until", "/grouser/slip", 2001, 20.0])),
        json!(true)
    );
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);

    let received = read(&place.received());
    for (topic, expected) in [
        ("/grouser/slip", &expected.slips),
        ("/grouser/odom", &expected.odometry),
    ] {
        let lines = received.lines().filter_map(|line| line.strip_prefix(topic));
        let messages: Vec<Vec<u8>> = lines
            .map(|line| bytes(line.split_whitespace().nth(1).unwrap()))
            .collect();
        // what follows reports the silence after the log
        assert!(
            messages.len() >= expected.len(),
            "{topic}: {} of {}",
            messages.len(),
            expected.len()
        );
        for (index, (own, other)) in messages.iter().zip(expected).enumerate() {
            assert_eq!(own, other, "{topic}, message {index}");
        }
    }
}

#[cfg(feature = "zenoh")]
#[test]
fn over_zenoh() {
    same_bits("zenoh");
}
