//! Modules import only downwards: the imports between the modules of a crate form no cycle. A folder is one module, and in
//! the command each verb is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::repository::{files, root};

/// Folders whose members are modules of their own.
const OPEN_FOLDERS: &[&str] = &["verbs"];

/// The laws of a wheel in the soil name each other: soil, contact and lanes hold one set of equations.
const LAWS_OF_ONE_CONTACT: &[&str] = &["terra"];

/// The maximum number of layers of a crate's modules: a module lies one layer above the highest that it imports.
const MAX_LAYERS: &[(&str, usize)] = &[("doctor", 6), ("replay", 9)];

type Graph = BTreeMap<String, BTreeSet<String>>;

/// The module of a path of segments; what an open folder's own file holds belongs to the folder.
fn module(segments: &[String], known: &BTreeSet<Vec<String>>) -> Option<String> {
    let first = segments.first()?;
    let is_member = OPEN_FOLDERS.contains(&first.as_str())
        && known
            .iter()
            .any(|file| file.starts_with(&segments[..2.min(segments.len())]));
    let second = segments.get(1).filter(|_| is_member);
    Some(second.map_or_else(|| first.clone(), |second| format!("{first}::{second}")))
}

/// The segments of the module that a file holds.
fn segments(source: &Path, file: &Path) -> Vec<String> {
    let relative = file.strip_prefix(source).unwrap().with_extension("");
    let mut all: Vec<String> = relative
        .iter()
        .map(|part| part.to_str().unwrap().to_owned())
        .collect();
    if all.last().is_some_and(|last| last == "mod") {
        all.pop();
    }
    all
}

/// Every path that follows `prefix` in a text, with the members of its braces one by one.
fn paths_after(text: &str, prefix: &str) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(prefix) {
        let before = rest[..start].chars().next_back();
        rest = &rest[start + prefix.len()..];
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            continue;
        }
        let plain: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || matches!(c, '_' | ':'))
            .collect();
        let base: Vec<String> = plain
            .split("::")
            .filter(|part| !part.is_empty())
            .map(str::to_owned)
            .collect();
        let tail = &rest[plain.len()..];
        match tail.strip_prefix('{').and_then(|tail| tail.split_once('}')) {
            Some((members, _)) => found.extend(members.split(',').map(|member| {
                let member = member.split_whitespace().next().unwrap_or_default();
                let own = member.split("::").filter(|part| !part.is_empty());
                base.iter().cloned().chain(own.map(str::to_owned)).collect()
            })),
            // a list over several lines has spaces before no name
            None if base.is_empty() => {}
            None => found.push(base),
        }
    }
    found
}

/// A file's code: comments and its tests left out.
fn code(file: &Path) -> String {
    let text = std::fs::read_to_string(file).unwrap();
    let is_test = ["#[cfg(test)]", "#[cfg(all(test"].map(|mark| text.find(mark));
    let end = is_test.into_iter().flatten().min().unwrap_or(text.len());
    let text = &text[..end];
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// The imports between the modules of a crate.
fn imports(folder: &str) -> Graph {
    let source = root().join("crates").join(folder).join("src");
    let files = files(&source, "rs");
    let known: BTreeSet<Vec<String>> = files.iter().map(|file| segments(&source, file)).collect();
    // Names that the crate's root takes from its modules.
    let mut roots = BTreeMap::new();
    for line in code(&source.join("lib.rs")).split(';') {
        if let Some(path) = line.trim().strip_prefix("pub use ") {
            for path in paths_after(&format!(" {path}"), " ") {
                roots.insert(path.last().unwrap().clone(), path[0].clone());
            }
        }
    }
    let mut graph = Graph::new();
    for file in &files {
        let own = segments(&source, file);
        let Some(from) = module(&own, &known).filter(|name| name != "lib" && name != "main") else {
            continue;
        };
        let text = code(file);
        let mut targets = paths_after(&text, "crate::");
        let parent = own[..own.len() - 1].to_vec();
        for (prefix, base) in [
            (
                "super::super::",
                parent[..parent.len().saturating_sub(1)].to_vec(),
            ),
            ("super::", parent.clone()),
        ] {
            for path in paths_after(&text, prefix) {
                targets.push(base.iter().cloned().chain(path).collect());
            }
        }
        for mut target in targets {
            if let Some(home) = target.first().and_then(|first| roots.get(first)) {
                target.insert(0, home.clone());
            }
            let is_module = (1..=target.len()).any(|n| known.contains(&target[..n]));
            if let Some(to) = module(&target, &known).filter(|to| is_module && *to != from) {
                graph.entry(from.clone()).or_default().insert(to);
            }
        }
    }
    graph
}

/// A cycle of imports, if there is one.
fn cycle(graph: &Graph) -> Option<Vec<String>> {
    fn visit(
        graph: &Graph,
        name: &String,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|seen| seen == name) {
            return Some(path[start..].to_vec());
        }
        if !done.insert(name.clone()) {
            return None;
        }
        path.push(name.clone());
        let found = graph
            .get(name)
            .into_iter()
            .flatten()
            .find_map(|next| visit(graph, next, path, done));
        path.pop();
        found
    }
    let mut done = BTreeSet::new();
    graph
        .keys()
        .find_map(|name| visit(graph, name, &mut Vec::new(), &mut done))
}

#[test]
fn imports_between_modules_form_no_cycle() {
    let mut arrows = 0;
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let folder = entry.unwrap().file_name().into_string().unwrap();
        let graph = imports(&folder);
        arrows += graph.values().map(BTreeSet::len).sum::<usize>();
        if !LAWS_OF_ONE_CONTACT.contains(&folder.as_str()) {
            assert_eq!(cycle(&graph), None, "{folder}");
        }
    }
    assert!(arrows > 600, "only {arrows} imports are found");
}

/// The modules of the longest chain of imports, the highest first.
fn longest_chain(graph: &Graph) -> Vec<String> {
    fn from(
        graph: &Graph,
        name: &String,
        known: &mut BTreeMap<String, Vec<String>>,
    ) -> Vec<String> {
        if let Some(chain) = known.get(name) {
            return chain.clone();
        }
        let below = graph.get(name).into_iter().flatten();
        let chains = below.map(|next| from(graph, next, known));
        let longest = chains.max_by_key(Vec::len).unwrap_or_default();
        let chain: Vec<String> = std::iter::once(name.clone()).chain(longest).collect();
        known.insert(name.clone(), chain.clone());
        chain
    }
    let mut known = BTreeMap::new();
    let chains = graph.keys().map(|name| from(graph, name, &mut known));
    chains.max_by_key(Vec::len).unwrap_or_default()
}

#[test]
fn modules_lie_on_few_layers() {
    for (folder, max) in MAX_LAYERS {
        let chain = longest_chain(&imports(folder));
        assert!(
            chain.len() <= *max,
            "{folder} has {} layers: {}",
            chain.len(),
            chain.join(" imports ")
        );
    }
}

#[test]
fn a_cycle_is_found() {
    let arrows = [("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")];
    let mut graph = Graph::new();
    for (from, to) in arrows {
        graph.entry(from.into()).or_default().insert(to.into());
    }
    assert_eq!(
        cycle(&graph),
        Some(vec!["a".into(), "b".into(), "c".into()])
    );
    graph.remove("c");
    assert_eq!(cycle(&graph), None);
    assert_eq!(longest_chain(&graph), ["d", "a", "b", "c"]);
    let paths = paths_after("use crate::b::{C, d::E}; crate::f::g()", "crate::");
    assert_eq!(paths, [vec!["b", "C"], vec!["b", "d", "E"], vec!["f", "g"]]);
}
