//! One operating point of a wheel, at a prescribed load or sinkage, and its keys.

use grouser_report::number::{in_message, shown};
use grouser_report::{Fields, fields};
use grouser_terra::{Error as LawError, Kinematics, LoadOutcome, OperatingPoint, WheelOnSoil};

/// The quantity that an operating point is solved at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Prescribed {
    /// The load that the wheel carries, N.
    Load(f64),
    /// How deep it has sunk, m.
    Sinkage(f64),
}

impl Prescribed {
    /// The load, if it is prescribed.
    pub(crate) fn load(self) -> Option<f64> {
        match self {
            Self::Load(load) => Some(load),
            Self::Sinkage(_) => None,
        }
    }

    /// The sinkage, if it is prescribed.
    pub(crate) fn sinkage(self) -> Option<f64> {
        match self {
            Self::Load(_) => None,
            Self::Sinkage(sinkage) => Some(sinkage),
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
    pub(crate) fn complaint(self, prescribed: Prescribed) -> Option<String> {
        match (self, prescribed) {
            (Self::Ok, _) => None,
            (Self::NoSolution(most), Prescribed::Load(load)) => Some(format!(
                "no sinkage carries {} N; the most that was found to be carried is {} N",
                in_message(load),
                shown(most)
            )),
            _ => Some("the search for the sinkage did not converge".to_owned()),
        }
    }
}

/// Solves the operating point of `pair`.
pub(crate) fn solve(
    pair: &WheelOnSoil,
    prescribed: Prescribed,
    kinematics: &Kinematics,
) -> Result<Answer, LawError> {
    match prescribed {
        Prescribed::Sinkage(sinkage) => Ok(Answer {
            status: Status::Ok,
            point: Some(pair.at_sinkage(sinkage, kinematics)?),
            residual: None,
            evaluations: 1,
        }),
        Prescribed::Load(load) => {
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
    /// The greatest load that some sinkage carries, where the load is greater, N.
    fn max_load(&self) -> Option<f64> {
        match self.status {
            Status::NoSolution(max_load) => Some(max_load),
            _ => None,
        }
    }

    fn cautions(&self) -> Vec<&'static str> {
        let cautions = self.point.iter().flat_map(|point| point.cautions.iter());
        cautions.map(grouser_terra::Caution::key).collect()
    }
}

/// The quantities of an operating point; without a value where there is none.
pub(crate) fn fields<'a>() -> Fields<'a, &'a Answer> {
    let shown = |angle: f64| shown(angle.to_degrees());
    fields! { |answer: &'a Answer|
        "status" "status" .shown("") = answer.status.key();
        join(point()) = answer.point.as_ref();
        remark "entry, greatest stress, exit" .shown("deg").as_number() = answer.point.map(|point| {
            let [entry, greatest, exit] =
                [point.angles.theta_1, point.angles.theta_m, point.angles.theta_2].map(shown);
            format!("{entry} / {greatest} / {exit}")
        }).unwrap_or_default();
        "residual" "difference between the load and the vertical force" = answer.residual;
        "energy_residual_nm" "torque that the energy balance leaves" =
            answer.point.map(|point| point.forces.energy_residual);
        "error_estimate_n" "error of the integrals at most" .shown("N") =
            answer.point.map(|point| point.error_estimate);
        "evaluations" "evaluations of the forces" = answer.evaluations;
        "max_load_n" "the greatest load that was found to be carried" = answer.max_load();
        "cautions" "cautions" = answer.cautions();
    }
}

fn point<'a>() -> Fields<'a, Option<&'a OperatingPoint>> {
    fields! { |point: Option<&'a OperatingPoint>|
        "sinkage_m" "sinkage" .shown("mm") = point.map(|p| p.sinkage);
        "theta_1_deg" "entry angle" = point.map(|p| p.angles.theta_1.to_degrees());
        "theta_2_deg" "exit angle" = point.map(|p| p.angles.theta_2.to_degrees());
        "theta_m_deg" "angle of the greatest stress" = point.map(|p| p.angles.theta_m.to_degrees());
        "vertical_force_n" "vertical force" .shown("N") = point.map(|p| p.forces.vertical_force);
        "drawbar_pull_n" "drawbar pull" .shown("N") = point.map(|p| p.forces.drawbar_pull);
        "side_force_n" "side force" .shown("N") = point.map(|p| p.side_force);
        "torque_nm" "torque" .shown("N m") = point.map(|p| p.forces.torque);
        "tractive_efficiency" "tractive efficiency" .shown("%").missing("none") =
            point.and_then(OperatingPoint::tractive_efficiency);
        "energy_j_per_m" "energy" .shown("J/m").missing("none") = point.and_then(OperatingPoint::energy_per_metre);
        "pull_coefficient" "drawbar pull over vertical force" = point.and_then(OperatingPoint::pull_coefficient);
        "compaction_resistance_n" "compaction resistance" .shown("N") =
            point.map(|p| p.forces.compaction_resistance);
    }
}
