//! One case: its folder, the run, and what must hold whatever was done.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io::Read;
use std::os::unix::ffi::OsStringExt as _;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt as _;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::damage::{WORDS, damage};
use super::mischief::Mischief;
use super::program::{Folder, send};
use super::random::Random;
use super::verbs::Shared;

/// A job that takes longer is interrupted, as its user would do it.
const PATIENCE: Duration = Duration::from_secs(20);
/// One that was interrupted has so long.
const END: Duration = Duration::from_mins(5);
const OLD: &[u8] = b"what was there before\n";

/// How a case ended.
pub(crate) struct Ended {
    pub(crate) code: Option<i32>,
    pub(crate) verdict: Result<(), String>,
}

struct Case {
    folder: Folder,
    words: Vec<OsString>,
    /// Places in the words of files that are read, and of one that is written.
    reads: Vec<usize>,
    writes: Option<usize>,
    json: bool,
    /// What the shell sets first.
    limit: Option<String>,
    signal: Option<(&'static str, Duration)>,
    stdout: Stdout,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Stdout {
    Read,
    Closed,
    Full,
    Gone,
}

pub(crate) fn run(shared: &Shared, verb: &str, mischief: Mischief, random: &mut Random) -> Ended {
    let mut case = Case::new(shared, verb, random);
    case.play(mischief, random);
    // what comes from outside may come on top
    if random.below(4) == 0 {
        case.play(
            [Mischief::Signal, Mischief::Limit, Mischief::Closed][random.below(3)],
            random,
        );
    }
    case.run()
}

impl Case {
    /// The verb as it works, in a folder of its own, where its output may be there already.
    fn new(shared: &Shared, verb: &str, random: &mut Random) -> Self {
        let folder = Folder::new();
        let (mut words, mut reads, mut writes) = (Vec::new(), Vec::new(), None);
        for word in verb.split_whitespace() {
            if let Some(name) = word.strip_prefix('@') {
                reads.push(words.len());
                folder.file(name, shared.content(name));
                for also in others(name) {
                    folder.file(also, shared.content(also));
                }
                words.push(folder.path(name).into());
            } else if let Some(name) = word.strip_prefix('>') {
                writes = Some(words.len());
                if random.below(2) == 0 {
                    folder.file(name, OLD);
                }
                words.push(folder.path(name).into());
            } else {
                words.push(word.into());
            }
        }
        let to_stdout = words.last().is_some_and(|word| word == "-");
        let json = !to_stdout && random.below(2) == 0;
        if json {
            words.push("--json".into());
        }
        Self {
            folder,
            words,
            reads,
            writes,
            json,
            limit: None,
            signal: None,
            stdout: Stdout::Read,
        }
    }

    fn play(&mut self, mischief: Mischief, random: &mut Random) {
        match mischief {
            Mischief::Damage => {
                let names = self.folder.names();
                let inputs: Vec<&String> = names.iter().filter(|n| !n.starts_with("x.")).collect();
                if inputs.is_empty() {
                    return self.change_value(random);
                }
                let path = self.folder.path(inputs[random.below(inputs.len())]);
                let content = fs::read(&path).unwrap();
                fs::write(path, damage(&content, random)).unwrap();
            }
            Mischief::Value => self.change_value(random),
            Mischief::Flags => self.change_flags(random),
            Mischief::NoFile => self.replace_input(random),
            Mischief::NoPlace => self.replace_output(random),
            Mischief::Closed => {
                self.stdout = [Stdout::Closed, Stdout::Full, Stdout::Gone][random.below(3)];
            }
            Mischief::Signal => {
                let signal = ["-INT", "-TERM", "-HUP"][random.below(3)];
                let delay = Duration::from_millis(random.below(120) as u64);
                self.signal = Some((signal, delay));
            }
            Mischief::Limit => {
                let some = random.below(1000);
                self.limit = Some(match random.below(4) {
                    0 => format!("ulimit -f {}", some % 40),
                    1 => format!("ulimit -n {}", 12 + some % 8),
                    2 => format!("ulimit -v {}", 30_000 + 300 * some),
                    _ => "export RUST_MIN_STACK=68719476736; ulimit -v 4000000".to_owned(),
                });
            }
        }
    }

    fn change_value(&mut self, random: &mut Random) {
        let places: Vec<usize> = (1..self.words.len())
            .filter(|&place| {
                let text = |place: usize| self.words[place].to_string_lossy().into_owned();
                text(place - 1).starts_with("--")
                    && !text(place).starts_with('-')
                    && Some(place) != self.writes
            })
            .collect();
        let Some(&place) = places.get(random.below(places.len())) else {
            return self.change_flags(random);
        };
        let hostile = *random.one_of(&WORDS.each_ref());
        self.words[place] = match random.below(20) {
            0 => OsString::from_vec(vec![b'1', 0xff, 0xfe]),
            1 => "1".repeat(1 << (4 + random.below(12))).into(),
            2 => format!("{hostile},{hostile}").into(),
            3 => format!("{hostile}:{hostile}").into(),
            _ => hostile.into(),
        };
    }

    fn change_flags(&mut self, random: &mut Random) {
        let count = self.words.len();
        let place = random.below(count);
        // the output stays where the verdict looks for it
        self.writes = None;
        match random.below(5) {
            0 => {
                self.words.remove(place);
            }
            1 => {
                let word = self.words[place].clone();
                self.words.push(word);
            }
            2 => {
                let other = random.below(count);
                self.words.swap(place, other);
            }
            3 => {
                let flags = [
                    "--json",
                    "--help",
                    "--slip",
                    "--soil",
                    "-o",
                    "--",
                    "-",
                    "--output=x.csv",
                    "-x",
                    "--seed",
                    "--figure",
                    "--sinkage-m",
                    "--json=1",
                ];
                self.words.insert(place, random.one_of(&flags).into());
            }
            _ => {
                let mut word = self.words[place].clone();
                word.push(random.one_of(&WORDS.each_ref()));
                self.words[place] = word;
            }
        }
    }

    fn replace_input(&mut self, random: &mut Random) {
        let Some(&place) = self.reads.get(random.below(self.reads.len())) else {
            return self.change_value(random);
        };
        let at = |name: &str| self.folder.path(name);
        self.words[place] = match random.below(9) {
            0 => "/dev/zero".into(),
            1 => "/dev/null".into(),
            2 => at(".").into(),
            3 => at("missing.mcap").into(),
            4 => {
                symlink("loop.csv", at("loop.csv")).unwrap();
                at("loop.csv").into()
            }
            5 => at("in.csv/x.toml").into(),
            6 => "-".into(),
            7 => {
                let made = Command::new("mkfifo").arg(at("pipe.csv")).status().unwrap();
                assert!(made.success());
                at("pipe.csv").into()
            }
            _ => {
                let mut odd = self.words[place].clone();
                odd.push(OsString::from_vec(vec![0xff, 0x1b, b'[', b'2', b'J']));
                fs::rename(&self.words[place], &odd).unwrap();
                odd
            }
        };
    }

    fn replace_output(&mut self, random: &mut Random) {
        let Some(place) = self.writes else {
            return self.change_value(random);
        };
        let target = PathBuf::from(&self.words[place]);
        let ending = target.extension().unwrap().to_string_lossy().into_owned();
        let at = |name: &str| self.folder.path(format!("{name}.{ending}"));
        let _ = fs::remove_file(&target);
        match random.below(8) {
            0 => self.words[place] = "/dev/full".into(),
            1 => fs::create_dir(&target).unwrap(),
            2 => self.words[place] = at("missing/x").into(),
            3 => {
                let made = Command::new("mkfifo").arg(&target).status().unwrap();
                assert!(made.success());
            }
            4 => {
                fs::write(&target, OLD).unwrap();
                let mut mode = fs::metadata(&target).unwrap().permissions();
                mode.set_readonly(true);
                fs::set_permissions(&target, mode).unwrap();
            }
            5 => self.words[place] = at(&"y".repeat(250 + random.below(20))).into(),
            6 => symlink(&target, &target).unwrap(),
            // a link to what is read
            _ => match self.reads.first() {
                Some(&input) => symlink(&self.words[input], &target).unwrap(),
                None => symlink("/proc/version", &target).unwrap(),
            },
        }
    }

    fn start(&self) -> Child {
        let mut command = if self.limit.is_some() || self.stdout == Stdout::Closed {
            let first = self.limit.as_deref().unwrap_or("true");
            let close = if self.stdout == Stdout::Closed {
                ">&-"
            } else {
                ""
            };
            let line = format!("{first}; exec \"$0\" \"$@\" {close}");
            let mut shell = Command::new("sh");
            shell.args(["-c", &line, env!("CARGO_BIN_EXE_grouser")]);
            shell
        } else {
            Command::new(env!("CARGO_BIN_EXE_grouser"))
        };
        let out = match self.stdout {
            Stdout::Full => fs::File::options()
                .write(true)
                .open("/dev/full")
                .unwrap()
                .into(),
            _ => Stdio::piped(),
        };
        command
            .args(&self.words)
            // what a verb writes under a default name
            .current_dir(self.folder.path("."))
            .env_remove("RUST_BACKTRACE")
            .stdin(Stdio::null())
            .stdout(out)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    fn run(self) -> Ended {
        let before = self.contents();
        let mut child = self.start();
        let out = child.stdout.take().filter(|_| self.stdout != Stdout::Gone);
        let (out, err) = (read(out), read(child.stderr.take()));
        let mut interrupted = false;
        if let Some((signal, delay)) = self.signal {
            thread::sleep(delay);
            send(&child, signal);
            interrupted = true;
        }
        let mut status = wait(&mut child, PATIENCE);
        if status.is_none() {
            println!("over {PATIENCE:?}: {:?} {:?}", self.limit, self.words);
            interrupted = true;
            // a search is ended by the second
            status = (0..2).find_map(|_| {
                send(&child, "-INT");
                wait(&mut child, END)
            });
        }
        if status.is_none() {
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let (out, err) = (out.join().unwrap(), err.join().unwrap());
        let err = String::from_utf8_lossy(&err).into_owned();
        let verdict = match status {
            None => Err("it hangs and no signal ends it".to_owned()),
            Some(status) => self.verdict(status, interrupted, &out, &err, &before),
        };
        Ended {
            code: status.and_then(|status| status.code()),
            verdict: verdict.map_err(|why| {
                let err: String = err.chars().take(600).collect();
                let limit = self.limit.as_deref().unwrap_or("");
                format!("{why}: {limit} {:?} {:?}\n{err}", self.words, status)
            }),
        }
    }

    fn verdict(
        &self,
        status: ExitStatus,
        interrupted: bool,
        out: &[u8],
        err: &str,
        before: &BTreeMap<String, Vec<u8>>,
    ) -> Result<(), String> {
        let fail = |why: &str| Err(why.to_owned());
        match status.signal() {
            // before the program has begun to handle it, and with that anything
            Some(_) if self.signal.is_some() && before == &self.contents() => return Ok(()),
            Some(signal) => return Err(format!("ended by signal {signal}")),
            None => {}
        }
        let code = status.code().unwrap_or(-1);
        if !(matches!(code, 0..=3) || code == 130 && interrupted) {
            return Err(format!("exit code {code}"));
        }
        if ["panicked", "overflowed its stack", "RUST_BACKTRACE"]
            .iter()
            .any(|word| err.contains(word))
            && !err.contains("memory allocation of")
        {
            return fail("a panic");
        }
        let out = String::from_utf8_lossy(out);
        let sends = |text: &str| {
            text.chars()
                .any(|c| c.is_control() && !matches!(c, '\n' | '\t' | '\r'))
        };
        // a table that is piped is as its input has it
        let is_piped = self.words.iter().any(|word| word == "-");
        if sends(err) || sends(&out) && !is_piped {
            return fail("control characters reach the terminal");
        }
        let is_error = err.starts_with("error: ") || err.contains("\nerror: ");
        if code == 2 && !is_error && !err.contains("memory allocation of") {
            return fail("refused without an error");
        }
        let whole = self.stdout == Stdout::Read && !err.contains("memory allocation of");
        if self.json && whole && code != 130 && self.words.iter().any(|word| word == "--json") {
            let is_help = self.words.iter().any(|word| word == "--help");
            match serde_json::from_str::<serde_json::Value>(&out) {
                Ok(value) if value.is_object() => {
                    if (code == 2) != value.get("error").is_some() {
                        return fail("the object and the exit code differ");
                    }
                }
                _ if is_help => {}
                _ => return fail("no JSON object on standard output"),
            }
        }
        self.check_files(code, before)
    }

    /// Nothing but the output has changed, and that only as a whole.
    fn check_files(&self, code: i32, before: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
        let after = self.contents();
        let without_memory = self
            .limit
            .as_deref()
            .is_some_and(|l| l.starts_with("ulimit -v"));
        for (name, content) in &after {
            if name.ends_with(".partial") && !without_memory {
                return Err(format!("{name} stays"));
            }
            match before.get(name) {
                Some(old) if old == content => {}
                // finished strips of a map go on in the next run
                None if code != 2
                    || self.stdout != Stdout::Read
                    || name.contains(".strips")
                    || name.ends_with(".partial") => {}
                // a result that could not be reported is written all the same
                _ if name.starts_with("x.")
                    && (code != 2 || self.stdout != Stdout::Read)
                    && !content.is_empty() => {}
                Some(_) => return Err(format!("{name} has changed")),
                None => return Err(format!("{name} was written")),
            }
        }
        match before.keys().find(|name| !after.contains_key(*name)) {
            Some(gone) => Err(format!("{gone} is gone")),
            None => Ok(()),
        }
    }

    /// The regular files of the folder.
    fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        let names = self.folder.names().into_iter();
        let read = |name: String| {
            let path = self.folder.path(&name);
            let is_file = fs::symlink_metadata(&path).is_ok_and(|found| found.is_file());
            is_file.then(|| fs::read(path).ok().map(|content| (name, content)))?
        };
        names.filter_map(read).collect()
    }
}

/// Files that a file names.
fn others(name: &str) -> &'static [&'static str] {
    match name {
        "scenario.toml" => &["five-wheel.toml"],
        "tests.toml" => &["plates.csv", "shear.csv"],
        _ => &[],
    }
}

fn read<R: Read + Send + 'static>(pipe: Option<R>) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            pipe.read_to_end(&mut bytes).unwrap();
        }
        bytes
    })
}

fn wait(child: &mut Child, limit: Duration) -> Option<ExitStatus> {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status);
        }
        if begun.elapsed() > limit {
            return None;
        }
        thread::sleep(Duration::from_millis(1));
    }
}
