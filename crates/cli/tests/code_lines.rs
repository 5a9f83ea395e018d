//! No crate grows: its lines of code against the limits of `code_lines.tsv`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::repository::{files, root};

/// A crate that is above its goal has its limit within this many lines of what it has, so that what left stays away.
const SLACK: usize = 150;

/// Lines that are neither blank nor comments nor tests. `name` is the file's path in the repository.
fn code_lines(name: &str, text: &str) -> usize {
    if name.contains("/tests/") || name.ends_with("tests.rs") || name.ends_with("test.rs") {
        return 0;
    }
    let (mut count, mut is_test, mut follows_cfg) = (0, false, false);
    for line in text.lines().map(str::trim) {
        if line.contains("#[cfg(test)]") {
            follows_cfg = true;
            continue;
        }
        if follows_cfg && !line.starts_with("#[") {
            let item = line.split_once("mod ").filter(|(before, _)| {
                before.is_empty() || before.starts_with("pub") && before.ends_with(' ')
            });
            // a module of tests is the last item of its file
            is_test = item.is_some() && line.ends_with('{');
            follows_cfg = false;
        }
        let is_code = !line.is_empty() && !line.starts_with("//");
        count += usize::from(is_code && !is_test);
    }
    count
}

/// The folders of sources, by the names of the parts: a crate is a part, and so is each program beside the crates.
fn sources() -> BTreeMap<String, PathBuf> {
    let root = root();
    let members = |folder: &str| {
        let entries = fs::read_dir(root.join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.map(|name| format!("{folder}/{name}")).collect()
    };
    let mut parts: Vec<String> = members("crates");
    let pages: Vec<String> = members("page");
    parts.extend(pages);
    let alone = ["live/src", "python/src"].map(|name| (name.to_owned(), root.join(name)));
    let crates = parts.into_iter().map(|part| {
        let folder = root.join(&part);
        (part, folder)
    });
    crates
        .filter(|(_, folder)| folder.join("src").is_dir())
        .chain(alone)
        .collect()
}

fn lines_of(folder: &Path) -> usize {
    let root = root();
    let count = |path: &PathBuf| {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        // a program of its own within a crate, such as that for firmware, counts too
        if !name.contains("/src/") || name.contains("/target/") {
            return 0;
        }
        code_lines(name, &fs::read_to_string(path).unwrap())
    };
    files(folder, "rs").iter().map(count).sum()
}

#[test]
fn no_crate_grows() {
    let table = fs::read_to_string(root().join("crates/cli/tests/code_lines.tsv")).unwrap();
    let mut limits = BTreeMap::new();
    for row in table.lines().skip(1) {
        let [part, limit, goal] = row.split('\t').collect::<Vec<_>>().try_into().unwrap();
        let number = |text: &str| text.parse::<usize>().unwrap();
        limits.insert(part.to_owned(), (number(limit), number(goal)));
    }
    let sources = sources();
    assert!(
        sources.keys().eq(limits.keys()),
        "code_lines.tsv lists the parts {:?}",
        sources.keys()
    );
    let mut faults = Vec::new();
    for (part, folder) in &sources {
        let (count, (limit, goal)) = (lines_of(folder), limits[part]);
        println!("{part}\t{count}\t{limit}\t{goal}");
        if count > limit {
            faults.push(format!(
                "{part} has {count} lines of code, more than its limit of {limit}: something must leave, which \
                 DESIGN.md (Size) then names, or a feature is named there with the new limit"
            ));
        }
        if limit > goal && count + SLACK < limit {
            faults.push(format!(
                "{part} has {count} lines of code: lower its limit of {limit} (goal {goal})"
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn blanks_comments_and_tests_are_no_code() {
    let text = "//! Words.\n\nuse std::fs;\n#[cfg(test)]\nuse other;\nfn a() {\n    // why\n    b();\n}\n\
                #[cfg(test)]\n#[allow(reason)]\nmod tests {\n    fn c() {}\n}\n";
    // `use`, the import for tests, `fn`, the call, the brace, the attribute before the module
    assert_eq!(code_lines("crates/a/src/lib.rs", text), 6);
    assert_eq!(code_lines("crates/a/src/tests/b.rs", text), 0);
}
