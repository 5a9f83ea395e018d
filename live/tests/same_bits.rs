//! A bag that is replayed through a transport gives the bits of `grouser estimate`.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::collections::BTreeMap;
use std::io;

use grouser_files::robot;
use grouser_log::Log;
use grouser_log::container::{Container, Event};
use grouser_log::message::Header;
use grouser_replay::messages::{write_odometry, write_wheel_slip};
use grouser_replay::{Options, Row, Sink, Step, run_into};
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

/// `rate`: messages a second. What the first second gave is estimated at once, and a DDS writer keeps 1000 messages.
fn same_bits(transport: &'static str, rate: f64) {
    let Some(python) = python() else { return };
    let (log, file) = (example().join("log.mcap"), example().join("robot.toml"));
    let robot = robot::read(&file).unwrap();
    let run = Log::find_any(std::slice::from_ref(&log), None, &robot.topics).unwrap();
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
    let record = place.folder.join("run.mcap");
    let kept = ["--record", record.to_str().unwrap()];
    let arguments = [&["--look-s", "1", "--hold-ms", "300"][..], &kept].concat();
    let node = Node::start(&place, &file, &arguments);
    assert_eq!(
        peer.call(&json!(["play", "player", log, rate])),
        json!(4002)
    );
    assert_eq!(
        peer.call(&json!(["until", "/grouser/slip", 1850, 20.0])),
        json!(true)
    );
    // on a loaded machine the last ones arrive seconds later; a peer may have missed some, so that this may time out
    peer.call(&json!(["until", "/grouser/slip", 2001, 8.0]));
    peer.call(&json!(["sleep", 1.0]));
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
    same_bits("zenoh", 2000.0);
}

#[cfg(feature = "dds")]
#[test]
fn over_dds() {
    same_bits("dds", 500.0);
}
