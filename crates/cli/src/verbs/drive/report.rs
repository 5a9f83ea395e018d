//! `drive` as a page that stands alone: table, map, charts, decisions, where its numbers come from.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_rover::drive::Scenario;

use super::charts;
use super::decisions;
use super::map;
use super::run::{Run, pilots};
use super::text::summary;
use super::track::Track;
use grouser_figure::escaped;
use grouser_figure::{Figure, Style};
use grouser_report::Object;

const STYLE: &str = include_str!("report.css");

/// The page. `provenance` is what the JSON has under that name.
pub(super) fn page(scenario: &Scenario, optimum: f64, runs: &[Run], provenance: &Object) -> String {
    let title = escaped(&scenario.title);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" \
         content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style></head>\n<body>\n<h1>{title}</h1>\n\
         <p>{robot}; slip to run at {optimum:.3} ({meaning}); {legs} over {ground}.</p>\n",
        robot = escaped(scenario.robot.robot.name()),
        meaning = escaped(&super::optimum::meaning(scenario)),
        legs = legs(scenario),
        ground = ground(scenario),
    );
    table(runs, &mut out);
    let drivers = pilots(runs);
    if runs.len() > drivers.len() {
        out.push_str("<ul>\n");
        for pilot in &drivers {
            let _ = writeln!(out, "<li>{}</li>", escaped(&summary(runs, *pilot)));
        }
        out.push_str("</ul>\n");
    }
    if drivers.len() > 1 {
        out.push_str("<h2>Energy of each driver</h2>\n<div class=\"grid\">");
        picture("", &charts::compared(scenario, runs), &mut out);
        out.push_str("</div>\n");
    }
    for run in runs {
        if let Some(track) = &run.track {
            section(scenario, run, track, &mut out);
        }
    }
    sources(scenario, provenance, &mut out);
    out.push_str("</body></html>\n");
    out
}

fn legs(scenario: &Scenario) -> String {
    match scenario.legs.len() {
        1 => "1 leg".to_owned(),
        count => format!("{count} legs"),
    }
}

/// The size of the ground in words.
fn ground(scenario: &Scenario) -> String {
    use grouser_rover::drive::GroundShape;
    match &scenario.ground.shape {
        GroundShape::Generated { size, .. } => {
            format!("generated ground of {} × {} m", size.0, size.1)
        }
        GroundShape::File(file) => {
            let name = file.path.file_name().unwrap_or_default().to_string_lossy();
            format!("the ground of {}", escaped(&name))
        }
        _ => "ground".to_owned(),
    }
}

fn table(runs: &[Run], out: &mut String) {
    out.push_str(
        "<div class=\"wide\"><table><thead><tr><th>driver</th><th>seed</th><th>outcome</th>\
         <th>distance, m</th><th>time, s</th><th>energy, J</th><th>energy, J/m</th><th>worst slip</th>\
         <th>slip, RMS error</th><th>bias</th></tr></thead><tbody>\n",
    );
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "—".to_owned(), |value| signed(value, digits))
    };
    for run in runs {
        let result = &run.result;
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td class=\"text\">{}</td><td>{:.2}</td><td>{:.1}</td><td>{:.0}</td>\
             <td>{}</td><td>{:.2}</td><td>{}</td><td>{}</td></tr>",
            run.pilot.name(),
            run.seed,
            result.outcome.name(),
            result.distance,
            result.duration,
            result.energy,
            number(result.energy_per_metre(), 0),
            result.worst_slip,
            number(result.slip.rmse, 3),
            number(result.slip.bias, 3),
        );
    }
    out.push_str("</tbody></table></div>\n");
}

fn section(scenario: &Scenario, run: &Run, track: &Track, out: &mut String) {
    let _ = writeln!(out, "<h2>{}, seed {}</h2>", run.pilot.name(), run.seed);
    let _ = writeln!(
        out,
        "<figure class=\"sheet\">{}</figure>",
        map::map(scenario, run, track)
    );
    out.push_str("<h3>Slip and torque of each powered wheel</h3>\n");
    let _ = writeln!(
        out,
        "<p class=\"key\">{} true &ensp; {} estimated, with one standard deviation</p>",
        swatch(charts::TRUE),
        swatch(charts::SEEN)
    );
    out.push_str("<div class=\"grid\">\n");
    for wheel in scenario.robot.powered() {
        if let Some(described) = scenario.robot.robot.wheels().get(wheel) {
            let name = &described.name;
            picture(name, &charts::slip(track, wheel, name), out);
            picture(name, &charts::torque(track, wheel, name), out);
        }
    }
    out.push_str("</div>\n<h3>Speed and energy</h3>\n");
    let _ = writeln!(
        out,
        "<p class=\"key\">{} true &ensp; {} estimated &ensp; {} requested</p>\n<div class=\"grid\">",
        swatch(charts::TRUE),
        swatch(charts::SEEN),
        swatch(charts::REQUESTED)
    );
    picture("", &charts::speed(track), out);
    picture("", &charts::energy(track), out);
    out.push_str("</div>\n");
    books(scenario, run, out);
    decisions(scenario, run, out);
}

fn picture(name: &str, figure: &Figure, out: &mut String) {
    let caption = if name.is_empty() {
        String::new()
    } else {
        format!("<figcaption>{}</figcaption>", escaped(name))
    };
    let _ = writeln!(
        out,
        "<figure class=\"sheet\">{caption}{}</figure>",
        figure.svg()
    );
}

/// A short line in a style, for the key.
fn swatch(style: Style) -> String {
    let dash = match style.dash {
        grouser_figure::Dash::Solid => "",
        grouser_figure::Dash::Dotted => " stroke-dasharray=\"2 2.4\"",
        _ => " stroke-dasharray=\"7 3\"",
    };
    format!(
        "<svg class=\"swatch\" viewBox=\"0 0 34 8\" aria-hidden=\"true\"><path d=\"M0 4h34\" \
         stroke=\"{}\" stroke-width=\"{:.1}\"{dash}/></svg>",
        style.colour,
        1.5 * style.width
    )
}

/// Where the electrical energy went.
fn books(scenario: &Scenario, run: &Run, out: &mut String) {
    let result = &run.result;
    let ledger = &result.ledger;
    let electronics = scenario.hotel * result.duration;
    let rows = [
        ("electronics", electronics),
        ("heat of motors and gears", ledger.motor_heat),
        ("soil", ledger.soil),
        ("bearings", ledger.bearings),
        ("dampers", ledger.dampers),
    ];
    let gone: f64 = rows.iter().map(|(_, energy)| energy).sum();
    out.push_str(
        "<div class=\"wide\"><table><thead><tr><th>the energy went into</th><th>J</th><th>share</th></tr></thead>\
         <tbody>\n",
    );
    let whole = result.energy;
    let mut row = |name: &str, energy: f64| {
        let share = if whole > 0.0 {
            format!("{} %", signed(100.0 * energy / whole, 1))
        } else {
            "—".to_owned()
        };
        let _ = writeln!(
            out,
            "<tr><td>{name}</td><td>{}</td><td>{share}</td></tr>",
            signed(energy, 1)
        );
    };
    for (name, energy) in rows {
        row(name, energy);
    }
    row("height and motion, and what the books lack", whole - gone);
    row("battery, in all", whole);
    out.push_str("</tbody></table></div>\n");
}

/// A number with a true minus, and without one before a zero.
fn signed(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|digit| matches!(digit, '0' | '.')) => zero.to_owned(),
        Some(size) => format!("−{size}"),
        None => text,
    }
}

fn decisions(scenario: &Scenario, run: &Run, out: &mut String) {
    out.push_str("<h3>Decisions</h3>\n");
    let kept = &run.result.decisions;
    if kept.is_empty() {
        out.push_str("<p>None.</p>\n");
        return;
    }
    out.push_str(
        "<div class=\"wide\"><table><thead><tr><th>time, s</th><th>on the map</th><th class=\"text\">wheels</th>\
         <th class=\"text\">decision</th><th class=\"text\">reason</th><th>seen</th><th>limit</th></tr></thead><tbody>\n",
    );
    let wheels = scenario.robot.robot.wheels();
    for group in decisions::groups(kept) {
        let named: Vec<String> = group
            .wheels
            .iter()
            .filter_map(|index| Some(escaped(&wheels.get(*index)?.name)))
            .collect();
        let decision = &group.first.decision;
        let _ = writeln!(
            out,
            "<tr><td>{:.2}</td><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td>\
             <td class=\"text\">{}</td><td>{}</td><td>{:.3}</td></tr>",
            group.first.time,
            group
                .number
                .map_or_else(String::new, |number| number.to_string()),
            if named.is_empty() {
                "the robot".to_owned()
            } else {
                named.join(", ")
            },
            escaped(decision.action.name()),
            escaped(decision.reason.name()),
            group.values(),
            decision.limit,
        );
    }
    out.push_str("</tbody></table></div>\n");
    let more = run.result.decision_count.saturating_sub(kept.len() as u64);
    if more > 0 {
        let _ = writeln!(out, "<p>… and {more} more.</p>");
    }
}

/// Version, seed, inputs with their hashes, soils with their sources.
fn sources(scenario: &Scenario, provenance: &Object, out: &mut String) {
    out.push_str("<h2>Provenance</h2>\n<div class=\"wide\"><table class=\"sources\"><tbody>\n");
    let mut row = |name: &str, value: &str| {
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td class=\"text\">{}</td></tr>",
            escaped(name),
            escaped(value)
        );
    };
    let word = |key: &str| match provenance.get(key) {
        None | Some(serde_json::Value::Null) => "—".to_owned(),
        Some(serde_json::Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    };
    row("grouser", &word("version"));
    row("commit", &word("commit"));
    row("seed", &word("seed"));
    if let Some(inputs) = provenance.get("input_sha256").and_then(|v| v.as_object()) {
        for (name, hash) in inputs {
            let hash = hash.as_str().unwrap_or_default();
            row(name, &format!("SHA-256 {hash}"));
        }
    }
    for soil in &scenario.ground.soils {
        row(&format!("soil {}", soil.name), &soil.source);
    }
    out.push_str(
        "</tbody></table></div>\n<p class=\"note\">Simulated: forces from the stresses under each wheel, \
         sensors with their noise, and the estimator and controller that run on a robot. The same seed and files \
         give the same numbers.</p>\n",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign_and_a_minus_is_one() {
        assert_eq!(signed(-0.0004, 3), "0.000");
        assert_eq!(signed(-0.0006, 3), "−0.001");
        assert_eq!(signed(12.34, 1), "12.3");
    }
}
