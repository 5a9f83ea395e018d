//! Two labelled curves as SVG on standard output.
//! `cargo run -p grouser-figure --example pull > pull.svg`

use std::io::Write as _;

use grouser_figure::{Axis, Chart, Curve, Figure, Style};

fn main() -> std::io::Result<()> {
    let pull = |load: f64| {
        (0..=50).map(move |i| {
            let slip = f64::from(i) / 50.0;
            [slip, load * (0.3 * (1.0 - (-8.0 * slip).exp()) - 0.05)]
        })
    };
    let axes = (
        Axis::new("Slip *s*"),
        Axis::new("Drawbar pull *F*_{DP} (N)"),
    );
    let mut chart = Chart::new(axes.0, axes.1);
    for (number, load) in [40.0, 90.0].into_iter().enumerate() {
        let curve = Curve::new(pull(load)).style(Style::numbered(number));
        chart = chart.curve(curve.label(format!("*W* = {load} N")));
    }
    let figure = Figure::new("Drawbar pull against slip").panel(chart);
    std::io::stdout().write_all(figure.svg().as_bytes())
}
