//! A robot of eight wheels at 200 Hz, with bursts: slips stay right, no message is lost, and memory stays flat.
//!
//! Twenty seconds by default; `GROUSER_LIVE_SOAK_S` sets another time (`just live-soak`), and `GROUSER_LIVE_BURSTS=0` leaves
//! the bursts out, so that latencies are those of a steady stream.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and prints what it measured"
)]
#![allow(dead_code, reason = "the peers are shared by several tests")]

mod peers;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use peers::{Node, Peer, Place, python};
use serde_json::json;

const RATE_HZ: f64 = 200.0;
/// Memory that a run of any length may add after its start, kB: an allocator's slack. A leak of 100 bytes for each of 400
/// messages a second adds 2 MB within the minute.
const MAX_GROWTH_KB: u64 = 1024;
/// Messages of one burst: half a second of both topics.
const BURST: u64 = 200;

/// Seven driven wheels and a free one, measured by angles.
fn robot(place: &Place) -> (PathBuf, Vec<String>) {
    let mut text = "format = 1\nname = \"eight wheels\"\n".to_owned();
    let mut joints: Vec<String> = (0..7).map(|index| format!("wheel_{index}")).collect();
    joints.push("fifth".to_owned());
    for (index, joint) in joints.iter().enumerate() {
        let role = if joint == "fifth" { "free" } else { "powered" };
        let (x, y) = (
            0.8 - 0.2 * index as f64,
            if index % 2 == 0 { 0.4 } else { -0.4 },
        );
        writeln!(
            text,
            "[[wheel]]\nname = \"{joint}\"\ndrive = \"{role}\"\nx_m = {x:.1}\ny_m = {y}\nradius_m = 0.1\nwidth_m = 0.1\n\
             load_n = 60.0\nencoder_on = \"wheel\"\nticks_per_turn = 4096"
        )
        .unwrap();
    }
    let file = place.folder.join("robot.toml");
    std::fs::write(&file, text).unwrap();
    (file, joints)
}

/// Resident memory, kB.
fn memory_kb(process: u32) -> u64 {
    let status = peers::read(std::path::Path::new(&format!("/proc/{process}/status")));
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))
        .unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// Processor time so far, s.
fn processor_s(process: u32) -> f64 {
    let stat = peers::read(std::path::Path::new(&format!("/proc/{process}/stat")));
    let fields: Vec<&str> = stat
        .rsplit_once(')')
        .unwrap()
        .1
        .split_whitespace()
        .collect();
    // user and system time in ticks of 10 ms
    fields[11..13]
        .iter()
        .map(|ticks| ticks.parse::<f64>().unwrap() * 0.01)
        .sum()
}

fn soak(transport: &'static str) {
    let Some(python) = python() else { return };
    let setting = |name: &str| std::env::var(name).ok();
    let seconds = setting("GROUSER_LIVE_SOAK_S").map_or(20.0, |text| text.parse().unwrap());
    let has_bursts = setting("GROUSER_LIVE_BURSTS").as_deref() != Some("0");
    let place = Place::new(transport, "soak");
    let (robot, joints) = robot(&place);
    let mut peer = Peer::start(&python, &place);
    peer.call(&json!(["open", "driver"]));
    peer.call(&json!([
        "listen",
        "driver",
        "/grouser/slip",
        "/diagnostics"
    ]));
    peer.call(&json!(["drive", "driver", { "rate_hz": RATE_HZ, "joints": joints }]));
    let node = Node::start(&place, &robot, &["--look-s", "1", "--quiet"]);
    let is_right = |message: &serde_json::Value| {
        let slip = message["slip"][0].as_f64();
        slip.is_some_and(|slip| (slip - 0.2).abs() < 0.02) && message["health"][0] == "Ok"
    };
    peer.until_slip(is_right);
    // the program has started itself again with what its transport needs
    let variables = std::fs::read(format!("/proc/{}/environ", node.id())).unwrap();
    let variables = String::from_utf8_lossy(&variables);
    let needed = if transport == "dds" {
        "MALLOC_ARENA_MAX=1\0"
    } else {
        "ZENOH_RUNTIME=(rx"
    };
    assert!(variables.contains(needed), "{variables}");
    // what is allocated once is allocated by now
    // the transports keep 1000 messages of each topic, and DDS grows by 1 MB from the 10th to the 25th second; by 0.1 MB in the minute after
    std::thread::sleep(Duration::from_secs(25));
    let (begun, processor) = (Instant::now(), processor_s(node.id()));
    let (start_kb, mut most_kb) = (memory_kb(node.id()), 0);
    let (mut looks, mut wrong) = (0, 0);
    while begun.elapsed().as_secs_f64() < seconds {
        if has_bursts && looks % 10 == 5 {
            peer.call(&json!(["change", "driver", "burst", BURST]));
        }
        std::thread::sleep(Duration::from_secs(1));
        looks += 1;
        wrong += usize::from(!is_right(&peer.slip()));
        most_kb = most_kb.max(memory_kb(node.id()));
    }
    let share = (processor_s(node.id()) - processor) / begun.elapsed().as_secs_f64();
    let status = peer.node_status();
    let value = |key: &str| {
        let values = status["values"].as_array().unwrap();
        let entry = values.iter().find(|entry| entry["key"] == key).unwrap();
        entry["value"].as_str().unwrap().parse::<f64>().unwrap()
    };
    println!(
        "{transport}: {seconds} s, {} messages, processor {:.2} %, memory {start_kb} to at most {most_kb} kB, latency median \
         {} us, 99.9 % {} us, longest {} us",
        value("messages"),
        100.0 * share,
        value("latency_median_us"),
        value("latency_p999_us"),
        value("latency_longest_us"),
    );
    assert!(value("messages_dropped") < 0.5, "{status}");
    assert!(value("messages_undecoded") < 0.5, "{status}");
    assert!(
        value("messages") > 0.9 * 2.0 * RATE_HZ * seconds,
        "{status}"
    );
    assert_eq!(wrong, 0, "of {looks} looks");
    assert!(
        most_kb < start_kb + MAX_GROWTH_KB,
        "{start_kb} to {most_kb} kB"
    );
    let ended = node.interrupt(&place);
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);
}

#[cfg(feature = "zenoh")]
#[test]
fn over_zenoh() {
    soak("zenoh");
}

#[cfg(feature = "dds")]
#[test]
fn over_dds() {
    soak("dds");
}
