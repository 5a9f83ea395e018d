//! Each test belongs to a program, and each command that a page, a recipe or a comment names runs a test: `cargo test` passes
//! where no name matches.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use proptest::test_runner::{Config, RngSeed};

use crate::repository::{cargo, files, root};

/// The tests of a program by their full names, and the files that it is made of.
#[derive(Default)]
struct Program {
    tests: Vec<String>,
    files: BTreeSet<PathBuf>,
}

impl Program {
    /// Adds a file, the modules that it declares in `folder`, and so on.
    fn add(&mut self, file: &Path, folder: &Path, module: &str) {
        let text = fs::read_to_string(file).unwrap();
        self.files.insert(file.canonicalize().unwrap());
        let (mut path, mut is_test) = (None, false);
        for line in text.lines().map(str::trim) {
            if let Some(rest) = line.strip_prefix("#[path = \"") {
                path = rest.strip_suffix("\"]").map(|p| file.with_file_name(p));
            } else if line == "#[test]" {
                is_test = true;
            } else if let (true, Some(rest)) = (is_test, line.strip_prefix("fn ")) {
                let name = rest.split(['(', '<']).next().unwrap();
                self.tests.push(format!("{module}{name}"));
                is_test = false;
            } else if let Some(name) = line
                .trim_start_matches("pub(crate) ")
                .trim_start_matches("pub ")
                .strip_prefix("mod ")
                .and_then(|rest| rest.strip_suffix(';'))
            {
                let (plain, inner) = (folder.join(format!("{name}.rs")), folder.join(name));
                let (file, folder) = match path.take() {
                    Some(path) => (path.clone(), path.parent().unwrap().to_owned()),
                    None if plain.is_file() => (plain, inner),
                    None => (inner.join("mod.rs"), inner),
                };
                self.add(&file, &folder, &format!("{module}{name}::"));
            }
        }
    }
}

/// The programs of tests by package and name; a library's own tests have the name `--lib`.
fn programs() -> BTreeMap<(String, String), Program> {
    let text = cargo(&["metadata", "--no-deps", "--format-version", "1"]);
    let metadata: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut programs = BTreeMap::new();
    for package in metadata["packages"].as_array().unwrap() {
        for target in package["targets"].as_array().unwrap() {
            let name = match target["kind"][0].as_str().unwrap() {
                "test" => target["name"].as_str().unwrap(),
                "lib" | "staticlib" => "--lib",
                _ => continue,
            };
            let file = Path::new(target["src_path"].as_str().unwrap());
            let mut program = Program::default();
            program.add(file, file.parent().unwrap(), "");
            let package = package["name"].as_str().unwrap().to_owned();
            programs.insert((package, name.to_owned()), program);
        }
    }
    programs
}

/// The commands in a file: in Markdown and comments up to the next backtick, in other files up to the end of the line.
fn commands(file: &Path) -> Vec<String> {
    let text = fs::read_to_string(file).unwrap();
    let is_quoted = file.extension().is_some_and(|e| e == "rs" || e == "md");
    let text = if is_quoted {
        let plain = |line: &'_ str| line.trim_start_matches([' ', '/', '!']).to_owned();
        text.lines().map(plain).collect::<Vec<_>>().join(" ")
    } else {
        text
    };
    let starts = ["cargo test ", "cargo +nightly test "];
    let found = starts.iter().flat_map(|start| text.match_indices(start));
    let command = |(at, start): (usize, &str)| text[at + start.len()..].split(['`', '\n']).next();
    found.filter_map(command).map(str::to_owned).collect()
}

/// What of a command matches no test.
fn mismatches(command: &str, programs: &BTreeMap<(String, String), Program>) -> Vec<String> {
    let (mut packages, mut names, mut filters) = (Vec::new(), Vec::new(), Vec::new());
    let mut words = command.split_whitespace();
    let mut is_program = false;
    let mut missing = Vec::new();
    while let Some(word) = words.next() {
        is_program |= word == "--";
        match word {
            "-p" | "--package" => packages.extend(words.next()),
            "--test" => names.extend(words.next()),
            "--lib" => names.push(word),
            "--features" | "--target" => _ = words.next(),
            _ if word.starts_with('-') => {}
            // cargo itself takes one
            _ if !is_program && !filters.is_empty() => missing.push(format!("`{word}` before --")),
            _ => filters.push(word),
        }
    }
    let mut tests = Vec::new();
    for package in packages {
        let of_package = programs.iter().filter(|((p, _), _)| p == package);
        let chosen: Vec<_> = of_package
            .filter(|((_, name), _)| names.is_empty() || names.contains(&name.as_str()))
            .collect();
        if chosen.len() < names.len().max(1) {
            missing.push(format!("not all of {names:?} in {package}"));
        }
        tests.extend(chosen.into_iter().flat_map(|(_, program)| &program.tests));
    }
    let is_missing = |filter: &&str| !tests.iter().any(|test| test.contains(*filter));
    missing.extend(filters.into_iter().filter(is_missing).map(str::to_owned));
    missing
}

#[test]
fn every_command_that_is_written_down_runs_a_test() {
    let programs = programs();
    let mut written = files(&root().join("docs"), "md");
    written.extend(files(&root().join("crates"), "rs"));
    written.retain(|file| !file.ends_with("test_commands.rs"));
    for name in ["README", "RESULTS", "CONTRIBUTING", "DESIGN"] {
        written.push(root().join(name).with_extension("md"));
    }
    written.extend(["justfile", "deny.toml"].map(|name| root().join(name)));
    let (mut count, mut failures) = (0, Vec::new());
    for file in written {
        for command in commands(&file) {
            // a workspace of another folder, or all packages
            if !command.contains("-p ") && !command.contains("--package ") {
                continue;
            }
            count += 1;
            let missing = mismatches(&command, &programs);
            if !missing.is_empty() {
                failures.push(format!("{}: {command}: {missing:?}", file.display()));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(count >= 80, "only {count} commands");
}

#[test]
fn a_command_without_a_test_is_found() {
    let programs = programs();
    let found = |command: &str| !mismatches(command, &programs).is_empty();
    assert!(!found(
        "-p grouser --test all test_commands:: -- --nocapture"
    ));
    assert!(found("-p grouser --test test_commands"));
    assert!(found("-p grouser --test all test_comands::"));
    assert!(found(
        "-p grouser --test all -- --nocapture docs:: nothing_of_this_name"
    ));
    assert!(found("-p grouser-none --test all"));
    assert!(found("-p grouser --test all docs:: layering::"));
}

#[test]
fn every_file_of_tests_belongs_to_a_program() {
    let programs = programs();
    let used: BTreeSet<&PathBuf> = programs.values().flat_map(|p| &p.files).collect();
    let crates = root().join("crates");
    let all = files(&crates, "rs");
    // beside private code a folder of tests is a module
    let is_of_program = |file: &PathBuf| {
        let mut parts = file.strip_prefix(&crates).unwrap().iter().skip(1);
        parts.next().is_some_and(|part| part == "tests")
    };
    let tests = all
        .iter()
        .filter(|file| is_of_program(file))
        .map(|file| file.canonicalize().unwrap());
    let (mut count, mut unused) = (0, Vec::new());
    for file in tests {
        count += 1;
        if !used.contains(&file) {
            unused.push(file);
        }
    }
    assert!(unused.is_empty(), "in no program: {unused:#?}");
    assert!(count >= 150, "only {count} files");
}

/// A user's tree stays as it is, and a user's cases are those of everybody: `.cargo/config.toml`.
#[test]
fn property_tests_have_one_seed_and_leave_no_file() {
    let usual = Config::default();
    assert!(usual.failure_persistence.is_none());
    assert!(matches!(usual.rng_seed, RngSeed::Fixed(_)));
}
