use super::super::Lanes;
use super::super::plan::tests::alike;
use super::*;
use crate::catalogue::tests::dry_sand_with;
use crate::contact::ladder::LIMITS;
use crate::{Kinematics, RigidWheel, Settings, Slip, Soil, WheelOnSoil};

fn placed(soil: &Soil, numbers: &[[f64; 8]; 5], per_k_shear: Option<f64>) -> Placed<Lanes> {
    let prepared = Prepared::new(soil).unwrap();
    let mut lanes = prepared.soil::<Lanes>(&alike(&[0.0; 8]), 0);
    if let Some(per_k_shear) = per_k_shear {
        lanes.per_k_shear = Lanes([per_k_shear; 8]);
    }
    Placed::new(
        &prepared,
        &lanes,
        numbers.each_ref().map(|column| Lanes(*column)),
    )
}

/// Every number is that of the general contact; a stiffness just below and above each limit has its step.
#[test]
fn points_are_placed_as_contacts() {
    let soil = dry_sand_with(|params| params.cohesion = 700.0);
    for (radius, width, rebound, slip, z_over_r) in [
        (0.1, 0.05, 0.0, 0.3, 0.2),
        (0.4, 0.3, 0.5, 0.1, 0.03),
        (0.2, 0.1, 1.4, 0.7, 0.11),
        (0.03, 0.02, 1.0, 0.0, 0.2),
    ] {
        let wheel = RigidWheel::new(radius, width).unwrap();
        let with_rebound = soil.with_rebound(rebound).unwrap();
        let on_soil = WheelOnSoil::new(wheel, with_rebound, Settings::default()).unwrap();
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let theta_1 = on_soil.entry_angle(z_over_r * radius, &motion).unwrap();
        let contact = on_soil.contact(theta_1, &motion);
        let numbers = [radius, width, rebound, slip, z_over_r].map(|x| [x; 8]);
        let found = placed(&soil, &numbers, None);
        let angles = contact.angles();
        let arc = angles.theta_1 - angles.theta_2;
        let front = angles.theta_1 - angles.theta_m;
        let of = &found.contact;
        let n = soil.params().n;
        let k_shear = soil.params().k_shear;
        let sigma = on_soil.laws().modulus(width, n) * (radius * front * theta_1.sin()).powf(n);
        for (found, expected) in [
            (of.theta_1, theta_1),
            (of.behind, -angles.theta_2),
            (of.front, front),
            (of.rear, angles.theta_m - angles.theta_2),
            (of.q, 1.0 - slip),
            (of.r_over_k, radius * core::f64::consts::LOG2_E / k_shear),
            (found.stress, radius * width * sigma * front),
            (found.hold, radius * width * 700.0 * arc),
        ] {
            let off = (found.0[6] - expected).abs();
            assert!(off <= 1e-10 * expected.abs(), "{} {expected}", found.0[6]);
        }
        let stiffness = contact.shear.stiffness(arc);
        for (k, limit) in LIMITS.into_iter().enumerate() {
            for (factor, step) in [(1.0 - 1e-9, k), (1.0 + 1e-9, k + 1)] {
                let per_k_shear = factor * limit / stiffness * core::f64::consts::LOG2_E / k_shear;
                let found = placed(&soil, &numbers, Some(per_k_shear));
                assert_eq!(found.step.0, [step as f64; 8]);
            }
        }
    }
}

/// Each lane lacks one thing that the lanes need, or none.
#[test]
fn which_points_lanes_serve() {
    let good = [true, false, true, false, true, true, true, false];
    let is_served = |soil: &Soil, changes: &[(usize, [f64; 8])]| {
        let mut numbers = [0.1, 0.1, 0.0, 0.2, 0.2].map(|x| [x; 8]);
        for (k, column) in changes {
            numbers[*k] = *column;
        }
        // so much shear modulus that the first step serves
        placed(soil, &numbers, Some(1e-3))
            .step
            .0
            .map(|step| step == 0.0)
    };
    let soil = dry_sand_with(|_| ());
    let size = [1e-3, 0.999e-3, 100.0, 100.1, 0.2, 0.2, 0.2, f64::NAN];
    assert_eq!(is_served(&soil, &[(0, size)]), good);
    assert_eq!(is_served(&soil, &[(1, size)]), good);
    let rebound = [0.0, -1e-9, 1.0, 1e9, 0.5, 0.6, 0.7, f64::NAN];
    assert_eq!(is_served(&soil, &[(2, rebound)]), good);
    let slip = [0.0, -1e-9, 1.0, 1.001, 0.1, 0.2, 0.3, f64::NAN];
    assert_eq!(is_served(&soil, &[(3, slip)]), good);
    let depth = [4.5e-4, 4.4e-4, 0.5, 0.501, 0.1, 0.2, 0.3, f64::NAN];
    assert_eq!(is_served(&soil, &[(4, depth)]), good);
    // a rise of 0.5 radii, and an arc of 1.7
    let (flat, steep) = (
        [0.005; 8],
        [90.0, 100.1, 100.0, 101.0, 1.0, 2.0, 3.0, f64::NAN],
    );
    assert_eq!(is_served(&soil, &[(2, steep), (4, flat)]), good);
    let deep = 0.5 * (1.0 - f64::cos(0.85) + 1.0 - f64::cos(0.85));
    let arc = [
        deep - 1e-9,
        deep + 1e-9,
        deep - 1e-3,
        0.4,
        0.1,
        0.2,
        0.3,
        f64::NAN,
    ];
    assert_eq!(is_served(&soil, &[(2, [1.0; 8]), (4, arc)]), good);
    // a soil that does not carry a wheel so narrow: k_c/b + k_φ < 0
    let weak = dry_sand_with(|params| {
        params.pressure = crate::Pressure::Bekker(crate::Bekker {
            k_c: -1e4,
            k_phi: 1e5,
        });
    });
    let width = [0.101, 0.099, 0.11, 0.09, 1.0, 1.0, 1.0, 0.05];
    assert_eq!(is_served(&weak, &[(1, width)]), good);
    // a front of 0.07 n of the entry angle
    let with_position = dry_sand_with(|params| (params.c_1, params.c_2) = (0.523, 0.5));
    let limit = (1.0 - 0.07 * soil.params().n - 0.523) / 0.5;
    let slip = [
        0.0,
        -1e-3,
        limit - 1e-9,
        limit + 1e-9,
        0.1,
        0.2,
        0.3,
        f64::NAN,
    ];
    assert_eq!(is_served(&with_position, &[(3, slip)]), good);
}
