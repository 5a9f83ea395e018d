//! Every shell block of README.md and docs/, pasted as it stands.
//!
//! A block ```` ```sh ```` runs line by line; the block ```` ```text ```` after it quotes lines of its output. In ```` ```console ````
//! a line after `$ ` runs and the others are quoted. ```` ```toml title="F" ```` writes the file F. `sh data` and `console data` need
//! the measured data (`GROUSER_DATA`); `exit=N` is the exit code if it is not 0.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().nth(2).unwrap().to_owned()
}

/// A fenced block: its language, the words behind it, and its lines.
struct Block {
    language: String,
    options: Vec<String>,
    body: String,
}

impl Block {
    fn option(&self, name: &str) -> Option<&str> {
        let mut values = self.options.iter();
        values.find_map(|option| Some(option.strip_prefix(name)?.strip_prefix('=')?.trim_matches('"')))
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

/// Lines that end in a backslash go on in the next one.
fn commands(body: &str) -> Vec<String> {
    let joined = body.replace("\\\n", " ");
    joined.lines().map(str::to_owned).collect()
}

/// Runs a line; `None` if it is not of this command.
fn run(line: &str, folder: &Path, data: Option<&Path>, exit: i32) -> Option<String> {
    let line = line.split(" #").next().unwrap_or(line);
    let arguments = line.strip_prefix("cargo run --release -- ").or(line.strip_prefix("grouser "))?;
    let (arguments, target) = match arguments.split_once(" > ") {
        Some((arguments, target)) => (arguments, Some(target.trim())),
        None => (arguments, None),
    };
    let data = data.map(|data| data.display().to_string()).unwrap_or_default();
    let arguments = arguments.replace("$GROUSER_DATA", &data);
    let output = Command::new(env!("CARGO_BIN_EXE_grouser"))
        .current_dir(folder)
        .args(arguments.split_whitespace().map(|word| word.trim_matches('\'')))
        .output()
        .unwrap();
    let printed = String::from_utf8(output.stdout).unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(exit), "{line}\n{printed}{errors}");
    if let Some(target) = target {
        fs::write(folder.join(target), &printed).unwrap();
    }
    Some(format!("{printed}{errors}"))
}

/// The quoted lines stand in the output; a line of `…` stands for others.
fn check_quotes(line: &str, output: &str, quotes: &str) {
    let squeezed = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let lines: Vec<_> = output.lines().map(squeezed).collect();
    let mut missing = String::new();
    for quote in quotes.lines().map(squeezed).filter(|quote| !quote.is_empty() && quote != "…") {
        if !lines.iter().any(|printed| printed.contains(&quote)) {
            let _ = writeln!(missing, "  {quote}");
        }
    }
    assert!(missing.is_empty(), "{line}\nlacks:\n{missing}prints:\n{output}");
}

/// Runs a page; returns how many commands ran.
fn page(path: &Path) -> usize {
    let text = fs::read_to_string(path).unwrap();
    let name = path.file_stem().unwrap().to_string_lossy().into_owned();
    let folder = Folder::new(&name);
    let data = std::env::var_os("GROUSER_DATA").map(PathBuf::from);
    let data = data.unwrap_or_else(|| root().join("data"));
    let has_data = data.is_dir();
    let mut ran = 0;
    let blocks = blocks(&text);
    for (i, block) in blocks.iter().enumerate() {
        let exit = block.option("exit").map_or(0, |code| code.parse().unwrap());
        if block.needs_data() && !has_data {
            assert!(std::env::var_os("CI").is_none(), "no measured data in {}", data.display());
            eprintln!("{}: skipped for lack of data:\n{}", path.display(), block.body);
            continue;
        }
        let data = Some(data.as_path()).filter(|_| has_data);
        match block.language.as_str() {
            "toml" => {
                if let Some(file) = block.option("title") {
                    fs::write(folder.0.join(file), &block.body).unwrap();
                }
            }
            "sh" => {
                let mut printed = String::new();
                for line in commands(&block.body) {
                    if let Some(output) = run(&line, &folder.0, data, exit) {
                        printed.push_str(&output);
                        ran += 1;
                    }
                }
                if let Some(quoted) = blocks.get(i + 1).filter(|next| next.language == "text") {
                    check_quotes(&block.body, &printed, &quoted.body);
                }
            }
            "console" => {
                for part in block.body.split("$ ").filter(|part| !part.trim().is_empty()) {
                    let (line, quoted) = part.split_once('\n').unwrap_or((part, ""));
                    if let Some(output) = run(line, &folder.0, data, exit) {
                        check_quotes(line, &output, quoted);
                        ran += 1;
                    }
                }
            }
            _ => {}
        }
    }
    ran
}

fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "md")).collect();
    pages.sort();
    pages
}

#[test]
fn the_readme_runs_and_prints_what_it_quotes() {
    assert!(page(&root().join("README.md")) >= 3);
}

#[test]
fn the_tutorials_run_and_print_what_they_quote() {
    let pages = pages(&root().join("docs/tutorials"));
    assert!(pages.len() >= 6, "{pages:?}");
    let ran: usize = pages.iter().map(|path| page(path)).sum();
    assert!(ran >= 15, "{ran} commands");
}

#[test]
fn the_reference_pages_run_and_print_what_they_quote() {
    let pages = pages(&root().join("docs"));
    let ran: usize = pages.iter().map(|path| page(path)).sum();
    assert!(ran >= 10, "{ran} commands");
}

/// Lines of prose stay readable beside code: at most 100 characters in the README and the tutorials, and a tutorial is one sitting.
#[test]
fn the_readme_and_the_tutorials_are_short() {
    let mut pages = pages(&root().join("docs/tutorials"));
    pages.push(root().join("README.md"));
    for path in pages {
        let text = fs::read_to_string(&path).unwrap();
        let limit = if path.ends_with("README.md") { 130 } else { 100 };
        assert!(text.lines().count() <= limit, "{}", path.display());
        let is_table = |line: &str| line.starts_with('|');
        for line in text.lines().filter(|line| !is_table(line) && !line.contains("](")) {
            assert!(line.chars().count() <= 100, "{}: {line}", path.display());
        }
    }
}
