//! Reading of logs beside its rivals, in one run:
//!
//! `cargo run --release --manifest-path bench/log/Cargo.toml`
//!
//! `-- large GROUSER`: the memory of that program's `log info` on a file of 1 GiB, which is written to the
//! folder for temporary files and removed.
//!
//! `-- write FILE MIB`: the file for readers in other languages (`rosbags_read.py`).

mod decode;
mod memory;
mod read;
mod sample;
mod timing;
mod unzip;

use std::path::Path;
use std::{env, fs, process};

fn main() {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let scratch = env::temp_dir().join(format!("grouser-log-bench-{}.mcap", process::id()));
    match words[..] {
        [] => {
            sample::write(&scratch, 64 << 20, false);
            read::run(&scratch);
            unzip::run(&scratch);
            decode::run();
            rosbags(&scratch);
        }
        ["large", program] => {
            sample::write(&scratch, 1100 << 20, true);
            memory::run(Path::new(program), &scratch);
        }
        ["write", file, mib] => {
            let mib: u64 = mib.parse().expect("a number of MiB");
            sample::write(Path::new(file), mib << 20, false);
            return;
        }
        _ => {
            eprintln!("usage: grouser-log-bench | large GROUSER | write FILE MIB");
            process::exit(2);
        }
    }
    fs::remove_file(&scratch).expect("removed");
}

/// Python's rosbags on the same file, by the interpreter that `ROSBAGS_PYTHON` names.
fn rosbags(file: &Path) {
    let Some(python) = env::var_os("ROSBAGS_PYTHON") else {
        println!("\nrosbags: skipped, ROSBAGS_PYTHON does not name a Python that has it");
        return;
    };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/rosbags_read.py");
    let done = process::Command::new(python).arg(script).arg(file).status();
    assert!(done.expect("Python").success());
}
