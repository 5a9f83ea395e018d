//! A black-box campaign against the built program: every verb with damaged files, hostile flags, places that are no files,
//! closed outputs, signals and limits of the system. `GROUSER_ATTACK_CASES` says how many cases (60 unless set; `just attack`
//! runs 6000), `GROUSER_ATTACK_FIRST` which is the first. A case depends on its number alone.
#![cfg(target_os = "linux")]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and may say what it measured"
)]

#[path = "../command/program.rs"]
#[allow(dead_code, reason = "other tests use the rest")]
mod program;

mod damage;
mod mischief;
mod random;
mod run;
mod verbs;

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use mischief::Mischief;
use random::Random;

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().unwrap())
}

#[test]
fn nothing_breaks_the_program() {
    let first = number("GROUSER_ATTACK_FIRST", 0);
    let cases = number("GROUSER_ATTACK_CASES", 60);
    let shared = verbs::Shared::new();
    let next = AtomicU64::new(first);
    let failures = Mutex::new(Vec::new());
    let counts = Mutex::new(BTreeMap::new());
    let work = || {
        loop {
            let case = next.fetch_add(1, Ordering::Relaxed);
            if case >= first + cases {
                return;
            }
            let mut random = Random::new(case);
            let verb = verbs::choose(&mut random);
            let mischief = Mischief::choose(&mut random);
            let ended = run::run(&shared, verb, mischief, &mut random);
            let key = (mischief.name(), ended.code);
            *counts.lock().unwrap().entry(key).or_insert(0) += 1;
            if let Err(why) = ended.verdict {
                println!("case {case}: {why}");
                failures.lock().unwrap().push(case);
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    println!("mischief, exit code: cases");
    for ((mischief, code), count) in counts.into_inner().unwrap() {
        println!("{mischief}, {code:?}: {count}");
    }
    let failures = failures.into_inner().unwrap();
    println!("{cases} cases from {first}: {} failures", failures.len());
    assert!(failures.is_empty(), "cases {failures:?}");
}
