//! A wheel over a range of slip: the numbers of `grouser wheel --slip FROM:TO --json`.

use std::collections::BTreeMap;

use grouser_terra::{
    Angle, BatchColumns, BatchKernel, BestSlip, Caution, OperatingPoint, Slip, SolveStatus,
    WheelOnSoil,
};
use serde_json::{Value, json};

use crate::contact::{contact, kinematics};
use crate::request::{Problem, Request};

/// Most points of a curve.
const MAX_POINTS: u32 = 10_000;

/// A curve in columns; `None` where a slip has no solution.
struct Columns {
    pull: Vec<Option<f64>>,
    torque: Vec<Option<f64>>,
    sinkage: Vec<Option<f64>>,
    efficiency: Vec<Option<f64>>,
    side_force: Vec<Option<f64>>,
    /// `None` where they were not looked for.
    cautions: Option<Value>,
}

/// Solves `points` slips from `slip_from` to `slip_to` under `load_n`, the weight on a slope (`slope_deg`); with
/// `best` also where pull and efficiency are greatest. With `quick` a smooth wheel that drives straight ahead is
/// solved on lanes: the same numbers to 1e-9, without cautions.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let pair = contact(request)?;
    let slope = request.optional_number("slope_deg")?.map(Angle::from_deg);
    let load = request.number("load_n")? * slope.map_or(1.0, Angle::cos);
    let (from, to) = (request.number("slip_from")?, request.number("slip_to")?);
    let points = request.count("points", MAX_POINTS)?;
    if points < 2 {
        return Err(Problem::new("points", "a curve has two points or more"));
    }
    let last = points - 1;
    // the last point is exactly the one that was requested
    let slip = |i: u32| {
        if i == last {
            to
        } else {
            from + (to - from) * (f64::from(i) / f64::from(last))
        }
    };
    let slips: Vec<f64> = (0..points).map(slip).collect();
    let straight = request.optional_number("slip_angle_deg")?.unwrap_or(0.0) == 0.0;
    let on_lanes = request.is_set("quick") && straight && pair.wheel().grousers().is_none();
    let columns = if on_lanes {
        // what is wrong with a slip or the load is said by the same check as of a single point
        pair.under_load(load, &kinematics(request, from)?)?;
        kinematics(request, to)?;
        on_lanes_of(&pair, load, &slips)?
    } else {
        one_by_one(request, &pair, load, &slips)?
    };
    let mut out = json!({
        "slip": slips,
        "drawbar_pull_n": columns.pull,
        "torque_nm": columns.torque,
        "sinkage_m": columns.sinkage,
        "tractive_efficiency": columns.efficiency,
        "side_force_n": columns.side_force,
        "cautions": columns.cautions,
    });
    if request.is_set("best") && straight {
        out["most_pull"] = best(pair.slip_of_maximum_pull(load)?, "drawbar_pull_n");
        out["most_efficient"] = best(
            pair.slip_of_maximum_efficiency(load)?,
            "tractive_efficiency",
        );
    }
    Ok(out)
}

fn one_by_one(
    request: &Request<'_>,
    pair: &WheelOnSoil,
    load: f64,
    slips: &[f64],
) -> Result<Columns, Problem> {
    let mut solved: Vec<Option<OperatingPoint>> = Vec::with_capacity(slips.len());
    for &slip in slips {
        let motion = kinematics(request, slip)?;
        solved.push(pair.under_load(load, &motion)?.point());
    }
    let column = |of: &dyn Fn(&OperatingPoint) -> Option<f64>| {
        solved
            .iter()
            .map(|point| point.as_ref().and_then(of))
            .collect()
    };
    Ok(Columns {
        pull: column(&|point| Some(point.forces.drawbar_pull)),
        torque: column(&|point| Some(point.forces.torque)),
        sinkage: column(&|point| Some(point.sinkage)),
        efficiency: column(&OperatingPoint::tractive_efficiency),
        side_force: column(&|point| Some(point.side_force)),
        cautions: Some(cautions(&solved)),
    })
}

fn on_lanes_of(pair: &WheelOnSoil, load: f64, slips: &[f64]) -> Result<Columns, Problem> {
    let n = slips.len();
    let [mut sinkage, mut vertical_force, mut pull, mut torque] =
        [(); 4].map(|()| vec![f64::NAN; n]);
    let mut status = vec![SolveStatus::default(); n];
    let mut columns = BatchColumns {
        sinkage: &mut sinkage,
        vertical_force: &mut vertical_force,
        drawbar_pull: &mut pull,
        torque: &mut torque,
        status: &mut status,
    };
    BatchKernel::new(*pair.soil()).curve(pair.wheel(), load, slips, &mut columns)?;
    let solved = |values: &[f64]| {
        let values = values.iter().map(|value| Some(*value));
        values
            .map(|value| value.filter(|value| value.is_finite()))
            .collect::<Vec<_>>()
    };
    let radius = pair.wheel().running_radius();
    let efficiency = |i: usize| {
        let q = Slip::new(slips[i]).ok()?.speed_ratio();
        (torque[i] > 0.0 && pull[i] > 0.0).then(|| pull[i] * q * radius / torque[i])
    };
    Ok(Columns {
        efficiency: (0..n).map(efficiency).collect(),
        side_force: pull
            .iter()
            .map(|pull| pull.is_finite().then_some(0.0))
            .collect(),
        pull: solved(&pull),
        torque: solved(&torque),
        sinkage: solved(&sinkage),
        cautions: None,
    })
}

fn best(best: Option<BestSlip>, key: &str) -> Value {
    best.map_or(
        Value::Null,
        |best| json!({ "slip": best.slip.value(), key: best.value }),
    )
}

/// Each caution once, with the number of points that carry it.
fn cautions(points: &[Option<OperatingPoint>]) -> Value {
    let mut counts: BTreeMap<Caution, u32> = BTreeMap::new();
    for point in points.iter().flatten() {
        for caution in point.cautions.iter() {
            *counts.entry(caution).or_default() += 1;
        }
    }
    counts
        .into_iter()
        .map(|(caution, points)| {
            json!({ "key": caution.key(), "text": caution.to_string(), "points": points })
        })
        .collect()
}
