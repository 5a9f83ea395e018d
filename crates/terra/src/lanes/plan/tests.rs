use super::super::Lanes;
use super::super::columns::SoilInputs;
use super::*;
use crate::catalogue::tests::dry_sand_with;
use crate::{Angle, Bekker, LawChoice, ShearLaw, SoilParams};

/// Every place of a step is in one of its groups, in order, and a group that is not full repeats the last one.
#[test]
fn groups_hold_every_place_once() {
    let steps = |n: usize, seed: usize| (0..n).map(move |i| ((i * i + seed * i) % 7 % 6) as f64);
    for n in [0, 1, 7, 8, 9, 40, CHUNK] {
        for seed in 0..5 {
            let mut plan = Plan::EMPTY;
            // what an earlier chunk left
            plan.steps = [1.0; ROOM];
            plan.order = [9; ROOM];
            for (to, step) in plan.steps.iter_mut().zip(steps(n, seed)) {
                *to = step;
            }
            plan.sort(n);
            let mut found = [const { std::vec::Vec::new() }; Step::COUNT];
            for group in plan.groups() {
                assert!((1..=8).contains(&group.count));
                let (counted, rest) = group.places.split_at(group.count);
                assert!(rest.iter().all(|place| place == &counted[group.count - 1]));
                let of_step = &mut found[group.step.index()];
                assert!(of_step.len() % 8 == 0, "only the last group is not full");
                of_step.extend(counted.iter().map(|&place| usize::from(place)));
            }
            for (step, places) in found.iter().enumerate() {
                let of_step = steps(n, seed).enumerate();
                let expected = of_step.filter(|(_, of)| *of == step as f64).map(|(i, _)| i);
                assert!(places.iter().copied().eq(expected), "{n} {seed} {step}");
            }
            for (i, step) in steps(n, seed).enumerate() {
                assert_eq!(plan.is_single(i), step == 5.0);
            }
        }
    }
}

/// By the limits of the ladder, whose own step for single numbers is the same below an entry angle of 60°.
#[test]
fn steps_are_those_of_the_ladder() {
    for i in 0..2000 {
        let stiffness = 0.05 * f64::from(i);
        let step = step_of(Lanes([stiffness; 8])).0[3];
        let least = Step::for_stiffness(stiffness, 0.5);
        let index = least.map_or(Step::COUNT, Step::index);
        assert_eq!(step, index as f64, "{stiffness}");
        assert_eq!(index_of(step), index);
    }
    assert_eq!(step_of(Lanes([f64::NAN; 8])).0[0], SINGLE_STEP);
}

#[test]
fn ranges_have_their_ends_and_no_nan() {
    let x = Lanes([-1.0, 0.999, 1.0, 1.5, 2.0, 2.001, f64::NAN, f64::INFINITY]);
    let expected = [false, false, true, true, true, false, false, false];
    assert_eq!(within(x, 1.0, 2.0).0, expected);
    assert_eq!(inside(x, (1.0, 2.0)).0, expected);
    assert!(Lanes::any(within(x, 2.0, 2.0)) && !Lanes::any(within(x, 3.0, 4.0)));
}

/// The same for radius, width, rebound, slip and what is given.
pub(in crate::lanes) fn alike(numbers: &[f64]) -> Inputs<'_> {
    Inputs {
        radius: numbers,
        width: numbers,
        rebound: numbers,
        slip: numbers,
        given: numbers,
        soil: None,
    }
}

/// ln((3 − n)/3 · 2⁻ⁿ), with 3 − n at least ½.
fn shape(n: f64) -> f64 {
    ((3.0 - n).max(0.5) / 3.0).ln() - n * 2.0_f64.ln()
}

fn near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 2e-15 * expected.abs(),
        "{found} {expected}"
    );
}

#[test]
fn what_lanes_prepare_of_a_soil() {
    for n in [0.7, 1.3, 2.8] {
        let soil = dry_sand_with(|params| {
            (params.n, params.cohesion, params.k_shear) = (n, 350.0, 0.013);
            params.phi = Angle::from_rad(0.6);
            params.pressure = Pressure::Bekker(Bekker {
                k_c: 900.0,
                k_phi: 7e5,
            });
            (params.c_1, params.c_2) = (0.21, 0.34);
        });
        let prepared = Prepared::new(&soil).unwrap();
        let inputs = alike(&[0.0; 8]);
        let lanes: LaneSoil<Lanes> = prepared.soil(&inputs, 0);
        for (found, expected) in [
            (lanes.n, n),
            (lanes.cohesion, 350.0),
            (lanes.tan_phi, 0.6_f64.tan()),
            (lanes.per_k_shear, core::f64::consts::LOG2_E / 0.013),
            (lanes.per_slope, 1.0 / (2.0 * n + 1.0)),
            (lanes.shape, shape(n)),
            (
                prepared.modulus(&lanes, Lanes([0.05; 8])),
                900.0 / 0.05 + 7e5,
            ),
            // of a slip of 0.4
            (
                prepared.position(&lanes, Lanes([0.4; 8])),
                0.21 + 0.4 * 0.34,
            ),
        ] {
            near(found.0[5], expected);
        }
        assert_eq!(lanes.sound.0, [true; 8]);
    }
    let is_served = |change: fn(&mut SoilParams)| Prepared::new(&dry_sand_with(change)).is_some();
    assert!(is_served(|_| ()));
    assert!(!is_served(|params| params.rear_driving = 0.1));
    assert!(!is_served(|params| params.transport_layer = 0.001));
    assert!(!is_served(|params| {
        params.laws = LawChoice {
            shear: Some(ShearLaw::SlipVelocityRegular),
            ..params.laws
        };
    }));
    assert!(!is_served(|params| params.n_1 = 0.1));
}

/// Each lane has another soil; then each lacks another number, in the order of the columns.
#[test]
fn soils_of_lanes() {
    let prepared = Prepared::new(&dry_sand_with(|_| ())).unwrap();
    let legal: [[f64; 8]; 8] = [
        [900.0, 1e3, 2e3, 0.0, -100.0, 5.0, 6.0, -1e12],
        [7e5, 1e5, 2e5, 3e5, 4e5, 5e5, 6e5, 1e12],
        [0.7, 1.0, 1.3, 2.6, 2.9, 0.1, 3.0, 0.5],
        [0.0, 1.0, 20.0, 300.0, 4e3, 5e4, 1e8, 7.0],
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1.5],
        [1e-6, 0.01, 0.02, 0.03, 0.04, 0.5, 6.0, 10.0],
        [-2.0, -1.0, 0.0, 0.1, 0.2, 0.3, 1.0, 2.0],
        [2.0, 1.0, 0.5, 0.1, 0.2, 0.3, -1.0, -2.0],
    ];
    let of = |numbers: &[[f64; 8]; 8]| -> (LaneSoil<Lanes>, [f64; 8]) {
        let empty = [0.05; 8];
        let inputs = Inputs {
            soil: Some(SoilInputs {
                numbers: numbers.each_ref().map(|column| &column[..]),
                tables: None,
            }),
            ..alike(&empty)
        };
        let soil = prepared.soil(&inputs, 0);
        (soil, prepared.modulus(&soil, Lanes(empty)).0)
    };
    let (soil, modulus) = of(&legal);
    assert_eq!(soil.sound.0, [true; 8]);
    for k in 0..8 {
        let [k_c, k_phi, n, cohesion, phi, k_shear, c_1, c_2] = legal.map(|column| column[k]);
        assert_eq!((soil.n.0[k], soil.cohesion.0[k]), (n, cohesion));
        assert_eq!((soil.c_1.0[k], soil.c_2.0[k]), (c_1, c_2));
        near(soil.tan_phi.0[k], phi.tan());
        near(soil.per_k_shear.0[k], core::f64::consts::LOG2_E / k_shear);
        near(soil.per_slope.0[k], 1.0 / (2.0 * n + 1.0));
        near(soil.shape.0[k], shape(n));
        near(modulus[k], k_c / 0.05 + k_phi);
    }
    let mut bad = legal;
    for (k, x) in [-1.1e12, 1.1e12, 3.1, -1.0, 1.56, 11.0, 2.1, f64::NAN]
        .into_iter()
        .enumerate()
    {
        bad[k][k] = x;
    }
    assert_eq!(of(&bad).0.sound.0, [false; 8]);
}
