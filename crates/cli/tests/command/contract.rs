//! What other programs rely on: keys, exit codes, one JSON object, nothing on standard output on error.

use super::program::{Folder, grouser, line};

const WHEEL: &str = "wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --slip 0.2";

#[test]
fn wheel_has_its_keys_and_its_provenance() {
    let said = line(&format!("{WHEEL} --load-n 80 --json")).assert_done();
    let json = said.json();
    for key in [
        "sinkage_m",
        "theta_1_deg",
        "theta_2_deg",
        "theta_m_deg",
        "vertical_force_n",
        "drawbar_pull_n",
        "side_force_n",
        "torque_nm",
        "residual",
        "evaluations",
    ] {
        assert!(json[key].is_number(), "{key}: {json}");
    }
    assert!(json["cautions"].is_array());
    assert!(
        json.as_object()
            .unwrap()
            .contains_key("tractive_efficiency")
    );
    assert!(json.as_object().unwrap().contains_key("energy_j_per_m"));
    assert!((json["vertical_force_n"].as_f64().unwrap() - 80.0).abs() < 1e-9);
    let provenance = json["provenance"].as_object().unwrap();
    let keys: Vec<&String> = provenance.keys().collect();
    let expected = [
        "version",
        "commit",
        "instructions",
        "seed",
        "input_sha256",
        "soil",
    ];
    assert_eq!(keys, expected);
    let instructions = provenance["instructions"].as_str().unwrap();
    assert!(["avx512", "avx2", "portable"].contains(&instructions));
    assert_eq!(provenance["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(provenance["soil"]["key"], "dry-sand");
    assert!(
        provenance["soil"]["source"]
            .as_str()
            .unwrap()
            .contains("rover papers")
    );
    assert_eq!(provenance["soil"]["overrides"], serde_json::json!({}));
    assert!(provenance["seed"].is_null());
    let json = line(&format!("{WHEEL} --load-n 80 --k-shear-m 0.02 --json")).json();
    assert_eq!(
        json["provenance"]["soil"]["overrides"],
        serde_json::json!({"k_shear_m": 0.02})
    );
}

#[test]
fn the_sinkage_found_for_a_load_carries_it() {
    // There and back: the load's sinkage, prescribed as a sinkage, gives the load.
    let there = line(&format!("{WHEEL} --load-n 80 --json")).json();
    let sinkage = there["sinkage_m"].as_f64().unwrap();
    let back = line(&format!("{WHEEL} --sinkage-m {sinkage} --json")).json();
    for key in ["vertical_force_n", "drawbar_pull_n", "torque_nm"] {
        let [a, b] = [&there, &back].map(|json| json[key].as_f64().unwrap());
        assert!((a - b).abs() < 1e-9 * 80.0, "{key}: {a} {b}");
    }
    assert!(back["residual"].is_null());
}

#[test]
fn what_does_not_exist_is_null() {
    // Spinning on the spot: no travel, no energy per metre.
    let spinning =
        "wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 1 --json";
    let json = line(spinning).assert_done().json();
    assert!(json["energy_j_per_m"].is_null(), "{json}");
    assert!(!line(spinning).out.contains("inf"));
}

#[test]
fn no_solution_is_exit_1_with_its_json() {
    let said = line(&format!("{WHEEL} --load-n 1e9 --json"));
    assert_eq!(said.code, Some(1), "{said:?}");
    let json = said.json();
    assert_eq!(json["status"], "no-solution");
    assert!(json["sinkage_m"].is_null() && json["max_load_n"].as_f64().unwrap() > 0.0);
    assert!(
        said.err.starts_with("error: no sinkage carries"),
        "{said:?}"
    );
}

#[test]
fn errors_are_text_and_one_object_under_json() {
    for words in ["wheel", "nothing", "log", WHEEL] {
        let said = line(words);
        said.assert_refused(words);
        assert_eq!(said.out, "", "{words}");
        let said = line(&format!("{words} --json"));
        said.assert_refused(words);
        assert_eq!(said.json()["error"]["kind"], "usage", "{words}");
    }
    line("--json").assert_refused("--json");
    let error = &line(&format!("{WHEEL} --load-n 80 --slip-angle-deg 95 --json")).json()["error"];
    assert_eq!(error["kind"], "value");
    assert_eq!(error["field"], "--slip-angle-deg");
    assert_eq!(error["unit"], "deg");
    for (value, wanted) in [
        (&error["value"], 95.0),
        (&error["limit"][0], -89.9),
        (&error["limit"][1], 89.9),
    ] {
        assert!((value.as_f64().unwrap() - wanted).abs() < 1e-12, "{error}");
    }
    let folder = Folder::new();
    let soil = folder.file("soil.toml", "format = 1\nname = \"sand\"\nn = 99.0\n");
    let words = format!(
        "wheel --soil {} --radius-m 0.1 --width-m 0.1 --load-n 9 --slip 0 --json",
        soil.display()
    );
    let error = &line(&words).json()["error"];
    assert_eq!(error["kind"], "content", "{error}");
    assert_eq!(error["file"], soil.display().to_string());
    assert!(error["line"].is_number(), "{error}");
    let said = line(&format!("{WHEEL} --load-n 80 --rebound -1"));
    assert_eq!(
        said.err,
        "error: `--rebound` is -1, but must lie in [0, 100]\n"
    );
    let said = line("wheel --soil hit-lss1 --radius-m 0.1 --width-m 0.1 --load-n 9 --slip 0");
    assert!(
        said.err
            .starts_with("error: missing `--c-1`, `--c-2` for soil `hit-lss1`"),
        "{said:?}"
    );
}

#[test]
fn negative_values_are_values() {
    let json = line("wheel --soil lunar --radius-m 0.1 --width-m 0.1 --load-n 40 --slip -0.3 --slip-angle-deg -5 --json")
        .assert_done()
        .json();
    assert_eq!(json["slip"], -0.3);
    // Drifting to the right, the soil pushes to the left.
    assert!(json["side_force_n"].as_f64().unwrap() > 0.0);
    let json = line("paper slip-model --theta-deg -5 --sinkage-m 0.01 --radius-m 0.1 --json")
        .assert_done()
        .json();
    assert_eq!(json["theta_deg"], -5.0);
    let json =
        line("wheel --soil lunar --radius-m 0.1 --width-m 0.1 --load-n 40 --slip -1e-6 --json")
            .assert_done()
            .json();
    assert_eq!(json["slip"], -1e-6);
}

#[test]
fn the_slip_model_gives_the_numbers_of_the_model_page() {
    // by another program: θ = 32°.
    // Radius, sinkage, S_0, and whether 32° is less than acos(1 − z/r).
    for (radius, sinkage, slip, inside) in [
        (0.07, 0.01, -0.1729, false),
        (0.07, 0.03, -0.3897, true),
        (0.10, 0.014, -0.1709, false),
        (0.18, 0.03, -0.1894, true),
    ] {
        let words = format!(
            "paper slip-model --theta-deg 32 --sinkage-m {sinkage} --radius-m {radius} --json"
        );
        let json = line(&words).assert_done().json();
        assert!(
            (json["slip"].as_f64().unwrap() - slip).abs() < 5e-5,
            "{json}"
        );
        assert_eq!(
            json["slip_magnitude"].as_f64(),
            json["slip"].as_f64().map(f64::abs)
        );
        assert!(json["theta_1_deg"].is_number());
        assert_eq!(json["in_contact"], inside, "{json}");
        assert_eq!(json["cautions"].as_array().unwrap().is_empty(), inside);
    }
}

#[test]
fn the_catalogue_keeps_its_order_and_names_its_sources() {
    let json = line("soils --json").assert_done().json();
    let soils = json["soils"].as_object().unwrap();
    let keys: Vec<&str> = soils.keys().map(String::as_str).take(3).collect();
    assert_eq!(keys, ["dry-sand", "sandy-loam", "clayey-soil"]);
    assert!(
        soils
            .values()
            .all(|soil| !soil["source"].as_str().unwrap().is_empty())
    );
    assert_eq!(
        soils["hit-lss1"]["missing"],
        serde_json::json!(["c_1", "c_2"])
    );
}

#[test]
fn a_soil_file_is_read_hashed_and_completed() {
    let folder = Folder::new();
    let text = "format = 1\nname = \"bed\"\nsource = \"ours\"\nn = 1.1\nk_c_kn_per_m_n1 = 0.9\n\
                k_phi_kn_per_m_n2 = 1528.4\ncohesion_kpa = 1.0\nphi_deg = 30.0\n";
    let path = folder.file("bed.toml", text);
    let words = |rest: &str| {
        let mut words: Vec<String> = ["wheel", "--soil"].map(str::to_owned).to_vec();
        words.push(path.to_str().unwrap().to_owned());
        let rest = format!("--radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2 --json {rest}");
        words.extend(rest.split_whitespace().map(str::to_owned));
        words
    };
    grouser(words("")).assert_refused("incomplete");
    let said = grouser(words("--k-shear-m 0.025 --c-1 0.18 --c-2 0.32")).assert_done();
    let json = said.json();
    // The same numbers as the catalogue's dry sand, so the same answer to the last bit.
    let own = line(&format!("{WHEEL} --load-n 80 --json")).json();
    assert_eq!(json["sinkage_m"], own["sinkage_m"]);
    assert_eq!(json["provenance"]["soil"]["source"], "ours");
    // sha256sum of the text above
    let hashes = json["provenance"]["input_sha256"].as_object().unwrap();
    assert_eq!(hashes.len(), 1);
    assert_eq!(
        hashes[path.to_str().unwrap()],
        "953af27f92cb02acd0b54526169d1b7d4f59ff46c39b7171a1d27c28bf27c1f9"
    );
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = super::program::start(["soils", "--json"], std::process::Stdio::null());
    drop(child.stdout.take());
    let status = child.wait().unwrap();
    let mut err = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut err).unwrap();
    assert!(status.success() && err.is_empty(), "{status} {err}");
}
