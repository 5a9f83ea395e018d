//! The command path with a robot in Python that follows the limited commands: slip, silence, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::time::{Duration, Instant};

use peers::{Node, PATIENCE, Peer, Place, python, wheel_robot};
use serde_json::{Value, json};

/// A robot that must slow down or stop does so within this time, s, on a loaded machine too.
const REACTION_S: f64 = 8.0;

/// What is requested, m/s.
const SPEED: f64 = 0.3;

struct Run {
    peer: Peer,
    node: Node,
    place: Place,
    topic: &'static str,
}

impl Run {
    /// A robot that drives as requested, with the node between.
    fn begin(transport: &'static str, name: &str, is_stamped: bool) -> Option<Self> {
        let python = python()?;
        let place = Place::new(transport, name);
        let topic = if is_stamped {
            "/stamped/cmd_vel"
        } else {
            "/grouser/cmd_vel"
        };
        let mut peer = Peer::start(&python, &place);
        peer.call(&json!(["open", "robot"]));
        peer.call(&json!([
            "listen",
            "robot",
            topic,
            "/grouser/slip",
            "/diagnostics"
        ]));
        peer.call(&json!(["follow", "robot", { "stamped": is_stamped }]));
        let arguments = [
            "--look-s",
            "1",
            "--command",
            "cmd_vel",
            "--command-out",
            topic,
            "--max-speed-m-per-s",
            "0.5",
        ];
        let node = Node::start(&place, &wheel_robot(&place), &arguments);
        let mut run = Self {
            peer,
            node,
            place,
            topic,
        };
        run.change("speed", &json!(SPEED));
        run.until(|speed| (speed - SPEED).abs() < 0.01);
        Some(run)
    }

    fn change(&mut self, field: &str, value: &Value) {
        self.peer.call(&json!(["change", "robot", field, value]));
    }

    /// Speed of the newest limited command, m/s, and its age, s.
    fn limited(&mut self) -> (f64, f64) {
        let answer = self.peer.call(&json!(["limited", self.topic]));
        (answer[0].as_f64().unwrap(), answer[1].as_f64().unwrap())
    }

    /// Waits until the limited speed is as wanted; the time that it took, s.
    fn until(&mut self, holds: impl Fn(f64) -> bool) -> f64 {
        let begun = Instant::now();
        loop {
            let (speed, _) = self.limited();
            let passed = begun.elapsed();
            if holds(speed) {
                return passed.as_secs_f64();
            }
            let status = if passed < PATIENCE {
                Value::Null
            } else {
                self.peer.node_status()
            };
            assert!(
                passed < PATIENCE,
                "not within {PATIENCE:?}: {speed} m/s; {status}"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The greatest limited speed over `seconds`, m/s.
    fn greatest(&mut self, seconds: f64) -> f64 {
        let begun = Instant::now();
        let mut greatest = 0.0_f64;
        while begun.elapsed().as_secs_f64() < seconds {
            greatest = greatest.max(self.limited().0.abs());
            std::thread::sleep(Duration::from_millis(10));
        }
        greatest
    }

    fn until_reported(&mut self, words: &str) {
        let begun = Instant::now();
        loop {
            let status = self.peer.node_status();
            if status["message"]
                .as_str()
                .unwrap_or_default()
                .contains(words)
            {
                return;
            }
            assert!(begun.elapsed() < PATIENCE, "no `{words}` in {status}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

/// Slip and a wheel that stands slow the robot; without them it drives as requested.
fn slip_slows(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "slows", false) else {
        return;
    };
    // all wheels slip by 0.7 beside a running slip of 0.3; the crawl is 0.15 of what is requested, and a rim whose slip is lost in
    // the noise of that creeps at 0.6 until it is known
    run.change("slip", &json!(0.7));
    assert!(run.until(|speed| speed < 0.5 * SPEED) < REACTION_S);
    let slowest = run.greatest(1.0);
    assert!(slowest < 0.61 * SPEED, "{slowest}");
    run.change("slip", &json!(0.1));
    run.until(|speed| (speed - SPEED).abs() < 0.01);
    // one wheel spins alone: its slip is known, and the speed over ground is what the others carry
    run.change("diverging", &json!(0.8));
    run.peer.call(&json!(["sleep", 2.0]));
    let slips = run.peer.call(&json!(["latest", "/grouser/slip"]));
    let slip = slips["slip"][0].as_f64().unwrap();
    assert!((slip - 0.8).abs() < 0.05, "{slips}");
    run.change("diverging", &Value::Null);
    run.until(|speed| (speed - SPEED).abs() < 0.01);
    // one wheel stands: a stalled motor, or an encoder that is stuck
    run.change("stuck", &json!("rear_right"));
    assert!(run.until(|speed| speed < 0.2 * SPEED) < REACTION_S);
    run.change("stuck", &Value::Null);
    run.until(|speed| (speed - SPEED).abs() < 0.01);
    run.node.interrupt(&run.place);
}

/// Silence of commands and of sensors ends in zero within 0.5 s, and what follows is stated.
fn silence_stops(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "silence", true) else {
        return;
    };
    run.change("requests", &json!(false));
    // 0.5 s, a period of the commands, a period of the node, and the peer's own delays
    let silent = run.until(|speed| speed == 0.0);
    assert!((0.3..0.75).contains(&silent), "{silent} s");
    // then nothing is published any more: another source may command
    run.peer.call(&json!(["sleep", 1.0]));
    let (_, age) = run.limited();
    assert!(age > 0.4, "{age} s");
    run.change("requests", &json!(true));
    run.until(|speed| (speed - SPEED).abs() < 0.01);

    run.change("senses", &json!(false));
    let silent = run.until(|speed| speed == 0.0);
    assert!(silent < 0.75, "{silent} s");
    run.change("senses", &json!(true));
    // the sensors are back; the robot waits for a zero command
    run.until_reported("send a zero command");
    assert!(run.greatest(1.0) == 0.0, "it drives before a zero command");
    run.change("speed", &json!(0.0));
    run.peer.call(&json!(["sleep", 3.0]));
    run.change("speed", &json!(SPEED));
    run.until(|speed| (speed - SPEED).abs() < 0.01);
    run.node.interrupt(&run.place);
}

/// What is not finite or not planar is refused and counts as silence; limits are kept; the end of the node is a zero.
fn refused_and_limited(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "refused", false) else {
        return;
    };
    for (field, value, words) in [
        (
            "speed",
            json!("nan"),
            "`linear.x` is NaN, but must be finite",
        ),
        ("yaw_rate", json!("nan"), "`angular.z` is NaN"),
        ("sideways", json!(0.1), "`linear.y` is 0.1, but must be 0"),
    ] {
        let before = if field == "speed" { SPEED } else { 0.0 };
        run.change(field, &value);
        assert!(run.until(|speed| speed == 0.0) < REACTION_S);
        run.until_reported(words);
        run.change(field, &json!(before));
        run.until(|speed| (speed - SPEED).abs() < 0.01);
    }
    for (requested, sense) in [(1e300, 1.0), (-7.0, -1.0)] {
        run.change("speed", &json!(requested));
        run.until(|speed| (sense * speed - 0.5).abs() < 0.01);
        assert!(run.greatest(0.5) <= 0.5);
    }
    run.change("speed", &json!(SPEED));
    run.until(|speed| (speed - SPEED).abs() < 0.01);
    run.node.interrupt(&run.place);
    run.peer.call(&json!(["sleep", 0.2]));
    let answer = run.peer.call(&json!(["limited", run.topic]));
    assert_eq!(answer[0].as_f64(), Some(0.0), "the last command");
}

macro_rules! over {
    ($transport:ident, $feature:literal: $($case:ident),* $(,)?) => {
        #[cfg(feature = $feature)]
        mod $transport {
            $(#[test]
            fn $case() {
                super::$case(stringify!($transport));
            })*
        }
    };
}

over!(zenoh, "zenoh": slip_slows, silence_stops, refused_and_limited);
over!(dds, "dds": slip_slows, silence_stops, refused_and_limited);
