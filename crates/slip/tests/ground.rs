//! The ground's strength from the wheels, against wheels whose soil is known; hostile input; no allocation.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking and may say what it measured"
)]

mod noise;

use grouser_slip::ground::{
    GroundSettings, Knowledge, LeanOutcome, SoilIdentifier, SoilPrior, Taken, Uncertain,
    WheelReading, contact_lean, entry_angle_from_sinkage,
};
use grouser_terra::{
    Angle, Kinematics, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil, catalogue,
};
use noise::Noise;
use proptest::prelude::*;

fn soil(key: &str) -> Soil {
    catalogue::find(key).unwrap().soil().unwrap()
}

fn wheel() -> RigidWheel {
    RigidWheel::new(0.1, 0.08).unwrap()
}

/// What the sensors' errors are: sigma of slip, of load and torque (share of them), of sinkage (m).
const SLIP_SIGMA: f64 = 0.01;
const SHARE_SIGMA: f64 = 0.02;
const DEPTH_SIGMA: f64 = 0.0005;

/// A reading of a wheel on `soil` as the stress model has it, with noise; the model error is that which the identifier
/// is told of.
fn reading(
    soil: &Soil,
    tenths: i64,
    slip: f64,
    load: f64,
    model_error: f64,
    noise: &mut Noise,
) -> WheelReading {
    let pair = WheelOnSoil::new(wheel(), *soil, Settings::default()).unwrap();
    let motion = Kinematics::straight(Slip::new(slip).unwrap());
    let point = pair.under_load(load, &motion).unwrap().point().unwrap();
    let mut with = |value: f64, sigma: f64| Uncertain {
        value: value + sigma * noise.normal(),
        sigma,
    };
    let torque = with(point.forces.torque, SHARE_SIGMA * point.forces.torque);
    WheelReading {
        time_ns: 100_000_000 * tenths,
        wheel: 0,
        slip: with(slip, SLIP_SIGMA),
        load: with(load, SHARE_SIGMA * load),
        sinkage: with(point.sinkage, DEPTH_SIGMA),
        torque: Uncertain {
            value: torque.value + model_error * point.forces.torque * noise.normal(),
            ..torque
        },
    }
}

fn identifier(prior: &Soil, settings: GroundSettings) -> SoilIdentifier {
    SoilIdentifier::new(&[wheel()], prior, SoilPrior::around(prior), settings).unwrap()
}

/// Knowledge that does not fade, for runs on one soil.
fn lasting() -> GroundSettings {
    GroundSettings {
        memory: 1e6,
        ..GroundSettings::default()
    }
}

#[test]
fn learns_another_soil_than_it_was_told_of() {
    let prior = soil("dry-sand");
    let truth = Soil::new(SoilParams {
        cohesion: 1800.0,
        phi: Angle::from_deg(25.0),
        k_shear: 0.016,
        ..*prior.params()
    })
    .unwrap();
    let mut noise = Noise::new(1);
    let mut identifier = identifier(&prior, lasting());
    for i in 0..600 {
        let slip = 0.03 + 0.5 * f64::from(i % 17) / 16.0;
        let load = 20.0 + 20.0 * f64::from(i % 5);
        let reading = reading(&truth, i64::from(i), slip, load, 0.03, &mut noise);
        identifier.update(&reading).unwrap();
    }
    let found = identifier.estimate();
    for ((value, knowledge), truth) in [
        (found.cohesion, 1800.0),
        (found.phi, 25_f64.to_radians()),
        (found.k_shear, 0.016),
    ] {
        println!("{truth}: {value:?} {knowledge:?}");
        assert_eq!(knowledge, Knowledge::Observed);
        assert!((value.value - truth).abs() < 3.0 * value.sigma);
        assert!(value.sigma < 0.15 * truth);
    }
    assert_eq!(found.changes, 0);
}

/// Truths drawn from the prior itself: a filter that is honest covers them as often as it says.
#[test]
fn its_sigmas_are_those_of_its_errors() {
    const RUNS: u32 = 200;
    let prior_soil = soil("dry-sand");
    let prior = SoilPrior {
        cohesion: Uncertain {
            value: 2000.0,
            sigma: 500.0,
        },
        phi: Uncertain {
            value: 0.5,
            sigma: 0.08,
        },
        k_shear: Uncertain {
            value: 0.02,
            sigma: 0.006,
        },
    };
    let mut noise = Noise::new(2);
    let (mut nees, mut inside) = (0.0, [0; 3]);
    for _ in 0..RUNS {
        let truth = [
            (2000.0 + 500.0 * noise.normal()).max(0.0),
            0.5 + 0.08 * noise.normal(),
            0.02_f64.ln() + 0.3 * noise.normal(),
        ];
        let ground = Soil::new(SoilParams {
            cohesion: truth[0],
            phi: Angle::from_rad(truth[1]),
            k_shear: truth[2].exp(),
            ..*prior_soil.params()
        })
        .unwrap();
        let mut identifier =
            SoilIdentifier::new(&[wheel()], &prior_soil, prior, lasting()).unwrap();
        for i in 0..100 {
            let slip = 0.05 + 0.5 * noise.uniform();
            let load = 20.0 + 80.0 * noise.uniform();
            let reading = reading(&ground, i64::from(i), slip, load, 0.03, &mut noise);
            identifier.update(&reading).unwrap();
        }
        let found = identifier.estimate();
        let error = [
            found.cohesion.0.value - truth[0],
            found.phi.0.value - truth[1],
            found.k_shear.0.value.ln() - truth[2],
        ];
        let solved = solve(found.covariance, error);
        nees += error.iter().zip(solved).map(|(e, x)| e * x).sum::<f64>();
        for i in 0..3 {
            inside[i] += u32::from(error[i].abs() < 2.0 * found.covariance[i][i].sqrt());
        }
    }
    let nees = nees / f64::from(RUNS);
    println!("NEES of 3: {nees:.2}; within 2 sigma: {inside:?} of {RUNS}");
    // the mean of 200 χ² of 3 has a standard deviation of 0.17; linearisation and the sensors' noise that enters the
    // slopes add to it
    assert!((2.4..=3.8).contains(&nees), "{nees}");
    for count in inside {
        assert!(f64::from(count) >= 0.9 * f64::from(RUNS), "{inside:?}");
    }
}

#[test]
fn says_what_one_load_at_one_slip_cannot_tell() {
    let truth = Soil::new(SoilParams {
        k_shear: 0.002,
        ..*soil("dry-sand").params()
    })
    .unwrap();
    let mut noise = Noise::new(3);
    let mut identifier = identifier(&truth, lasting());
    for i in 0..400 {
        let reading = reading(&truth, i64::from(i), 0.6, 60.0, 0.03, &mut noise);
        identifier.update(&reading).unwrap();
    }
    let found = identifier.estimate();
    // the shear is all but mobilised: c and φ only together, K not at all
    assert_eq!(found.k_shear.1, Knowledge::NotObservable);
    assert_eq!(found.cohesion.1, Knowledge::NotObservable);
    // but their sum under this wheel's pressure is known
    let pressure = 60.0 / (0.08 * 0.06);
    let strength = found.shear_strength(pressure);
    let of_truth = 1000.0 + pressure * 30_f64.to_radians().tan();
    println!("{strength:?} against {of_truth}; {found:?}");
    assert!((strength.value - of_truth).abs() < 3.0 * strength.sigma);
    assert!(strength.sigma < 0.1 * of_truth);
}

#[test]
fn finds_a_change_of_ground_and_none_where_there_is_none() {
    let sand = soil("dry-sand");
    let loose = Soil::new(SoilParams {
        cohesion: 300.0,
        phi: Angle::from_deg(22.0),
        k_shear: 0.035,
        ..*sand.params()
    })
    .unwrap();
    let mut noise = Noise::new(4);
    let mut identifier = identifier(&sand, GroundSettings::default());
    let mut step = |identifier: &mut SoilIdentifier, ground: &Soil, i: u32| {
        let slip = 0.05 + 0.4 * noise.uniform();
        let load = 30.0 + 40.0 * noise.uniform();
        let reading = reading(ground, i64::from(i), slip, load, 0.03, &mut noise);
        identifier.update(&reading).unwrap()
    };
    for i in 0..5_000 {
        assert_ne!(
            step(&mut identifier, &sand, i),
            Taken::Changed,
            "reading {i}"
        );
    }
    let delay = (0..50).position(|i| step(&mut identifier, &loose, 5_000 + i) == Taken::Changed);
    println!("found after {delay:?} readings");
    assert!(delay.unwrap() < 10);
    for i in 0..200 {
        step(&mut identifier, &loose, 5_100 + i);
    }
    let found = identifier.estimate();
    let (phi, _) = found.phi;
    assert!(
        (phi.value - 22_f64.to_radians()).abs() < 4.0 * phi.sigma,
        "{phi:?}"
    );
}

#[test]
fn one_wild_reading_is_an_outlier_and_not_a_change() {
    let sand = soil("dry-sand");
    let mut noise = Noise::new(5);
    let mut identifier = identifier(&sand, lasting());
    for i in 0..100 {
        identifier
            .update(&reading(&sand, i64::from(i), 0.2, 60.0, 0.0, &mut noise))
            .unwrap();
    }
    let mut wild = reading(&sand, 100, 0.2, 60.0, 0.0, &mut noise);
    wild.torque.value *= 5.0;
    identifier.update(&wild).unwrap();
    let before = identifier.estimate();
    let next = reading(&sand, 101, 0.2, 60.0, 0.0, &mut noise);
    let taken = identifier.update(&next).unwrap();
    assert!(matches!(taken, Taken::Outlier { .. }), "{taken:?}");
    let after = identifier.estimate();
    assert!((after.phi.0.value - before.phi.0.value).abs() < 1e-4);
    assert_eq!(after.changes, 0);
}

#[test]
fn takes_any_bits_and_allocates_nothing() {
    let sand = soil("dry-sand");
    let mut identifier = identifier(&sand, GroundSettings::default());
    let good = reading(&sand, 0, 0.2, 60.0, 0.0, &mut Noise::new(6));
    let made = allocation_counter::measure(|| {
        let _ = identifier.update(&good);
        let _ = identifier.update(&WheelReading { wheel: 7, ..good });
        let _ = identifier.estimate();
    });
    assert_eq!(made.count_total, 0);
    assert_eq!(identifier.rejected().unknown, 1);
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop::sample::select(vec![0.0, f64::NAN, f64::INFINITY, 1e308, 5e-324, 1.0, -1.0]),
        0.0..1.0_f64,
        0.0..1e4_f64,
    ]
}

proptest! {
    #[test]
    fn stays_finite_for_any_reading(
        readings in prop::collection::vec(
            (any::<i64>(), 0..3_usize, prop::array::uniform8(number())),
            1..40,
        ),
    ) {
        let mut identifier = identifier(&soil("snow"), GroundSettings::default());
        for (time_ns, wheel, x) in readings {
            let pair = |i: usize| Uncertain { value: x[i], sigma: x[i + 1] };
            let _ = identifier.update(&WheelReading {
                time_ns,
                wheel,
                slip: pair(0),
                load: pair(2),
                sinkage: pair(4),
                torque: pair(6),
            });
            let e = identifier.estimate();
            for (value, _) in [e.cohesion, e.phi, e.k_shear] {
                prop_assert!(value.value.is_finite() && value.sigma.is_finite() && value.sigma >= 0.0);
            }
        }
    }
}

/// Two wheels of one link over ground that leans by two angles, with noise on all that is measured.
#[test]
fn finds_the_lean_under_both_wheels_within_its_sigmas() {
    const LENGTH: f64 = 0.5;
    let mut noise = Noise::new(7);
    let (mut seen, mut inside, mut silent) = (0, 0, 0);
    for _ in 0..4000 {
        let [front, rear] = [(); 2].map(|()| -0.6 + 1.2 * noise.uniform());
        // both centres move along the link alike
        let along = 0.1;
        let speeds = [front, rear].map(|lean| along / f64::cos(lean));
        let rate = along * (front.tan() - rear.tan()) / LENGTH;
        let mut with = |value: f64, sigma: f64| Uncertain {
            value: value + sigma * noise.normal(),
            sigma,
        };
        let [v_f, v_r] = speeds.map(|v| with(v, 2e-4));
        match contact_lean(v_f, v_r, with(rate, 1e-3), LENGTH).unwrap() {
            LeanOutcome::Measured(lean) => {
                seen += 2;
                for (found, truth) in [(lean.front, front), (lean.rear, rear)] {
                    inside += u32::from((found.value - truth).abs() < 2.0 * found.sigma);
                }
            }
            LeanOutcome::NotObservable => silent += 1,
            LeanOutcome::Inconsistent => {}
        }
    }
    println!("{inside} of {seen} within 2 sigma; {silent} not observable");
    assert!(seen > 6000);
    assert!(f64::from(inside) > 0.93 * f64::from(seen));
    // level ground, however fast: any common angle fits
    let exact = |value| Uncertain { value, sigma: 0.0 };
    let level = contact_lean(exact(0.1), exact(0.1), exact(0.0), LENGTH).unwrap();
    assert_eq!(level, LeanOutcome::NotObservable);
    // a front wheel that runs away from the rear one on a link that hardly turns
    let apart = contact_lean(exact(0.3), exact(0.1), exact(0.01), LENGTH).unwrap();
    assert_eq!(apart, LeanOutcome::Inconsistent);
}

#[test]
fn an_entry_angle_has_the_spread_of_the_sinkage_it_comes_from() {
    let radius = Uncertain {
        value: 0.1,
        sigma: 0.0,
    };
    let mut noise = Noise::new(8);
    let truth = 0.02;
    let sigma = 0.001;
    let of = |value: f64| entry_angle_from_sinkage(Uncertain { value, sigma }, radius).unwrap();
    let centre = of(truth);
    let mut squares = 0.0;
    for _ in 0..20_000 {
        let off = of(truth + sigma * noise.normal()).value - centre.value;
        squares += off * off;
    }
    let spread = (squares / 20_000.0_f64).sqrt();
    // 20 000 draws know their spread to 0.5 %; the second order adds less
    assert!(
        (centre.sigma / spread - 1.0).abs() < 0.02,
        "{} {spread}",
        centre.sigma
    );
    // at the surface the sigma stays finite
    assert!(of(0.0).sigma.is_finite());
    assert!(entry_angle_from_sinkage(Uncertain { value: 0.2, sigma }, radius).is_err());
}

/// x of A x = y for a symmetric positive A, by Cramer.
fn solve(a: [[f64; 3]; 3], y: [f64; 3]) -> [f64; 3] {
    let det = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = det(a);
    core::array::from_fn(|column| {
        let mut m = a;
        for row in 0..3 {
            m[row][column] = y[row];
        }
        det(m) / whole
    })
}
