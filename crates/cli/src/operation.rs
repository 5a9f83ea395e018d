//! One operating point of a wheel, asked for by its load or by its sinkage, and its keys.

use grouser_terra::{Error as LawError, Kinematics, LoadOutcome, OperatingPoint, WheelOnSoil};
use serde_json::Value;

use crate::report::Object;

/// What an operating point is asked for by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Asked {
    /// The load that the wheel carries, N.
    Load(f64),
    /// How deep it has sunk, m.
    Sinkage(f64),
}

impl Asked {
    /// The load, if it is asked for by one.
    pub(crate) fn load(self) -> Option<f64> {
        match self {
            Self::Load(load) => Some(load),
            Self::Sinkage(_) => None,
        }
    }
}

/// An operating point, or why there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) status: Status,
    pub(crate) point: Option<OperatingPoint>,
    residual: Option<f64>,
    evaluations: u32,
}

/// How the search for an operating point ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Status {
    Ok,
    /// The greatest load that some sinkage carries, N.
    NoSolution(f64),
    NotConverged,
}

impl Status {
    /// Its name in files and in JSON.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NoSolution(_) => "no-solution",
            Self::NotConverged => "not-converged",
        }
    }

    /// Why there is no point; `None` where there is one.
    pub(crate) fn complaint(self, asked: Asked) -> Option<String> {
        use grouser_report::number::told;
        match (self, asked) {
            (Self::Ok, _) => None,
            (Self::NoSolution(most), Asked::Load(load)) => Some(format!(
                "no sinkage carries {} N; the most that was found to be carried is {} N",
                told(load),
                grouser_report::number::shown(most)
            )),
            _ => Some("the search for the sinkage did not converge".to_owned()),
        }
    }
}

/// Asks `pair` for the operating point.
pub(crate) fn solve(
    pair: &WheelOnSoil,
    asked: Asked,
    kinematics: &Kinematics,
) -> Result<Answer, LawError> {
    match asked {
        Asked::Sinkage(sinkage) => Ok(Answer {
            status: Status::Ok,
            point: Some(pair.at_sinkage(sinkage, kinematics)?),
            residual: None,
            evaluations: 1,
        }),
        Asked::Load(load) => {
            let solution = pair.under_load(load, kinematics)?;
            let status = match solution.outcome {
                LoadOutcome::Solved(_) => Status::Ok,
                LoadOutcome::NoSolution { max_load } => Status::NoSolution(max_load),
                _ => Status::NotConverged,
            };
            Ok(Answer {
                status,
                point: solution.point(),
                residual: solution.residual(),
                evaluations: solution.evaluations,
            })
        }
    }
}

impl Answer {
    /// The keys of an operating point; `null` where there is none.
    pub(crate) fn object(&self) -> Object {
        let number = |f: &dyn Fn(&OperatingPoint) -> Option<f64>| {
            Value::from(self.point.as_ref().and_then(f))
        };
        let max_load = match self.status {
            Status::NoSolution(most) => Some(most),
            _ => None,
        };
        let cautions = self.point.iter().flat_map(|point| point.cautions.iter());
        [
            ("status", Value::from(self.status.key())),
            ("sinkage_m", number(&|p| Some(p.sinkage))),
            (
                "theta_1_deg",
                number(&|p| Some(p.angles.theta_1.to_degrees())),
            ),
            (
                "theta_2_deg",
                number(&|p| Some(p.angles.theta_2.to_degrees())),
            ),
            (
                "theta_m_deg",
                number(&|p| Some(p.angles.theta_m.to_degrees())),
            ),
            (
                "vertical_force_n",
                number(&|p| Some(p.forces.vertical_force)),
            ),
            ("drawbar_pull_n", number(&|p| Some(p.forces.drawbar_pull))),
            ("side_force_n", number(&|p| Some(p.side_force))),
            ("torque_nm", number(&|p| Some(p.forces.torque))),
            (
                "tractive_efficiency",
                number(&OperatingPoint::tractive_efficiency),
            ),
            ("energy_j_per_m", number(&OperatingPoint::energy_per_metre)),
            (
                "pull_coefficient",
                number(&OperatingPoint::pull_coefficient),
            ),
            (
                "compaction_resistance_n",
                number(&|p| Some(p.forces.compaction_resistance)),
            ),
            ("residual", Value::from(self.residual)),
            (
                "energy_residual_nm",
                number(&|p| Some(p.forces.energy_residual)),
            ),
            ("error_estimate_n", number(&|p| Some(p.error_estimate))),
            ("evaluations", Value::from(self.evaluations)),
            ("max_load_n", Value::from(max_load)),
            (
                "cautions",
                cautions.map(|caution| Value::from(caution.key())).collect(),
            ),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }
}
