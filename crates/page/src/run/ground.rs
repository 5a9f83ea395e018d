//! The ground around a drive: heights and soils on a grid, before the wheels passed.

use serde_json::{Value, json};

use super::drive::Drive;

/// Nodes along the longer side.
const MAX_NODES: f64 = 200.0;
/// The ground is shown this far around the way, as a share of its longer side, and at least so far, m.
const MARGIN: (f64, f64) = (0.06, 1.0);

/// Heights (m, null where unknown) and indices of soils, row by row from the lowest x and y on; null for a drive
/// without a way, or ground that cannot be built.
pub(super) fn object(drive: &Drive<'_>, x: &[f64], y: &[f64]) -> Value {
    let (Some([left, right]), Some([low, high])) = (range(x), range(y)) else {
        return Value::Null;
    };
    let Ok(ground) = drive.scenario.ground.build(drive.seed) else {
        return Value::Null;
    };
    let margin = MARGIN.1.max(MARGIN.0 * (right - left).max(high - low));
    let corners = [
        [left - margin, right + margin],
        [low - margin, high + margin],
    ];
    let step = corners
        .map(|[from, to]| to - from)
        .into_iter()
        .fold(0.0, f64::max)
        / MAX_NODES;
    let [across, up] = corners.map(|[from, to]| nodes(from, to, step));
    let mut heights = Vec::with_capacity(across.len() * up.len());
    let mut soils = Vec::with_capacity(heights.capacity());
    for y in &up {
        for x in &across {
            let spot = ground.at(*x, *y);
            // a tenth of a millimetre is far below what a picture shows
            heights.push(spot.known.then(|| (spot.height * 1e4).round() / 1e4));
            soils.push(spot.soil);
        }
    }
    let names: Vec<&str> = drive
        .scenario
        .ground
        .soils
        .iter()
        .map(|soil| soil.name.as_str())
        .collect();
    json!({
        "x_m": [across.first(), across.last()],
        "y_m": [up.first(), up.last()],
        "columns": across.len(),
        "height_m": heights,
        "soil": soils,
        "soils": names,
    })
}

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (low.is_finite() && high.is_finite()).then_some([low, high])
}

fn nodes(from: f64, to: f64, step: f64) -> Vec<f64> {
    let count = ((to - from) / step).round().max(1.0);
    let mut place = 0.0;
    let mut nodes = Vec::new();
    while place <= count {
        nodes.push(from + (to - from) * place / count);
        place += 1.0;
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_begin_and_end_at_the_corners() {
        let nodes = nodes(-1.0, 2.0, 0.25);
        assert_eq!((nodes[0], nodes[12], nodes.len()), (-1.0, 2.0, 13));
        assert_eq!(range(&[]), None);
        assert_eq!(range(&[2.0, -1.0]), Some([-1.0, 2.0]));
    }
}
