//! The figure of `estimate`: slip against time, one panel a wheel, with its sigma as a band.

use grouser_files::robot::RobotFile;
use grouser_replay::{Row, Summary};
use grouser_slip::{Degraded, Health, Invalid};

use grouser_figure::{Area, Axis, Chart, Colour, Curve, Dash, Figure, Rule, Style, plain};

/// At most this many stretches of time are kept of a wheel: more than a figure has columns.
const STRETCHES: usize = 4096;

/// Slip against time in fixed memory: of each stretch of time the least and the greatest slip. When
/// there are too many stretches, two become one.
#[derive(Debug)]
pub(super) struct Trace {
    stretches: Vec<Stretch>,
    seconds: f64,
}

impl Default for Trace {
    fn default() -> Self {
        Self {
            stretches: Vec::new(),
            seconds: 0.001,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Stretch {
    index: f64,
    time: f64,
    /// Least and greatest, the earlier one first; `None` without slip.
    slips: Option<[f64; 2]>,
    sigma: f64,
    /// Did nothing measure the robot's speed at some time in it?
    is_unreferenced: bool,
}

impl Trace {
    /// One value more, later than all before.
    pub(super) fn add(&mut self, row: &Row<'_>) {
        let (time, slip, sigma) = (row.time_s, row.slip, row.slip_sigma);
        let new = Stretch {
            index: (time / self.seconds).floor(),
            time,
            slips: slip.map(|slip| [slip, slip]),
            sigma: sigma.unwrap_or(0.0),
            is_unreferenced: matches!(
                row.health,
                Health::Degraded(Degraded::ReferenceLost | Degraded::Relative)
                    | Health::Invalid(Invalid::NoReference)
            ),
        };
        match self.stretches.last_mut() {
            Some(last) if last.index == new.index => last.join(new),
            _ => self.stretches.push(new),
        }
        if self.stretches.len() > STRETCHES {
            self.seconds *= 2.0;
            let old = std::mem::take(&mut self.stretches);
            for mut stretch in old {
                stretch.index = (stretch.time / self.seconds).floor();
                match self.stretches.last_mut() {
                    Some(last) if last.index == stretch.index => last.join(stretch),
                    _ => self.stretches.push(stretch),
                }
            }
        }
    }

    /// The line; NaN breaks it where there is no slip.
    fn line(&self) -> Vec<[f64; 2]> {
        let mut line = Vec::new();
        for stretch in &self.stretches {
            match stretch.slips {
                Some([first, second]) => {
                    line.push([stretch.time, first]);
                    if first != second {
                        line.push([stretch.time, second]);
                    }
                }
                None => line.push([stretch.time, f64::NAN]),
            }
        }
        line
    }

    /// Spans in which nothing measured the robot's speed, s.
    fn unreferenced(&self) -> impl Iterator<Item = (f64, f64)> {
        let groups = self
            .stretches
            .chunk_by(|a, b| a.is_unreferenced == b.is_unreferenced);
        groups
            .filter(|group| group[0].is_unreferenced)
            .filter_map(|group| Some((group.first()?.time, group.last()?.time)))
            .filter(|(from, to)| to > from)
    }

    /// Bands of one sigma around stretches without a break.
    fn bands(&self) -> Vec<Area> {
        let groups = self
            .stretches
            .chunk_by(|a, b| a.slips.is_some() == b.slips.is_some());
        groups
            .filter(|group| group.len() > 1 && group[0].slips.is_some())
            .map(|group| {
                let edge = |sign: f64| {
                    group.iter().filter_map(move |stretch| {
                        let [a, b] = stretch.slips?;
                        let middle = if sign < 0.0 { a.min(b) } else { a.max(b) };
                        let limited = (middle + sign * stretch.sigma).clamp(-1.0, 1.0);
                        Some([stretch.time, limited])
                    })
                };
                Area::between(edge(-1.0), edge(1.0))
            })
            .collect()
    }

    fn range(&self) -> Option<[f64; 2]> {
        let slips = self.stretches.iter().filter_map(|stretch| stretch.slips);
        slips
            .map(|[a, b]| [a.min(b), a.max(b)])
            .reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
    }
}

impl Stretch {
    fn join(&mut self, later: Self) {
        self.slips = match (self.slips, later.slips) {
            (Some([a, b]), Some([c, d])) => {
                let (low, high) = (a.min(b).min(c).min(d), a.max(b).max(c).max(d));
                // What was there first stays first.
                Some(if a <= c { [low, high] } else { [high, low] })
            }
            (one, other) => one.or(other),
        };
        self.sigma = self.sigma.max(later.sigma);
        self.is_unreferenced |= later.is_unreferenced;
    }
}

/// Draws every wheel that has a slip, all to one scale.
///
/// Spans in which nothing measured the robot's speed have a grey ground; `truths` are the true slips by wheel, drawn dashed.
pub(super) fn draw(
    robot: &RobotFile,
    summary: &Summary,
    traces: &[Trace],
    truths: &[(String, Vec<[f64; 2]>)],
) -> Figure {
    let description = format!("Slip against time of {}", robot.robot.name());
    let of_truth = |(_, line): &(String, Vec<[f64; 2]>)| {
        let slips = line.iter().map(|point| [point[1], point[1]]);
        slips.reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
    };
    let [low, high] = traces
        .iter()
        .filter_map(Trace::range)
        .chain(truths.iter().filter_map(of_truth))
        .reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])
        .unwrap_or([0.0, 1.0]);
    let low = (low.min(0.0) * 10.0 - 0.2).floor() / 10.0;
    let high = (high.max(0.1) * 10.0 + 0.2).ceil() / 10.0;
    let start = traces
        .iter()
        .filter_map(|trace| trace.stretches.first())
        .map(|s| s.time);
    let start = start.fold(f64::INFINITY, f64::min);
    let end = traces
        .iter()
        .filter_map(|trace| trace.stretches.last())
        .map(|s| s.time);
    let end = end.fold(f64::NEG_INFINITY, f64::max);
    let mut figure = Figure::new(description);
    for (index, (wheel, trace)) in summary.wheels.iter().zip(traces).enumerate() {
        if trace.range().is_none() {
            continue;
        }
        let style = Style::numbered(index);
        let solid = Style {
            dash: Dash::Solid,
            width: 0.9,
            ..style
        };
        let mut chart = Chart::new(
            Axis::new("Time (s)").range(start, end.max(start + 1e-3)),
            Axis::new(format!("Slip *s*, {}", plain(&wheel.name)))
                .range(low.max(-1.0), high.min(1.0)),
        );
        for (from, to) in trace.unreferenced() {
            chart = chart.area(Area::columns(from, to).colour(Colour::INK, 0.1));
        }
        for band in trace.bands() {
            chart = chart.area(band.colour(style.colour, 0.18));
        }
        chart = chart.curve(Curve::new(trace.line()).style(solid));
        if let Some((_, truth)) = truths.iter().find(|(name, _)| *name == wheel.name) {
            let inside = truth
                .iter()
                .copied()
                .filter(|point| point[0] >= start && point[0] <= end);
            let dashed = Style::thin(Colour::INK, Dash::Dotted);
            chart = chart.curve(Curve::new(inside).style(dashed).label("truth"));
        }
        // At zero it would lie on the axis' own line.
        if let Some(median) = wheel.slip.median.filter(|m| m.abs() > 0.02 * (high - low)) {
            let dashed = Style::thin(Colour::INK, Dash::Dashed);
            chart = chart.rule(
                Rule::at_y(median)
                    .style(dashed)
                    .label(format!("median {median:.3}")),
            );
        }
        figure = figure.panel(chart);
    }
    figure
}
