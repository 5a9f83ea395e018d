//! The figure of a range of slip: drawbar pull, torque, sinkage and efficiency against slip.

use grouser_terra::{OperatingPoint, Prescribed};

use super::Family;
use grouser_figure::{Axis, Chart, Colour, Curve, Figure, Mark, Marker, Style};
use grouser_report::number::rounded;

/// A quantity of an operating point.
type Quantity = fn(&OperatingPoint) -> Option<f64>;

/// Draws the curves.
pub(super) fn draw(soil: &str, families: &[Family]) -> Figure {
    let pull = panel("Drawbar pull *F*_{DP} (N)", families, |point| {
        Some(point.forces.drawbar_pull)
    });
    let torque = panel("Torque *T* (N m)", families, |point| {
        Some(point.forces.torque)
    });
    let by_sinkage = families
        .iter()
        .any(|family| matches!(family.prescribed, Prescribed::Sinkage(_)));
    let third = if by_sinkage {
        panel("Vertical force *W* (N)", families, |point| {
            Some(point.forces.vertical_force)
        })
    } else {
        panel("Sinkage *z* (mm)", families, |point| {
            Some(1e3 * point.sinkage)
        })
    };
    let mut efficiency = panel("Tractive efficiency *η* (%)", families, |point| {
        point.tractive_efficiency().map(|share| 100.0 * share)
    });
    for best in families.iter().filter_map(|family| family.most_efficient) {
        let at = [best.slip.value(), 100.0 * best.value];
        if at[0] >= range(families)[0] && at[0] <= range(families)[1] {
            efficiency = efficiency.mark(Mark::new(at).look(Marker::Disc, Colour::INK));
        }
    }
    Figure::new(format!(
        "Drawbar pull, torque, sinkage and efficiency of a wheel on {soil} against slip"
    ))
    .panel(pull)
    .panel(torque)
    .panel(third)
    .panel(efficiency)
}

fn panel(title: &str, families: &[Family], quantity: Quantity) -> Chart {
    let [low, high] = axis(families);
    let mut chart = Chart::new(
        Axis::new("Slip ratio *s*").range(low, high),
        Axis::new(title),
    );
    for (index, family) in families.iter().enumerate() {
        let points = family.points.iter().map(|(slip, answer)| {
            let value = answer.point().as_ref().and_then(quantity);
            [*slip, value.unwrap_or(f64::NAN)]
        });
        let label = match family.prescribed {
            Prescribed::Load(load) => format!("*W* = {} N", rounded(load, 4)),
            Prescribed::Sinkage(sinkage) => format!("*z* = {} mm", rounded(1e3 * sinkage, 4)),
        };
        chart = chart.curve(
            Curve::new(points)
                .style(Style::numbered(index))
                .label(label),
        );
    }
    chart
}

/// One slip axis for all panels, so that they compare: out to the next fifth.
fn axis(families: &[Family]) -> [f64; 2] {
    let [low, high] = range(families);
    // a fifth that the ends meet but for rounding is theirs
    let (low, high) = (
        (5.0 * low + 1e-9).floor() / 5.0,
        (5.0 * high - 1e-9).ceil() / 5.0,
    );
    [low, high.max(low + 0.2)]
}

fn range(families: &[Family]) -> [f64; 2] {
    let slips = || {
        families
            .iter()
            .flat_map(|family| &family.points)
            .map(|(slip, _)| *slip)
    };
    [
        slips().fold(f64::INFINITY, f64::min),
        slips().fold(f64::NEG_INFINITY, f64::max),
    ]
}
