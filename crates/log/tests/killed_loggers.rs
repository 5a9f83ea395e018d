//! A program is killed at a random moment of its logging. A part of the kills runs always; a
//! thousand of each format by `just dense`.

use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{env, thread};

use grouser_log::container::{Channel, Container, Encoding, Event, Format};
use grouser_log::write::{Times, Writer};

use crate::scratch::Folder;

const INTO: &str = "GROUSER_LOG_INTO";
/// Messages at 200 Hz, ns.
const PERIOD_NS: u64 = 5_000_000;
const BEGIN_NS: u64 = 1_700_000_000_000_000_000;

/// Of a robot's kind, not of zeros: they would pack to nothing.
fn payload(number: u64) -> [u8; 48] {
    let mut bytes = [0; 48];
    for (place, part) in bytes.chunks_mut(8).enumerate() {
        let mixed = (number * 6 + place as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        part.copy_from_slice(&mixed.to_le_bytes());
    }
    bytes
}

/// The program that is killed: it logs until then, and says after each tenth message that it was taken.
#[test]
fn logger() {
    let Some(path) = env::var_os(INTO).map(PathBuf::from) else {
        return;
    };
    let is_bag = path.extension().is_some_and(|end| end == "bag");
    let format = if is_bag { Format::Bag } else { Format::Mcap };
    let out = BufWriter::new(File::create(&path).unwrap());
    let mut writer = Writer::new(out, format, "").unwrap();
    let channel = Channel {
        topic: "/wheels".to_owned(),
        type_name: "grouser/Wheels".to_owned(),
        definition: b"uint64[6] ticks"[..].into(),
        definition_language: "ros1msg".to_owned(),
        encoding: Encoding::Ros1,
        encoding_name: "ros1".to_owned(),
        metadata: std::collections::BTreeMap::new(),
    };
    let channel = writer.channel(&channel).unwrap();
    let mut reported = std::io::stdout().lock();
    for number in 0_u64.. {
        let times = Times::at(BEGIN_NS + number * PERIOD_NS);
        writer.message(channel, times, &payload(number)).unwrap();
        if number % 10 == 9 {
            writeln!(reported, "taken {number}").unwrap();
        }
    }
}

/// Kills a logger after a while; how many messages it said were taken, and which are read of its file.
fn kill(path: &Path, after: Duration) -> (u64, Vec<u64>) {
    let mut running = Command::new(env::current_exe().unwrap())
        .args(["killed_loggers::logger", "--exact", "--nocapture"])
        .env(INTO, path)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let reported = BufReader::new(running.stdout.take().unwrap());
    let counting = thread::spawn(move || {
        let lines = reported.lines().map_while(Result::ok);
        let taken = lines.filter_map(|line| line.strip_prefix("taken ")?.parse::<u64>().ok());
        taken.last().map_or(0, |last| last + 1)
    });
    thread::sleep(after);
    running.kill().unwrap();
    running.wait().unwrap();
    let taken = counting.join().unwrap();

    let mut read = Vec::new();
    if let Ok(mut container) = Container::open(path) {
        while let Some(event) = container.next() {
            if let Event::Message(message) = event {
                let number = (message.log_time_ns - BEGIN_NS) / PERIOD_NS;
                assert_eq!(message.data, payload(number), "message {number}");
                read.push(number);
            }
        }
    }
    (taken, read)
}

fn kill_often(extension: &str) {
    let kills = if env::var_os("GROUSER_DENSE").is_some() {
        1000
    } else {
        25
    };
    let folder = Folder::new(&format!("killed-{extension}"));
    let path = folder.0.join(format!("log.{extension}"));
    let (mut most_lost, mut longest) = (0, 0);
    for kill_number in 0..kills {
        let after = Duration::from_micros(3000 + kill_number * 7919 % 30_000);
        let (taken, read) = kill(&path, after);
        let whole = 0..read.len() as u64;
        assert!(
            read.iter().copied().eq(whole),
            "{after:?}: a gap or a repeat"
        );
        // One second of messages, and the one that would have closed their chunk.
        let lost = taken.saturating_sub(read.len() as u64);
        assert!(
            lost * PERIOD_NS <= 1_000_000_000 + PERIOD_NS,
            "{lost} lost of {taken}"
        );
        (most_lost, longest) = (lost.max(most_lost), taken.max(longest));
    }
    println!("{extension}: {kills} kills, at most {most_lost} of up to {longest} messages lost");
    assert!(longest > 400, "killed too early to say anything: {longest}");
}

#[test]
fn of_a_killed_logger_a_second_of_its_mcap_is_lost_at_most() {
    kill_often("mcap");
}

#[test]
fn of_a_killed_logger_a_second_of_its_bag_is_lost_at_most() {
    kill_often("bag");
}
