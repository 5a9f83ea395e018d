//! The lock file by the rules of `deny.toml`: licences, sources, banned crates, duplicates. The rules are cargo-deny's; this
//! needs no network and no other program.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use serde_json::Value;

use crate::repository::root;

/// Every package of the graph for all targets.
fn packages(features: &[&str]) -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .current_dir(root())
        .args(["metadata", "--locked", "--format-version", "1"])
        .args(features)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let graph: Value = serde_json::from_slice(&output.stdout).unwrap();
    graph["packages"].as_array().unwrap().clone()
}

/// The words of the list `name` of `deny.toml`.
fn rules(name: &str) -> BTreeSet<String> {
    let text = std::fs::read_to_string(root().join("deny.toml")).unwrap();
    let (_, list) = text.split_once(&format!("\n{name} = [")).unwrap();
    let list = list.split_once("\n]").unwrap().0;
    let lines = list.lines().filter(|line| !line.trim().starts_with('#'));
    lines
        .filter_map(|line| line.split('"').nth(1))
        .map(str::to_owned)
        .collect()
}

/// May a crate under this licence be used? One side of an `OR`, both of an `AND`.
fn is_allowed(licence: &str, allowed: &BTreeSet<String>) -> bool {
    let one = |licence: &str| allowed.contains(licence.trim().trim_matches(['(', ')']));
    if let Some((left, right)) = licence.split_once(" AND ") {
        return is_allowed(left, allowed) && is_allowed(right, allowed);
    }
    licence.split(" OR ").flat_map(|l| l.split('/')).any(one)
}

#[test]
fn licences_sources_and_names_are_those_that_the_rules_allow() {
    let (allowed, banned) = (rules("allow"), rules("deny"));
    assert!(allowed.contains("MIT") && banned.contains("cmake"));
    let registry = "registry+https://github.com/rust-lang/crates.io-index";
    for package in packages(&["--all-features"]) {
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().unwrap_or("none");
        assert!(is_allowed(licence, &allowed), "{name}: {licence}");
        assert!(!banned.contains(name), "{name} is banned");
        let source = package["source"].as_str();
        assert!(
            source.is_none_or(|source| source == registry),
            "{name}: {source:?}"
        );
    }
}

#[test]
fn no_crate_is_there_twice_but_those_that_the_rules_name() {
    let skipped = rules("skip");
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    // those of Parquet are its own
    for package in packages(&[]) {
        let text = |key: &str| package[key].as_str().unwrap().to_owned();
        versions
            .entry(text("name"))
            .or_default()
            .insert(text("version"));
    }
    let twice: BTreeSet<String> = versions
        .into_iter()
        .filter(|(_, versions)| versions.len() > 1)
        .map(|(name, _)| name)
        .collect();
    // a name that is no longer needed goes from the rules
    assert_eq!(twice, skipped);
}

#[test]
fn licences_are_read_as_written() {
    let allowed = BTreeSet::from(["MIT".to_owned(), "Zlib".to_owned()]);
    assert!(is_allowed("MIT OR GPL-3.0", &allowed));
    assert!(is_allowed("MIT/Apache-2.0", &allowed));
    assert!(is_allowed("(MIT OR GPL-3.0) AND Zlib", &allowed));
    assert!(!is_allowed("MIT AND GPL-3.0", &allowed));
    assert!(!is_allowed("none", &allowed));
}
