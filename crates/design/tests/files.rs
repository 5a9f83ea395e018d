//! Problem files: what they may say, what they may not, and what the shipped ones give.

use std::path::Path;

use grouser_design::{Answer, Design, Optimum, Task, parse, read};
use grouser_files::Document;
use grouser_opt::Status;

fn design(text: &str) -> Design {
    parse(&Document::from_text("p.toml", text.to_owned()).unwrap())
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn refused(text: &str) -> (String, Option<String>) {
    match parse(&Document::from_text("p.toml", text.to_owned()).unwrap()) {
        Ok(_) => panic!("was read:\n{text}"),
        Err(error) => (error.to_string(), error.hint()),
    }
}

fn optimum(design: &Design) -> Optimum {
    match design.solve().unwrap() {
        Answer::Optimum(optimum) => *optimum,
        other => panic!("{other:?}"),
    }
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6, "{a} instead of {b}");
}

const PAGE: &str = r#"
method = "minimax"
[variables]
x2 = { start = 0.1, lower = -10.0, upper = 10.0 }
x1 = { start = 0.1, lower = -10.0, upper = 10.0 }
[objectives]
f2 = "-x1^2 - 3*x2^2"
f1 = "2*x1^2 + x2^2 - 48*x1 - 40*x2 + 304"
f3 = "x1 + 3*x2 - 18"
f4 = "-x1 - x2"
f5 = "x1 + x2 - 8"
[constraints]
g1 = "x1 + 3*x2 <= 18"
"#;

#[test]
fn the_example_of_the_fminimax_page_in_the_order_of_the_file() {
    let design = design(PAGE);
    let names: Vec<&str> = design.variables.iter().map(|v| v.name.as_str()).collect();
    assert_eq!(names, ["x2", "x1"]);
    let found = optimum(&design);
    assert_eq!(found.status, Status::Converged);
    near(found.x[0], 4.0);
    near(found.x[1], 4.0);
    let values: Vec<(&str, f64)> = found
        .objectives
        .iter()
        .map(|(n, v)| (n.as_str(), v.round()))
        .collect();
    assert_eq!(
        values,
        [
            ("f2", -64.0),
            ("f1", 0.0),
            ("f3", -2.0),
            ("f4", -8.0),
            ("f5", 0.0)
        ]
    );
    near(
        found
            .objective_multipliers
            .iter()
            .map(|(_, l)| l)
            .sum::<f64>(),
        1.0,
    );
    assert_eq!(found.constraint_multipliers, [("g1".to_owned(), 0.0)]);
}

#[test]
fn linear_and_curved_constraints_and_their_prices() {
    let found = optimum(&design(
        r#"
format = 1
method = "minimax"
[variables]
x = { start = 0.8 }
y = { start = 1.3 }
[objectives]
f = "x^2 + y^2"
[constraints]
line = "x + 2*y = 3"
right = "x >= 1"
circle = "x^2 + y^2 <= 100"
curve = "x*y = 1"
"#,
    ));
    // Line and curve meet at (1, 1) and (2, 1/2); the start is near the first, which the bound admits.
    near(found.x[0], 1.0);
    near(found.x[1], 1.0);
    let names: Vec<&str> = found
        .constraint_multipliers
        .iter()
        .map(|(n, _)| n.as_str())
        .collect();
    assert_eq!(names, ["line", "right", "circle", "curve"]);
}

/// An objective and a constraint may be called alike: they stand in different lists, and in the common one
/// the constraint is marked.
#[test]
fn one_name_for_an_objective_and_a_constraint() {
    for constraint in ["x + y >= 2", "x*y >= 1"] {
        let found = optimum(&design(&format!(
            "method = \"minimax\"\n[variables]\nx = {{ start = 3.0 }}\ny = {{ start = 2.0 }}\n[objectives]\nload = \"x^2 + y^2\"\n[constraints]\nload = \"{constraint}\"\n"
        )));
        near(found.x[0], 1.0);
        assert_eq!(found.constraint_multipliers[0].0, "load");
        near(found.constraint_multipliers[0].1, 2.0);
        assert_eq!(found.active, ["load", "load (constraint)"]);
    }
}

#[test]
fn goals_weights_scales_and_magnitudes() {
    let text = |objectives: &str, method: &str| {
        format!(
            "method = \"{method}\"\n[variables]\nx = {{ start = 0.3, lower = -5.0, upper = 5.0 }}\n[objectives]\n{objectives}"
        )
    };
    // (x − 1)² ≤ γ, (x + 1)² ≤ 3 γ.
    let attained = optimum(&design(&text(
        "a = { expr = \"(x - 1)^2\", goal = 0.0 }\nb = { expr = \"(x + 1)^2\", goal = 0.0, weight = 3.0 }\n",
        "attain",
    )));
    near(attained.x[0], 2.0 - 3.0_f64.sqrt());
    near(attained.attainment.unwrap(), (1.0 - 3.0_f64.sqrt()).powi(2));
    // A hard goal's price stands with the constraints.
    let hard = optimum(&design(&text(
        "a = { expr = \"(x - 1)^2\", goal = 0.25, weight = 0.0 }\nb = { expr = \"(x + 1)^2\", goal = 0.0 }\n",
        "attain",
    )));
    near(hard.x[0], 0.5);
    assert_eq!(hard.constraint_multipliers[0].0, "a");
    near(hard.constraint_multipliers[0].1, 3.0);
    // Scaling moves the compromise, and reports stay without it: 4 (x − 1)² = (x + 1)².
    let scaled = optimum(&design(&text(
        "a = { expr = \"(x - 1)^2\", scale = 4.0 }\nb = \"(x + 1)^2\"\n",
        "minimax",
    )));
    near(scaled.x[0], 1.0 / 3.0);
    near(scaled.objectives[0].1, 4.0 / 9.0);
    near(scaled.maximum, 16.0 / 9.0);
    near(scaled.utility, 16.0 / 9.0);
    assert_eq!(scaled.deciding, "b");
    // Objectives are compared with their scales: 0.001 (100 + x) never exceeds 0.5.
    let small = optimum(&design(&text(
        "cost = { expr = \"100 + x\", scale = 0.001 }\nloss = \"(x - 0.7)^2 + 0.5\"\n",
        "minimax",
    )));
    near(small.x[0], 0.7);
    assert_eq!(small.deciding, "loss");
    near(small.maximum, 0.5);
    near(small.starts[0].maximum, 0.5);
    let weighted = optimum(&design(&text(
        "a = { expr = \"(x - 1)^2\", weight = 3.0 }\nb = \"(x + 1)^2\"\n",
        "weighted",
    )));
    near(weighted.x[0], 0.5);
    // Of three objectives only the last two by magnitude: |x − 1|, |x + 2|, and x itself.
    let magnitudes = optimum(&design(&text(
        "plain = \"x\"\na = { expr = \"x - 1\", absolute = true }\nb = { expr = \"x + 2\", absolute = true }\n",
        "minimax",
    )));
    near(magnitudes.x[0], -0.5);
    near(magnitudes.maximum, 1.5);
    assert_eq!(magnitudes.objectives[0].0, "plain");
    near(magnitudes.objectives[1].1, -1.5);
    let all = optimum(&design(&format!(
        "absolute = true\n{}",
        text("a = \"x - 1\"\nb = \"x + 2\"\n", "minimax")
    )));
    near(all.maximum, 1.5);
}

#[test]
fn many_starts_find_every_optimum_and_need_a_box() {
    let text = |bounds: &str| {
        format!(
            "method = \"minimax\"\nstarts = 20\nseed = 3\n[variables]\nx = {{ start = 0.9{bounds} }}\n[objectives]\nf = \"(x^2 - 1)^2\"\n"
        )
    };
    let found = optimum(&design(&text(", lower = -2.0, upper = 2.0")));
    assert_eq!(found.starts.len(), 20);
    assert!(found.optima.len() >= 2 && found.is_ambiguous);
    near(found.starts[found.optima[0].0].x[0].abs(), 1.0);
    let unbounded = design(&text(", lower = -2.0"));
    let error = unbounded.solve().unwrap_err();
    assert!(
        error.to_string().contains("`x` has the bounds [-2, inf]"),
        "{error}"
    );
    assert!(error.hint().unwrap().contains("`x`"));
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let with = |extra: &str| {
        format!(
            "method = \"minimax\"\n[variables]\nx = {{ start = 1.0 }}\n[objectives]\nf = \"x\"\n{extra}"
        )
    };
    for (text, message, hint) in [
        (with("[constraints]\ng = \"x + y <= 1\"\n"), "p.toml:7:1: `g`, column 5: nothing is called `y`", None),
        (with("[constraints]\ng = \"x + 1\"\n"), "exactly one of", None),
        (with("[constraints]\ng = \"0 <= x <= 1\"\n"), "this one has 2", None),
        (with("[constraints]\ng = \"x < 1\"\n"), "`<` has no meaning", Some("`<=`")),
        (with("[constraint]\ng = \"x <= 1\"\n"), "no such key as `constraint`", Some("`constraints`")),
        (with("[wheel]\nradius = 1.0\n"), "no such key as `radius`", Some("`radius_m`")),
        (with("[soil]\nkey = \"dry-snd\"\n"), "`dry-snd` is not in the catalogue", Some("\"dry-sand\"")),
        ("method = \"minmax\"\n".to_owned(), "\"minmax\", but must be one of", Some("\"minimax\"")),
        ("method = \"minimax\"\n".to_owned(), "no variables", None),
        ("method = \"minimax\"\n[variables]\nx = { start = 1.0 }\n".to_owned(), "no objectives", None),
        ("method = \"minimax\"\n[variables]\nx = { lower = 1.0 }\n[objectives]\nf = \"x\"\n".to_owned(), "`x` has no key `start`", None),
        ("method = \"minimax\"\n[variables]\nx = 3\n[objectives]\nf = \"x\"\n".to_owned(), "must be a table with `start`", None),
        ("method = \"minimax\"\n[variables]\nX = { start = 1.0 }\n[objectives]\nf = \"1\"\n".to_owned(), "cannot name a variable", None),
        ("method = \"minimax\"\n[variables]\nsin = { start = 1.0 }\n[objectives]\nf = \"1\"\n".to_owned(), "cannot name a variable", None),
        ("method = \"minimax\"\n[variables]\ntorque_nm = { start = 1.0 }\n[objectives]\nf = \"1\"\n".to_owned(), "it is a quantity", None),
        ("method = \"minimax\"\n[variables]\nx = { start = 1.0, lower = 3.0, upper = 2.0 }\n[objectives]\nf = \"x\"\n".to_owned(), "lower 3 is greater than upper 2", None),
        ("method = \"minimax\"\n[variables]\nx = { start = nan }\n[objectives]\nf = \"x\"\n".to_owned(), "`start` is NaN, but must be a finite number", None),
        ("method = \"minimax\"\n[variables]\nx = { start = 1.0, upper = nan }\n[objectives]\nf = \"x\"\n".to_owned(), "`upper` is NaN, but must be a number", None),
        ("format = 2\nmethod = \"minimax\"\n".to_owned(), "reads up to format 1", Some("newer version")),
        ("method = \"attain\"\n[variables]\nx = { start = 1.0 }\n[objectives]\nf = \"x\"\n".to_owned(), "has no `goal`", None),
        ("method = \"minimax\"\n[variables]\nx = { start = 1.0 }\n[objectives]\nf = \"torque_n\"\n".to_owned(), "nothing is called `torque_n`", Some("`torque_nm`")),
        ("method = \"minimax\"\n[variables]\nslip = { start = 0.1 }\n[objectives]\nf = \"torque_nm\"\n".to_owned(), "needs `radius_m`; neither [wheel]", None),
        ("method = \"minimax\"\n[variables]\nsinkage_m = { start = 0.1 }\n[state]\nload_n = 3\n[objectives]\nf = \"sinkage_m\"\n".to_owned(), "both `load_n` and `sinkage_m`", None),
        (with("[robust]\nmeasure = \"worst_case\"\n"), "exactly one of `soils`", None),
    ] {
        let (said, told) = refused(&text);
        assert!(said.contains(message), "{said}\ninstead of\n{message}");
        if let Some(hint) = hint {
            assert!(told.as_deref().unwrap_or_default().contains(hint), "{told:?} instead of {hint}");
        }
    }
}

#[test]
fn long_and_deep_formulas() {
    let long = format!("x{}", " + x*0".repeat(12_000));
    let found = optimum(&design(&format!(
        "method = \"minimax\"\n[variables]\nx = {{ start = 1.0, lower = -1.0, upper = 3.0 }}\n[objectives]\nf = \"{long}\"\n"
    )));
    near(found.x[0], -1.0);
    let deep = format!("{}x{}", "(".repeat(201), ")".repeat(201));
    let (said, _) = refused(&format!(
        "method = \"minimax\"\n[variables]\nx = {{ start = 1.0 }}\n[objectives]\nf = \"{deep}\"\n"
    ));
    assert!(
        said.contains("column 201: parentheses nest deeper than 200"),
        "{said}"
    );
}

#[test]
fn several_worlds() {
    let text = |measure: &str| {
        format!(
            r#"
method = "minimax"
seed = 2
[variables]
slip = {{ start = 0.3, lower = 0.02, upper = 0.9 }}
[wheel]
radius_m = 0.125
width_m = 0.1
[soil]
key = "dry-sand"
[state]
load_n = 60.0
[objectives]
loss = "-tractive_efficiency"
[constraints]
torque = "torque_nm <= 50"
[robust]
{measure}
"#
        )
    };
    let one = |measure: &str| optimum(&design(&text(measure)));
    let ranges =
        "samples = 8\n[robust.ranges]\nphi_deg = [27.0, 33.0]\ncohesion_kpa = [0.8, 1.2]\n";
    let worst = one(&format!("measure = \"worst_case\"\n{ranges}"));
    assert!(worst.status.is_solved());
    assert_eq!(worst.objectives.len(), 8);
    assert_eq!(worst.constraint_multipliers.len(), 8);
    assert_eq!(worst.objectives[0].0, "loss @ sample 1");
    let mean = one(&format!(
        "measure = \"mean_plus_deviations\"\nkappa = 0.0\n{ranges}"
    ));
    let spread = one(&format!(
        "measure = \"mean_plus_deviations\"\nkappa = 2.0\n{ranges}"
    ));
    let tail = one(&format!("measure = \"cvar\"\nalpha = 0.75\n{ranges}"));
    // From the mean over the worst quarter to the worst: each is more careful than the last.
    assert!(mean.objectives[0].1 < tail.objectives[0].1 + 1e-9);
    assert!(
        tail.maximum <= worst.maximum + 1e-7,
        "{} {}",
        tail.maximum,
        worst.maximum
    );
    assert!(spread.objectives[0].1 > mean.objectives[0].1);
    assert_eq!(tail.x.len(), 1);
    assert!(
        tail.active
            .iter()
            .all(|name| !name.contains("excess") && !name.contains("eta"))
    );
    let soils = one("measure = \"worst_case\"\nsoils = [\"dry-sand\", \"sandy-loam\"]\n");
    assert_eq!(soils.objectives[1].0, "loss @ sandy-loam");
    let normal = one("measure = \"worst_case\"\nsamples = 4\n[robust.deviations]\nphi_deg = 1.5\n");
    assert_eq!(normal.objectives.len(), 4);
}

#[test]
fn the_shipped_problems_have_answers() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/problems");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let design = read(&path).unwrap_or_else(|e| panic!("{e}"));
        match design.solve().unwrap() {
            Answer::Optimum(found) => {
                assert_eq!(found.status, Status::Converged, "{}", path.display());
                assert!(found.kkt.violation <= 1e-8);
            }
            Answer::Trade(found) => {
                assert_eq!(design.task, Task::Pareto);
                assert!(found.points.len() > 30 && found.knee.is_some());
            }
            _ => panic!("a new kind of answer"),
        }
        let start: Vec<f64> = design.variables.iter().map(|v| v.start).collect();
        let check = design.check_derivatives(&start, 1e-5).unwrap();
        assert_eq!(check.wrong, [], "{}", path.display());
        count += 1;
    }
    assert!(count >= 5);
}

#[test]
fn no_feasible_design_is_a_status_with_names() {
    let found = optimum(&design(
        r#"
method = "minimax"
[variables]
radius_m = { start = 0.1, lower = 0.05, upper = 0.2 }
slip = { start = 0.3, lower = 0.02, upper = 0.9 }
[wheel]
width_m = 0.1
[soil]
key = "dry-sand"
[state]
load_n = 60.0
[objectives]
torque = "torque_nm"
[constraints]
pull = "drawbar_pull_n >= 200"
"#,
    ));
    let Status::NoFeasiblePoint(violations) = &found.status else {
        panic!("{:?}", found.status)
    };
    assert_eq!(violations[0].name, "pull");
    assert!(violations[0].amount > 100.0 && violations[0].amount < 200.0);
}

#[test]
fn a_start_without_a_value_says_why() {
    let design = design(
        r#"
method = "minimax"
[variables]
load_n = { start = 1e7, lower = 1.0, upper = 1e8 }
[wheel]
radius_m = 0.1
width_m = 0.1
[soil]
key = "dry-sand"
[state]
slip = 0.3
[objectives]
torque = "torque_nm"
"#,
    );
    let found = optimum(&design);
    let Status::NotFinite {
        function,
        reason: Some(reason),
    } = &found.status
    else {
        panic!("{:?}", found.status);
    };
    assert!(
        function == "torque" && reason.contains("`torque_nm` has no value: no sinkage carries"),
        "{reason}"
    );
}
