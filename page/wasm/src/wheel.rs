//! One operating point: the numbers of `grouser wheel --json`, and the stress along the contact.

use grouser_terra::{
    Angle, Cautions, LoadOutcome, OperatingPoint, Slip, SlopeOutcome, WheelOnSoil,
};
use serde_json::{Map, Value, json};

use crate::contact::{contact, kinematics};
use crate::request::{Problem, Request};

/// Most points along the contact.
const MAX_PROFILE_POINTS: u32 = 1000;

/// Solves the request's operating point: `slip`, or without it the slip that holds `slope_deg`; `load_n` (the
/// weight on a slope) or `sinkage_m`; `profile` points of stress. With `slip_demand_near` the slip that holds the
/// slope is looked for near that one first.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let pair = contact(request)?;
    let load = request.optional_number("load_n")?;
    let slope = request.optional_number("slope_deg")?;
    let mut out = Map::new();
    let mut demand = None;
    if let (Some(weight), Some(degrees)) = (load, slope) {
        let angle = Angle::from_deg(degrees);
        out.insert("slope_pull_n".into(), json!(weight * angle.sin()));
        let outcome = match request.optional_number("slip_demand_near")? {
            Some(near) => pair.slip_demand_near(weight, angle, Slip::new(near)?)?,
            None => pair.slip_demand(weight, angle)?,
        };
        match outcome {
            SlopeOutcome::Holds { slip } => demand = Some(slip.value()),
            SlopeOutcome::Immobilised { max_pull, .. } => {
                out.insert("max_pull_n".into(), json!(max_pull));
            }
            _ => {}
        }
        out.insert("slip_demand".into(), json!(demand));
    }
    let Some(slip) = request.optional_number("slip")?.or(demand) else {
        out.insert("status".into(), json!("no-slip"));
        return Ok(out.into());
    };
    out.insert("slip".into(), json!(slip));
    let motion = kinematics(request, slip)?;
    let point = match (load, request.optional_number("sinkage_m")?) {
        (Some(weight), None) => {
            let load = weight * slope.map_or(1.0, |slope| Angle::from_deg(slope).cos());
            let solution = pair.under_load(load, &motion)?;
            out.insert("evaluations".into(), json!(solution.evaluations));
            out.insert("status".into(), json!(status(&solution.outcome)));
            if let LoadOutcome::NoSolution { max_load } = solution.outcome {
                out.insert("max_load_n".into(), json!(max_load));
            }
            solution.point()
        }
        (None, Some(sinkage)) => {
            out.insert("status".into(), json!("ok"));
            Some(pair.at_sinkage(sinkage, &motion)?)
        }
        _ => {
            return Err(Problem::new(
                "load_n",
                "exactly one of `load_n` and `sinkage_m` is needed",
            ));
        }
    };
    if let Some(point) = point {
        insert_point(&mut out, &pair, &point);
        let steps = request.count("profile", MAX_PROFILE_POINTS)?;
        if steps > 1 {
            out.insert("profile".into(), profile(&point, steps));
        }
    }
    Ok(out.into())
}

/// The status in the words of the command.
pub(crate) fn status<T>(outcome: &LoadOutcome<T>) -> &'static str {
    match outcome {
        LoadOutcome::Solved(_) => "ok",
        LoadOutcome::NoSolution { .. } => "no-solution",
        _ => "not-converged",
    }
}

fn insert_point(out: &mut Map<String, Value>, pair: &WheelOnSoil, point: &OperatingPoint) {
    let angles = &point.angles;
    let forces = &point.forces;
    let mut put = |key: &str, value: Value| out.insert(key.to_owned(), value);
    put("sinkage_m", json!(point.sinkage));
    put("theta_1_deg", json!(angles.theta_1.to_degrees()));
    put("theta_2_deg", json!(angles.theta_2.to_degrees()));
    put("theta_m_deg", json!(angles.theta_m.to_degrees()));
    put("vertical_force_n", json!(forces.vertical_force));
    put("drawbar_pull_n", json!(forces.drawbar_pull));
    put("side_force_n", json!(point.side_force));
    put("torque_nm", json!(forces.torque));
    put("tractive_efficiency", json!(point.tractive_efficiency()));
    put("energy_j_per_m", json!(point.energy_per_metre()));
    put("pull_coefficient", json!(point.pull_coefficient()));
    put(
        "compaction_resistance_n",
        json!(forces.compaction_resistance),
    );
    put("error_estimate_n", json!(point.error_estimate));
    put("running_radius_m", json!(pair.wheel().running_radius()));
    put("cautions", cautions(point.cautions));
    if let Some(lugs) = pair.lug_passage(point) {
        put("grouser_spacing_deg", json!(lugs.spacing.to_degrees()));
        put("grousers_in_soil", json!(lugs.in_soil));
        put("pull_fluctuation_n", json!(lugs.pull));
        put("torque_fluctuation_nm", json!(lugs.torque));
    }
}

/// Cautions with their words.
pub(crate) fn cautions(cautions: Cautions) -> Value {
    cautions
        .iter()
        .map(|caution| json!({ "key": caution.key(), "text": caution.to_string() }))
        .collect()
}

/// Stress from exit to entry, Pa.
fn profile(point: &OperatingPoint, steps: u32) -> Value {
    let (from, to) = (point.angles.theta_2, point.angles.theta_1);
    let theta = |i: u32| from + (to - from) * f64::from(i) / f64::from(steps - 1);
    let column = |of: &dyn Fn(f64) -> f64| -> Value { (0..steps).map(|i| of(theta(i))).collect() };
    json!({
        "theta_deg": column(&f64::to_degrees),
        "normal_stress_pa": column(&|theta| point.normal_stress(theta)),
        "shear_stress_pa": column(&|theta| point.shear_stress(theta).0),
        "side_shear_stress_pa": column(&|theta| point.shear_stress(theta).1),
    })
}
