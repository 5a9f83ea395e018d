//! `design`: the wheel of a robot for a mission.

use serde_json::Value;

use super::program::{Folder, LANE_SOIL, grouser};

const ROBOT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/robots/skid-steer.toml"
);

/// One soil, two slopes, three wheels: a second or two.
const MISSION: [&str; 9] = [
    "design",
    ROBOT,
    "--soil",
    "dry-sand",
    "--slope-deg",
    "0=0.7,8=0.3",
    "--points",
    "3",
    "--json",
];

fn design(flags: &[&str]) -> Value {
    let run = grouser(MISSION.iter().chain(flags));
    run.assert_done().json()
}

fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key}: {value}"))
}

#[test]
fn the_written_robot_climbs_as_the_design_says() {
    let folder = Folder::new();
    let robot = folder.path("new.toml");
    let written = robot.to_str().unwrap();
    let made = design(&["--write-robot", written, "--gravity-m-per-s2", "mars"]);
    let chosen = &made["chosen"];
    assert!(number(chosen, "least_reserve") >= 0.05 - 1e-6);
    assert!(number(&made, "difference") < 1e-6, "{made}");
    // `climb` reads the file with all that rose with the axles, and knows nothing of the design. Its table has the level.
    let climbed = grouser(["climb", "--robot", written, "--soil", "dry-sand", "--json"]);
    let climbed = climbed.assert_done().json();
    assert_eq!(number(&climbed, "gravity_m_per_s2"), 3.71);
    let level = &climbed["steps"][0];
    let ours = &chosen["stations"][0];
    for key in ["slip", "energy_j_per_m", "sinkage_m"] {
        let off = number(level, key) / number(ours, key) - 1.0;
        assert!(off.abs() < 1e-6, "{key}: {off}");
    }
    assert!(number(&climbed, "steepest_slope_deg") > 8.0);
    // The present wheel is that of the file, with its mass there.
    let climbed = grouser([
        "climb",
        "--robot",
        ROBOT,
        "--soil",
        "dry-sand",
        "--gravity-m-per-s2",
        "mars",
        "--json",
    ]);
    let level = &climbed.assert_done().json()["steps"][0];
    let present = &made["present"];
    for key in ["slip", "energy_j_per_m", "sinkage_m"] {
        let off = number(level, key) / number(&present["stations"][0], key) - 1.0;
        assert!(off.abs() < 1e-6, "present {key}: {off}");
    }
    assert_eq!(number(present, "wheel_mass_kg"), 0.8);
    assert!(number(&made, "present_formula_mass_kg") > 0.9);
    // The mass of the formula is in the file.
    let text = std::fs::read_to_string(&robot).unwrap();
    assert!(
        text.contains(&format!("{:?}", number(chosen, "wheel_mass_kg"))),
        "{text}"
    );
}

/// The first line has the doubt where the formula is that of another wheel, and both masses follow wherever they differ.
#[test]
fn masses_of_another_wheel_are_in_the_first_line() {
    let text = |formula: &str| {
        let flags = ["--wheel-mass-kg", formula];
        let arguments = MISSION
            .iter()
            .filter(|word| **word != "--json")
            .chain(&flags);
        grouser(arguments).assert_done().out
    };
    let heavy = text("2");
    let mut lines = heavy.lines();
    assert!(
        lines.next().unwrap().contains("(masses uncertain)"),
        "{heavy}"
    );
    let why = "WARNING: the formula gives the present wheel a mass of 2 kg, the robot file 0.8 kg";
    assert!(lines.next().unwrap().starts_with(why), "{heavy}");
    let near = text("0.9");
    assert!(
        !near.contains("uncertain")
            && near.contains("it gives the present wheel 0.9 kg, the robot file 0.8 kg"),
        "{near}"
    );
    assert!(!text("0.8").contains("the robot file"));
}

#[test]
fn what_must_grow_grows() {
    let plain = design(&[]);
    let front = plain["front"].as_array().unwrap();
    for pair in front.windows(2) {
        assert!(number(&pair[1], "wheel_mass_kg") > number(&pair[0], "wheel_mass_kg"));
        assert!(number(&pair[1], "energy_j_per_m") < number(&pair[0], "energy_j_per_m"));
    }
    // More reserve: a heavier lightest wheel. Less gravity: less energy per metre.
    let lightest = |object: &Value| number(&object["front"][0], "wheel_mass_kg");
    let safer = design(&["--min-reserve", "0.12"]);
    assert!(
        lightest(&safer) > lightest(&plain),
        "{} {}",
        lightest(&safer),
        lightest(&plain)
    );
    let moon = design(&["--gravity-m-per-s2", "moon", "--choice", "least-energy"]);
    let least = |object: &Value| {
        let front = object["front"].as_array().unwrap();
        number(front.last().unwrap(), "energy_j_per_m")
    };
    assert!(
        least(&moon) < 0.25 * least(&plain),
        "{} {}",
        least(&moon),
        least(&plain)
    );
    // A second soil can only add to the energy of the worst one.
    let two = design(&["--soil", "lunar"]);
    assert_eq!(two["soils"].as_array().unwrap().len(), 2);
    assert!(least(&two) >= least(&plain) * (1.0 - 1e-6));
}

#[test]
fn a_mission_file_is_the_flags() {
    let folder = Folder::new();
    let file = folder.path("mission.toml");
    let text = "format = 1\npoints = 3\n[[soil]]\nsoil = \"dry-sand\"\n[[slope]]\nslope_deg = 0\nshare = 0.7\n\
                [[slope]]\nslope_deg = 8\nshare = 0.3\n";
    std::fs::write(&file, text).unwrap();
    let mission = file.to_str().unwrap();
    let by_file = grouser(["design", ROBOT, "--mission", mission, "--json"])
        .assert_done()
        .json();
    let by_flags = design(&[]);
    assert_eq!(by_file["front"], by_flags["front"]);
    for (wrong, says) in [
        ("min_reserve = 2.0\n", "min_reserve"),
        ("points = 1\n", "points"),
        ("[wheel]\nradius = 0.1\n", "radius"),
        ("[wheel]\nradius_m = [0.2, 0.1]\n", "radius_m"),
        ("[[slope]]\nslope_deg = 70\n", "60"),
        ("soil_measure = \"best\"\n", "worst"),
    ] {
        std::fs::write(&file, format!("format = 1\n{wrong}")).unwrap();
        let said = grouser(["design", ROBOT, "--mission", mission]);
        said.assert_refused(wrong);
        assert!(said.err.contains(says), "{wrong}: {}", said.err);
    }
}

/// The load is shared out by where the chassis' mass lies: no fixed place has less energy, the loads are those of the lever, and
/// `climb` finds the same on the written robot.
#[test]
fn the_mass_is_shifted_to_where_the_energy_is_least() {
    let folder = Folder::new();
    let robot = folder.path("new.toml");
    let energy_at = |shift: &str, width: &str| {
        let flags = [
            "design",
            ROBOT,
            "--soil",
            "dry-sand",
            "--slope-deg",
            "0=0.3,8=0.7",
            "--points",
            "2",
        ];
        let rest = [
            "--radius-m",
            "0.15",
            "--width-m",
            width,
            "--choice",
            "least-energy",
            "--json",
        ];
        let written = [
            "--mass-shift-m",
            shift,
            "--write-robot",
            robot.to_str().unwrap(),
        ];
        let run = grouser(flags.into_iter().chain(rest).chain(written));
        let made = run.assert_done().json();
        assert!(number(&made, "difference") < 1e-6, "{made}");
        made["chosen"].clone()
    };
    let best = energy_at("-0.1:0.1", "0.08:0.12");
    let shift = number(&best, "mass_shift_m");
    assert!(shift > 0.02 && shift < 0.06, "{shift}");
    // 12 kg on a wheelbase of 0.44 m; the two front wheels share what is shifted
    let load = |name: &str| number(&best["loads_n"], name);
    let lever = 12.0 * 9.806_65 * shift / 0.44;
    assert!(
        (load("front_left") - load("rear_left") - lever).abs() < 1e-6,
        "{best}"
    );
    let climbed = grouser([
        "climb",
        "--robot",
        robot.to_str().unwrap(),
        "--soil",
        "dry-sand",
        "--json",
    ]);
    let climbed = climbed.assert_done().json();
    let level = number(&climbed["steps"][0], "energy_j_per_m");
    assert!((level / number(&best["stations"][0], "energy_j_per_m") - 1.0).abs() < 1e-6);
    let energies: Vec<f64> = ["-0.1", "0", "0.02", "0.06", "0.1"]
        .map(|fixed| number(&energy_at(fixed, "0.119:0.12"), "energy_j_per_m"))
        .to_vec();
    let least = number(&best, "energy_j_per_m");
    assert!(
        energies.iter().all(|energy| *energy > least),
        "{least} {energies:?}"
    );
    assert!(energies[0] > 1.01 * least, "{least} {energies:?}");
    let beyond = grouser([
        "design",
        ROBOT,
        "--soil",
        "dry-sand",
        "--slope-deg",
        "0",
        "--mass-shift-m",
        "0:0.3",
    ]);
    beyond.assert_refused("a mass in front of the wheels");
    assert!(beyond.err.contains("0.22"), "{}", beyond.err);
}

/// A mission that is written finds the same front from another folder: its soil file lies beside it, where it was or in full.
#[test]
fn a_written_mission_finds_the_same_wheels() {
    let folder = Folder::new();
    let soil = folder.file("own.toml", LANE_SOIL);
    let elsewhere = Folder::new();
    for file in [folder.path("day.toml"), elsewhere.path("day.toml")] {
        let file = file.to_str().unwrap();
        let soil = soil.to_str().unwrap();
        let flags = [
            "design",
            ROBOT,
            "--soil",
            soil,
            "--slope-deg",
            "0=0.75,4=0.25",
        ];
        let flags = flags
            .into_iter()
            .chain(["--points", "3", "--width-m", "0.08:0.2", "--json"]);
        let by_flags = grouser(flags.chain(["--write-mission", file]))
            .assert_done()
            .json();
        let by_file = grouser(["design", ROBOT, "--mission", file, "--json"])
            .assert_done()
            .json();
        assert_eq!(by_file["front"], by_flags["front"]);
        let text = std::fs::read_to_string(file).unwrap();
        let is_near = file.starts_with(folder.path("").to_str().unwrap());
        assert_eq!(text.contains("soil = \"own.toml\""), is_near, "{text}");
    }
    let unsaid = folder.path("no.toml");
    let flags = [
        "design",
        ROBOT,
        "--soil",
        "dry-sand",
        "--slope-deg",
        "0",
        "--k-shear-m",
        "0.02",
    ];
    let refused = grouser(
        flags
            .into_iter()
            .chain(["--write-mission", unsaid.to_str().unwrap()]),
    );
    refused.assert_refused("--write-mission beside --k-shear-m");
    assert!(
        refused.err.contains("`--k-shear-m`") && !unsaid.exists(),
        "{}",
        refused.err
    );
}

#[test]
fn what_makes_no_mission_is_refused() {
    let refused = |flags: &[&str], says: &str| {
        let run = grouser(["design", ROBOT].iter().chain(flags));
        run.assert_refused(says);
        assert!(run.err.contains(says), "{says}: {}", run.err);
    };
    let sand = ["--soil", "dry-sand"];
    let with = |flags: &[&'static str]| [&sand[..], flags].concat();
    refused(&["--slope-deg", "0"], "no soil");
    refused(&sand, "no slope");
    refused(
        &with(&["--slope-deg", "0=0.5,5=0.4"]),
        "sum of the shares of slopes",
    );
    refused(&with(&["--slope-deg", "0=0.5,5"]), "all or none");
    refused(&with(&["--slope-deg", "75"]), "60");
    refused(&with(&["--slope-deg", "-5"]), "-5");
    refused(
        &with(&["--slope-deg", "0", "--radius-m", "nan"]),
        "--radius-m",
    );
    refused(
        &with(&["--slope-deg", "0", "--width-m", "0.2:0.1"]),
        "must not fall",
    );
    refused(
        &with(&["--slope-deg", "0", "--radius-m", "0.15", "--width-m", "0.1"]),
        "nothing is left",
    );
    refused(
        &with(&["--slope-deg", "0", "--wheel-mass-kg", "radius"]),
        "radius",
    );
    refused(
        &with(&["--slope-deg", "0", "--wheel-mass-kg", "0 - width_m"]),
        "kg",
    );
    refused(
        &with(&["--slope-deg", "0", "--grouser-height-m", "0.01"]),
        "--grouser-count",
    );
    refused(
        &with(&[
            "--slope-deg",
            "0",
            "--grouser-count",
            "2.5",
            "--grouser-height-m",
            "0.01",
        ]),
        "whole",
    );
    refused(
        &with(&["--slope-deg", "0", "--max-slip", "1.2"]),
        "max_slip",
    );
    refused(&["--soil", "dry-sad", "--slope-deg", "0"], "dry-sad");
    refused(
        &["--soil", "dry-sand,dry-sand", "--slope-deg", "0"],
        "named twice",
    );
}

#[test]
fn what_no_wheel_holds_ends_with_3_and_the_nearest() {
    let folder = Folder::new();
    let robot = folder.path("new.toml");
    let flags = [
        "design",
        ROBOT,
        "--soil",
        "dry-sand",
        "--slope-deg",
        "30",
        "--points",
        "2",
        "--json",
    ];
    let flags = flags
        .iter()
        .copied()
        .chain(["--write-robot", robot.to_str().unwrap()]);
    let said = grouser(flags);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(
        said.err.contains("no wheel within the bounds"),
        "{}",
        said.err
    );
    let object = said.json();
    assert!(object["chosen"].is_null() && object["front"].as_array().unwrap().is_empty());
    assert!(number(&object["nearest"], "least_reserve") < 0.05);
    assert!(!robot.exists(), "a wheel that does not hold was written");
}

#[test]
fn the_problem_goes_on_in_optimize() {
    let folder = Folder::new();
    let problem = folder.path("wheel.toml");
    let made = design(&["--problem", problem.to_str().unwrap()]);
    let text = std::fs::read_to_string(&problem).unwrap();
    // At the wheel's slip the problem has the design's energy: a quarter of the robot's.
    let station = &made["chosen"]["stations"][1];
    let slip = number(station, "slip");
    assert!(
        text.contains(&format!("\"slip\" = {{ start = {slip:?}")),
        "{text}"
    );
    // `optimize` reads it and finds its front; a smaller search is enough here.
    let quick = text
        .replace("generations = ", "generations = 3 # ")
        .replace("population = ", "population = 8 # ");
    std::fs::write(&problem, quick).unwrap();
    let solved = grouser(["optimize", problem.to_str().unwrap(), "--json"])
        .assert_done()
        .json();
    assert_eq!(solved["method"], "pareto");
}

/// The page holds the front, and the problem of the chosen wheel.
#[test]
fn a_report_is_a_page_of_the_front() {
    let folder = Folder::new();
    let page = folder.path("wheel.html");
    let made = design(&["--report", page.to_str().unwrap()]);
    let html = std::fs::read_to_string(page).unwrap();
    let shown = super::drive::embedded(&html);
    let mass = number(&made["chosen"], "wheel_mass_kg");
    let knee = usize::try_from(shown["answer"]["knee"].as_u64().unwrap()).unwrap();
    let point = &shown["answer"]["front"][knee]["objectives"];
    assert!((number(point, "wheel_mass_kg") - mass).abs() < 1e-12);
    assert!(number(point, "energy_j_per_m") > 0.0);
    let problem = shown["problem"].as_str().unwrap();
    assert!(
        problem.contains("[objectives]"),
        "the problem of the wheel is missing"
    );
    let refused = grouser(MISSION.iter().chain(&["--report", "wheel.txt"]));
    refused.assert_refused("a report that is no page");
}
