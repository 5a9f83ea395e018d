//! The C example against the engine of `grouser estimate`, on the same log: the same bits.

use std::collections::BTreeMap;
use std::process::Command;

use grouser_files::{columns, robot};
use grouser_log::Log;
use grouser_replay::{Options, Row, run};
use grouser_slip::WheelRole;

use crate::compiler::{folder, library, needs_compiler, scratch};

/// Slip and sigma of a wheel at a time, as bits.
type Slips = BTreeMap<(i64, usize), (u64, u64)>;

#[test]
fn the_example_prints_the_slips_of_the_estimate() {
    let Some(cc) = needs_compiler("cc") else {
        return;
    };
    let program = scratch("replay").join("replay");
    let source = folder().join("examples/replay.c");
    let lines = std::fs::read_to_string(&source).unwrap().lines().count();
    assert!(lines <= 60, "the example has {lines} lines");
    let flags = [
        "-std=c11",
        "-pedantic",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-o",
        program.to_str().unwrap(),
    ];
    cc.run(&flags, &[&source, &library()]);

    let example = folder().join("../../examples/five-wheel");
    let files = [example.join("robot.toml"), example.join("log.csv")];
    let output = Command::new(&program).args(&files).output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let by_c = printed(&String::from_utf8(output.stdout).unwrap());

    let file = robot::read(&files[0]).unwrap();
    let map = columns::read(&example.join("columns.toml")).unwrap();
    let log = Log::find(&files[1..], map).unwrap();
    let mut by_engine = Slips::new();
    let take = |row: &Row<'_>| {
        if let (Some(slip), Some(sigma)) = (row.slip, row.slip_sigma) {
            #[allow(clippy::cast_possible_truncation, reason = "the log is 40 s long")]
            let time_ns = (row.time_s * 1e3).round() as i64 * 1_000_000;
            by_engine.insert((time_ns, row.wheel), (slip.to_bits(), sigma.to_bits()));
        }
        Ok(())
    };
    run(&log, &file, &Options::default(), take).unwrap();

    let powered = |wheel: usize| file.robot.wheels()[wheel].role == WheelRole::Powered;
    // the engine prints no slip for the wheel that is its reference
    let by_c: Slips = by_c.into_iter().filter(|(key, _)| powered(key.1)).collect();
    assert!(by_engine.len() > 6000, "{} slips", by_engine.len());
    assert_eq!(by_c.len(), by_engine.len());
    for (key, bits) in &by_engine {
        let [c, engine] = [by_c[key], *bits].map(|(s, d)| (f64::from_bits(s), f64::from_bits(d)));
        assert!(
            by_c[key] == *bits,
            "{key:?}: {c:?} by C, {engine:?} by the engine"
        );
    }
}

/// The slips in the example's lines: time, then slip, sigma and health of each wheel.
fn printed(text: &str) -> Slips {
    let mut slips = Slips::new();
    for line in text.lines() {
        let mut cells = line.split(',');
        let time_ns = cells.next().unwrap().parse().unwrap();
        let cells: Vec<_> = cells.collect();
        for (wheel, cell) in cells.chunks(3).enumerate() {
            let [slip, sigma] = [cell[0], cell[1]].map(|text| text.parse::<f64>().ok());
            if let (Some(slip), Some(sigma)) = (slip, sigma) {
                slips.insert((time_ns, wheel), (slip.to_bits(), sigma.to_bits()));
            }
        }
    }
    slips
}
