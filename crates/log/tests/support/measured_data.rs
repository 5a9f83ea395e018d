//! Where the measured data are.

use std::path::{Path, PathBuf};

/// A file or folder of the measured data (`GROUSER_DATA`, else `data` in the project); `None` (printed on stderr)
/// where it is absent, which in CI is a failure.
pub(crate) fn measured_data(name: &str) -> Option<PathBuf> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = (package
        .ancestors()
        .find(|folder| folder.join("crates").is_dir()))
    .unwrap();
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root.join("data"), PathBuf::from);
    // A relative path counts from the project's root, wherever the test runs.
    let path = root.join(base).join(name);
    if path.exists() {
        return Some(path);
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "no measured data at {}, and CI is set",
        path.display()
    );
    eprintln!("skipped: no {} (GROUSER_DATA)", path.display());
    None
}
