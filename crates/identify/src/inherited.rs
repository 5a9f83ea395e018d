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

#[cfg(test)]
mod tests {
    use grouser_files::Document;
    use grouser_files::soil::{self, SoilNumber};
    use grouser_real::Real;
    use grouser_terra::{OpenSoil, Pressure};

    use super::*;
    use crate::{Job, WheelNumber, identify};

    /// Identified anew beside numbers that are moved by a tenth of each mixture, the answer moves by a tenth of what the
    /// mixture adds to its error.
    fn check(parameters: &[SoilNumber]) {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/bevameter/");
        let file = |name: &str| std::path::PathBuf::from(format!("{folder}{name}"));
        let mut job = Job::read(&Document::read(&file("tests.toml")).unwrap()).unwrap();
        job.soil = soil::read(&file("truth.toml")).unwrap().soil;
        let wheel = job.wheel.as_mut().unwrap();
        wheel.parameters = parameters.iter().copied().map(Parameter::Soil).collect();
        // without it the sinkage is off by more than its scatter in all tests, and few of them count
        wheel.parameters.push(Parameter::SinkageDatum);
        wheel.starts.starts = 1;
        let width = wheel.wheel.width();
        let taken = |number| !parameters.contains(&number);
        let whole = identify(&job).unwrap();
        let (plates, shear) = (
            whole.plates.as_ref().unwrap(),
            whole.shear.as_ref().unwrap(),
        );
        (job.plates, job.shear) = (Vec::new(), None);
        let of = |moved: &dyn Fn(&mut OpenSoil)| -> Vec<WheelNumber> {
            let mut job = job.clone();
            job.soil = whole.soil;
            moved(&mut job.soil);
            identify(&job).unwrap().wheel.unwrap().numbers
        };
        let alone = of(&|_| ());
        let mut squares = vec![0.0; parameters.len() + 1];
        let mut add = |moved: &dyn Fn(&mut OpenSoil)| {
            for ((sum, moved), own) in squares.iter_mut().zip(of(moved)).zip(&alone) {
                *sum += Real::powi(10.0 * (moved.value - own.value), 2);
            }
        };
        let mixtures = plates.fit.scatter(&plates.tests, width, taken(Exponent));
        for [n, k, k_c] in mixtures.unwrap() {
            add(&|soil| {
                soil.n = soil
                    .n
                    .map(|own| own + if taken(Exponent) { 0.1 * n } else { 0.0 });
                let Pressure::Bekker(law) = &mut soil.pressure else {
                    unreachable!("plates give Bekker's")
                };
                law.k_c = law.k_c.map(|own| own + 0.1 * k_c);
                law.k_phi = law.k_phi.map(|own| own + 0.1 * (k - k_c / width));
            });
        }
        let numbers = [Cohesion, Phi, KShear];
        let left: Vec<usize> = (0..3).filter(|place| taken(numbers[*place])).collect();
        for mixture in shear.fit.uncertainty.scatter(&left).unwrap() {
            add(&|soil| {
                for (number, moved) in numbers.into_iter().zip(&mixture) {
                    let number = Parameter::Soil(number);
                    let own = number.of(soil).unwrap();
                    number.put(soil, own + 0.1 * moved);
                }
            });
        }
        assert!(
            squares[0].sqrt() > 0.1 * alone[0].standard_error,
            "{squares:?}"
        );
        for ((number, own), squares) in whole.wheel.unwrap().numbers.iter().zip(&alone).zip(squares)
        {
            let close = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 0.02;
            assert!(close(number.value, own.value), "{number:?} {own:?}");
            let error = Real::hypot(own.standard_error, squares.sqrt());
            assert!(
                close(number.standard_error, error),
                "{number:?} {own:?} {error}"
            );
        }
    }

    #[test]
    fn a_modulus_inherits_the_exponent_and_the_other_modulus() {
        check(&[KPhi]);
    }

    #[test]
    fn a_modulus_beside_its_exponent_inherits_the_other_modulus() {
        check(&[Exponent, KPhi]);
    }

    #[test]
    fn friction_inherits_plates_and_cohesion() {
        check(&[Phi, KShear]);
    }
}
