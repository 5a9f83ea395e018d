//! The paper's optimisation problem: how its answer depends on what the paper does not say.

use grouser_design::{Answer, Quantity};
use std::fmt::Write as _; // writing to a string cannot fail

use super::problem::{INTERPRETATIONS, Interpretation, PRINTED_SLIP, sinkage_ratio_of_slip};
use crate::error::Result;
use grouser_figure::{Axis, Chart, Colour, Curve, Dash, Figure, Marker, Points, Rule, Style};
use grouser_report::number::exact;
use grouser_report::{Fields, fields};

/// Starts of each reading.
const STARTS: usize = 16;
/// The seed of the starts of every reading.
pub const SEED: u64 = 1;

/// Where one start ended.
pub(super) struct End {
    pub(super) theta_deg: f64,
    pub(super) ratio: f64,
    pub(super) slip: f64,
    pub(super) utility: f64,
    pub(super) solved: bool,
}

/// One reading with all its ends.
pub(super) struct Solved {
    pub(super) reading: &'static Interpretation,
    pub(super) ends: Vec<End>,
    /// How many different points are optima.
    pub(super) optima: usize,
}

/// Solves every reading from all starts.
pub(super) fn solve() -> Result<Vec<Solved>> {
    INTERPRETATIONS
        .iter()
        .map(|reading| {
            let design = reading.design(STARTS, SEED)?;
            let Answer::Optimum(optimum) = design.solve()? else {
                return Ok(Solved {
                    reading,
                    ends: Vec::new(),
                    optima: 0,
                });
            };
            let place = |name: &str| design.variables.iter().position(|v| v.name == name);
            let (r, z, theta) = (place("radius_m"), place("sinkage_m"), place("theta_deg"));
            let at = |x: &[f64], place: Option<usize>| place.map_or(f64::NAN, |i| x[i]);
            let ends = optimum
                .starts
                .iter()
                .map(|start| End {
                    theta_deg: at(&start.x, theta),
                    ratio: at(&start.x, z) / at(&start.x, r),
                    slip: design.quantity(Quantity::S0, &start.x).unwrap_or(f64::NAN),
                    utility: start.utility,
                    solved: start.status.is_solved(),
                })
                .collect();
            Ok(Solved {
                reading,
                ends,
                optima: optimum.optima.len(),
            })
        })
        .collect()
}

impl Solved {
    pub(super) fn solved(&self) -> impl Iterator<Item = &End> {
        self.ends.iter().filter(|end| end.solved)
    }

    /// The least utility: the best that any start found.
    pub(super) fn best(&self) -> f64 {
        self.solved()
            .map(|e| e.utility)
            .fold(f64::INFINITY, f64::min)
    }

    /// Those that are as good as the best, to 1e-6.
    pub(super) fn equally_good(&self) -> impl Iterator<Item = &End> {
        let best = self.best();
        self.solved()
            .filter(move |e| e.utility <= best + 1e-6 * (1.0 + best.abs()))
    }

    /// The least and greatest |S_0| among `ends`.
    pub(super) fn range<'e>(ends: impl Iterator<Item = &'e End>) -> (f64, f64) {
        ends.map(|e| e.slip.abs())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| {
                (l.min(s), h.max(s))
            })
    }

    pub(super) fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |solved: &'a Self|
            "reading" "reading of the problem" = solved.reading.name;
            "assumes" "what it assumes" = solved.reading.assumes;
            "starts" "starts" = solved.ends.len();
            "solved" "starts that were solved" = solved.solved().count();
            "optima" "different optima" = solved.optima;
            "equally_good" "starts that ended equally well" = solved.equally_good().count();
            "slip_magnitude_min" "minimum magnitude of their slip" = Self::range(solved.equally_good()).0;
            "slip_magnitude_max" "maximum magnitude of their slip" = Self::range(solved.equally_good()).1;
        }
    }
}

/// The curve on which |S_0| is the printed optimum: (θ in degrees, z/r, in the contact?).
pub(super) fn curve() -> Vec<(f64, f64, bool)> {
    (0..=180)
        .filter_map(|i| {
            let theta = (0.25 * f64::from(i)).to_radians();
            let ratio = sinkage_ratio_of_slip(PRINTED_SLIP, theta)?;
            let inside = theta <= grouser_terra::entry_angle(ratio, 1.0);
            Some((theta.to_degrees(), ratio, inside))
        })
        .collect()
}

pub(super) fn curve_csv() -> String {
    let mut text = String::from("theta_deg,sinkage_over_radius,in_contact\n");
    for (theta, ratio, inside) in curve() {
        let _ = writeln!(text, "{},{},{inside}", exact(theta), exact(ratio));
    }
    text
}

pub(super) fn csv(all: &[Solved]) -> String {
    let mut text = String::from(
        "reading,start,theta_deg,sinkage_over_radius,slip,slip_magnitude,utility,solved\n",
    );
    for solved in all {
        for (index, end) in solved.ends.iter().enumerate() {
            let numbers = [
                end.theta_deg,
                end.ratio,
                end.slip,
                end.slip.abs(),
                end.utility,
            ];
            let numbers: Vec<String> = numbers.iter().map(|v| exact(*v)).collect();
            let _ = writeln!(
                text,
                "\"{}\",{},{},{}",
                solved.reading.name,
                index + 1,
                numbers.join(","),
                end.solved
            );
        }
    }
    text
}

const LOOKS: [(Marker, Colour); 5] = [
    (Marker::Circle, Colour::BLUE),
    (Marker::Square, Colour::OCHRE),
    (Marker::Triangle, Colour::GREEN),
    (Marker::Diamond, Colour::PURPLE),
    (Marker::Disc, Colour::SLATE),
];

/// (a) where the solutions lie beside the curve of the printed slip; (b) the slip that each start ends at.
pub(super) fn draw(all: &[Solved]) -> Figure {
    let all_of = |inside: bool| {
        let points = curve().into_iter();
        points
            .filter(move |p| p.2 == inside)
            .map(|p| [p.0, p.1])
            .collect::<Vec<_>>()
    };
    let solid = Style {
        colour: Colour::RED,
        dash: Dash::Solid,
        width: 1.2,
    };
    let thin = Style {
        width: 0.5,
        ..solid
    };
    let mut places = Chart::new(
        Axis::new("Angle on the wheel *θ* (deg)").range(-2.0, 47.0),
        Axis::new("Sinkage over radius *z*/*r*").range(0.0, 0.45),
    )
    .curve(
        Curve::new(all_of(true))
            .style(solid)
            .label("|*S*_{0}| = 0.1146"),
    )
    .curve(Curve::new(all_of(false)).style(thin));
    let mut ends = Chart::new(
        Axis::new("Start"),
        Axis::new("Slip magnitude |*S*_{0}| where it ends"),
    )
    .rule(Rule::at_y(PRINTED_SLIP).label("printed: 0.1146"));
    for (solved, (marker, colour)) in all.iter().zip(LOOKS) {
        let at = solved.equally_good().map(|e| [e.theta_deg, e.ratio]);
        places = places.points(
            Points::new(at.collect::<Vec<_>>())
                .look(marker, colour)
                .label(solved.reading.name),
        );
        let by_start = solved
            .ends
            .iter()
            .enumerate()
            .filter(|(_, e)| e.solved)
            .map(|(i, e)| [i as f64 + 1.0, e.slip.abs()]);
        ends = ends.points(Points::new(by_start.collect::<Vec<_>>()).look(marker, colour));
    }
    Figure::new(
        "The paper's optimisation problem under five readings: where solutions lie relative to the curve of the \
         printed slip, and how the slip depends on the start",
    )
    .panel(places)
    .panel(ends)
}
