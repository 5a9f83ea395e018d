//! The repository's files, and the program run in its folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

use serde_json::Value;

pub(crate) fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap().to_owned()
}

/// All files below a folder whose names end like this, in order.
pub(crate) fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// What cargo prints.
pub(crate) fn cargo(arguments: &[&str]) -> String {
    let mut cargo = Command::new(env!("CARGO"));
    let output = cargo.current_dir(root()).args(arguments).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// The program, with lines of any length, so that sentences are found whole.
pub(crate) fn program() -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_grouser"));
    program.env("COLUMNS", "10000");
    program
}

/// Runs the program.
pub(crate) fn grouser(arguments: &[&str]) -> Output {
    program()
        .current_dir(root())
        .args(arguments)
        .output()
        .unwrap()
}

/// Runs the program in a folder of its own, with the examples at hand.
pub(crate) fn grouser_in(folder: &Folder, arguments: &[&str]) -> Output {
    let link = folder.0.join("examples");
    if !link.exists() {
        std::os::unix::fs::symlink(root().join("examples"), link).unwrap();
    }
    program()
        .current_dir(&folder.0)
        .args(arguments)
        .output()
        .unwrap()
}

/// Under `--json` standard output has the error, and no result.
pub(crate) fn is_error_alone(output: &Output) -> bool {
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    object.as_object().unwrap().keys().eq(["error"]) && object["error"]["message"].is_string()
}

/// A folder for a test, removed at its end.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(name: &str) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("grouser-{name}-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::write(self.0.join(name), content).unwrap();
        self.path(name)
    }

    /// The names in the folder.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
