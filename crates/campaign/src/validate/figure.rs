//! The figure of `validate`: measured points with their errors, and what the models say between them.

use super::rows::{ModelName, Series, Validation};
use grouser_identify::wheel::Quantity;

use grouser_figure::{Axis, Chart, Colour, Curve, Dash, Figure, Marker, Measured, Points, Style};

impl Validation {
    /// Pull, side force and sinkage of the smooth wheel at three slip angles; the first column was fitted, the
    /// others are predicted.
    #[must_use]
    pub fn draw(&self) -> Figure {
        draw(self)
    }
}

fn draw(validation: &Validation) -> Figure {
    let mut figure = Figure::new(
        "Drawbar pull, side force and sinkage of a wheel on dry sand against slip at slip angles of 0, 30 \
         and 60 degrees: measured, predicted by Grouser from slip angle 0, and by plain Wong-Reece",
    )
    .columns(3);
    for (quantity, title, low, high) in [
        (Quantity::Pull, "Drawbar pull *F*_{DP} (N)", -30.0, 10.0),
        (Quantity::Side, "Side force |*F*_{y}| (N)", -5.0, 40.0),
        (Quantity::Sinkage, "Sinkage *z* (mm)", 0.0, 60.0),
    ] {
        for angle in [0.0, 30.0, 60.0] {
            let found = validation.series.iter().find(|series| {
                series.data_set == "cmu-wheel"
                    && series.wheel == "smooth"
                    && series.slip_angle_deg == angle
                    && series.quantity == quantity
            });
            if let Some(series) = found {
                figure = figure.panel(panel(series, title, (low, high)));
            }
        }
    }
    figure
}

fn panel(series: &Series, title: &str, (low, high): (f64, f64)) -> Chart {
    // The force on a wheel that drifts to its left points to the right: its magnitude is drawn.
    let sign = if series.quantity == Quantity::Side {
        -1.0
    } else {
        1.0
    };
    let axis = format!("Slip ratio *s*, *β* = {}°", series.slip_angle_deg);
    let mut chart = Chart::new(
        Axis::new(axis).range(-0.8, 0.8),
        Axis::new(title).range(low, high),
    );
    let measured = series.measured.iter().map(|point| Measured {
        at: [point.slip, sign * point.value],
        x_error: [0.0; 2],
        y_error: [point.deviation; 2],
    });
    for (model, fit, line) in &series.lines {
        let (style, name) = match (model, *fit) {
            (ModelName::Grouser, "slip angle 0") => (Style::numbered(0), "Grouser"),
            (ModelName::WongReece, _) => (Style::thin(Colour::GREY, Dash::Dashed), "Wong-Reece"),
            _ => continue,
        };
        let points = line.iter().map(|[slip, value]| [*slip, sign * value]);
        let mut curve = Curve::new(points).style(style);
        // one label each is enough: panels share their looks
        if series.quantity == Quantity::Pull && series.slip_angle_deg == 0.0 {
            curve = curve.label(name);
        }
        chart = chart.curve(curve);
    }
    let mut points = Points::new(measured).look(Marker::Circle, Colour::INK);
    if series.quantity == Quantity::Pull && series.slip_angle_deg == 0.0 {
        points = points.label("measured");
    }
    chart.points(points)
}
