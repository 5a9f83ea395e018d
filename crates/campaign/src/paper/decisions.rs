//! Figure 11: from slip to decision, with the limits that the controller has by default.

use grouser_figure::{Colour, Dash, Figure, Scene, Shape, Style};
use grouser_report::number::rounded;
use grouser_slip::control::ControlSettings;

/// Size of the drawing; its unit is about a point.
const SIZE: [f64; 2] = [288.0, 216.0];
/// From one row to the next.
const ROW: f64 = 36.0;
/// Half the height of a box.
const HALF: f64 = 13.0;
/// Left and right edges of the conditions and of the actions.
const CONDITION: [f64; 2] = [2.0, 178.0];
const ACTION: [f64; 2] = [204.0, 286.0];

/// Conditions from the first that is tested to the last, each with its action: two lines a box.
fn rows(s: &ControlSettings) -> [[[String; 2]; 2]; 6] {
    let number = |value: f64| rounded(value, 3);
    let degrees = |angle: f64| rounded(angle.to_degrees(), 2);
    let row = |a: String, b: String, action: [&str; 2]| [[a, b], action.map(str::to_owned)];
    [
        row(
            format!("slip or speed unknown for {} s,", number(s.blind_time)),
            format!("or tilt above {}°", degrees(s.max_tilt)),
            ["end: sensors,", "tilt"],
        ),
        row(
            format!(
                "*s* > {} for {} s, no progress for 2 s,",
                number(s.dig_slip),
                number(s.dig_time)
            ),
            "or softer ground than the known soil".to_owned(),
            ["back out,", "change direction"],
        ),
        row(
            format!(
                "more than {} attempts within {} m,",
                s.max_attempts,
                number(s.progress)
            ),
            "or no motion backwards for 10 s".to_owned(),
            ["end: no route left,", "immobilised"],
        ),
        row(
            "*s* > *s*_{opt}, steady: slope and soil demand it,".to_owned(),
            "and a slower wheel does not lower it".to_owned(),
            ["accept slip:", "raise torque"],
        ),
        row(
            "*s* > *s*_{opt} otherwise".to_owned(),
            String::new(),
            ["reduce torque", ""],
        ),
        row(
            "*s* at or below *s*_{opt}".to_owned(),
            String::new(),
            ["raise torque", ""],
        ),
    ]
}

/// The figure.
pub(super) fn figure() -> Figure {
    let stroke = Style {
        width: 0.8,
        ..Style::thin(Colour::INK, Dash::Solid)
    };
    let mut scene = Scene::new([0.0, 0.0], SIZE);
    let rows = rows(&ControlSettings::default());
    for (index, row) in rows.iter().enumerate() {
        let y = SIZE[1] - HALF - 5.0 - ROW * index as f64;
        for ([left, right], lines) in [CONDITION, ACTION].into_iter().zip(row) {
            let outline = vec![
                [left, y - HALF],
                [right, y - HALF],
                [right, y + HALF],
                [left, y + HALF],
                [left, y - HALF],
            ];
            scene = scene.shape(Shape::Line(outline, stroke));
            let middle = f64::midpoint(left, right);
            let shown = lines.iter().filter(|line| !line.is_empty());
            let lift = if shown.clone().count() > 1 { 5.6 } else { 0.0 };
            for (line, offset) in shown.zip([lift, -lift]) {
                let at = [middle, y + offset];
                scene = scene.shape(Shape::Text(at, line.clone(), Colour::INK));
            }
        }
        scene = scene.shape(Shape::Arrow([CONDITION[1], y], [ACTION[0], y], stroke));
        let yes = [f64::midpoint(CONDITION[1], ACTION[0]), y + 6.0];
        scene = scene.shape(Shape::Text(yes, "yes".to_owned(), Colour::GREY));
        if index + 1 < rows.len() {
            let x = f64::midpoint(CONDITION[0], CONDITION[1]);
            scene = scene.shape(Shape::Arrow([x, y - HALF], [x, y - ROW + HALF], stroke));
        }
    }
    Figure::new("Figure 11: from the slip of each wheel to the decision, tested from top to bottom")
        .panel(scene)
}
