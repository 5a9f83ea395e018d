//! The figure of `optimize`: what decides a compromise, or a front with its knee.

use grouser_design::{Answer, Design, FrontProof, Optimum, Trade};

use grouser_figure::{
    Axis, Chart, Colour, Curve, Figure, Mark, Marker, Points, Rule, Style, plain,
};

/// More panels than this are no picture any more.
const MAX_PANELS: usize = 6;
/// More names than this are no reading any more.
const MAX_NAMES: usize = 16;

pub(super) fn draw(design: &Design, answer: &Answer, proof: Option<&FrontProof>) -> Figure {
    match answer {
        Answer::Trade(trade) => front(design, trade, proof),
        Answer::Optimum(optimum) if optimum.starts.len() > 1 => {
            starts(design, optimum, compromise(design, optimum))
        }
        Answer::Optimum(optimum) => compromise(design, optimum),
        _ => Figure::new("Nothing to show"),
    }
}

/// A line from 0 to each value with the name at its end.
fn lines(title: &str, names: &[String], values: &[f64], colour: Colour) -> Chart {
    let count = values.len() as f64;
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let width = if high > low { high - low } else { 1.0 };
    // Room for the names at both ends.
    let mut chart = Chart::new(
        Axis::new(title).range(low - 0.08 * width, high + 0.45 * width),
        Axis::new("Objective number").range(0.3, count + 0.7),
    );
    let style = Style {
        colour,
        width: 1.6,
        ..Style::numbered(0)
    };
    for (i, value) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
        let y = i as f64 + 1.0;
        let mark = Mark::new([*value, y]).look(Marker::Disc, colour);
        chart = chart.curve(Curve::new([[0.0, y], [*value, y]]).style(style));
        chart = chart.mark(if values.len() <= MAX_NAMES {
            mark.label(plain(&names[i]))
        } else {
            mark
        });
    }
    chart.rule(Rule::at_x(0.0))
}

/// Scaled objectives against the level they are held at, and who holds it.
fn compromise(design: &Design, optimum: &Optimum) -> Figure {
    let names: Vec<String> = optimum.objectives.iter().map(|(n, _)| n.clone()).collect();
    let values: Vec<f64> = optimum
        .objectives
        .iter()
        .zip(&optimum.objective_scales)
        .map(|((_, f), scale)| f * scale)
        .collect();
    let shares: Vec<f64> = optimum
        .objective_multipliers
        .iter()
        .map(|(_, l)| *l)
        .collect();
    let scaled = optimum.objective_scales.iter().any(|s| *s != 1.0);
    let title = if scaled {
        "Objective, scaled as in the file"
    } else {
        "Objective"
    };
    let description = format!(
        "The compromise of {}: the objectives, and the multipliers that say which of them decide",
        design.file
    );
    Figure::new(description)
        .panel(lines(title, &names, &values, Colour::BLUE))
        .panel(lines(
            "Multiplier (share of the decision)",
            &names,
            &shares,
            Colour::RED,
        ))
}

/// One more panel: where each start ended.
fn starts(design: &Design, optimum: &Optimum, figure: Figure) -> Figure {
    let mut solved: Vec<f64> = optimum
        .starts
        .iter()
        .filter(|s| s.status.is_solved())
        .map(|s| s.maximum)
        .collect();
    solved.sort_by(f64::total_cmp);
    let all_maximised = design.objectives.iter().all(|o| o.maximise);
    if all_maximised {
        solved.reverse();
    }
    let places = solved.iter().enumerate().map(|(i, m)| [i as f64 + 1.0, *m]);
    let chart = Chart::new(Axis::new("Start, best first"), Axis::new("Worst objective"))
        .points(Points::new(places).look(Marker::Circle, Colour::BLUE));
    figure.panel(chart)
}

/// The steps between the corners, behind which no design lies.
fn proved_steps(proof: &FrontProof) -> Vec<[f64; 2]> {
    let corners = proof.corners.iter().map(|corner| [corner[0], corner[1]]);
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for corner in corners.filter(|c| c.iter().all(|x| x.is_finite())) {
        if let Some(last) = steps.last() {
            steps.push([corner[0], last[1]]);
        }
        steps.push(corner);
    }
    steps
}

/// Every pair of objectives, and what is proved about a front of two.
fn front(design: &Design, trade: &Trade, proof: Option<&FrontProof>) -> Figure {
    let m = design.objectives.len();
    let mut figure = Figure::new(format!(
        "The Pareto front of {}: {} compromises; the best trade-off (knee point) is marked",
        design.file,
        trade.points.len()
    ));
    let pairs = (0..m).flat_map(|a| (a + 1..m).map(move |b| (a, b)));
    for (a, b) in pairs.take(MAX_PANELS) {
        let title = |i: usize| plain(&design.objectives[i].name);
        let places: Vec<[f64; 2]> = trade
            .points
            .iter()
            .map(|p| [p.objectives[a], p.objectives[b]])
            .collect();
        let mut chart = Chart::new(Axis::new(title(a)), Axis::new(title(b)));
        chart = if m == 2 {
            chart.curve(Curve::new(places.clone()))
        } else {
            chart.points(Points::new(places.clone()).look(Marker::Circle, Colour::BLUE))
        };
        if let Some(proof) = proof {
            let style = Style {
                colour: Colour::RED,
                ..Style::numbered(1)
            };
            chart = chart.curve(
                Curve::new(proved_steps(proof))
                    .style(style)
                    .label("proved: nothing is better"),
            );
        }
        if let Some(knee) = trade.knee.and_then(|knee| places.get(knee)) {
            chart = chart.mark(
                Mark::new(*knee)
                    .look(Marker::Disc, Colour::RED)
                    .label("best trade-off"),
            );
        }
        figure = figure.panel(chart);
    }
    figure
}
