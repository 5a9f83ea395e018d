//! `identify` and `validate`: the shipped example against its truth, the soil file through other verbs, and what is
//! refused.

use std::fs;
use std::path::{Path, PathBuf};

use crate::repository::{Folder, grouser, is_error_alone, root};

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = grouser(arguments);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The example was made by another program from `truth.toml`: each number lies in its interval, or near it where
/// chance has put it outside (five of a hundred do).
#[test]
fn the_example_gives_back_what_it_was_made_of() {
    let folder = Folder::new("identify-bevameter");
    let (soil, figure) = (folder.path("sand.toml"), folder.path("residuals.svg"));
    let found = json(&[
        "identify",
        "examples/bevameter/tests.toml",
        "-o",
        &soil,
        "--figure",
        &figure,
        "--json",
    ]);
    assert!(fs::read_to_string(&figure).unwrap().starts_with("<svg"));
    let near = |numbers: &serde_json::Value, key: &str, truth: f64| {
        let number = &numbers[key];
        let value = |name: &str| number[name].as_f64().unwrap();
        let (low, high) = (value("low"), value("high"));
        let half = 0.5 * (high - low);
        assert!(
            low - half < truth && truth < high + half,
            "{key}: {number}, truth {truth}"
        );
        assert_eq!(number["verdict"], "identified", "{key}");
        // and the interval says something
        assert!(half < 0.5 * truth.abs(), "{key}: {number}");
    };
    near(&found["plates"]["parameters"], "n", 1.25);
    for (key, truth) in [("phi_deg", 30.963_756), ("k_shear_m", 0.012)] {
        near(&found["shear"], key, truth);
    }
    let wheel = &found["wheel"];
    assert_eq!(wheel["missing"], serde_json::Value::Null);
    for (key, truth) in [("c_1", 0.35), ("c_2", 0.25), ("sinkage_datum_m", 0.003)] {
        near(&wheel["parameters"], key, truth);
    }
    // noise of 0.4 N, 0.03 N m and 0.4 mm was put in: no more and hardly less is left
    for (key, sigma) in [("pull_n", 0.4), ("torque_nm", 0.03), ("sinkage_mm", 0.4)] {
        let rmse = wheel["rmse"][key].as_f64().unwrap();
        assert!(rmse > 0.5 * sigma && rmse < 1.5 * sigma, "{key}: {rmse}");
    }
    // the soil file through another verb, beside the truth through the same: 24 tests tell the pull to 0.3 N
    let pull = |soil: &str| {
        let point = json(&[
            "wheel",
            "--soil",
            soil,
            "--radius-m",
            "0.1",
            "--width-m",
            "0.06",
            "--load-n",
            "60",
            "--slip",
            "0.25",
            "--json",
        ]);
        point["drawbar_pull_n"].as_f64().unwrap()
    };
    let (ours, truth) = (pull(&soil), pull("examples/bevameter/truth.toml"));
    assert!((ours - truth).abs() < 0.3, "{ours} {truth}");
}

#[test]
fn what_the_tests_cannot_tell_is_named() {
    let folder = Folder::new("identify-untold");
    let shear: Vec<String> = fs::read_to_string(root().join("examples/bevameter/shear.csv"))
        .unwrap()
        .lines()
        .filter(|line| line.starts_with("normal") || line.starts_with("7,"))
        .map(str::to_owned)
        .collect();
    fs::write(folder.path("shear.csv"), shear.join("\n")).unwrap();
    let tests = folder.path("tests.toml");
    fs::write(
        &tests,
        "format = 1\nname = \"one load\"\n[shear]\ntable = \"shear.csv\"\n",
    )
    .unwrap();
    let output = grouser(&["identify", &tests]);
    assert!(output.status.success());
    let warnings = String::from_utf8(output.stderr).unwrap();
    assert!(warnings.contains("cohesion_kpa"), "{warnings}");
    // and no soil file can be made of it
    let refused = grouser(&["identify", &tests, "-o", &folder.path("soil.toml")]);
    assert_eq!(refused.status.code(), Some(2));
    let error = String::from_utf8(refused.stderr).unwrap();
    assert!(error.contains("do not determine n"), "{error}");
    assert!(!Path::new(&folder.path("soil.toml")).exists());
}

/// A doubtful soil ends with 3, its doubt in the first line and in JSON, and is written nevertheless.
#[test]
fn a_doubtful_soil_ends_with_3() {
    let folder = Folder::new("identify-doubtful");
    let shear = fs::read_to_string(root().join("examples/bevameter/shear.csv")).unwrap();
    fs::write(folder.path("shear.csv"), shear.replace("\n3,", "\n-3,")).unwrap();
    let tests = folder.path("tests.toml");
    let job = "format = 1\nname = \"a sign\"\n[shear]\ntable = \"shear.csv\"\n[soil]\nn = 1.0\n\
               k_c_kn_per_m_n1 = 1.0\nk_phi_kn_per_m_n2 = 1000.0\n";
    fs::write(&tests, job).unwrap();
    let soil = folder.path("soil.toml");
    let output = grouser(&["identify", &tests, "-o", &soil]);
    assert_eq!(output.status.code(), Some(3), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.lines()
            .nth(1)
            .unwrap()
            .starts_with("WARNING: 50 of 150 shear readings"),
        "{text}"
    );
    assert!(
        fs::read_to_string(&soil)
            .unwrap()
            .contains("WARNING: 50 of 150")
    );
    let output = grouser(&["identify", &tests, "--json"]);
    assert_eq!(output.status.code(), Some(3));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        found["doubts"][0]
            .as_str()
            .unwrap()
            .starts_with("50 of 150"),
        "{found}"
    );
}

/// A shear box that is driven back after each test: the numbers are those without the way back, which is counted.
#[test]
fn ways_back_are_left_out_and_counted() {
    let folder = Folder::new("identify-unloading");
    let shear = fs::read_to_string(root().join("examples/bevameter/shear.csv")).unwrap();
    let mut rows: Vec<String> = shear.lines().map(str::to_owned).collect();
    let mut with = rows.clone();
    for back in (1..=10).rev() {
        // slack of the last test's end, without stress
        let last = rows.last().unwrap().split(',').collect::<Vec<_>>();
        let displacement = 0.1 * f64::from(back) * last[1].parse::<f64>().unwrap();
        with.push(format!("{},{displacement},0", last[0]));
    }
    let tests = folder.path("tests.toml");
    fs::write(
        &tests,
        "format = 1\nname = \"x\"\n[shear]\ntable = \"shear.csv\"\n",
    )
    .unwrap();
    let of = |rows: &mut Vec<String>| {
        fs::write(folder.path("shear.csv"), rows.join("\n")).unwrap();
        json(&["identify", &tests, "--json"])
    };
    let (plain, found) = (of(&mut rows), of(&mut with));
    assert_eq!(
        (&plain["unloading"], &found["unloading"]),
        (&0.into(), &10.into())
    );
    assert_eq!(plain["shear"], found["shear"]);
    let text = String::from_utf8(grouser(&["identify", &tests]).stdout).unwrap();
    assert!(
        text.contains("10 of 160 shear readings left out, in unloading or reloading"),
        "{text}"
    );
}

#[test]
fn bad_jobs_are_refused_with_their_place() {
    let folder = Folder::new("identify-badjobs");
    for (text, expected) in [
        ("format = 1\nname = \"x\"\n", "no [[plate]]"),
        (
            "format = 1\nname = \"x\"\n[shear]\ntabel = \"s.csv\"\n",
            "did you mean `table`?",
        ),
        (
            "format = 1\nname = \"x\"\n[shear]\ntable = \"absent.csv\"\n",
            "absent.csv",
        ),
        (
            "format = 1\nname = \"x\"\n[wheel]\ntable = \"w.csv\"\nradius_m = 0.1\nwidth_m = 0.1\nfit = [\"c_3\"]\n",
            "did you mean \"c_1\"",
        ),
    ] {
        let tests = folder.path("tests.toml");
        fs::write(&tests, text).unwrap();
        let output = grouser(&["identify", &tests, "--json"]);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(is_error_alone(&output));
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn validate_prints_the_rows_it_promises() {
    let base = std::env::var_os("GROUSER_DATA").map_or_else(|| root().join("data"), PathBuf::from);
    let data = root().join(base);
    if !data.join("cmu-wheel/trials.csv").is_file() {
        assert!(
            std::env::var_os("CI").is_none(),
            "no measured data, and CI is set"
        );
        eprintln!("skipped: no measured data (GROUSER_DATA)");
        return;
    }
    let folder = Folder::new("identify-validate");
    let (figure, table) = (folder.path("measured.svg"), folder.path("rows.csv"));
    let found = json(&[
        "validate",
        "--data",
        data.to_str().unwrap(),
        "--figure",
        &figure,
        "-o",
        &table,
        "--json",
    ]);
    let rows = found["rows"].as_array().unwrap();
    for key in [
        "data_set",
        "wheel",
        "slip_angle_deg",
        "quantity",
        "unit",
        "model",
        "split",
        "n",
        "bias",
        "rmse",
        "q75",
        "q99",
        "max",
        "fitted_parameters",
        "published_rmse",
    ] {
        assert!(rows[0].get(key).is_some(), "{key}");
    }
    let lines = fs::read_to_string(&table).unwrap();
    assert_eq!(lines.lines().count(), rows.len() + 1);
    assert!(fs::read_to_string(&figure).unwrap().starts_with("<svg"));
    let digests = found["provenance"]["input_sha256"].as_object().unwrap();
    assert_eq!(digests.len(), 5, "the trials, two bags and two text files");
}
