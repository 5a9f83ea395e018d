//! A file that is written as a whole has all of it, or what was there.

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;

use grouser_files::{WholeFile, WriteError, write_whole};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("grouser-{}-{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn names(folder: &PathBuf) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    entries
        .map(|entry| entry.file_name().into_string().unwrap())
        .collect()
}

#[test]
fn a_write_that_fails_leaves_what_was_there() {
    let folder = folder("fails");
    let path = folder.join("page.html");
    write_whole(&path, b"old").unwrap();
    let mut file = WholeFile::create(&path).unwrap();
    file.write_all(b"half of the n").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    // as on a full disk: the writer gives up
    drop(file);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(&folder), ["page.html"]);
    write_whole(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(&folder), ["page.html"]);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_a_rename_would_replace_by_mistake_is_refused() {
    let folder = folder("refused");
    assert!(matches!(
        WholeFile::create(&folder),
        Err(WriteError::Directory)
    ));
    let path = folder.join("kept.toml");
    fs::write(&path, "kept").unwrap();
    let mut mode = fs::metadata(&path).unwrap().permissions();
    mode.set_readonly(true);
    fs::set_permissions(&path, mode).unwrap();
    assert!(matches!(
        WholeFile::create(&path),
        Err(WriteError::ReadOnly)
    ));
    assert_eq!(names(&folder), ["kept.toml"]);
    fs::remove_dir_all(folder).unwrap();
}

#[cfg(unix)]
#[test]
fn links_and_modes_stay_and_what_a_killed_program_left_goes() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = folder("links");
    let (path, link) = (folder.join("state.toml"), folder.join("link.toml"));
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("state.toml", &link).unwrap();
    // without its lock, as a program that was killed leaves it
    let file = WholeFile::create(&link).unwrap();
    let left = file.partial().unwrap().to_owned();
    drop(file);
    fs::write(&left, "half").unwrap();
    write_whole(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&path).unwrap(), b"new");
    let mode = fs::metadata(&path).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
    assert!(!left.exists());
    fs::remove_dir_all(folder).unwrap();
}
