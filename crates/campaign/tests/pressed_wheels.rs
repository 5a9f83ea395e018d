//! Plates to wheels: laws of size, fitted on two discs, against the wheels of the same test bed pressed into the sand
//! without turning.

use std::path::Path;

use grouser_campaign::validate::{plate_tests, read_press};
use grouser_identify::plate::{Plate, PlateSettings, PlateTest, fit_plates};

use crate::measured_data::measured_data;

/// A modulus of pressure against sinkage (m).
type Modulus<'a> = &'a dyn Fn(f64) -> f64;

const RADIUS_M: f64 = 0.058;
const WIDTH_M: f64 = 0.05;
/// Depths below the fitted surface at which a wheel and a law are compared, m: above the surface's roughness, below the
/// end of every stroke.
const DEPTHS_M: (f64, f64) = (0.003, 0.025);
/// The surface is sought so far above and below where the force begins, m.
const SURFACES_M: (f64, f64) = (-0.005, 0.03);

/// A wheel pressed like a plate; the surface is where the force begins.
fn pressed(data: &Path, name: &str) -> PlateTest {
    let stem = format!("cmu-lugs/f-d-large-box__force-displacement_{name}");
    let contact = Plate::disc(2.0 * RADIUS_M).unwrap();
    let record = read_press(data, &stem, (name, contact), None).unwrap();
    // an offset at the end of what is searched is none: such a record would need another surface at each speed
    assert!(
        record.offset_s.abs() < 0.9,
        "{name}: clocks {} s apart",
        record.offset_s
    );
    record.test
}

/// Measured over predicted force: the factor of the predicted curve that, with the height of the surface free, leaves
/// the least squares; with the share of the forces that is left.
fn measured_over_predicted(test: &PlateTest, predicted: &dyn Fn(f64) -> f64) -> (f64, f64, f64) {
    const SURFACES: u32 = 141;
    (0..SURFACES)
        .map(|i| {
            let share = f64::from(i) / f64::from(SURFACES - 1);
            let surface = SURFACES_M.0 + share * (SURFACES_M.1 - SURFACES_M.0);
            let (mut fp, mut pp, mut ff) = (0.0, 0.0, 0.0);
            for (depth, force) in test.depth.iter().zip(&test.force).step_by(5) {
                let z = depth - surface;
                if z >= DEPTHS_M.0 && z <= DEPTHS_M.1 {
                    let p = predicted(z);
                    fp += force * p;
                    pp += p * p;
                    ff += force * force;
                }
            }
            let factor = fp / pp;
            (factor, surface, (1.0 - fp * factor / ff).max(0.0).sqrt())
        })
        .filter(|found| found.2.is_finite())
        .min_by(|a, b| a.2.total_cmp(&b.2))
        .unwrap()
}

/// p = k zⁿ Dᵐ of discs: ln k, n, m by least squares over the readings' logarithms.
struct SizeLaw {
    ln_k: f64,
    n: f64,
    m: f64,
}

impl SizeLaw {
    fn of(discs: &[PlateTest], settings: &PlateSettings) -> Self {
        // normal equations of three unknowns, each disc with the same weight
        let mut a = [[0.0; 4]; 3];
        for disc in discs {
            let used = (0..disc.depth.len()).filter(|i| disc.depth[*i] >= settings.least_depth);
            let used: Vec<usize> = used.filter(|i| disc.pressure(*i) > 0.0).collect();
            let diameter = 2.0 * disc.plate.width;
            for i in &used {
                let row = [
                    1.0,
                    disc.depth[*i].ln(),
                    diameter.ln(),
                    disc.pressure(*i).ln(),
                ];
                for (k, line) in a.iter_mut().enumerate() {
                    for (sum, x) in line.iter_mut().zip(row) {
                        *sum += row[k] * x / used.len() as f64;
                    }
                }
            }
        }
        for pivot in 0..3 {
            for other in 0..3 {
                if other != pivot {
                    let factor = a[other][pivot] / a[pivot][pivot];
                    let line = a[pivot];
                    for (x, y) in a[other].iter_mut().zip(line) {
                        *x -= factor * y;
                    }
                }
            }
        }
        let solved = |i: usize| a[i][3] / a[i][i];
        Self {
            ln_k: solved(0),
            n: solved(1),
            m: solved(2),
        }
    }
}

/// Force of a wheel pressed in without turning, N: b ∫ k zⁿ(x) dx over its chord, by the midpoint rule.
fn wheel_force(depth: f64, modulus: f64, n: f64) -> f64 {
    const PIECES: u32 = 200;
    let half = (2.0 * RADIUS_M * depth - depth * depth).sqrt();
    let piece = half / f64::from(PIECES);
    let sum: f64 = (0..PIECES)
        .map(|i| {
            let x = (f64::from(i) + 0.5) * piece;
            let raised = RADIUS_M - (RADIUS_M * RADIUS_M - x * x).sqrt();
            (depth - raised).max(0.0).powf(n)
        })
        .sum();
    2.0 * WIDTH_M * modulus * sum * piece
}

/// Diameter of the disc whose area is that of the contact, m.
fn same_area(depth: f64) -> f64 {
    let half = (2.0 * RADIUS_M * depth - depth * depth).sqrt();
    (4.0 * WIDTH_M * 2.0 * half / std::f64::consts::PI).sqrt()
}

#[test]
fn no_law_of_size_predicts_a_pressed_wheel() {
    if measured_data("cmu-lugs/trials.csv").is_none() {
        return;
    }
    let Some(data) = measured_data("") else {
        return;
    };
    let discs = plate_tests(&data).unwrap();
    let settings = PlateSettings::default();
    let bekker = fit_plates(&discs, &settings).unwrap();
    let power = SizeLaw::of(&discs, &settings);
    eprintln!(
        "discs: n {:.3}, k_c {:.0}, k_phi {:.0} · p = k z^n D^m: n {:.3}, m {:.3}",
        bekker.n, bekker.k_c, bekker.k_phi, power.n, power.m
    );
    let power_modulus = |diameter: f64| (power.ln_k + power.m * diameter.ln()).exp();
    let bekker_modulus = |width: f64| bekker.k_c / width + bekker.k_phi;
    let laws: [(&str, f64, Modulus<'_>); 6] = [
        ("Bekker, b the width", bekker.n, &|_| {
            bekker_modulus(WIDTH_M)
        }),
        ("Bekker, b half the width", bekker.n, &|_| {
            bekker_modulus(0.5 * WIDTH_M)
        }),
        ("Bekker, b of the same area", bekker.n, &|z| {
            bekker_modulus(0.5 * same_area(z))
        }),
        ("z^n D^m, D the wheel's", power.n, &|_| {
            power_modulus(2.0 * RADIUS_M)
        }),
        ("z^n D^m, D the width", power.n, &|_| power_modulus(WIDTH_M)),
        ("z^n D^m, D of the same area", power.n, &|z| {
            power_modulus(same_area(z))
        }),
    ];
    let wheels = ["smooth_1", "grouser_1", "grouser_2"].map(|name| pressed(&data, name));
    let mut doubts = Vec::new();
    for (law, n, modulus) in laws {
        let found = wheels
            .each_ref()
            .map(|wheel| measured_over_predicted(wheel, &|z| wheel_force(z, modulus(z), n)));
        for (wheel, (factor, surface, left)) in wheels.iter().zip(&found) {
            eprintln!(
                "{law}, {}: measured/predicted {factor:.2}, surface {:.1} mm, {:.1} % of the force left",
                wheel.name,
                1e3 * surface,
                100.0 * left
            );
            assert!(*left < 0.04, "the surface fits: {left}");
        }
        let squares = found.iter().map(|x| x.0.ln().powi(2)).sum::<f64>();
        doubts.push((law, found, (squares / found.len() as f64).sqrt()));
    }
    let of = |name: &str| doubts.iter().find(|(law, ..)| *law == name).unwrap();
    // Bekker's form with the wheel's width, as every verb uses it: the smooth wheel bears three quarters of it
    let (_, found, bekker_error) = of("Bekker, b the width");
    assert!((found[0].0 - 0.75).abs() < 0.05, "{found:?}");
    // the best form is nearer by a fifth of the error and still 14 % off, beyond the two repeats' difference of 4 %
    let (_, found, best) = of("z^n D^m, D of the same area");
    assert!((found[0].0 - 0.86).abs() < 0.05, "{found:?}");
    assert!(
        doubts.iter().all(|(_, _, error)| error >= best),
        "{doubts:?}"
    );
    assert!(*best > 0.1 && best < bekker_error, "{best} {bekker_error}");
    // with the wheel's diameter for D, as published for wheels of several sizes, it is worse
    let (_, _, published) = of("z^n D^m, D the wheel's");
    assert!(published > bekker_error, "{published}");
}
