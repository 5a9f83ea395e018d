//! Figure 11: the flow chart from slip to decision, with how often a run went each way.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::{Colour, Figure, Scene, Shape};
use grouser_report::number::{exact, rounded};
use grouser_rover::drive::NamedDecision;
use grouser_slip::control::Action;

use super::drawing::{corners, framed, stroke};

/// Half the size of a box, in units of the drawing.
const HALF_BOX: [f64; 2] = [1.95, 0.42];

/// The chart. `optimum` is the controller's slip setpoint.
pub(super) fn draw(decisions: &[NamedDecision], optimum: f64, outcome: &str) -> Figure {
    let count = |of: &[Action]| {
        let times = decisions
            .iter()
            .filter(|one| of.contains(&one.decision.action))
            .count();
        format!("{times} ×")
    };
    let reduced = count(&[Action::ReduceTorque, Action::ShedTorque]);
    let raised = count(&[Action::RaiseTorque, Action::AcceptSlip]);
    let turned = count(&[
        Action::Traverse,
        Action::SwitchSide,
        Action::BackOut,
        Action::Detour,
    ]);
    let mut scene = Scene::new([-6.6, -5.4], [6.6, 2.9]);
    let boxes: [([f64; 2], [&str; 2], Colour); 7] = [
        (
            [0.0, 2.2],
            ["encoders: powered", "and free wheel"],
            Colour::INK,
        ),
        ([0.0, 0.7], ["slip *s* of each", "wheel"], Colour::INK),
        (
            [0.0, -0.8],
            ["compare with the", "optimum *s*_{opt}"],
            Colour::INK,
        ),
        (
            [-4.6, -2.7],
            ["*s* > *s*_{opt}:", "reduce torque"],
            Colour::BLUE,
        ),
        ([0.0, -2.7], ["*s* is back:", "raise torque"], Colour::GREEN),
        (
            [4.6, -2.7],
            ["wheels dig in:", "change direction"],
            Colour::RED,
        ),
        (
            [0.0, -4.7],
            ["way driven, or", "no way on: end"],
            Colour::INK,
        ),
    ];
    for (at, lines, colour) in boxes {
        scene = scene.shape(Shape::Filled(corners(at, HALF_BOX), colour, 0.06));
        scene = framed(scene, at, HALF_BOX, colour);
        for (line, rise) in lines.into_iter().zip([0.17, -0.19]) {
            scene = scene.shape(Shape::Text(
                [at[0], at[1] + rise],
                line.to_owned(),
                Colour::INK,
            ));
        }
    }
    for (from, to) in [
        ([0.0, 1.78], [0.0, 1.12]),
        ([0.0, 0.28], [0.0, -0.38]),
        ([-1.95, -0.8], [-4.6, -2.28]),
        ([0.0, -1.22], [0.0, -2.28]),
        ([1.95, -0.8], [4.6, -2.28]),
        ([-4.6, -3.12], [-1.95, -4.7]),
        ([0.0, -3.12], [0.0, -4.28]),
        ([4.6, -3.12], [1.95, -4.7]),
    ] {
        scene = scene.shape(Shape::Arrow(from, to, stroke(Colour::INK, 0.8)));
    }
    for (at, times, colour) in [
        ([-3.6, -1.35], reduced, Colour::BLUE),
        ([0.55, -1.75], raised, Colour::GREEN),
        ([3.6, -1.35], turned, Colour::RED),
        ([3.3, -5.0], outcome.to_owned(), Colour::INK),
    ] {
        scene = scene.shape(Shape::Text(at, times, colour));
    }
    scene = scene.note(format!("*s*_{{opt}} = {}", rounded(optimum, 3)));
    Figure::new("From slip to decision, with how often the simulated run went each way")
        .panel(scene)
}

/// The run's decisions in order.
pub(super) fn csv(decisions: &[NamedDecision], wheels: &[String]) -> String {
    let mut text = String::from("time_s,action,reason,wheel,value,limit\n");
    for NamedDecision { time, decision, .. } in decisions {
        let wheel = decision.wheel.and_then(|wheel| wheels.get(wheel));
        let _ = writeln!(
            text,
            "{},{},{},{},{},{}",
            rounded(*time, 2),
            decision.action.name(),
            // no reason holds a quote
            format_args!("\"{}\"", decision.reason.name()),
            wheel.map_or("", String::as_str),
            exact(decision.value),
            exact(decision.limit)
        );
    }
    text
}
