//! `install.sh`: what it places, refuses and removes, with releases of a shell script in place of the program.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::repository::{Folder, root};

/// A release of files in `bin/` and `share/`, as `release/make` packs them, in a folder of its own.
fn release(folder: &Folder, version: &str, files: &[&str]) -> String {
    let name = format!(
        "grouser-{version}-{}-unknown-linux-musl",
        std::env::consts::ARCH
    );
    let script = format!(
        "mkdir -p '{version}' '{name}/bin' '{name}/share'
         printf '#!/bin/sh\\necho grouser {version}\\n' >'{name}/bin/grouser'
         chmod +x '{name}/bin/grouser'
         for file in {}; do echo {version} >\"{name}/$file\"; done
         tar -czf '{version}/{name}.tar.gz' '{name}'
         cd '{version}' && sha256sum ./* | sed 's|\\./||' >SHA256SUMS",
        files.join(" ")
    );
    let shell = Command::new("sh")
        .current_dir(&folder.0)
        .args(["-euc", &script])
        .status();
    assert!(shell.unwrap().success());
    folder.path(version)
}

fn install(releases: &str, prefix: &str, more: &[&str]) -> Output {
    let mut script = Command::new("sh");
    script
        .arg(root().join("install.sh"))
        .args(["--prefix", prefix])
        .args(more);
    script.env("GROUSER_RELEASES", releases).output().unwrap()
}

/// All files below a folder, from it on.
fn content(folder: &str) -> Vec<String> {
    let find = Command::new("find")
        .current_dir(folder)
        .args([".", "-type", "f"])
        .output();
    let found = String::from_utf8(find.unwrap().stdout).unwrap();
    let mut found: Vec<String> = found.lines().map(str::to_owned).collect();
    found.sort();
    found
}

/// Exit code 1, one error with a hint, and the folder as it was.
fn assert_nothing_installed(output: &Output, prefix: &str, before: &[String], reason: &str) {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains(reason) && errors.contains("hint: "),
        "{errors}"
    );
    assert_eq!(content(prefix), before);
}

#[test]
fn a_release_is_installed_replaced_and_removed() {
    let folder = Folder::new("install");
    let prefix = folder.path("prefix");
    fs::create_dir_all(Path::new(&prefix).join("bin")).unwrap();
    fs::write(Path::new(&prefix).join("bin/other"), "not ours").unwrap();
    let before = content(&prefix);

    let first = release(&folder, "1.0.0", &["share/old", "share/kept"]);
    let said = install(&first, &prefix, &[]);
    let text = String::from_utf8_lossy(&said.stdout);
    assert!(
        said.status.success() && text.contains("installed grouser 1.0.0"),
        "{said:?}"
    );
    assert!(text.contains("--remove"), "{text}");
    let program = Command::new(format!("{prefix}/bin/grouser"))
        .output()
        .unwrap();
    assert_eq!(program.stdout, b"grouser 1.0.0\n");

    // the next version, from a file:// address: its files replace those of the first
    let second = release(&folder, "1.1.0", &["share/new", "share/kept"]);
    let said = install(&format!("file://{second}"), &prefix, &[]);
    assert!(said.status.success(), "{said:?}");
    let ours = [
        "bin/grouser",
        "bin/other",
        "share/grouser/installed-files",
        "share/kept",
        "share/new",
    ];
    assert_eq!(content(&prefix), ours.map(|name| format!("./{name}")));
    assert_eq!(
        fs::read_to_string(format!("{prefix}/share/kept")).unwrap(),
        "1.1.0\n"
    );

    assert!(install(&second, &prefix, &["--remove"]).status.success());
    assert_eq!(content(&prefix), before);
    assert!(!Path::new(&prefix).join("share").exists());
    let again = install(&second, &prefix, &["--remove"]);
    assert_nothing_installed(&again, &prefix, &before, "no installation");
}

#[test]
fn what_is_wrong_with_a_release_leaves_the_folder_as_it_was() {
    let folder = Folder::new("install-refused");
    let prefix = folder.path("prefix");
    fs::create_dir_all(Path::new(&prefix).join("bin")).unwrap();
    fs::write(Path::new(&prefix).join("bin/grouser"), "not ours").unwrap();
    let before = content(&prefix);
    let releases = release(&folder, "1.0.0", &["share/file"]);

    let foreign = install(&releases, &prefix, &[]);
    assert_nothing_installed(
        &foreign,
        &prefix,
        &before,
        "was not installed by this script",
    );
    let absent = install(&releases, &prefix, &["--version", "2.0.0"]);
    assert_nothing_installed(&absent, &prefix, &before, "lists no archive of 2.0.0");
    let nowhere = install(&folder.path("nowhere"), &prefix, &[]);
    assert_nothing_installed(&nowhere, &prefix, &before, "cannot fetch");

    let archive = fs::read_dir(&releases)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let archive = archive
        .into_iter()
        .find(|path| path.extension().is_some_and(|end| end == "gz"))
        .unwrap();
    let mut bytes = fs::read(&archive).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&archive, bytes).unwrap();
    let damaged = install(&releases, &prefix, &[]);
    assert_nothing_installed(&damaged, &prefix, &before, "SHA-256");
    fs::remove_file(&archive).unwrap();
    let missing = install(&releases, &prefix, &[]);
    assert_nothing_installed(&missing, &prefix, &before, "cannot fetch");
}
