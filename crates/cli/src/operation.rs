//! One operating point of a wheel, at a prescribed load or sinkage: its text fields in addition to the declared ones.

use grouser_report::number::{in_message, shown};
use grouser_report::{Fields, fields};
use grouser_terra::{LoadOutcome, LoadSolution, LugPassage, Prescribed};

/// Why there is no point; `None` where there is one.
pub(crate) fn complaint(answer: &LoadSolution, prescribed: Prescribed) -> Option<String> {
    match (&answer.outcome, prescribed) {
        (LoadOutcome::Solved(_), _) => None,
        (LoadOutcome::NoSolution { max_load }, Prescribed::Load(load)) => Some(format!(
            "no sinkage carries {} N; the maximum load that was found is {} N",
            in_message(load),
            shown(*max_load)
        )),
        (LoadOutcome::NoSolution { .. } | LoadOutcome::NotConverged, _) => {
            Some("the search for the sinkage did not converge".to_owned())
        }
    }
}

/// The quantities of an operating point; without a value where there is none.
pub(crate) fn fields<'a>() -> Fields<'a, &'a LoadSolution> {
    let shown = |angle: f64| shown(angle.to_degrees());
    fields! { |answer: &'a LoadSolution|
        declared(LoadSolution::FIELDS) = Some(answer);
        remark "entry, peak stress, exit" .shown("deg").as_number() = answer.point().map(|point| {
            let [entry, peak, exit] =
                [point.angles.theta_1, point.angles.theta_m, point.angles.theta_2].map(shown);
            format!("{entry} / {peak} / {exit}")
        }).unwrap_or_default();
    }
}

/// How far the forces rise and fall as lugs pass.
pub(crate) fn passage<'a>() -> Fields<'a, Option<LugPassage>> {
    Fields::new().declared(LugPassage::FIELDS, |lugs| lugs)
}
