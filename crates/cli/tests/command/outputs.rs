//! Output files: what is there already is replaced as a whole, with its mode and its links, or not at all.
#![cfg(unix)]

use std::ffi::OsString;
use std::fs::{self, Permissions};
use std::io::Write as _;
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::program::{Folder, LANE_SOIL, LIMIT, grouser, line, start, wait};

const TABLE: &str = "soil,radius_m,width_m,slip,load_n\nlunar,0.1,0.1,0.2,40\n";

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(name)
}

/// `batch` that waits for the rest of its table, its output begun.
fn waiting(folder: &Folder, output: &Path) -> Child {
    let before = folder.names();
    let arguments: [OsString; 4] = ["batch".into(), "-".into(), "-o".into(), output.into()];
    let mut child = start(arguments, Stdio::piped());
    let pipe = child.stdin.as_mut().unwrap();
    pipe.write_all(TABLE.as_bytes()).unwrap();
    pipe.flush().unwrap();
    let begun = Instant::now();
    let is_new = |name: &String| name.ends_with(".partial") && !before.contains(name);
    while !folder.names().iter().any(is_new) {
        assert!(begun.elapsed() < LIMIT, "never begun");
        thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn what_a_killed_program_left_goes_with_the_next_and_a_living_one_keeps_its_file() {
    let folder = Folder::new();
    let table = folder.file("in.csv", TABLE);
    let output = folder.path("out.csv");
    let mut killed = waiting(&folder, &output);
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(folder.names().len(), 2, "{:?}", folder.names());
    let mut living = waiting(&folder, &output);
    // the killed one's is gone, the living one's is there
    assert_eq!(folder.names().len(), 2, "{:?}", folder.names());
    let arguments = ["batch".into(), table, "-o".into(), output.clone()];
    grouser(&arguments).assert_done();
    assert_eq!(folder.names().len(), 3, "{:?}", folder.names());
    drop(living.stdin.take());
    wait(living).assert_done();
    assert_eq!(folder.names(), ["in.csv", "out.csv"]);
    assert_eq!(fs::read_to_string(output).unwrap().lines().count(), 2);
}

#[test]
fn a_file_keeps_its_mode_and_a_link_stays_a_link() {
    let folder = Folder::new();
    let table = folder.file("in.csv", TABLE);
    for mode in [0o600, 0o640, 0o664, 0o755] {
        let output = folder.file("out.csv", "old");
        fs::set_permissions(&output, Permissions::from_mode(mode)).unwrap();
        let arguments = ["batch".into(), table.clone(), "-o".into(), output.clone()];
        grouser(arguments).assert_done();
        let found = fs::metadata(&output).unwrap().permissions().mode();
        assert_eq!(found & 0o777, mode);
        assert_ne!(fs::read_to_string(output).unwrap(), "old");
    }
    // a link to a file, a link to a link, and a link to what is not there yet, from another folder
    fs::create_dir(folder.path("to")).unwrap();
    folder.file("to/file.csv", "old");
    symlink("to/file.csv", folder.path("link.csv")).unwrap();
    symlink("link.csv", folder.path("links.csv")).unwrap();
    symlink("to/new.csv", folder.path("dangling.csv")).unwrap();
    for (link, target) in [("links.csv", "to/file.csv"), ("dangling.csv", "to/new.csv")] {
        let link = folder.path(link);
        let arguments = ["batch".into(), table.clone(), "-o".into(), link.clone()];
        grouser(arguments).assert_done();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let written = fs::read_to_string(folder.path(target)).unwrap();
        assert_eq!(written.lines().count(), 2, "{target}");
    }
    assert!(
        fs::symlink_metadata(folder.path("link.csv"))
            .unwrap()
            .is_symlink()
    );
    // in a ring there is no file
    symlink("b.csv", folder.path("a.csv")).unwrap();
    symlink("a.csv", folder.path("b.csv")).unwrap();
    let ring = ["batch".into(), table, "-o".into(), folder.path("a.csv")];
    grouser(ring).assert_refused("a ring of links");
}

#[test]
fn a_read_only_file_is_refused_also_by_an_administrator() {
    let folder = Folder::new();
    let table = folder.file("in.csv", TABLE);
    let output = folder.file("out.csv", "old");
    fs::set_permissions(&output, Permissions::from_mode(0o444)).unwrap();
    let said = grouser(["batch".into(), table, "-o".into(), output.clone()]);
    said.assert_refused("read-only");
    assert!(said.err.contains("read-only"), "{said:?}");
    assert_eq!(fs::read_to_string(output).unwrap(), "old");
    assert_eq!(folder.names(), ["in.csv", "out.csv"]);
}

#[test]
fn the_longest_name_that_the_system_takes_is_written() {
    let folder = Folder::new();
    let table = folder.file("in.csv", TABLE);
    let output = |length: usize| folder.path(format!("{}.csv", "x".repeat(length - 4)));
    let run = |output: PathBuf| grouser(["batch".into(), table.clone(), "-o".into(), output]);
    run(output(255)).assert_done();
    run(output(256)).assert_refused("a name that is too long");
    assert_eq!(folder.names().len(), 2);
}

/// Verbs that read files and write some: the words, with `@NAME` for a file of the folder and `>NAME` for the output.
const READ_AND_WRITE: [&str; 25] = [
    "wheel --soil @soil.toml --radius-m 0.1 --width-m 0.1 --slip 0.2 --load-n 40 --figure >x.svg",
    "wheel --soil @soil.toml --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0:0.9 --points 3 -o >x.csv",
    "wheel --soil @soil.toml --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0:0.9 --points 3 -o >x.png",
    "paper slip-model --theta-deg 10 --sinkage-m 0.01 --radius-m 0.05:0.1 --mobilised 0.2 --soil @soil.toml --points 3 -o >x.csv",
    "climb --soil @soil.toml --robot @skid-steer.toml -o >x.svg",
    "batch @in.csv -o >x.csv",
    "batch @of-file.csv -o >x.csv",
    "estimate @log.mcap --robot @robot.toml -o >x.csv",
    "estimate @log.mcap --robot @robot.toml -o >x.mcap",
    "estimate @log.mcap --robot @robot.toml -o >x.svg",
    "estimate @log.csv --map @columns.toml --robot @robot.toml -o >x.csv",
    "estimate @log.csv --map @columns.toml --robot @robot.toml --soil @soil.toml -o >x.csv",
    "estimate @log.mcap --robot @robot.toml --truth /truth --calibrate >x.toml",
    "estimate @log.mcap --robot @robot.toml --report >x.html",
    "optimize @problem.toml --report >x.html",
    "drive @scenario.toml -o >x.csv",
    "drive @scenario.toml --report >x.html",
    "map @dunes.asc --robot @skid-steer.toml --soil @soil.toml --headings 4 -o >x.tif",
    "optimize @problem.toml -o >x.csv",
    "optimize @problem.toml --certify 0.1 --proof >x.jsonl",
    "robot @rover.urdf -o >x.toml",
    "identify @tests.toml -o >x.toml",
    "identify @tests.toml --figure >x.svg",
    "log convert @log.mcap >x.csv --topic /imu",
    "log recover @log.mcap >x.mcap",
];

#[test]
fn no_verb_writes_over_a_file_that_it_reads() {
    let folder = Folder::new();
    for (name, from) in [
        ("robot.toml", "five-wheel/robot.toml"),
        ("five-wheel.toml", "robots/five-wheel.toml"),
        ("log.mcap", "five-wheel/log.mcap"),
        ("log.csv", "five-wheel/log.csv"),
        ("columns.toml", "five-wheel/columns.toml"),
        ("skid-steer.toml", "robots/skid-steer.toml"),
        ("rover.urdf", "robots/five-wheel.urdf"),
        ("dunes.asc", "terrain/dunes.asc"),
        ("problem.toml", "problems/paper.toml"),
        ("tests.toml", "bevameter/tests.toml"),
        ("plates.csv", "bevameter/plates.csv"),
        ("shear.csv", "bevameter/shear.csv"),
        ("wheel.csv", "bevameter/wheel.csv"),
        ("truth.toml", "bevameter/truth.toml"),
    ] {
        fs::copy(example(from), folder.path(name)).unwrap();
    }
    folder.file("soil.toml", LANE_SOIL);
    let soil = folder.path("soil.toml").display().to_string();
    folder.file("in.csv", TABLE);
    folder.file("of-file.csv", TABLE.replace("lunar", &soil));
    let scenario = fs::read_to_string(example("scenarios/soft-patch.toml")).unwrap();
    folder.file("scenario.toml", scenario.replace("../robots/", ""));
    let read = |name: &str| fs::read(folder.path(name)).unwrap();
    let mut checked = 0;
    for words in READ_AND_WRITE {
        let mut inputs: Vec<&str> = words
            .split_whitespace()
            .filter_map(|word| word.strip_prefix('@'))
            .collect();
        // files that others name
        match inputs[0] {
            "scenario.toml" => inputs.push("five-wheel.toml"),
            "tests.toml" => inputs.extend(["plates.csv", "shear.csv", "wheel.csv"]),
            "of-file.csv" => inputs.push("soil.toml"),
            _ => {}
        }
        for input in inputs {
            let mut link = PathBuf::new();
            let arguments: Vec<OsString> = words
                .split_whitespace()
                .map(
                    |word| match (word.strip_prefix('@'), word.strip_prefix('>')) {
                        (Some(name), _) => folder.path(name).into(),
                        (_, Some(name)) => {
                            link = folder.path(name);
                            link.clone().into()
                        }
                        _ => word.into(),
                    },
                )
                .collect();
            symlink(input, &link).unwrap();
            let before = read(input);
            let said = grouser(&arguments);
            assert_eq!(read(input), before, "{words} over {input}");
            said.assert_refused(&format!("{words} over {input}"));
            assert!(
                said.err.contains("it is read by the same command"),
                "{words} over {input}: {said:?}"
            );
            fs::remove_file(link).unwrap();
            checked += 1;
        }
    }
    assert!(checked > READ_AND_WRITE.len());
    assert!(!folder.names().iter().any(|name| name.contains("partial")));
}

#[test]
fn two_outputs_of_one_name_are_refused() {
    let folder = Folder::new();
    let output = folder.path("x.csv").display().to_string();
    let said = line(&format!(
        "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0:0.9 --points 3 -o {output} -o {}",
        folder.path("./x.csv").display()
    ));
    said.assert_refused("one name twice");
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

/// As of `batch`: 1 where no point has a solution, 3 where some have none, 0 where all have one.
#[test]
fn a_curve_with_points_that_are_not_solved_ends_with_3() {
    let curve = |load: &str| {
        let wheel = "--soil lunar --radius-m 0.1 --width-m 0.05 --slip 0:0.9 --points 31";
        super::program::line(&format!("wheel {wheel} --load-n {load}"))
    };
    let codes: Vec<Option<i32>> = ["20", "300", "100000"].map(|load| curve(load).code).into();
    assert_eq!(codes, [Some(0), Some(3), Some(1)]);
    let some = curve("300");
    assert!(some.out.contains("of 31 points solved"), "{}", some.out);
}
