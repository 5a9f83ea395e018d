//! A recording that a robot still writes: its logger appends, is killed, and begins again behind what it left.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::env;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use grouser_log::container::{Container, Event};
use grouser_log::write::{McapWriter, Times};
use grouser_view::feed::Feed;
use grouser_view::run::RecordedRun;
use serde_json::Value;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/five-wheel");
const INTO: &str = "GROUSER_VIEW_LOG_INTO";
const FROM_NS: &str = "GROUSER_VIEW_LOG_FROM_NS";
/// The logger's time runs so much faster than the example's.
const SPEED: u32 = 10;
/// A slip is shown this long after its bytes arrived at the latest, here and on a loaded machine.
const MAX_LATENCY: Duration = Duration::from_secs(2);
/// What takes longer never comes: a loaded machine is slow.
const PATIENCE: Duration = Duration::from_mins(10);

/// The logger that is killed: appends a recording of the example's messages from a time on.
#[test]
fn logger() {
    let Some(path) = env::var_os(INTO).map(PathBuf::from) else {
        return;
    };
    let from_ns: u64 = env::var(FROM_NS).unwrap().parse().unwrap();
    let file = OpenOptions::new().append(true).open(path).unwrap();
    let mut writer = McapWriter::new(file, "ros2").unwrap();
    let mut source = Container::open(&Path::new(EXAMPLE).join("log.mcap")).unwrap();
    let mut channels = BTreeMap::new();
    let (begin, mut first_ns) = (Instant::now(), None);
    while let Some(event) = source.next() {
        let Event::Message(message) = event else {
            continue;
        };
        if message.log_time_ns < from_ns {
            continue;
        }
        let first_ns = *first_ns.get_or_insert(message.log_time_ns);
        let due = Duration::from_nanos(message.log_time_ns - first_ns) / SPEED;
        sleep(due.saturating_sub(begin.elapsed()));
        let channel = *channels
            .entry(message.channel)
            .or_insert_with(|| writer.channel(message.of).unwrap());
        let times = Times::at(message.log_time_ns);
        writer.message(channel, times, message.data).unwrap();
    }
    writer.finish().unwrap();
}

fn start_logger(path: &Path, from_ns: u64) -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["logger", "--exact"])
        .env(INTO, path)
        .env(FROM_NS, from_ns.to_string())
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// What the page has received.
#[derive(Default)]
struct Shown {
    next: usize,
    /// Times of the moments with the slip of the first wheel, s.
    moments: Vec<(f64, f64)>,
    has_ended: bool,
}

impl Shown {
    fn take(&mut self, feed: &Feed) {
        let answer = feed.from(self.next);
        self.next = answer.next;
        for part in answer.parts {
            let part = &part[8..];
            let length = u32::from_le_bytes(part[..4].try_into().unwrap()) as usize;
            let head: Value = serde_json::from_slice(&part[4..4 + length]).unwrap();
            assert!(head["failed"].is_null(), "{head}");
            self.has_ended |= head["end"].is_object();
            let rows = usize::try_from(head["rows"].as_u64().unwrap_or(0)).unwrap();
            let names = head["columns"].as_array().cloned().unwrap_or_default();
            let column = |name: &str| -> Vec<f64> {
                let at = names.iter().position(|own| own == name).unwrap();
                let bytes = &part[4 + length + 8 * rows * at..][..8 * rows];
                bytes
                    .chunks_exact(8)
                    .map(|value| f64::from_le_bytes(value.try_into().unwrap()))
                    .collect()
            };
            if rows > 0 && head["overview"].is_null() {
                let slips = column("slip 0");
                self.moments.extend(column("time_s").into_iter().zip(slips));
            }
        }
    }

    fn last_s(&self) -> f64 {
        self.moments.last().map_or(f64::NEG_INFINITY, |last| last.0)
    }

    /// Waits for a moment; how long that took.
    fn wait(&mut self, feed: &Feed, until: impl Fn(&Self) -> bool, limit: Duration) -> Duration {
        let begin = Instant::now();
        while !until(self) {
            let last = self.last_s();
            assert!(begin.elapsed() < limit, "nothing comes after {last} s");
            sleep(Duration::from_millis(5));
            self.take(feed);
        }
        begin.elapsed()
    }
}

/// First and last time of the messages that can be read of a file, ns.
fn span(path: &Path) -> Option<(u64, u64)> {
    let mut container = Container::open(path).ok()?;
    let mut span = None;
    while let Some(event) = container.next() {
        if let Event::Message(message) = event {
            let (first, _) = span.unwrap_or((message.log_time_ns, 0));
            span = Some((first, message.log_time_ns));
        }
    }
    span
}

/// The slips of the finished log: as it is followed, which is online, or by all of it.
fn whole(is_live: bool) -> Vec<(f64, f64)> {
    let example = Path::new(EXAMPLE);
    let robot = example.join("robot.toml");
    let run = RecordedRun::open(&example.join("log.mcap"), &robot, None, is_live).unwrap();
    let feed = run.start();
    let mut shown = Shown::default();
    shown.wait(&feed, |shown| shown.has_ended, PATIENCE);
    shown.moments
}

#[test]
fn a_logger_that_is_killed_and_begins_again_is_followed() {
    let folder = env::temp_dir().join(format!("grouser-view-follow-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("log.mcap");
    fs::write(&path, []).unwrap();
    let robot = Path::new(EXAMPLE).join("robot.toml");
    let feed = RecordedRun::open(&path, &robot, None, true)
        .unwrap()
        .start();
    let mut shown = Shown::default();
    sleep(Duration::from_millis(100));
    shown.take(&feed);
    assert!(shown.moments.is_empty(), "nothing is written yet");

    let mut logger = start_logger(&path, 0);
    shown.wait(&feed, |shown| shown.last_s() > 12.0, PATIENCE);
    let first_ns = span(&path).unwrap().0;
    let seconds = |ns: u64| (ns - first_ns) as f64 * 1e-9;
    // half a second is held back, and a moment waits for its successor
    let catch_up = |shown: &mut Shown| {
        let last_ns = span(&path).unwrap().1;
        let due_s = seconds(last_ns) - 0.6;
        let latency = shown.wait(&feed, |shown| shown.last_s() >= due_s, PATIENCE);
        (last_ns, latency)
    };
    let mut latencies: Vec<Duration> = (0..20)
        .map(|_| {
            sleep(Duration::from_millis(53));
            catch_up(&mut shown).1
        })
        .collect();
    latencies.sort_unstable();
    logger.kill().unwrap();
    logger.wait().unwrap();
    let (last_ns, _) = catch_up(&mut shown);
    eprintln!(
        "slips after their bytes: median {:?}, longest {:?}",
        latencies[10], latencies[19]
    );
    // a loaded machine delays many of them, and a follower that looks seldom all but a few
    assert!(latencies[5] < MAX_LATENCY, "{latencies:?}");
    let before = whole(true);
    let same = |shown: &[(f64, f64)]| {
        let pairs = shown.iter().zip(&before);
        pairs
            .filter(|(a, b)| a.0.to_bits() == b.0.to_bits() && a.1.to_bits() == b.1.to_bits())
            .count()
    };
    assert_eq!(same(&shown.moments), shown.moments.len(), "the same bits");

    // a writer that the system ends may leave a part of a chunk: the next recording stands behind it
    let written = fs::read(&path).unwrap();
    let is_chunk = |at: &usize| written[*at] == 6 && written[at + 3..at + 9] == [0; 6];
    let chunk = (1..written.len() - 9).rev().find(is_chunk).unwrap();
    let mut out = OpenOptions::new().append(true).open(&path).unwrap();
    out.write_all(&written[chunk..chunk + 400]).unwrap();
    let again_ns = last_ns + 3_000_000_000;
    let mut logger = start_logger(&path, again_ns);
    shown.wait(&feed, |shown| shown.has_ended, PATIENCE);
    logger.wait().unwrap();
    let end_s = before.last().unwrap().0;
    assert!((shown.last_s() - end_s).abs() < 1e-9, "{}", shown.last_s());
    // as many slips as the whole log has there, but for the estimator's new start
    let slips = |moments: &[(f64, f64)]| {
        let after = moments.iter().filter(|moment| moment.0 > seconds(again_ns));
        after.filter(|moment| moment.1.is_finite()).count()
    };
    let (found, all) = (slips(&shown.moments), slips(&before));
    assert!(all > 100 && 10 * found >= 8 * all, "{found} slips of {all}");
    fs::remove_dir_all(folder).unwrap();
}

/// Records the example in numbered files, each begun before the one before has its footer, as `ros2 bag record` does.
fn record_in_parts(folder: &Path, count: u32) {
    let mut source = Container::open(&Path::new(EXAMPLE).join("log.mcap")).unwrap();
    let (mut writer, mut channels): (Option<McapWriter<fs::File>>, _) = (None, BTreeMap::new());
    let (mut begun, mut first_ns) = (0, None);
    while let Some(event) = source.next() {
        let Event::Message(message) = event else {
            continue;
        };
        let age_ns = message.log_time_ns - *first_ns.get_or_insert(message.log_time_ns);
        if age_ns >= u64::from(begun) * 40_100_000_000 / u64::from(count) {
            let path = folder.join(format!("run_{begun}.mcap"));
            begun += 1;
            let next = McapWriter::new(fs::File::create(path).unwrap(), "ros2").unwrap();
            sleep(Duration::from_millis(100));
            if let Some(writer) = writer.replace(next) {
                writer.finish().unwrap();
            }
            channels.clear();
        }
        let writer = writer.as_mut().unwrap();
        let channel = *channels
            .entry(message.channel)
            .or_insert_with(|| writer.channel(message.of).unwrap());
        let times = Times::at(message.log_time_ns);
        writer.message(channel, times, message.data).unwrap();
    }
    writer.unwrap().finish().unwrap();
    assert_eq!(begun, count);
    fs::write(folder.join("metadata.yaml"), "").unwrap();
}

#[test]
fn a_recorder_that_splits_its_recording_is_followed() {
    let folder = env::temp_dir().join(format!("grouser-view-split-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("run_0.mcap"), []).unwrap();
    let robot = Path::new(EXAMPLE).join("robot.toml");
    let run = |is_live| RecordedRun::open(&folder, &robot, None, is_live).unwrap();
    let feed = run(true).start();
    let recorder = std::thread::spawn({
        let folder = folder.clone();
        move || record_in_parts(&folder, 12)
    });
    let shown = |feed| {
        let mut shown = Shown::default();
        shown.wait(feed, |shown| shown.has_ended, PATIENCE);
        shown.moments
    };
    let bits = |moments: &[(f64, f64)]| -> Vec<(u64, u64)> {
        let pairs = moments.iter();
        pairs
            .map(|(time, slip)| (time.to_bits(), slip.to_bits()))
            .collect()
    };
    let followed = bits(&shown(&feed));
    recorder.join().unwrap();
    let expected = bits(&whole(true));
    assert!(expected.len() > 1000);
    assert!(followed == expected, "the same bits as of one file");
    // the folder as it is then, as one log
    assert!(bits(&shown(&run(false).start())) == bits(&whole(false)));
    fs::remove_dir_all(folder).unwrap();
}

/// Waits for the end of a followed log; its doubts.
fn doubts(feed: &Feed) -> Vec<String> {
    let begin = Instant::now();
    let mut next = 0;
    loop {
        let answer = feed.from(next);
        next = answer.next;
        for part in answer.parts {
            let part = &part[8..];
            let length = u32::from_le_bytes(part[..4].try_into().unwrap()) as usize;
            let head: Value = serde_json::from_slice(&part[4..4 + length]).unwrap();
            assert!(head["failed"].is_null(), "{head}");
            if let Some(doubts) = head["end"]["doubts"].as_array() {
                let words = doubts
                    .iter()
                    .map(|doubt| doubt.as_str().unwrap().to_owned());
                return words.collect();
            }
        }
        assert!(begin.elapsed() < PATIENCE, "it does not end");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_log_that_is_truncated_renamed_or_rotated_ends_with_a_doubt() {
    let folder = env::temp_dir().join(format!("grouser-view-rotated-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let example = Path::new(EXAMPLE);
    let robot = example.join("robot.toml");
    let whole = fs::read(example.join("log.csv")).unwrap();
    let half = whole[..whole.len() / 2]
        .iter()
        .rposition(|byte| *byte == b'\n')
        .unwrap()
        + 1;
    for (what, words) in [
        ("truncated", "truncated"),
        ("renamed", "renamed"),
        ("rotated", "renamed"),
    ] {
        let folder = folder.join(what);
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("log.csv");
        fs::write(&path, &whole[..half]).unwrap();
        let feed = RecordedRun::open(&path, &robot, None, true)
            .unwrap()
            .start();
        let mut shown = Shown::default();
        shown.wait(&feed, |shown| shown.last_s() > 5.0, PATIENCE);
        match what {
            "truncated" => OpenOptions::new()
                .write(true)
                .open(&path)
                .unwrap()
                .set_len(100)
                .unwrap(),
            "renamed" => fs::rename(&path, folder.join("away")).unwrap(),
            _ => {
                fs::rename(&path, folder.join("log.1")).unwrap();
                fs::write(&path, &whole[half..]).unwrap();
            }
        }
        let doubts = doubts(&feed);
        assert!(
            doubts.iter().any(|doubt| doubt.contains(words)),
            "{what}: {doubts:?}"
        );
    }
    fs::remove_dir_all(folder).unwrap();
}
