//! Bad input to the kernel and what must happen, named by its entry in the list of faults (D1-D15).

use grouser_real::OutOfRange;
use grouser_terra::{
    Accuracy, Angle, Bekker, Caution, Error, Forces, Kinematics, LoadOutcome, Pressure, RigidWheel,
    Settings, Slip, Soil, SoilParams, WheelOnSoil, catalogue,
};

fn sand() -> SoilParams {
    *catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap()
        .params()
}

fn wheel() -> RigidWheel {
    RigidWheel::new(0.125, 0.1).unwrap()
}

fn on(params: SoilParams) -> WheelOnSoil {
    WheelOnSoil::new(wheel(), Soil::new(params).unwrap(), Settings::default()).unwrap()
}

fn at(slip: f64) -> Kinematics {
    Kinematics::straight(Slip::new(slip).unwrap())
}

/// The error names this field.
fn names<T>(result: &Result<T, Error>, expected: &str) -> bool {
    match result {
        Err(Error::OutOfRange(OutOfRange { field, .. }) | Error::NotAbove { field, .. }) => {
            *field == expected
        }
        _ => false,
    }
}

fn finite(f: &Forces) -> bool {
    [
        f.vertical_force,
        f.drawbar_pull,
        f.torque,
        f.thrust,
        f.lost_work,
    ]
    .iter()
    .all(|x| x.is_finite())
}

#[test]
fn nan_cohesion_is_an_error() {
    assert!(names(
        &Soil::new(SoilParams {
            cohesion: f64::NAN,
            ..sand()
        }),
        "cohesion"
    ));
    assert!(names(
        &Soil::new(SoilParams {
            cohesion: -1.0,
            ..sand()
        }),
        "cohesion"
    ));
}

#[test]
fn greatest_stress_at_the_entry_is_computed_with_a_caution() {
    for c_1 in [1.0, 1.5] {
        let point = on(SoilParams { c_1, ..sand() })
            .at_sinkage(0.02, &at(0.2))
            .unwrap();
        assert!(finite(&point.forces));
        assert!(point.cautions.contains(Caution::NoNormalStress));
        assert_eq!(point.forces.compaction_resistance, 0.0);
        assert!(point.forces.thrust > 0.0, "cohesion still pulls");
    }
    // continuous as the limit is approached
    let near = on(SoilParams {
        c_1: 1.0 - 0.064 - 1e-12,
        ..sand()
    });
    let there = on(SoilParams {
        c_1: 1.0 - 0.064,
        ..sand()
    });
    let (near, there) = (
        near.forces_at(0.02, &at(0.2)).unwrap(),
        there.forces_at(0.02, &at(0.2)).unwrap(),
    );
    assert!((near.drawbar_pull - there.drawbar_pull).abs() < 1e-9 * there.thrust);
}

#[test]
fn negative_sinkage_is_an_error() {
    for z in [-1e-12, -1.0, f64::NAN] {
        assert!(names(&on(sand()).forces_at(z, &at(0.1)), "sinkage"));
    }
}

#[test]
fn tiny_sinkage_keeps_its_digits() {
    let contact = on(sand());
    let nothing = contact.forces_at(0.0, &at(0.1)).unwrap();
    assert_eq!(
        [nothing.vertical_force, nothing.drawbar_pull, nothing.torque],
        [0.0; 3]
    );
    // z → 0: by similarity W → r b k rⁿ θ_1^(2n+1) w, with w a number of c_1 + c_2 s alone (and the
    // cohesion's part, which is switched off here), so that W(2z)/W(z) → 2^(n + 1/2).
    let dry = on(SoilParams {
        cohesion: 0.0,
        phi: Angle::from_rad(0.0),
        ..sand()
    });
    let z = 1e-9 * 0.125;
    let ratio = dry.forces_at(2.0 * z, &at(0.1)).unwrap().vertical_force
        / dry.forces_at(z, &at(0.1)).unwrap().vertical_force;
    // the next term of the expansion is of the order of z/r = 1e-9
    assert!((ratio / 2_f64.powf(1.6) - 1.0).abs() < 2e-9, "{ratio}");
    let (fast, exact) = both_accuracies(sand(), z, 0.1);
    assert!((fast.vertical_force / exact.vertical_force - 1.0).abs() < 1e-12);
}

fn both_accuracies(params: SoilParams, sinkage: f64, slip: f64) -> (Forces, Forces) {
    let forces = |accuracy| {
        let settings = Settings {
            accuracy,
            ..Settings::default()
        };
        let contact = WheelOnSoil::new(wheel(), Soil::new(params).unwrap(), settings).unwrap();
        contact.forces_at(sinkage, &at(slip)).unwrap()
    };
    (forces(Accuracy::Standard), forces(Accuracy::Reference))
}

#[test]
fn a_buried_hub_is_outside_the_model() {
    for z in [0.125, 0.2, 0.25, 1e300] {
        let result = on(sand()).at_sinkage(z, &at(0.1));
        assert!(
            matches!(result, Err(Error::HubBuried { radius: 0.125, .. })),
            "{result:?}"
        );
    }
    assert!(finite(
        &on(sand())
            .forces_at(0.125_f64.next_down(), &at(0.1))
            .unwrap()
    ));
    let soft = on(SoilParams {
        rebound: 2.0,
        ..sand()
    });
    assert!(matches!(
        soft.forces_at(0.0625, &at(0.1)),
        Err(Error::ReboundAboveHub { .. })
    ));
}

#[test]
fn slip_from_minus_one_to_one_and_nothing_else() {
    for slip in [
        -1.0,
        (-1.0_f64).next_up(),
        -0.999_999,
        -1e-300,
        0.0,
        1e-300,
        1.0,
    ] {
        assert!(
            finite(&on(sand()).forces_at(0.02, &at(slip)).unwrap()),
            "{slip}"
        );
    }
    for slip in [1.0_f64.next_up(), -1.5, f64::NAN, f64::INFINITY] {
        assert!(names(&Slip::new(slip), "slip"));
    }
    // the locked wheel is the limit of the braked one
    let (locked, nearly) = (
        on(sand()).forces_at(0.02, &at(-1.0)).unwrap(),
        on(sand()).forces_at(0.02, &at(-1.0 + 1e-9)).unwrap(),
    );
    assert!((locked.drawbar_pull - nearly.drawbar_pull).abs() < 1e-6 * locked.vertical_force);
    assert!((locked.torque - nearly.torque).abs() < 1e-6 * locked.vertical_force);
}

#[test]
fn sinkage_exponents() {
    for n in [0.1, 0.5, 1.0, 2.5, 3.0] {
        let (fast, exact) = both_accuracies(SoilParams { n, ..sand() }, 0.02, 0.2);
        assert!(
            (fast.vertical_force / exact.vertical_force - 1.0).abs() < 1e-9,
            "{n}"
        );
    }
    for n in [0.0, -1.0, 3.1, f64::NAN] {
        assert!(names(&Soil::new(SoilParams { n, ..sand() }), "n"));
    }
    let digging = on(SoilParams { n_1: 2.5, ..sand() });
    assert!(names(&digging.forces_at(0.02, &at(0.9)), "n at this slip"));
}

#[test]
fn stiff_shear_keeps_its_accuracy() {
    for k_shear in [1e-6, 1e-5, 1e-4, 1e-3] {
        for slip in [-0.9, -0.2, 0.0, 0.02, 0.5] {
            let (fast, exact) = both_accuracies(SoilParams { k_shear, ..sand() }, 0.02, slip);
            let off = (fast.drawbar_pull - exact.drawbar_pull).abs() / exact.vertical_force;
            assert!(off < 1e-9, "K {k_shear} s {slip}: {off:e}");
        }
    }
    for k_shear in [0.0, -0.01, f64::NAN, 1e-300] {
        assert!(names(
            &Soil::new(SoilParams { k_shear, ..sand() }),
            "k_shear"
        ));
    }
}

#[test]
fn an_angle_of_friction_in_degrees_is_an_error() {
    for phi in [30.0, 35.0, core::f64::consts::FRAC_PI_2, -0.1, f64::NAN] {
        assert!(names(
            &Soil::new(SoilParams {
                phi: Angle::from_rad(phi),
                ..sand()
            }),
            "phi"
        ));
    }
}

#[test]
fn a_soil_that_pulls_is_an_error() {
    let negative = Soil::bekker(-1e3, 0.0, 1.0)
        .cohesion(1000.0)
        .phi(Angle::from_deg(30.0))
        .k_shear(0.025)
        .stress_position(0.2, 0.3)
        .params()
        .unwrap();
    let contact = WheelOnSoil::new(wheel(), Soil::new(negative).unwrap(), Settings::default());
    assert!(names(&contact, "k_c/b + k_phi"));
}

#[test]
fn loads_that_nothing_carries() {
    let contact = on(sand());
    assert_eq!(
        contact
            .under_load(0.0, &at(0.1))
            .unwrap()
            .point()
            .unwrap()
            .sinkage,
        0.0
    );
    for load in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(names(&contact.under_load(load, &at(0.1)), "load"));
    }
    for (contact, slip) in [
        (on(sand()), 0.1),
        (on(sand()), -0.5),
        (
            on(SoilParams {
                rebound: 0.6,
                ..sand()
            }),
            0.6,
        ),
        (on(SoilParams { c_1: 1.0, ..sand() }), 0.3),
    ] {
        let solution = contact.under_load(1e9, &at(slip)).unwrap();
        let LoadOutcome::NoSolution { max_load } = solution.outcome else {
            panic!("{:?}", solution.outcome)
        };
        assert!(max_load > 0.0 && max_load < 1e9);
        // a rough scan, and one that is not
        assert!(solution.evaluations <= 20, "{}", solution.evaluations);
        assert!(solution.point().is_none());
        // and what it says is true: a little less is carried
        assert!(
            contact
                .under_load(0.999 * max_load, &at(slip))
                .unwrap()
                .point()
                .is_some()
        );
    }
}

#[test]
fn the_lowest_rising_branch_and_word_of_the_others() {
    // Snow that rises behind a slipping wheel: the vertical force is negative at small sinkage.
    let snow = *catalogue::find("snow").unwrap().soil().unwrap().params();
    let contact = WheelOnSoil::new(
        RigidWheel::new(0.2, 0.1).unwrap(),
        Soil::new(SoilParams {
            rebound: 0.6,
            ..snow
        })
        .unwrap(),
        Settings::default(),
    )
    .unwrap();
    let motion = at(0.6);
    let force = |z_over_r: f64| {
        contact
            .forces_at(0.2 * z_over_r, &motion)
            .unwrap()
            .vertical_force
    };
    assert!((force(0.01) + 0.0098).abs() < 5e-5 && (force(0.02) - 0.018).abs() < 5e-4);
    for load in [0.005, 0.1, 10.0] {
        let point = contact.under_load(load, &motion).unwrap().point().unwrap();
        assert!((point.forces.vertical_force / load - 1.0).abs() < 1e-9);
        let above = contact
            .forces_at(1.001 * point.sinkage, &motion)
            .unwrap()
            .vertical_force;
        assert!(above > load, "on a rising branch");
    }
}

/// The greatest jump of `f` on [from, to] above 1e-8: an interval on which the fourth difference is larger is halved towards
/// the half whose own is the larger one, until a smooth bend has vanished and a jump is left.
fn greatest_jump(f: impl Fn(f64) -> [f64; 3], (from, to): (f64, f64)) -> f64 {
    const INTERVALS: u32 = 1000;
    let difference = |[a, b]: [f64; 2]| {
        let values = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| f(a + share * (b - a)));
        let of = |i: usize| {
            values[0][i] - 4.0 * values[1][i] + 6.0 * values[2][i] - 4.0 * values[3][i]
                + values[4][i]
        };
        (0..3).map(|i| of(i).abs()).fold(0.0, f64::max)
    };
    let mut worst = 0.0_f64;
    let place = |i: u32| from + (to - from) * f64::from(i) / f64::from(INTERVALS);
    for i in 0..INTERVALS {
        let mut ends = [place(i), place(i + 1)];
        let mut jump = difference(ends);
        while ends[1] - ends[0] > 1e-10 && jump > 1e-8 {
            let middle = 0.5 * (ends[0] + ends[1]);
            let halves = [[ends[0], middle], [middle, ends[1]]];
            let [left, right] = halves.map(difference);
            ends = halves[usize::from(right > left)];
            jump = left.max(right);
        }
        worst = worst.max(jump);
    }
    worst
}

#[test]
fn continuous_across_every_internal_switch() {
    // along slip, slip angle and sinkage the rule, the branch and the order change: each rule is good to 1e-9 of the forces
    for (k_shear, rebound) in [(0.025, 0.0), (0.002, 0.5)] {
        let contact = on(SoilParams {
            k_shear,
            rebound,
            ..sand()
        });
        let forces = |sinkage: f64, kinematics: &Kinematics| {
            let found = contact.forces_at(sinkage, kinematics).unwrap();
            [
                found.drawbar_pull,
                found.vertical_force,
                found.torque / wheel().radius(),
            ]
        };
        let scale = forces(0.02, &at(0.5))[1];
        let shares = |forces: [f64; 3]| forces.map(|force| force / scale);
        let along_slip = greatest_jump(|slip| shares(forces(0.02, &at(slip))), (-0.999, 0.999));
        let along_sinkage =
            greatest_jump(|sinkage| shares(forces(sinkage, &at(0.3))), (1e-3, 0.12));
        let along_angle = greatest_jump(
            |angle| {
                let slip = Slip::new(0.3).unwrap();
                shares(forces(
                    0.02,
                    &Kinematics::with_slip_angle(slip, Angle::from_rad(angle)).unwrap(),
                ))
            },
            (-1.5, 1.5),
        );
        for jump in [along_slip, along_sinkage, along_angle] {
            assert!(jump < 1e-8, "{jump:e}");
        }
    }
    // at the switch from driving to braking, and from straight to drifting
    let contact = on(sand());
    let (a, b) = (
        contact.forces_at(0.02, &at(0.0)).unwrap(),
        contact.forces_at(0.02, &at(-1e-14)).unwrap(),
    );
    assert!((a.torque - b.torque).abs() < 1e-9 * a.vertical_force);
    for slip in [-0.3, 0.0, 0.3] {
        let slip = Slip::new(slip).unwrap();
        let drifting = Kinematics::with_slip_angle(slip, Angle::from_rad(1e-12)).unwrap();
        let a = contact
            .forces_at(0.02, &Kinematics::straight(slip))
            .unwrap();
        let b = contact.forces_at(0.02, &drifting).unwrap();
        assert!((a.drawbar_pull - b.drawbar_pull).abs() < 1e-9 * a.vertical_force);
    }
}

#[test]
fn sizes_out_of_range_name_their_field() {
    for bad in [0.0, 1e-310, 1e300, -1.0, f64::NAN, f64::INFINITY] {
        assert!(names(&RigidWheel::new(bad, 0.1), "radius"));
        assert!(names(&RigidWheel::new(0.1, bad), "width"));
    }
    // kPa taken for Pa, N/m^n for kN/m^n: beyond any soil
    assert!(names(
        &Soil::new(SoilParams {
            cohesion: 1e9,
            ..sand()
        }),
        "cohesion"
    ));
    let (k_c, k_phi) = (0.9e9, 1.5e15);
    assert!(names(
        &Soil::new(SoilParams {
            pressure: Pressure::Bekker(Bekker { k_c, k_phi }),
            ..sand()
        }),
        "k_phi"
    ));
}
