//! One operating point: the numbers of `grouser wheel --json`, and the stress along the contact.

use grouser_terra::{
    Angle, Cautions, FieldValue, LoadSolution, LugPassage, OperatingPoint, Prescribed, ResultField,
    Slip, SlopeOutcome,
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
        let mut greatest = None;
        out.insert("slope_pull_n".into(), json!(weight * angle.sin()));
        let outcome = match request.optional_number("slip_demand_near")? {
            Some(near) => pair.slip_demand_near(weight, angle, Slip::new(near)?)?,
            None => pair.slip_demand(weight, angle)?,
        };
        match outcome {
            SlopeOutcome::Holds { slip } => demand = Some(slip.value()),
            SlopeOutcome::Immobilised { max_pull, .. } => greatest = max_pull,
            SlopeOutcome::Slides { .. } => {}
        }
        out.insert("max_pull_n".into(), json!(greatest));
        out.insert("slip_demand".into(), json!(demand));
    }
    let Some(slip) = request.optional_number("slip")?.or(demand) else {
        out.insert("status".into(), json!("no-slip"));
        return Ok(out.into());
    };
    out.insert("slip".into(), json!(slip));
    let motion = kinematics(request, slip)?;
    let prescribed = match (load, request.optional_number("sinkage_m")?) {
        (Some(weight), None) => {
            Prescribed::Load(weight * slope.map_or(1.0, |slope| Angle::from_deg(slope).cos()))
        }
        (None, Some(sinkage)) => Prescribed::Sinkage(sinkage),
        _ => {
            return Err(Problem::new(
                "load_n",
                "exactly one of `load_n` and `sinkage_m` is needed",
            ));
        }
    };
    let solution = pair.solve(prescribed, &motion)?;
    insert(&mut out, LoadSolution::FIELDS, &solution);
    if let Some(point) = solution.point() {
        out.insert("cautions".into(), cautions(point.cautions));
        if let Some(lugs) = pair.lug_passage(&point) {
            insert(&mut out, LugPassage::FIELDS, &lugs);
        }
        let steps = request.count("profile", MAX_PROFILE_POINTS)?;
        if steps > 1 {
            out.insert("profile".into(), profile(&point, steps));
        }
    }
    Ok(out.into())
}

/// The fields of a result as the library declares them; lists of words have another form here.
fn insert<T>(out: &mut Map<String, Value>, fields: &[ResultField<T>], of: &T) {
    for field in fields {
        let value = match field.value(of) {
            FieldValue::Missing | FieldValue::Texts => Value::Null,
            FieldValue::Number(number) => json!(number),
            FieldValue::Whole(number) => json!(number),
            FieldValue::Text(text) => json!(text),
        };
        out.insert(field.key.to_owned(), value);
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
