//! Figures 8 to 10 of the paper, signed and as magnitudes, each with its numbers.

use grouser_terra::{Angle, ModelOutcome, slip_model};

use grouser_figure::{Axis, Chart, Curve, Figure, Mark, Marker, Style};
use grouser_report::number::{exact, rounded};

/// One line of a figure.
struct Line {
    /// Angle in rad, sinkage and radius in m; the swept one is replaced.
    theta: f64,
    sinkage: f64,
    radius: f64,
    label: String,
}

/// What a figure sweeps.
#[derive(Clone, Copy)]
enum Swept {
    Theta,
    Sinkage,
    Radius,
}

/// One figure of the paper.
pub(super) struct PaperFigure {
    pub(super) number: u32,
    pub(super) about: &'static str,
    swept: Swept,
    from: f64,
    to: f64,
    lines: Vec<Line>,
}

const POINTS: u32 = 201;

fn line(theta_deg: f64, sinkage: f64, radius: f64, label: String) -> Line {
    Line {
        theta: theta_deg.to_radians(),
        sinkage,
        radius,
        label,
    }
}

/// The three, with the parameters of the paper.
pub(super) fn all() -> Vec<PaperFigure> {
    let pairs = [
        (0.010, 0.10),
        (0.014, 0.10),
        (0.020, 0.10),
        (0.030, 0.10),
        (0.010, 0.07),
        (0.010, 0.08),
        (0.010, 0.18),
    ];
    let millimetres = |m: f64| rounded(1e3 * m, 4);
    vec![
        PaperFigure {
            number: 8,
            about: "slip against the angle on the wheel",
            swept: Swept::Theta,
            from: 0.0,
            to: 45_f64.to_radians(),
            lines: pairs
                .map(|(z, r)| {
                    let label = format!("*z* = {}, *r* = {} mm", millimetres(z), millimetres(r));
                    line(0.0, z, r, label)
                })
                .into(),
        },
        PaperFigure {
            number: 9,
            about: "slip against sinkage at θ = 32°",
            swept: Swept::Sinkage,
            from: 0.001,
            to: 0.04,
            lines: [0.07, 0.08, 0.10, 0.18]
                .map(|r| line(32.0, 0.0, r, format!("*r* = {} mm", millimetres(r))))
                .into(),
        },
        PaperFigure {
            number: 10,
            about: "slip against wheel radius at θ = 32°, z = 1 mm",
            swept: Swept::Radius,
            from: 0.05,
            to: 0.20,
            lines: vec![line(32.0, 0.001, 0.0, "*z* = 1 mm".to_owned())],
        },
    ]
}

/// (swept value, S_0, in the contact?)
type Point = (f64, f64, bool);

impl PaperFigure {
    fn points(&self, line: &Line) -> Vec<Point> {
        (0..POINTS)
            .filter_map(|i| {
                let at = self.from + (self.to - self.from) * f64::from(i) / f64::from(POINTS - 1);
                let (mut theta, mut sinkage, mut radius) = (line.theta, line.sinkage, line.radius);
                match self.swept {
                    Swept::Theta => theta = at,
                    Swept::Sinkage => sinkage = at,
                    Swept::Radius => radius = at,
                }
                match slip_model(Angle::from_rad(theta), sinkage, radius, None) {
                    Ok(ModelOutcome::Slip(slip)) => {
                        Some((self.shown(at), slip.driving_formula, slip.in_contact))
                    }
                    _ => None,
                }
            })
            .collect()
    }

    /// The swept value in the figure's unit.
    fn shown(&self, at: f64) -> f64 {
        match self.swept {
            Swept::Theta => at.to_degrees(),
            Swept::Sinkage | Swept::Radius => 1e3 * at,
        }
    }

    fn axis(&self) -> &'static str {
        match self.swept {
            Swept::Theta => "Angle on the wheel *θ* (deg)",
            Swept::Sinkage => "Sinkage *z* (mm)",
            Swept::Radius => "Wheel radius *r* (mm)",
        }
    }

    /// Two panels: S_0 and |S_0|. Lines are thin outside the contact, and a circle marks its end.
    pub(super) fn draw(&self) -> Figure {
        let description = format!(
            "Figure {} of Ani et al. (2012): {}; lines are thin outside the contact",
            self.number, self.about
        );
        let panel = |title: &str, sign: f64| {
            let mut chart = Chart::new(Axis::new(self.axis()), Axis::new(title));
            for (index, line) in self.lines.iter().enumerate() {
                chart = add_line(chart, &self.points(line), &line.label, index, sign);
            }
            chart
        };
        Figure::new(description)
            .panel(panel("Slip *S*_{0}", 1.0))
            .panel(panel("Slip magnitude |*S*_{0}|", -1.0))
    }

    /// The numbers of all lines.
    pub(super) fn csv(&self) -> String {
        let swept = match self.swept {
            Swept::Theta => "theta_deg",
            Swept::Sinkage => "sinkage_mm",
            Swept::Radius => "radius_mm",
        };
        let mut text = format!("line,{swept},slip,slip_magnitude,in_contact\n");
        for line in &self.lines {
            let name = line.label.replace('*', "").replace(',', ";");
            for (at, slip, inside) in self.points(line) {
                let cells = [
                    name.clone(),
                    exact(at),
                    exact(slip),
                    exact(slip.abs()),
                    inside.to_string(),
                ];
                text.push_str(&cells.join(","));
                text.push('\n');
            }
        }
        text
    }
}

fn add_line(chart: Chart, points: &[Point], label: &str, index: usize, sign: f64) -> Chart {
    let style = Style::numbered(index);
    let thin = Style {
        width: 0.5,
        ..style
    };
    let mut chart = chart;
    let mut start = 0;
    for piece in points.chunk_by(|a, b| a.2 == b.2) {
        let end = start + piece.len();
        let reach = points.len().min(end + 1);
        let curve = Curve::new(points[start..reach].iter().map(|p| [p.0, sign * p.1]))
            .style(if piece[0].2 { style } else { thin });
        chart = chart.curve(if end == points.len() {
            curve.label(label)
        } else {
            curve
        });
        if end < points.len() {
            let (x, s, _) = points[end];
            chart = chart.mark(Mark::new([x, sign * s]).look(Marker::Circle, style.colour));
        }
        start = end;
    }
    chart
}
