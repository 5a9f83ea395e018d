//! A design built in a program beside the same one in a file, and soils that no file describes.

use grouser_design::{Answer, Design, Error, Optimum, State, parse};
use grouser_files::Document;
use grouser_opt::{Measure, Variable};
use grouser_terra::{
    GrouserRule, Grousers, LawChoice, Pressure, Reece, RigidWheel, Settings, ShearLaw, Soil,
    SoilParams, WheelOnSoil, catalogue,
};

fn solved(design: &Design) -> Optimum {
    match design.solve().unwrap() {
        Answer::Optimum(optimum) => *optimum,
        other => panic!("{other:?}"),
    }
}

fn soil(key: &str) -> Soil {
    catalogue::find(key).unwrap().soil().unwrap()
}

fn wheel() -> RigidWheel {
    RigidWheel::new(0.125, 0.1).unwrap()
}

/// On a soil that a file can describe, file and builder give the same bits.
#[test]
fn a_file_and_a_builder_give_the_same_answer() {
    let text = "format = 1
method = \"minimax\"
[variables]
slip = { start = 0.2, lower = 0.01, upper = 0.8 }
[wheel]
radius_m = 0.125
width_m = 0.1
[soil]
key = \"dry-sand\"
[state]
load_n = 60.0
[objectives]
efficiency = \"-tractive_efficiency\"
[constraints]
reserve = \"gradeability_deg >= 3\"
";
    let file = parse(&Document::from_text("running-slip.toml", text.to_owned()).unwrap()).unwrap();
    let built = Design::builder(&wheel(), &soil("dry-sand"), State::under_load(60.0))
        .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
        .minimise("efficiency", "-tractive_efficiency")
        .constraint("reserve", "gradeability_deg >= 3")
        .starts(8, 1) // what a file of bounded variables has
        .build()
        .unwrap();
    assert_eq!(solved(&file), solved(&built));
}

/// The slip of the greatest tractive efficiency by the optimiser, with derivatives through the wheel's laws.
fn optimal_slip(wheel: &RigidWheel, soil: &Soil, load: f64) -> f64 {
    let design = Design::builder(wheel, soil, State::under_load(load))
        .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
        .minimise("efficiency", "-tractive_efficiency")
        .build()
        .unwrap();
    let Answer::Optimum(optimum) = design.solve().unwrap() else {
        panic!("one objective has no front")
    };
    assert!(optimum.status.is_solved(), "{:?}", optimum.status);
    optimum.x[0]
}

/// The search over slip of the wheel's own solver, which knows every law.
fn best_slip(wheel: RigidWheel, soil: &Soil, load: f64) -> f64 {
    let contact = WheelOnSoil::new(wheel, *soil, Settings::default()).unwrap();
    let best = contact.slip_of_maximum_efficiency(load).unwrap().unwrap();
    best.slip.value()
}

#[test]
fn the_optimal_slip_of_a_reece_soil() {
    let sand = *soil("dry-sand").params();
    let reece = Soil::new(SoilParams {
        unit_weight: Some(15e3),
        pressure: Pressure::Reece(Reece {
            k_c_prime: 0.0,
            k_phi_prime: 900.0,
        }),
        ..sand
    })
    .unwrap();
    let slip = optimal_slip(&wheel(), &reece, 60.0);
    assert!(
        (slip - best_slip(wheel(), &reece, 60.0)).abs() < 1e-3,
        "{slip}"
    );
}

/// Rear contact, transport and a shear law change the slip, and all of them count.
#[test]
fn the_optimal_slip_counts_every_law_of_the_soil() {
    let sand = *soil("dry-sand").params();
    let whole = Soil::new(SoilParams {
        rebound: 0.3,
        rear_driving: 0.5,
        transport_layer: 0.004,
        laws: LawChoice {
            shear: Some(ShearLaw::SlipVelocity),
            ..LawChoice::default()
        },
        ..sand
    })
    .unwrap();
    let plain = optimal_slip(&wheel(), &soil("dry-sand"), 60.0);
    let slip = optimal_slip(&wheel(), &whole, 60.0);
    assert!((slip - plain).abs() > 1e-3, "{slip} {plain}");
    assert!(
        (slip - best_slip(wheel(), &whole, 60.0)).abs() < 1e-3,
        "{slip}"
    );
}

/// Grousers by either rule: the design's forces are those of the wheel.
#[test]
fn grousers_count_by_their_rule() {
    let lugs = GrouserRule::Lugs {
        count: 24.0,
        thickness: 0.002,
    };
    for rule in [
        GrouserRule::Tips,
        GrouserRule::AreaShare { tips: 0.3 },
        lugs,
    ] {
        let wheel = wheel()
            .with_grousers(Grousers { height: 0.01, rule })
            .unwrap();
        let slip = optimal_slip(&wheel, &soil("dry-sand"), 60.0);
        let best = best_slip(wheel, &soil("dry-sand"), 60.0);
        assert!((slip - best).abs() < 1e-3, "{rule:?}: {slip} {best}");
    }
}

#[test]
fn worlds_of_a_builder_are_all_held() {
    let soils = [("sand", soil("dry-sand")), ("clay", soil("clayey-soil"))];
    let robust = Design::builder(&wheel(), &soils[0].1, State::under_load(60.0))
        .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
        .minimise("pull", "-drawbar_pull_n")
        .worlds(Measure::WorstCase, &soils)
        .build()
        .unwrap();
    let worst = solved(&robust).maximum;
    for (_, soil) in soils {
        let alone = Design::builder(&wheel(), &soil, State::under_load(60.0))
            .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
            .minimise("pull", "-drawbar_pull_n")
            .build()
            .unwrap();
        assert!(solved(&alone).maximum <= worst + 1e-9);
    }
}

#[test]
fn what_a_builder_refuses() {
    let begin = || Design::builder(&wheel(), &soil("dry-sand"), State::under_load(60.0));
    let slip = || Variable::bounded("slip", 0.2, 0.01, 0.8);
    assert!(matches!(
        begin().minimise("f", "slip").build(),
        Err(Error::Contradiction { .. })
    ));
    let formula = begin().variable(slip()).minimise("f", "slip +").build();
    assert!(matches!(formula, Err(Error::Formula { .. })));
    let name = begin()
        .variable(Variable::free("torque_nm", 1.0))
        .minimise("f", "1")
        .build();
    assert!(matches!(name, Err(Error::Name { .. })));
    // no slip is given, and the pull needs one
    let missing = begin()
        .variable(Variable::bounded("radius_m", 0.1, 0.05, 0.2))
        .minimise("pull", "-drawbar_pull_n")
        .build();
    assert!(matches!(
        missing,
        Err(Error::MissingParameter {
            parameter: "slip",
            ..
        })
    ));
    let both = Design::builder(
        &wheel(),
        &soil("dry-sand"),
        State::under_load(60.0).slip(0.2),
    )
    .variable(Variable::bounded("sinkage_m", 0.01, 0.005, 0.02))
    .minimise("f", "sinkage_m")
    .build();
    assert!(matches!(both, Err(Error::Contradiction { .. })));
}

/// `maximise` is the same problem as a minus sign, with goals and values in the quantity's own sign.
#[test]
fn a_maximised_objective_keeps_its_sign() {
    let of = |method: &str, objective: &str| {
        let text = format!(
            "method = \"{method}\"
[variables]
slip = {{ start = 0.2, lower = 0.01, upper = 0.8 }}
[wheel]
radius_m = 0.125
width_m = 0.1
[soil]
key = \"dry-sand\"
[state]
load_n = 60.0
[objectives]
efficiency = {objective}
"
        );
        solved(&parse(&Document::from_text("p.toml", text).unwrap()).unwrap())
    };
    let minus = of("minimax", "\"-tractive_efficiency\"");
    let plain = of("minimax", "{ maximise = \"tractive_efficiency\" }");
    assert_eq!(minus.x, plain.x);
    assert_eq!(minus.objectives[0].1, -plain.objectives[0].1);
    // what decides has the sign of the file, what was minimised is the same
    assert_eq!(
        (minus.maximum, minus.utility),
        (-plain.maximum, plain.utility)
    );
    let minus = of(
        "attain",
        "{ expr = \"-tractive_efficiency\", goal = -0.1, weight = 0.1 }",
    );
    let plain = of(
        "attain",
        "{ maximise = \"tractive_efficiency\", goal = 0.1, weight = 0.1 }",
    );
    assert_eq!((minus.x, minus.attainment), (plain.x, plain.attainment));
    assert!(plain.attainment.unwrap() < 0.0 && plain.objectives[0].1 > 0.1);
}
