//! The figure of `slip-model`: slip against what is swept. Outside the contact the lines are thin.

use super::slip_model::Point;
use super::slip_model_grid::{Axes, Quantity};
use crate::error::{Error, Result};
use crate::figure::{Axis, Chart, Colour, Curve, Figure, Mark, Marker, Style};
use crate::number::rounded;

/// Draws the sweep: |S_0|, as the paper apparently shows it, or S where strength is mobilised.
pub(super) fn draw(axes: &Axes, points: &[Point], share: f64) -> Result<Figure> {
    let Some(swept) = axes.swept else {
        return Err(Error::usage(
            "there is nothing to draw: none of `--theta-deg`, `--sinkage-m` and `--radius-m` is a range",
            "give one of them as a range, such as `--theta-deg 0:40`",
        ));
    };
    let y = if share == 0.0 {
        "Slip magnitude |*S*_{0}|".to_owned()
    } else {
        format!("Slip *S* at *τ* = {} *τ*_{{max}}", rounded(share, 4))
    };
    let mut chart = Chart::new(Axis::new(title(swept)), Axis::new(y));
    for (index, run) in points.chunks(axes.run_length()).enumerate() {
        chart = add_run(chart, axes, swept, run, share, index);
    }
    let description =
        "Slip by the analytical model of Ani et al. (2012); thin lines lie outside the contact";
    Ok(Figure::new(description).panel(chart))
}

fn title(swept: Quantity) -> &'static str {
    match swept {
        Quantity::Theta => "Angle on the rim *θ* (deg)",
        Quantity::Sinkage => "Sinkage *z* (mm)",
        Quantity::Radius => "Wheel radius *r* (mm)",
    }
}

fn add_run(
    chart: Chart,
    axes: &Axes,
    swept: Quantity,
    run: &[Point],
    share: f64,
    index: usize,
) -> Chart {
    let place = |point: &Point| {
        let x = match swept {
            Quantity::Theta => point.theta_deg,
            Quantity::Sinkage => 1e3 * point.sinkage_m,
            Quantity::Radius => 1e3 * point.radius_m,
        };
        let slip = point.slip().map_or(f64::NAN, |slip| slip.driving_formula);
        [x, if share == 0.0 { slip.abs() } else { slip }]
    };
    let style = Style::numbered(index);
    let inside = |point: &Point| point.slip().is_some_and(|slip| slip.in_contact);
    // A thin line under the whole run; over it, within the contact, the line that is meant.
    let thin = Style {
        width: 0.5,
        ..style
    };
    let mut chart = chart;
    let pieces = run.chunk_by(|a, b| inside(a) == inside(b));
    let (mut start, mut labelled) = (0, false);
    for piece in pieces {
        let end = start + piece.len();
        let within = piece.first().is_some_and(inside);
        // Each piece reaches to the first point of the next, so that the line is unbroken.
        let points = run[start..run.len().min(end + 1)].iter().map(place);
        let mut curve = Curve::new(points).style(if within { style } else { thin });
        if within && !labelled {
            curve = curve.label(label(axes, run));
            labelled = true;
        }
        chart = chart.curve(curve);
        if end < run.len() {
            let entry = if within { &run[end - 1] } else { &run[end] };
            chart = chart.mark(Mark::new(place(entry)).look(Marker::Circle, style.colour));
        }
        start = end;
    }
    if labelled {
        chart
    } else {
        chart.curve(unlabelled(axes, run, &place, thin))
    }
}

/// A run that lies outside the contact as a whole still has its name.
fn unlabelled(
    axes: &Axes,
    run: &[Point],
    place: &dyn Fn(&Point) -> [f64; 2],
    style: Style,
) -> Curve {
    Curve::new(run.iter().map(place))
        .style(style)
        .label(label(axes, run))
}

/// What tells this run from the others.
fn label(axes: &Axes, run: &[Point]) -> String {
    let Some(point) = run.first() else {
        return String::new();
    };
    let parts = [
        (
            Quantity::Theta,
            format!("*θ* = {}°", rounded(point.theta_deg, 4)),
        ),
        (
            Quantity::Sinkage,
            format!("*z* = {} mm", rounded(1e3 * point.sinkage_m, 4)),
        ),
        (
            Quantity::Radius,
            format!("*r* = {} mm", rounded(1e3 * point.radius_m, 4)),
        ),
    ];
    let varies = |quantity: &Quantity| axes.varies(*quantity);
    let alone = !parts.iter().any(|(quantity, _)| varies(quantity));
    let said = parts.into_iter().filter(|(quantity, _)| {
        if alone {
            axes.swept != Some(*quantity)
        } else {
            varies(quantity)
        }
    });
    said.map(|(_, part)| part).collect::<Vec<_>>().join(", ")
}
