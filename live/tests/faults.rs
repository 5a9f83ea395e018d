//! Faults of the robot's network, with drivers in Python: what the node publishes, and what it says.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use grouser_log::message::View;
use peers::{Node, PATIENCE, Peer, Place, python, read, wheel_robot};
use serde_json::{Value, json};

/// The driven wheels' slip: rims at 0.25 m/s, the robot at 0.2 m/s.
const SLIP: f64 = 0.2;

/// The front left wheel's slip, where it has one.
fn slip(message: &Value) -> Option<f64> {
    message["slip"][0].as_f64()
}

fn health(message: &Value) -> String {
    message["health"][0].as_str().unwrap_or_default().to_owned()
}

fn is_right(message: &Value) -> bool {
    slip(message).is_some_and(|slip| (slip - SLIP).abs() < 0.02) && health(message) == "Ok"
}

/// A peer with a driver, and the node that listens to it, with the right slip.
struct Run {
    peer: Peer,
    node: Node,
    place: Place,
}

impl Run {
    fn begin(transport: &'static str, name: &str, arguments: &[&str]) -> Option<Self> {
        let python = python()?;
        let place = Place::new(transport, name);
        let mut peer = Peer::start(&python, &place);
        peer.call(&json!(["open", "driver"]));
        peer.call(&json!(["listen", "driver"]));
        peer.call(&json!(["drive", "driver", {}]));
        let arguments = [&["--look-s", "1"], arguments].concat();
        let node = Node::start(&place, &wheel_robot(&place), &arguments);
        let mut run = Self { peer, node, place };
        run.peer.until_slip(is_right);
        Some(run)
    }

    /// Waits until the node's status says something with `words`.
    fn until_told(&mut self, words: &str) -> String {
        let begun = std::time::Instant::now();
        loop {
            let status = self.peer.node_status();
            let message = status["message"].as_str().unwrap_or_default();
            if message.contains(words) {
                return message.to_owned();
            }
            assert!(begun.elapsed() < PATIENCE, "no `{words}` in {status}");
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
    }

    fn change(&mut self, field: &str, value: &Value) {
        self.peer.call(&json!(["change", "driver", field, value]));
    }

    fn end(self) -> peers::Ended {
        self.node.interrupt(&self.place)
    }
}

/// A driver that is killed and started again.
fn killed_and_back(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "killed", &[]) else {
        return;
    };
    run.peer.call(&json!(["open", "listener"]));
    run.peer.call(&json!(["listen", "listener"]));
    run.peer.call(&json!(["stop", "driver"]));
    let silent = run.peer.until_slip(|message| slip(message).is_none());
    assert!(silent < 3.0, "{silent}");
    assert_eq!(health(&run.peer.slip()), "Invalid(Dropout)");
    assert!(run.until_told("is silent").contains("/joint_states"));
    run.peer.call(&json!(["open", "again"]));
    run.peer.call(&json!(["drive", "again", {}]));
    // it stands for a second, drives, and is trusted after the filter's own two seconds
    run.peer.until_slip(is_right);
    run.end();
}

/// Two processes publish the same joints with other speeds: the first is used.
fn two_publishers(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "two", &[]) else {
        return;
    };
    run.peer.call(&json!(["open", "other"]));
    run.peer
        .call(&json!(["drive", "other", { "rims": 0.5, "imu": false }]));
    let words = run.until_told("measure the same joints");
    assert!(words.contains("2 publishers of `/joint_states`"), "{words}");
    for _ in 0..20 {
        let message = run.peer.slip();
        assert!(is_right(&message), "{message}");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    let ended = run.end();
    assert!(
        ended.err.contains("measure the same joints"),
        "{}",
        ended.err
    );
}

/// The robot's clock is set back and forth by an hour.
fn clock_jump(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "clock", &[]) else {
        return;
    };
    for offset_s in [3600_i64, 0] {
        run.change("offset_ns", &json!(offset_s * 1_000_000_000));
        run.peer.call(&json!(["sleep", 0.3]));
        // what the node said of the time before does not count
        let is_of_this_clock = |message: &Value| {
            let stamp = message["header"]["stamp"]["sec"].as_i64().unwrap();
            let now = std::time::SystemTime::now()
                .duration_since(std::time::UNIX_EPOCH)
                .unwrap();
            let ahead = stamp - i64::try_from(now.as_secs()).unwrap();
            (ahead - offset_s).abs() < 3
        };
        let recovered = run
            .peer
            .until_slip(|message| is_right(message) && is_of_this_clock(message));
        assert!(
            recovered < 3.0,
            "{recovered} s after a step to {offset_s} s"
        );
    }
    let ended = run.end();
    assert_eq!(
        ended.code,
        Some(3),
        "a jump of the clock is a doubt: {}{}",
        ended.out,
        ended.err
    );
}

/// A fifth of the messages are lost.
fn loss(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "loss", &[]) else {
        return;
    };
    run.change("loss", &json!(0.2));
    let (mut right, mut seen) = (0, 0);
    for _ in 0..40 {
        let message = run.peer.slip();
        if let Some(slip) = slip(&message) {
            seen += 1;
            right += usize::from((slip - SLIP).abs() < 0.03);
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    assert!(seen >= 36 && right == seen, "{right} of {seen} of 40");
    run.end();
}

/// A publisher with another definition of the type.
fn wrong_hash(transport: &'static str) {
    let Some(python) = python() else { return };
    let place = Place::new(transport, "hash");
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "driver"]));
    let wrong = format!("RIHS01_{}", "0".repeat(64));
    peer.call(&json!(["drive", "driver", { "hash": wrong }]));
    let node = Node::start(&place, &wheel_robot(&place), &["--look-s", "1"]);
    peer.call(&json!(["sleep", 3.0]));
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(1));
    let hash = peer.call(&json!(["hashes", "sensor_msgs/msg/JointState"]));
    let own = hash[0].as_str().unwrap();
    assert!(
        ended.err.contains("`/joint_states`")
            && ended.err.contains(&wrong)
            && ended.err.contains(own),
        "{}",
        ended.err
    );
}

/// A subscriber that requests what the node does not offer.
fn qos_mismatch(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "qos", &[]) else {
        return;
    };
    run.peer.call(&json!(["open", "late"]));
    run.peer
        .call(&json!(["transient_local", "late", "/grouser/odom"]));
    let words = run.until_told("QoS");
    assert!(words.contains("/grouser/odom"), "{words}");
    run.end();
}

/// A robot in another domain.
fn domains(transport: &'static str) {
    let Some(python) = python() else { return };
    let place = Place::new(transport, "domains");
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "driver", place.domain + 100]));
    peer.call(&json!(["drive", "driver", {}]));
    let node = Node::start(&place, &wheel_robot(&place), &["--look-s", "1"]);
    peer.call(&json!(["sleep", 3.0]));
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(1), "{}{}", ended.out, ended.err);
    assert!(
        ended.err.contains("before any topic was chosen"),
        "{}",
        ended.err
    );
}

/// A second node of the same name.
fn duplicated_node(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "duplicate", &[]) else {
        return;
    };
    let place = Place {
        folder: peers::folder(&format!("{transport}-second")),
        ..run.place.clone()
    };
    std::fs::copy(
        run.place.folder.join("zenoh.json5"),
        place.folder.join("zenoh.json5"),
    )
    .unwrap();
    let second = Node::start(&place, &wheel_robot(&place), &["--look-s", "1"]);
    run.peer.call(&json!(["sleep", 3.0]));
    let ended = second.interrupt(&place);
    assert!(
        ended.err.contains("another node publishes `/grouser/slip`"),
        "{}",
        ended.err
    );
    run.end();
}

/// State and recording: a second run begins with what the first has learnt, and the recording is a log.
fn state_and_recording(transport: &'static str) {
    let folder = peers::folder(&format!("{transport}-kept"));
    let (state, record) = (folder.join("state.toml"), folder.join("drive.mcap"));
    let arguments = [
        "--state",
        state.to_str().unwrap(),
        "--record",
        record.to_str().unwrap(),
        "--publish-tf",
    ];
    let Some(mut run) = Run::begin(transport, "kept", &arguments) else {
        return;
    };
    run.peer.call(&json!(["until", "/diagnostics", 2, 5.0]));
    let ended = run.end();
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);
    let first = read(&state);
    assert!(
        first.contains("robot = \"five wheels\"") && first.contains("bias_rad_per_s"),
        "{first}"
    );
    let survey = grouser_log::Survey::read(&record, |_| ()).unwrap();
    let topics: Vec<&str> = survey
        .topics
        .iter()
        .map(|topic| topic.channel.topic.as_str())
        .collect();
    for topic in [
        "/joint_states",
        "/imu",
        "/grouser/slip",
        "/grouser/odom",
        "/diagnostics",
        "/tf",
    ] {
        assert!(topics.contains(&topic), "{topic} of {topics:?}");
    }
    check_transform(&record);
    let again = Run::begin(transport, "kept-again", &arguments[..2]).unwrap();
    assert_eq!(again.end().code, Some(0));
    std::fs::write(&state, first.replace("five wheels", "another")).unwrap();
    let place = Place::new(transport, "other-robot");
    let node = Node::start(&place, &wheel_robot(&place), &arguments[..2]);
    std::thread::sleep(std::time::Duration::from_secs(1));
    drop(node);
    assert!(read(&place.folder.join("err")).contains("the state is of the robot `another`"));
}

/// The wheels' angles in `control_msgs/DynamicJointState`, as the robot file names them.
fn joint_interfaces(transport: &'static str) {
    let Some(python) = python() else { return };
    let place = Place::new(transport, "interfaces");
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "driver"]));
    peer.call(&json!(["listen", "driver"]));
    peer.call(&json!(["drive", "driver", { "interfaces": true }]));
    let file = wheel_robot(&place);
    let wheels = [
        "front_left",
        "front_right",
        "rear_left",
        "rear_right",
        "fifth",
    ];
    let fields = wheels.iter().enumerate().map(|(place, wheel)| {
        format!(
            "[[topics.field]]\ntopic = \"/dynamic_joint_states\"\nfield = \"interface_values[{place}].values[0]\"\n\
             meaning = \"wheel_angle\"\nunit = \"rad\"\nwheel = \"{wheel}\"\n"
        )
    });
    let text = read(&file) + &fields.collect::<String>();
    std::fs::write(&file, text).unwrap();
    let node = Node::start(&place, &file, &["--look-s", "1"]);
    peer.until_slip(is_right);
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);
    assert!(ended.out.contains("/dynamic_joint_states"), "{}", ended.out);
}

/// The transform in `/tf` is the pose in `/grouser/odom`.
fn check_transform(record: &std::path::Path) {
    use grouser_log::Clock;
    let mut messages = grouser_log::Messages::open(record, Clock::Recorder, |channel| {
        ["/tf", "/grouser/odom"].contains(&channel.topic.as_str())
    })
    .unwrap();
    let mut pairs = std::collections::BTreeMap::new();
    while let Some(message) = messages.next() {
        let pair: &mut [Option<[f64; 4]>; 2] = pairs.entry(message.time_ns).or_default();
        match messages.view(&message) {
            Some(View::Odometry(odometry)) => {
                let [x, y, _] = odometry.position;
                pair[0] = Some([x, y, odometry.orientation[2], odometry.orientation[3]]);
            }
            Some(View::Transforms(all)) => {
                let transform = all.get(0).unwrap();
                assert_eq!(
                    (transform.frame, transform.child_frame),
                    ("odom", "base_link")
                );
                let ([x, y, _], turn) = (transform.translation, transform.rotation);
                pair[1] = Some([x, y, turn[2], turn[3]]);
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(pairs.len() > 100, "{}", pairs.len());
    for [pose, transform] in pairs.into_values() {
        assert!(
            pose.is_some() && pose == transform,
            "{pose:?} {transform:?}"
        );
    }
}

/// DDS itself names no nodes: the node announces itself as ROS 2's own do, with readers and writers that exist.
#[cfg(feature = "dds")]
fn name_in_the_graph(transport: &'static str) {
    let Some(mut run) = Run::begin(transport, "named", &[]) else {
        return;
    };
    let begun = std::time::Instant::now();
    let expected = json!([{
        "namespace": "/",
        "name": "grouser",
        "publishes": [
            "rt/diagnostics",
            "rt/grouser/events",
            "rt/grouser/odom",
            "rt/grouser/slip",
            "rt/grouser/twist",
        ],
        "subscriptions": 2,
    }]);
    loop {
        let nodes = run.peer.call(&json!(["nodes", "driver"]));
        if nodes == expected {
            break;
        }
        assert!(begun.elapsed() < PATIENCE, "{nodes}");
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    run.end();
}

macro_rules! over {
    ($transport:ident, $feature:literal: $($fault:ident),* $(,)?) => {
        #[cfg(feature = $feature)]
        mod $transport {
            $(#[test]
            fn $fault() {
                super::$fault(stringify!($transport));
            })*
        }
    };
}

over!(zenoh, "zenoh": killed_and_back, two_publishers, clock_jump, loss, wrong_hash, qos_mismatch, domains, duplicated_node, joint_interfaces, state_and_recording);
over!(dds, "dds": killed_and_back, two_publishers, clock_jump, loss, wrong_hash, qos_mismatch, domains, duplicated_node, joint_interfaces, name_in_the_graph);
