//! A bag that is replayed through a transport gives the bits of `grouser estimate`: the example's, and a measured one.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

#[path = "../../crates/log/tests/support/measured_data.rs"]
mod measured_data;
mod peers;

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

use grouser_files::robot;
use grouser_log::Log;
use grouser_log::container::{Container, Event};
use grouser_log::message::Header;
use grouser_replay::messages::{write_odometry, write_wheel_slip};
use grouser_replay::{Options, Row, Sink, Step, run_into};
use measured_data::measured_data;
use peers::{Node, Peer, Place, bytes, example, python, read};
use serde_json::json;

/// The messages of `grouser estimate -o OUT.mcap`, as bytes.
struct Messages {
    names: Vec<String>,
    slips: Vec<Vec<u8>>,
    odometry: Vec<Vec<u8>>,
}

impl Sink for Messages {
    fn row(&mut self, _: &Row<'_>) -> io::Result<()> {
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let header = |frame| Header {
            time_ns: step.time_ns,
            frame,
        };
        let mut message = Vec::new();
        write_wheel_slip(&mut message, header("base_link"), &self.names, step.wheels).unwrap();
        self.slips.push(message.clone());
        if let Some(odometry) = step.odometry {
            write_odometry(&mut message, header("odom"), "base_link", &odometry).unwrap();
            self.odometry.push(message);
        }
        Ok(())
    }
}

/// A log with its robot.
struct Played {
    name: &'static str,
    log: PathBuf,
    robot: PathBuf,
    messages: usize,
    steps: usize,
}

fn example_log() -> Played {
    Played {
        name: "same-bits",
        log: example().join("log.mcap"),
        robot: example().join("robot.toml"),
        messages: 4002,
        steps: 2001,
    }
}

/// Measured by a Clearpath Jackal: a bag of ROS 1, whose messages the peer converts to those of ROS 2.
fn jackal_log() -> Option<Played> {
    Some(Played {
        name: "measured-bits",
        log: measured_data("jackal/jackal_61s.bag")?,
        robot: example().join("../jackal/robot.toml"),
        messages: 6121,
        steps: 3060,
    })
}

/// `rate`: messages a second. What the first second gave is estimated at once, and a DDS writer keeps 1000 messages.
fn same_bits(transport: &'static str, rate: f64, played: &Played) {
    let Some(python) = python() else { return };
    let robot = robot::read(&played.robot).unwrap();
    let run = Log::find_any(std::slice::from_ref(&played.log), None, &robot.topics).unwrap();
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
    assert_eq!(expected.slips.len(), played.steps);

    let place = Place::new(transport, played.name);
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "player"]));
    peer.call(&json!([
        "listen",
        "player",
        "/grouser/slip",
        "/grouser/odom"
    ]));
    // on a loaded machine the messages of one stamp arrive apart: these are 200 messages of the measured log
    let record = place.folder.join("run.mcap");
    let kept = ["--record", record.to_str().unwrap()];
    let arguments = [&["--look-s", "1", "--hold-ms", "2000"][..], &kept].concat();
    let node = Node::start(&place, &played.robot, &arguments);
    assert_eq!(
        peer.call(&json!(["play", "player", played.log, rate])),
        json!(played.messages)
    );
    assert_eq!(
        peer.call(&json!([
            "until",
            "/grouser/slip",
            played.steps * 9 / 10,
            20.0
        ])),
        json!(true)
    );
    // on a loaded machine the last ones arrive seconds later; a peer may have missed some, so that this may time out
    peer.call(&json!(["until", "/grouser/slip", played.steps, 8.0]));
    peer.call(&json!(["sleep", 3.0]));
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);

    // what was published, message by message: what follows reports the silence after the log
    let mut recorded: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
    let mut container = Container::open(&record).unwrap();
    while let Some(event) = container.next() {
        if let Event::Message(message) = event {
            let messages = recorded.entry(message.of.topic.clone()).or_default();
            messages.push(message.data.to_vec());
        }
    }
    let received = read(&place.received());
    for (topic, expected) in [
        ("/grouser/slip", &expected.slips),
        ("/grouser/odom", &expected.odometry),
    ] {
        let published = &recorded[topic];
        assert!(
            published.len() >= expected.len(),
            "{topic}: {}",
            published.len()
        );
        for (index, (own, other)) in published.iter().zip(expected).enumerate() {
            assert_eq!(own, other, "{topic}, message {index}");
        }
        // what arrived at the peer, by its stamp: a volatile writer may lose the first messages
        let by_stamp: BTreeMap<&[u8], &Vec<u8>> = expected
            .iter()
            .map(|message| (&message[4..12], message))
            .collect();
        let lines = received.lines().filter_map(|line| line.strip_prefix(topic));
        let mut arrived = 0;
        for line in lines {
            let message = bytes(line.split_whitespace().nth(1).unwrap());
            if let Some(other) = by_stamp.get(&message[4..12]) {
                assert_eq!(&message, *other, "{topic}");
                arrived += 1;
            }
        }
        assert!(arrived * 10 >= expected.len() * 9, "{topic}: {arrived}");
    }
}

#[cfg(feature = "zenoh")]
#[test]
fn over_zenoh() {
    same_bits("zenoh", 2000.0, &example_log());
    if let Some(played) = jackal_log() {
        same_bits("zenoh", 2000.0, &played);
    }
}

#[cfg(feature = "dds")]
#[test]
fn over_dds() {
    same_bits("dds", 500.0, &example_log());
    if let Some(played) = jackal_log() {
        same_bits("dds", 500.0, &played);
    }
}
