//! Figures 1 to 3, drawn from the robot file: the robot from its left side and from above, and its fifth wheel.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::{Colour, Dash, Figure, Scene, Shape, Style, plain};
use grouser_report::number::{exact, rounded};
use grouser_rover::robot::{RobotModel, WheelMount};

use super::file::PaperFile;

/// Room around a drawing, as a share of its width.
const DRAWING_MARGIN_SHARE: f64 = 0.08;

/// The three figures, and the wheels' numbers.
pub(super) fn files(robot: &RobotModel) -> Vec<PaperFile> {
    let arm = |mount: &&WheelMount| mount.centre.y == 0.0;
    let whole: Vec<&WheelMount> = robot.wheels.iter().collect();
    let fifth: Vec<&WheelMount> = robot.wheels.iter().filter(arm).collect();
    let drawing = |name: &str, about: &str, scene: Scene| {
        let figure = Figure::new(format!("{about}, from the robot file")).panel(scene);
        PaperFile::figure(name, figure, format!("{}: {about}", name.replace('-', " ")))
    };
    vec![
        drawing(
            "figure-1",
            "the robot from its left side",
            side(robot, &whole),
        ),
        drawing("figure-2", "the robot from above", above(robot)),
        drawing(
            "figure-3",
            "the fifth wheel: a powered and a free wheel on one arm",
            side(robot, &fifth),
        ),
        PaperFile::text("robot.csv", csv(robot), "the wheels of figures 1 to 3"),
    ]
}

/// Between two lines of text below the wheels, as a share of the drawing's width.
const LINE_SPACING_SHARE: f64 = 0.04;

/// From the outline of a wheel to the middle of its name, as a share of the drawing's width.
const NAME_GAP_SHARE: f64 = 0.028;

/// The least and the largest of numbers.
fn span(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Wheels with the links that carry them, forwards to the right.
fn side(robot: &RobotModel, wheels: &[&WheelMount]) -> Scene {
    let reach = |sign: f64| {
        let ends = wheels
            .iter()
            .map(move |mount| mount.centre.x + sign * mount.wheel.radius());
        span(ends)
    };
    let (back, front) = (reach(-1.0)[0], reach(1.0)[1]);
    let pivots = wheels
        .iter()
        .filter_map(|mount| Some(robot.linkage.links()[mount.link?].pivot.z));
    let rims = wheels
        .iter()
        .map(|mount| mount.centre.z + mount.wheel.radius());
    let top = span(pivots.chain(rims))[1];
    let margin = DRAWING_MARGIN_SHARE * (front - back);
    let mut scene = Scene::new(
        [back - margin, -2.5 * margin],
        [front + margin, top + margin],
    );
    scene = scene.shape(Shape::Filled(
        vec![[-9.0, 0.0], [9.0, 0.0], [9.0, -9.0], [-9.0, -9.0]],
        Colour::SAND,
        1.0,
    ));
    let left = wheels.iter().filter(|mount| mount.centre.y >= 0.0);
    for (row, mount) in left.enumerate() {
        let (at, radius) = ([mount.centre.x, mount.centre.z], mount.wheel.radius());
        let powered = mount.motor.is_some();
        let style = if powered {
            stroke(Colour::INK, 1.4)
        } else {
            Style {
                width: 1.4,
                ..Style::numbered(0)
            }
        };
        scene = scene.shape(Shape::Circle(at, radius, style));
        let mut link = mount.link;
        let mut end = at;
        while let Some(index) = link {
            let part = &robot.linkage.links()[index];
            let pivot = [part.pivot.x, part.pivot.z];
            scene = scene
                .shape(Shape::Line(vec![end, pivot], stroke(Colour::INK, 2.0)))
                .shape(Shape::Disc(pivot, 0.08 * radius, Colour::RED));
            end = pivot;
            link = part.on;
        }
        let words = format!(
            "{}, *r* {} mm",
            plain(&mount.name),
            rounded(1e3 * radius, 4)
        );
        let below = [
            at[0],
            -(0.6 + row as f64) * LINE_SPACING_SHARE * (front - back),
        ];
        scene = scene
            .shape(Shape::Disc(at, 0.06 * radius, style.colour))
            .shape(Shape::Text(below, words, style.colour));
    }
    scene
}

/// The robot from above, forwards to the right.
fn above(robot: &RobotModel) -> Scene {
    let x =
        span(robot.wheels.iter().flat_map(|mount| {
            [-1.0, 1.0].map(|sign| mount.centre.x + sign * mount.wheel.radius())
        }));
    let y = span(robot.wheels.iter().flat_map(|mount| {
        [-1.0, 1.0].map(|sign| mount.centre.y + sign * mount.wheel.width() / 2.0)
    }));
    let margin = DRAWING_MARGIN_SHARE * (x[1] - x[0]);
    let mut scene = Scene::new(
        [x[0] - margin, y[0] - margin],
        [x[1] + margin, y[1] + margin],
    );
    for mount in &robot.wheels {
        let (radius, half) = (mount.wheel.radius(), mount.wheel.width() / 2.0);
        let at = mount.centre;
        if let Some(link) = mount.link {
            let pivot = robot.linkage.links()[link].pivot;
            let arm = vec![[at.x, at.y], [pivot.x, pivot.y]];
            scene = scene.shape(Shape::Line(arm, stroke(Colour::INK, 1.2)));
        }
        let outline = corners([at.x, at.y], [radius, half]);
        let colour = if mount.motor.is_some() {
            Colour::GREY
        } else {
            Colour::BLUE
        };
        // below a powered wheel and above a free one, which may overlap on an arm
        let side = if mount.motor.is_some() { -1.0 } else { 1.0 };
        let name_at = [at.x, at.y + side * (half + NAME_GAP_SHARE * (x[1] - x[0]))];
        scene = scene
            .shape(Shape::Filled(outline.clone(), colour, 0.35))
            .shape(Shape::Line(outline, stroke(Colour::INK, 0.8)))
            .shape(Shape::Text(name_at, plain(&mount.name), Colour::INK));
    }
    let corners = || robot.wheels.iter().filter(|mount| mount.centre.y != 0.0);
    let length = |[low, high]: [f64; 2]| rounded(1e3 * (high - low), 4);
    scene
        .note(format!(
            "wheelbase {} mm",
            length(span(corners().map(|mount| mount.centre.x)))
        ))
        .note(format!(
            "stance {} mm",
            length(span(corners().map(|mount| mount.centre.y)))
        ))
        .note(format!("weight {} N", rounded(robot.weight(), 3)))
}

fn csv(robot: &RobotModel) -> String {
    let mut text = String::from("wheel,x_m,y_m,z_m,radius_m,width_m,powered,carried_by\n");
    for mount in &robot.wheels {
        let numbers = [
            mount.centre.x,
            mount.centre.y,
            mount.centre.z,
            mount.wheel.radius(),
            mount.wheel.width(),
        ];
        let carrier = mount
            .link
            .map_or("chassis", |link| robot.links[link].as_str());
        let _ = writeln!(
            text,
            "{},{},{},{carrier}",
            mount.name,
            numbers.map(exact).join(","),
            mount.motor.is_some()
        );
    }
    text
}

/// A solid line of `width`.
fn stroke(colour: Colour, width: f64) -> Style {
    Style {
        width,
        ..Style::thin(colour, Dash::Solid)
    }
}

/// The closed outline of a box about its centre; `half` is half its size.
fn corners([x, y]: [f64; 2], half: [f64; 2]) -> Vec<[f64; 2]> {
    let [a, b] = half;
    [[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]]
        .map(|[i, j]| [x + i, y + j])
        .into()
}
