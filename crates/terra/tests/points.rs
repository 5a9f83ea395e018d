//! What an operating point reports beside its forces, and the doors to the same numbers.

use grouser_real::{Dual, Real};
use grouser_terra::{
    Accuracy, Angle, Bulldozing, Caution, DualInputs, Entry, Error, FittedRange, GrouserRule,
    Grousers, Kinematics, LawChoice, OperatingPoint, RigidWheel, Settings, ShearLaw, SideForce,
    Slip, Soil, SoilHistory, SoilParams, WheelOnSoil, catalogue, entry_angle,
};

const RADIUS_M: f64 = 0.1;

fn sand() -> SoilParams {
    *catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap()
        .params()
}

fn under(params: SoilParams, settings: Settings) -> WheelOnSoil {
    let wheel = RigidWheel::new(RADIUS_M, 0.05).unwrap();
    WheelOnSoil::new(wheel, Soil::new(params).unwrap(), settings).unwrap()
}

fn on(params: SoilParams) -> WheelOnSoil {
    under(params, Settings::default())
}

fn straight(slip: f64) -> Kinematics {
    Kinematics::straight(Slip::new(slip).unwrap())
}

fn drifting(slip: f64, degrees: f64) -> Kinematics {
    Kinematics::with_slip_angle(Slip::new(slip).unwrap(), Angle::from_deg(degrees)).unwrap()
}

fn has(point: &OperatingPoint, caution: Caution) -> bool {
    point.cautions.contains(caution)
}

#[test]
fn cautions_begin_at_their_limits() {
    let place = |c_1: f64, c_2: f64, slip: f64| {
        let soil = SoilParams { c_1, c_2, ..sand() };
        let point = on(soil).at_sinkage(0.01, &straight(slip)).unwrap();
        (
            has(&point, Caution::NoNormalStress),
            has(&point, Caution::MaximumStressHeld),
        )
    };
    assert_eq!(place(1.0, 0.0, 0.0), (true, false));
    assert_eq!(place(0.75, 0.5, 0.5), (true, false));
    assert_eq!(place(0.99, 0.0, 0.0), (false, false));
    assert_eq!(place(0.0, 0.0, 0.0), (false, false));
    assert_eq!(place(0.25, -0.5, 0.25), (false, false));
    assert_eq!(place(0.25, -0.5, 0.75), (false, true));

    let deep = |z: f64| {
        has(
            &on(sand()).at_sinkage(z, &straight(0.2)).unwrap(),
            Caution::DeepSinkage,
        )
    };
    assert!(!deep(0.3333 * RADIUS_M) && deep(0.3334 * RADIUS_M));

    let by = |shear: ShearLaw, motion: Kinematics| {
        let settings = Settings {
            shear,
            ..Settings::default()
        };
        let point = under(sand(), settings).at_sinkage(0.02, &motion).unwrap();
        has(&point, Caution::ShearAboveStrength)
    };
    assert!(by(ShearLaw::Independent, drifting(0.2, 10.0)));
    assert!(
        !by(ShearLaw::Independent, straight(0.2)) && !by(ShearLaw::Coupled, drifting(0.2, 10.0))
    );

    let reverses = |slip: f64| {
        let point = on(sand()).at_sinkage(0.02, &straight(slip)).unwrap();
        has(&point, Caution::ShearReversal)
    };
    // q = 1.02: backwards at first, forwards at the lowest point; q = 2: backwards all along
    assert!(!reverses(0.2) && !reverses(-0.5) && !reverses(-1.0));
    assert!(reverses(1.0 / 1.09 - 1.0));

    let fitted = |load: (f64, f64), slip: f64| {
        let range = FittedRange {
            slip: (0.0, 0.5),
            slip_angle: (0.0, 0.0),
            width: (0.05, 0.05),
            load,
        };
        let soil = SoilParams {
            fitted: Some(range),
            ..sand()
        };
        let point = on(soil)
            .under_load(50.0, &straight(slip))
            .unwrap()
            .point()
            .unwrap();
        has(&point, Caution::OutsideFit)
    };
    assert!(!fitted((40.0, 60.0), 0.3) && fitted((40.0, 60.0), 0.6) && fitted((55.0, 60.0), 0.3));
    assert!(!has(
        &on(sand()).at_sinkage(0.01, &straight(0.9)).unwrap(),
        Caution::OutsideFit
    ));

    let beside = |bulldozing: Bulldozing, unit_weight: Option<f64>, degrees: f64| {
        let settings = Settings {
            bulldozing,
            ..Settings::default()
        };
        let soil = SoilParams {
            unit_weight,
            ..sand()
        };
        let point = under(soil, settings)
            .at_sinkage(0.02, &drifting(0.2, degrees))
            .unwrap();
        has(&point, Caution::NoBulldozing)
    };
    assert!(beside(Bulldozing::Scaled, None, 10.0) && beside(Bulldozing::Full, None, -10.0));
    assert!(!beside(Bulldozing::Off, None, 10.0) && !beside(Bulldozing::Scaled, Some(14e3), 10.0));
    assert!(!beside(Bulldozing::Scaled, None, 0.0));
}

#[test]
fn depths_end_at_the_hub_and_where_the_soil_rises_above_it() {
    let plain = on(sand());
    assert!(
        plain
            .forces_at(0.999_999 * RADIUS_M, &straight(0.2))
            .is_ok()
    );
    assert!(matches!(
        plain.forces_at(RADIUS_M, &straight(0.2)),
        Err(Error::HubBuried { .. })
    ));
    let rising = on(SoilParams {
        rebound: 2.0,
        ..sand()
    });
    assert!(
        rising
            .forces_at(0.499_999 * RADIUS_M, &straight(0.2))
            .is_ok()
    );
    let above = rising
        .forces_at(0.5 * RADIUS_M, &straight(0.2))
        .unwrap_err();
    assert!(matches!(above, Error::ReboundAboveHub { .. }) && above.field() == Some("rebound"));
    let disc = on(SoilParams {
        unit_weight: Some(14e3),
        laws: LawChoice {
            bulldozing: Some(Bulldozing::Disc),
            ..LawChoice::default()
        },
        ..sand()
    });
    let deepest = |degrees: f64, share: f64| {
        disc.forces_at(share * RADIUS_M, &drifting(0.2, degrees))
            .is_ok()
    };
    assert!(deepest(60.1, 1.499) && !deepest(60.1, 1.501) && deepest(-60.1, 1.499));
    assert!(!deepest(59.9, 1.001) && deepest(59.9, 0.999));
    let point = disc
        .at_sinkage(1.1 * RADIUS_M, &drifting(0.2, 70.0))
        .unwrap();
    assert!(has(&point, Caution::HubInSoil));
    let point = disc
        .at_sinkage(0.9 * RADIUS_M, &drifting(0.2, 70.0))
        .unwrap();
    assert!(!has(&point, Caution::HubInSoil));
    // an exponent that slip makes none
    let digging = on(SoilParams { n_1: 3.0, ..sand() });
    assert!(digging.forces_at(0.01, &straight(0.5)).is_ok());
    for fails in [
        digging.forces_at(0.01, &straight(0.9)).err(),
        digging.at_sinkage(0.01, &straight(0.9)).err(),
        digging.under_load(10.0, &straight(0.9)).err(),
    ] {
        assert_eq!(
            fails.and_then(|error| error.field()),
            Some("n at this slip")
        );
    }
}

/// A step in time on soil whose history is its own motion has the forces of the operating point.
#[test]
fn a_steady_history_changes_nothing() {
    let plain = sand();
    let disc = LawChoice {
        bulldozing: Some(Bulldozing::Disc),
        ..LawChoice::default()
    };
    let entry = Entry::new(0.02, RADIUS_M);
    assert_eq!(
        (entry.sinkage(), entry.theta_1()),
        (0.02, entry_angle(0.02, RADIUS_M))
    );
    for soil in [
        plain,
        SoilParams {
            k_shear_1: 0.02,
            ..plain
        },
        SoilParams {
            k_shear_side: Some(0.03),
            k_shear_side_1: 0.02,
            laws: LawChoice {
                shear: Some(ShearLaw::Independent),
                ..LawChoice::default()
            },
            ..plain
        },
        SoilParams {
            sideways_support: 0.3,
            ..plain
        },
        SoilParams {
            unit_weight: Some(14e3),
            laws: disc,
            ..plain
        },
        SoilParams { n_1: 0.3, ..plain },
    ] {
        let on_soil = on(soil);
        for degrees in [75.0, -75.0, 0.0] {
            let motion = drifting(0.2, degrees);
            let steady = SoilHistory::steady(motion);
            let point = on_soil.at_sinkage(0.02, &motion).unwrap();
            let after = |side| {
                on_soil
                    .forces_after(&entry, &motion, &steady, side)
                    .unwrap()
            };
            let (forces, side) = after(SideForce::Whole);
            let size = point
                .forces
                .vertical_force
                .abs()
                .max(point.forces.torque.abs() / RADIUS_M);
            for (a, b) in [
                (forces.vertical_force, point.forces.vertical_force),
                (forces.drawbar_pull, point.forces.drawbar_pull),
                (forces.torque / RADIUS_M, point.forces.torque / RADIUS_M),
                (side, point.side_force),
            ] {
                assert!((a - b).abs() < 1e-12 * size, "{soil:?} {degrees}: {a} {b}");
            }
            let by_shear = -forces.side_shear * (degrees / 75.0);
            assert_eq!(after(SideForce::Shear), (forces, by_shear));
            if degrees == 0.0 {
                assert!(after(SideForce::Shear).1.is_sign_positive());
            }
            // drift to the left is pushed to the right
            assert_eq!(
                side.signum(),
                if degrees == 0.0 {
                    1.0
                } else {
                    -degrees.signum()
                }
            );
        }
        // another K is another soil
        let (motion, factor) = (drifting(0.2, 20.0), 0.6);
        let stiffer = on(SoilParams {
            k_shear: factor * soil.k_shear,
            k_shear_1: factor * soil.k_shear_1,
            k_shear_side: soil.k_shear_side.map(|k| factor * k),
            k_shear_side_1: factor * soil.k_shear_side_1,
            ..soil
        });
        let history = SoilHistory::steady(motion).with_k_shear_factor(factor);
        let (after, _) = on_soil
            .forces_after(&entry, &motion, &history, SideForce::Shear)
            .unwrap();
        let expected = stiffer.forces_at(0.02, &motion).unwrap();
        assert!(
            (after.drawbar_pull - expected.drawbar_pull).abs() < 1e-12 * expected.vertical_force
        );
        assert!((after.side_shear - expected.side_shear).abs() < 1e-12 * expected.vertical_force);
        for bad in [0.0, 1001.0, f64::NAN] {
            let history = SoilHistory::steady(motion).with_k_shear_factor(bad);
            let after = on_soil.forces_after(&entry, &motion, &history, SideForce::Shear);
            assert!(after.is_err());
        }
    }
}

#[test]
fn a_wheel_that_rolls_backwards_has_a_mirrored_point() {
    let on_soil = on(SoilParams {
        rebound: 0.2,
        ..sand()
    });
    let at = |sense: f64| {
        let motion = Kinematics::from_speeds(0.7 * sense, 0.1, sense).unwrap();
        on_soil.at_sinkage(0.02, &motion).unwrap()
    };
    let (ahead, back) = (at(1.0), at(-1.0));
    assert_eq!(back.angles.theta_1, -ahead.angles.theta_1);
    assert_eq!(back.angles.theta_2, -ahead.angles.theta_2);
    assert_eq!(back.angles.theta_m, -ahead.angles.theta_m);
    assert!(ahead.angles.theta_2 < 0.0 && ahead.angles.theta_m > 0.0);
    let (a, b) = (ahead.forces, back.forces);
    assert_eq!(
        (b.thrust, b.compaction_resistance),
        (-a.thrust, -a.compaction_resistance)
    );
    assert_eq!(
        (b.vertical_force, b.lost_work),
        (a.vertical_force, a.lost_work)
    );
    assert_eq!(
        (b.side_shear, back.side_force),
        (a.side_shear, ahead.side_force)
    );
    assert!((ahead.sinkage - 0.02).abs() < 1e-15 && ahead.side_force < 0.0);
}

/// The estimate is how far the next finer rule lies.
#[test]
fn the_error_estimate_is_the_finer_rules_distance() {
    let motion = drifting(-0.3, 20.0);
    let of = |accuracy: Accuracy| {
        on(sand())
            .with_accuracy(accuracy)
            .at_sinkage(0.02, &motion)
            .unwrap()
    };
    let (quick, standard) = (of(Accuracy::Simulation), of(Accuracy::Standard));
    let apart = [
        quick.forces.vertical_force - standard.forces.vertical_force,
        quick.forces.drawbar_pull - standard.forces.drawbar_pull,
        (quick.forces.torque - standard.forces.torque) / RADIUS_M,
    ];
    let most = apart
        .into_iter()
        .fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(most > 0.0 && (quick.error_estimate() - most).abs() < 1e-2 * most);
}

/// Numbers with derivatives have the values of plain ones, the side force with its sign and what is ploughed.
#[test]
fn dual_points_have_the_values_of_plain_ones() {
    for (bulldozing, unit_weight) in [
        (Bulldozing::Scaled, None),
        (Bulldozing::Scaled, Some(14e3)),
        (Bulldozing::Full, Some(14e3)),
        (Bulldozing::Disc, Some(14e3)),
    ] {
        let soil = SoilParams {
            unit_weight,
            ..sand()
        };
        let settings = Settings {
            bulldozing,
            ..Settings::default()
        };
        let on_soil = under(soil, settings);
        for degrees in [0.0, 25.0, -25.0, 70.0] {
            let motion = drifting(0.2, degrees);
            let point = on_soil.under_load(40.0, &motion).unwrap().point().unwrap();
            let inputs = DualInputs::<1>::new(&on_soil, &motion);
            let found = inputs
                .under_load(&on_soil, &motion, Dual::variable(40.0, 0))
                .unwrap()
                .unwrap();
            for (dual, plain) in [
                (found.sinkage, point.sinkage),
                (found.theta_1, point.angles.theta_1),
                (found.forces.vertical_force, point.forces.vertical_force),
                (found.forces.drawbar_pull, point.forces.drawbar_pull),
                (found.side_force, point.side_force),
            ] {
                assert!(
                    (dual.value - plain).abs() < 1e-6 * plain.abs().max(1e-3),
                    "{bulldozing:?} {degrees}"
                );
            }
            assert!((found.forces.vertical_force.gradient[0] - 1.0).abs() < 1e-6);
            // how the sinkage grows with the load
            let more = on_soil
                .under_load(40.004, &motion)
                .unwrap()
                .point()
                .unwrap();
            let growth = (more.sinkage - point.sinkage) / 0.004;
            assert!((found.sinkage.gradient[0] / growth - 1.0).abs() < 1e-3);
        }
        let none = DualInputs::<1>::new(&on_soil, &straight(0.2));
        assert!(
            none.under_load(&on_soil, &straight(0.2), Dual::constant(1e9))
                .unwrap()
                .is_none()
        );
    }
}

/// Where shear along the slip velocity jumps, in front of the greatest stress and behind it, with lugs and without.
#[test]
fn a_jump_of_the_shear_has_its_derivative() {
    let lugs = Grousers {
        height: 0.005,
        rule: GrouserRule::Lugs {
            count: 24.0,
            thickness: 0.001,
        },
    };
    for lugged in [false, true] {
        for slip in [-0.01, -0.05, -0.15] {
            let soil = SoilParams {
                c_1: 0.6,
                c_2: 0.0,
                rebound: 0.3,
                ..sand()
            };
            let mut wheel = RigidWheel::new(RADIUS_M, 0.05).unwrap();
            if lugged {
                wheel = wheel.with_grousers(lugs).unwrap();
            }
            let settings = Settings {
                shear: ShearLaw::SlipVelocity,
                accuracy: Accuracy::Reference,
                ..Settings::default()
            };
            let on_soil = WheelOnSoil::new(wheel, Soil::new(soil).unwrap(), settings).unwrap();
            let mut inputs = DualInputs::<1>::new(&on_soil, &straight(slip));
            inputs.motion.slip = Dual::variable(slip, 0);
            let exact = inputs.forces(Dual::constant(entry_angle(0.02, RADIUS_M)));
            let step = 1e-6;
            let at = |slip: f64| on_soil.forces_at(0.02, &straight(slip)).unwrap();
            let (high, low, here) = (at(slip + step), at(slip - step), at(slip));
            for (dual, value, difference) in [
                (
                    exact.vertical_force,
                    here.vertical_force,
                    high.vertical_force - low.vertical_force,
                ),
                (
                    exact.drawbar_pull,
                    here.drawbar_pull,
                    high.drawbar_pull - low.drawbar_pull,
                ),
                (
                    exact.torque / Dual::from_f64(RADIUS_M),
                    here.torque / RADIUS_M,
                    (high.torque - low.torque) / RADIUS_M,
                ),
            ] {
                let slope = difference / (2.0 * step);
                let size = here.vertical_force.abs();
                assert!(
                    (dual.value - value).abs() < 1e-8 * size,
                    "{lugged} {slip}: {dual:?} {value}"
                );
                let off = (dual.gradient[0] - slope).abs();
                assert!(
                    off < 1e-4 * (slope.abs() + size),
                    "{lugged} {slip}: {dual:?} {slope}"
                );
            }
        }
    }
}

/// At one slip an exponent that grows with slip is that of another soil.
#[test]
fn a_digging_soil_is_another_soil_at_each_slip() {
    for (n_1, n_2, slip) in [(0.3, 0.0, 0.4), (0.0, 0.3, -0.4)] {
        let digging = on(SoilParams { n_1, n_2, ..sand() });
        let n = sand().n + 0.3 * 0.4;
        let there = on(SoilParams { n, ..sand() });
        let (a, b) = (
            digging.forces_at(0.02, &straight(slip)).unwrap(),
            there.forces_at(0.02, &straight(slip)).unwrap(),
        );
        assert!((a.vertical_force - b.vertical_force).abs() < 1e-8 * b.vertical_force);
        assert!((a.torque - b.torque).abs() < 1e-8 * b.vertical_force * RADIUS_M);
    }
}
