//! What small functions give, by hand: names, sizes, speeds, and closed forms of single laws.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use grouser_terra::{
    Accuracy, Angle, Bulldozing, Caution, Cautions, Error, FittedRange, GrouserRule, Grousers,
    Kinematics, Mobilised, ModelOutcome, MohrCoulomb, MultiPass, OpenSoil, OperatingPoint,
    RigidWheel, Settings, ShearLaw, SinkageExponent, Slip, SlipNorm, SlipSinkage, Soil, SoilParams,
    SolveStatus, StressPosition, WheelMotion, WheelOnSoil, bulldozing_hegedus, catalogue,
    entry_angle, gravity_of, level_off, lug_mobilisation, lug_spacing_skonieczny,
    lug_transport_layer, passive_pressure_coulomb, sinkage_from_entry_angle, slip_ani, slip_model,
    transition_angle_wong_reece, transport_depth_reece,
};

fn near(got: f64, expected: f64) {
    assert!(
        (got - expected).abs() <= 1e-13 * expected.abs().max(1.0),
        "{got} {expected}"
    );
}

fn slip(value: f64) -> Slip {
    Slip::new(value).unwrap()
}

fn straight(value: f64) -> Kinematics {
    Kinematics::straight(slip(value))
}

fn sand() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

#[test]
fn names_in_files() {
    let keys = Bulldozing::ALL.map(Bulldozing::key);
    assert_eq!(keys, ["scaled", "full", "chord", "disc", "off"]);
    let keys = StressPosition::ALL.map(StressPosition::key);
    let expected = ["in-plane", "magnitude", "whole", "sliding", "saturating"];
    assert_eq!(keys, expected);
    let keys = ShearLaw::ALL.map(ShearLaw::key);
    let expected = [
        "coupled",
        "slip-velocity",
        "slip-velocity-regular",
        "independent",
        "towed-restart",
        "towed-wong-reece",
    ];
    assert_eq!(keys, expected);
    let keys = SlipSinkage::ALL.map(SlipSinkage::key);
    assert_eq!(keys, ["in-plane", "whole", "saturating", "ploughing"]);
    let keys = [SlipNorm::Greater, SlipNorm::Root].map(SlipNorm::key);
    assert_eq!(keys, ["greater", "root"]);
    // codes of foreign interfaces: a new one comes last
    let states = SolveStatus::ALL.map(|status| (status.code(), status.key()));
    let expected = [
        (0, "ok"),
        (1, "no-solution"),
        (2, "not-converged"),
        (3, "bad-input"),
    ];
    assert!(states.starts_with(&expected), "{states:?}");
}

#[test]
fn cautions_are_a_set() {
    let all = [
        (Caution::NoNormalStress, "no-normal-stress"),
        (Caution::MaximumStressHeld, "maximum-stress-held"),
        (Caution::DeepSinkage, "deep-sinkage"),
        (Caution::ShearReversal, "shear-reversal"),
        (Caution::ShearAboveStrength, "shear-above-strength"),
        (Caution::NoBulldozing, "no-bulldozing"),
        (Caution::SeveralSinkages, "several-sinkages"),
        (Caution::WorkGained, "work-gained"),
        (Caution::LugSpacing, "lug-spacing"),
        (Caution::LugHeight, "lug-height"),
        (Caution::OutsideFit, "outside-fit"),
        (Caution::HubInSoil, "hub-in-soil"),
        (Caution::LoadBelowResolution, "load-below-resolution"),
    ];
    let mut cautions = Cautions::default();
    assert!(cautions.is_empty());
    for (count, (caution, key)) in all.into_iter().enumerate() {
        assert_eq!(caution.key(), key);
        cautions.insert_if(false, caution);
        assert!(!cautions.contains(caution) && cautions.iter().count() == count);
        cautions.insert(caution);
        cautions.insert_if(true, caution);
        assert!(cautions.contains(caution) && !cautions.is_empty());
    }
    assert!(cautions.iter().eq(all.map(|(caution, _)| caution)));
    let texts: BTreeSet<String> = all.iter().map(|(caution, _)| caution.to_string()).collect();
    assert!(texts.len() == all.len() && texts.iter().all(|text| text.len() > 20));
}

#[test]
fn slips_of_speeds() {
    near(Angle::from_rad(FRAC_PI_2).deg(), 90.0);
    assert!(slip(0.0).is_driving() && slip(0.3).is_driving() && !slip(-1e-3).is_driving());
    // at rest on a turning rim and sliding on a locked one, whichever the sense
    for (forward, rim, expected) in [
        (0.0, 0.5, 1.0),
        (0.0, -0.5, 1.0),
        (0.5, 0.0, -1.0),
        (-0.5, 0.0, -1.0),
        (-0.3, -0.4, 0.25),
        (0.4, 0.3, -0.25),
    ] {
        near(Slip::from_speeds(forward, rim).unwrap().value(), expected);
    }
    for (forward, rim) in [(0.1, -0.2), (-0.1, 0.2), (0.0, 0.0)] {
        assert!(matches!(
            Slip::from_speeds(forward, rim),
            Err(Error::NoSlip { .. })
        ));
    }
    for (forward, rim) in [(f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        assert!(matches!(
            Slip::from_speeds(forward, rim),
            Err(Error::NotFinite { .. })
        ));
    }
    // a speed of the noise's size is none
    let at_noise = WheelMotion::from_speeds(0.002, 0.5, 0.002).unwrap();
    let expected = WheelMotion::Rolling {
        slip: slip(1.0),
        reversed: false,
    };
    assert_eq!(at_noise, expected);
    near(Slip::from_driving_formula(-0.25).unwrap().value(), -0.2);
    // 45° while the rim turns twice as fast as the wheel goes forward
    let motion = Kinematics::with_slip_angle(slip(0.5), Angle::from_deg(45.0)).unwrap();
    near(motion.q_y(), 0.5);
    let locked = Kinematics::with_slip_angle(slip(-1.0), Angle::from_deg(45.0)).unwrap();
    near(locked.q_y(), 1.0);
    assert!(Kinematics::with_slip_angle(slip(0.5), Angle::from_deg(-89.95)).is_err());
    assert!(Kinematics::from_speeds(1.0, f64::NAN, 1.0).is_err());
    assert!(Kinematics::with_drift(slip(0.0), f64::NAN).is_err());
    let back = Kinematics::from_speeds(-0.4, 0.3, -0.8).unwrap();
    assert!(back.is_reversed());
    near(back.slip().value(), 0.5);
    near(back.q_y(), 0.375);
    near(back.slip_angle().rad(), 0.75_f64.atan());
}

#[test]
fn open_soils_are_soils_again() {
    let params = *sand().params();
    assert_eq!(OpenSoil::from(params).params().unwrap(), params);
    let completion = catalogue::Completion {
        k_shear: Some(0.02),
        c_1: Some(0.4),
        c_2: Some(0.2),
        unit_weight: Some(15e3),
    };
    let clay = catalogue::find("heavy-clay-25-wes").unwrap();
    let open: BTreeSet<&str> = clay.missing().collect();
    assert_eq!(open, BTreeSet::from(["k_shear", "c_1", "c_2"]));
    let soil = clay.completed(&completion).unwrap();
    let got = soil.params();
    assert_eq!((got.k_shear, got.c_1, got.c_2), (0.02, 0.4, 0.2));
    assert_eq!((got.unit_weight, got.n), (Some(15e3), clay.n));
    assert!(clay.soil().is_err() && catalogue::find("cheese").is_none());
}

#[test]
fn wheels_with_grousers() {
    let bare = RigidWheel::new(0.1, 0.05).unwrap();
    let of = |height, rule| bare.with_grousers(Grousers { height, rule });
    let sizes = |wheel: RigidWheel| {
        [
            wheel.running_radius(),
            wheel.shear_radius(),
            wheel.tip_share(),
        ]
    };
    assert_eq!(sizes(bare), [0.1, 0.1, 1.0]);
    assert_eq!(
        sizes(of(0.02, GrouserRule::Tips).unwrap()),
        [0.1 + 0.02, 0.1 + 0.02, 1.0]
    );
    let share = of(0.02, GrouserRule::AreaShare { tips: 0.3 }).unwrap();
    assert_eq!(sizes(share), [0.1 + 0.02, 0.1, 0.3]);
    let lugs = |count, thickness| of(0.01, GrouserRule::Lugs { count, thickness });
    assert_eq!(sizes(lugs(20.0, 0.001).unwrap()), [0.1, 0.1, 1.0]);
    // lugs without gaps fill the rim
    let room = TAU * 0.1 / 20.0;
    assert!(lugs(20.0, 0.999 * room).is_ok());
    assert_eq!(
        lugs(20.0, 1.001 * room).unwrap_err().field(),
        Some("lug_thickness")
    );
    assert_eq!(lugs(0.5, 0.001).unwrap_err().field(), Some("lug_count"));
    assert!(of(0.11, GrouserRule::Tips).is_err());
    assert!(of(0.01, GrouserRule::AreaShare { tips: 1.1 }).is_err());
}

#[test]
fn a_fits_range_holds_with_a_hundredth_beyond() {
    let range = FittedRange {
        slip: (-0.5, 0.75),
        slip_angle: (0.25, 0.5),
        width: (0.05, 0.1),
        load: (20.0, 40.0),
    };
    range.check().unwrap();
    let holds = |s: f64, beta: f64, width: f64, load: f64| {
        let motion = Kinematics::with_slip_angle(slip(s), Angle::from_rad(beta)).unwrap();
        range.holds(&motion, width, load)
    };
    for (inside, outside, at) in [
        (-0.504, -0.506, 0),
        (0.757, 0.758, 0),
        (0.248, 0.247, 1),
        (-0.504, -0.506, 1),
        (0.0496, 0.0494, 2),
        (0.1009, 0.1011, 2),
        (19.81, 19.79, 3),
        (40.39, 40.41, 3),
    ] {
        let with = |x: f64| {
            let mut point = [0.5, 0.3, 0.08, 30.0];
            point[at] = x;
            holds(point[0], point[1], point[2], point[3])
        };
        assert!(with(inside) && !with(outside), "{inside} {outside}");
    }
    // a width of 0.5 exactly beyond which nothing is allowed
    let exact = FittedRange {
        slip: (0.0, 0.0),
        slip_angle: (0.0, 0.0),
        ..range
    };
    assert!(exact.holds(&straight(0.0), 0.05, 20.0));
    for (slip, slip_angle, width) in [
        ((-1.1, 0.5), (0.0, 0.1), (0.1, 0.2)),
        ((0.5, 0.4), (0.0, 0.1), (0.1, 0.2)),
        ((0.0, 0.5), (-0.1, 0.1), (0.1, 0.2)),
        ((0.0, 0.5), (0.0, 0.1), (0.1, f64::NAN)),
    ] {
        let bad = FittedRange {
            slip,
            slip_angle,
            width,
            ..range
        };
        assert!(bad.check().is_err());
    }
    let whole = FittedRange {
        slip: (-1.0, 1.0),
        ..range
    };
    whole.check().unwrap();
}

#[test]
fn gravities() {
    let of = ["earth", "moon", "mars", "venus"].map(gravity_of);
    assert_eq!(of, [Some(9.806_65), Some(1.62), Some(3.71), None]);
}

/// In metres: how far ahead of the axle a lug's tip and the rim meet the ground, over the way between two lugs.
#[test]
fn lugs_enter_before_the_rim() {
    for (r, h, z, s) in [
        (0.058, 0.005, 0.015, 0.2),
        (0.157, 0.01, 0.04, 0.0),
        (0.1, 0.02, 0.01, 0.7),
    ] {
        let ahead = |reach: f64| f64::sqrt(reach * reach - (r - z) * (r - z));
        let expected = (ahead(r + h) - ahead(r)) / (r * (1.0 - s));
        near(lug_spacing_skonieczny(r, h, z, s), expected);
    }
    assert_eq!(lug_spacing_skonieczny(0.1, 0.01, 0.02, 1.0), f64::INFINITY);
    near(
        lug_transport_layer(0.01, 20.0, 0.002, 0.1),
        0.005 * (1.0 - 0.2 / PI),
    );
    near(lug_mobilisation(0.01, 20.0, 0.1), 1.75 / PI);
}

fn lugged(height: f64, count: f64) -> WheelOnSoil {
    let rule = GrouserRule::Lugs {
        count,
        thickness: 0.001,
    };
    let wheel = RigidWheel::new(0.1, 0.05).unwrap();
    let wheel = wheel.with_grousers(Grousers { height, rule }).unwrap();
    let soil = sand().with_rebound(0.2).unwrap();
    WheelOnSoil::new(wheel, soil, Settings::default()).unwrap()
}

#[test]
fn lugs_that_are_too_far_apart_are_cautioned_of() {
    let z = 0.01;
    for s in [0.0, 0.3] {
        let spacing = lug_spacing_skonieczny(0.1, 0.005, z, s);
        let is_sparse = |count: f64, s: f64| {
            let point = lugged(0.005, count).at_sinkage(z, &straight(s)).unwrap();
            point.cautions.contains(Caution::LugSpacing)
        };
        assert!(is_sparse(0.99 * TAU / spacing, s) && !is_sparse(1.01 * TAU / spacing, s));
        // a braked wheel may
        assert!(!is_sparse(0.99 * TAU / spacing, -0.1));
    }
    // up to a tenth of the radius they were tried
    for (height, high) in [(0.01, false), (0.0101, true)] {
        let point = lugged(height, 24.0).at_sinkage(z, &straight(0.3)).unwrap();
        assert_eq!(point.cautions.contains(Caution::LugHeight), high);
    }
    let flat = lugged(0.0, 10.0).at_sinkage(z, &straight(0.3)).unwrap();
    assert!(!flat.cautions.contains(Caution::LugSpacing));
    assert!(lugged(0.0, 10.0).lug_passage(&flat).is_none());
}

/// The faces of the lugs in the soil, one after the other, at 1024 turns of the wheel.
#[test]
fn the_passage_of_lugs_is_a_sum_over_their_faces() {
    for (count, height) in [(4.0, 0.005), (24.0, 0.005), (60.0, 0.01)] {
        let on_soil = lugged(height, count);
        let point = on_soil.at_sinkage(0.015, &straight(0.3)).unwrap();
        let passage = on_soil.lug_passage(&point).unwrap();
        let (first, last) = (point.angles.theta_1, point.angles.theta_2);
        let gain = count * height / (TAU * 0.1);
        let sums: Vec<[f64; 2]> = (0..1024)
            .map(|turn| {
                let lugs = (0..60)
                    .map(|k| first - TAU / count * (f64::from(turn) / 1024.0 + f64::from(k)));
                let force = |theta: f64| point.shear_stress(theta).0 * height * 0.05 / (1.0 + gain);
                let in_soil: Vec<f64> = lugs.filter(|theta| *theta > last).collect();
                let pull = in_soil
                    .iter()
                    .map(|theta| force(*theta) * theta.cos())
                    .sum();
                [pull, in_soil.iter().map(|theta| force(*theta) * 0.1).sum()]
            })
            .collect();
        let range = |k: usize| {
            let of = || sums.iter().map(|sum| sum[k]);
            of().fold(f64::MIN, f64::max) - of().fold(f64::MAX, f64::min)
        };
        assert!(
            (passage.pull - range(0)).abs() < 0.01 * range(0),
            "{passage:?} {}",
            range(0)
        );
        assert!((passage.torque - range(1)).abs() < 0.01 * range(1));
        assert!(range(0) > 0.1 && range(1) > 0.01);
        near(passage.spacing, TAU / count);
        near(passage.in_soil, (first - last) * count / TAU);
    }
}

#[test]
fn what_an_operating_point_shows() {
    let wheel = RigidWheel::new(0.1, 0.05).unwrap();
    let on_soil = WheelOnSoil::new(wheel, sand(), Settings::default()).unwrap();
    let at = |v: f64, rim: f64| {
        let motion = Kinematics::from_speeds(v, 0.0, rim).unwrap();
        on_soil.at_sinkage(0.006, &motion).unwrap()
    };
    let check = |point: &OperatingPoint, q: f64, sense: f64| {
        let (pull, torque) = (
            sense * point.forces.drawbar_pull,
            sense * point.forces.torque,
        );
        let efficiency = (pull > 0.0 && torque > 0.0).then(|| pull * q * 0.1 / torque);
        assert_eq!(point.tractive_efficiency().is_some(), efficiency.is_some());
        near(
            point.tractive_efficiency().unwrap_or(0.0),
            efficiency.unwrap_or(0.0),
        );
        near(point.energy_per_metre().unwrap(), torque / q / 0.1);
        let ratio = point.forces.drawbar_pull / point.forces.vertical_force;
        near(point.pull_coefficient().unwrap(), ratio);
        near(point.gradeability().unwrap().rad(), ratio.atan());
        efficiency.is_some()
    };
    assert!(check(&at(0.6, 1.0), 0.6, 1.0) && check(&at(-0.6, -1.0), 0.6, -1.0));
    assert!(!check(&at(1.0, 0.8), 1.25, 1.0) && !check(&at(-1.0, -0.8), 1.25, -1.0));
    assert_eq!(at(0.0, 1.0).energy_per_metre(), None);
    assert_eq!(at(0.0, 1.0).tractive_efficiency(), Some(0.0));
    assert_eq!(at(1.0, 0.0).energy_per_metre(), Some(0.0));
    // at the entry nothing has moved; both senses of rolling are mirror images
    let (ahead, back) = (at(0.6, 1.0), at(-0.6, -1.0));
    let theta = 0.3 * ahead.angles.theta_1;
    let (sigma, tau) = (ahead.normal_stress(theta), ahead.shear_stress(theta));
    assert!(sigma > 1e3 && tau.0 > 100.0 && tau.0 < sigma + 1e3 && tau.1 == 0.0);
    assert_eq!(
        (back.normal_stress(-theta), back.shear_stress(-theta)),
        (sigma, tau)
    );
    assert_eq!(
        (ahead.normal_stress(-theta), ahead.shear_stress(-theta).0),
        (0.0, 0.0)
    );
    let none = on_soil.at_sinkage(0.0, &straight(0.3)).unwrap();
    assert_eq!(
        (none.pull_coefficient(), none.gradeability().is_some()),
        (None, false)
    );
}

#[test]
fn single_laws() {
    assert_eq!(
        MultiPass::new(0.12, 0.17, 0.035).unwrap().numbers(),
        [0.12, 0.17, 0.035]
    );
    let n = SinkageExponent {
        n_0: 1.0,
        n_1: 0.5,
        n_2: 0.25,
    };
    near(n.at(0.4), 1.2);
    near(n.at(-0.4), 1.1);
    near(level_off(0.4), 0.32);
    let velocity = |along, across| {
        let mut velocity = straight(0.0).motion::<f64>().slip_velocity();
        (velocity.along, velocity.across) = (along, across);
        velocity
    };
    // n_1 · 0.6 and n_2 · 0.4; n_2 hypot(0.3, 0.4)
    near(n.at_whole(&velocity(0.6, 0.4)), 1.0 + 0.3_f64.hypot(0.1));
    near(n.at_whole(&velocity(-0.3, 0.4)), 1.0 + 0.25 * 0.5);
    near(
        n.at_saturating(&velocity(0.6, 0.4)),
        1.0 + 0.21_f64.hypot(0.08),
    );
    near(n.at_saturating(&velocity(-0.3, 0.4)), 1.0 + 0.25 * 0.375);
    // g(0.4) = 0.416
    near(
        n.at_ploughing(&velocity(-0.4, 0.0), 0.3),
        1.0 + 0.25 * 0.416_f64.hypot(0.3),
    );
    near(
        n.at_ploughing(&velocity(0.6, 0.4), 0.3),
        1.0 + 0.21_f64.hypot(0.075),
    );
    // V = 0.5, m = max(1, V) or hypot(1, V)
    let motion = Kinematics::from_speeds(0.3, 0.4, 1.0)
        .unwrap()
        .motion::<f64>();
    near(
        motion.sideways_ploughing(SlipNorm::Greater),
        0.8 * 0.5_f64.cbrt(),
    );
    let root = 1.25_f64.sqrt();
    near(
        motion.sideways_ploughing(SlipNorm::Root),
        0.8 * (0.5 / root).cbrt(),
    );
    let moved = motion.slip_velocity_by(SlipNorm::Root);
    near(moved.along, 0.7 / root);
    near(moved.across, 0.4 / root);
    near(moved.ploughing, (0.5 - 0.6) / root);
    near(moved.sliding(), 0.65_f64.sqrt() / root);
    near(moved.working(), 0.7 / root);
    let braked = Kinematics::from_speeds(1.0, 0.0, 0.6)
        .unwrap()
        .motion::<f64>();
    assert_eq!(braked.sideways_ploughing(SlipNorm::Greater), 0.0);
    let on_the_spot = straight(1.0).motion::<f64>();
    assert_eq!(on_the_spot.sideways_ploughing(SlipNorm::Root), 0.0);
    near(braked.slip_velocity().braking(), 0.4);
    near(braked.slip_velocity().working(), 0.4);
    // carried backwards by the rim, over the way
    near(transport_depth_reece(0.01, &motion), 0.01 * 0.7 / 0.5);
    assert_eq!(transport_depth_reece(0.01, &braked), 0.0);
    // φ = 30°: X_c = 30°, D_1 = 2√3, D_2 = 2√3
    let strength = MohrCoulomb {
        cohesion: 500.0,
        phi: PI / 6.0,
    };
    let three = 3_f64.sqrt();
    let expected = 2.0 * three * (500.0 * 0.02 + three * 14e3 * 4e-4);
    near(strength.strength(300.0), 500.0 + 300.0 / three);
    near(bulldozing_hegedus(&strength, 14e3, 0.02), expected);
    near(passive_pressure_coulomb(PI / 6.0, 0.0), 3.0);
    near(passive_pressure_coulomb(0.0, 0.75), 1.25);
    // tan δ = √3/3: sin φ + t cos φ = 1, so the root is √½
    let rest = 1.0 - 0.5_f64.sqrt();
    let expected = 0.75 * (4.0_f64 / 3.0).sqrt() / (rest * rest);
    near(passive_pressure_coulomb(PI / 6.0, three / 3.0), expected);
    near(sinkage_from_entry_angle(PI / 3.0, 0.1), 0.05);
    let theta_0: f64 = transition_angle_wong_reece(PI / 6.0, 1.25).unwrap();
    near((theta_0.cos() - 0.8) / theta_0.sin(), 1.0 / three);
    assert_eq!(transition_angle_wong_reece(PI / 6.0, 1.0), None);
}

#[test]
fn the_slip_models_formula_as_printed() {
    // [θ_1 − θ + (K/r) ln(1 − x)]/(sin θ_1 − sin θ) = 1 − S
    let (r, z, k_shear) = (0.1, 0.02, 0.01);
    let theta_1 = f64::acos(1.0 - z / r);
    for (theta, share) in [(0.2, 0.5), (-0.1, 0.3), (0.63, 0.05), (0.3, 0.0)] {
        let mobilised = Some(Mobilised { share, k_shear });
        let arc = theta_1 - theta + k_shear / r * f64::ln(1.0 - share);
        let expected = 1.0 - arc / (theta_1.sin() - theta.sin());
        let ModelOutcome::Slip(found) =
            slip_model(Angle::from_rad(theta), z, r, mobilised).unwrap()
        else {
            panic!("{theta} {share} is reached");
        };
        assert!(
            (found.driving_formula - expected).abs() < 1e-12,
            "{found:?} {expected}"
        );
        near(found.theta_1.rad(), theta_1);
        assert!(found.in_contact);
    }
    // to the series beside θ_1 and back; the printed form loses three digits there
    for apart in [0.001, 0.019, 0.021] {
        let theta = theta_1 - apart;
        let expected = 1.0 - apart / (theta_1.sin() - theta.sin());
        assert!((slip_ani(theta, theta_1) - expected).abs() < 1e-12);
    }
    let outside = slip_model(Angle::from_deg(60.0), z, r, None).unwrap();
    assert!(matches!(outside, ModelOutcome::Slip(found) if !found.in_contact));
    let last = slip_model(Angle::from_rad(-entry_angle(z, r)), z, r, None).unwrap();
    assert!(matches!(last, ModelOutcome::Slip(found) if found.in_contact));
    let field = |theta: f64, z: f64, r: f64, mobilised| {
        let error = slip_model(Angle::from_rad(theta), z, r, mobilised).unwrap_err();
        error.field().unwrap()
    };
    let with = |share, k_shear| Some(Mobilised { share, k_shear });
    assert_eq!(field(0.1, 0.0, 0.1, None), "sinkage");
    assert_eq!(field(0.1, 0.1, 0.1, None), "sinkage");
    assert_eq!(field(0.1, 0.1, 0.0, None), "radius");
    assert_eq!(field(0.1, 0.1, f64::INFINITY, None), "radius");
    assert_eq!(field(1.6, 0.02, 0.1, None), "theta");
    assert_eq!(field(-1.6, 0.02, 0.1, None), "theta");
    assert_eq!(field(0.1, 0.02, 0.1, with(1.1, 0.01)), "mobilised");
    assert_eq!(field(0.1, 0.02, 0.1, with(0.5, 0.0)), "k_shear");
    assert_eq!(field(0.65, 0.02, 0.1, with(0.5, 0.01)), "theta");
    let all = slip_model(Angle::from_rad(0.2), z, r, with(0.999, k_shear)).unwrap();
    let most = 1.0 - f64::exp(-(theta_1 - 0.2) * r / k_shear);
    assert!(
        matches!(all, ModelOutcome::Unreachable { max_share } if (max_share - most).abs() < 1e-12)
    );
}

#[test]
fn what_moves_sideways_ploughs() {
    // κ and the resistance by the side force that ploughing adds to the shear's
    let of = |bulldozing: Bulldozing, beta: f64, settings: Settings| {
        let soil = Soil::new(SoilParams {
            unit_weight: Some(14e3),
            phi: Angle::from_deg(30.0),
            ..*sand().params()
        })
        .unwrap();
        let settings = Settings {
            bulldozing,
            ..settings
        };
        let wheel = RigidWheel::new(0.1, 0.05).unwrap();
        let motion = Kinematics::with_slip_angle(slip(0.2), Angle::from_deg(beta)).unwrap();
        let on_soil = WheelOnSoil::new(wheel, soil, settings).unwrap();
        let point = on_soil.at_sinkage(0.02, &motion).unwrap();
        -point.side_force - point.forces.side_shear
    };
    let plain = Settings::default();
    let full = of(Bulldozing::Full, 20.0, plain);
    assert!(full > 1.0);
    near(
        of(Bulldozing::Scaled, 20.0, plain),
        full * 20_f64.to_radians().sin(),
    );
    assert!(of(Bulldozing::Off, 20.0, plain).abs() < 1e-12);
    let reference = Settings {
        accuracy: Accuracy::Reference,
        ..plain
    };
    let chord = of(Bulldozing::Chord, 30.0, reference);
    // sin²⁴ 30° = 2⁻²⁴
    let disc = of(Bulldozing::Disc, 30.0, reference);
    assert!((disc / chord - 1.0).abs() < 1e-6 && disc != chord);
}
