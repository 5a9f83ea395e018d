//! Ctrl-C while a file is being written.
#![cfg(unix)]

use std::ffi::OsStr;
use std::io::Write as _;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use super::program::{Folder, LIMIT, send, start, wait};

#[test]
fn an_interrupted_job_leaves_nothing() {
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::new();
        let output = folder.path("out.csv");
        let mut child = start(
            ["batch".into(), "-".into(), "-o".into(), output],
            Stdio::piped(),
        );
        let mut pipe = child.stdin.take().unwrap();
        pipe.write_all(b"soil,radius_m,width_m,slip,load_n\nlunar,0.1,0.1,0.2,40\n")
            .unwrap();
        let begun = Instant::now();
        while folder.names().is_empty() {
            assert!(begun.elapsed() < LIMIT, "the output was never begun");
            thread::sleep(Duration::from_millis(2));
        }
        // It is being written under another name.
        assert_ne!(folder.names(), ["out.csv"]);
        assert!(send(&child, signal));
        let said = wait(child);
        drop(pipe);
        assert_eq!(said.code, Some(130), "{said:?}");
        assert!(folder.names().is_empty(), "{:?}", folder.names());
    }
}

/// A front that takes minutes: the first Ctrl-C ends it with what it has.
#[test]
fn an_interrupted_search_keeps_the_best_so_far() {
    let folder = Folder::new();
    let problem = folder.path("slow.toml");
    let example = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/problems/pull-against-torque.toml"
    );
    let text = std::fs::read_to_string(example).unwrap();
    let text: String = text
        .lines()
        .filter(|line| !line.starts_with("generations") && !line.starts_with("population"))
        .map(|line| match line {
            "[pareto]" => "[pareto]\ngenerations = 100000\npopulation = 40\n".to_owned(),
            line => format!("{line}\n"),
        })
        .collect();
    assert!(text.contains("100000"), "{text}");
    std::fs::write(&problem, text).unwrap();
    let output = folder.path("front.csv");
    // on a loaded machine three seconds are not enough for a front
    for seconds in [3, 10, 30, 100, 300] {
        let arguments = [
            OsStr::new("optimize"),
            problem.as_ref(),
            "--json".as_ref(),
            "-o".as_ref(),
            output.as_ref(),
        ];
        let child = start(arguments, Stdio::null());
        thread::sleep(Duration::from_secs(seconds));
        assert!(send(&child, "-INT"));
        let said = wait(child);
        assert_eq!(said.code, Some(130), "{said:?}");
        assert!(said.err.contains("best that was found so far"), "{said:?}");
        let points = said.json()["front"].as_array().map_or(0, Vec::len);
        if points <= 3 {
            continue;
        }
        let rows = std::fs::read_to_string(&output).unwrap().lines().count();
        assert_eq!(rows, points + 1);
        return;
    }
    panic!("no front");
}

/// A proof that takes minutes: the first Ctrl-C ends it with the bounds so far and a log that the checker accepts.
#[test]
fn an_interrupted_proof_keeps_its_bounds_and_its_log() {
    let folder = Folder::new();
    let log = folder.path("proof.jsonl");
    let example = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/problems/dry-sand-wheel.toml"
    );
    let child = start(
        [
            OsStr::new("optimize"),
            example.as_ref(),
            "--json".as_ref(),
            "--certify=1e-9".as_ref(),
            "--certify-time=600".as_ref(),
            "--proof".as_ref(),
            log.as_os_str(),
        ],
        Stdio::null(),
    );
    // some of it is written, under another name
    let begun = Instant::now();
    let size = |name: &String| std::fs::metadata(folder.path(name)).map_or(0, |file| file.len());
    while folder.names().iter().map(size).max() < Some(20_000) {
        assert!(begun.elapsed() < LIMIT, "no proof");
        thread::sleep(Duration::from_millis(20));
    }
    assert!(send(&child, "-INT"));
    let said = wait(child);
    assert_eq!(said.code, Some(130), "{said:?}");
    assert!(said.err.contains("interrupted"), "{said:?}");
    let certificate = &said.json()["certificate"];
    assert_eq!(certificate["status"], "stopped", "{certificate}");
    let lower = certificate["lower"].as_f64().unwrap();
    assert!(lower < certificate["upper"].as_f64().unwrap());
    let text = std::fs::read_to_string(log).unwrap();
    let last: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    assert_eq!(last["end"], "stopped");
    assert_eq!(last["lower"].as_f64().unwrap(), lower);
}
