//! `validate` for programs.

use grouser_campaign::validate::{FitReport, Found, Row, Validation};
use grouser_report::{Fields, fields};

use crate::verbs::identify::object::plates;

/// The keys that DESIGN.md names, and the fits behind the rows.
pub(super) fn fields<'a>() -> Fields<'a, &'a Validation> {
    fields! { |validation: &'a Validation|
        "rows" "errors by data set, wheel, quantity and model" rows(row()) = &validation.rows;
        "fits" "the fits behind the rows" rows(fit()) = &validation.fits;
        "plates" "what plate tests showed" group(plates()) = &validation.plates;
    }
}

pub(super) fn row<'a>() -> Fields<'a, &'a Row> {
    fields! { |row: &'a Row|
        "data_set" "data set" = row.data_set;
        "wheel" "wheel" = row.wheel;
        "slip_angle_deg" "slip angle" = row.slip_angle_deg;
        "slips" "which slips: steady (at most 0.75), spinning or locked" = row.slips.key();
        "quantity" "quantity" = row.quantity.key();
        "unit" "its unit" = row.quantity.unit();
        "model" "model" = row.model.key();
        "fit" "what its numbers are fitted on" = row.fit;
        "split" "fitted or predicted" = row.split.key();
        "n" "readings" = row.score.n;
        "bias" "mean error" = row.score.bias;
        "rmse" "root mean square error" = row.score.rmse;
        "q75" "75th percentile of the absolute error" = row.score.q75;
        "q99" "99th percentile of the absolute error" = row.score.q99;
        "max" "maximum absolute error" = row.score.max;
        "fitted_parameters" "numbers that were fitted" = row.fitted_parameters;
        "published_rmse" "error that was published with the data" = row.published_rmse;
        "scatter" "scatter of repeated tests" = row.scatter;
        "hub_buried" "readings that the model cannot reach: the hub is buried" = row.hub_buried;
    }
}

fn fit<'a>() -> Fields<'a, &'a FitReport> {
    let number = fields! { |found: &'a Found|
        "value" "value" = found.parameter.to_key_unit(found.value);
        "standard_error" "standard error" = found.parameter.to_key_unit(found.standard_error);
        "verdict" "whether the tests determine the number" = found.verdict.key();
    };
    fields! { |fit: &'a FitReport|
        "data_set" "data set" = fit.data_set;
        "model" "model" = fit.model.key();
        "fit" "what its numbers are fitted on" = fit.fit;
        "status" "how the search ended" = fit.status.key();
        "condition" "condition number" = fit.condition;
        "parameters" "the numbers that were fitted" named(number) =
            fit.found.iter().map(|found| (found.parameter.key(), found));
    }
}
