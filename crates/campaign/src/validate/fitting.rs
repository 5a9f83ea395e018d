//! A model fitted to some tests, and its predictions of others.

use grouser_terra::{OpenSoil, RigidWheel};

use super::rows::{FitReport, Found, ModelName};
use grouser_identify::Parameter;
use grouser_identify::least_squares::{
    Bounded, Loss, Settings, StartSettings, Uncertainty, multi_start,
};
use grouser_identify::wheel::{
    Fixed, Prediction, Scatter, WheelModel, WheelTest, fitted_range, predict,
};
use grouser_identify::{Error, Result};

/// A wheel, soil or motion of the measured data that the laws refuse.
pub(super) fn law_error(source: grouser_terra::Error) -> Error {
    Error::Law {
        what: "a wheel of the measured data".to_owned(),
        source,
    }
}

/// A model with its numbers.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub(super) fixed: Fixed,
    pub(super) parameters: Vec<Parameter>,
    pub(super) x: Vec<f64>,
    pub(super) report: FitReport,
}

/// What is fitted, and how.
pub(super) struct Job<'a> {
    pub(super) data_set: &'static str,
    pub(super) model: ModelName,
    pub(super) fit: &'static str,
    pub(super) wheel: RigidWheel,
    pub(super) soil: OpenSoil,
    pub(super) scatter: Scatter,
    pub(super) tests: &'a [WheelTest],
    pub(super) parameters: &'a [Parameter],
}

impl Job<'_> {
    /// Fits from the soil's own numbers and five more starts.
    pub(super) fn run(&self) -> Result<Fitted> {
        let fixed = Fixed {
            wheel: self.wheel,
            soil: self.soil,
            scatter: self.scatter,
        };
        let model = WheelModel::new(fixed, self.tests, self.parameters);
        let start: Vec<Bounded> = self
            .parameters
            .iter()
            .map(|parameter| parameter.bounded(&self.soil))
            .collect();
        let settings = Settings {
            steps: 200,
            ..Settings::default()
        };
        let starts = StartSettings { starts: 6, seed: 1 };
        let (best, _) = multi_start(&model, model.count(), &start, &settings, &starts)?;
        let uncertainty = Uncertainty::from_fit(&best, Loss::Squares);
        let found = self
            .parameters
            .iter()
            .enumerate()
            .map(|(index, parameter)| Found {
                parameter: *parameter,
                value: best.x[index],
                standard_error: uncertainty.standard_errors[index],
                verdict: uncertainty.verdicts[index],
            })
            .collect();
        let mut soil = self.soil;
        for (parameter, value) in self.parameters.iter().zip(&best.x) {
            parameter.put(&mut soil, *value);
        }
        soil.fitted = fitted_range(&self.wheel, self.tests);
        Ok(Fitted {
            fixed,
            parameters: self.parameters.to_vec(),
            report: FitReport {
                data_set: self.data_set,
                model: self.model,
                fit: self.fit,
                soil,
                status: best.status,
                found,
                condition: uncertainty.condition,
            },
            x: best.x,
        })
    }

    /// The model with nothing fitted.
    pub(super) fn unfitted(&self) -> Fitted {
        Fitted {
            fixed: Fixed {
                wheel: self.wheel,
                soil: self.soil,
                scatter: self.scatter,
            },
            parameters: Vec::new(),
            x: Vec::new(),
            report: FitReport {
                data_set: self.data_set,
                model: self.model,
                fit: self.fit,
                soil: self.soil,
                status: grouser_identify::least_squares::Status::Converged,
                found: Vec::new(),
                condition: 1.0,
            },
        }
    }
}

impl Fitted {
    /// Its predictions of `tests`, as read.
    pub(super) fn predict(&self, tests: &[WheelTest]) -> Result<Vec<Prediction>> {
        predict(&self.fixed, tests, &self.parameters, &self.x)
    }

    /// The same numbers on another wheel.
    pub(super) fn on(&self, wheel: RigidWheel) -> Self {
        let mut other = self.clone();
        other.fixed.wheel = wheel;
        other
    }
}
