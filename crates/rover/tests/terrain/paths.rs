//! Paths that are no files. None may hang.
#![cfg(unix)]

use std::fs;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use grouser_rover::Error;
use grouser_rover::ground::{HeightFile, TerrainFault, read_heights};

use super::made::SMALL_GRID;
use crate::processor_time::ThreadTime;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path =
            std::env::temp_dir().join(format!("grouser-terrain-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn refused(path: &Path) -> Error {
    let file = HeightFile {
        path: path.to_owned(),
        cell: None,
        height_step: 1.0,
    };
    read_heights(&file).unwrap_err()
}

fn said(path: &Path) -> String {
    match refused(path) {
        Error::File(error) => error.to_string(),
        other => panic!("{other}"),
    }
}

#[test]
fn what_is_no_regular_file() {
    let folder = Folder::new("kinds");
    let directory = folder.0.join("folder.asc");
    fs::create_dir(&directory).unwrap();
    assert!(said(&directory).contains("directory"));
    let pipe = folder.0.join("pipe.tif");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    assert!(said(&pipe).contains("pipe"));
    let device = folder.0.join("zero.png");
    symlink("/dev/zero", &device).unwrap();
    assert!(said(&device).contains("device"));
    let (a, b) = (folder.0.join("a.asc"), folder.0.join("b.asc"));
    symlink(&a, &b).unwrap();
    symlink(&b, &a).unwrap();
    assert!(said(&a).contains("a.asc"));
    assert!(said(&folder.0.join("missing.asc")).contains("missing.asc"));
}

#[test]
fn names_that_are_not_utf_8() {
    let folder = Folder::new("names");
    let path = folder.0.join(std::ffi::OsStr::from_bytes(b"gr\xffund.asc"));
    fs::write(&path, SMALL_GRID).unwrap();
    let file = HeightFile {
        path,
        cell: None,
        height_step: 1.0,
    };
    assert!(read_heights(&file).is_ok());
}

#[test]
fn a_file_beyond_its_limit_is_not_read_whole() {
    let folder = Folder::new("large");
    let path = folder.0.join("large.asc");
    // a hole of 1 TiB: nothing is stored
    if fs::File::create(&path).unwrap().set_len(1 << 40).is_ok() {
        let begun = ThreadTime::now();
        let Error::Terrain { fault, .. } = refused(&path) else {
            panic!("another error");
        };
        assert_eq!(fault, TerrainFault::TooManyBytes { limit: 1 << 28 });
        assert!(begun.elapsed().as_secs() < 5);
    }
}

#[test]
fn endings_that_are_no_kind() {
    let folder = Folder::new("endings");
    for name in ["ground", "ground.jpg", "ground.tif.gz"] {
        let path = folder.0.join(name);
        fs::write(&path, "x").unwrap();
        let Error::Terrain { fault, .. } = refused(&path) else {
            panic!("another error");
        };
        assert_eq!(fault, TerrainFault::Kind, "{name}");
    }
}
