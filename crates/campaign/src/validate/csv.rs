//! `validate` as a table.

use std::fmt::Write as _;

use super::rows::Validation;

use grouser_report::number::exact;

impl Validation {
    /// The table: one line a row; what does not exist is empty.
    #[must_use]
    pub fn csv(&self) -> String {
        csv(self)
    }
}

fn csv(validation: &Validation) -> String {
    let mut out = String::from(
        "data_set,wheel,slip_angle_deg,slips,quantity,unit,model,fit,split,n,bias,rmse,q75,q99,max,\
         fitted_parameters,published_rmse,scatter,hub_buried\n",
    );
    let optional = |value: Option<f64>| value.map(exact).unwrap_or_default();
    for row in &validation.rows {
        let score = &row.score;
        // writing to a string cannot fail
        let _ = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            row.data_set,
            row.wheel,
            exact(row.slip_angle_deg),
            row.slips.key(),
            row.quantity.key(),
            row.quantity.unit(),
            row.model.key(),
            row.fit,
            row.split.key(),
            score.n,
            exact(score.bias),
            exact(score.rmse),
            exact(score.q75),
            exact(score.q99),
            exact(score.max),
            row.fitted_parameters,
            optional(row.published_rmse),
            optional(row.scatter),
            row.hub_buried,
        );
    }
    out
}
