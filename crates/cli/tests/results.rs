//! RESULTS.md is rendered from `results/`, and what is cheap is measured again.
//!
//! `RESULTS.in` is the page without the rows of its tables; `rows.tsv` has these, with the date and the processor
//! of their figures; `checks.tsv` the figures that a command of at most a few seconds prints, which stand in the rows as `{1}`,
//! `{2}`: the command, the line of its output (`*`: any word, `{}`: the figure; `HEADING > LINE`: below that heading), the value
//! and its limits. `just results` writes RESULTS.md.

use std::collections::BTreeMap;
use std::fs;

use crate::repository::{Folder, grouser_in, root};

/// The rows of a table of `results/` without its header.
fn table<const COLUMNS: usize>(name: &str) -> Vec<[String; COLUMNS]> {
    let text = fs::read_to_string(root().join("results").join(name)).unwrap();
    let cells = |row: &str| row.split('\t').map(str::to_owned).collect::<Vec<_>>();
    let rows = text.lines().skip(1);
    rows.map(|row| cells(row).try_into().unwrap()).collect()
}

struct Check {
    id: String,
    command: String,
    line: String,
    value: String,
    low: f64,
    high: f64,
}

fn checks() -> Vec<Check> {
    let number = |text: &str| text.parse().unwrap();
    let rows = table("checks.tsv").into_iter();
    rows.map(|[id, command, line, value, low, high]| Check {
        id,
        command,
        line,
        value,
        low: number(&low),
        high: number(&high),
    })
    .collect()
}

fn rendered() -> String {
    let page = fs::read_to_string(root().join("results/RESULTS.in")).unwrap();
    let values = checks().into_iter().map(|check| (check.id, check.value));
    let mut values: BTreeMap<_, _> = values.collect();
    let mut tables = BTreeMap::<String, Vec<String>>::new();
    for [id, date, processor, mut cells] in table("rows.tsv") {
        assert!(date.starts_with("20") && !processor.is_empty(), "{id}");
        for n in 1.. {
            let Some(value) = values.remove(&format!("{id}:{n}")) else {
                break;
            };
            let place = format!("{{{n}}}");
            assert!(cells.contains(&place), "{id} has no {place}");
            cells = cells.replace(&place, &value);
        }
        let (table, _) = id.split_once('/').unwrap();
        let rows = tables.entry(table.to_owned()).or_default();
        rows.push(format!("| {cells} |\n"));
    }
    assert!(values.is_empty(), "values without a row: {values:?}");
    let mut text = String::new();
    for line in page.lines() {
        match line.strip_prefix("<!-- rows ") {
            Some(name) => {
                let name = name.trim_end_matches(" -->");
                let rows = tables.remove(name);
                text += &rows.unwrap_or_else(|| panic!("no rows of {name}")).concat();
            }
            None => text = text + line + "\n",
        }
    }
    assert!(tables.is_empty(), "tables without a place: {tables:?}");
    text
}

#[test]
fn the_page_is_rendered_from_its_rows() {
    let (path, text) = (root().join("RESULTS.md"), rendered());
    if std::env::var_os("GROUSER_WRITE_RESULTS").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let written = fs::read_to_string(path).unwrap();
    assert!(written == text, "RESULTS.md is not that of results/");
}

/// The number in a word such as `(43` or `11.2592°;`.
fn number(word: &str) -> Option<f64> {
    let word = word.replace('−', "-");
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '-' | '.');
    let word = word.trim_matches(|c| !is_part(c));
    word.trim_end_matches('.').parse().ok()
}

/// The figure of a line of this pattern.
fn figure(output: &str, pattern: &str) -> Option<f64> {
    let words = |text: &str| {
        text.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let mut lines: Vec<_> = output.lines().map(words).collect();
    let line = match pattern.split_once(" > ") {
        Some((heading, line)) => {
            let heading = words(heading);
            let below = lines.iter().position(|line| line.starts_with(&heading))?;
            lines.drain(..=below);
            line
        }
        None => pattern,
    };
    let pattern = words(line);
    let place = pattern.iter().position(|word| word.contains("{}"))?;
    let matches = |(pattern, word): (&String, &String)| {
        let ends = pattern.split_once("{}");
        pattern == "*"
            || pattern == word
            || ends.is_some_and(|(begin, end)| word.starts_with(begin) && word.ends_with(end))
    };
    let found = lines
        .iter()
        .find(|line| line.len() >= pattern.len() && pattern.iter().zip(*line).all(matches))?;
    number(&found[place])
}

#[test]
fn cheap_figures_are_printed_as_the_page_has_them() {
    let data = std::env::var_os("GROUSER_DATA").map_or_else(|| root().join("data"), Into::into);
    let data = Some(data).filter(|data| data.is_dir());
    assert!(data.is_some() || std::env::var_os("CI").is_none());
    let (folder, checks) = (Folder::new("results"), checks());
    let mut outputs = BTreeMap::new();
    let mut faults = Vec::new();
    for check in &checks {
        let words = check.command.strip_prefix("grouser ").unwrap();
        let words = match &data {
            Some(data) => words.replace("$GROUSER_DATA", data.to_str().unwrap()),
            None if words.contains("$GROUSER_DATA") => continue,
            None => words.to_owned(),
        };
        let output: &String = outputs.entry(words).or_insert_with_key(|words| {
            let words: Vec<&str> = words.split_whitespace().collect();
            let output = grouser_in(&folder, &words);
            String::from_utf8(output.stdout).unwrap()
        });
        let printed = figure(output, &check.line);
        let is_within = |value: f64| (check.low..=check.high).contains(&value);
        if !printed.is_some_and(is_within) {
            faults.push(format!(
                "{}: `{}` prints {printed:?}, not {} to {}",
                check.id, check.command, check.low, check.high
            ));
        }
        if !number(&check.value).is_some_and(is_within) {
            faults.push(format!("{}: {} is outside", check.id, check.value));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_figure_is_found_by_its_line() {
    let output = "wheel A\n 0  pull N  1.5\nwheel B\n 0  pull N  −2.5°;\nproved (43 boxes)\n";
    assert_eq!(figure(output, "0 pull N {}"), Some(1.5));
    assert_eq!(figure(output, "wheel B > 0 * N {}"), Some(-2.5));
    assert_eq!(figure(output, "proved ({} boxes)"), Some(43.0));
    assert_eq!(figure(output, "1 pull N {}"), None);
}
