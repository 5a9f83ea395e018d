//! `validate` for people.

use std::fmt::Write as _;

use super::rows::{Row, Validation};

use grouser_report::number::{rounded, shown};
use grouser_report::{Layout, Table};

impl Validation {
    /// The tables and the fits behind them, for people.
    #[must_use]
    pub fn text(&self) -> String {
        text(self)
    }
}

fn text(validation: &Validation) -> String {
    let mut out = String::new();
    let plates = &validation.plates;
    let _ = writeln!(
        out,
        "errors of {} models on {} sets of measured wheels; each is named with the slip angles of its fit; -v prints quantiles and fitted numbers",
        validation.fits.len(),
        groups(&validation.rows).len()
    );
    let _ = writeln!(
        out,
        "plates: n {}, k_c {} kN/m^(n+1), k_phi {} kN/m^(n+2) ({} numbers)",
        rounded(plates.n, 4),
        rounded(plates.k_c / 1e3, 4),
        rounded(plates.k_phi / 1e3, 4),
        plates.parameters.len(),
    );
    for (data_set, wheel) in groups(&validation.rows) {
        let rows = validation
            .rows
            .iter()
            .filter(|row| row.data_set == data_set && row.wheel == wheel);
        let _ = writeln!(out, "\n{data_set}, {wheel} wheel");
        out.push_str(&table(rows));
    }
    for fit in validation.fits.iter().filter(|_| Layout::current().details) {
        let _ = writeln!(
            out,
            "\n{} on {}: {}",
            title(fit.model.key(), fit.fit),
            fit.data_set,
            fit.status.key()
        );
        let mut table = Table::new()
            .text("number")
            .number("value")
            .number("± std. error")
            .text("");
        for found in &fit.found {
            let in_unit = |value| rounded(found.parameter.to_key_unit(value), 3);
            let error = if found.standard_error.is_nan() {
                String::new()
            } else {
                in_unit(found.standard_error)
            };
            table.row([
                found.parameter.key().to_owned(),
                in_unit(found.value),
                error,
                found.verdict.key().to_owned(),
            ]);
        }
        out.push_str(&table.render());
    }
    out
}

/// Data sets and wheels in their order.
fn groups(rows: &[Row]) -> Vec<(&'static str, &'static str)> {
    let mut list = Vec::new();
    for row in rows {
        if !list.contains(&(row.data_set, row.wheel)) {
            list.push((row.data_set, row.wheel));
        }
    }
    list
}

fn table<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let mut table = Table::new().number("β deg");
    for header in ["slips", "quantity", "model", "split"] {
        table = table.text(header);
    }
    let headers = if Layout::current().details {
        "n,bias,RMSE,q75,q99,max,numbers,published,repeats,hub buried"
    } else {
        "n,bias,RMSE"
    };
    for header in headers.split(',') {
        table = table.number(header);
    }
    let or_nothing = |value: Option<f64>| value.map(|v| rounded(v, 3)).unwrap_or_default();
    for row in rows {
        let score = &row.score;
        let cells = [
            shown(row.slip_angle_deg),
            row.slips.key().to_owned(),
            format!("{} {}", row.quantity.key(), row.quantity.unit()),
            title(row.model.key(), row.fit),
            row.split.key().to_owned(),
            score.n.to_string(),
            // an offset that was fitted leaves rounding only
            if score.bias.abs() < 1e-6 * score.rmse {
                "0".to_owned()
            } else {
                rounded(score.bias, 2)
            },
            rounded(score.rmse, 3),
            rounded(score.q75, 3),
            rounded(score.q99, 3),
            rounded(score.max, 3),
            row.fitted_parameters.to_string(),
            or_nothing(row.published_rmse),
            or_nothing(row.scatter),
            row.hub_buried.to_string(),
        ];
        // β, slips, quantity, model, split, then the numbers
        table.row(cells.into_iter().take(5 + headers.split(',').count()));
    }
    table.render()
}

/// A model and the slip angles on which it is fitted.
fn title(model: &str, fit: &str) -> String {
    let angles = fit.trim_start_matches("slip angle").trim_start_matches('s');
    match fit {
        "nothing" => model.to_owned(),
        _ => format!("{model},{}", angles.replace(" and ", "+")),
    }
}
