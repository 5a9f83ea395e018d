//! The greatest memory of `grouser log info`, and its time, on a file.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

pub fn run(program: &Path, file: &Path) {
    let bytes = fs::metadata(file).expect("a file").len() as f64;
    let start = Instant::now();
    let child = Command::new(program)
        .args(["log", "info"])
        .arg(file)
        .stdout(Stdio::null())
        .spawn();
    let mut child = child.expect("the command");
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kib = 0;
    let done = loop {
        // The system keeps the greatest so far; the last look may be some ms old.
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak_kib = peak_kib.max(kib.unwrap_or(0));
        match child.try_wait().expect("a status") {
            Some(done) => break done,
            None => sleep(Duration::from_millis(5)),
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    assert!(done.success(), "{done}");
    println!(
        "\n`grouser log info` on {:.0} MiB: {seconds:.1} s, {:.0} MB/s, at most {:.1} MiB of memory",
        bytes / 1048576.0,
        bytes / seconds / 1e6,
        peak_kib as f64 / 1024.0
    );
}
