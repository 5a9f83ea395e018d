//! Help, completions, man pages and templates.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::program::{Folder, grouser, line, start, verbs, wait};

/// Standard output and standard error of a line, as a pipe gets them where no width is set.
fn piped(words: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_grouser"))
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .args(words.split_whitespace())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    [output.stdout, output.stderr]
        .map(|bytes| String::from_utf8(bytes).unwrap())
        .concat()
}

#[test]
fn piped_text_is_at_most_80_columns_wide_and_in_the_words_of_the_field() {
    let nothing = grouser::<&str>([]).assert_done();
    assert!(nothing.out.contains("Usage: grouser"), "{nothing:?}");
    assert!(nothing.out.contains("130  interrupted"), "{nothing:?}");
    let help = verbs().into_iter().map(|verb| format!("help {verb}"));
    let results = [
        "soils",
        "wheel --soil lunar --radius-m 0.1 --width-m 0.08 --load-n 60 --slip 0.2 --grouser-height-m 0.01 --grouser-count 9",
        "wheel --soil dry-sand --radius-m 0.1 --width-m 0.08 --load-n 60 --slip 0:0.8 --points 9",
        "wheel --soil sandd --radius-m 0.1 --width-m 0.08 --load-n 60 --slip 0.2",
        "climb --soil dry-sand --robot examples/robots/rocker-bogie.toml",
        "climb --soil dry-sand --radius-m 0.15 --width-m 0.12 --load-n 40 --certify 0.1 -v",
        "estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml --soil dry-sand",
        "estimate examples/five-wheel/log.mcap --robot examples/five-wheel/robot.toml -v",
        "drive examples/scenarios/slope.toml --compare open-loop,controller -v",
        "optimize examples/problems/paper.toml -v",
        "optimize examples/problems/lug-height.toml",
        "design examples/robots/rocker-bogie.toml --soil dry-sand --slope-deg 0=0.8,5=0.2 --points 3 -v",
        "identify examples/bevameter/tests.toml -v",
        "log info examples/five-wheel/log.mcap",
        "log info examples/five-wheel/log.csv",
        "robot examples/robots/five-wheel.toml --stance --pitch-deg 15",
        "paper slip-model --theta-deg 0:45 --sinkage-m 0.02 --radius-m 0.1",
    ];
    let private = [
        "way", "ways", "rim", "rims", "greatest", "beside", "besides", "apart", "stands", "anew",
    ];
    for words in help.chain(results.map(str::to_owned)) {
        let text = piped(&words);
        assert!(text.lines().count() > 1, "{words}: {text}");
        for line in text.lines() {
            // one word, such as a path, stays whole
            let is_wide = line.chars().count() > 80 && line.trim().contains(' ');
            assert!(!is_wide, "{words}: {line}");
            assert!(!line.contains('\u{2212}'), "{words}: {line}");
        }
        let flat = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let flat = flat.replace("at least", "").replace("least-", "");
        let mut found = flat.split(|c: char| !c.is_alphanumeric());
        let found = found.find(|word| private.contains(word) || *word == "least");
        assert_eq!(found, None, "{words}: {text}");
    }
    line("help nothing").assert_refused("help nothing");
    line("help help --schema").assert_refused("a verb without a schema");
}

#[test]
fn every_verb_has_an_example_a_schema_and_a_row_of_the_readme() {
    let readme = include_str!("../../../../README.md");
    let with_schema = line("help help --schema").err;
    let (_, with_schema) = with_schema.split_once("verbs with one are ").unwrap();
    let mut with_schema: Vec<&str> = with_schema.split([' ', ',']).collect();
    // what one prints is text, what the other prints is the node's
    with_schema.extend(["help", "live"]);
    for verb in verbs() {
        let help = line(&format!("help {verb}")).assert_done().out;
        let has_example = help.contains("Example") && help.contains(&format!("grouser {verb}"));
        assert!(has_example, "{verb} has no example: {help}");
        let has_schema = with_schema.iter().any(|name| name.trim() == verb);
        assert!(has_schema, "{verb} has no schema");
        let mut rows = readme.lines().filter(|line| line.starts_with('|'));
        let has_row = rows.any(|row| row.contains(&format!("`{verb}`")));
        assert!(has_row, "{verb} has no row in README.md");
    }
}

#[test]
fn the_exit_codes_are_those_of_the_documentation() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap();
    let page = std::fs::read_to_string(root.join("docs/command.md")).unwrap();
    let help = line("help").assert_done().out;
    let (_, codes) = help.split_once("Exit codes:").unwrap();
    let codes = codes.split_whitespace().collect::<Vec<_>>().join(" ");
    let rows = page.lines().filter_map(|row| {
        row.strip_prefix("| ")?
            .strip_suffix(" |")?
            .split_once(" | ")
    });
    let rows: Vec<String> = rows
        .filter(|(code, _)| code.parse::<u8>().is_ok())
        .map(|(code, meaning)| format!("{code} {meaning}"))
        .collect();
    assert_eq!(rows.join(" "), codes);
}

#[test]
fn completions_and_man_pages_name_the_verbs() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let said = line(&format!("help --completions {shell}")).assert_done();
        assert!(said.out.contains("slip-model"), "{shell}");
    }
    line("help --completions tcsh").assert_refused("a shell that is not known");
    let page = line("help wheel --man").assert_done();
    assert!(
        page.out.starts_with(".ie") && page.out.contains(".SH SYNOPSIS"),
        "{page:?}"
    );
}

#[test]
fn a_verb_of_before_names_what_does_its_job() {
    for (verb, now) in [
        ("curve --soil lunar", "wheel --slip FROM:TO"),
        ("slip-model", "paper slip-model"),
        ("completions bash", "help --completions SHELL"),
    ] {
        let said = line(verb);
        said.assert_refused(verb);
        assert_eq!(said.err.lines().count(), 1, "{said:?}");
        assert!(said.err.contains(&format!("`grouser {now}`")), "{said:?}");
    }
}

#[test]
fn templates_work_as_they_stand() {
    let folder = Folder::new();
    for kind in ["robot", "scenario", "problem", "soil"] {
        let path = folder.path(format!("{kind}.toml"));
        let arguments = ["init", kind, "-o", path.to_str().unwrap()];
        grouser(arguments).assert_done();
        let again = grouser(arguments);
        again.assert_refused("a file that exists");
        assert!(again.err.contains("it exists"), "{again:?}");
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(line(&format!("init {kind}")).assert_done().out, text);
    }
    let shown = |name: &str| folder.path(name).display().to_string();
    line(&format!("optimize {}", shown("problem.toml"))).assert_done();
    let wheel = |soil: &str| {
        let words = format!(
            "wheel --soil {soil} --radius-m 0.1 --width-m 0.1 --load-n 60 --slip 0.2 --json"
        );
        line(&words).assert_done().json()["torque_nm"].clone()
    };
    assert_eq!(wheel(&shown("soil.toml")), wheel("cmu-sand"));
}

#[test]
fn installed_examples_are_listed_and_copied() {
    let folder = Folder::new();
    let mut names: Vec<String> = ["a.csv", "robots/b.toml"].map(str::to_owned).to_vec();
    for name in &names {
        let path = folder.path(format!("usr/share/grouser/examples/{name}"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, name).unwrap();
    }
    // what pip compiles of an example in Python is none
    let compiled = folder.path("usr/share/grouser/examples/__pycache__");
    std::fs::create_dir(&compiled).unwrap();
    std::fs::write(compiled.join("c.pyc"), "").unwrap();
    // as a folder of the path in which another program of the same installation is
    let run = |path: PathBuf, words: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_grouser"));
        program.current_dir(folder.path("")).env("PATH", path);
        program
            .args(["init", "examples"])
            .args(words)
            .output()
            .unwrap()
    };
    let bin = folder.path("usr/bin");
    let listed = run(bin.clone(), &[]);
    assert!(listed.status.success(), "{listed:?}");
    names.sort();
    let text = String::from_utf8(listed.stdout).unwrap();
    assert_eq!(text.lines().collect::<Vec<_>>(), names);
    assert!(run(bin.clone(), &["-o", "copy"]).status.success());
    for name in &names {
        let copied = std::fs::read_to_string(folder.path(format!("copy/{name}"))).unwrap();
        assert_eq!(copied, *name);
    }
    let again = run(bin, &["-o", "copy"]);
    assert_eq!(again.status.code(), Some(2), "{again:?}");
    let absent = run(folder.path("nowhere"), &[]);
    let errors = String::from_utf8(absent.stderr).unwrap();
    assert!(
        errors.contains("not installed") && errors.contains("hint: "),
        "{errors}"
    );
}

#[test]
fn templates_are_the_examples() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .nth(2)
        .unwrap();
    for (kind, example) in [
        ("robot", "robots/five-wheel.toml"),
        ("scenario", "scenarios/sandbox.toml"),
        ("problem", "problems/dry-sand-wheel.toml"),
    ] {
        let text = std::fs::read_to_string(root.join("examples").join(example)).unwrap();
        let text = text.replace("\"../robots/five-wheel.toml\"", "\"robot.toml\"");
        assert_eq!(line(&format!("init {kind}")).out, text, "{kind}");
    }
    let patch = include_str!("../../templates/soft-patch.toml");
    let text = std::fs::read_to_string(root.join("examples/scenarios/soft-patch.toml")).unwrap();
    assert_eq!(
        text.replace("../robots/five-wheel.toml", "robot.toml"),
        patch
    );
}

#[test]
fn batch_reads_and_writes_the_standard_streams() {
    use std::io::Write as _;
    let batch = |rows: &str| {
        let mut child = start(["batch", "-", "-o", "-"], Stdio::piped());
        let mut input = child.stdin.take().unwrap();
        write!(input, "soil,radius_m,width_m,slip,load_n\n{rows}").unwrap();
        drop(input);
        wait(child)
    };
    let said = batch("lunar,0.1,0.1,0.2,40\nnothing,0.1,0.1,0.2,40\n");
    assert_eq!(said.code, Some(3), "one row of two failed: {said:?}");
    assert_eq!(said.out.lines().count(), 3, "{said:?}");
    assert!(
        said.err.starts_with("wrote `-`: 2 rows, 1 solved"),
        "{said:?}"
    );
    let said = batch("nothing,0.1,0.1,0.2,40\n");
    assert_eq!(said.code, Some(1), "no row is solved");
    line("batch - -o - --json").assert_refused("two users of standard output");
}
