//! Charts of the page as one figure of publication quality, its letters as outlines: for papers and slides.

use grouser_figure::{
    Area, Axis, Chart, Colour, Curve, Dash, Figure, Mark, Points, Rule, Style, plain,
};
use serde_json::{Value, json};

use crate::request::{Problem, Request};

/// Most panels of a figure, and most series of a panel.
const MAX_PANELS: usize = 24;
const MAX_SERIES: usize = 64;

/// Draws the `panels` of a request: each has `x` and `y` (`title`, `range`), `curves` (`x`, `y`, `label`, `style`: a
/// number, or null for a thin grey line), `bands` (`x`, `low`, `high`, `style`), `points` and `marks` (`x`, `y`), `levels` (`y`, `label`)
/// and `spans` (`from`, `to`). The answer has the figure as `svg`.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let panels = request.list("panels", MAX_PANELS)?;
    let mut figure = Figure::new(plain(request.text("description")?));
    for panel in panels {
        figure = figure.panel(chart(panel)?);
    }
    Ok(json!({ "svg": figure.columns(if panels.len() > 1 { 2 } else { 1 }).svg() }))
}

fn chart(panel: &Value) -> Result<Chart, Problem> {
    let mut chart = Chart::new(axis(&panel["x"])?, axis(&panel["y"])?);
    for span in series(panel, "spans")? {
        if let (Some(from), Some(to)) = (span["from"].as_f64(), span["to"].as_f64()) {
            chart = chart.area(Area::columns(from, to).colour(Colour::GREY, 0.2));
        }
    }
    for band in series(panel, "bands")? {
        let [low, high] = [line(band, "low"), line(band, "high")];
        for (low, high) in runs(&low, &high) {
            let area = Area::between(low.iter().copied(), high.iter().copied());
            chart = chart.area(area.colour(style(band).colour, 0.15));
        }
    }
    for level in series(panel, "levels")? {
        if let Some(y) = level["y"].as_f64() {
            chart = chart.rule(Rule::at_y(y).label(text(&level["label"])));
        }
    }
    for curve in series(panel, "curves")? {
        let drawn = Curve::new(line(curve, "y")).style(style(curve));
        chart = chart.curve(match &curve["label"] {
            Value::String(_) => drawn.label(text(&curve["label"])),
            _ => drawn,
        });
    }
    for measured in series(panel, "points")? {
        let points = line(measured, "y").into_iter();
        chart = chart.points(Points::new(
            points.filter(|[x, y]| x.is_finite() && y.is_finite()),
        ));
    }
    for mark in series(panel, "marks")? {
        if let (Some(x), Some(y)) = (mark["x"].as_f64(), mark["y"].as_f64()) {
            chart = chart.mark(Mark::new([x, y]));
        }
    }
    Ok(chart)
}

fn axis(value: &Value) -> Result<Axis, Problem> {
    let axis = Axis::new(text(&value["title"]));
    let Some(range) = value["range"].as_array() else {
        return Ok(axis);
    };
    match (
        range.first().and_then(Value::as_f64),
        range.get(1).and_then(Value::as_f64),
    ) {
        (Some(low), Some(high)) if low < high => Ok(axis.range(low, high)),
        _ => Err(Problem::new(
            "panels",
            "the range of an axis is two rising numbers",
        )),
    }
}

fn series<'a>(panel: &'a Value, kind: &str) -> Result<&'a [Value], Problem> {
    let list = panel[kind].as_array().map_or(&[][..], Vec::as_slice);
    if list.len() > MAX_SERIES {
        return Err(Problem::new(
            "panels",
            format!(
                "a panel has {} {kind}, but at most {MAX_SERIES} are drawn",
                list.len()
            ),
        ));
    }
    Ok(list)
}

/// The points of a column over `x`; what is missing breaks the line.
fn line(series: &Value, column: &str) -> Vec<[f64; 2]> {
    let numbers = |key: &str| {
        let values = series[key].as_array().map_or(&[][..], Vec::as_slice);
        values
            .iter()
            .map(|value| value.as_f64().unwrap_or(f64::NAN))
    };
    numbers("x")
        .zip(numbers(column))
        .map(|(x, y)| [x, y])
        .collect()
}

type Run<'a> = (&'a [[f64; 2]], &'a [[f64; 2]]);

/// The stretches in which both ends of a band are there.
fn runs<'a>(low: &'a [[f64; 2]], high: &'a [[f64; 2]]) -> Vec<Run<'a>> {
    let is_there = |i: usize| {
        [low[i], high[i]]
            .iter()
            .flatten()
            .all(|value| value.is_finite())
    };
    let mut found = Vec::new();
    let mut begin = None;
    for i in 0..=low.len().min(high.len()) {
        let there = i < low.len().min(high.len()) && is_there(i);
        match (there, begin) {
            (true, None) => begin = Some(i),
            (false, Some(first)) => {
                found.push((&low[first..i], &high[first..i]));
                begin = None;
            }
            _ => {}
        }
    }
    found
}

fn style(series: &Value) -> Style {
    let number = series["style"]
        .as_u64()
        .and_then(|number| usize::try_from(number).ok());
    number.map_or_else(
        || Style::thin(Colour::GREY, Dash::Dashed),
        |number| Style::numbered(number % 64),
    )
}

fn text(value: &Value) -> String {
    plain(value.as_str().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use crate::answer;

    #[test]
    fn a_chart_is_a_figure_whose_letters_are_outlines() {
        let request = r#"{"call": "figure", "description": "pull", "panels": [{
            "x": {"title": "Slip", "range": [0, 1]}, "y": {"title": "Drawbar pull (N)"},
            "curves": [{"x": [0, 0.5, 1], "y": [0, null, 2], "label": "<img src=x> _{a}", "style": 0}],
            "bands": [{"x": [0, 0.5, 1], "low": [0, null, 1], "high": [1, 2, 3], "style": 0}],
            "points": [{"x": [0.2, null], "y": [1, 1]}], "marks": [{"x": 0.4, "y": 1}],
            "levels": [{"y": 1.5, "label": "needed"}], "spans": [{"from": 0.1, "to": 0.2}]}]}"#;
        let answer: serde_json::Value = serde_json::from_str(&answer(request)).expect("JSON");
        let svg = answer["svg"].as_str().expect("a figure");
        assert!(svg.starts_with("<svg") && svg.contains("aria-label"));
        assert!(
            !svg.contains("<text") && !svg.contains("<img"),
            "letters are outlines"
        );
    }

    #[test]
    fn what_is_no_figure_is_refused() {
        for panels in ["3", r#"[{"x": {"range": [1, 0]}, "y": {}}]"#] {
            let request = format!(r#"{{"call": "figure", "description": "", "panels": {panels}}}"#);
            assert!(
                answer(&request).starts_with(r#"{"error":{"field":"panels""#),
                "{panels}"
            );
        }
    }
}
