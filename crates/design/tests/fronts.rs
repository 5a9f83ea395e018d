//! Fronts of designs: over several soils, and proved.

use std::ops::ControlFlow;

use grouser_design::{Answer, Design, Quantity, Trade, parse};
use grouser_files::Document;
use grouser_opt::CertifySettings;

use crate::random_starts::Stream;

const PULL_AND_TORQUE: &str = r#"
format = 1
method = "pareto"
[variables]
radius_m = { start = 0.1, lower = 0.08, upper = 0.16 }
slip = { start = 0.2, lower = 0.05, upper = 0.5 }
[wheel]
width_m = 0.1
LUGS
[state]
load_n = 80.0
SOIL
[objectives]
pull = { maximise = "drawbar_pull_n" }
torque = "torque_nm"
[constraints]
sinkage = "sinkage_m <= 0.03"
[pareto]
population = 24
generations = 20
"#;

fn design(lugs: &str, soil: &str) -> Design {
    let text = PULL_AND_TORQUE.replace("LUGS", lugs).replace("SOIL", soil);
    parse(&Document::from_text("front.toml", text).unwrap()).unwrap()
}

fn trade(design: &Design) -> Trade {
    let Answer::Trade(trade) = design.solve().unwrap() else {
        unreachable!()
    };
    *trade
}

const DRY_SAND: &str = "[soil]\nkey = \"dry-sand\"";
const TWO_SOILS: &str =
    "[robust]\nmeasure = \"worst_case\"\nsoils = [\"dry-sand\", \"sandy-loam\"]";

/// Pull and torque of the worst of these designs, each on one soil; `None` where a wheel does not carry its load.
fn worst(alone: &[Design], x: &[f64]) -> Option<[f64; 2]> {
    let value = |design: &Design, name: &str| design.quantity(Quantity::named(name).unwrap(), x);
    let mut worst = [f64::INFINITY, f64::NEG_INFINITY];
    for design in alone {
        worst[0] = worst[0].min(value(design, "drawbar_pull_n")?);
        worst[1] = worst[1].max(value(design, "torque_nm")?);
    }
    Some(worst)
}

fn on_each(lugs: &str, soils: &[&str]) -> Vec<Design> {
    let one = |key: &&str| design(lugs, &format!("[soil]\nkey = \"{key}\""));
    soils.iter().map(one).collect()
}

/// The objectives of a front over several soils are those on the worst one, each by itself.
#[test]
fn a_front_over_two_soils_has_the_worst_of_both() {
    let found = trade(&design("", TWO_SOILS));
    assert!(found.points.len() > 5);
    let alone = on_each("", &["dry-sand", "sandy-loam"]);
    for point in &found.points {
        let expected = worst(&alone, &point.x).unwrap();
        for (own, expected) in point.objectives.iter().zip(expected) {
            assert!((own - expected).abs() < 1e-9, "{point:?} {expected}");
        }
    }
}

/// No random design is better than a listed one by more than the proved tolerance, and none lies below every corner.
#[test]
fn no_random_wheel_is_better_than_a_proved_front() {
    let lugs = "grouser_height_m = 0.008\ngrouser_count = 18\ngrouser_thickness_m = 0.002";
    for (name, lugs, soil, soils) in [
        ("smooth", "", DRY_SAND, &["dry-sand"][..]),
        ("lugs", lugs, DRY_SAND, &["dry-sand"]),
        ("two soils", "", TWO_SOILS, &["dry-sand", "sandy-loam"]),
    ] {
        let design = design(lugs, soil);
        let alone = on_each(lugs, soils);
        let trade = trade(&design);
        let mut settings = CertifySettings::default();
        settings.gap = 0.2;
        settings.time_limit_s = Some(30.0);
        let mut go_on = |_: &_| ControlFlow::Continue(());
        let proof = design
            .certify_front(&trade, &settings, &mut go_on, None)
            .unwrap();
        println!(
            "{name}: {} to {:.3} of the ranges, {:?}, {} points, {} proofs, {} boxes, {:.1} s",
            proof.status.name(),
            proof.share,
            proof.tolerance,
            proof.points.len(),
            proof.proofs,
            proof.boxes,
            proof.seconds
        );
        assert!(
            proof.share < 1.0 && proof.points.len() > 3,
            "{name}: {proof:?}"
        );
        let mut stream = Stream(5);
        let (mut feasible, mut nearest) = (0, f64::INFINITY);
        for _ in 0..1500 {
            let x: Vec<f64> = design
                .variables
                .iter()
                .map(|v| v.lower + (v.upper - v.lower) * stream.next())
                .collect();
            if design.merit(&x).unwrap().violation > 0.0 {
                continue;
            }
            let Some(q) = worst(&alone, &x) else { continue };
            feasible += 1;
            let room = |p: &[f64]| {
                (p[0] + proof.tolerance[0] - q[0]).min(q[1] + proof.tolerance[1] - p[1])
            };
            let best = proof
                .points
                .iter()
                .map(|p| room(&p.objectives))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(best >= 0.0, "{name}: {x:?} has {q:?}");
            nearest = nearest.min(best);
            assert!(
                proof.corners.iter().any(|c| q[0] <= c[0] && q[1] >= c[1]),
                "{name}: {q:?} is below every corner"
            );
        }
        println!("  {feasible} wheels, the best within {nearest:.3} of the proof");
        assert!(feasible > 200, "{name}: {feasible}");
    }
}
