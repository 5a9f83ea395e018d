//! The node without a transport: what a message costs, in allocations.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::float_cmp,
    reason = "a test fails by panicking, and prints what it measured; counts are exact"
)]

use std::cell::Cell;
use std::fmt::Write as _;
use std::rc::Rc;
use std::time::Instant;

use grouser_files::Document;
use grouser_files::robot::{self, RobotFile};
use grouser_log::Preview;
use grouser_log::message::{Definition, build, known};
use grouser_replay::{Inputs, Options};

use super::*;
use crate::outputs::Frames;
use crate::run::wheel_names;
use crate::transport::{Endpoint, Graph, Transport, inbox};

const WHEELS: usize = 8;
const PERIOD_NS: i64 = 5_000_000;

/// Takes what is published, and counts it.
pub(super) struct Sent {
    count: Rc<Cell<u64>>,
    has_subscriber: bool,
}

impl Sent {
    pub(super) fn new(count: &Rc<Cell<u64>>, has_subscriber: bool) -> Self {
        Self {
            count: Rc::clone(count),
            has_subscriber,
        }
    }
}

impl Transport for Sent {
    fn graph(&mut self) -> Graph {
        Graph::default()
    }

    fn subscribe(&mut self, _: usize, _: &Endpoint, _: &Inbox) -> Result<()> {
        Ok(())
    }

    fn unsubscribe(&mut self, _: usize) {}

    fn advertise(&mut self, _: &str, _: &str) -> Result<usize> {
        Ok(0)
    }

    fn has_subscriber(&mut self, _: usize) -> bool {
        self.has_subscriber
    }

    fn publish(&mut self, _: usize, _: &[u8]) -> Result<()> {
        self.count.set(self.count.get() + 1);
        Ok(())
    }

    fn warnings(&mut self) -> Vec<String> {
        Vec::new()
    }

    fn close(self: Box<Self>) {}
}

pub(super) fn robot() -> RobotFile {
    let mut text = "format = 1\nname = \"eight wheels\"\n".to_owned();
    for index in 0..WHEELS {
        let role = if index == WHEELS - 1 {
            "free"
        } else {
            "powered"
        };
        let (x, y) = (
            0.8 - 0.2 * index as f64,
            if index % 2 == 0 { 0.4 } else { -0.4 },
        );
        write!(
            text,
            "[[wheel]]\nname = \"wheel_{index}\"\ndrive = \"{role}\"\nx_m = {x:.1}\ny_m = {y}\nradius_m = 0.1\n\
             width_m = 0.1\nload_n = 60.0\nencoder_on = \"wheel\"\nticks_per_turn = 4096\n"
        )
        .unwrap();
    }
    robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
}

/// Messages of a robot at 0.2 m/s whose rims run at 0.25 m/s: joints, then the IMU.
pub(super) struct Driver {
    definitions: [Definition; 2],
    names: Vec<String>,
}

impl Driver {
    pub(super) fn new() -> Self {
        let definition = |name: &str| {
            let (package, kind) = name.split_once('/').unwrap();
            let text = known::definition(name).unwrap();
            Definition::parse(&format!("{package}/msg/{kind}"), &text).unwrap()
        };
        Self {
            definitions: ["sensor_msgs/JointState", "sensor_msgs/Imu"].map(definition),
            names: (0..WHEELS).map(|index| format!("wheel_{index}")).collect(),
        }
    }

    pub(super) fn arrival(&self, number: i64) -> Arrival {
        let subscription = usize::try_from(number % 2).unwrap();
        let time_ns = number * PERIOD_NS / 2;
        let seconds = time_ns as f64 * 1e-9;
        let header = build::header(time_ns, "base_link");
        let message = if subscription == 0 {
            let angles: Vec<f64> = (0..WHEELS)
                .map(|wheel| seconds * if wheel == WHEELS - 1 { 2.0 } else { 2.5 })
                .collect();
            {
                let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
                build::joint_state(header, &names, [&angles, &[], &[]])
            }
        } else {
            build::planar_imu(header, Some(0.0), Some([0.0; 2]))
        };
        Arrival {
            subscription,
            publisher: [1; 16],
            received: Instant::now(),
            received_ns: u64::try_from(time_ns).unwrap(),
            bytes: self.definitions[subscription].encode(&message).unwrap(),
        }
    }
}

/// A node that has chosen both topics, and the count of what it has published.
fn node(driver: &Driver, hold: Duration, has_subscriber: bool) -> (Node, Rc<Cell<u64>>) {
    let count = Rc::default();
    let transport = Box::new(Sent::new(&count, has_subscriber));
    (node_over(driver, hold, transport).0, count)
}

/// A node that has chosen both topics, over a transport.
pub(super) fn node_over(
    driver: &Driver,
    hold: Duration,
    transport: Box<dyn Transport>,
) -> (Node, RobotFile) {
    let robot = robot();
    let channels = vec![
        known::channel("/joint_states", "sensor_msgs/JointState").unwrap(),
        known::channel("/imu", "sensor_msgs/Imu").unwrap(),
    ];
    let mut preview = Preview::new(&robot.topics);
    for channel in &channels {
        preview.channel(channel);
    }
    for number in 0..400 {
        let arrival = driver.arrival(number);
        preview.push(arrival.subscription, &arrival.bytes, arrival.received_ns);
    }
    let intake = preview.into_intake().unwrap().with_hold(hold);
    let inputs = Inputs::of(&intake, &robot, &Options::default()).unwrap();
    let samples = RobotSamples::new(&intake, &robot).unwrap();
    let engine = Engine::new(&robot, inputs, &Options::default()).unwrap();
    let frames = Frames {
        base: "base_link".to_owned(),
        odom: "odom".to_owned(),
    };
    let name = |name: &str| Ok(format!("/{name}"));
    let outputs = Outputs::announce(transport, wheel_names(&robot), frames, false, name).unwrap();
    let mut node = Node::new(channels, intake, (samples, engine), outputs, inbox().0);
    node.hold = hold;
    (node, robot)
}

/// Allocations, messages published and time of a message, the filter warm.
fn cost(has_subscriber: bool) -> [f64; 3] {
    let driver = Driver::new();
    let (mut node, published) = node(&driver, Duration::ZERO, has_subscriber);
    let arrivals: Vec<Arrival> = (0..8000).map(|number| driver.arrival(number)).collect();
    let (warm, timed) = arrivals.split_at(4000);
    for arrival in warm {
        node.take(arrival, false).unwrap();
    }
    let before = published.get();
    let begun = Instant::now();
    let allocations = allocation_counter::measure(|| {
        for arrival in timed {
            node.take(arrival, false).unwrap();
        }
    });
    let passed_us = begun.elapsed().as_secs_f64() * 1e6;
    let slip = node.outputs.latest[0].slip.unwrap().value();
    assert!((slip - 0.2).abs() < 0.02, "{slip}");
    [
        allocations.count_total as f64,
        (published.get() - before) as f64,
        passed_us,
    ]
    .map(|sum| sum / timed.len() as f64)
}

#[test]
fn what_nobody_receives_is_not_made() {
    let [received, ignored] = [true, false].map(cost);
    for [allocations, published, us] in [received, ignored] {
        println!("{allocations:.2} allocations, {published:.2} published, {us:.1} us a message");
    }
    // three messages of each joint state
    assert!((received[1] - 1.5).abs() < 1e-9 && ignored[1] == 0.0);
    // diagnostics aside, which come once a second
    assert_eq!([received[0], ignored[0]], [0.0; 2]);
}

#[test]
fn what_is_held_back_waits_as_long_as_it_should() {
    let driver = Driver::new();
    let hold = Duration::from_millis(500);
    let (mut node, _) = node(&driver, hold, false);
    let (inbox, mut arrivals) = inbox();
    let sender = std::thread::spawn(move || {
        // the IMU's message, and much later one of the joints from before it
        for (number, wait_ms) in [(3, 0), (2, 200)] {
            std::thread::sleep(Duration::from_millis(wait_ms));
            let arrival = driver.arrival(number);
            inbox.put(arrival.subscription, arrival.publisher, arrival.bytes);
        }
        std::thread::sleep(Duration::from_millis(200));
    });
    // ends with the sender
    node.turn(&mut arrivals, &|| false).unwrap();
    sender.join().unwrap();
    assert_eq!((node.messages, node.intake.left_out().late), (2, 0));
}
