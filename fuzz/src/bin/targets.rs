//! The target that `GROUSER_FUZZ` names, under libFuzzer. One program for all: it links once.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;

static RUN: LazyLock<fn(&[u8])> = LazyLock::new(|| {
    let name = std::env::var("GROUSER_FUZZ").unwrap_or_default();
    let Some(target) = grouser_fuzz::find(&name) else {
        eprintln!("GROUSER_FUZZ is {name:?}, which is no target");
        std::process::exit(2);
    };
    target.run
});

fuzz_target!(|bytes: &[u8]| RUN(bytes));
