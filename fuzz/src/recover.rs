//! A damaged log written anew, as either format: what was written is read again whole, message by message.
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::LazyLock;

use grouser_log::Error;
use grouser_log::container::Format;
use grouser_log::write::{copy, verify};

/// Files in memory where the system has them.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let memory = PathBuf::from("/dev/shm");
    if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    }
});

fn file(name: &str) -> PathBuf {
    FOLDER.join(format!("grouser-fuzz-{}-{name}", std::process::id()))
}

pub fn run(bytes: &[u8]) {
    let magics: [&[u8]; 2] = [b"\x89MCAP0\r\n", b"#ROSBAG V2.0\n"];
    let kind = bytes.last().copied().unwrap_or(0);
    let is_log = magics.iter().any(|magic| bytes.starts_with(magic));
    // Magic bytes are hardly found by mutation.
    let magic = if is_log {
        &[][..]
    } else {
        magics[usize::from(kind % 2)]
    };
    let format = if kind / 2 % 2 == 0 {
        Format::Mcap
    } else {
        Format::Bag
    };
    let damaged = file("damaged");
    fs::write(&damaged, [magic, bytes].concat()).expect("a file");
    let mut written = Cursor::new(Vec::new());
    let copied = match copy(&damaged, &mut written, format, |_| {}) {
        Ok(copied) => copied,
        // A bag takes messages of ROS 1 only, and no time after 2106.
        Err(Error::Output(error)) => {
            assert_eq!(error.kind(), std::io::ErrorKind::InvalidInput, "{error}");
            return;
        }
        Err(_) => return,
    };
    let anew = file("anew");
    fs::write(&anew, written.into_inner()).expect("a file");
    verify(&anew, &copied).expect("what was written is whole");
}
