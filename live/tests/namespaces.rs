//! Robot and node in two network namespaces with a lossy link between them: frames are lost on the way, then all of them.
//!
//! Needs root and `ip`; skipped with a line elsewhere. The namespaces go with the test, also where it fails.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test fails by panicking, and says what it skips"
)]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use peers::{Node, Peer, Place, python, wheel_robot};
use serde_json::{Value, json};

const BRIDGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/lossy_bridge.py");

/// Three namespaces: the robot's, the node's, and the bridge's between them.
struct Network {
    names: [&'static str; 3],
    bridge: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

fn ip(arguments: &str) -> bool {
    let status = Command::new("ip")
        .args(arguments.split(' '))
        .stderr(Stdio::null())
        .status();
    status.is_ok_and(|status| status.success())
}

fn must(arguments: &str) {
    assert!(ip(arguments), "ip {arguments}");
}

impl Network {
    /// `None` where namespaces cannot be made.
    fn new(python: &Path, names: [&'static str; 3]) -> Option<Self> {
        for name in names {
            ip(&format!("netns del {name}"));
        }
        let [robot, node, middle] = names;
        if !ip(&format!("netns add {robot}")) {
            eprintln!("skipped: network namespaces need root and `ip`");
            return None;
        }
        must(&format!("netns add {node}"));
        must(&format!("netns add {middle}"));
        for (side, name) in [robot, node].into_iter().enumerate() {
            must(&format!(
                "link add eth0 netns {name} type veth peer name side{side} netns {middle}"
            ));
            must(&format!(
                "-n {name} addr add 10.77.0.{}/24 dev eth0",
                side + 1
            ));
            must(&format!("-n {middle} link set side{side} up"));
            for device in ["lo", "eth0"] {
                must(&format!("-n {name} link set {device} up"));
            }
            must(&format!("-n {name} route add 224.0.0.0/4 dev eth0"));
            let plain = Command::new("ip")
                .args(["netns", "exec", name])
                .arg(python)
                .args([BRIDGE, "--plain", "eth0"])
                .status();
            assert!(plain.unwrap().success());
        }
        let mut bridge = Command::new("ip")
            .args(["netns", "exec", middle])
            .arg(python)
            .args([BRIDGE, "side0", "side1"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Some(Self {
            names,
            input: bridge.stdin.take().unwrap(),
            output: BufReader::new(bridge.stdout.take().unwrap()),
            bridge,
        })
    }

    /// This share of the frames is lost from now on.
    fn lose(&mut self, share: f64) {
        writeln!(self.input, "{share}").unwrap();
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        assert!(!line.is_empty(), "the bridge ended");
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        let _ = self.bridge.kill();
        let _ = self.bridge.wait();
        for name in self.names {
            ip(&format!("netns del {name}"));
        }
    }
}

/// Slips that the peer has received.
fn count(peer: &mut Peer) -> u64 {
    peer.call(&json!(["count", "/grouser/slip"]))
        .as_u64()
        .unwrap()
}

fn lossy(transport: &'static str, names: [&'static str; 3]) {
    let Some(python) = python() else { return };
    let Some(mut network) = Network::new(&python, names) else {
        return;
    };
    let place = Place {
        endpoint: "tcp/10.77.0.1:7447".to_owned(),
        peer_by: vec!["ip", "netns", "exec", names[0]],
        node_by: vec!["ip", "netns", "exec", names[1]],
        ..Place::new(transport, "lossy")
    };
    place.write_config();
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "driver"]));
    peer.call(&json!([
        "listen",
        "driver",
        "/grouser/slip",
        "/diagnostics"
    ]));
    peer.call(&json!(["drive", "driver", {}]));
    let node = Node::start(&place, &wheel_robot(&place), &["--look-s", "1"]);
    let slip = |message: &Value| message["slip"][0].as_f64();
    let is_right = |message: &Value| slip(message).is_some_and(|slip| (slip - 0.2).abs() < 0.02);
    peer.until_slip(is_right);

    network.lose(0.2);
    let before = count(&mut peer);
    let (mut right, mut without) = (0, 0);
    for _ in 0..100 {
        let message = peer.slip();
        match slip(&message) {
            Some(slip) => {
                assert!((slip - 0.2).abs() < 0.03, "{message}");
                right += 1;
            }
            None => without += 1,
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    // TCP and reliable writers wait for what was lost, so that a slip may be late, and then is none
    let received = count(&mut peer) - before;
    eprintln!(
        "{transport}: of 100 looks at 20 % loss {right} had the right slip, {without} none; {received} of about 1000 messages arrived"
    );
    assert!(
        right >= 50 && received > 300,
        "{right} of 100, {received} messages"
    );

    network.lose(1.0);
    std::thread::sleep(Duration::from_secs(1));
    let before = count(&mut peer);
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(count(&mut peer), before, "nothing arrives");
    network.lose(0.0);
    let restored_s = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)
        .unwrap()
        .as_secs_f64();
    // measured after the outage, not before
    let is_new = |message: &Value| {
        let stamp = &message["header"]["stamp"];
        let part = |name: &str| stamp[name].as_f64().unwrap_or(0.0);
        part("sec") + 1e-9 * part("nanosec") > restored_s
    };
    let again = peer
        .until_slip(|message| is_new(message) && is_right(message) && message["health"][0] == "Ok");
    eprintln!("{transport}: right again {again:.1} s after an outage of 3 s");
    node.interrupt(&place);
}

#[cfg(feature = "zenoh")]
#[test]
fn over_zenoh() {
    lossy("zenoh", ["glz-robot", "glz-node", "glz-between"]);
}

#[cfg(feature = "dds")]
#[test]
fn over_dds() {
    lossy("dds", ["gld-robot", "gld-node", "gld-between"]);
}
