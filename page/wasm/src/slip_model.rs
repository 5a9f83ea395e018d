//! The analytical slip model of Ani et al. (2012) over one of its quantities: the numbers of `grouser paper slip-model --json`.

use grouser_terra::{Angle, Mobilised, ModelOutcome, entry_angle, slip_model};
use serde_json::{Value, json};

use crate::request::{Problem, Request};

/// Most points of a sweep.
const MAX_POINTS: u32 = 10_000;

/// S at `theta_deg`, `sinkage_m` and `radius_m` with the share `mobilised` of the strength (above 0 it needs
/// `k_shear_m`), for `points` values of the quantity `sweep` between `from` and `to`. A value that the model refuses has
/// no slip: null.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let fixed = [
        request.number("theta_deg")?,
        request.number("sinkage_m")?,
        request.number("radius_m")?,
        request.optional_number("mobilised")?.unwrap_or(0.0),
    ];
    let k_shear = request.optional_number("k_shear_m")?;
    let names = ["theta_deg", "sinkage_m", "radius_m", "mobilised"];
    let sweep = request.text("sweep")?;
    let Some(swept) = names.iter().position(|name| *name == sweep) else {
        let known = names.join(", ");
        return Err(Problem::new(
            "sweep",
            format!("`{sweep}` is none of {known}"),
        ));
    };
    let (from, to) = (request.number("from")?, request.number("to")?);
    let points = request.count("points", MAX_POINTS)?;
    if points < 2 {
        return Err(Problem::new("points", "a sweep has two points or more"));
    }
    let (mut at, mut slips, mut formulas, mut inside) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for i in 0..points {
        let value = from + (to - from) * (f64::from(i) / f64::from(points - 1));
        let mut all = fixed;
        all[swept] = value;
        let [theta_deg, sinkage, radius, share] = all;
        let mobilised = match (share > 0.0, k_shear) {
            (false, _) => None,
            (true, Some(k_shear)) => Some(Mobilised { share, k_shear }),
            (true, None) => {
                return Err(Problem::new(
                    "k_shear_m",
                    "a mobilised share needs the soil's K",
                ));
            }
        };
        let found = match slip_model(Angle::from_deg(theta_deg), sinkage, radius, mobilised) {
            Ok(ModelOutcome::Slip(found)) => Some(found),
            _ => None,
        };
        at.push(value);
        slips.push(found.map(|found| found.slip.value()));
        formulas.push(found.map(|found| found.driving_formula));
        inside.push(found.is_some_and(|found| found.in_contact));
    }
    let is_wheel = fixed[1] > 0.0 && fixed[1] < fixed[2];
    Ok(json!({
        "at": at,
        "slip": slips,
        "driving_formula_slip": formulas,
        "in_contact": inside,
        "theta_1_deg": is_wheel.then(|| entry_angle(fixed[1], fixed[2]).to_degrees()),
    }))
}
