//! What Ani et al. 2012 (J. Cent. South Univ. 19, 2458-2467) print, or what follows from their formulas.

use grouser_real::OutOfRange;
use grouser_terra::{
    Angle, Contact, Error, Kinematics, Mobilised, ModelOutcome, ModelSlip, RigidWheel, ShearLaw,
    Slip, catalogue, entry_angle, slip_ani, slip_model,
};

fn s_0(theta_deg: f64, sinkage: f64, radius: f64) -> ModelSlip {
    match slip_model(Angle::from_deg(theta_deg), sinkage, radius, None).unwrap() {
        ModelOutcome::Slip(found) => found,
        other => panic!("S_0 always exists: {other:?}"),
    }
}

#[test]
fn figure_9_at_32_degrees() {
    for (radius, values) in [
        (0.07, [-0.1729, -0.2128, -0.2751, -0.3897]),
        (0.10, [-0.1430, -0.1709, -0.2128, -0.2859]),
        (0.18, [-0.1111, -0.1273, -0.1508, -0.1894]),
    ] {
        for (sinkage, expected) in [0.010, 0.014, 0.020, 0.030].into_iter().zip(values) {
            let got = s_0(32.0, sinkage, radius).driving_formula;
            assert!(
                (got - expected).abs() <= 5e-5,
                "r {radius} z {sinkage}: {got}"
            );
        }
    }
}

#[test]
fn s_0_is_never_positive_and_ends_in_minus_z_over_r_minus_z() {
    for z in [0.001, 0.01, 0.03] {
        let theta_1 = entry_angle(z, 0.1_f64);
        let limit = -z / (0.1 - z);
        assert!((slip_ani(theta_1, theta_1) - limit).abs() < 1e-15);
        // continuous through the removable singularity
        for step in [1e-3, 1e-6, 1e-9] {
            assert!((slip_ani(theta_1 + step, theta_1) - limit).abs() < step);
        }
        for i in -20..=20 {
            assert!(slip_ani(theta_1 * f64::from(i) / 20.0, theta_1) <= 0.0);
        }
    }
}

#[test]
fn grows_with_sinkage_and_angle_and_falls_with_radius() {
    for theta in [0.0, 5.0, 10.0] {
        let here = s_0(theta, 0.02, 0.1).driving_formula.abs();
        assert!(s_0(theta, 0.021, 0.1).driving_formula.abs() > here);
        assert!(s_0(theta + 1.0, 0.02, 0.1).driving_formula.abs() > here);
        assert!(s_0(theta, 0.02, 0.105).driving_formula.abs() < here);
    }
}

#[test]
fn the_contact_ends_before_32_degrees_at_10_mm() {
    for radius in [0.07, 0.08, 0.10, 0.18] {
        assert!(!s_0(32.0, 0.010, radius).in_contact);
    }
    assert!(s_0(32.0, 0.020, 0.10).in_contact);
    for radius in [0.05, 0.1, 0.2] {
        assert!(
            !s_0(32.0, 0.001, radius).in_contact,
            "figure 10 is outside all over"
        );
    }
}

#[test]
fn the_curve_of_the_printed_optimum() {
    // |S_0| = 0.1146 is a curve in (θ, z/r), not a point.
    for (theta, z_over_r) in [
        (0.0, 0.30189),
        (20.0, 0.15188),
        (24.0, 0.12005),
        (26.21, 0.10282),
        (32.0, 0.06026),
    ] {
        let got = s_0(theta, z_over_r, 1.0).driving_formula;
        assert!((got + 0.1146).abs() < 2e-5, "θ {theta}: {got}");
    }
}

#[test]
fn where_s_0_is_zero_so_is_the_shear_and_a_share_comes_back() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = RigidWheel::new(0.10, 0.05).unwrap();
    let (sinkage, k_shear) = (0.020, soil.params().k_shear);
    let theta = Angle::from_deg(10.0);
    for share in [0.0, 0.1, 0.3] {
        let found =
            match slip_model(theta, sinkage, 0.10, Some(Mobilised { share, k_shear })).unwrap() {
                ModelOutcome::Slip(found) => found,
                other => panic!("{other:?}"),
            };
        // The stress model at that slip mobilises just this share there.
        let contact: Contact = Contact::new(
            &wheel.size(),
            &soil.laws(),
            ShearLaw::Coupled,
            &Kinematics::straight(found.slip).motion(),
            entry_angle(sinkage, 0.10),
        );
        let tau = contact.shear_stress(theta.rad()).0;
        let strength = contact.strength_at(theta.rad());
        assert!(
            (tau / strength - share).abs() < 1e-13,
            "{share}: {}",
            tau / strength
        );
    }
}

#[test]
fn what_cannot_be_mobilised_is_an_outcome_and_the_pole_an_error() {
    let all = Mobilised {
        share: 0.99,
        k_shear: 0.025,
    };
    let outcome = slip_model(Angle::from_deg(10.0), 0.02, 0.1, Some(all)).unwrap();
    let theta_1 = entry_angle(0.02, 0.1);
    let most = 1.0 - (-0.1 * (theta_1 - 10_f64.to_radians()) / 0.025_f64).exp();
    match outcome {
        ModelOutcome::Unreachable { max_share: got } => assert!((got - most).abs() < 1e-15),
        other => panic!("{other:?}"),
    }
    let beyond = slip_model(Angle::from_deg(60.0), 0.02, 0.1, Some(all));
    assert!(matches!(
        beyond,
        Err(Error::OutOfRange(OutOfRange { field: "theta", .. }))
    ));
    assert!(matches!(
        slip_model(Angle::from_deg(10.0), 0.1, 0.1, None),
        Err(Error::HubBuried { .. })
    ));
    assert!(Slip::from_driving_formula(-1.0).is_ok_and(|slip| slip.value() == -0.5));
}
