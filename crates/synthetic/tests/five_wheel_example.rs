//! The example that ships is what the generator gives, to the byte.

use std::fs;
use std::path::Path;

use grouser_synthetic::FiveWheel;

#[test]
fn the_shipped_example_is_the_generators() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/five-wheel");
    let run = FiveWheel::default().generate();
    for (name, fresh) in [("log.csv", run.log_csv()), ("truth.csv", run.truth_csv())] {
        let shipped = fs::read_to_string(folder.join(name)).unwrap();
        let differing = shipped.lines().zip(fresh.lines()).position(|(a, b)| a != b);
        assert!(
            shipped == fresh,
            "{name} differs from line {:?} on; if that is meant: \
             cargo run -p grouser-synthetic --example write -- examples/five-wheel",
            differing.map(|line| line + 1)
        );
    }
}

#[test]
fn the_shipped_mcap_is_the_generators() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/five-wheel");
    let fresh = FiveWheel::default().generate().log_mcap().unwrap();
    let shipped = fs::read(folder.join("log.mcap")).unwrap();
    let differing = shipped.iter().zip(&fresh).position(|(a, b)| a != b);
    assert!(
        shipped == fresh,
        "log.mcap differs from byte {differing:?} on; if that is meant: \
         cargo run -p grouser-synthetic --example write -- examples/five-wheel"
    );
}

#[test]
fn another_seed_is_another_run() {
    let other = FiveWheel {
        seed: 1,
        ..FiveWheel::default()
    };
    assert_ne!(other.generate().rows, FiveWheel::default().generate().rows);
}
