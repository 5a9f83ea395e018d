//! Where `CI` is set, every folder of measured data that CONTRIBUTING.md names is there: the tests that use one skip what they do
//! not find, each by itself.

use std::path::{Path, PathBuf};

/// The folders of the page's table of data.
fn folders(page: &str) -> Vec<String> {
    let (_, section) = page.split_once("\n## Data\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    section
        .lines()
        .filter(|line| line.starts_with("| `"))
        .filter_map(|line| line.split('|').nth(1))
        .flat_map(|cell| cell.split('`').skip(1).step_by(2))
        .map(|name| name.trim_end_matches('/').to_owned())
        .collect()
}

#[test]
fn every_folder_that_the_page_names_is_there_in_ci() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let named = folders(&std::fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap());
    assert!(named.len() >= 9, "{named:?}");
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root.join("data"), PathBuf::from);
    let base = root.join(base);
    let is_missing = |name: &&String| {
        let mut files = std::fs::read_dir(base.join(name)).into_iter().flatten();
        !files.any(|file| file.is_ok_and(|file| file.path().is_file()))
    };
    let missing: Vec<&String> = named.iter().filter(is_missing).collect();
    if missing.is_empty() {
        return;
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "CI is set, and {} lacks {missing:?}",
        base.display()
    );
    eprintln!("without {missing:?} the tests on them are skipped (GROUSER_DATA)");
}
