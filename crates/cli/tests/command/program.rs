//! Runs the program, with a limit on its time, and keeps what it says.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// What takes longer hangs: the slowest verb of a test takes seconds, and a loaded machine is fifty times as slow.
pub(crate) const LIMIT: Duration = Duration::from_mins(10);

/// A soil file that lanes serve: with the laws of the template maps and fronts take thirty times as long.
pub(crate) const LANE_SOIL: &str = "format = 1\nname = \"sand\"\nn = 1.1\nk_c_kn_per_m_n1 = 0.9\nk_phi_kn_per_m_n2 = 1528.4\n\
     cohesion_kpa = 1.0\nphi_deg = 30.0\nk_shear_m = 0.025\nc_1 = 0.18\nc_2 = 0.32\n";

/// What the program said.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Said {
    /// Refused: exit 2, an error on standard error, no panic; standard output is empty or holds the same error.
    pub(crate) fn assert_refused(&self, what: &str) {
        assert_eq!(self.code, Some(2), "{what}: {self:?}");
        assert!(self.err.starts_with("error: "), "{what}: {self:?}");
        self.assert_sane(what);
    }

    /// It did not panic or hang, and what failed left no result on standard output.
    pub(crate) fn assert_sane(&self, what: &str) {
        assert!(matches!(self.code, Some(0..=3)), "{what}: {self:?}");
        assert!(!self.err.contains("panicked"), "{what}: {self:?}");
        if self.code == Some(2) && !self.out.is_empty() {
            let json = self.json();
            let keys: Vec<&String> = json.as_object().unwrap().keys().collect();
            assert_eq!(keys, ["error"], "{what}: {self:?}");
            let message = json["error"]["message"].as_str().unwrap();
            let first = message.lines().next().unwrap();
            assert!(
                self.err.contains(first) || first.chars().any(char::is_control),
                "{what}: {self:?}"
            );
        }
    }

    /// Done: exit 0.
    pub(crate) fn assert_done(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Standard output as one JSON object.
    pub(crate) fn json(&self) -> serde_json::Value {
        let value: serde_json::Value = serde_json::from_str(&self.out).unwrap();
        assert!(value.is_object());
        value
    }
}

/// Starts the program.
pub(crate) fn start<S: AsRef<OsStr>>(
    arguments: impl IntoIterator<Item = S>,
    input: Stdio,
) -> Child {
    Command::new(env!("CARGO_BIN_EXE_grouser"))
        .env("COLUMNS", "10000")
        .args(arguments)
        .stdin(input)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Sends a signal such as `-INT`; the shell's own `kill`, since not every machine has the program. False where it has ended.
pub(crate) fn send(child: &Child, signal: &str) -> bool {
    let sent = Command::new("sh")
        .args(["-c", "kill \"$0\" \"$1\"", signal, &child.id().to_string()])
        .stderr(Stdio::null())
        .status();
    sent.unwrap().success()
}

/// Waits for the program's end; kills it after [`LIMIT`] and fails.
pub(crate) fn wait(mut child: Child) -> Said {
    fn reader(mut pipe: impl std::io::Read + Send + 'static) -> thread::JoinHandle<String> {
        thread::spawn(move || {
            let mut bytes = Vec::new();
            pipe.read_to_end(&mut bytes).unwrap();
            String::from_utf8_lossy(&bytes).into_owned()
        })
    }
    let out = reader(child.stdout.take().unwrap());
    let err = reader(child.stderr.take().unwrap());
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begun.elapsed() > LIMIT {
            child.kill().unwrap();
            panic!("still running after {LIMIT:?}");
        }
        thread::sleep(Duration::from_millis(1));
    };
    Said {
        code: status.code(),
        out: out.join().unwrap(),
        err: err.join().unwrap(),
    }
}

/// Runs the program with nothing on standard input.
pub(crate) fn grouser<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Said {
    wait(start(arguments, Stdio::null()))
}

/// Runs the program with the words of a line as its arguments.
pub(crate) fn line(words: &str) -> Said {
    grouser(words.split_whitespace())
}

/// Every verb, as the help lists them.
pub(crate) fn verbs() -> Vec<String> {
    let help = line("--help").assert_done().out;
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let rows = list.lines().take_while(|row| !row.is_empty());
    let names = rows.filter_map(|row| row.strip_prefix("  ")?.split(' ').next());
    names
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect()
}

/// A folder of a test's own, removed at the end.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("grouser-test-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn path(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file and gives its path.
    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, content).unwrap();
        path
    }

    /// The names in the folder.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.unwrap().file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
