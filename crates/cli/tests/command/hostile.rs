//! Every verb with arguments and files that mean no good.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;

use super::program::{Folder, grouser};

/// Verbs with arguments that work; the last of each pair is what gets replaced.
fn verbs(folder: &Folder) -> Vec<Vec<OsString>> {
    let table = folder.file(
        "in.csv",
        "soil,radius_m,width_m,slip,load_n\nlunar,0.1,0.1,0.2,40\n",
    );
    let (out, figure) = (folder.path("out.csv"), folder.path("figure.svg"));
    let words = |line: &str| {
        line.split_whitespace()
            .map(OsString::from)
            .collect::<Vec<_>>()
    };
    let with = |line: &str, rest: &[PathBuf]| {
        let mut all = words(line);
        all.extend(rest.iter().map(|path| path.clone().into_os_string()));
        all
    };
    vec![
        with(
            "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --rebound 0.1 --load-n 40 --slip 0.2 \
             --slip-angle-deg 3 --slope-deg 2 --k-shear-m 0.02 --c-1 0.4 --c-2 0.2 \
             --unit-weight-n-per-m3 9000 --figure",
            std::slice::from_ref(&figure),
        ),
        words("wheel --soil lunar --radius-m 0.1 --width-m 0.1 --slip 0.2 --sinkage-m 0.01"),
        with(
            "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0:0.5 \
             --points 5 -o",
            std::slice::from_ref(&out),
        ),
        with(
            "paper slip-model --theta-deg 10 --sinkage-m 0.01 --radius-m 0.05:0.1 --mobilised 0.2 --soil lunar \
             --points 5 -o",
            std::slice::from_ref(&figure),
        ),
        with("batch", &[table, "-o".into(), out]),
        words("soils lunar"),
    ]
}

/// The places of the values in a verb's arguments: what follows a flag, and what stands alone.
fn places(words: &[OsString]) -> impl Iterator<Item = usize> {
    (1..words.len()).filter(|place| !words[*place].to_string_lossy().starts_with('-'))
}

fn replaced(words: &[OsString], place: usize, value: &OsStr) -> Vec<OsString> {
    let mut words = words.to_vec();
    value.clone_into(&mut words[place]);
    words
}

#[test]
fn the_arguments_themselves_work() {
    let folder = Folder::new();
    for words in verbs(&folder) {
        assert_eq!(grouser(&words).code, Some(0), "{words:?}");
    }
}

#[test]
fn values_that_no_flag_takes_are_refused_and_write_nothing() {
    let mut values: Vec<OsString> = [
        "nan", "NaN", "inf", "-inf", "1e400", "-1e999", "", "abc", "0x10", "1_0", "٣", "1e", "+-1",
    ]
    .map(OsString::from)
    .to_vec();
    #[cfg(unix)]
    values.push(std::os::unix::ffi::OsStringExt::from_vec(vec![
        b'1', 0xff, 0xfe,
    ]));
    let folder = Folder::new();
    for words in verbs(&folder) {
        let takes_names = |place: usize| {
            let before = words[place - 1].to_string_lossy().into_owned();
            ["-o", "--figure"].contains(&before.as_str())
        };
        for place in places(&words).filter(|place| !takes_names(*place)) {
            for value in &values {
                for name in ["out.csv", "figure.svg"] {
                    let _ = std::fs::remove_file(folder.path(name));
                }
                let hostile = replaced(&words, place, value);
                grouser(&hostile).assert_refused(&format!("{hostile:?}"));
                assert_eq!(folder.names(), ["in.csv"], "{hostile:?}");
            }
        }
    }
}

#[test]
fn numbers_at_the_ends_of_their_type_break_nothing() {
    let values = [
        "0",
        "-0",
        "-1",
        "1",
        "1e300",
        "-1e300",
        "1e-300",
        "5e-324",
        "1.7976931348623157e308",
        "1e18",
        "90",
        "-90",
    ];
    let folder = Folder::new();
    for words in verbs(&folder) {
        for place in places(&words) {
            let before = words[place - 1].to_string_lossy().into_owned();
            if !before.starts_with("--") || before == "--figure" {
                continue;
            }
            for value in values {
                let mut hostile = replaced(&words, place, OsStr::new(value));
                hostile.push("--json".into());
                let said = grouser(&hostile);
                said.assert_sane(&format!("{hostile:?}"));
                if said.code != Some(2) {
                    let json = said.json();
                    assert!(json["provenance"].is_object(), "{hostile:?}");
                }
            }
        }
    }
}

#[test]
fn flags_twice_unknown_or_missing_are_refused() {
    let folder = Folder::new();
    for words in verbs(&folder) {
        for place in
            places(&words).filter(|place| words[place - 1].to_string_lossy().starts_with("--"))
        {
            let flag = words[place - 1].to_string_lossy().into_owned();
            let mut without = words.clone();
            without.drain(place - 1..=place);
            grouser(&without).assert_sane(&format!("{without:?}"));
            let mut misspelt = words.clone();
            misspelt[place - 1] = OsString::from(format!("{flag}x"));
            grouser(&misspelt).assert_refused(&format!("{misspelt:?}"));
            let mut last = words.clone();
            last.push(flag.into());
            grouser(&last).assert_refused(&format!("{last:?}"));
        }
    }
    for words in [
        vec![],
        vec![""],
        vec!["--"],
        vec!["wheel", "--", "x"],
        vec!["--json", "--json", "soils"],
    ] {
        grouser(&words).assert_sane(&format!("{words:?}"));
    }
}

/// Paths that are no files to read.
fn no_files(folder: &Folder) -> Vec<PathBuf> {
    let mut paths = vec![
        folder.path("missing.toml"),
        folder.path("."),
        folder.path("missing/x.csv"),
    ];
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStringExt as _;
        use std::os::unix::fs::symlink;
        let made = Command::new("mkfifo")
            .arg(folder.path("fifo.csv"))
            .status()
            .unwrap();
        assert!(made.success());
        symlink(folder.path("loop.csv"), folder.path("loop.csv")).unwrap();
        symlink(folder.path("gone.csv"), folder.path("dangling.csv")).unwrap();
        let odd = OsString::from_vec(b"n\xff.csv".to_vec());
        let devices = ["/dev/zero", "/dev/null"].map(PathBuf::from);
        let ours = ["fifo.csv", "loop.csv", "dangling.csv"].map(|name| folder.path(name));
        paths.extend(devices.into_iter().chain(ours));
        paths.push(folder.path(odd));
    }
    paths
}

#[test]
fn what_is_no_file_is_refused_as_input() {
    let folder = Folder::new();
    let words = verbs(&folder);
    let (wheel, batch, model) = (&words[1], &words[4], &words[3]);
    let soil = |words: &[OsString]| words.iter().position(|word| word == "lunar").unwrap();
    for path in no_files(&folder) {
        for hostile in [
            replaced(wheel, soil(wheel), path.as_os_str()),
            replaced(model, soil(model), path.as_os_str()),
            replaced(batch, 1, path.as_os_str()),
        ] {
            grouser(&hostile).assert_refused(&format!("{hostile:?}"));
        }
    }
    assert!(
        !folder
            .names()
            .iter()
            .any(|name| name.starts_with("out") || name.starts_with("figure"))
    );
}

#[test]
fn files_that_say_nonsense_are_refused() {
    let folder = Folder::new();
    let words = verbs(&folder);
    let (wheel, batch) = (&words[1], &words[4]);
    let deep = format!("x = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    let nan = "format = 1\nname = \"x\"\nn = nan\nk_c_kn_per_m_n1 = 1\nk_phi_kn_per_m_n2 = 1\ncohesion_kpa = 1\nphi_deg = 1\n";
    let contents: [(&str, Vec<u8>); 8] = [
        ("empty", Vec::new()),
        ("nul", vec![0; 4096]),
        ("binary", (0..=255).cycle().take(70_000).collect()),
        ("deep", deep.into_bytes()),
        ("large", vec![b'#'; 3 << 20]),
        ("newer", b"format = 99\nname = \"x\"\n".to_vec()),
        ("nan", nan.into()),
        (
            "unknown",
            b"format = 1\nname = \"x\"\nphi_degrees = 30\n".to_vec(),
        ),
    ];
    for (name, content) in contents {
        let path = folder.file(&format!("{name}.txt"), content);
        let soil = wheel.iter().position(|word| word == "lunar").unwrap();
        for hostile in [
            replaced(wheel, soil, path.as_os_str()),
            replaced(batch, 1, path.as_os_str()),
        ] {
            grouser(&hostile).assert_refused(name);
        }
    }
    assert!(
        !folder.names().iter().any(|name| name.contains("out")),
        "{:?}",
        folder.names()
    );
}

#[test]
fn outputs_that_cannot_be_written_are_refused() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.svg")).unwrap();
    std::fs::create_dir(folder.path("folder.csv")).unwrap();
    let mut outputs = vec![
        folder.path("missing/a.svg"),
        folder.path("missing/a.csv"),
        folder.path("folder.svg"),
        folder.path("folder.csv"),
        folder.path("in.csv/a.svg"),
    ];
    #[cfg(unix)]
    {
        let made = Command::new("mkfifo")
            .arg(folder.path("fifo.svg"))
            .status()
            .unwrap();
        assert!(made.success());
        outputs.push(folder.path("fifo.svg"));
    }
    for words in verbs(&folder) {
        let is_output = |place: &usize| words[place - 1] == "-o" || words[place - 1] == "--figure";
        let Some(place) = places(&words).find(is_output) else {
            continue;
        };
        for output in &outputs {
            let hostile = replaced(&words, place, output.as_os_str());
            grouser(&hostile).assert_refused(&format!("{hostile:?}"));
        }
    }
    assert!(
        !folder.names().iter().any(|name| name.contains("partial")),
        "{:?}",
        folder.names()
    );
}

/// Controls that a terminal obeys, in the name and the source of a soil, in a column and in a file's name.
#[test]
fn names_never_send_controls_to_the_terminal() {
    let folder = Folder::new();
    let soil = folder.path("soil.toml");
    let made = grouser(["init".into(), "soil".into(), "-o".into(), soil.clone()]);
    made.assert_done();
    let text = std::fs::read_to_string(&soil).unwrap();
    let hostile: String = text
        .lines()
        .map(|line| match line.split_once(" = ") {
            Some(("name" | "source", _)) => {
                let key = line.split_once(" = ").unwrap().0;
                format!("{key} = \"\\u001b[31mred \\u009b2J \\u007f\"\n")
            }
            _ => format!("{line}\n"),
        })
        .collect();
    assert!(hostile.contains("u009b"), "{text}");
    let soil = folder.file("\u{1b}[2J\u{9b}.toml", hostile);
    let table = folder.file(
        "in.csv",
        format!(
            "soil,radius_m,width_m,slip,load_n,\u{1b}[31m\n{},0.1,0.1,0.2,40,\u{9b}\n",
            soil.display()
        ),
    );
    let wheel = "wheel --radius-m 0.1 --width-m 0.1 --slip 0.2 --load-n 40 --soil";
    let with = |line: &str, rest: [&std::path::Path; 1]| {
        let mut words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        words.extend(rest.iter().map(|path| path.as_os_str().to_owned()));
        words
    };
    let output = folder.path("out.csv").display().to_string();
    for words in [
        with(wheel, [&soil]),
        with(&format!("--json {wheel}"), [&soil]),
        with(&format!("batch --json -o {output}"), [&table]),
        with("log info", [&table]),
        with("log info --json", [&table]),
        with("optimize", [&soil]),
        with("optimize --json", [&soil]),
    ] {
        let said = grouser(&words);
        said.assert_sane(&format!("{words:?}"));
        for text in [&said.out, &said.err] {
            let sent = text.chars().find(|c| c.is_control() && *c != '\n');
            assert_eq!(sent, None, "{words:?}: {said:?}");
        }
        if words.iter().any(|word| word == "--json") {
            said.json();
        }
    }
}

/// A disk that is full: what is written there fails, and a finished file is never half of one.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported() {
    let folder = Folder::new();
    let words = verbs(&folder);
    let batch = replaced(&words[4], 3, OsStr::new("/dev/full"));
    grouser(&batch).assert_refused("a table to a full disk");
    let full = std::fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let said = crate::repository::program()
        .arg("soils")
        .stdout(full)
        .output()
        .unwrap();
    assert_eq!(said.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&said.stderr).starts_with("error: cannot write `standard output`")
    );
}
