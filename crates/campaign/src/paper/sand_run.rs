//! Figure 13: slip against time of a run on sand, as `estimate` finds it in the log, with its 90 % intervals, next to the
//! true slip of the simulation.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_figure::{Area, Axis, Chart, Colour, Curve, Dash, Figure, Style, plain};
use grouser_report::number::{exact, rounded};
use grouser_report::{Fields, Table, fields};
use grouser_rover::robot::RobotModel;

/// A moment of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipMoment {
    /// Seconds since the log's start.
    pub time: f64,
    /// Estimated slip.
    pub slip: f64,
    /// Its 90 % interval.
    pub interval_90: Option<[f64; 2]>,
    /// True slip, where it is known.
    pub truth: Option<f64>,
}

/// A powered wheel of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct SandWheel {
    /// Its name.
    pub name: String,
    /// Every row of its estimate.
    pub moments: Vec<SlipMoment>,
    /// Root of the mean squared error.
    pub rmse: Option<f64>,
    /// Mean error.
    pub bias: Option<f64>,
    /// Share of the 90 % intervals that contain the true slip.
    pub coverage_90: Option<f64>,
}

/// The run on sand: what `estimate` finds in the log of a drive.
#[derive(Clone, Debug)]
pub struct SandRun {
    /// Its powered wheels.
    pub wheels: Vec<SandWheel>,
    /// Seed of ground and noise.
    pub seed: u64,
    /// The robot.
    pub robot: RobotModel,
}

/// The slip as section 4.1 of the paper words it, 1 − v_powered/v_fifth, which has no lower bound; `None` for a wheel that
/// spins on the spot.
///
/// ```
/// use grouser_campaign::paper::slip_as_worded;
///
/// assert_eq!(slip_as_worded(0.5), Some(-1.0)); // the wheel runs at twice the robot's speed
/// assert_eq!(slip_as_worded(-0.2), Some(0.2));
/// assert_eq!(slip_as_worded(1.0), None);
/// ```
#[must_use]
pub fn slip_as_worded(slip: f64) -> Option<f64> {
    if slip >= 1.0 {
        None
    } else if slip > 0.0 {
        Some(-slip / (1.0 - slip))
    } else {
        Some(-slip)
    }
}

/// Which definition of slip a figure shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Definition {
    Ours,
    Paper,
}

impl Definition {
    fn of(self, slip: f64) -> Option<f64> {
        match self {
            Self::Ours => Some(slip),
            Self::Paper => slip_as_worded(slip),
        }
    }

    const fn axis(self) -> &'static str {
        match self {
            Self::Ours => "Slip *s*",
            Self::Paper => "1 − *v*_{w}/*v*_{free}",
        }
    }
}

impl SandRun {
    /// What was done, in words.
    pub(super) fn about(&self) -> String {
        format!(
            "The paper's data of its run on sand are not published. In their place the scenario scenario.toml is driven \
             (seed {}) and its log drive.mcap is estimated: a box of dry sand with waves of 25 cm, forwards, a stop, \
             forwards faster, a stop, and back. Every row of the estimate is drawn, with its 90 % interval, next to the \
             true slip. The first figure has the definition used everywhere here: driving slip is positive, braking slip \
             negative. The second has the definition of section 4.1 of the paper, 1 − v_powered/v_free: the signs are \
             reversed, and a wheel that spins at more than twice the robot's speed is below −100 % without any noise ({} \
             of the rows). The mean speed of the free wheel is corrected for nothing but noise; its skid is part of the \
             error.",
            self.seed,
            rounded(self.beyond_whole(), 2),
        )
    }

    /// Share of the rows that lie below −1 in the paper's definition.
    fn beyond_whole(&self) -> f64 {
        let moments = || self.wheels.iter().flat_map(|wheel| &wheel.moments);
        let beyond = moments().filter(|moment| moment.slip > 0.5).count();
        beyond as f64 / moments().count().max(1) as f64
    }

    pub(super) const HEADER: [&'static str; 5] = [
        "wheel",
        "rows",
        "RMSE of slip",
        "mean error",
        "true slip in the 90 % interval",
    ];

    /// The errors of each wheel, as rows of a table.
    pub(super) fn rows(&self) -> Vec<Vec<String>> {
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| rounded(v, 3));
        let row = |wheel: &SandWheel| {
            let numbers = [wheel.rmse, wheel.bias, wheel.coverage_90].map(number);
            let head = [wheel.name.clone(), wheel.moments.len().to_string()];
            head.into_iter().chain(numbers).collect()
        };
        self.wheels.iter().map(row).collect()
    }

    /// The same as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut table = Table::new().text("figure 13");
        for name in ["rows", "slip rmse", "bias", "in 90 %"] {
            table = table.number(name);
        }
        for row in self.rows() {
            table.row(row);
        }
        table.render()
    }

    /// Figure 13 in our definition of slip and in the paper's.
    #[must_use]
    pub fn figures(&self) -> [Figure; 2] {
        [Definition::Ours, Definition::Paper].map(|definition| self.draw(definition))
    }

    /// A panel for each wheel.
    fn draw(&self, definition: Definition) -> Figure {
        let words = match definition {
            Definition::Ours => "slip",
            Definition::Paper => "slip as section 4.1 of the paper words it",
        };
        let figure = Figure::new(format!(
            "Figure 13, simulated: {words} against time of each powered wheel, estimated with its 90 % interval, and true"
        ));
        self.wheels.iter().fold(figure, |figure, wheel| {
            figure.panel(panel(wheel, definition))
        })
    }

    /// A row for each wheel and time; what is not known is empty.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "time_s,wheel,slip,slip_low_90,slip_high_90,slip_true,paper_slip,paper_slip_low_90,paper_slip_high_90,paper_slip_true\n",
        );
        let cell = |value: Option<f64>| value.map(exact).unwrap_or_default();
        for wheel in &self.wheels {
            for moment in &wheel.moments {
                let [low, high] = moment.interval_90.map_or([None; 2], |ends| ends.map(Some));
                let ours = [Some(moment.slip), low, high, moment.truth];
                // the paper's definition falls as the slip rises
                let [slip, high, low, truth] = ours.map(|slip| slip.and_then(slip_as_worded));
                let cells: Vec<String> = ours
                    .into_iter()
                    .chain([slip, low, high, truth])
                    .map(cell)
                    .collect();
                let _ = writeln!(
                    text,
                    "{},{},{}",
                    exact(moment.time),
                    wheel.name,
                    cells.join(",")
                );
            }
        }
        text
    }

    pub(super) fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |run: &'a Self|
            "scenario" "scenario" = "scenario.toml";
            "seed" "seed" = run.seed;
            "wheels" "powered wheels" rows(SandWheel::fields()) = &run.wheels;
        }
    }
}

impl SandWheel {
    /// The wheel's errors for programs.
    #[must_use]
    pub fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |wheel: &'a Self|
            "wheel" "wheel" = wheel.name.as_str();
            "rows" "estimated slips" = wheel.moments.len();
            "slip_rmse" "root mean square error of its slip" = wheel.rmse;
            "slip_bias" "mean error of its slip" = wheel.bias;
            "coverage_90" "share of the 90 % intervals that contain the true slip" = wheel.coverage_90;
        }
    }
}

fn panel(wheel: &SandWheel, definition: Definition) -> Chart {
    let moments = || wheel.moments.iter();
    let ends = |moment: &SlipMoment| {
        let ends = moment.interval_90?.map(|end| definition.of(end));
        Some([ends[0]?, ends[1]?])
    };
    let all = moments().flat_map(|moment| {
        let [low, high] = ends(moment).map_or([None; 2], |ends| ends.map(Some));
        let truth = moment.truth.and_then(|slip| definition.of(slip));
        [definition.of(moment.slip), truth, low, high]
    });
    let (low, high) = all.flatten().fold((0.0_f64, 0.0_f64), |(low, high), slip| {
        (low.min(slip), high.max(slip))
    });
    let margin = 0.05 * (high - low).max(0.1);
    let end = wheel.moments.last().map_or(1.0, |moment| moment.time);
    let mut chart = Chart::new(
        Axis::new("Time (s)").range(0.0, end),
        Axis::new(format!("{}, {}", definition.axis(), plain(&wheel.name)))
            .range(low - margin, high + margin),
    );
    for group in wheel
        .moments
        .chunk_by(|a, b| ends(a).is_some() == ends(b).is_some())
    {
        let edge = |side: usize| {
            group
                .iter()
                .filter_map(move |m| Some([m.time, ends(m)?[side]]))
        };
        if group.len() > 1 && ends(&group[0]).is_some() {
            chart = chart.area(Area::between(edge(0), edge(1)).colour(Colour::BLUE, 0.25));
        }
    }
    let line = |of: fn(&SlipMoment) -> Option<f64>| {
        let shown = move |moment: &SlipMoment| {
            let slip = of(moment).and_then(|slip| definition.of(slip));
            [moment.time, slip.unwrap_or(f64::NAN)]
        };
        Curve::new(wheel.moments.iter().map(shown))
    };
    let solid = |colour, width| Style {
        width,
        ..Style::thin(colour, Dash::Solid)
    };
    chart
        .curve(
            line(|moment| moment.truth)
                .style(solid(Colour::RED, 1.2))
                .label("true"),
        )
        .curve(
            line(|moment| Some(moment.slip))
                .style(solid(Colour::BLUE, 0.7))
                .label("estimated"),
        )
}
