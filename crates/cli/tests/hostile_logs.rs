//! The command on logs that are cut, flipped, empty or something else: an answer or an error with its exit
//! code, never a panic, a hang, or half an object on stdout.

use std::fs;
use std::path::Path;
use std::process::Output;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::repository::{Folder, is_error_alone, root};

const ROBOT: &str = "examples/five-wheel/robot.toml";
const COLUMNS: &str = "examples/five-wheel/columns.toml";

/// Runs the command; whatever it is given, it ends in time by one of its exit codes.
fn grouser(arguments: &[&str]) -> Output {
    let begin = Instant::now();
    let output = crate::repository::program()
        .current_dir(root())
        .args(arguments)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!printed.contains("panicked"), "{arguments:?}: {printed}");
    assert!(
        begin.elapsed() < Duration::from_mins(10),
        "{arguments:?}: {:?}",
        begin.elapsed()
    );
    let code = output.status.code();
    match code {
        Some(0 | 1 | 3) => {
            let text = std::str::from_utf8(&output.stdout).unwrap();
            let one: Value = serde_json::from_str(text).unwrap();
            assert!(
                one.is_object() && !text.contains("NaN"),
                "{arguments:?}: {text}"
            );
        }
        Some(2) => {
            assert!(is_error_alone(&output), "{arguments:?}");
            assert!(printed.starts_with("error: "), "{arguments:?}: {printed}");
        }
        _ => panic!("{arguments:?} ends with {code:?}: {printed}"),
    }
    output
}

/// Cuts, flips and overwritten stretches of a file, the same in every run.
fn broken(bytes: &[u8], count: usize) -> Vec<Vec<u8>> {
    let mut state = 2012_u64;
    let mut next = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below
    };
    let mut out = vec![Vec::new(), bytes[..1].to_vec(), bytes[..8].to_vec()];
    for _ in 0..count {
        out.push(bytes[..next(bytes.len())].to_vec());
        let mut flipped = bytes.to_vec();
        for _ in 0..=next(20) {
            flipped[next(bytes.len())] ^= 1 << next(8);
        }
        out.push(flipped);
        let mut wiped = bytes.to_vec();
        let at = next(bytes.len());
        let end = (at + next(5000)).min(bytes.len());
        wiped[at..end].fill(u8::try_from(next(256)).unwrap());
        out.push(wiped);
    }
    out
}

#[test]
fn estimate_and_info_of_a_broken_mcap_file() {
    let folder = Folder::new("hostile_logs-mcap");
    let whole = fs::read(root().join("examples/five-wheel/log.mcap")).unwrap();
    let mut estimated = 0;
    for bytes in broken(&whole, 8) {
        let log = folder.file("log.mcap", &bytes);
        let output = grouser(&["estimate", &log, "--robot", ROBOT, "--json"]);
        estimated += usize::from(output.status.code() == Some(0));
        grouser(&["log", "info", &log, "--json"]);
    }
    assert!(estimated > 8, "{estimated} of them have an estimate");
}

#[test]
fn recovery_of_a_broken_mcap_file_is_whole_partial_or_nothing() {
    let folder = Folder::new("hostile_logs-recover");
    let whole = fs::read(root().join("examples/five-wheel/log.mcap")).unwrap();
    for bytes in broken(&whole, 4) {
        let log = folder.file("log.mcap", &bytes);
        let saved = folder.0.join("saved.mcap");
        let _ = fs::remove_file(&saved);
        let saved = saved.to_str().unwrap();
        let output = grouser(&["log", "recover", &log, saved, "--json"]);
        let code = output.status.code();
        assert_eq!(
            Path::new(saved).exists(),
            matches!(code, Some(0 | 3)),
            "{code:?}"
        );
        if code == Some(3) {
            let again = grouser(&["log", "info", saved, "--json"]);
            let found: Value = serde_json::from_slice(&again.stdout).unwrap();
            assert_eq!(found["damage_count"], 0, "what was saved is whole");
        }
    }
}

#[test]
fn estimate_of_a_broken_table() {
    let folder = Folder::new("hostile_logs-table");
    let whole = fs::read(root().join("examples/five-wheel/log.csv")).unwrap();
    let whole = &whole[..60_000];
    for bytes in broken(whole, 8) {
        let log = folder.file("log.csv", &bytes);
        grouser(&[
            "estimate", &log, "--robot", ROBOT, "--map", COLUMNS, "--json",
        ]);
    }
}

#[test]
fn estimate_with_a_broken_robot_or_map() {
    let folder = Folder::new("hostile_logs-toml");
    for (name, other) in [(ROBOT, COLUMNS), (COLUMNS, ROBOT)] {
        let whole = fs::read(root().join(name)).unwrap();
        for bytes in broken(&whole, 6) {
            let file = folder.file("file.toml", &bytes);
            let (robot, map) = if name == ROBOT {
                (&*file, other)
            } else {
                (other, &*file)
            };
            let log = "examples/five-wheel/log.csv";
            grouser(&["estimate", log, "--robot", robot, "--map", map, "--json"]);
        }
    }
}

#[test]
fn a_log_that_is_something_else() {
    let folder = Folder::new("hostile_logs-else");
    let noise: Vec<u8> = (0..5000_u32)
        .map(|k| k.wrapping_mul(2_654_435_761).to_be_bytes()[0])
        .collect();
    let of_magic = [&b"\x89MCAP0\r\n"[..], &noise].concat();
    let of_bag = [&b"#ROSBAG V2.0\n"[..], &noise].concat();
    for (name, bytes) in [
        ("log.mcap", &noise),
        ("log.bag", &noise),
        ("log.csv", &noise),
        ("cut.mcap", &of_magic),
        ("cut.bag", &of_bag),
        ("bag.mcap", &of_bag),
    ] {
        let log = folder.file(name, bytes);
        let output = grouser(&["estimate", &log, "--robot", ROBOT, "--json"]);
        assert_ne!(output.status.code(), Some(0), "{name}");
        grouser(&["log", "info", &log, "--json"]);
    }
    #[cfg(unix)]
    for path in ["/dev/zero", "/", "examples"] {
        let output = grouser(&["estimate", path, "--robot", ROBOT, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{path}");
    }
}
