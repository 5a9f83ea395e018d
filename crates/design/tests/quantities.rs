//! Every quantity against terra's own answer, and its derivatives against finite differences.

use grouser_design::{Answer, Design, Quantity, parse};
use grouser_files::Document;
use grouser_terra::{
    Angle, Kinematics, RigidWheel, Settings, Slip, SlopeOutcome, WheelOnSoil, catalogue,
};

fn design(text: &str) -> Design {
    parse(&Document::from_text("test.toml", text.to_owned()).unwrap()).unwrap()
}

const HEAD: &str = r#"
format = 1
method = "minimax"
[variables]
radius_m = { start = 0.125, lower = 0.05, upper = 0.3 }
width_m = { start = 0.1, lower = 0.05, upper = 0.3 }
slip = { start = 0.5, lower = 0.01, upper = 0.9 }
phi_deg = { start = 30.0, lower = 20.0, upper = 40.0 }
n = { start = 1.1, lower = 0.5, upper = 1.5 }
cohesion_kpa = { start = 1.0, lower = 0.1, upper = 5.0 }
load_n = { start = 80.0, lower = 10.0, upper = 200.0 }
theta_deg = { start = 12.0, lower = 0.0, upper = 30.0 }
slope_deg = { start = 4.0, lower = 0.0, upper = 10.0 }
k_shear_m = { start = 0.025, lower = 0.005, upper = 0.05 }
[soil]
key = "dry-sand"
[state]
mobilised = 0.3
"#;

fn at_start(design: &Design) -> Vec<f64> {
    design.variables.iter().map(|v| v.start).collect()
}

#[test]
fn quantities_agree_with_terra() {
    let design = design(&format!("{HEAD}[objectives]\nf = \"drawbar_pull_n\"\n"));
    let x = at_start(&design);
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let contact = WheelOnSoil::new(
        RigidWheel::new(0.125, 0.1).unwrap(),
        soil,
        Settings::default(),
    )
    .unwrap();
    let slope = Angle::from_deg(4.0);
    let carried = 80.0 * slope.cos();
    let motion = Kinematics::straight(Slip::new(0.5).unwrap());
    let point = contact
        .under_load(carried, &motion)
        .unwrap()
        .point()
        .unwrap();
    let SlopeOutcome::Holds { slip } = contact.slip_demand(80.0, slope).unwrap() else {
        panic!("the slope is held")
    };
    for (name, expected) in [
        ("sinkage_m", point.sinkage),
        ("theta_1_deg", point.angles.theta_1.to_degrees()),
        ("theta_m_deg", point.angles.theta_m.to_degrees()),
        ("vertical_force_n", carried),
        ("drawbar_pull_n", point.forces.drawbar_pull),
        ("torque_nm", point.forces.torque),
        ("thrust_n", point.forces.thrust),
        (
            "compaction_resistance_n",
            point.forces.compaction_resistance,
        ),
        ("tractive_efficiency", point.tractive_efficiency().unwrap()),
        ("energy_j_per_m", point.energy_per_metre().unwrap()),
        ("pull_coefficient", point.pull_coefficient().unwrap()),
        ("gradeability_deg", point.gradeability().unwrap().deg()),
        ("slip_demand", slip.value()),
        (
            "max_drawbar_pull_n",
            contact
                .slip_of_maximum_pull(carried)
                .unwrap()
                .unwrap()
                .value,
        ),
        (
            "max_tractive_efficiency",
            contact
                .slip_of_maximum_efficiency(carried)
                .unwrap()
                .unwrap()
                .value,
        ),
        (
            "max_gradeability_deg",
            contact.gradeability(80.0).unwrap().unwrap().deg(),
        ),
    ] {
        let got = design.quantity(Quantity::named(name).unwrap(), &x).unwrap();
        assert!(
            (got - expected).abs() <= 1e-8 * expected.abs().max(1e-3),
            "{name}: {got} {expected}"
        );
    }
}

/// Derivatives of every quantity in every variable. The sinkage's, the slip demand's and the steepest slope's
/// come from implicit equations.
#[test]
fn derivatives_are_right_in_every_variable() {
    for name in Quantity::names() {
        let design = design(&format!("{HEAD}[objectives]\nf = \"{name}\"\n"));
        let check = design.check_derivatives(&at_start(&design), 1e-5).unwrap();
        assert!(check.wrong.is_empty(), "{name}: {:?}", check.wrong);
        assert_eq!(check.entries, 10, "{name}");
    }
}

#[test]
fn the_papers_slip_is_the_one_of_the_model() {
    let text = r#"
method = "minimax"
absolute = true
[variables]
theta_deg = { start = 32.0 }
[wheel]
radius_m = 0.1
[state]
sinkage_m = 0.03
[objectives]
s = "s_0"
"#;
    let design = design(text);
    let s = design.quantity(Quantity::S0, &[32.0]).unwrap();
    // by another program
    assert!((s + 0.2859).abs() < 5e-5, "{s}");
    let Answer::Optimum(optimum) = design.solve().unwrap() else {
        panic!("one point")
    };
    // |S_0| falls with θ until S_0 meets the vertical's mirror: its least is where ξ is least.
    assert!(optimum.maximum < 0.2859);
}
