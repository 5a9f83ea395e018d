//! Every end of the node stops the robot: faults at each call of the transport, and messages that were damaged.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and prints what it counted"
)]

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use clap::Parser as _;

use super::cycle_tests::{Driver, Sent, node_over};
use super::*;
use crate::command::{CommandLimits, SUBSCRIPTION};
use crate::error::Error;
use crate::state_file;
use crate::transport::{Endpoint, Graph, Transport, inbox};

/// Two seconds of messages find the slip; the commands follow.
const BACKLOG: i64 = 800;
const COMMAND: &str = "/cmd_vel";
const OUTPUT: &str = "/limited";

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Refused,
    Panic,
}

/// A transport that fails at one call, and keeps the speed of each limited command that it has carried.
#[derive(Clone, Default)]
struct Faulty {
    /// Calls until the fault; `None`: it does not come, or has come.
    left: Rc<Cell<Option<(u32, Fault)>>>,
    calls: Rc<Cell<u32>>,
    topics: Rc<RefCell<Vec<String>>>,
    speeds: Rc<RefCell<Vec<f64>>>,
}

impl Faulty {
    fn call(&self) -> Result<()> {
        self.calls.set(self.calls.get() + 1);
        match self.left.get() {
            Some((0, fault)) => {
                self.left.set(None);
                assert!(fault == Fault::Refused, "planted");
                Err(Error::UnknownType {
                    type_name: "planted".to_owned(),
                })
            }
            Some((left, fault)) => {
                self.left.set(Some((left - 1, fault)));
                Ok(())
            }
            None => Ok(()),
        }
    }
}

impl Transport for Faulty {
    fn graph(&mut self) -> Graph {
        if self.call().is_err() {
            return Graph::default();
        }
        Graph {
            endpoints: vec![Endpoint {
                topic: COMMAND.to_owned(),
                type_name: "geometry_msgs/Twist".to_owned(),
                type_hash: None,
                node: "/driver".to_owned(),
                is_publisher: true,
                is_reliable: true,
                is_transient_local: false,
            }],
        }
    }

    fn subscribe(&mut self, _: usize, _: &Endpoint, _: &Inbox) -> Result<()> {
        self.call()
    }

    fn unsubscribe(&mut self, _: usize) {}

    fn advertise(&mut self, topic: &str, _: &str) -> Result<usize> {
        self.call()?;
        self.topics.borrow_mut().push(topic.to_owned());
        Ok(self.topics.borrow().len() - 1)
    }

    fn has_subscriber(&mut self, _: usize) -> bool {
        self.call().is_ok()
    }

    fn publish(&mut self, publisher: usize, bytes: &[u8]) -> Result<()> {
        self.call()?;
        if self.topics.borrow()[publisher] == OUTPUT {
            let speed = f64::from_le_bytes(bytes[4..12].try_into().unwrap());
            self.speeds.borrow_mut().push(speed);
        }
        Ok(())
    }

    fn warnings(&mut self) -> Vec<String> {
        let _ = self.call();
        Vec::new()
    }

    fn close(self: Box<Self>) {
        let _ = self.call();
    }
}

fn commanded(driver: &Driver, transport: Box<dyn Transport>) -> Node {
    let (mut node, robot) = node_over(driver, Duration::ZERO, transport);
    let limits = CommandLimits {
        max_speed: 1.0,
        max_yaw_rate: 1.0,
        max_acceleration: 10.0,
        slip: 0.3,
        timeout: Duration::from_millis(500),
    };
    let topics = (COMMAND.to_owned(), OUTPUT.to_owned());
    let described = (&robot.robot, false);
    let path = CommandPath::new(topics, "base_link".to_owned(), described, limits).unwrap();
    node.command = Some(path);
    // so that a short run has some
    node.diagnostics_period = Duration::from_millis(50);
    node
}

/// `Twist` of a speed, in CDR.
fn twist(speed: f64) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    for value in [speed, 0.0, 0.0, 0.0, 0.0, 0.0] {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

/// What a run ended with.
struct Ended {
    outcome: Result<Outcome>,
    speeds: Vec<f64>,
    /// Calls of the transport once the node runs.
    calls: u32,
    has_state: bool,
}

/// Runs a node for a fifth of a second of commands, with a fault at a call of its transport.
fn run(fault: Option<(u32, Fault)>, state: &std::path::Path) -> Ended {
    let driver = Driver::new();
    let transport = Faulty::default();
    let mut node = commanded(&driver, Box::new(transport.clone()));
    let (inbox, mut arrivals) = inbox();
    node.inbox = inbox.clone();
    let backlog: Vec<Arrival> = (0..BACKLOG).map(|number| driver.arrival(number)).collect();
    for arrival in &backlog {
        node.take(arrival, false).unwrap();
    }
    transport.left.set(fault);
    transport.calls.set(0);
    let number = Cell::new(BACKLOG);
    let begun = Instant::now();
    let stop = || {
        let arrival = driver.arrival(number.replace(number.get() + 1));
        inbox.put(arrival.subscription, arrival.publisher, arrival.bytes);
        inbox.put(SUBSCRIPTION, [2; 16], twist(0.3));
        std::thread::sleep(Duration::from_millis(3));
        begun.elapsed() > Duration::from_millis(200)
    };
    let words = [
        "grouser live",
        "--robot",
        "robot.toml",
        "--quiet",
        "--state",
    ];
    let words = words.into_iter().chain(state.to_str());
    let arguments = Arguments::try_parse_from(words).unwrap();
    let robot = super::cycle_tests::robot().robot;
    let outcome = node.run(&[], &mut arrivals, &stop, (&arguments, &robot));
    Ended {
        outcome,
        speeds: transport.speeds.take(),
        calls: transport.calls.get(),
        has_state: state_file::read(state, &robot).unwrap().is_some(),
    }
}

/// The calls until the end of a run without a fault, as far as each run has them.
fn calls(folder: &std::path::Path) -> u32 {
    let whole = run(None, &folder.join("whole.toml"));
    assert!(matches!(whole.outcome, Ok(Outcome::Done)));
    let drove = whole.speeds.iter().filter(|speed| **speed > 0.0).count();
    assert!(drove > 3, "{:?}", whole.speeds);
    whole.calls
}

#[test]
fn after_a_fault_at_any_call_the_last_command_is_zero_and_the_state_is_written() {
    let folder = std::env::temp_dir().join(format!("grouser-live-ends-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let calls = calls(&folder);
    let cases: Vec<(u32, Fault)> = (0..calls)
        .flat_map(|call| [(call, Fault::Refused), (call, Fault::Panic)])
        .collect();
    // they sleep most of the time
    let share = cases.len().div_ceil(16);
    let drove = std::thread::scope(|scope| {
        let of = |cases: &[(u32, Fault)]| {
            let drove = cases.iter().filter(|(call, fault)| {
                let state = folder.join(format!("{call}-{fault:?}.toml"));
                let ended = run(Some((*call, *fault)), &state);
                let last = ended.speeds.last().copied().unwrap_or(0.0);
                assert!(
                    last.abs() < f64::MIN_POSITIVE,
                    "{fault:?} at {call}: {last}"
                );
                assert!(ended.has_state, "{fault:?} at {call}: no state");
                let is_error = ended.outcome.is_err();
                assert!(*fault == Fault::Panic || !is_error || ended.speeds.is_empty());
                ended.speeds.iter().any(|speed| *speed > 0.0)
            });
            drove.count()
        };
        let threads: Vec<_> = (cases.chunks(share))
            .map(|part| scope.spawn(move || of(part)))
            .collect();
        let counts = threads.into_iter().map(|thread| thread.join().unwrap());
        counts.sum::<usize>()
    });
    println!(
        "{} faults, {drove} of them of a robot that drove",
        cases.len()
    );
    // a busy machine starts later, so that fewer of them drive
    assert!(4 * drove > cases.len());
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_state_that_cannot_be_written_does_not_keep_the_robot_driving() {
    let ended = run_without_state();
    assert!(matches!(ended.0, Err(Error::File { .. })));
    assert!(
        ended
            .1
            .last()
            .is_some_and(|speed| speed.abs() < f64::MIN_POSITIVE)
    );
}

fn run_without_state() -> (Result<Outcome>, Vec<f64>) {
    let state = std::env::temp_dir().join("grouser-no-such-folder/state.toml");
    let ended = run(None, &state);
    assert!(!ended.has_state);
    (ended.outcome, ended.speeds)
}

/// A stream of random numbers.
struct Random(u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % below as u64).unwrap()
    }
}

/// One message of a hostile sender: bytes exchanged, numbers at their limits, or cut off.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    const NUMBERS: [u64; 8] = [
        u64::MAX,
        i64::MAX as u64,
        1 << 63,
        0x7fff_ffff_ffff_ffff,
        // seconds at their limit, nanoseconds beyond it
        0xffff_ffff_7fff_ffff,
        0x3b9a_c9ff_7fff_ffff,
        0x7ff0_0000_0000_0000,
        0,
    ];
    let at = random.next(bytes.len());
    match random.next(4) {
        0 => bytes[at] ^= 1 << random.next(8),
        1 => bytes.truncate(at),
        2 => {
            let number = NUMBERS[random.next(NUMBERS.len())].to_le_bytes();
            for (byte, new) in bytes[at..].iter_mut().zip(number) {
                *byte = new;
            }
        }
        // the stamp
        _ => {
            let number = NUMBERS[random.next(NUMBERS.len())].to_le_bytes();
            for (byte, new) in bytes[4..].iter_mut().zip(number) {
                *byte = new;
            }
        }
    }
}

/// `GROUSER_LIVE_MESSAGES=1000000` for a search.
#[test]
fn no_message_ends_the_node() {
    let count = std::env::var("GROUSER_LIVE_MESSAGES").ok();
    let count = count.map_or(30_000, |count| count.parse().unwrap());
    let driver = Driver::new();
    let published = Rc::new(Cell::new(0));
    let mut node = commanded(&driver, Box::new(Sent::new(&published, true)));
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut now = Instant::now();
    for number in 0..count {
        let mut arrival = driver.arrival(number);
        if random.next(4) == 0 {
            damage(&mut arrival.bytes, &mut random);
        }
        node.take(&arrival, true).unwrap();
        if number % 500 == 0 {
            now += Duration::from_secs(1);
            node.diagnose(now);
        }
    }
    println!(
        "{:?} not encoded, {} not decoded, {} late",
        node.outputs.unencoded(),
        node.intake.left_out().undecoded,
        node.intake.left_out().late
    );
    assert!(node.intake.left_out().undecoded > 0 && published.get() > 0);
}

#[test]
fn a_message_that_cannot_be_encoded_is_dropped_and_counted() {
    let driver = Driver::new();
    let published = Rc::new(Cell::new(0));
    let mut node = commanded(&driver, Box::new(Sent::new(&published, true)));
    for number in 0..400 {
        node.take(&driver.arrival(number), true).unwrap();
    }
    let stamp = |sec: i32, nanosec: u32| {
        let mut arrival = driver.arrival(400);
        arrival.bytes[4..8].copy_from_slice(&sec.to_le_bytes());
        arrival.bytes[8..12].copy_from_slice(&nanosec.to_le_bytes());
        arrival
    };
    node.take(&stamp(i32::MAX, u32::MAX), true).unwrap();
    let left_out = node.intake.left_out();
    assert_eq!(left_out.undecoded, 1);
    assert!(left_out.problem.as_ref().unwrap().contains("nanosec"));
    let before = published.get();
    let time_ns = (i64::from(i32::MAX) + 1) * 1_000_000_000;
    node.outputs.publish_silence(time_ns);
    let (count, reason) = node.outputs.unencoded();
    assert_eq!((count, published.get()), (1, before));
    assert!(reason.unwrap().contains("/grouser/slip"));
}
