//! Every example of the README, pasted as it stands.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap()
        .to_owned()
}

/// The README's fenced blocks: their kind and their text.
fn blocks() -> Vec<(String, String)> {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.as_mut()) {
            (Some(kind), None) => open = Some((kind.to_owned(), String::new())),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some((_, body))) => {
                body.push_str(line);
                body.push('\n');
            }
            (None, None) => {}
        }
    }
    blocks
}

/// A folder of its own with what the examples read, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        let folder = std::env::temp_dir().join(format!("grouser-readme-{}", std::process::id()));
        copy(&root().join("examples"), &folder.join("examples"));
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

#[test]
fn the_examples_run_and_print_what_is_quoted() {
    let folder = Folder::new();
    let blocks = blocks();
    let mut ran = 0;
    for (i, (kind, body)) in blocks.iter().enumerate() {
        if kind != "sh" {
            continue;
        }
        for line in body.lines() {
            let line = line
                .strip_prefix("cargo run --release -- ")
                .or(line.strip_prefix("grouser "));
            let Some(arguments) = line else { continue };
            let output = Command::new(env!("CARGO_BIN_EXE_grouser"))
                .current_dir(&folder.0)
                .args(arguments.split_whitespace())
                .output()
                .unwrap();
            let printed = String::from_utf8(output.stdout).unwrap();
            let complaint = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{arguments}\n{complaint}");
            ran += 1;
            // what the block after it quotes stands in the output, line by line
            if let Some((next, quoted)) = blocks.get(i + 1) {
                let said = format!("{printed}{complaint}");
                for quote in quoted.lines().filter(|_| next == "text") {
                    assert!(
                        said.contains(quote.trim()),
                        "{arguments}\nlacks: {quote}\nprints:\n{said}"
                    );
                }
            }
        }
    }
    assert!(ran >= 7, "one example a verb: {ran}");
}
