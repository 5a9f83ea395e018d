//! The front with the chosen and the present wheel.

use grouser_figure::{Axis, Chart, Colour, Curve, Figure, Mark, Marker, Points};

use super::object::Designed;

pub(super) fn draw(designed: &Designed<'_>) -> Figure {
    let front = &designed.front.points;
    let energy: Vec<[f64; 2]> = front
        .iter()
        .filter_map(|point| Some([point.wheel_mass, point.energy?]))
        .collect();
    let present = designed
        .present
        .energy
        .map(|energy| [designed.present.wheel_mass, energy]);
    let chosen = designed.chosen();
    let mut trade = Chart::new(
        Axis::new("Mass of one wheel (kg)"),
        Axis::new("Energy (J/m)"),
    )
    .curve(Curve::new(energy.clone()))
    .points(Points::new(energy).look(Marker::Circle, Colour::BLUE));
    if let Some(at) = present {
        let mark = Mark::new(at).look(Marker::Disc, Colour::INK);
        trade = trade.mark(mark.label("present wheel"));
    }
    if let Some(point) = chosen
        && let Some(energy) = point.energy
    {
        let mark = Mark::new([point.wheel_mass, energy]).look(Marker::Disc, Colour::RED);
        trade = trade.mark(mark.label("chosen"));
    }
    let at = |of: fn(&grouser_design::mission::WheelDesign) -> f64| -> Vec<[f64; 2]> {
        let points = front.iter();
        points
            .map(|point| [point.wheel_mass, of(&point.wheel)])
            .collect()
    };
    let sizes = Chart::new(Axis::new("Mass of one wheel (kg)"), Axis::new("Size (m)"))
        .curve(Curve::new(at(|wheel| wheel.radius)).label("radius"))
        .curve(
            Curve::new(at(|wheel| wheel.width))
                .style(grouser_figure::Style::numbered(1))
                .label("width"),
        );
    Figure::new(format!(
        "Energy per metre of {} against the mass of one wheel, with the chosen and the present wheel; radius and width along the front",
        designed.carrier.name()
    ))
    .panel(trade)
    .panel(sizes)
}
