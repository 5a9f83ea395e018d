//! Paths that are no files. None may hang, and each has its own error.
#![cfg(unix)]

use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use grouser_files::{Error, regular, robot};

/// A folder of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("grouser-e12-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn what(path: &Path) -> String {
    match robot::read(path).unwrap_err() {
        Error::NotAFile { what, .. } => what.into(),
        Error::Unreadable { source, .. } => format!("{:?}", source.kind()),
        other => other.to_string(),
    }
}

#[test]
fn a_loop_of_links() {
    let folder = Folder::new("loop");
    let (a, b) = (folder.0.join("a.toml"), folder.0.join("b.toml"));
    symlink(&a, &b).unwrap();
    symlink(&b, &a).unwrap();
    // The name of a kind that the standard library has not stabilised yet.
    assert_eq!(what(&a), "FilesystemLoop");
}

#[test]
fn a_directory() {
    let folder = Folder::new("directory");
    assert_eq!(what(&folder.0), "a directory");
}

#[test]
fn a_pipe_that_nobody_writes() {
    let folder = Folder::new("pipe");
    let pipe = folder.0.join("pipe.toml");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    assert_eq!(what(&pipe), "a pipe");
}

#[test]
fn a_device_without_end() {
    assert_eq!(what(Path::new("/dev/zero")), "a device");
    assert_eq!(what(Path::new("/dev/null")), "a device");
}

#[test]
fn no_permission() {
    let folder = Folder::new("permission");
    let file = folder.0.join("secret.toml");
    fs::write(&file, "format = 1").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser may read it anyway: then it is read, and is an incomplete robot.
    if fs::File::open(&file).is_err() {
        assert_eq!(what(&file), format!("{:?}", ErrorKind::PermissionDenied));
    } else {
        assert!(matches!(robot::read(&file), Err(Error::MissingKey { .. })));
    }
}

#[test]
fn names_that_are_not_utf_8_and_files_that_are_not_there() {
    let folder = Folder::new("names");
    let odd = folder.0.join(OsStr::from_bytes(b"r\xff.toml"));
    assert_eq!(what(&odd), format!("{:?}", ErrorKind::NotFound));
    fs::write(&odd, "format = 1\nname = \"\\u0000").unwrap();
    assert!(matches!(robot::read(&odd), Err(Error::Syntax { .. })));
    fs::write(&odd, b"format = 1\nname = \"\xff\"").unwrap();
    let error = robot::read(&odd).unwrap_err();
    assert!(
        matches!(&error, Error::NotText { at } if (at.line, at.column) == (2, 9)),
        "{error}"
    );
}

#[test]
fn a_table_or_a_log_in_the_place_of_a_toml_file() {
    let folder = Folder::new("table");
    let hint_of = |name: &str, bytes: &[u8]| {
        let file = folder.0.join(name);
        fs::write(&file, bytes).unwrap();
        robot::read(&file).unwrap_err().hint()
    };
    let expected = Some("a TOML file is expected here (.toml)".to_owned());
    assert_eq!(hint_of("drive.csv", b"time_s,x_m\n0,1\n"), expected);
    assert_eq!(hint_of("drive.mcap", b"\x89MCAP0\r\n\xff"), expected);
    assert_eq!(hint_of("robot.toml", b"time_s,x_m\n0,1\n"), None);
}

#[test]
fn a_file_beyond_its_limit_is_not_read_whole() {
    let folder = Folder::new("large");
    let file = folder.0.join("large.toml");
    // A hole of 1 TiB: nothing is stored, and nothing of it may be held.
    let sparse = fs::File::create(&file).unwrap();
    if sparse.set_len(1 << 40).is_ok() {
        assert!(matches!(robot::read(&file), Err(Error::TooLarge { .. })));
        assert!(matches!(
            regular::read_text(&file, 10),
            Err(Error::TooLarge { limit: 10, .. })
        ));
    }
}
