//! The charts of a drive's report: one panel each, so that a page can set them side by side or in one column.

use grouser_rover::drive::Scenario;

use super::run::Run;
use super::track::Track;
use grouser_figure::{Area, Axis, Chart, Colour, Curve, Dash, Figure, Style};

/// How true and estimated values look; the page's key says it in words.
pub(super) const TRUE: Style = Style {
    colour: Colour::RED,
    dash: Dash::Solid,
    width: 1.5,
};
pub(super) const SEEN: Style = Style {
    colour: Colour::BLUE,
    dash: Dash::Dashed,
    width: 1.0,
};
/// The requested value.
pub(super) const REQUESTED: Style = Style {
    colour: Colour::GREY,
    dash: Dash::Dotted,
    width: 1.2,
};
const TORQUE: Style = Style {
    colour: Colour::SLATE,
    dash: Dash::Solid,
    width: 1.1,
};

fn figure(about: String, chart: Chart) -> Figure {
    Figure::new(about).columns(1).panel(chart)
}

fn over_time(track: &Track, title: &str, range: [f64; 2]) -> Chart {
    Chart::new(
        Axis::new("Time (s)").range(0.0, track.end()),
        Axis::new(title).range(range[0], range[1]),
    )
}

/// Slip of a wheel, true and estimated with one standard deviation.
pub(super) fn slip(track: &Track, wheel: usize, name: &str) -> Figure {
    let mut chart = over_time(track, "Slip ratio *s*", [-1.0, 1.0]);
    let bands = track.bands(|point| {
        let at = point.wheels.get(wheel)?;
        let (slip, sigma) = (at.seen?, at.sigma?);
        Some([(slip - sigma).max(-1.0), (slip + sigma).min(1.0)])
    });
    for [lower, upper] in bands {
        chart = chart.area(Area::between(lower, upper).colour(SEEN.colour, 0.16));
    }
    let truth = track.line(|point| point.wheels.get(wheel)?.slip);
    let seen = track.line(|point| point.wheels.get(wheel)?.seen);
    chart = chart
        .curve(Curve::new(truth).style(TRUE))
        .curve(Curve::new(seen).style(SEEN));
    figure(
        format!("Slip of {name} against time: true and estimated"),
        chart,
    )
}

/// Torque of a wheel's motor; all to one scale.
pub(super) fn torque(track: &Track, wheel: usize, name: &str) -> Figure {
    let all = track.points.iter().flat_map(|point| &point.wheels);
    let range = spread(all.map(|wheel| wheel.torque), 0.1);
    let line = track.line(|point| Some(point.wheels.get(wheel)?.torque));
    let chart = over_time(track, "Torque *T* (N m)", range).curve(Curve::new(line).style(TORQUE));
    figure(format!("Torque of the motor of {name} against time"), chart)
}

/// Speed of the robot: requested, true, estimated.
pub(super) fn speed(track: &Track) -> Figure {
    let all = track.points.iter();
    let all = all.flat_map(|p| [Some(p.speed), p.speed_seen, Some(p.requested_speed)]);
    let range = spread(all.flatten(), 0.02);
    let chart = over_time(track, "Forward speed *v* (m/s)", range)
        .curve(Curve::new(track.line(|p| Some(p.requested_speed))).style(REQUESTED))
        .curve(Curve::new(track.line(|p| Some(p.speed))).style(TRUE))
        .curve(Curve::new(track.line(|p| p.speed_seen)).style(SEEN));
    figure(
        "Forward speed against time: requested, true and estimated".to_owned(),
        chart,
    )
}

/// Electrical energy against time.
pub(super) fn energy(track: &Track) -> Figure {
    let range = spread(track.points.iter().map(|point| point.energy), 1.0);
    let chart = over_time(track, "Electrical energy *E* (J)", range)
        .curve(Curve::new(track.line(|point| Some(point.energy))).style(Style::numbered(0)));
    figure("Electrical energy against time".to_owned(), chart)
}

/// Electrical energy against progress, of every driver.
pub(super) fn compared(scenario: &Scenario, runs: &[Run]) -> Figure {
    let tracks = || {
        let runs = runs.iter();
        runs.filter_map(|run| Some((run, run.track.as_ref()?)))
    };
    let all = tracks().flat_map(|(_, track)| &track.points);
    let [low, high] = spread(all.map(|point| point.distance), 0.1);
    let mut chart = Chart::new(
        Axis::new("Progress along the way (m)").range(low, high),
        Axis::new("Electrical energy *E* (J)"),
    );
    for (index, (run, track)) in tracks().enumerate() {
        let line = track
            .points
            .iter()
            .map(|point| [point.distance, point.energy]);
        let curve = Curve::new(line)
            .style(Style::numbered(index))
            .label(run.pilot.name());
        chart = chart.curve(curve);
    }
    let about = format!("Electrical energy against progress, {}", scenario.name);
    figure(about, chart)
}

/// From the least to the greatest value and zero, at least `least` on one side, with a margin.
fn spread(values: impl Iterator<Item = f64>, least: f64) -> [f64; 2] {
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([0.0, least], |[low, high]: [f64; 2], value| {
            [low.min(value), high.max(value)]
        });
    let margin = 0.06 * (high - low);
    [if low < 0.0 { low - margin } else { 0.0 }, high + margin]
}
