//! Figures 5 to 7: the three classes of parameters and the stress under a wheel that joins them, for one wheel of the robot.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::{Colour, Figure, Scene, Shape};
use grouser_report::number::{exact, rounded};
use grouser_terra::{OperatingPoint, Pressure, WheelOnSoil};

use super::drawing::{framed, stroke};
use super::file::PaperFile;
use crate::stress;

/// Rows of the table of stresses.
const ROWS: u32 = 200;

/// Figure 5, and figures 6 and 7 together, with their numbers.
pub(super) fn files(pair: &WheelOnSoil, point: &OperatingPoint, soil: &str) -> Vec<PaperFile> {
    let classes = classes(pair, point);
    vec![
        PaperFile::figure(
            "figure-5",
            draw(&classes),
            "figure 5: the three classes of parameters, with the numbers of one wheel of the run on sand",
        ),
        PaperFile::text("figure-5.csv", csv(&classes), "the numbers of figure 5"),
        PaperFile::figure(
            "figure-6-7",
            stress::draw(pair, point, soil),
            "figures 6 and 7: the stress on the rim, by (P1) to (P3)",
        ),
        PaperFile::text(
            "figure-6-7.csv",
            stresses(point),
            "the numbers of figures 6 and 7",
        ),
    ]
}

/// A class of parameters: its name, and each parameter's symbol, value and unit.
type Class = (&'static str, Vec<(&'static str, f64, &'static str)>);

fn classes(pair: &WheelOnSoil, point: &OperatingPoint) -> [Class; 3] {
    let soil = pair.soil().params();
    let mut strength = vec![
        ("*c*", 1e-3 * soil.cohesion, "kPa"),
        ("*φ*", soil.phi.deg(), "°"),
        ("*K*", 1e3 * soil.k_shear, "mm"),
        ("*n*", soil.n, ""),
    ];
    if let Pressure::Bekker(bekker) = soil.pressure {
        strength.push(("*k*_{c}", 1e-3 * bekker.k_c, "kN/m^{n+1}"));
        strength.push(("*k*_{φ}", 1e-3 * bekker.k_phi, "kN/m^{n+2}"));
    }
    let angles = [
        point.angles.theta_1,
        point.angles.theta_m,
        point.angles.theta_2,
    ]
    .map(f64::to_degrees);
    [
        (
            "wheel",
            vec![
                ("*r*", 1e3 * pair.wheel().radius(), "mm"),
                ("*b*", 1e3 * pair.wheel().width(), "mm"),
                ("*W*", point.forces.vertical_force, "N"),
            ],
        ),
        ("soil", strength),
        (
            "interface",
            vec![
                ("*s*", point.kinematics.slip().value(), ""),
                ("*z*", 1e3 * point.sinkage, "mm"),
                ("*θ*_{1}", angles[0], "°"),
                ("*θ*_{m}", angles[1], "°"),
                ("*θ*_{2}", angles[2], "°"),
            ],
        ),
    ]
}

fn draw(classes: &[Class; 3]) -> Figure {
    let mut scene = Scene::new([-7.0, -4.6], [7.0, 2.6]);
    let ink = stroke(Colour::INK, 1.0);
    for ((name, parameters), x) in classes.iter().zip([-4.7, 0.0, 4.7]) {
        scene = framed(scene, [x, 0.75], [2.2, 1.75], Colour::INK);
        scene = scene.shape(Shape::Text([x, 2.2], (*name).to_owned(), Colour::RED));
        for (row, (symbol, value, unit)) in parameters.iter().enumerate() {
            let words = format!("{symbol} = {} {unit}", rounded(*value, 4));
            let y = 1.75 - 0.42 * row as f64;
            scene = scene.shape(Shape::Text([x, y], words, Colour::INK));
        }
        scene = scene.shape(Shape::Arrow([x, -1.0], [0.4 * x, -2.2], ink));
    }
    scene = framed(scene, [0.0, -2.7], [4.0, 0.5], Colour::INK);
    scene = scene
        .shape(Shape::Text(
            [0.0, -2.7],
            "stress on the rim: *σ*(*θ*), *τ*(*θ*) by (P1) to (P3)".to_owned(),
            Colour::INK,
        ))
        .shape(Shape::Arrow([0.0, -3.2], [0.0, -3.8], ink))
        .shape(Shape::Text(
            [0.0, -4.1],
            "drawbar pull, torque, sinkage, slip".to_owned(),
            Colour::INK,
        ));
    Figure::new("Three classes of parameters and the stress model that joins them").panel(scene)
}

fn csv(classes: &[Class; 3]) -> String {
    let mut text = String::from("class,parameter,value,unit\n");
    let plain = |markup: &str| markup.replace(['*', '_', '^', '{', '}'], "");
    for (name, parameters) in classes {
        for (symbol, value, unit) in parameters {
            let _ = writeln!(
                text,
                "{name},{},{},{}",
                plain(symbol),
                exact(*value),
                plain(unit)
            );
        }
    }
    text
}

fn stresses(point: &OperatingPoint) -> String {
    let mut text = String::from("theta_deg,sigma_pa,tau_pa\n");
    let (from, to) = (point.angles.theta_2, point.angles.theta_1);
    for row in 0..=ROWS {
        let theta = from + (to - from) * f64::from(row) / f64::from(ROWS);
        let numbers = [
            theta.to_degrees(),
            point.normal_stress(theta),
            point.shear_stress(theta).0,
        ];
        let _ = writeln!(text, "{}", numbers.map(exact).join(","));
    }
    text
}
