//! The table of `optimize` as CSV: the front, or every start.

use grouser_design::{Answer, Design};
use grouser_log::csv::quoted;
use grouser_report::number::exact;

/// Columns: the variables, then the objectives (a front) or `max` and `status` (starts).
pub(super) fn csv(design: &Design, answer: &Answer) -> String {
    let quoted = |name: &str| quoted(name).into_owned();
    let mut header: Vec<String> = design.variables.iter().map(|v| quoted(&v.name)).collect();
    let mut text = String::new();
    let mut line = |cells: &[String]| {
        text.push_str(&cells.join(","));
        text.push('\n');
    };
    match answer {
        Answer::Trade(trade) => {
            header.extend(design.objectives.iter().map(|o| quoted(&o.name)));
            header.push("knee".to_owned());
            line(&header);
            for (index, point) in trade.points.iter().enumerate() {
                let mut cells: Vec<String> = point
                    .x
                    .iter()
                    .chain(&point.objectives)
                    .map(|v| number(*v))
                    .collect();
                cells.push((trade.knee == Some(index)).to_string());
                line(&cells);
            }
        }
        Answer::Optimum(optimum) => {
            header.extend(["max".to_owned(), "status".to_owned()]);
            line(&header);
            for start in &optimum.starts {
                let mut cells: Vec<String> = start.x.iter().map(|v| number(*v)).collect();
                cells.push(number(start.maximum));
                cells.push(start.status.name().to_owned());
                line(&cells);
            }
        }
        _ => {}
    }
    text
}

/// Seventeen digits; empty for what does not exist.
fn number(value: f64) -> String {
    if value.is_finite() {
        exact(value)
    } else {
        String::new()
    }
}
