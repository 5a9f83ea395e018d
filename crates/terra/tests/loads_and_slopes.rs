//! Searches for sinkages, slips and slopes against many samples and halving, and what they spend and report.

use grouser_terra::{
    Angle, BestSlip, Caution, GrouserRule, Grousers, Kinematics, LoadOutcome, RigidWheel, Settings,
    Slip, SlopeOutcome, Soil, SoilParams, SolveStatus, WheelOnSoil, catalogue,
};

const RADIUS_M: f64 = 0.125;

fn params(key: &str) -> SoilParams {
    *catalogue::find(key).unwrap().soil().unwrap().params()
}

fn on(params: SoilParams) -> WheelOnSoil {
    let wheel = RigidWheel::new(RADIUS_M, 0.1).unwrap();
    WheelOnSoil::new(wheel, Soil::new(params).unwrap(), Settings::default()).unwrap()
}

fn at(slip: f64) -> Kinematics {
    Kinematics::straight(Slip::new(slip).unwrap())
}

/// Pull and torque at a slip under a load.
fn forces(on_soil: &WheelOnSoil, load: f64, slip: f64) -> Option<(f64, f64)> {
    let point = on_soil.under_load(load, &at(slip)).unwrap().point()?;
    Some((point.forces.drawbar_pull, point.forces.torque))
}

/// The least slip of [−1, 1] in steps of 0.01 at which `of` is not negative, by halving; `None` where there is none, and −1
/// where it is the first with a value.
fn least_slip(of: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let mut low = None;
    for i in -100..=100 {
        let slip = f64::from(i) / 100.0;
        let Some(value) = of(slip) else { continue };
        if value >= 0.0 {
            let Some(mut low) = low else {
                return Some(slip);
            };
            let mut high = slip;
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if of(middle).is_some_and(|value| value >= 0.0) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            return Some(high);
        }
        low = Some(slip);
    }
    None
}

/// The slip of smallest magnitude up to 0.6 in steps of 0.01 at which `of` changes its sign from that at slip 0, by halving.
fn held_slip(of: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let sense = if of(0.0)? > 0.0 { -1.0 } else { 1.0 };
    let is_held = |slip: f64| of(sense * slip).is_some_and(|value| sense * value >= 0.0);
    let first = (0..=60).find(|i| is_held(f64::from(*i) / 100.0))?;
    let (mut low, mut high) = (f64::from(first - 1) / 100.0, f64::from(first) / 100.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if is_held(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some(sense * high)
}

#[test]
fn the_slip_that_a_slope_requires() {
    for (key, weight) in [("dry-sand", 80.0), ("snow", 40.0), ("clayey-soil", 200.0)] {
        let on_soil = on(params(key));
        for slope in [-0.6, -0.1, 0.0, 0.08, 0.15, 0.7] {
            let (load, required) = (weight * f64::cos(slope), weight * f64::sin(slope));
            let pull = |slip| forces(&on_soil, load, slip).map(|f| f.0 - required);
            let slope = Angle::from_rad(slope);
            let found = on_soil.slip_demand(weight, slope).unwrap();
            match (found, held_slip(pull)) {
                (SlopeOutcome::Holds { slip }, Some(expected)) => {
                    assert!(
                        (slip.value() - expected).abs() < 1e-9,
                        "{key} {slope:?} {slip:?} {expected}"
                    );
                    for near in [-0.15, 0.01, 0.05, 0.15] {
                        let near = Slip::new((slip.value() + near).clamp(-1.0, 1.0)).unwrap();
                        let beside = on_soil.slip_demand_near(weight, slope, near).unwrap();
                        let SlopeOutcome::Holds { slip: beside } = beside else {
                            panic!("{key} {slope:?} is held");
                        };
                        assert!((beside.value() - slip.value()).abs() < 1e-9);
                    }
                }
                (
                    SlopeOutcome::Immobilised {
                        max_pull,
                        required_pull,
                    },
                    None,
                ) => {
                    let pulls = (0..=600).filter_map(|i| pull(f64::from(i) / 1000.0));
                    let best = pulls.fold(f64::NEG_INFINITY, f64::max) + required;
                    let off = max_pull.unwrap() - best;
                    assert!((-1e-9 * load..1e-6 * load).contains(&off), "{off}");
                    assert!(required_pull == required && best < required);
                    let near = on_soil.slip_demand_near(weight, slope, Slip::ZERO).unwrap();
                    assert!(matches!(near, SlopeOutcome::Immobilised { .. }));
                }
                (SlopeOutcome::Slides { required_pull }, None) => {
                    assert!(required_pull == required && pull(-0.6).unwrap() > 0.0);
                }
                other => panic!("{key} {slope:?}: {other:?}"),
            }
        }
        for bad in [1.58, -1.58, f64::NAN] {
            assert!(on_soil.slip_demand(weight, Angle::from_rad(bad)).is_err());
            assert!(
                on_soil
                    .slip_demand_near(weight, Angle::from_rad(bad), Slip::ZERO)
                    .is_err()
            );
        }
        let heavy = on_soil.slip_demand(1e9, Angle::from_rad(0.1)).unwrap();
        assert!(matches!(
            heavy,
            SlopeOutcome::Immobilised { max_pull: None, .. }
        ));
    }
}

#[test]
fn the_skid_of_a_free_wheel() {
    for (key, load) in [("dry-sand", 80.0), ("snow", 40.0), ("clayey-soil", 200.0)] {
        for rebound in [0.0, 0.4] {
            let on_soil = on(SoilParams {
                rebound,
                ..params(key)
            });
            for share in [0.0, 0.02, 0.1, 5.0] {
                let friction = share * load * RADIUS_M;
                let surplus = |slip| forces(&on_soil, load, slip).map(|f| f.1 + friction);
                let found = on_soil.free_slip(load, friction).unwrap();
                // a friction that the locked rim does not overcome leaves it locked
                let expected = least_slip(surplus).filter(|slip| *slip > -1.0 && *slip <= 0.0);
                assert_eq!(
                    found.is_some(),
                    expected.is_some(),
                    "{key} {share} {expected:?}"
                );
                let (Some(found), Some(expected)) = (found, expected) else {
                    continue;
                };
                assert!(
                    (found.value() - expected).abs() < 1e-9,
                    "{key} {share} {found:?} {expected}"
                );
                let near = Slip::new(expected + 0.05).unwrap();
                let near = on_soil
                    .free_slip_near(load, friction, near)
                    .unwrap()
                    .unwrap();
                assert!((near.value() - expected).abs() < 1e-9);
            }
            for bad in [-1.0, f64::NAN] {
                assert!(on_soil.free_slip(load, bad).is_err());
                assert!(on_soil.free_slip_near(load, bad, Slip::ZERO).is_err());
            }
            assert_eq!(on_soil.free_slip(1e9, 0.0).unwrap(), None);
        }
    }
}

/// As good as any of 500 samples, and what it says it is.
#[test]
fn the_best_slips() {
    for (key, load) in [
        ("dry-sand", 80.0),
        ("snow", 40.0),
        ("clayey-soil", 200.0),
        ("snow", 400.0),
    ] {
        let on_soil = on(params(key));
        let efficiency = |slip: f64, (pull, torque): (f64, f64)| {
            (pull > 0.0 && torque > 0.0).then(|| pull * (1.0 - slip) * RADIUS_M / torque)
        };
        let check = |best: Option<BestSlip>, of: &dyn Fn(f64) -> Option<f64>, size: f64| {
            let samples = (0..=500).filter_map(|i| of(f64::from(i) / 500.0));
            let most = samples.fold(f64::NEG_INFINITY, f64::max);
            let Some(best) = best else {
                assert_eq!(most, f64::NEG_INFINITY, "{key}");
                return;
            };
            assert!(best.value >= most - 1e-9 * size && best.value < most + 1e-3 * size);
            assert!((of(best.slip.value()).unwrap() - best.value).abs() < 1e-9 * size);
        };
        let pull = |slip| forces(&on_soil, load, slip).map(|f| f.0);
        check(on_soil.slip_of_maximum_pull(load).unwrap(), &pull, load);
        let share = |slip| efficiency(slip, forces(&on_soil, load, slip)?);
        check(
            on_soil.slip_of_maximum_efficiency(load).unwrap(),
            &share,
            1.0,
        );
    }
    assert!(
        on(params("snow"))
            .slip_of_maximum_pull(1e9)
            .unwrap()
            .is_none()
    );
}

/// On the steepest slope the greatest pull is what the slope takes; a hair less and a hair more are held and not.
#[test]
fn the_steepest_slope_takes_all_of_the_pull() {
    let lugs = Grousers {
        height: 0.01,
        rule: GrouserRule::Lugs {
            count: 24.0,
            thickness: 0.002,
        },
    };
    let mut count = 0;
    for (key, weight, n_1, lugged) in [
        ("dry-sand", 20.0, 0.0, false),
        ("lunar", 20.0, 0.4, false),
        ("snow", 80.0, 0.0, true),
        ("sandy-loam", 400.0, 0.4, true),
    ] {
        let mut wheel = RigidWheel::new(RADIUS_M, 0.1).unwrap();
        if lugged {
            wheel = wheel.with_grousers(lugs).unwrap();
        }
        let soil = Soil::new(SoilParams { n_1, ..params(key) });
        let settings = Settings {
            max_slip: 1.0,
            ..Settings::default()
        };
        let on_soil = WheelOnSoil::new(wheel, soil.unwrap(), settings).unwrap();
        let left = |alpha: f64| {
            let best = on_soil.slip_of_maximum_pull(weight * alpha.cos()).unwrap();
            best.unwrap().value / weight - alpha.sin()
        };
        let Some(steepest) = on_soil.steepest_slope(weight).unwrap() else {
            assert!(left(0.0) < 0.0, "{key}");
            continue;
        };
        count += 1;
        let alpha = steepest.slope.rad();
        assert!(
            left(alpha).abs() < 1e-8 && left(alpha - 1e-6) > 0.0 && left(alpha + 1e-6) < 0.0,
            "{key}"
        );
        let (pull, _) = forces(&on_soil, weight * alpha.cos(), steepest.slip.value()).unwrap();
        assert!((pull / weight - alpha.sin()).abs() < 1e-8, "{key}");
        assert_eq!(on_soil.gradeability(weight).unwrap(), Some(steepest.slope));
    }
    assert!(count > 2);
    // it cannot pull itself, or is not carried
    let weak = on(SoilParams {
        cohesion: 0.0,
        phi: Angle::from_deg(5.0),
        ..params("dry-sand")
    });
    assert!(weak.gradeability(80.0).unwrap().is_none());
    assert!(on(params("snow")).gradeability(1e9).unwrap().is_none());
}

#[test]
fn how_a_search_for_a_sinkage_ends() {
    let on_soil = on(params("dry-sand"));
    let motion = at(0.2);
    let solved = on_soil.under_load(80.0, &motion).unwrap();
    let point = solved.point().unwrap();
    assert_eq!(solved.residual(), Some(point.forces.vertical_force - 80.0));
    assert!(solved.residual().unwrap().abs() < 1e-9 * 80.0);
    let alone = on_soil.sinkage_under(80.0, &motion).unwrap();
    assert_eq!(solved.evaluations, alone.evaluations + 1);
    assert_eq!(alone.sinkage(), Some(point.sinkage));
    assert_eq!(solved.outcome.status(), SolveStatus::Solved);
    let none = on_soil.under_load(1e9, &motion).unwrap();
    assert_eq!(
        (none.residual(), none.outcome.status()),
        (None, SolveStatus::NoSolution)
    );
    assert_eq!(
        LoadOutcome::<f64>::NotConverged.status(),
        SolveStatus::NotConverged
    );
    // the greatest load is that just below the hub
    let LoadOutcome::NoSolution { max_load } = none.outcome else {
        panic!("1e9 N are not carried");
    };
    let hub = on_soil
        .forces_at(RADIUS_M * (1.0 - 1e-11), &motion)
        .unwrap();
    assert!((max_load / hub.vertical_force - 1.0).abs() < 1e-8);
    for share in [1.0 - 1e-6, 1.0 + 1e-6] {
        let solved = on_soil.sinkage_under(share * max_load, &motion).unwrap();
        assert_eq!(solved.sinkage().is_some(), share < 1.0);
    }
    let nothing = on_soil.sinkage_under(0.0, &motion).unwrap();
    assert_eq!((nothing.sinkage(), nothing.evaluations), (Some(0.0), 0));
    for bad in [-1.0, 1.1e12, f64::NAN] {
        assert!(on_soil.sinkage_under(bad, &motion).is_err());
    }
}

/// Where the vertical force may fall, eleven rough samples, eight side by side, guard the search.
#[test]
fn rough_samples_where_the_force_may_fall() {
    let evaluations = |on_soil: &WheelOnSoil, slip: f64| {
        on_soil.sinkage_under(80.0, &at(slip)).unwrap().evaluations
    };
    let plain = params("dry-sand");
    for slip in [0.0, 0.2] {
        let rising = SoilParams {
            rebound: 0.2,
            ..plain
        };
        let carried = SoilParams {
            transport_layer: 0.001,
            ..plain
        };
        let rule = GrouserRule::Lugs {
            count: 24.0,
            thickness: 0.002,
        };
        let lugged = RigidWheel::new(RADIUS_M, 0.1).unwrap();
        let lugged = lugged
            .with_grousers(Grousers { height: 0.01, rule })
            .unwrap();
        let lugged =
            WheelOnSoil::new(lugged, Soil::new(plain).unwrap(), Settings::default()).unwrap();
        assert!((5..=10).contains(&evaluations(&on(rising), slip)));
        for free in [on(plain), on(carried), lugged] {
            assert!((2..=7).contains(&evaluations(&free, slip)));
        }
    }
    assert!((5..=10).contains(&evaluations(&on(plain), -0.1)));
}

/// A load that is carried at three sinkages: the lowest is taken, with a caution; where it is carried once, without.
#[test]
fn of_several_sinkages_the_lowest() {
    let on_soil = on(SoilParams {
        rebound: 1.5,
        ..params("lunar")
    });
    let motion = at(-0.1);
    let force = |z: f64| on_soil.forces_at(z, &motion).unwrap().vertical_force;
    let top = RADIUS_M / 1.5 * (1.0 - 1e-9);
    let samples: Vec<f64> = (1..=400).map(|i| top * f64::from(i) / 400.0).collect();
    let forces: Vec<f64> = samples.iter().map(|z| force(*z)).collect();
    let most = forces.iter().copied().fold(0.0, f64::max);
    for share in [0.05, 0.3, 0.6, 0.9] {
        let load = share * most;
        let rising = forces
            .windows(2)
            .filter(|pair| pair[0] < load && pair[1] >= load)
            .count();
        let falling = forces
            .windows(2)
            .filter(|pair| pair[0] >= load && pair[1] < load)
            .count();
        let first = samples[forces.iter().position(|force| *force >= load).unwrap()];
        let solution = on_soil.under_load(load, &motion).unwrap();
        let point = solution.point().unwrap();
        assert!(
            (first - point.sinkage).abs() <= top / 400.0,
            "{share} {first} {point:?}"
        );
        let several = rising + falling > 1;
        assert_eq!(
            point.cautions.contains(Caution::SeveralSinkages),
            several,
            "{share} {rising} {falling}"
        );
    }
    let LoadOutcome::NoSolution { max_load } = on_soil.sinkage_under(1e9, &motion).unwrap().outcome
    else {
        panic!("1e9 N are not carried");
    };
    assert!(max_load <= 1.001 * most && max_load > 0.5 * most);
}
