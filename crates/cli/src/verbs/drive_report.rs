//! `drive` as a page that stands alone: table, map, figures, decisions.

use std::fmt::Write as _;

use grouser_rover::drive::Scenario;

use super::drive::Run;
use super::drive_map;
use super::drive_tables::Track;
use crate::figure::{Axis, Chart, Colour, Curve, Dash, Figure, Style, plain};

const STYLE: &str = "\
body{font:16px/1.5 Georgia,serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff}\
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}table{border-collapse:collapse;font-size:.9rem}\
th,td{padding:.2rem .7rem;text-align:right;border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}\
td.text{text-align:left}svg{max-width:100%;height:auto}.note{color:#555;font-size:.9rem}";

/// The page.
pub(super) fn page(scenario: &Scenario, optimum: f64, runs: &[Run]) -> String {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{title}</title>\n<style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n\
         <p>Robot: {robot}. Slip to run at: {optimum:.3}. Soil: {soil}.</p>\n",
        title = escaped(&scenario.title),
        robot = escaped(scenario.robot.robot.name()),
        soil = escaped(
            &scenario
                .ground
                .soils
                .iter()
                .map(|spec| format!("{} ({})", spec.name, spec.source))
                .collect::<Vec<_>>()
                .join(", ")
        ),
    );
    table(runs, &mut out);
    for run in runs {
        if let Some(track) = &run.track {
            section(scenario, run, track, &mut out);
        }
    }
    let _ = write!(
        out,
        "<p class=\"note\">grouser {} drive {}. Simulated: the stresses under each wheel by the laws of \
         grouser-terra; sensors with noise; the same estimator and controller that run on a robot.</p>\n</body></html>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&scenario.name),
    );
    out
}

fn table(runs: &[Run], out: &mut String) {
    out.push_str(
        "<table><thead><tr><th>driver</th><th>seed</th><th>outcome</th><th>distance, m</th><th>time, s</th>\
         <th>energy, J</th><th>J/m</th><th>worst slip</th><th>slip, RMS error</th></tr></thead><tbody>\n",
    );
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "—".to_owned(), |value| format!("{value:.digits$}"))
    };
    for run in runs {
        let result = &run.result;
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td class=\"text\">{}</td><td>{:.2}</td><td>{:.0}</td><td>{:.0}</td>\
             <td>{}</td><td>{:.2}</td><td>{}</td></tr>",
            run.pilot.name(),
            run.seed,
            result.outcome.name(),
            result.distance,
            result.duration,
            result.energy,
            number(result.energy_per_metre(), 0),
            result.worst_slip,
            number(result.slip.rmse, 3),
        );
    }
    out.push_str("</tbody></table>\n");
}

fn section(scenario: &Scenario, run: &Run, track: &Track, out: &mut String) {
    let _ = writeln!(out, "<h2>{}, seed {}</h2>", run.pilot.name(), run.seed);
    out.push_str(&drive_map::map(scenario, run, track));
    out.push_str(&slips(scenario, track).svg());
    out.push_str(&books(scenario, track).svg());
    decisions(scenario, run, out);
}

/// Slip of each powered wheel, true and estimated.
fn slips(scenario: &Scenario, track: &Track) -> Figure {
    let mut figure =
        Figure::new("Slip of each powered wheel against time: true and estimated").columns(2);
    let end = end(track);
    for wheel in scenario.robot.powered() {
        let Some(described) = scenario.robot.robot.wheels().get(wheel) else {
            continue;
        };
        let mut chart = Chart::new(
            Axis::new("Time (s)").range(0.0, end),
            Axis::new(format!("Slip, {}", plain(&described.name))).range(-1.0, 1.0),
        );
        for points in pieces(track, |point| point.wheels[wheel].seen) {
            chart = chart.curve(Curve::new(points).style(Style::thin(Colour::BLUE, Dash::Solid)));
        }
        for points in pieces(track, |point| point.wheels[wheel].slip) {
            chart = chart.curve(Curve::new(points).style(Style::thin(Colour::RED, Dash::Solid)));
        }
        figure = figure.panel(chart);
    }
    figure
}

/// Torques and energy.
fn books(scenario: &Scenario, track: &Track) -> Figure {
    let end = end(track);
    let most = track
        .points
        .iter()
        .flat_map(|point| point.wheels.iter().map(|wheel| wheel.torque.abs()))
        .fold(0.1, f64::max);
    let mut torques = Chart::new(
        Axis::new("Time (s)").range(0.0, end),
        Axis::new("Torque of each motor (N m)").range(-1.1 * most, 1.1 * most),
    );
    for (index, wheel) in scenario.robot.powered().enumerate() {
        let line = track
            .points
            .iter()
            .map(|point| [point.time, point.wheels[wheel].torque]);
        let style = Style {
            width: 0.6,
            ..Style::numbered(index)
        };
        torques = torques.curve(Curve::new(line).style(style));
    }
    let spent = track
        .points
        .last()
        .map_or(1.0, |point| point.energy.max(1.0));
    let energy = Chart::new(
        Axis::new("Time (s)").range(0.0, end),
        Axis::new("Electrical energy (J)").range(0.0, 1.05 * spent),
    )
    .curve(Curve::new(track.points.iter().map(|p| [p.time, p.energy])).style(Style::numbered(0)));
    Figure::new("Torque of each motor and electrical energy against time")
        .columns(2)
        .panel(torques)
        .panel(energy)
}

fn end(track: &Track) -> f64 {
    track.points.last().map_or(1.0, |point| point.time.max(1.0))
}

/// The stretches over which a value exists.
fn pieces(
    track: &Track,
    of: impl Fn(&super::drive_tables::Point) -> Option<f64>,
) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = vec![Vec::new()];
    for point in &track.points {
        match (of(point), pieces.last_mut()) {
            (Some(value), Some(piece)) => piece.push([point.time, value]),
            (None, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
            _ => {}
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

fn decisions(scenario: &Scenario, run: &Run, out: &mut String) {
    out.push_str("<p class=\"note\">Slip: true in red, estimated in blue.</p>\n");
    if run.result.decisions.is_empty() {
        return;
    }
    out.push_str(
        "<table><thead><tr><th>time, s</th><th>wheel</th><th>decision</th></tr></thead><tbody>\n",
    );
    let wheels = scenario.robot.robot.wheels();
    for named in &run.result.decisions {
        let wheel = named.decision.wheel.and_then(|index| wheels.get(index));
        let _ = writeln!(
            out,
            "<tr><td>{:.2}</td><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>",
            named.time,
            wheel.map_or_else(String::new, |wheel| escaped(&wheel.name)),
            escaped(&named.decision.to_string()),
        );
    }
    out.push_str("</tbody></table>\n");
}

/// Text that came from a user, safe in a page.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
