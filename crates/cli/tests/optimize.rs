//! The verbs `optimize` and `paper` from outside: keys, order, exit codes, files, and what bad input gets.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::repository::{Folder, grouser, is_error_alone};

fn json(output: &Output) -> Value {
    let text = std::str::from_utf8(&output.stdout).unwrap();
    assert!(!text.contains("NaN") && !text.contains("inf,"), "{text}");
    serde_json::from_str(text).unwrap()
}

const PAGE: &str = r#"
format = 1
method = "minimax"
[variables]
x1 = { start = 0.1, lower = -10.0, upper = 10.0 }
x2 = { start = 0.1, lower = -10.0, upper = 10.0 }
[objectives]
f1 = "2*x1^2 + x2^2 - 48*x1 - 40*x2 + 304"
f2 = "-x1^2 - 3*x2^2"
f3 = "x1 + 3*x2 - 18"
f4 = "-x1 - x2"
f5 = "x1 + x2 - 8"
[constraints]
g1 = "x1 + 3*x2 <= 18"
"#;

fn keys(object: &Value) -> Vec<&str> {
    let object = object.as_object().unwrap();
    object.keys().map(String::as_str).collect()
}

#[test]
fn every_key_of_the_contract_is_there_in_the_order_of_the_file() {
    let folder = Folder::new("optimize-keys");
    // every variable has both bounds: eight starts unless the file says otherwise
    let spread = folder.file("spread.toml", PAGE);
    let spread = json(&grouser(&["optimize", &spread, "--json"]));
    assert_eq!(spread["starts"].as_array().unwrap().len(), 8);
    assert_eq!(spread["provenance"]["seed"], 1);
    let problem = folder.file("page.toml", PAGE.replace("method", "starts = 1\nmethod"));
    let output = grouser(&["optimize", &problem, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    for key in [
        "status",
        "x",
        "objectives",
        "max",
        "objective_multipliers",
        "constraint_multipliers",
        "active",
        "kkt",
        "iterations",
        "values",
        "jacobians",
        "starts",
        "front",
        "attainment",
        "provenance",
    ] {
        assert!(found.get(key).is_some(), "{key}");
    }
    assert_eq!(found["status"], "converged");
    assert_eq!(keys(&found["x"]), ["x1", "x2"]);
    assert_eq!(keys(&found["objectives"]), ["f1", "f2", "f3", "f4", "f5"]);
    assert_eq!(keys(&found["constraint_multipliers"]), ["g1"]);
    assert!((found["x"]["x1"].as_f64().unwrap() - 4.0).abs() < 1e-6);
    assert!(found["max"].as_f64().unwrap().abs() < 1e-6);
    let shares = found["objective_multipliers"].as_object().unwrap();
    let sum: f64 = shares.values().map(|v| v.as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-12);
    assert_eq!(found["starts"].as_array().unwrap().len(), 1);
    assert_eq!(keys(&found["starts"][0]), ["x", "max", "utility", "status"]);
    assert!(found["front"].is_null() && found["attainment"].is_null());
    assert!(found["provenance"]["seed"].is_null());
}

#[test]
fn text_says_what_binds_and_what_it_costs() {
    let output = grouser(&["optimize", "examples/problems/dry-sand-wheel.toml"]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    for words in [
        "upper bound 0.25",
        "active",
        "attainment factor γ",
        "1 % better `efficiency` costs",
    ] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

/// The objective that decides is compared with its scale and shown without; one without a value is said to have none.
#[test]
fn text_and_json_name_the_objective_that_decides() {
    let folder = Folder::new("optimize-deciding");
    let head = "method = \"minimax\"\n[variables]\nx = { start = 0.2, lower = 0.0, upper = 1.0 }\n[objectives]\n";
    let scaled = folder.file(
        "scaled.toml",
        format!(
            "{head}cost = {{ expr = \"100 + x\", scale = 0.001 }}\nloss = \"(x - 0.7)^2 + 0.5\"\n"
        ),
    );
    let text = grouser(&["optimize", &scaled]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("worst objective `loss` 0.5 (utility with scales 0.5)\n"),
        "{text}"
    );
    let found = json(&grouser(&["optimize", &scaled, "--json"]));
    assert_eq!(found["deciding"], "loss");
    assert!((found["max"].as_f64().unwrap() - 0.5).abs() < 1e-6);
    assert!((found["starts"][0]["utility"].as_f64().unwrap() - 0.5).abs() < 1e-6);

    let nowhere = folder.file("nowhere.toml", format!("{head}a = \"ln(-1 - x)\"\n"));
    let output = grouser(&["optimize", &nowhere]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("worst objective `a` no value"), "{text}");
    assert!(!text.contains("NaN"), "{text}");
}

#[test]
fn a_front_with_its_knee_as_json_table_and_figure() {
    let folder = Folder::new("optimize-front");
    let (table, figure, picture) = (
        folder.path("f.csv"),
        folder.path("f.svg"),
        folder.path("f.png"),
    );
    let problem = "examples/problems/pull-against-torque.toml";
    let output = grouser(&[
        "optimize", problem, "--json", "-o", &table, "-o", &figure, "-o", &picture,
    ]);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    let front = found["front"].as_array().unwrap();
    assert!(front.len() > 40);
    assert_eq!(keys(&front[0]["objectives"]), ["pull_lost", "torque"]);
    assert!(found["provenance"]["seed"] == 1);
    let knee = usize::try_from(found["knee"].as_u64().unwrap()).unwrap();
    assert_eq!(found["x"], front[knee]["x"]);
    let table = fs::read_to_string(table).unwrap();
    assert_eq!(table.lines().count(), front.len() + 1);
    assert!(table.starts_with("radius_m,width_m,slip,pull_lost,torque,knee\n"));
    assert!(fs::read_to_string(figure).unwrap().starts_with("<svg"));
    assert!(fs::read(picture).unwrap().starts_with(b"\x89PNG"));
    // The same again, to the bit.
    assert_eq!(
        json(&grouser(&["optimize", problem, "--json"]))["front"],
        found["front"]
    );
}

#[test]
fn no_result_is_exit_1_with_its_json() {
    let folder = Folder::new("optimize-infeasible");
    let problem = folder.file(
        "p.toml",
        "method = \"minimax\"\n[variables]\nx = { start = 5.0 }\n[objectives]\nf = \"x\"\n[constraints]\nlow = \"x <= 1\"\nhigh = \"x >= 3\"\n",
    );
    let output = grouser(&["optimize", &problem, "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let found = json(&output);
    assert_eq!(found["status"], "no_feasible_point");
    let sum: f64 = found["violated"]
        .as_object()
        .unwrap()
        .values()
        .map(|v| v.as_f64().unwrap())
        .sum();
    assert!((sum - 2.0).abs() < 1e-6);
    assert!(
        String::from_utf8(output.stderr)
            .unwrap()
            .contains("`low` by")
    );
    for (text, status) in [
        ("f = \"-x^3\"", "unbounded"),
        ("f = \"ln(x - 9)\"", "not_finite"),
    ] {
        let problem = folder.file(
            "q.toml",
            format!(
                "method = \"minimax\"\n[variables]\nx = {{ start = 5.0 }}\n[objectives]\n{text}\n"
            ),
        );
        let output = grouser(&["optimize", &problem, "--json"]);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert_eq!(json(&output)["status"], status);
    }
}

#[test]
fn bad_problems_are_exit_2_and_leave_nothing() {
    let folder = Folder::new("optimize-bad");
    let missing = folder.path("none.toml");
    let broken = folder.file("broken.toml", "method = ");
    let unknown = folder.file("unknown.toml", PAGE.replace("x1 + x2 - 8", "x1 + x3 - 8"));
    let deep = folder.file(
        "deep.toml",
        PAGE.replace(
            "x1 + x2 - 8",
            &format!("{}x1{}", "(".repeat(300), ")".repeat(300)),
        ),
    );
    let starts = folder.file(
        "starts.toml",
        PAGE.replace("method", "starts = 5\nmethod")
            .replace(", upper = 10.0", ""),
    );
    for (problem, message) in [
        (&missing, "none.toml"),
        (&broken, "broken.toml:1:"),
        (&unknown, "column 6: nothing is called `x3`"),
        (&deep, "column 201: parentheses nest deeper than 200"),
        (&starts, "needs finite ones"),
    ] {
        let table = folder.path("out.csv");
        let output = grouser(&["optimize", problem, "--json", "-o", &table]);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{printed}");
        assert!(is_error_alone(&output));
        assert!(
            printed.starts_with("error: ") && printed.contains(message),
            "{printed}"
        );
        assert!(!Path::new(&table).exists());
    }
}

#[test]
fn the_paper_is_written_and_its_slip_is_not_claimed() {
    let folder = Folder::new("optimize-paper");
    let target = folder.path("out");
    let output = grouser(&["paper", "-o", &target, "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    assert_eq!(found["printed_slip_claimed"], false);
    let verdicts: Vec<&str> = found["statements"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s["verdict"].as_str().unwrap())
        .collect();
    for verdict in ["reproduced", "reproduced in part", "not possible"] {
        assert!(verdicts.contains(&verdict), "{verdict}");
    }
    for file in found["files"].as_array().unwrap() {
        let path = Path::new(&target).join(file.as_str().unwrap());
        assert!(fs::metadata(&path).unwrap().len() > 0, "{}", path.display());
    }
    // Figure 9 against another program: r = 70 mm, z = 10 and 30 mm at 32 degrees, one outside the contact.
    let table = fs::read_to_string(Path::new(&target).join("figure-9.csv")).unwrap();
    let near = |line: &str, z: f64| -> (f64, bool) {
        table
            .lines()
            .filter(|row| row.starts_with(line))
            .map(|row| row.split(',').collect::<Vec<_>>())
            .map(|cells| {
                (
                    cells[1].parse::<f64>().unwrap(),
                    cells[2].parse::<f64>().unwrap(),
                    cells[4] == "true",
                )
            })
            .min_by(|a, b| (a.0 - z).abs().total_cmp(&(b.0 - z).abs()))
            .map(|(_, slip, inside)| (slip, inside))
            .unwrap()
    };
    let (slip, inside) = near("r = 70 mm", 10.0);
    assert!((slip + 0.1729).abs() < 2e-3 && !inside, "{slip}");
    let (slip, inside) = near("r = 70 mm", 30.0);
    assert!((slip + 0.3897).abs() < 2e-3 && inside, "{slip}");
    let page = fs::read_to_string(Path::new(&target).join("paper.html")).unwrap();
    assert!(page.contains("not claimed") && page.contains("figure-10.svg"));
    // The run on sand: five powered wheels drive and brake, and the errors that are printed are those of the table.
    let table = fs::read_to_string(Path::new(&target).join("figure-13.csv")).unwrap();
    let wheels = found["sand_run"]["wheels"].as_array().unwrap();
    assert_eq!(wheels.len(), 5);
    for wheel in wheels {
        let name = wheel["wheel"].as_str().unwrap();
        let rows: Vec<Vec<&str>> = table
            .lines()
            .map(|row| row.split(',').collect::<Vec<_>>())
            .filter(|cells| cells[1] == name)
            .collect();
        assert_eq!(rows.len() as u64, wheel["rows"].as_u64().unwrap());
        let number = |cells: &[&str], place: usize| cells[place].parse::<f64>().ok();
        let both: Vec<[f64; 2]> = rows
            .iter()
            .filter_map(|cells| Some([number(cells, 2)?, number(cells, 5)?]))
            .collect();
        let square: f64 = both
            .iter()
            .map(|[slip, truth]| (slip - truth).powi(2))
            .sum();
        let rmse = (square / both.len() as f64).sqrt();
        let printed = wheel["slip_rmse"].as_f64().unwrap();
        assert!((rmse - printed).abs() < 1e-9, "{name}: {rmse} {printed}");
        assert!(both.len() > 1000 && rmse < 0.15, "{name}: {rmse}");
        assert!(wheel["coverage_90"].as_f64().unwrap() > 0.8, "{name}");
        for cells in &rows {
            let slip = number(cells, 2).unwrap();
            if let (Some(low), Some(high)) = (number(cells, 3), number(cells, 4)) {
                assert!(low <= slip && slip <= high, "{cells:?}");
            }
            if let Some(worded) = number(cells, 6) {
                assert!(worded <= 1.0 && (worded > 0.0) == (slip < 0.0), "{cells:?}");
            }
        }
        for is in [(|slip| slip > 0.2) as fn(f64) -> bool, |slip| slip < -0.05] {
            let both = both.iter().filter(|row| row.iter().all(|slip| is(*slip)));
            assert!(both.count() > 20, "{name}");
        }
    }
    let optima: Vec<f64> = found["optima"]
        .as_array()
        .unwrap()
        .iter()
        .map(|optimum| optimum["slip"].as_f64().unwrap())
        .collect();
    assert_eq!((optima.len(), optima[0]), (4, 0.1146));
    assert!(optima[1] < optima[2] && optima[2] < optima[3], "{optima:?}");
    // Each reading that is written is a problem that can be solved.
    let reading = Path::new(&target).join("problem-as-printed-in-pa.toml");
    assert_eq!(
        grouser(&["optimize", reading.to_str().unwrap()])
            .status
            .code(),
        Some(0)
    );
    // A file in the folder's place is refused.
    let taken = folder.file("taken", "");
    assert_eq!(grouser(&["paper", "-o", &taken]).status.code(), Some(2));
}

/// From the model to the decisions: every step is done, the setpoint is proved, the pulses of the free wheel are in the log, the
/// soil that is learnt from it is the ground's, and the page stands alone.
#[test]
fn the_papers_robot_goes_from_end_to_end() {
    let folder = Folder::new("paper-end-to-end");
    let (target, page) = (folder.path("out"), folder.path("page.html"));
    let words = [
        "paper",
        "--end-to-end",
        "-o",
        &target,
        "--report",
        &page,
        "--json",
    ];
    let output = grouser(&words);
    assert_eq!(output.status.code(), Some(0));
    let found = json(&output);
    let steps = found["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 6);
    for step in steps {
        assert_eq!(step["exit_code"], 0, "{step}");
    }
    assert_eq!(found["certificate"], "proved");
    let setpoint = found["slip_setpoint"].as_f64().unwrap();
    let scenario = fs::read_to_string(Path::new(&target).join("scenario.toml")).unwrap();
    assert!(
        scenario.contains(&format!("optimum = {setpoint:?}")),
        "{scenario}"
    );
    let info = grouser(&["log", "info", &format!("{target}/drive.mcap")]);
    assert!(String::from_utf8_lossy(&info.stdout).contains("/wheel_edges"));
    assert_eq!(found["wheels"].as_array().unwrap().len(), 5);
    let soil = &found["soil_learnt"];
    let of = |key: &str| soil[key].as_f64().unwrap();
    assert!(
        of("strength_low") < 1.0 && 1.0 < of("strength_high"),
        "{soil}"
    );
    assert!(
        of("stiffness_low") < 1.0 && 1.0 < of("stiffness_high"),
        "{soil}"
    );
    assert_eq!(found["run_on_sand"]["energy_gain"], "no gain");
    let patch = &found["soft_patch"];
    assert_eq!(
        (&patch["controller_arrives"], &patch["open_loop_arrives"]),
        (&5.into(), &0.into())
    );
    assert!(found["decisions"].as_u64().unwrap() > 5);
    let page = fs::read_to_string(&page).unwrap();
    assert!(page.contains("data:image/svg+xml,") && !page.contains("src=\"figure"));
    for table in [
        "slip.csv",
        "figure-13.csv",
        "decisions.csv",
        "soil.csv",
        "model.csv",
    ] {
        let text = fs::read_to_string(Path::new(&target).join(table)).unwrap();
        assert!(text.lines().count() > 5, "{table}");
    }
    let refused = grouser(&["paper", "-o", &target, "--report", "page.html"]);
    assert_eq!(refused.status.code(), Some(2));
}

#[test]
fn a_certificate_is_proved_refused_or_doubtful() {
    let folder = Folder::new("optimize-certificate");
    let proof = folder.path("proof.jsonl");
    let proved = grouser(&[
        "optimize",
        "examples/problems/paper.toml",
        "--certify",
        "1e-6",
        "--proof",
        &proof,
        "--json",
    ]);
    assert_eq!(proved.status.code(), Some(0));
    let object = json(&proved);
    let certificate = &object["certificate"];
    assert_eq!(certificate["status"], "proved");
    // the local solver's utility lies between the proved bounds
    let utility = object["utility"].as_f64().unwrap();
    let gap = certificate["gap"].as_f64().unwrap();
    assert!((0.0..=1.06e-6).contains(&gap), "{gap}");
    assert!(certificate["lower"].as_f64().unwrap() <= utility);
    assert!(utility <= certificate["upper"].as_f64().unwrap() + 1e-9);
    assert!(fs::read_to_string(proof).unwrap().lines().count() > 100);

    let unreached = grouser(&[
        "optimize",
        "examples/problems/paper.toml",
        "--certify",
        "1e-6",
        "--certify-time",
        "0",
        "--json",
    ]);
    assert_eq!(unreached.status.code(), Some(3));
    assert_eq!(json(&unreached)["certificate"]["status"], "time_limit");

    let text = "format = 1\nmethod = \"minimax\"\n[variables]\n\
        x = { start = 1.0, lower = 0.0, upper = 2.0 }\n[objectives]\nf = \"x^2\"\n\
        [constraints]\nfar = \"x^3 >= 9\"\n";
    let nowhere = folder.file("nowhere.toml", text);
    let infeasible = grouser(&["optimize", &nowhere, "--certify", "--json"]);
    assert_eq!(infeasible.status.code(), Some(1));
    assert_eq!(json(&infeasible)["certificate"]["status"], "infeasible");

    let running = grouser(&[
        "optimize",
        "examples/problems/running-slip.toml",
        "--certify",
        "--json",
    ]);
    assert_eq!(running.status.code(), Some(0));
    assert_eq!(json(&running)["certificate"]["status"], "proved");
    assert_eq!(json(&running)["certificate"]["remainder"], 1e-8);
    assert_eq!(json(&running)["certificate"]["remainder_is_proved"], true);

    // a kink stops the local search at a point that the proof shows to be the best
    let kinky = "crates/design/tests/problems/kinky4.toml";
    let stalled = grouser(&["optimize", kinky, "--json"]);
    assert_eq!(stalled.status.code(), Some(1));
    assert_eq!(json(&stalled)["status"], "stalled");
    let proved = grouser(&["optimize", kinky, "--certify", "--json"]);
    assert_eq!(proved.status.code(), Some(0));
    assert_eq!(json(&proved)["certificate"]["status"], "proved");

    let over_slip = folder.file(
        "over_slip.toml",
        "format = 1\nmethod = \"minimax\"\n[variables]\n\
         radius_m = { start = 0.1, lower = 0.05, upper = 0.2 }\n[wheel]\nwidth_m = 0.1\n\
         [soil]\nkey = \"dry-sand\"\n[state]\nload_n = 60.0\n\
         [objectives]\npull = \"-max_drawbar_pull_n\"\n",
    );
    for (arguments, reason) in [
        ([over_slip.as_str(), "--certify"], "no bounds over a box"),
        (
            [
                "examples/problems/pull-against-torque.toml",
                "--certify=1e-4",
            ],
            "for a front",
        ),
        (["examples/problems/paper.toml", "--certify=0"], "--certify"),
    ] {
        let refused = grouser(&["optimize", arguments[0], arguments[1], "--json"]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(is_error_alone(&refused));
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(message.contains(reason), "{message}");
    }
}

/// A convex front: both texts and JSON have objectives in the signs of the file, and the log is one of several proofs.
#[test]
fn a_front_is_certified_in_the_signs_of_the_file() {
    let folder = Folder::new("optimize-front-certificate");
    let problem = folder.file(
        "front.toml",
        "format = 1\nmethod = \"pareto\"\n[variables]\nx = { start = 1.0, lower = 0.0, upper = 3.0 }\n\
         [objectives]\ngain = { maximise = \"4 - x^2\" }\ncost = \"(x - 2)^2\"\n\
         [pareto]\npopulation = 12\ngenerations = 10\n",
    );
    let log = folder.path("proof.jsonl");
    let figure = folder.path("front.svg");
    let output = grouser(&[
        "optimize",
        &problem,
        "--certify",
        "--proof",
        &log,
        "--json",
        "-o",
        &figure,
    ]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let object = json(&output);
    assert!(object["certificate"].is_null());
    let front = &object["front_certificate"];
    assert_eq!(front["status"], "proved");
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!(number(&front["share"]) <= 0.05);
    let by = |key: &str| number(&front["tolerance"][key]);
    // between x = 0 and 2 the front is known: no point of it is better than a listed one by more than the tolerance
    for i in 0..=200 {
        let x = 0.01 * f64::from(i);
        let (gain, cost) = (4.0 - x * x, (x - 2.0) * (x - 2.0));
        let listed = front["points"].as_array().unwrap().iter();
        let is_near = |p: &serde_json::Value| {
            let (own_gain, own_cost) = (
                number(&p["objectives"]["gain"]),
                number(&p["objectives"]["cost"]),
            );
            assert!((own_gain - (4.0 - number(&p["x"]["x"]).powi(2))).abs() < 1e-9);
            own_gain >= gain - by("gain") && own_cost <= cost + by("cost")
        };
        assert!(listed.clone().any(is_near), "{x}");
        let is_below = |c: &serde_json::Value| {
            gain <= number(&c["objectives"]["gain"]) && cost >= number(&c["objectives"]["cost"])
        };
        assert!(
            front["corners"].as_array().unwrap().iter().any(is_below),
            "{x}"
        );
    }
    let logs = fs::read_to_string(&log).unwrap();
    let begun = logs
        .lines()
        .filter(|line| line.contains("grouser-certificate"))
        .count();
    assert_eq!(begun as u64, front["proofs"].as_u64().unwrap());
    assert!(fs::read_to_string(figure).unwrap().contains("proved"));
    let checked = std::process::Command::new("python3")
        .args([
            concat!(env!("CARGO_MANIFEST_DIR"), "/../../checker/check.py"),
            &log,
        ])
        .output();
    match checked {
        Ok(checked) => {
            let said = String::from_utf8_lossy(&checked.stdout).into_owned();
            assert!(checked.status.success(), "{said}");
            let corners = front["corners"].as_array().unwrap().len();
            assert!(
                said.contains(&format!("proved: {corners} corners")),
                "{said}"
            );
        }
        Err(_) => println!("not replayed: no python3"),
    }
    let printed = grouser(&["optimize", &problem, "--certify", "0.1"]);
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert!(
        printed.contains("proved: for any point of the box") && printed.contains("in `gain`"),
        "{printed}"
    );
}

/// What is maximised has its own sign, also in what is proved about it.
#[test]
fn maximised_objectives_keep_their_sign() {
    let file = "examples/problems/running-slip.toml";
    let printed = grouser(&["optimize", file, "--certify"]);
    let printed = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert!(
        printed.contains("has `efficiency` above 0.154979"),
        "{printed}"
    );
    assert!(!printed.contains("-0.15"), "{printed}");
    let object = json(&grouser(&["optimize", file, "--json"]));
    assert!((object["max"].as_f64().unwrap() - 0.154_977_576).abs() < 1e-8);
    assert!(object["starts"][0]["max"].as_f64().unwrap() > 0.15);
}

/// The optimum is a kink that no step of a search ends at by its own conditions; the start is near it.
#[test]
fn the_best_feasible_point_that_was_evaluated_is_the_answer() {
    let folder = Folder::new("optimize-kink");
    let kink = "format = 1\nmethod = \"minimax\"\n[variables]\nx = { start = -0.9, lower = -4.0, upper = 5.0 }\n\
        [objectives]\nf = \"min(abs(x + 1), (x - 2)^2 + 0.5)\"\n";
    for starts in ["", "starts = 1\n"] {
        let problem = folder.file("kink.toml", format!("{starts}{kink}"));
        let found = json(&grouser(&["optimize", &problem, "--json"]));
        assert!(found["max"].as_f64().unwrap() < 1e-6, "{found}");
        assert!(
            (found["x"]["x"].as_f64().unwrap() + 1.0).abs() < 1e-6,
            "{found}"
        );
    }
}

/// A search that ends in the higher of two smooth valleys: the proof finds the other one, which is no kink.
#[test]
fn the_better_point_of_a_proof_is_a_solution() {
    let folder = Folder::new("optimize-valleys");
    for (f, expected) in [
        ("(x^2 - 1)^2 - 0.1*x", -0.100_616_9),
        ("(x - 1.3)^2 * ((x + 1)^2 + 0.001)", 0.0),
    ] {
        let text = format!(
            "format = 1\nmethod = \"minimax\"\nstarts = 1\n[variables]\n\
             x = {{ start = -1.05, lower = -2.0, upper = 2.0 }}\n[objectives]\nf = \"{f}\"\n"
        );
        let problem = folder.file("valleys.toml", text);
        let found = json(&grouser(&["optimize", &problem, "--json"]));
        assert!(found["x"]["x"].as_f64().unwrap() < 0.0, "{found}");
        let proved = grouser(&["optimize", &problem, "--certify", "--json"]);
        let object = json(&proved);
        assert_eq!(proved.status.code(), Some(0), "{object}");
        assert_eq!(object["certificate"]["status"], "proved", "{object}");
        assert_ne!(object["status"], "stalled", "{object}");
        let off = object["max"].as_f64().unwrap() - expected;
        assert!(off.abs() < 1e-6, "{object}");
    }
}

/// Waves over six variables with no point where all of them are lowest, so that no search of seconds closes the gap. The start is
/// near the lowest optimum of 300 starts: the local search converges, and the proof finds nothing better.
#[test]
fn a_proof_keeps_its_limits_and_holds_the_text_of_its_problem() {
    let folder = Folder::new("optimize-limits");
    let mut text = "format = 1\nmethod = \"minimax\"\nstarts = 1\n[variables]\n".to_owned();
    let starts = [1.4, 1.1, 1.46, 1.57, -0.97, -1.06];
    for (name, start) in ["a", "b", "c", "d", "e", "g"].into_iter().zip(starts) {
        writeln!(
            text,
            "{name} = {{ start = {start}, lower = -4.0, upper = 4.0 }}"
        )
        .unwrap();
    }
    text += "[objectives]\nf = \"sin(3*a*b) + cos(b*c + d) + sin(2*c*d) + sin(d*e) + cos(3*e*g) + sin(g*a) \
        + (a^2 + b^2 + c^2 + d^2 + e^2 + g^2) / 8\"\n";
    let problem = folder.file("waves.toml", &text);
    let log = folder.file("log.jsonl", "");
    std::fs::remove_file(&log).unwrap();
    let of = |limits: &[&str]| {
        let arguments = ["optimize", &problem, "--certify", "1e-9", "--json"];
        let output = grouser(&[&arguments[..], limits].concat());
        assert_eq!(output.status.code(), Some(3));
        json(&output)["certificate"]["status"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    assert_eq!(of(&["--certify-memory-mb", "0.1"]), "memory_limit");
    assert_eq!(
        of(&["--proof", &log, "--proof-size-mb", "0.1"]),
        "proof_limit"
    );
    let proof = fs::read_to_string(&log).unwrap();
    assert!((50_000..=100_000).contains(&proof.len()), "{}", proof.len());
    let head: Value = serde_json::from_str(proof.lines().next().unwrap()).unwrap();
    assert_eq!(head["problem"]["text"], text);
    let checker = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../checker/check.py");
    let mut python = std::process::Command::new("python3");
    let Ok(run) = python
        .arg(checker)
        .args(["--problem", &problem, &log])
        .output()
    else {
        println!("skipped: no python3");
        return;
    };
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(said.starts_with("accepted: proof_limit"), "{said}");
}
