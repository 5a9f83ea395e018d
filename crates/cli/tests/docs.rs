//! Every shell block of README.md and docs/, pasted as it stands.
//!
//! A block ```` ```sh ```` runs line by line; the block ```` ```text ```` after it quotes lines of its output. In ```` ```console ````
//! a line after `$ ` runs and the others are quoted. ```` ```toml title="F" ```` writes the file F. `sh data` and `console data` need
//! the measured data (`GROUSER_DATA`); `exit=N` is the exit code if it is not 0.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_campaign::paper::STATEMENTS;

use crate::repository::root;

/// A fenced block: its language, the words behind it, and its lines.
struct Block {
    language: String,
    options: Vec<String>,
    body: String,
}

impl Block {
    fn option(&self, name: &str) -> Option<&str> {
        let mut values = self.options.iter();
        values.find_map(|option| {
            Some(
                option
                    .strip_prefix(name)?
                    .strip_prefix('=')?
                    .trim_matches('"'),
            )
        })
    }

    fn needs_data(&self) -> bool {
        self.options.iter().any(|option| option == "data")
    }
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in text.lines() {
        match (line.trim_start().strip_prefix("```"), open.as_mut()) {
            (Some(info), None) => {
                let mut words = info.split_whitespace().map(str::to_owned);
                open = Some(Block {
                    language: words.next().unwrap_or_default(),
                    options: words.collect(),
                    body: String::new(),
                });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => {
                block.body.push_str(line);
                block.body.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

/// A temporary folder with what the examples read.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let name = format!("grouser-docs-{}-{name}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        copy(&root().join("examples"), &folder.join("examples"));
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs a line; `None` if it is not of this command, `Err` if its exit code is another one.
fn run(
    line: &str,
    folder: &Path,
    data: Option<&Path>,
    exit: i32,
) -> Option<Result<String, String>> {
    let line = line.split(" #").next().unwrap_or(line);
    let arguments = line
        .strip_prefix("cargo run --release -- ")
        .or(line.strip_prefix("grouser "))?;
    let (arguments, target) = match arguments.split_once(" > ") {
        Some((arguments, target)) => (arguments, Some(target.trim())),
        None => (arguments, None),
    };
    let data = data
        .map(|data| data.display().to_string())
        .unwrap_or_default();
    let arguments = arguments.replace("$GROUSER_DATA", &data);
    let output = Command::new(env!("CARGO_BIN_EXE_grouser"))
        .current_dir(folder)
        .args(
            arguments
                .split_whitespace()
                .map(|word| word.trim_matches('\'')),
        )
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() != Some(exit) {
        return Some(Err(format!(
            "{line}\n{}, not {exit}\n{printed}{errors}",
            output.status
        )));
    }
    if let Some(target) = target {
        fs::write(folder.join(target), &printed).unwrap();
    }
    Some(Ok(format!("{printed}{errors}")))
}

/// The quoted lines stand in the output; a line of `…` stands for others.
fn check_quotes(line: &str, output: &str, quotes: &str) -> Result<(), String> {
    let squeezed = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let lines: Vec<_> = output.lines().map(squeezed).collect();
    let mut missing = String::new();
    for quote in quotes
        .lines()
        .map(squeezed)
        .filter(|quote| !quote.is_empty() && quote != "…")
    {
        if !lines.iter().any(|printed| printed.contains(&quote)) {
            let _ = writeln!(missing, "  {quote}");
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!("{line}\nlacks:\n{missing}prints:\n{output}"))
}

/// Runs a page: how many commands ran, and what failed.
fn page(path: &Path) -> (usize, Vec<String>) {
    let text = fs::read_to_string(path).unwrap();
    let name = path.file_stem().unwrap().to_string_lossy().into_owned();
    let folder = Folder::new(&name);
    let data = std::env::var_os("GROUSER_DATA").map(PathBuf::from);
    let data = data.unwrap_or_else(|| root().join("data"));
    let data = Some(data.as_path()).filter(|data| data.is_dir());
    let (mut ran, mut failures) = (0, Vec::new());
    let blocks = blocks(&text);
    for (i, block) in blocks.iter().enumerate() {
        let exit = block.option("exit").map_or(0, |code| code.parse().unwrap());
        if block.needs_data() && data.is_none() {
            assert!(std::env::var_os("CI").is_none(), "no measured data");
            eprintln!(
                "{}: skipped for lack of data:\n{}",
                path.display(),
                block.body
            );
            continue;
        }
        // each part: its commands, and the lines that their output must have
        let parts: Vec<(String, &str)> = match block.language.as_str() {
            "toml" | "text" => {
                if let Some(file) = block.option("title") {
                    fs::write(folder.0.join(file), &block.body).unwrap();
                }
                continue;
            }
            "sh" => {
                let quoted = blocks.get(i + 1).filter(|next| next.language == "text");
                vec![(
                    block.body.replace("\\\n", " "),
                    quoted.map_or("", |next| &next.body),
                )]
            }
            "console" => {
                let parts = block
                    .body
                    .split("$ ")
                    .filter(|part| !part.trim().is_empty());
                let split = |part: &'_ str| {
                    part.split_once('\n')
                        .map_or(part.len(), |(line, _)| line.len())
                };
                parts
                    .map(|part| part.split_at(split(part)))
                    .map(|(line, quoted)| (line.to_owned(), quoted))
                    .collect()
            }
            _ => continue,
        };
        for (lines, quoted) in parts {
            let outputs: Result<Vec<_>, _> = lines
                .lines()
                .filter_map(|line| run(line, &folder.0, data, exit))
                .collect();
            match outputs {
                Ok(outputs) => {
                    ran += outputs.len();
                    if !outputs.is_empty() {
                        failures.extend(check_quotes(&lines, &outputs.concat(), quoted).err());
                    }
                }
                Err(failure) => failures.push(failure),
            }
        }
    }
    let at = |failure| format!("{}: {failure}", path.display());
    (ran, failures.into_iter().map(at).collect())
}

/// Runs pages that must have at least this many commands.
fn check(pages: &[PathBuf], min_commands: usize) {
    let (mut ran, mut failures) = (0, Vec::new());
    // pages know nothing of one another
    let next = AtomicUsize::new(0);
    let some = || {
        let mine = || pages.get(next.fetch_add(1, Ordering::Relaxed));
        std::iter::from_fn(|| mine().map(|path| page(path))).collect::<Vec<_>>()
    };
    std::thread::scope(|scope| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let runs: Vec<_> = (0..threads.min(pages.len()))
            .map(|_| scope.spawn(some))
            .collect();
        for (commands, failed) in runs.into_iter().flat_map(|run| run.join().unwrap()) {
            ran += commands;
            failures.extend(failed);
        }
    });
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(ran >= min_commands, "only {ran} commands");
}

fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut pages: Vec<_> = entries
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.sort();
    pages
}

#[test]
fn the_readme_runs_and_prints_what_it_quotes() {
    check(&[root().join("README.md")], 3);
}

#[test]
fn the_tutorials_run_and_print_what_they_quote() {
    check(&pages(&root().join("docs/tutorials")), 15);
}

#[test]
fn the_reference_pages_run_and_print_what_they_quote() {
    check(&pages(&root().join("docs")), 10);
}

/// Text between backticks.
fn code_spans(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// The paper's rows: each has its statement, its command runs, and the output has what the row quotes.
#[test]
fn every_row_of_the_paper_runs_and_prints_what_it_quotes() {
    let text = fs::read_to_string(root().join("docs/paper.md")).unwrap();
    let folder = Folder::new("paper-rows");
    let rows: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with("| "))
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect();
    let mut outputs = std::collections::BTreeMap::new();
    let mut failures = Vec::new();
    for statement in STATEMENTS {
        let Some(row) = rows.iter().find(|row| row[0] == statement.item) else {
            failures.push(format!("{}: no row", statement.item));
            continue;
        };
        let [_, about, command, comes_out, _] = row[..] else {
            failures.push(format!("{}: not five cells", statement.item));
            continue;
        };
        if about != statement.about || code_spans(command).concat() != statement.command {
            failures.push(format!("{}: not as the command has it", statement.item));
        }
        let [command] = code_spans(command)[..] else {
            continue; // what is lost has no command
        };
        let printed = outputs
            .entry(command)
            .or_insert_with(|| run(command, &folder.0, None, 0).expect("a command"));
        match printed {
            Ok(printed) => {
                let quotes = code_spans(comes_out).join("\n");
                failures.extend(check_quotes(command, printed, &quotes).err());
            }
            Err(failure) => failures.push(failure.clone()),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(outputs.len() > 12, "only {} commands", outputs.len());
}

/// Lines stay readable next to code: at most 100 characters, tables and links excepted. A tutorial is one sitting.
#[test]
fn pages_have_short_lines_and_tutorials_are_short() {
    let tutorials = pages(&root().join("docs/tutorials"));
    let mut all = [pages(&root().join("docs")), tutorials.clone()].concat();
    all.push(root().join("README.md"));
    for path in all {
        let text = fs::read_to_string(&path).unwrap();
        let max_lines = if tutorials.contains(&path) {
            100
        } else if path.ends_with("README.md") {
            130
        } else {
            usize::MAX
        };
        assert!(text.lines().count() <= max_lines, "{}", path.display());
        let is_free = |line: &&str| !line.starts_with('|') && !line.contains("](");
        for line in text.lines().filter(is_free) {
            assert!(line.chars().count() <= 100, "{}: {line}", path.display());
        }
    }
}

/// `just rivals` writes the sections of `bench/RESULTS.md` between markers, each once, and no more of that page.
#[test]
fn generated_sections_of_results_have_markers() {
    let read = |name: &str| fs::read_to_string(root().join("bench").join(name)).unwrap();
    let (script, results) = (read("rivals.py"), read("RESULTS.md"));
    let sections: Vec<&str> = script
        .split("    replace_section(\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    assert_eq!(sections, ["rivals", "paths"]);
    for name in sections {
        let place = |edge: &str| {
            let marker = format!("<!-- {edge} {name} -->");
            assert_eq!(results.matches(&marker).count(), 1, "{marker}");
            results.find(&marker)
        };
        assert!(place("begin") < place("end"));
    }
    assert_eq!(script.matches("\"RESULTS.md\"").count(), 1);
}
