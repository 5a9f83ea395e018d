//! The floors of the workspace, held against `cargo metadata`: what a crate may import, where threads may
//! live, which crates stay without the standard library, and who may write `unsafe`.

use std::collections::{BTreeMap, BTreeSet};

use crate::repository::{cargo, files, root};

/// Each crate and the ones of ours that it may use (dev-dependencies aside). A new crate needs a line here
/// and one in DESIGN.md.
const FLOORS: &[(&str, &[&str])] = &[
    ("grouser-real", &[]),
    ("grouser-terra", &["grouser-real"]),
    ("grouser-opt", &["grouser-real"]),
    ("grouser-slip", &["grouser-real", "grouser-terra"]),
    (
        "grouser-files",
        &["grouser-real", "grouser-terra", "grouser-slip"],
    ),
    (
        "grouser-log",
        &["grouser-real", "grouser-slip", "grouser-files"],
    ),
    (
        "grouser-doctor",
        &["grouser-real", "grouser-slip", "grouser-files"],
    ),
    (
        "grouser-replay",
        &[
            "grouser-real",
            "grouser-terra",
            "grouser-slip",
            "grouser-files",
            "grouser-log",
            "grouser-doctor",
        ],
    ),
    (
        "grouser-design",
        &[
            "grouser-real",
            "grouser-terra",
            "grouser-opt",
            "grouser-files",
        ],
    ),
    (
        "grouser-rover",
        &[
            "grouser-real",
            "grouser-terra",
            "grouser-slip",
            "grouser-files",
        ],
    ),
    (
        "grouser-terrain",
        &[
            "grouser-terra",
            "grouser-slip",
            "grouser-files",
            "grouser-rover",
        ],
    ),
    (
        "grouser-identify",
        &[
            "grouser-real",
            "grouser-terra",
            "grouser-opt",
            "grouser-files",
            "grouser-log",
        ],
    ),
    (
        "grouser-campaign",
        &[
            "grouser-figure",
            "grouser-report",
            "grouser-rover",
            "grouser-slip",
            "grouser-terra",
            "grouser-design",
            "grouser-identify",
            "grouser-files",
        ],
    ),
    (
        "grouser-synthetic",
        &["grouser-terra", "grouser-slip", "grouser-log"],
    ),
    (
        "grouser-fmu",
        &["grouser-real", "grouser-terra", "grouser-files"],
    ),
    (
        "grouser-c",
        &["grouser-terra", "grouser-slip", "grouser-files"],
    ),
    ("grouser-figure", &[]),
    ("grouser-report", &["grouser-real"]),
    (
        "grouser-page",
        &[
            "grouser-terra",
            "grouser-opt",
            "grouser-slip",
            "grouser-files",
            "grouser-log",
            "grouser-replay",
            "grouser-design",
            "grouser-rover",
        ],
    ),
    (
        "grouser",
        &[
            "grouser-figure",
            "grouser-report",
            "grouser-real",
            "grouser-terra",
            "grouser-opt",
            "grouser-slip",
            "grouser-files",
            "grouser-fmu",
            "grouser-log",
            "grouser-doctor",
            "grouser-replay",
            "grouser-design",
            "grouser-identify",
            "grouser-campaign",
            "grouser-page",
            "grouser-rover",
            "grouser-terrain",
        ],
    ),
];

/// Where threads may live.
const THREADED: &[&str] = &[
    "grouser-opt",
    "grouser-identify",
    "grouser-campaign",
    "grouser",
];

/// Crates that build without the standard library, on bare metal.
const BARE: &[&str] = &["grouser-real", "grouser-terra", "grouser-slip", "grouser-c"];

/// The only files that may allow `unsafe`: the lanes of the machine, and the C interfaces, which follow the caller's
/// pointers.
const UNSAFE_FILES: &[&str] = &[
    "crates/terra/src/lanes/machine/mod.rs",
    "crates/c/src/lib.rs",
    "crates/fmu/src/interface.rs",
];

/// Each crate of ours with the names of all its dependencies but dev-dependencies.
fn dependencies() -> BTreeMap<String, BTreeSet<String>> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: serde_json::Value = serde_json::from_str(&text).unwrap();
    let name = |value: &serde_json::Value| value["name"].as_str().unwrap().to_owned();
    let list = metadata["packages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|package| {
            let all = package["dependencies"].as_array().unwrap();
            let used = all
                .iter()
                .filter(|dependency| dependency["kind"].as_str() != Some("dev"));
            (name(package), used.map(name).collect())
        });
    list.collect()
}

#[test]
fn each_crate_imports_only_what_stands_below_it() {
    let floors: BTreeMap<&str, &[&str]> = FLOORS.iter().copied().collect();
    for (package, used) in dependencies() {
        let allowed = floors
            .get(package.as_str())
            .unwrap_or_else(|| panic!("{package} has no floor"));
        for ours in used.iter().filter(|name| name.starts_with("grouser")) {
            assert!(
                allowed.contains(&ours.as_str()),
                "{package} may not use {ours}"
            );
        }
    }
}

/// What a stranger finds in a published crate: a front page, the licences, a program to run, and its description.
#[test]
fn each_published_crate_has_a_front_page_licences_and_an_example() {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: serde_json::Value = serde_json::from_str(&text).unwrap();
    let published = metadata["packages"].as_array().unwrap().iter();
    let published = published.filter(|package| package["publish"].is_null());
    let mut count = 0;
    for package in published {
        count += 1;
        let name = package["name"].as_str().unwrap();
        let folder = std::path::Path::new(package["manifest_path"].as_str().unwrap());
        let folder = folder.parent().unwrap();
        let front = std::fs::read_to_string(folder.join("src/lib.rs")).unwrap();
        assert!(
            front.starts_with("#![doc = include_str!(\"../README.md\")]"),
            "the front page of {name} is not its README"
        );
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let own = std::fs::read_to_string(folder.join(licence));
            let whole = std::fs::read_to_string(root().join(licence)).unwrap();
            assert_eq!(own.ok(), Some(whole), "{name} has no {licence}");
        }
        let examples = folder.join("examples");
        let endings = ["rs", "c"].into_iter();
        let found = endings
            .map(|ending| files(&examples, ending).len())
            .sum::<usize>();
        assert!(found > 0, "{name} has no example");
        for key in ["description", "license", "repository", "rust_version"] {
            assert!(package[key].is_string(), "{name} has no {key}");
        }
        assert!(
            package["metadata"]["docs"]["rs"].is_object(),
            "{name} has no settings for docs.rs"
        );
    }
    assert!(count > 15, "only {count} published crates are found");
}

#[test]
fn threads_live_only_where_they_may() {
    for (package, used) in dependencies() {
        let threaded = used.contains("rayon") || used.contains("tokio");
        assert!(
            !threaded || THREADED.contains(&package.as_str()),
            "{package} has threads"
        );
    }
}

#[test]
fn bare_crates_pull_in_no_standard_library() {
    for package in BARE {
        let tree = cargo(&[
            "tree",
            "--package",
            package,
            "--no-default-features",
            "--edges",
            "normal,features",
            "--prefix",
            "none",
        ]);
        for line in tree.lines() {
            assert!(
                !line.contains("feature \"std\""),
                "{package} enables {line}"
            );
        }
    }
}

#[test]
fn no_file_but_the_machines_lanes_and_the_c_interfaces_may_be_unsafe() {
    for (package, _) in dependencies() {
        let folder = if package == "grouser" {
            "cli"
        } else {
            &package["grouser-".len()..]
        };
        let source = root().join("crates").join(folder).join("src");
        let text = std::fs::read_to_string(source.join("lib.rs")).unwrap();
        if !["terra", "c", "fmu"].contains(&folder) {
            assert!(
                text.contains("#![forbid(unsafe_code)]"),
                "{package} does not forbid unsafe code"
            );
        }
        for path in files(&source, "rs") {
            let allowed = UNSAFE_FILES.iter().any(|file| path.ends_with(file));
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(
                allowed || !text.contains("allow(unsafe_code"),
                "{} allows unsafe",
                path.display()
            );
        }
    }
}
