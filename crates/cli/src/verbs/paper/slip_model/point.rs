//! One answer of the model.

use grouser_terra::{Angle, Error as LawError, Mobilised, ModelOutcome, ModelSlip, slip_model};

/// One answer of the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) theta_deg: f64,
    pub(super) sinkage_m: f64,
    pub(super) radius_m: f64,
    pub(super) outcome: std::result::Result<ModelOutcome, LawError>,
}

/// The model at an angle, a sinkage and a radius.
pub(super) fn evaluate(
    [theta_deg, sinkage_m, radius_m]: [f64; 3],
    mobilised: Option<Mobilised>,
) -> Point {
    let outcome = slip_model(Angle::from_deg(theta_deg), sinkage_m, radius_m, mobilised);
    Point {
        theta_deg,
        sinkage_m,
        radius_m,
        outcome,
    }
}

impl Point {
    pub(super) fn slip(&self) -> Option<ModelSlip> {
        match self.outcome {
            Ok(ModelOutcome::Slip(slip)) => Some(slip),
            _ => None,
        }
    }

    /// The greatest share that can be mobilised, where the requested one cannot.
    pub(super) fn max_share(&self) -> Option<f64> {
        match self.outcome {
            Ok(ModelOutcome::Unreachable { max_share }) => Some(max_share),
            _ => None,
        }
    }

    pub(super) fn status(&self) -> &'static str {
        match self.outcome {
            Ok(ModelOutcome::Slip(_)) => "ok",
            Ok(_) => "unreachable",
            Err(_) => "outside-model",
        }
    }

    pub(super) fn cautions(&self) -> Vec<&'static str> {
        let outside = self.slip().is_some_and(|slip| !slip.in_contact);
        outside.then_some("outside-contact").into_iter().collect()
    }
}
