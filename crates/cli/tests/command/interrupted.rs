//! Ctrl-C while a file is being written.
#![cfg(unix)]

use std::io::Write as _;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::program::{Folder, start, wait};

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
            assert!(
                begun.elapsed() < Duration::from_secs(30),
                "the output was never begun"
            );
            thread::sleep(Duration::from_millis(2));
        }
        // It is being written under another name.
        assert_ne!(folder.names(), ["out.csv"]);
        let sent = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status()
            .unwrap();
        assert!(sent.success());
        let said = wait(child);
        drop(pipe);
        assert_eq!(said.code, Some(130), "{said:?}");
        assert!(folder.names().is_empty(), "{:?}", folder.names());
    }
}
