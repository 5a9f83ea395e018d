//! Proofs about slopes against the laws themselves, at random soils and slips.

use crate::random_starts::Stream;

#[allow(dead_code, reason = "shared with searches from random starts")]
use std::ops::ControlFlow;

use grouser_design::{prove_no_slip_holds, read};
use grouser_opt::CertifySettings;
use grouser_terra::{
    Angle, Bekker, GrouserRule, Grousers, Kinematics, Pressure, RigidWheel, Settings, Slip, Soil,
    SoilParams, WheelOnSoil, catalogue,
};

/// The soil box ships with a minimum above 0: no soil of it may leave less, whatever its numbers.
#[test]
fn no_soil_of_the_box_leaves_less_than_what_is_proved() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/problems/soil-box.toml"
    );
    let design = read(file.as_ref()).unwrap();
    let mut settings = CertifySettings::default();
    settings.gap = 1e-3;
    let proof = design
        .certify(&settings, &mut |_| ControlFlow::Continue(()), None)
        .unwrap();
    assert!(proof.status.is_proved() && proof.lower > 0.0, "{proof:?}");
    let mut stream = Stream(5);
    let base = *catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap()
        .params();
    let wheel = RigidWheel::new(0.15, 0.12).unwrap();
    let (load, slope) = (40.0, Angle::from_deg(3.5));
    let mut least = f64::INFINITY;
    for case in 0..3000 {
        let x: Vec<f64> = design
            .variables
            .iter()
            .map(|v| {
                // A third of the cases are corners, where the worst soil lies.
                let share = stream.next();
                let share = if case % 3 == 0 { share.round() } else { share };
                v.lower + share * (v.upper - v.lower)
            })
            .collect();
        let [phi, cohesion, k_shear, k_phi, n] = x[..] else {
            panic!("the box has five numbers")
        };
        let Pressure::Bekker(law) = base.pressure else {
            panic!("dry sand has Bekker's law")
        };
        let soil = Soil::new(SoilParams {
            pressure: Pressure::Bekker(Bekker {
                k_phi: k_phi * 1e3,
                ..law
            }),
            phi: Angle::from_deg(phi),
            cohesion: cohesion * 1e3,
            k_shear,
            n,
            ..base
        })
        .unwrap();
        let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let motion = Kinematics::straight(Slip::new(0.5).unwrap());
        let solved = contact.under_load(load * slope.cos(), &motion).unwrap();
        let left = solved.point().unwrap().forces.drawbar_pull - load * slope.sin();
        assert!(left >= proof.lower, "{left} {x:?}");
        least = least.min(left);
    }
    // The bound is no idle one: a corner comes near it.
    assert!(least - proof.lower < 0.01, "{least} {}", proof.lower);
}

#[test]
fn a_slope_is_refuted_exactly_where_the_pull_ends() {
    let wheel = RigidWheel::new(0.15, 0.12).unwrap();
    let rule = GrouserRule::Lugs {
        count: 12.0,
        thickness: 0.002,
    };
    let lugged = wheel
        .with_grousers(Grousers { height: 0.01, rule })
        .unwrap();
    refuted_where_the_pull_ends(&wheel, 0.9);
    // a lugged wheel that spins digs itself in
    refuted_where_the_pull_ends(&lugged, 0.6);
}

fn refuted_where_the_pull_ends(wheel: &RigidWheel, max_slip: f64) {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let contact = WheelOnSoil::new(*wheel, soil, Settings::default()).unwrap();
    let weight = 40.0;
    let most = |slope_deg: f64| {
        let angle = Angle::from_deg(slope_deg);
        let left = (0..=900).map(|i| {
            let motion = Kinematics::straight(Slip::new(max_slip * f64::from(i) / 900.0).unwrap());
            let solved = contact.under_load(weight * angle.cos(), &motion).unwrap();
            solved.point().unwrap().forces.drawbar_pull - weight * angle.sin()
        });
        left.fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if most(middle) >= 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let above = prove_no_slip_holds(wheel, &soil, weight, high + 0.05, max_slip, 60.0).unwrap();
    assert!(above.is_proved, "{above:?}");
    let certificate = above.certificate.unwrap();
    assert!(certificate.lower <= -most(high + 0.05), "{certificate:?}");
    let below = prove_no_slip_holds(wheel, &soil, weight, low - 0.05, max_slip, 60.0).unwrap();
    assert!(!below.is_proved && below.shortage < 0.0, "{below:?}");
}
