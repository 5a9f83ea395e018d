//! The figure of `identify`: tests beside the fitted laws, and the residuals below.

use grouser_identify::wheel::Quantity;
use grouser_identify::{Identification, PlateStage, ShearStage, WheelStage};

use grouser_figure::{
    Axis, Chart, Colour, Curve, Dash, Figure, Marker, Points, Rule, Style, plain,
};

/// Panels of every stage.
pub(super) fn draw(found: &Identification) -> Figure {
    let mut figure = Figure::new("Tests of a soil, the fitted laws and their residuals");
    if let Some(stage) = &found.plates {
        figure = figure
            .panel(pressure(stage))
            .panel(pressure_residuals(stage));
    }
    if let Some(stage) = &found.shear {
        figure = figure.panel(shear(stage)).panel(shear_residuals(stage));
    }
    if let Some(stage) = &found.wheel {
        for quantity in Quantity::ALL {
            if stage.tests.iter().any(|test| test.read(quantity).is_some()) {
                figure = figure
                    .panel(wheel(stage, quantity))
                    .panel(wheel_residuals(stage, quantity));
            }
        }
    }
    figure
}

/// At most this many points of a test are drawn.
const DRAWN: usize = 60;

fn pressure(stage: &PlateStage) -> Chart {
    let mut chart = Chart::new(Axis::new("Depth *z* (mm)"), Axis::new("Pressure *p* (kPa)"));
    for (index, test) in stage.tests.iter().enumerate() {
        let style = Style::numbered(index);
        let step = (test.depth.len() / DRAWN).max(1);
        let points = (0..test.depth.len())
            .step_by(step)
            .map(|i| [1e3 * test.depth[i], 1e-3 * test.pressure(i)]);
        let deepest = test.depth.iter().copied().fold(0.0, f64::max);
        let modulus = stage.fit.k_c / test.plate.width + stage.fit.k_phi;
        let line = (0..=80).map(|i| {
            let z = deepest * f64::from(i) / 80.0;
            [1e3 * z, 1e-3 * modulus * z.powf(stage.fit.n)]
        });
        chart = chart
            .points(Points::new(points).look(Marker::Circle, style.colour))
            .curve(Curve::new(line).style(style).label(plain(&test.name)));
    }
    chart
}

fn pressure_residuals(stage: &PlateStage) -> Chart {
    let mut chart = Chart::new(
        Axis::new("Depth *z* (mm)"),
        Axis::new("Measured over law, ln (%)"),
    )
    .rule(Rule::at_y(0.0));
    for (index, (test, residuals)) in stage.tests.iter().zip(&stage.fit.residuals).enumerate() {
        let step = (residuals.len() / DRAWN).max(1);
        let points = residuals
            .iter()
            .step_by(step)
            .map(|(i, r)| [1e3 * test.depth[*i], 100.0 * r]);
        let colour = Style::numbered(index).colour;
        chart = chart.points(Points::new(points).look(Marker::Circle, colour));
    }
    chart
}

fn shear(stage: &ShearStage) -> Chart {
    let mut chart = Chart::new(
        Axis::new("Displacement *j* (mm)"),
        Axis::new("Shear stress *τ* (kPa)"),
    );
    let [cohesion, phi, k_shear] = stage.fit.values;
    for (index, normal) in normals(stage).into_iter().enumerate() {
        let style = Style::numbered(index);
        let of: Vec<_> = stage
            .readings
            .iter()
            .filter(|reading| reading.normal == normal)
            .collect();
        let reach = of.iter().map(|r| r.displacement).fold(0.0, f64::max);
        let points = of.iter().map(|r| [1e3 * r.displacement, 1e-3 * r.shear]);
        let line = (0..=80).map(|i| {
            let j = reach * f64::from(i) / 80.0;
            let shown = 1.0 - (-j / k_shear).exp();
            [1e3 * j, 1e-3 * (cohesion + normal * phi.tan()) * shown]
        });
        chart = chart
            .points(Points::new(points).look(Marker::Circle, style.colour))
            .curve(Curve::new(line).style(style).label(format!(
                "*σ* = {} kPa",
                grouser_report::number::rounded(1e-3 * normal, 3)
            )));
    }
    chart
}

fn shear_residuals(stage: &ShearStage) -> Chart {
    let mut chart = Chart::new(
        Axis::new("Displacement *j* (mm)"),
        Axis::new("Measured − law (kPa)"),
    )
    .rule(Rule::at_y(0.0));
    for (index, normal) in normals(stage).into_iter().enumerate() {
        let points = stage
            .readings
            .iter()
            .zip(&stage.fit.fit.residuals)
            .filter(|(reading, _)| reading.normal == normal)
            .map(|(reading, r)| [1e3 * reading.displacement, -1e-3 * r]);
        let colour = Style::numbered(index).colour;
        chart = chart.points(Points::new(points).look(Marker::Circle, colour));
    }
    chart
}

/// The normal stresses in their order.
fn normals(stage: &ShearStage) -> Vec<f64> {
    let mut list = Vec::new();
    for reading in &stage.readings {
        if !list.contains(&reading.normal) {
            list.push(reading.normal);
        }
    }
    list
}

fn title(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pull => "Drawbar pull *F*_{DP} (N)",
        Quantity::Side => "Side force *F*_{y} (N)",
        Quantity::Torque => "Torque *T* (N m)",
        Quantity::Sinkage => "Sinkage *z* (mm)",
    }
}

fn wheel(stage: &WheelStage, quantity: Quantity) -> Chart {
    let unit = quantity.scale();
    let slip = |index: usize| stage.tests[index].kinematics.slip().value();
    let read = (0..stage.tests.len())
        .filter_map(|i| Some([slip(i), stage.tests[i].read(quantity)? / unit]));
    let said = (0..stage.tests.len())
        .filter(|i| stage.tests[*i].read(quantity).is_some())
        .map(|i| [slip(i), stage.said[i].of(quantity) / unit]);
    Chart::new(Axis::new("Slip ratio *s*"), Axis::new(title(quantity)))
        .points(Points::new(read).look(Marker::Circle, Colour::INK))
        .points(Points::new(said).look(Marker::Disc, Style::numbered(0).colour))
        .rule(Rule::at_y(0.0).style(Style::thin(Colour::GREY, Dash::Dotted)))
}

fn wheel_residuals(stage: &WheelStage, quantity: Quantity) -> Chart {
    let unit = quantity.scale();
    let points = stage
        .tests
        .iter()
        .zip(&stage.said)
        .filter_map(|(test, said)| {
            let off = test.read(quantity)? - said.of(quantity);
            Some([test.kinematics.slip().value(), off / unit])
        });
    Chart::new(
        Axis::new("Slip ratio *s*"),
        Axis::new(format!("Measured − model ({})", quantity.unit())),
    )
    .points(Points::new(points).look(Marker::Circle, Colour::INK))
    .rule(Rule::at_y(0.0))
}
