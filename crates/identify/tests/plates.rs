//! Plate tests against regression by hand and against pressures that the law itself gives.

use grouser_identify::Error;
use grouser_identify::least_squares::{Loss, Verdict, student_quantile};
use grouser_identify::plate::{Plate, PlateSettings, PlateTest, fit_plates, read_table};
use proptest::prelude::*;

/// A disc's test, its force by `pressure` at each depth.
fn disc(name: &str, diameter: f64, depths: &[f64], pressure: impl Fn(f64) -> f64) -> PlateTest {
    let plate = Plate::disc(diameter).unwrap();
    let area = std::f64::consts::PI * diameter * diameter / 4.0;
    PlateTest {
        name: name.into(),
        plate,
        depth: depths.to_vec(),
        force: depths.iter().map(|z| pressure(*z) * area).collect(),
    }
}

fn steps(from: f64, step: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| from + step * f64::from(i)).collect()
}

fn close(found: f64, wanted: f64, relative: f64) -> bool {
    (found - wanted).abs() <= relative * wanted.abs()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// With one plate ln p = ln k + n ln z is a straight line: slope and intercept with their textbook errors, widened for
    /// residuals that follow each other.
    #[test]
    fn one_plate_is_a_regression_by_hand(
        (n, k) in (0.5..1.5_f64, 1e5..1e7_f64),
        noise in prop::collection::vec(-0.05..0.05_f64, 12..30),
        memory in 0.0..1.1_f64,
        diameter in 0.02..0.3_f64,
    ) {
        let depths = steps(0.001, 0.001, u32::try_from(noise.len()).unwrap());
        let mut drift = 0.0;
        let noise: Vec<f64> = noise.iter().map(|e| { drift = memory * drift + e; drift }).collect();
        let mut test = disc("a", diameter, &depths, |z| k * z.powf(n));
        for (force, e) in test.force.iter_mut().zip(&noise) {
            *force *= e.exp();
        }
        test.force[7] = 0.0; // no contact: left out, as is the depth of 1 mm
        let found = fit_plates(&[test.clone()], &PlateSettings::default()).unwrap();
        let used: Vec<usize> = (1..depths.len()).filter(|i| *i != 7).collect();
        let m = used.len() as f64;
        let (x, y): (Vec<f64>, Vec<f64>) = used.iter().map(|&i| (depths[i].ln(), (k * depths[i].powf(n)).ln() + noise[i])).unzip();
        let (x_mean, y_mean) = (x.iter().sum::<f64>() / m, y.iter().sum::<f64>() / m);
        let s_xx: f64 = x.iter().map(|x| (x - x_mean).powi(2)).sum();
        let slope = x.iter().zip(&y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>() / s_xx;
        let off: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y - y_mean - slope * (x - x_mean)).collect();
        let squares: f64 = off.iter().map(|r| r * r).sum();
        let s = (squares / (m - 2.0)).sqrt();
        let rho = (off.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / squares).max(0.0);
        let redundancy = ((1.0 + rho) / (1.0 - rho)).min(m / 4.0);
        prop_assert!(close(found.redundancy, redundancy, 1e-3), "{} {redundancy}", found.redundancy);
        prop_assert!(close(found.relative_deviation, s, 1e-6));
        prop_assert!(close(found.n, slope, 1e-5));
        let modulus = (y_mean - slope * x_mean).exp();
        prop_assert!(close(found.k_phi, modulus, 1e-4) && found.k_c == 0.0);
        for ((index, residual), (i, r)) in found.residuals[0].iter().zip(used.iter().zip(&off)) {
            prop_assert!(index == i && (residual - r).abs() < 1e-5 * s.max(1e-3));
        }
        prop_assert_eq!(found.residuals[0].len(), used.len());
        let errors = [s / s_xx.sqrt(), s * (1.0 / m + x_mean * x_mean / s_xx).sqrt()];
        let widened = errors.map(|error| redundancy.sqrt() * error);
        let t = student_quantile(0.975, used.len() - 2);
        let [own, of_k] = &found.parameters[..] else { panic!("{}", found.parameters.len()) };
        prop_assert!(own.name == "n" && of_k.name == "k_pa_per_m_n");
        prop_assert!(close(own.standard_error, widened[0], 1e-3) && close(of_k.standard_error, modulus * widened[1], 1e-3));
        prop_assert!(own.value == found.n && of_k.value == found.k_phi);
        // an interval that reaches the limits of the law's exponent has no end there, and that of k follows n
        for (sign, limit, end) in [(-1.0, 0.1, own.interval.low), (1.0, 3.0, own.interval.high)] {
            let beyond = sign * (slope + sign * t * errors[0] - limit) / (t * errors[0]);
            prop_assert!(beyond < 1e-2 || end.is_none(), "{beyond} {end:?}");
            if beyond > -1e-2 {
                return Ok(());
            }
        }
        for (sign, ends) in [(-1.0, (own.interval.low, of_k.interval.low)), (1.0, (own.interval.high, of_k.interval.high))] {
            prop_assert!(close(ends.0.unwrap() - slope, sign * t * widened[0], 2e-3));
            prop_assert!(close((ends.1.unwrap() / modulus).ln(), sign * t * widened[1], 2e-3));
        }
    }

    /// (k_c/b + k_phi) (z − z_0)ⁿ under plates of any two or three widths is found again.
    #[test]
    fn plates_of_several_widths_part_the_moduli(
        (n, k_c, k_phi) in (0.5..1.5_f64, 0.0..5e4_f64, 1e5..5e6_f64),
        diameters in prop::sample::subsequence(vec![0.05, 0.08, 0.12, 0.2], 2..=3).prop_shuffle(),
        datums in prop::collection::vec(-4e-3..2e-3_f64, 3),
        fit_datum in any::<bool>(),
    ) {
        let tests: Vec<PlateTest> = diameters
            .iter()
            .zip(&datums)
            .enumerate()
            .map(|(i, (d, z_0))| {
                let z_0 = if fit_datum { *z_0 } else { 0.0 };
                disc(&format!("disc {i}"), *d, &steps(0.003, 0.002, 15), |z| (k_c / (0.5 * d) + k_phi) * (z - z_0).powf(n))
            })
            .collect();
        let mut settings = PlateSettings::default();
        settings.fit_datum = fit_datum;
        let found = fit_plates(&tests, &settings).unwrap();
        prop_assert!(close(found.n, n, 1e-5), "{} {n}", found.n);
        prop_assert!((found.k_c - k_c).abs() < 1e-3 * (k_c + 0.1 * k_phi) && close(found.k_phi, k_phi, 1e-3), "{} {k_c} {} {k_phi}", found.k_c, found.k_phi);
        let mut ends = diameters.clone();
        ends.sort_by(f64::total_cmp);
        for (own, d) in found.parameters[1..3].iter().zip([ends[0], ends[ends.len() - 1]]) {
            prop_assert_eq!(&own.name, &format!("k_pa_per_m_n_at_b_{}_mm", 500.0 * d));
            prop_assert!(close(own.value, k_c / (0.5 * d) + k_phi, 1e-4));
        }
        prop_assert_eq!(found.parameters.len(), if fit_datum { 3 + tests.len() } else { 3 });
        for ((own, z_0), test) in found.parameters[3..].iter().zip(&datums).zip(&tests) {
            prop_assert!((own.value - z_0).abs() < 1e-6 && own.name == format!("datum_m of {}", test.name), "{} {z_0}", own.value);
        }
    }
}

#[test]
fn alike_residuals_count_as_few() {
    // residuals ±0.1 in two long runs: ρ = 1 − 2/m or so, and no more than m/4 readings for one
    let wave = |i: usize| if i < 20 { 0.1_f64 } else { -0.1 };
    let mut test = disc("a", 0.1, &steps(0.003, 0.001, 40), |z| 1e6 * z);
    for (i, force) in test.force.iter_mut().enumerate() {
        *force *= wave(i).exp();
    }
    let found = fit_plates(&[test], &PlateSettings::default()).unwrap();
    assert!(
        found.redundancy > 3.0 && found.redundancy <= 10.0,
        "{}",
        found.redundancy
    );
    let same = disc("a", 0.1, &[0.01; 12], |_| 1e4);
    assert!(
        fit_plates(&[same], &PlateSettings::default())
            .unwrap()
            .redundancy
            >= 1.0
    );
    // of the law itself nothing is left over
    let exact = disc("a", 0.1, &steps(0.003, 0.001, 12), |z| 1e6 * z);
    let found = fit_plates(&[exact], &PlateSettings::default()).unwrap();
    assert!(
        found.redundancy >= 1.0
            && found.redundancy <= 3.0
            && found.parameters[0].verdict == Verdict::Identified
    );
}

#[test]
fn ten_readings_below_the_surface_are_needed() {
    let of =
        |count: u32, diameter: f64| disc("a", diameter, &steps(2e-3, 1e-3, count), |z| 1e6 * z);
    let run = |tests: &[PlateTest]| fit_plates(tests, &PlateSettings::default());
    assert!(run(&[of(10, 0.1)]).is_ok() && run(&[of(5, 0.1), of(5, 0.2)]).is_ok());
    assert!(matches!(
        run(&[of(9, 0.1)]),
        Err(Error::TooFew {
            residuals: 9,
            parameters: 2
        })
    ));
    let one_empty = [of(12, 0.1), of(0, 0.2)];
    assert!(matches!(
        run(&one_empty),
        Err(Error::TooFew {
            residuals: 12,
            parameters: 3
        })
    ));
    // a width that differs by rounding is the same width
    assert_eq!(
        run(&[of(9, 0.1), of(9, 0.1 * (1.0 + 1e-9))]).unwrap().k_c,
        0.0
    );
    assert!(
        run(&[of(9, 0.1), of(9, 0.1 * (1.0 + 1e-5))])
            .unwrap()
            .parameters
            .len()
            == 3
    );
}

#[test]
fn widths_that_differ_by_a_millionth_are_one() {
    let of = |width: f64| {
        let area = 1.0;
        let mut test = disc("a", 0.1, &steps(2e-3, 1e-3, 9), |z| 1e6 * z);
        test.plate = Plate { area, width };
        test
    };
    let count = |width: f64| {
        let found = fit_plates(&[of(1.0), of(width)], &PlateSettings::default()).unwrap();
        found.parameters.len()
    };
    let same = 1.0 + 1e-6_f64;
    assert_eq!([count(same), count(same.next_up())], [2, 3]);
}

#[test]
fn moduli_have_an_error_and_ends_in_the_units_of_their_keys() {
    let wave = |z: f64, i: f64| (0.02 * (900.0 * z + i).sin()).exp();
    let of = |diameter: f64, i: f64| {
        disc("a", diameter, &steps(3e-3, 1e-3, 25), |z| {
            (2e4 / (0.5 * diameter) + 8e5) * z * wave(z, i)
        })
    };
    let tests = [of(0.06, 0.0), of(0.06, 2.0), of(0.12, 1.0), of(0.12, 4.0)];
    let found = fit_plates(&tests, &PlateSettings::default()).unwrap();
    let names = ["k_c_kn_per_m_n1", "k_phi_kn_per_m_n2"];
    let in_key_units = found.moduli_in_key_units();
    assert_eq!(in_key_units.len(), 2);
    for ((modulus, in_kn), name) in found.moduli.iter().zip(&in_key_units).zip(names) {
        let [low, high] = [modulus.interval.low, modulus.interval.high].map(Option::unwrap);
        let half = 0.5 * (high - low);
        assert!(close(0.5 * (high + low), modulus.value, 1e-12));
        let t = half / modulus.standard_error;
        assert!(
            (student_quantile(0.975, 100)..student_quantile(0.975, 1)).contains(&t),
            "{t}"
        );
        assert_eq!(in_kn.name, name);
        assert!(close(1e3 * in_kn.value, modulus.value, 1e-12));
        assert!(close(
            1e3 * in_kn.standard_error,
            modulus.standard_error,
            1e-12
        ));
        assert!(close(1e3 * in_kn.interval.low.unwrap(), low, 1e-12));
        assert!(close(1e3 * in_kn.interval.high.unwrap(), high, 1e-12));
    }
}

#[test]
fn a_datum_stays_above_the_shallowest_reading() {
    // z_0 at 0.97 of the shallowest depth that is used
    let test = disc("a", 0.1, &steps(2e-3, 1e-3, 15), |z| {
        1e6 * (z - 1.94e-3).powf(0.9)
    });
    let mut settings = PlateSettings::default();
    settings.fit_datum = true;
    let datum = fit_plates(&[test], &settings)
        .unwrap()
        .parameters
        .pop()
        .unwrap();
    assert!(
        close(datum.value, 0.9 * 2e-3, 1e-12) && datum.verdict == Verdict::OnBound,
        "{}",
        datum.value
    );
}

#[test]
fn one_bad_reading_weighs_little_with_hubers_loss() {
    let mut test = disc("a", 0.1, &steps(3e-3, 1e-3, 20), |z| 1e6 * z);
    test.force[15] *= 3.0;
    let off = |loss| {
        let mut settings = PlateSettings::default();
        settings.loss = loss;
        (fit_plates(&[test.clone()], &settings).unwrap().n - 1.0).abs()
    };
    assert!(off(Loss::Huber { threshold: 0.01 }) < 0.1 * off(Loss::Squares));
}

/// Eighty readings with a scatter, of which four are three times too great: the threshold counts multiples of the scatter,
/// whatever it is.
#[test]
fn hubers_threshold_counts_multiples_of_the_scatter() {
    for scatter in [0.001, 0.01, 0.05] {
        let mut test = disc("a", 0.1, &steps(3e-3, 1e-3, 80), |z| 1e6 * z);
        for (i, force) in test.force.iter_mut().enumerate() {
            // sizes of a normal distribution in a scrambled order: ln((1 − u)/u)/1.7 is nearly one
            let u = (0.5 + (37 * i % 80) as f64) / 80.0;
            *force *= (scatter * ((1.0 - u) / u).ln() / 1.7).exp();
        }
        let of = |test: &PlateTest, loss| {
            let mut settings = PlateSettings::default();
            settings.loss = loss;
            fit_plates(std::slice::from_ref(test), &settings).unwrap().n
        };
        let huber = Loss::Huber { threshold: 1.345 };
        let clean = of(&test, Loss::Squares);
        assert!((of(&test, huber) - clean).abs() < 0.2 * scatter);
        for i in [5, 12, 13, 20] {
            test.force[i] *= 3.0;
        }
        let (robust, squares) = (of(&test, huber) - clean, of(&test, Loss::Squares) - clean);
        assert!(
            robust.abs() < 0.3 * scatter && squares.abs() > 0.03,
            "{scatter}: {robust} {squares}"
        );
    }
}

#[test]
fn a_table_names_its_plates_and_tests() {
    let file = std::env::temp_dir().join(format!("grouser-plates-{}.csv", std::process::id()));
    let read = |text: &str| {
        std::fs::write(&file, text).unwrap();
        read_table(&file)
    };
    let tests =
        read("test,plate_diameter_mm,depth_mm,force_kn\na,60,1,0.5\nb,90,2,0.7\na,60,3,0.9\n")
            .unwrap();
    let names: Vec<&str> = tests.iter().map(|test| &*test.name).collect();
    assert_eq!(names, ["a", "b"]);
    assert_eq!(
        (&tests[0].depth[..], &tests[0].force[..]),
        (&[0.001, 0.003][..], &[500.0, 900.0][..])
    );
    assert!((tests[1].plate.width - 0.045).abs() < 1e-15 && tests[0].plate != tests[1].plate);
    assert!(close(
        tests[0].pressure(1),
        900.0 / (std::f64::consts::PI * 0.03 * 0.03),
        1e-12
    ));
    let alone = read("plate_diameter_m,depth_m,force_n\n0.06,0.001,5\n0.06,0.002,6\n").unwrap();
    assert!(alone.len() == 1 && alone[0].name == "plate" && alone[0].depth.len() == 2);
    let changes = read("plate_diameter_m,depth_m,force_n\n0.06,0.001,5\n0.07,0.002,6\n")
        .unwrap_err()
        .to_string();
    assert!(
        changes.contains("row 2: the plate of test `plate` changes from 0.06 m to 0.07 m"),
        "{changes}"
    );
    assert!(matches!(
        read("plate_diameter_m,depth_m,force_n\n0,0.001,5\n"),
        Err(Error::Missing { .. })
    ));
    for diameter in [0.0, -1.0, f64::INFINITY] {
        assert!(Plate::disc(diameter).is_err());
    }
    std::fs::remove_file(&file).unwrap();
}
