//! The stress under a wheel as a figure: the wheel in the soil with the stress on its rim, and the stresses against the
//! angle.

use std::f64::consts::{FRAC_PI_2, TAU};

use grouser_terra::{OperatingPoint, WheelOnSoil};

use grouser_figure::{Area, Axis, Chart, Colour, Curve, Dash, Figure, Scene, Shape, Style, plain};
use grouser_report::number::rounded;

/// Points along the contact.
const SAMPLES: u32 = 240;
/// Arrows of normal stress.
const ARROWS: u32 = 14;
/// The longest arrow in parts of the radius.
const MAX_ARROW_RADII: f64 = 0.42;

/// Draws an operating point of `pair` on the soil that is named `soil`.
///
/// ```
/// use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};
///
/// let soil = catalogue::find("lunar").expect("in the catalogue").soil()?;
/// let pair = WheelOnSoil::new(RigidWheel::new(0.125, 0.15)?, soil, Settings::default())?;
/// let point = pair.at_sinkage(0.01, &Kinematics::straight(Slip::new(0.25)?))?;
/// let figure = grouser_campaign::stress::draw(&pair, &point, "lunar");
/// assert!(figure.svg().contains("<svg"));
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[must_use]
pub fn draw(pair: &WheelOnSoil, point: &OperatingPoint, soil: &str) -> Figure {
    let description =
        format!("Stress under a wheel on {soil}: the wheel in the soil, and the stresses");
    Figure::new(description)
        .panel(scene(pair, point, soil))
        .panel(chart(point))
}

/// Angles from exit to entry, evenly spaced.
fn angles(point: &OperatingPoint, count: u32) -> impl Iterator<Item = f64> {
    let (from, to) = (point.angles.theta_2, point.angles.theta_1);
    (0..=count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count))
}

fn chart(point: &OperatingPoint) -> Chart {
    let curve = |stress: &dyn Fn(f64) -> f64| -> Vec<[f64; 2]> {
        angles(point, SAMPLES)
            .map(|theta| [theta.to_degrees(), stress(theta) / 1e3])
            .collect()
    };
    let sigma = curve(&|theta| point.normal_stress(theta));
    let tau = curve(&|theta| point.shear_stress(theta).0);
    let tau_y = curve(&|theta| point.shear_stress(theta).1);
    let mut chart = Chart::new(
        Axis::new("Wheel angle *θ* (deg)"),
        Axis::new("Stress (kPa)"),
    )
    .area(Area::under(sigma.iter().copied()).colour(Colour::RED, 0.12))
    .area(Area::under(tau.iter().copied()).colour(Colour::BLUE, 0.14))
    .curve(Curve::new(sigma).style(normal()).label("*σ*(*θ*)"))
    .curve(Curve::new(tau).style(shear()).label("*τ*(*θ*)"));
    if point.kinematics.q_y() != 0.0 {
        let style = Style::numbered(2);
        chart = chart.curve(Curve::new(tau_y).style(style).label("*τ*_{*y*}(*θ*)"));
    }
    chart
}

fn normal() -> Style {
    Style {
        dash: Dash::Solid,
        ..Style::numbered(1)
    }
}

fn shear() -> Style {
    Style {
        dash: Dash::Dashed,
        ..Style::numbered(0)
    }
}

/// The wheel's middle stands at the origin; the ground before it at −(r − z).
fn scene(pair: &WheelOnSoil, point: &OperatingPoint, soil: &str) -> Scene {
    let radius = pair.wheel().running_radius();
    let (entry, exit) = (point.angles.theta_1, point.angles.theta_2);
    let rim = |theta: f64, outside: f64| {
        let distance = radius + outside;
        [distance * theta.sin(), -distance * theta.cos()]
    };
    let most = angles(point, SAMPLES)
        .map(|theta| point.normal_stress(theta))
        .fold(0.0, f64::max);
    let length = |stress: f64| {
        if most > 0.0 {
            MAX_ARROW_RADII * radius * stress / most
        } else {
            0.0
        }
    };

    let far = 10.0 * radius;
    // Behind the wheel the soil stands where it leaves the rim.
    let sides = if entry >= exit {
        [-far, far]
    } else {
        [far, -far]
    };
    let mut ground = vec![[sides[0], -far], [sides[0], rim(exit, 0.0)[1]]];
    ground.extend(angles(point, SAMPLES).map(|theta| rim(theta, 0.0)));
    ground.extend([[sides[1], rim(entry, 0.0)[1]], [sides[1], -far]]);

    let mut pressure: Vec<[f64; 2]> = angles(point, SAMPLES)
        .map(|theta| rim(theta, 0.0))
        .collect();
    let mut outer: Vec<[f64; 2]> = angles(point, SAMPLES)
        .map(|theta| rim(theta, length(point.normal_stress(theta))))
        .collect();
    let edge = outer.clone();
    outer.reverse();
    pressure.extend(outer);

    let thin = Style::thin(Colour::GREY, Dash::Dashed);
    let mut scene = Scene::new(
        [-2.05 * radius, -1.55 * radius],
        [1.12 * radius, 1.05 * radius],
    )
    .shape(Shape::Filled(ground, Colour::SAND, 1.0))
    .shape(Shape::Filled(pressure, Colour::RED, 0.16))
    .shape(Shape::Line(
        edge,
        Style {
            width: 0.7,
            ..normal()
        },
    ))
    .shape(Shape::Circle(
        [0.0, 0.0],
        radius,
        Style {
            width: 1.6,
            ..ink()
        },
    ));
    for theta in angles(point, ARROWS) {
        let tail = rim(theta, length(point.normal_stress(theta)));
        let arrow = Style {
            width: 0.6,
            ..normal()
        };
        scene = scene.shape(Shape::Arrow(tail, rim(theta, 0.0), arrow));
    }
    scene = scene
        .shape(Shape::Line(vec![[0.0, 0.0], rim(0.0, 0.0)], thin))
        .shape(Shape::Line(vec![[0.0, 0.0], rim(entry, 0.0)], thin))
        .shape(Shape::Line(
            arc(0.34 * radius, entry),
            Style {
                dash: Dash::Solid,
                ..thin
            },
        ))
        .shape(Shape::Disc([0.0, 0.0], 0.025 * radius, Colour::INK))
        .label(
            arc(0.34 * radius, 0.55 * entry)
                .last()
                .copied()
                .unwrap_or_default(),
            angle_label(entry),
            Colour::INK,
        );
    rolling(scene, radius, entry)
        .note(plain(soil))
        .note(format!(
            "*s* = {}",
            rounded(point.kinematics.slip().value(), 3)
        ))
        .note(format!(
            "*W* = {} N",
            rounded(point.forces.vertical_force, 3)
        ))
        .note(format!(
            "*F*_{{DP}} = {} N",
            rounded(point.forces.drawbar_pull, 3)
        ))
        .note(format!("*T* = {} N m", rounded(point.forces.torque, 3)))
        .note(format!("*z* = {} mm", rounded(1e3 * point.sinkage, 3)))
}

fn angle_label(entry: f64) -> String {
    format!("*θ*_{{1}} = {}°", rounded(entry.to_degrees(), 3))
}

/// An arrow that shows the sense of rotation.
fn rolling(scene: Scene, radius: f64, entry: f64) -> Scene {
    let sense = entry.signum();
    let at = |angle: f64| {
        let angle = FRAC_PI_2 + sense * angle;
        [0.62 * radius * angle.cos(), 0.62 * radius * angle.sin()]
    };
    let turn = TAU / 9.0;
    let points: Vec<[f64; 2]> = (0..=24)
        .map(|i| at(turn - 2.0 * turn * f64::from(i) / 26.0))
        .collect();
    let tip = at(-turn);
    let tail = points.last().copied().unwrap_or(tip);
    let style = Style {
        width: 0.9,
        ..ink()
    };
    scene
        .shape(Shape::Line(points, style))
        .shape(Shape::Arrow(tail, tip, style))
}

/// From straight down to `to`.
fn arc(radius: f64, to: f64) -> Vec<[f64; 2]> {
    let point = |i: u32| {
        let theta = to * f64::from(i) / 40.0;
        [radius * theta.sin(), -radius * theta.cos()]
    };
    (0..=40).map(point).collect()
}

fn ink() -> Style {
    Style::thin(Colour::INK, Dash::Solid)
}
