//! A Python peer and the node, each as a process of its own.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// What takes longer never comes: a loaded machine is slow.
pub(crate) const PATIENCE: Duration = Duration::from_mins(2);

/// The Python that has the peers' packages (`live/ci` installs it); `None` without it on a developer's machine.
pub(crate) fn python() -> Option<PathBuf> {
    let python = std::env::var_os("GROUSER_LIVE_PYTHON").map(PathBuf::from);
    assert!(
        python.is_some() || std::env::var("CI").as_deref() != Ok("true"),
        "GROUSER_LIVE_PYTHON names no Python with the peers' packages"
    );
    python
}

/// A folder of a test's own.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("grouser-live-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A domain that no other test of this run uses.
fn next_domain() -> u32 {
    static NEXT: AtomicU32 = AtomicU32::new(20);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// How peer and node find each other.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) transport: &'static str,
    pub(crate) domain: u32,
    pub(crate) folder: PathBuf,
    pub(crate) endpoint: String,
    /// What node and peer are run by.
    pub(crate) node_by: Vec<&'static str>,
    pub(crate) peer_by: Vec<&'static str>,
}

impl Place {
    pub(crate) fn new(transport: &'static str, name: &str) -> Self {
        // a free port of this machine
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        let place = Self {
            transport,
            domain: next_domain(),
            folder: folder(&format!("{transport}-{name}")),
            endpoint: format!("tcp/127.0.0.1:{port}"),
            node_by: Vec::new(),
            peer_by: Vec::new(),
        };
        place.write_config();
        place
    }

    /// Zenoh's session of the node.
    pub(crate) fn write_config(&self) {
        let config = json!({
            "mode": "peer",
            "connect": { "endpoints": [self.endpoint], "timeout_ms": -1, "exit_on_failure": false },
            "listen": { "endpoints": ["tcp/127.0.0.1:0"] },
            "scouting": { "multicast": { "enabled": false } },
        });
        std::fs::write(self.config(), config.to_string()).unwrap();
    }

    fn config(&self) -> PathBuf {
        self.folder.join("zenoh.json5")
    }

    pub(crate) fn received(&self) -> PathBuf {
        self.folder.join("received")
    }
}

/// The Python peer.
pub(crate) struct Peer {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Peer {
    pub(crate) fn start(python: &Path, place: &Place) -> Self {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peer.py");
        let words: Vec<&std::ffi::OsStr> = place
            .peer_by
            .iter()
            .map(std::ffi::OsStr::new)
            .chain([python.as_os_str()])
            .collect();
        let mut child = Command::new(words[0])
            .args(&words[1..])
            .arg(script)
            .arg(place.received())
            .args([place.transport, &place.domain.to_string(), &place.endpoint])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Self {
            input: child.stdin.take().unwrap(),
            output: BufReader::new(child.stdout.take().unwrap()),
            child,
        }
    }

    /// One command of the script; its result.
    pub(crate) fn call(&mut self, command: &Value) -> Value {
        writeln!(self.input, "{command}").unwrap();
        let mut line = String::new();
        self.output.read_line(&mut line).unwrap();
        assert!(!line.is_empty(), "the peer ended at {command}");
        serde_json::from_str(&line).unwrap()
    }

    /// The newest slip message.
    pub(crate) fn slip(&mut self) -> Value {
        self.call(&json!(["latest", "/grouser/slip"]))
    }

    /// The node's own status in the newest diagnostics.
    pub(crate) fn node_status(&mut self) -> Value {
        self.call(&json!(["latest", "/diagnostics"]))["status"][0].clone()
    }

    /// Waits until `holds` of the newest slip; the time that it took, s.
    pub(crate) fn until_slip(&mut self, holds: impl Fn(&Value) -> bool) -> f64 {
        let begun = Instant::now();
        loop {
            let slip = self.slip();
            if holds(&slip) {
                return begun.elapsed().as_secs_f64();
            }
            assert!(
                begun.elapsed() < PATIENCE,
                "not within {PATIENCE:?}: {slip}"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The node.
pub(crate) struct Node {
    child: Child,
}

/// What the node printed, and how it ended.
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Node {
    pub(crate) fn start(place: &Place, robot: &Path, arguments: &[&str]) -> Self {
        let middleware = if place.transport == "zenoh" {
            "rmw_zenoh_cpp"
        } else {
            "rmw_cyclonedds_cpp"
        };
        let out = |name: &str| std::fs::File::create(place.folder.join(name)).unwrap();
        // `chrt -f 20`, `nice`, `ip netns exec NAME`: what the node is run by
        let by = std::env::var("GROUSER_LIVE_RUN_BY").unwrap_or_default();
        let mut words: Vec<&str> = by
            .split_whitespace()
            .chain(place.node_by.iter().copied())
            .collect();
        words.push(env!("CARGO_BIN_EXE_grouser-live"));
        let child = Command::new(words[0])
            .args(&words[1..])
            .arg("--robot")
            .arg(robot)
            .args(arguments)
            .env("RMW_IMPLEMENTATION", middleware)
            .env("ROS_DOMAIN_ID", place.domain.to_string())
            .env("ZENOH_SESSION_CONFIG_URI", place.config())
            .stdout(out("out"))
            .stderr(out("err"))
            .spawn()
            .unwrap();
        Self { child }
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Ctrl-C.
    pub(crate) fn interrupt(mut self, place: &Place) -> Ended {
        let id = self.child.id().to_string();
        assert!(
            Command::new("kill")
                .args(["-INT", &id])
                .status()
                .unwrap()
                .success()
        );
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(10));
        };
        Ended {
            code: status.code(),
            out: read(&place.folder.join("out")),
            err: read(&place.folder.join("err")),
        }
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub(crate) fn read(path: &Path) -> String {
    let mut text = String::new();
    std::fs::File::open(path)
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    text
}

pub(crate) fn bytes(hex: &str) -> Vec<u8> {
    let digit = |at: usize| u8::from_str_radix(&hex[at..at + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(digit).collect()
}

/// The robot file with wheels measured by their angles; nothing shares a stamp.
pub(crate) fn wheel_robot(place: &Place) -> PathBuf {
    // joint states are those of the wheels, not of the motors
    let text = read(&example().join("robot.toml"));
    let text = text.replace(
        "encoder_on = \"motor\"\ngear = 20.0",
        "encoder_on = \"wheel\"",
    );
    let file = place.folder.join("robot.toml");
    std::fs::write(&file, text).unwrap();
    file
}

pub(crate) fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/five-wheel")
}
