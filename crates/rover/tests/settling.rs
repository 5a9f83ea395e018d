//! How slip-sinkage follows a change of slip, and what passes leave for the wheels behind.

use grouser_rover::dynamics::{SoilUnder, WheelContact, WheelLoad, WheelMotionNow};
use grouser_rover::ground::{Ground, HeightMap, Packing, Track};
use grouser_terra::{
    Kinematics, MultiPass, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil, catalogue,
};

/// A wheel whose slip jumps from 0 at constant travel: time (s), way over the ground (mm) and height of its axle (mm,
/// from any datum) since the rim began to speed up. Source: the position logs of 3d-terramechanics (Robomechanics Lab,
/// Carnegie Mellon; MIT licence), commit d8192d4, raw-data-processing/gr630_grouser/3-11-21: a wheel of 58 mm with 24
/// lugs of 5 mm at a travel of 10 mm/s. `10_100_0_1.txt`, from 3316.133 s on its controller's clock: rim 10 to 99.5 mm/s
/// in 0.45 s, slip angle 0.
const TO_NINE_TENTHS: &[(f64, f64, f64)] = &[
    (0.000, 0.00, 6.03),
    (0.079, 0.68, 5.82),
    (0.172, 1.75, 5.10),
    (0.253, 2.65, 3.47),
    (0.347, 3.66, 2.25),
    (0.413, 4.36, 0.65),
    (0.480, 5.07, -1.32),
    (0.574, 6.02, -3.07),
    (0.693, 7.26, -4.40),
    (0.800, 8.36, -5.55),
    (0.880, 9.19, -6.62),
    (0.973, 10.15, -7.93),
    (1.080, 11.25, -9.18),
    (1.173, 12.22, -9.73),
    (1.268, 13.20, -10.53),
    (1.375, 14.32, -11.10),
    (1.470, 15.30, -11.48),
    (1.577, 16.41, -11.98),
    (1.684, 17.49, -12.30),
    (1.778, 18.46, -12.63),
    (1.886, 19.57, -13.10),
    (2.074, 21.52, -13.83),
    (2.275, 23.58, -14.60),
    (2.474, 25.63, -15.35),
    (2.672, 27.69, -16.15),
    (2.872, 29.74, -16.90),
    (3.070, 31.79, -17.52),
    (3.268, 33.81, -18.10),
    (3.466, 35.85, -18.83),
    (3.665, 37.90, -19.60),
    (3.875, 40.07, -20.38),
    (4.073, 42.09, -21.15),
    (4.271, 44.13, -21.87),
    (4.470, 46.17, -22.43),
    (4.672, 48.22, -22.93),
    (4.873, 50.29, -23.38),
    (5.073, 52.35, -23.83),
    (5.276, 54.43, -24.23),
    (5.477, 56.49, -24.52),
    (19.443, 200.17, -38.48),
    (20.368, 209.66, -38.58),
    (21.375, 220.05, -39.13),
    (22.369, 230.31, -39.57),
    (23.375, 240.63, -39.63),
    (60.236, 620.15, -40.73),
];

/// `10_40_15_1.txt`, from 1425.324 s: rim 10 to 40 mm/s in 0.25 s, slip angle 15°.
const TO_THREE_QUARTERS: &[(f64, f64, f64)] = &[
    (0.000, 0.00, 4.52),
    (0.201, 1.86, 3.90),
    (0.380, 3.83, 2.40),
    (0.590, 6.03, 0.95),
    (0.787, 8.06, -0.78),
    (0.983, 10.08, -2.35),
    (1.177, 12.07, -3.90),
    (1.383, 14.21, -5.08),
    (1.581, 16.24, -5.78),
    (1.781, 18.32, -6.88),
    (1.982, 20.38, -8.42),
    (2.183, 22.44, -9.52),
    (2.384, 24.52, -10.02),
    (2.587, 26.60, -10.52),
    (2.789, 28.69, -10.83),
    (2.992, 30.76, -11.78),
    (3.193, 32.84, -12.40),
    (8.996, 92.47, -24.80),
    (9.386, 96.46, -25.15),
    (9.793, 100.67, -26.12),
    (10.198, 104.84, -26.60),
    (10.601, 108.97, -26.70),
    (11.005, 113.12, -27.32),
    (11.412, 117.29, -27.70),
    (11.817, 121.44, -27.97),
    (12.221, 125.59, -28.25),
    (12.624, 129.73, -28.35),
    (13.032, 133.93, -28.55),
];

const TRAVEL_M_PER_S: f64 = 0.01;
const STEP_S: f64 = 1e-3;

fn on_sand(change: impl FnOnce(&mut SoilParams)) -> WheelOnSoil {
    let mut sand = *catalogue::find("dry-sand")
        .unwrap()
        .soil()
        .unwrap()
        .params();
    change(&mut sand);
    let wheel = RigidWheel::new(0.058, 0.05).unwrap();
    WheelOnSoil::new(wheel, Soil::new(sand).unwrap(), Settings::default()).unwrap()
}

fn motion(rim: f64, forward: f64) -> WheelMotionNow {
    WheelMotionNow {
        sinkage: 0.015,
        sinking: 0.0,
        velocity: [forward, 0.0],
        rim,
    }
}

fn under(settling_way: f64) -> SoilUnder {
    let mut soil = SoilUnder::default();
    soil.settling_way = settling_way;
    soil
}

/// The share of the final slip-sinkage at the times of `rows`.
fn settled(rows: &[(f64, f64, f64)], rim: f64, ramp: f64, way: f64) -> Vec<f64> {
    let pair = on_sand(|_| {});
    let (mut contact, mut step) = (WheelContact::default(), 0_u32);
    let last = 1.0 - TRAVEL_M_PER_S / rim;
    rows.iter()
        .map(|(time, ..)| {
            while f64::from(step) * STEP_S < *time {
                let share = (f64::from(step) * STEP_S / ramp).min(1.0);
                let now = motion(
                    TRAVEL_M_PER_S + share * (rim - TRAVEL_M_PER_S),
                    TRAVEL_M_PER_S,
                );
                contact.step(&pair, &under(way), &now, STEP_S);
                step += 1;
            }
            contact.dug()[0] / last
        })
        .collect()
}

/// Root mean square of height − (a + b share), mm, with the best a and b; each 5 mm of way count alike.
fn misfit(rows: &[(f64, f64, f64)], shares: &[f64]) -> f64 {
    let bin = |way: f64| (way / 5.0).floor();
    let weight = |way: f64| {
        let alike = rows.iter().filter(|row| bin(row.1) == bin(way)).count();
        1.0 / alike as f64
    };
    let mut sums = [0.0; 5];
    for ((_, way, height), share) in rows.iter().zip(shares) {
        let terms = [1.0, *share, share * share, *height, share * height];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += weight(*way) * term;
        }
    }
    let [n, s, ss, h, sh] = sums;
    let b = (n * sh - s * h) / (n * ss - s * s);
    let a = (h - b * s) / n;
    let squares: f64 = rows
        .iter()
        .zip(shares)
        .map(|((_, way, height), share)| weight(*way) * (height - a - b * share).powi(2))
        .sum();
    (squares / n).sqrt()
}

#[test]
fn fifty_millimetres_of_travel_hold_at_both_slips() {
    let errors = |way: f64| {
        [
            misfit(TO_NINE_TENTHS, &settled(TO_NINE_TENTHS, 0.0995, 0.45, way)),
            misfit(
                TO_THREE_QUARTERS,
                &settled(TO_THREE_QUARTERS, 0.04, 0.25, way),
            ),
        ]
    };
    let rms = |[a, b]: [f64; 2]| (0.5 * (a * a + b * b)).sqrt();
    let found = errors(0.05);
    println!("settling way 50 mm: {found:.2?} mm of 41 and 35 mm");
    assert!(found[0] < 1.8 && found[1] < 0.8, "{found:?}");
    for other in [1e-6, 0.02, 0.12] {
        let worse = errors(other);
        println!("settling way {:.3} mm: {worse:.2?} mm", 1e3 * other);
        assert!(rms(worse) > 1.5 * rms(found), "{other}: {worse:?}");
    }
}

/// The force while it digs is that of a soil whose constant exponent is the one that it has dug to.
#[test]
fn the_force_is_that_of_the_exponent_it_has_dug_to() {
    let (n_1, way, slip) = (0.4, 1.0, 0.5);
    let digging = on_sand(|sand| sand.n_1 = n_1);
    let n_0 = digging.soil().params().n;
    let straight = Kinematics::straight(Slip::new(slip).unwrap());
    for sign in [1.0, -1.0] {
        let mut contact = WheelContact::default();
        let now = motion(0.1 * sign, 0.05 * sign);
        let mut load = WheelLoad::default();
        for step in 1..=40_000_u32 {
            load = contact.step(&digging, &under(way), &now, STEP_S);
            let travel = 0.05 * STEP_S * f64::from(step);
            let expected = sign * slip * (1.0 - (-travel / way).exp());
            let dug = contact.dug()[0];
            assert!(
                (dug.abs() - expected.abs()).abs() < 1e-4,
                "{travel} m: {dug} {expected}"
            );
            if step % 8_000 == 0 {
                let fixed = on_sand(|sand| sand.n = n_0 + n_1 * dug.abs());
                let truth = fixed.forces_at(now.sinkage, &straight).unwrap();
                let off = (load.normal / truth.vertical_force - 1.0).abs();
                assert!(off < 1e-6, "{travel} m: {off}");
                let along = sign * truth.drawbar_pull;
                assert!((load.along - along).abs() < 1e-5 * truth.thrust.abs());
            }
        }
        let steady = digging.forces_at(now.sinkage, &straight).unwrap();
        assert!(load.normal > steady.vertical_force);
    }
}

#[test]
fn a_wheel_that_spins_on_the_spot_digs() {
    let pair = on_sand(|sand| sand.n_1 = 0.4);
    let mut contact = WheelContact::default();
    for _ in 0..20_000 {
        contact.step(&pair, &under(0.05), &motion(0.1, 0.0), STEP_S);
    }
    // 2 m of rim count as 0.2 m of travel: e^-4 is left
    assert!((1.0 - contact.dug()[0] - (-4.0_f64).exp()).abs() < 0.01);
}

#[test]
fn each_wheel_passes_once() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let map = HeightMap::from_shape((6.0, 2.0), 0.05, |_, _| 0.0).unwrap();
    let mut ground = Ground::new(map, vec![soil]).unwrap();
    let law = MultiPass::new(0.12, 0.17, 0.035).unwrap();
    let mut packing = Packing::default();
    packing.multi_pass = Some(law);
    ground.pack(packing, 1).unwrap();
    let untouched = ground.at(3.0, 0.0);
    assert_eq!((untouched.strength, untouched.k_shear), (1.0, 1.0));
    // wheels 0 and 1 in one track, in strips of 11 mm, then wheel 0 again
    let mut ways = [0.0, 0.0];
    for (pass, (wheel, slip)) in [(0_u8, 0.2), (1, 0.5), (0, 0.05)].into_iter().enumerate() {
        for strip in 0..364_u32 {
            let x = 1.0 + 0.011 * f64::from(strip);
            let way = &mut ways[usize::from(wheel)];
            let track = Track::new(wheel, *way, slip);
            ground.pass((x, 0.0), (x + 0.011, 0.0), (0.1, 0.01), &track);
            *way += 0.011;
        }
        let count = u32::try_from(pass + 1).unwrap();
        let (spot, change) = (ground.at(3.0, 0.0), law.change(slip, count));
        assert!(
            (spot.strength - change.strength_factor).abs() < 1e-7,
            "{spot:?}"
        );
        assert!(
            (spot.k_shear - change.k_shear_factor).abs() < 1e-7,
            "{spot:?}"
        );
    }
    assert_eq!(ground.at(3.0, 0.5).strength, 1.0);
    packing.gain = 0.4;
    assert!(ground.pack(packing, 1).is_err());
}

/// K of a rut: the force with a factor of K is that of a soil of that K.
#[test]
fn a_rut_shears_by_its_own_modulus() {
    let (plain, stiff) = (on_sand(|_| {}), on_sand(|sand| sand.k_shear *= 0.7));
    let mut soil = SoilUnder::default();
    soil.k_shear = 0.7;
    let (mut rut, mut truth) = (WheelContact::default(), WheelContact::default());
    for _ in 0..2_000 {
        let now = motion(0.1, 0.07);
        let a = rut.step(&plain, &soil, &now, STEP_S);
        let b = truth.step(&stiff, &SoilUnder::default(), &now, STEP_S);
        assert!((a.along - b.along).abs() < 1e-9 && (a.torque - b.torque).abs() < 1e-10);
        assert!((a.normal - b.normal).abs() < 1e-9);
    }
}
