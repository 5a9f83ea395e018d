//! The verbs with arguments that work, and the files that they read.

use std::fmt::Write as _; // writing to a string cannot fail
use std::fs;
use std::path::{Path, PathBuf};

use super::program::{Folder, grouser, verbs};
use super::random::Random;

/// Words of a command: `@NAME` is a file to read, `>NAME` one to write. The number is how often it is chosen.
const VERBS: [(u32, &str); 38] = [
    (
        3,
        "wheel --soil @soil.toml --radius-m 0.1 --width-m 0.1 --slip 0.2 --load-n 40",
    ),
    (
        1,
        "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --rebound 0.1 --mass-kg 4 --slope-deg 2 --gravity-m-per-s2 moon --slip-angle-deg 3 --figure >x.svg",
    ),
    (
        2,
        "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --slip 0.2 --sinkage-m 0.01 --grouser-height-m 0.01 --grouser-count 24",
    ),
    (
        3,
        "wheel --soil @soil.toml --radius-m 0.1 --width-m 0.1 --load-n 40 --slip -0.5:0.5 --points 5 -o >x.csv",
    ),
    (
        1,
        "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --mass-kg 4 --slip 0:0.9 --points 5 -o >x.svg",
    ),
    (
        2,
        "paper slip-model --theta-deg 10 --sinkage-m 0.01 --radius-m 0.05:0.1 --mobilised 0.2 --soil @soil.toml --points 4 -o >x.csv",
    ),
    (
        2,
        "climb --soil @soil.toml --radius-m 0.1 --width-m 0.1 --load-n 40",
    ),
    (1, "climb --soil lunar --robot @skid-steer.toml"),
    (6, "batch @in.csv -o >x.csv"),
    (2, "batch @in.csv -o -"),
    (6, "estimate @log.mcap --robot @robot.toml -o >x.csv"),
    (4, "estimate @log.mcap --robot @robot.toml -o >x.mcap"),
    (3, "estimate @log.bag --robot @robot.toml --online"),
    (
        5,
        "estimate @log.csv --map @columns.toml --robot @robot.toml -o >x.csv",
    ),
    (
        2,
        "estimate @log.csv --map @columns.toml --robot @robot.toml --from-s 1 --to-s 3",
    ),
    (
        2,
        "estimate @log.csv --map @columns.toml --robot @robot.toml --truth @truth.csv --check",
    ),
    (
        1,
        "estimate @log.csv --map @columns.toml --robot @robot.toml --truth @truth.csv --calibrate-radius >x.toml",
    ),
    (4, "drive @scenario.toml -o >x.csv"),
    (
        1,
        "drive @scenario.toml --seed 7 --sweep 2 --report >x.html",
    ),
    (
        3,
        "map @dem.asc --robot @skid-steer.toml --soil sandy-loam --headings 4 -o >x.tif",
    ),
    (
        3,
        "map @dem.tif --robot @skid-steer.toml --soil @soil.toml --headings 4 -o >x.tif",
    ),
    (4, "plan @map.tif --from 2,2 --to 8,8 -o >x.csv"),
    (
        1,
        "plan @map.tif --from 2,2 --to 8,8 --scenario >x.toml --dem @dem.asc --robot @skid-steer.toml --soil sandy-loam",
    ),
    (5, "optimize @problem.toml -o >x.csv"),
    (
        2,
        "optimize @problem.toml --certify 0.1 --certify-time 2 --proof >x.jsonl",
    ),
    (3, "robot @rover.urdf -o >x.toml"),
    (
        2,
        "robot @five-wheel.toml --stance --pitch-deg 5 --roll-deg 2",
    ),
    (2, "identify @tests.toml -o >x.toml"),
    (5, "log info @log.mcap"),
    (2, "log info @log.bag"),
    (3, "log convert @log.bag >x.mcap"),
    (3, "log convert @log.mcap >x.csv --topic /imu"),
    (6, "log recover @log.mcap >x.mcap"),
    (2, "estimate @log.mcap --robot @robot.toml --report >x.html"),
    (2, "optimize @problem.toml --report >x.html"),
    (
        2,
        "map @dem.asc --robot @skid-steer.toml --soil @soil.toml --headings 4 -o >x.tif -o x.yaml",
    ),
    (
        2,
        "design @five-wheel.toml --soil @soil.toml --slope-deg 0=0.9,4=0.1 --radius-m 0.15 --points 2 -o >x.csv",
    ),
    (
        2,
        "fmu --soil @soil.toml --radius-m 0.1 --width-m 0.1 -o >x.fmu",
    ),
];

/// Verbs that are not attacked.
const NOT_ATTACKED: [(&str, &str); 6] = [
    ("init", "reads no file"),
    ("soils", "reads no file"),
    ("help", "reads no file"),
    ("validate", "takes minutes"),
    ("live", "another program"),
    ("view", "another program"),
];

#[test]
fn every_verb_is_attacked() {
    for verb in verbs() {
        let is_attacked = VERBS.iter().any(|(_, words)| words.starts_with(&verb));
        let has_reason = NOT_ATTACKED.iter().any(|(name, _)| *name == verb);
        assert!(is_attacked != has_reason, "{verb}");
    }
}

/// The words of a verb, by how often each is chosen.
pub(crate) fn choose(random: &mut Random) -> &'static str {
    let all: u32 = VERBS.iter().map(|(often, _)| often).sum();
    let mut place = random.below(all as usize);
    for (often, words) in VERBS {
        if place < often as usize {
            return words;
        }
        place -= often as usize;
    }
    VERBS[0].1
}

/// The files of all cases, made once.
pub(crate) struct Shared {
    folder: Folder,
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples")
        .join(name)
}

impl Shared {
    pub(crate) fn new() -> Self {
        let folder = Folder::new();
        for (name, from) in [
            ("robot.toml", "five-wheel/robot.toml"),
            ("five-wheel.toml", "robots/five-wheel.toml"),
            ("log.mcap", "five-wheel/log.mcap"),
            ("log.csv", "five-wheel/log.csv"),
            ("truth.csv", "five-wheel/truth.csv"),
            ("columns.toml", "five-wheel/columns.toml"),
            ("skid-steer.toml", "robots/skid-steer.toml"),
            ("rover.urdf", "robots/five-wheel.urdf"),
            ("problem.toml", "problems/paper.toml"),
            ("plates.csv", "bevameter/plates.csv"),
            ("shear.csv", "bevameter/shear.csv"),
        ] {
            fs::copy(example(from), folder.path(name)).unwrap();
        }
        let read = |name: &str| fs::read_to_string(example(name)).unwrap();
        let scenario = read("scenarios/soft-patch.toml").replace("../robots/", "");
        let scenario = scenario.replace("duration_s = 180.0", "duration_s = 2.0");
        assert!(scenario.contains("duration_s = 2.0"), "{scenario}");
        folder.file("scenario.toml", scenario);
        // plates and shear alone: wheels take seconds
        let tests = read("bevameter/tests.toml");
        let (plates, wheel) = tests.split_once("\n[wheel]").unwrap();
        assert!(wheel.contains("wheel.csv"));
        folder.file("tests.toml", plates);
        let mut table = "soil,radius_m,width_m,slip,load_n\n".to_owned();
        for row in 0..200 {
            let (slip, load) = (f64::from(row) / 200.0, 10 + row);
            let _ = writeln!(table, "lunar,0.1,0.1,{slip},{load}");
        }
        folder.file("in.csv", table);
        let mut relief = "ncols 12\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 1\n".to_owned();
        for row in 0..12 {
            for column in 0..12 {
                let _ = write!(relief, "{} ", f64::from(row * column % 7) * 0.05);
            }
            relief.push('\n');
        }
        folder.file("dem.asc", relief);
        let shared = Self { folder };
        let run = |words: &str| {
            let words = words.split_whitespace().map(|word| shared.named(word));
            let said = grouser(words);
            assert_eq!(said.code, Some(0), "{said:?}");
        };
        run("init soil -o @soil.toml");
        run("map @dem.asc --robot @skid-steer.toml --soil sandy-loam --headings 4 -o @map.tif");
        fs::copy(shared.folder.path("map.tif"), shared.folder.path("dem.tif")).unwrap();
        // messages of ROS 1, which only a bag holds
        let bag = measured_bag().unwrap_or_else(|| shared.folder.path("log.mcap"));
        fs::copy(bag, shared.folder.path("log.bag")).unwrap();
        shared
    }

    fn named(&self, word: &str) -> PathBuf {
        word.strip_prefix('@')
            .map_or_else(|| word.into(), |name| self.folder.path(name))
    }

    /// The content of a file.
    pub(crate) fn content(&self, name: &str) -> Vec<u8> {
        fs::read(self.folder.path(name)).unwrap()
    }
}

/// A bag of the measured data; without them its place is taken by an MCAP file, whose content decides.
fn measured_bag() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root.join("data"), PathBuf::from);
    let name = "cmu-wheel/f-d-large-box__force-displacement_1.bag";
    Some(root.join(base).join(name)).filter(|path| path.is_file())
}
