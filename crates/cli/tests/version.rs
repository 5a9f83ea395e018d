//! Files that state the version in addition to the workspace's manifest.

use std::fs;

use crate::repository::root;

#[test]
fn every_file_states_the_version() {
    let version = env!("CARGO_PKG_VERSION");
    let manifest = format!("version = \"{version}\"");
    let changes = format!("## {version}");
    let citation = format!("version: {version}");
    let cmake = format!("set(PACKAGE_VERSION \"{version}\")");
    for (file, line) in [
        ("CHANGELOG.md", &changes),
        ("CITATION.cff", &citation),
        ("crates/c/cmake/grouser-config-version.cmake", &cmake),
        ("live/Cargo.toml", &manifest),
        ("page/view/Cargo.toml", &manifest),
        ("page/wasm/Cargo.toml", &manifest),
        ("python/Cargo.toml", &manifest),
        ("bench/slip/pyproject.toml", &manifest),
    ] {
        let text = fs::read_to_string(root().join(file)).unwrap();
        assert!(text.lines().any(|own| own == line), "{file} lacks {line}");
    }
}
