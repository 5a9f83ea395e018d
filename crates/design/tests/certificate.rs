//! Certificates of designs with wheels under a load.

use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;

use grouser_design::{Answer, Design, Error, State, parse, read};
use grouser_files::Document;
use grouser_opt::{Certificate, CertifySettings, Variable};
use grouser_terra::{RigidWheel, ShearLaw, Soil, catalogue};

fn certified(design: &Design, seconds: f64) -> Certificate {
    let mut settings = CertifySettings::default();
    settings.time_limit_s = Some(seconds);
    settings.starts = 4;
    design
        .certify(&settings, &mut |_| ControlFlow::Continue(()), None)
        .unwrap()
}

fn shipped(name: &str) -> Design {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/problems");
    read(&folder.join(name)).unwrap()
}

/// `GROUSER_CERTIFY_S=60 cargo test --release -p grouser-design --test all certificate:: -- --nocapture` measures the gaps.
#[test]
fn shipped_problems_have_bounds_on_both_sides_of_their_optimum() {
    let seconds = std::env::var("GROUSER_CERTIFY_S").map_or(4.0, |s| s.parse().unwrap());
    for name in [
        "running-slip.toml",
        "dry-sand-wheel.toml",
        "robust-wheel.toml",
    ] {
        let design = shipped(name);
        let Answer::Optimum(optimum) = design.solve().unwrap() else {
            unreachable!()
        };
        let c = certified(&design, seconds);
        println!(
            "{name}: {} lower {:.9} upper {:.9} gap {:.2e} boxes {} in {:.1} s, local {:.9}, x {:?}",
            c.status.name(),
            c.lower,
            c.upper,
            c.gap(),
            c.boxes,
            c.seconds,
            optimum.utility,
            c.x
        );
        assert!(
            c.lower <= optimum.utility,
            "{name}: {} > {}",
            c.lower,
            optimum.utility
        );
        assert!(c.lower <= c.upper, "{name}");
    }
}

/// Over boxes as small as a point the certificate is the kernel's value: also where a variable replaces a size or a slope,
/// with lugs, rebound, Reece's pressure and a soil that is carried away.
#[test]
fn the_level_over_a_small_box_is_that_of_the_kernel() {
    let smooth = "width_m = 0.1";
    let lugs =
        "width_m = 0.1\ngrouser_height_m = 0.01\ngrouser_count = 18\ngrouser_thickness_m = 0.002";
    let sand = "key = \"dry-sand\"";
    for (slip, load, more, wheel, soil) in [
        (0.05, 30.0, "", smooth, sand),
        (0.3, 60.0, "", smooth, sand),
        (0.7, 120.0, "", smooth, sand),
        (0.3, 60.0, "", lugs, sand),
        (0.3, 60.0, "", lugs, "key = \"dry-sand\"\nrebound = 0.2"),
        (0.4, 60.0, "slope_deg = 10.0", smooth, sand),
        (0.4, 60.0, "grouser_height_m = 0.01", smooth, sand),
        (0.4, 60.0, "grouser_count = 12.0", lugs, sand),
        (0.4, 60.0, "n_1 = 0.3", lugs, sand),
        (0.2, 60.0, "rebound = 0.1", smooth, "key = \"sandy-loam\""),
    ] {
        let (name, value) = more.split_once(" = ").unwrap_or(("theta_deg", "3.0"));
        let value: f64 = value.parse().unwrap();
        let text = format!(
            "format = 1\nmethod = \"minimax\"\n[variables]\n\
             slip = {{ start = {slip}, lower = {slip}, upper = {} }}\n\
             radius_m = {{ start = 0.125, lower = 0.125, upper = 0.1250001 }}\n\
             {name} = {{ start = {value}, lower = {value}, upper = {} }}\n\
             [wheel]\n{wheel}\n[soil]\n{soil}\n[state]\nload_n = {load}\n\
             [objectives]\nf = \"-tractive_efficiency + sinkage_m / radius_m + torque_nm / 10 + s_0 \\\n\
             + strength_at_theta_pa / 1e4\"\n",
            slip + 1e-7,
            value + 1e-7
        )
        .replace("\\\n", "");
        let text = if name == "theta_deg" {
            text
        } else {
            text.replace("load_n =", "theta_deg = 3.0\nload_n =")
        };
        let design = parse(&Document::from_text("small.toml", text).unwrap()).unwrap();
        let x: Vec<f64> = design.variables.iter().map(|v| v.start).collect();
        let exact = design.merit(&x).unwrap().utility;
        let c = certified(&design, 20.0);
        println!("{name} {exact} {c:?}");
        assert!(c.status.is_proved(), "{c:?}");
        assert!(
            (c.lower - exact).abs() < 1e-5 && (c.upper - exact).abs() < 1e-5,
            "{name}: {exact} {c:?}"
        );
    }
}

/// Wheels with lugs: no wheel of a random sample is better than what is proved.
#[test]
fn no_lugged_wheel_is_better_than_the_bound() {
    let text = "format = 1\nmethod = \"minimax\"\n[variables]\n\
        radius_m = { start = 0.1, lower = 0.08, upper = 0.14 }\n\
        grouser_height_m = { start = 0.01, lower = 0.002, upper = 0.015 }\n\
        slip = { start = 0.2, lower = 0.05, upper = 0.5 }\n\
        [wheel]\nwidth_m = 0.1\ngrouser_count = 18\ngrouser_thickness_m = 0.002\n\
        [soil]\nkey = \"dry-sand\"\n[state]\nload_n = 60.0\n\
        [objectives]\nloss = \"-tractive_efficiency\"\n\
        [constraints]\npull = \"drawbar_pull_n >= 3\"\n";
    let design = parse(&Document::from_text("lugs.toml", text.into()).unwrap()).unwrap();
    // of a debug build, which must not wait for the whole gap
    let c = certified(&design, 10.0);
    assert!(c.lower.is_finite() && c.lower <= c.upper, "{c:?}");
    let mut stream = crate::random_starts::Stream(7);
    let mut best = f64::INFINITY;
    for _ in 0..3000 {
        let x: Vec<f64> = design
            .variables
            .iter()
            .map(|v| v.lower + (v.upper - v.lower) * stream.next())
            .collect();
        let merit = design.merit(&x).unwrap();
        if merit.violation <= 0.0 {
            best = best.min(merit.utility);
        }
    }
    assert!(best >= c.lower, "{best} {c:?}");
    assert!(best - c.upper < 0.02, "{best} {c:?}");
}

fn assert_refused(design: &Design, reason: &str) {
    let refused = design.certify(
        &CertifySettings::default(),
        &mut |_| ControlFlow::Continue(()),
        None,
    );
    let Err(error @ Error::NoCertificate { .. }) = refused else {
        panic!("{refused:?}");
    };
    assert!(error.to_string().contains(reason), "{error}");
}

#[test]
fn what_has_no_bounds_is_refused() {
    let base = "format = 1\nmethod = \"minimax\"\n[variables]\n\
        slip = { start = 0.2, lower = LOWER, upper = 0.8 }\n\
        [wheel]\nradius_m = 0.125\nwidth_m = 0.1\n[soil]\nkey = \"dry-sand\"\n[state]\nload_n = 60.0\nslope_deg = 5.0\n\
        [objectives]\nf = \"-FUNCTION\"\n";
    for (lower, function, reason) in [
        ("-0.2", "drawbar_pull_n", "slips of 0 and above"),
        ("0.1", "max_drawbar_pull_n", "write `drawbar_pull_n`"),
        ("0.1", "slip_demand", "search over slip"),
    ] {
        let text = base.replace("LOWER", lower).replace("FUNCTION", function);
        let design = parse(&Document::from_text("refused.toml", text).unwrap()).unwrap();
        assert_refused(&design, reason);
    }
}

#[test]
fn a_law_without_bounds_is_named() {
    let mut params = *catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap()
        .params();
    params.laws.shear = Some(ShearLaw::SlipVelocityRegular);
    let design = Design::builder(
        &RigidWheel::new(0.125, 0.1).unwrap(),
        &Soil::new(params).unwrap(),
        State::under_load(60.0),
    )
    .variable(Variable::bounded("slip", 0.2, 0.0, 0.8))
    .minimise("pull", "-drawbar_pull_n")
    .build()
    .unwrap();
    assert_refused(&design, "slip-velocity-regular");
}

/// The proof of a loaded wheel is one of formulas, which the checker replays like any other.
#[test]
fn the_checker_accepts_the_proof_of_a_wheel() {
    let python = Command::new("python3").arg("--version").output();
    if !python.is_ok_and(|output| output.status.success()) {
        assert!(std::env::var("CI").is_err(), "the checker needs python3");
        println!("skipped: no python3");
        return;
    }
    let mut log = String::new();
    let certificate = shipped("running-slip.toml")
        .certify(
            &CertifySettings::default(),
            &mut |_| ControlFlow::Continue(()),
            Some(&mut |line: &str| {
                log.push_str(line);
                log.push('\n');
                ControlFlow::Continue(())
            }),
        )
        .unwrap();
    assert!(certificate.status.is_proved());
    let path = std::env::temp_dir().join(format!("grouser-wheel-{}.jsonl", std::process::id()));
    std::fs::write(&path, log).unwrap();
    let checker = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../checker/check.py");
    let output = Command::new("python3")
        .arg(checker)
        .arg(&path)
        .output()
        .unwrap();
    let _ = std::fs::remove_file(path);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{text}");
    assert!(text.starts_with("accepted"), "{text}");
}

/// The rule of integration is proved over the boxes of all shipped problems whose wheels carry a load.
#[test]
fn the_rule_of_integration_is_proved_for_shipped_problems() {
    for name in [
        "running-slip",
        "dry-sand-wheel",
        "robust-wheel",
        "soil-box",
        "lug-height",
        "pull-against-torque",
    ] {
        let path = format!("../../examples/problems/{name}.toml");
        let design = grouser_design::read(path.as_ref()).unwrap();
        let began = std::time::Instant::now();
        let remainder = design.force_remainder().unwrap();
        println!(
            "{name}: {remainder:?}, {:.2} s",
            began.elapsed().as_secs_f64()
        );
        assert!(remainder.is_proved, "{name}");
    }
}
