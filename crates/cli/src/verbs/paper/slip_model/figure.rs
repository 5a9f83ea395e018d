//! The figure of the slip model: slip against what is swept. Outside the contact the lines are thin.

use super::grid::{Axes, Quantity};
use super::point::Point;
use crate::error::{Error, Result};
use grouser_figure::{Axis, Chart, Curve, Figure, Mark, Marker, Style};
use grouser_report::number::rounded;

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
        Quantity::Theta => "Angle on the wheel *θ* (deg)",
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
    // Outside the contact the line is thin.
    let thin = Style {
        width: 0.5,
        ..style
    };
    let mut chart = chart;
    let mut start = 0;
    let last = run.iter().rposition(|point| point.slip().is_some());
    let touches = run.iter().any(|point| contact(point) == Some(true));
    for piece in run.chunk_by(|a, b| contact(a) == contact(b)) {
        let end = start + piece.len();
        let Some(within) = piece.first().and_then(contact) else {
            start = end;
            continue;
        };
        // Each piece reaches to the first point of the next, so that the line is unbroken.
        let points = run[start..run.len().min(end + 1)].iter().map(place);
        let mut curve = Curve::new(points).style(if within { style } else { thin });
        if last == Some(end - 1) {
            curve = curve.label(label(axes, run, touches));
        }
        if let Some(next) = run.get(end)
            && contact(next) == Some(!within)
        {
            let entry = if within { &run[end - 1] } else { next };
            let mark = Mark::new(place(entry)).look(Marker::Circle, style.colour);
            let first = index == 0 && start == 0;
            chart = chart.mark(if first {
                mark.label("*θ* = *θ*_{1}")
            } else {
                mark
            });
        }
        chart = chart.curve(curve);
        start = end;
    }
    chart
}

/// Does the point lie in the contact? `None` where the model has no slip.
fn contact(point: &Point) -> Option<bool> {
    point.slip().map(|slip| slip.in_contact)
}

/// What distinguishes this run from the others.
fn label(axes: &Axes, run: &[Point], touches: bool) -> String {
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
    let mut said: Vec<String> = said.map(|(_, part)| part).collect();
    if !touches {
        said.push("outside the contact".to_owned());
    }
    said.join(", ")
}
