//! The C compiler of the machine.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A compiler that is installed.
pub(crate) struct Compiler(&'static str);

/// The compiler of that name. Without one the test is skipped with a line; where `CI` is set it fails.
pub(crate) fn needs_compiler(name: &'static str) -> Option<Compiler> {
    if Command::new(name).arg("--version").output().is_ok() {
        return Some(Compiler(name));
    }
    assert!(std::env::var_os("CI").is_none(), "missing: {name}");
    eprintln!("skipped: there is no `{name}`");
    None
}

impl Compiler {
    /// Compiles with the header's folder; what the compiler reports fails the test.
    pub(crate) fn run(&self, flags: &[&str], files: &[&Path]) {
        let mut command = Command::new(self.0);
        command
            .args(flags)
            .arg("-I")
            .arg(header().parent().unwrap());
        // libraries come after what uses them
        let output = command
            .args(files)
            .args(["-lm", "-lpthread", "-ldl"])
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{errors}");
    }
}

pub(crate) fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub(crate) fn header() -> PathBuf {
    folder().join("include/grouser.h")
}

/// A folder for a test's files.
pub(crate) fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The static library that was built together with the test: the newest one beside it.
pub(crate) fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let files = std::fs::read_dir(test.parent().unwrap()).unwrap();
    let built = files.filter_map(|file| {
        let path = file.unwrap().path();
        let name = path.file_name()?.to_str()?;
        let is_library = name.starts_with("libgrouser_c-")
            && path.extension().is_some_and(|ending| ending == "a");
        let modified = path.metadata().unwrap().modified().unwrap();
        is_library.then_some((modified, path))
    });
    built.max().expect("a static library").1
}
