//! The shape of the ground as a picture: light and shade by its slope, contours by its height.

use grouser_figure::{Colour, MapFrame, Picture, even_ticks};
use grouser_rover::ground::Ground;

/// Pixels per unit of the picture.
const PIXELS_PER_UNIT: f64 = 0.8;
/// Cells along the longer side between which contours run.
const MAX_CELLS: f64 = 220.0;
/// Contours at most.
const MAX_CONTOURS: u8 = 9;
/// Slopes are shown this much steeper, so that gentle ground has a shape.
const SLOPE_EXAGGERATION: f64 = 2.0;
/// Ground of each soil in full light: sand, then tints for other soils.
const TINTS: [[f64; 3]; 5] = [
    [244.0, 233.0, 208.0],
    [213.0, 190.0, 158.0],
    [214.0, 220.0, 186.0],
    [200.0, 214.0, 222.0],
    [226.0, 204.0, 210.0],
];
/// Where the map knows nothing.
const UNKNOWN: [f64; 3] = [205.0, 205.0, 205.0];

/// The relief of the ground in a frame, lit from the upper left.
pub(super) fn relief(ground: &Ground, frame: &MapFrame) -> Picture {
    let [columns, rows] = frame.size().map(|length| side(length * PIXELS_PER_UNIT));
    let light = [-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];
    let level = light[2];
    let [low, high] = frame.corners();
    Picture::new([columns, rows], |column, row| {
        let (column, row) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let x = low[0] + (high[0] - low[0]) * column / f64::from(columns);
        let y = high[1] - (high[1] - low[1]) * row / f64::from(rows);
        let spot = ground.at(x, y);
        let [right, up] = spot.slope.map(|slope| slope * SLOPE_EXAGGERATION);
        let normal = (1.0 + right * right + up * up).sqrt();
        let lit = (light[2] - light[0] * right - light[1] * up) / normal;
        let brightness = (0.97 + 0.42 * (lit.max(0.0) - level)).clamp(0.6, 1.06);
        let tint = if spot.known {
            TINTS[spot.soil.min(TINTS.len() - 1)]
        } else {
            UNKNOWN
        };
        let [red, green, blue] = tint.map(|value| byte(value * brightness));
        Colour(red, green, blue)
    })
}

/// Contours: their distance in height (m), and their segments (m). Nothing for level ground.
pub(super) fn contours(ground: &Ground, frame: &MapFrame) -> Option<(f64, Vec<[[f64; 2]; 2]>)> {
    let [low, high] = frame.corners();
    let cell = (high[0] - low[0]).max(high[1] - low[1]) / MAX_CELLS;
    let [columns, rows] = [0, 1].map(|axis| side((high[axis] - low[axis]) / cell));
    let node = |column: u32, row: u32| {
        [
            low[0] + (high[0] - low[0]) * f64::from(column) / f64::from(columns),
            low[1] + (high[1] - low[1]) * f64::from(row) / f64::from(rows),
        ]
    };
    let mut heights = Vec::new();
    for row in 0..=rows {
        for column in 0..=columns {
            let [x, y] = node(column, row);
            let spot = ground.at(x, y);
            heights.push(if spot.known { spot.height } else { f64::NAN });
        }
    }
    let known = heights.iter().filter(|height| !height.is_nan());
    let range = known.fold(
        [f64::INFINITY, f64::NEG_INFINITY],
        |[least, most], height| [least.min(*height), most.max(*height)],
    );
    if !(range[1] - range[0] > 1e-3) {
        return None;
    }
    let levels: Vec<f64> = even_ticks(range[0], range[1], MAX_CONTOURS)
        .into_iter()
        .map(|(level, _)| level)
        .collect();
    let step = levels.windows(2).map(|pair| pair[1] - pair[0]).next()?;
    let mut lines = Vec::new();
    let height = |column: u32, row: u32| heights[(row * (columns + 1) + column) as usize];
    for row in 0..rows {
        for column in 0..columns {
            // two triangles a cell: a contour crosses each once or not at all
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
                let (column, row) = (column + right, row + up);
                (node(column, row), height(column, row))
            });
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                for level in &levels {
                    lines.extend(crossing(triangle.map(|corner| corners[corner]), *level));
                }
            }
        }
    }
    Some((step, lines))
}

/// Where a contour crosses a triangle.
fn crossing(corners: [([f64; 2], f64); 3], level: f64) -> Option<[[f64; 2]; 2]> {
    let mut ends = (0..3).filter_map(|index| {
        let ((from, low), (to, high)) = (corners[index], corners[(index + 1) % 3]);
        // NaN compares false: nothing is drawn beside unknown ground
        let crosses = (low < level && high >= level) || (high < level && low >= level);
        crosses.then(|| {
            let share = (level - low) / (high - low);
            [
                from[0] + share * (to[0] - from[0]),
                from[1] + share * (to[1] - from[1]),
            ]
        })
    });
    Some([ends.next()?, ends.next()?])
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded and within a byte's range"
)]
fn byte(value: f64) -> u8 {
    value.round().clamp(0.0, 255.0) as u8
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded and within the range just given"
)]
fn side(length: f64) -> u32 {
    length.round().clamp(2.0, 2000.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contour_of_a_plane_is_straight_and_at_its_height() {
        // height = x + 2 y
        let corner = |x: f64, y: f64| ([x, y], x + 2.0 * y);
        let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)];
        let [from, to] = crossing(corners, 0.6).unwrap();
        for [x, y] in [from, to] {
            assert!((x + 2.0 * y - 0.6).abs() < 1e-12);
        }
        assert_eq!(crossing(corners, 3.5), None);
        let torn = [corners[0], corners[1], (corners[2].0, f64::NAN)];
        assert_eq!(crossing(torn, 0.6), None);
    }
}
