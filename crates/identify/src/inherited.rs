//! What plates and shear tests leave uncertain of the numbers that the wheel stage takes from them.

use grouser_files::soil::SoilNumber::{Cohesion, Exponent, KPhi, KShear, Phi};
use grouser_opt::{Jacobian, Model as _};

use crate::job::WheelJob;
use crate::least_squares::Fit;
use crate::parameter::Parameter;
use crate::plate::{PlateFit, PlateTest};
use crate::shear::ShearFit;
use crate::wheel::{Fixed, WheelModel, WheelTest};

/// The numbers that a wheel stage takes from plates and shear tests.
const TAKEN: [Parameter; 5] = [
    Parameter::Soil(Exponent),
    Parameter::Soil(KPhi),
    Parameter::Soil(Cohesion),
    Parameter::Soil(Phi),
    Parameter::Soil(KShear),
];

/// How far the residuals of the wheel tests at their `best` fit change with one standard deviation of each independent
/// mixture of what plates and shear tests found and the wheel tests do not; `None` where those do not determine it.
pub(crate) fn changes(
    plates: Option<(&PlateFit, &[PlateTest])>,
    shear: Option<&ShearFit>,
    wheel: &WheelJob,
    (fixed, tests): (&Fixed, &[WheelTest]),
    best: &Fit,
) -> Option<Vec<Vec<f64>>> {
    let mut fixed = *fixed;
    for (parameter, value) in wheel.parameters.iter().zip(&best.x) {
        parameter.put(&mut fixed.soil, *value);
    }
    let x = TAKEN.map(|parameter| parameter.of(&fixed.soil).unwrap_or(f64::NAN));
    let count = best.residuals.len();
    let (mut values, mut slopes) = (vec![0.0; count], Jacobian::zeros(count, TAKEN.len()));
    WheelModel::new(fixed, tests, &TAKEN).derivatives(&x, &mut values, &mut slopes);
    let change = |moved: [f64; 5]| -> Vec<f64> {
        let of = |row: usize| slopes.row(row).iter().zip(moved).map(|(a, b)| a * b).sum();
        (0..count).map(of).collect()
    };
    let is_taken = TAKEN.map(|parameter| !wheel.parameters.contains(&parameter));
    let mut out = Vec::new();
    if let Some((fit, tests)) = plates {
        let width = wheel.wheel.width();
        for [n, k, k_c] in fit.scatter(tests, width, is_taken[0])? {
            // the wheel's width does not change, so that k_phi stands for k_c/b + k_phi; beside its own k_phi, k_c is left
            let k = if is_taken[1] { k } else { k_c / width };
            out.push(change([n, k, 0.0, 0.0, 0.0]));
        }
    }
    if let Some(fit) = shear {
        let taken: Vec<usize> = (0..3).filter(|k| is_taken[2 + k]).collect();
        for mixture in fit.uncertainty.scatter(&taken)? {
            out.push(change([0.0, 0.0, mixture[0], mixture[1], mixture[2]]));
        }
    }
    Some(out)
}
