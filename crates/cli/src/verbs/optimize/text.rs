//! What `optimize` prints: the compromise, what binds it, the trade-off in words.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_design::{Answer, Design, Optimum, Task, Trade};

use grouser_report::number::{rounded, shown};
use grouser_report::{Layout, Table};

/// A share below this does not count in words.
const MIN_WORDED_SHARE: f64 = 1e-6;
/// Maximum number of optima that are listed.
const MAX_OPTIMA: usize = 20;
/// Maximum number of points of a front that are listed, in addition to the knee.
const POINTS_SHOWN: usize = 11;

pub(super) fn text(design: &Design, answer: &Answer) -> String {
    let mut text = String::new();
    if let Some(title) = &design.title {
        let _ = writeln!(text, "{title}");
    }
    match answer {
        Answer::Optimum(optimum) => of_optimum(&mut text, design, optimum),
        Answer::Trade(trade) => of_trade(&mut text, design, trade),
        _ => {}
    }
    text
}

fn of_optimum(text: &mut String, design: &Design, optimum: &Optimum) {
    let own = optimum
        .objectives
        .iter()
        .find(|(name, _)| *name == optimum.deciding);
    let _ = write!(
        text,
        "{}, {}: worst objective `{}` {}",
        design.task.name(),
        optimum.status.name().replace('_', " "),
        optimum.deciding,
        value(own.map_or(optimum.maximum, |(_, value)| *value))
    );
    if has_scales(design) {
        let _ = write!(text, " (utility with scales {})", value(optimum.utility));
    }
    text.push('\n');
    if let Some(gamma) = optimum.attainment {
        let meaning = if gamma <= 0.0 {
            "all goals reached"
        } else {
            "goals missed by γ × weight"
        };
        let _ = writeln!(text, "attainment factor γ {} ({meaning})", shown(gamma));
    }
    if optimum.starts.len() > 1 {
        of_starts(text, optimum);
    }
    text.push('\n');
    let mut table = Table::new()
        .text("variable")
        .number("value")
        .text("unit")
        .text("active bound");
    for (i, variable) in design.variables.iter().enumerate() {
        let (lower, upper) = optimum.bound_multipliers[i];
        let held = match (lower > 0.0, upper > 0.0) {
            (true, _) => format!("lower bound {}", shown(variable.lower)),
            (_, true) => format!("upper bound {}", shown(variable.upper)),
            _ => String::new(),
        };
        table.row([
            variable.name.as_str(),
            &shown(optimum.x[i]),
            &design.units[i],
            &held,
        ]);
    }
    text.push_str(&table.render());
    text.push('\n');
    let mut table = Table::new()
        .text("objective")
        .number("value")
        .number("multiplier");
    for ((name, value), (_, share)) in optimum
        .objectives
        .iter()
        .zip(&optimum.objective_multipliers)
    {
        table.row([name.as_str(), &self::value(*value), &shown(*share)]);
    }
    text.push_str(&table.render());
    if !optimum.constraint_multipliers.is_empty() {
        text.push('\n');
        let mut table = Table::new()
            .text("constraint")
            .number("multiplier")
            .text("");
        for (name, price) in &optimum.constraint_multipliers {
            let (own, world) = name.split_once(" @ ").unwrap_or((name, ""));
            let mut listed = design.constraint_name(own);
            if !world.is_empty() {
                listed = format!("{listed} @ {world}");
            }
            let binds = optimum.active.contains(&listed);
            table.row([
                name.as_str(),
                &shown(*price),
                if binds { "active" } else { "" },
            ]);
        }
        text.push_str(&table.render());
    }
    for line in trade_off(optimum) {
        let _ = writeln!(text, "{line}");
    }
    if Layout::current().details || optimum.optima.len() > 1 {
        optima(text, design, optimum);
    }
    if Layout::current().details {
        let counts = &optimum.counts;
        let _ = writeln!(
            text,
            "{} iterations, {} evaluations, {} with derivatives",
            counts.iterations, counts.values, counts.jacobians
        );
    }
}

/// First-order exchange between the objectives that carry weight: Σ λ_i s_i df_i = 0 along the front.
fn trade_off(optimum: &Optimum) -> Vec<String> {
    if !optimum.status.is_solved() {
        return Vec::new();
    }
    let held: Vec<(&str, f64, f64)> = optimum
        .objectives
        .iter()
        .zip(&optimum.objective_multipliers)
        .zip(&optimum.objective_scales)
        .filter(|((_, (_, share)), _)| *share > MIN_WORDED_SHARE)
        .map(|(((name, f), (_, share)), scale)| (name.as_str(), *f, share * scale.abs()))
        .collect();
    let Some((first, rest)) = held.split_first() else {
        return Vec::new();
    };
    if rest.is_empty() {
        return vec![format!("`{}` alone decides", first.0)];
    }
    let mut lines = vec!["The trade-off here, to first order:".to_owned()];
    lines.extend(rest.iter().map(|other| exchange(*first, *other)));
    lines
}

/// An objective with its value and what one unit of it is worth.
type Priced<'n> = (&'n str, f64, f64);

/// What it costs to be better in the first objective: price_1 df_1 + price_2 df_2 = 0. In per cent of the
/// values, unless one of them is as good as nothing.
fn exchange((one, f, price): Priced<'_>, (two, g, other): Priced<'_>) -> String {
    const MIN_COMPARED_VALUE: f64 = 1e-6;
    let size = f.abs().max(g.abs()).max(1.0);
    if f.abs().min(g.abs()) > MIN_COMPARED_VALUE * size {
        let cost = price * f.abs() / (other * g.abs());
        format!(
            "  1 % better `{one}` costs {} % of `{two}`",
            rounded(cost, 2)
        )
    } else {
        let cost = price / other;
        format!(
            "  1 less of `{one}` costs {} more of `{two}`",
            rounded(cost, 2)
        )
    }
}

/// Does the solver compare other numbers than those that are shown?
fn has_scales(design: &Design) -> bool {
    let mut scales = design.objectives.iter().map(|objective| objective.scale);
    scales.any(|scale| (scale - 1.0).abs() > 0.0)
}

/// A number, or that there is none.
fn value(value: f64) -> String {
    if value.is_nan() {
        "no value".to_owned()
    } else {
        shown(value)
    }
}

/// Do the starts agree?
fn of_starts(text: &mut String, optimum: &Optimum) {
    let all = optimum.starts.len();
    let solved = optimum
        .starts
        .iter()
        .filter(|s| s.status.is_solved())
        .count();
    let agreement = match optimum.optima.len() {
        0 => String::new(),
        1 if solved == all => ": all starts agree".to_owned(),
        1 => ": they agree".to_owned(),
        several => format!(": {several} different optima"),
    };
    let _ = writeln!(text, "{solved} of {all} starts solved{agreement}");
}

/// The different optima that the starts led to.
fn optima(text: &mut String, design: &Design, optimum: &Optimum) {
    text.push('\n');
    let mut table = Table::new().number("worst objective");
    let is_scaled = has_scales(design);
    if is_scaled {
        table = table.number("utility");
    }
    table = table.number("starts");
    for variable in &design.variables {
        table = table.number(&variable.name);
    }
    for (start, count) in optimum.optima.iter().take(MAX_OPTIMA) {
        let found = &optimum.starts[*start];
        let mut cells = vec![value(found.maximum)];
        cells.extend(is_scaled.then(|| value(found.utility)));
        cells.push(count.to_string());
        cells.extend(found.x.iter().map(|x| shown(*x)));
        table.row(cells);
    }
    text.push_str(&table.render());
    if optimum.optima.len() > MAX_OPTIMA {
        let _ = writeln!(text, "and {} more", optimum.optima.len() - MAX_OPTIMA);
    }
}

fn of_trade(text: &mut String, design: &Design, trade: &Trade) {
    debug_assert_eq!(design.task, Task::Pareto);
    let exact = trade
        .points
        .iter()
        .filter(|p| p.multipliers.is_some())
        .count();
    let _ = writeln!(
        text,
        "pareto: {} points, {exact} of them converged to full accuracy",
        trade.points.len()
    );
    if Layout::current().details {
        let counts = &trade.counts;
        let _ = writeln!(
            text,
            "{} evaluations, {} with derivatives",
            counts.values, counts.jacobians
        );
    }
    text.push('\n');
    let mut table = Table::new().text("");
    for objective in &design.objectives {
        table = table.number(&objective.name);
    }
    for variable in &design.variables {
        table = table.number(&variable.name);
    }
    // The ends, some points between, and the knee.
    let n = trade.points.len();
    let mut places: Vec<usize> = (0..POINTS_SHOWN.min(n))
        .map(|i| i * n.saturating_sub(1) / (POINTS_SHOWN.min(n) - 1).max(1))
        .collect();
    places.extend(trade.knee);
    places.sort_unstable();
    places.dedup();
    for place in places {
        let point = &trade.points[place];
        let mut cells = vec![if trade.knee == Some(place) {
            "best trade-off".to_owned()
        } else {
            String::new()
        }];
        cells.extend(point.objectives.iter().chain(&point.x).map(|v| shown(*v)));
        table.row(cells);
    }
    text.push_str(&table.render());
    if let Some(knee) = trade.knee {
        text.push_str(&at_knee(design, trade, knee));
    }
}

/// The trade-off at the knee, from the multipliers of its polishing solve.
fn at_knee(design: &Design, trade: &Trade, knee: usize) -> String {
    let point = &trade.points[knee];
    let Some(shares) = &point.multipliers else {
        return String::new();
    };
    let rates: Vec<(&str, f64, f64)> = (0..design.objectives.len())
        .filter(|&i| shares[i] > MIN_WORDED_SHARE)
        .map(|i| {
            let objective = &design.objectives[i];
            (
                objective.name.as_str(),
                point.objectives[i],
                shares[i] * objective.scale,
            )
        })
        .collect();
    let mut text = String::new();
    if let Some((first, rest)) = rates.split_first() {
        text.push_str("The exchange at the best trade-off (knee point), to first order:\n");
        for other in rest {
            let _ = writeln!(text, "{}", exchange(*first, *other));
        }
    }
    text
}
