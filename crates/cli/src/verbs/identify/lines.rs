//! The numbers that `identify` found, each with its interval.

use grouser_identify::least_squares::{Interval, Verdict};
use grouser_identify::plate::PlateFit;
use grouser_identify::wheel::Quantity;
use grouser_identify::{Identification, WheelStage};

/// One number: name, value, standard error, interval, verdict, in the unit of its name.
#[derive(Clone)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) value: f64,
    pub(super) standard_error: f64,
    pub(super) interval: Interval,
    pub(super) verdict: Verdict,
}

pub(super) fn unit_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pull | Quantity::Side => "n",
        Quantity::Torque => "nm",
        Quantity::Sinkage => "mm",
    }
}

pub(super) fn plate_lines(fit: &PlateFit) -> Vec<Line> {
    fit.parameters
        .iter()
        .map(|number| Line {
            name: number.name.clone(),
            value: number.value,
            standard_error: number.standard_error,
            interval: number.interval,
            verdict: number.verdict,
        })
        .collect()
}

pub(super) fn shear_lines(found: &Identification) -> Vec<Line> {
    let Some(stage) = &found.shear else {
        return Vec::new();
    };
    let names = [
        ("cohesion_kpa", 1e3),
        ("phi_deg", std::f64::consts::PI / 180.0),
        ("k_shear_m", 1.0),
    ];
    names
        .into_iter()
        .enumerate()
        .map(|(index, (name, unit))| Line {
            name: name.to_owned(),
            value: stage.fit.values[index] / unit,
            standard_error: stage.fit.standard_errors[index] / unit,
            interval: scaled(stage.fit.intervals[index], |v| v / unit),
            verdict: stage.fit.uncertainty.verdicts[index],
        })
        .collect()
}

pub(super) fn wheel_lines(stage: &WheelStage) -> Vec<Line> {
    stage
        .numbers
        .iter()
        .map(|number| {
            let unit = |value| number.parameter.to_key_unit(value);
            Line {
                name: number.parameter.key().to_owned(),
                value: unit(number.value),
                standard_error: unit(number.standard_error),
                interval: scaled(number.interval, unit),
                verdict: number.verdict,
            }
        })
        .collect()
}

fn scaled(interval: Interval, unit: impl Fn(f64) -> f64) -> Interval {
    Interval {
        low: interval.low.map(&unit),
        high: interval.high.map(&unit),
    }
}

/// Root mean square error of each quantity that was read, in its unit.
pub(super) fn errors(stage: &WheelStage) -> Vec<(Quantity, f64, usize)> {
    Quantity::ALL
        .into_iter()
        .filter_map(|quantity| {
            let errors: Vec<f64> = stage
                .tests
                .iter()
                .zip(&stage.said)
                .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
                .collect();
            let squares: f64 = errors.iter().map(|e| e * e).sum();
            let count = errors.len();
            (count > 0).then(|| {
                let rmse = (squares / count as f64).sqrt() / quantity.scale();
                (quantity, rmse, count)
            })
        })
        .collect()
}
