//! `validate` for programs.

use grouser_campaign::validate::{FitReport, Row, Validation};
use serde_json::Value;

use super::super::identify::text::plate_object;
use crate::report::Object;

/// The keys that DESIGN.md names, and the fits behind the rows.
pub(super) fn object(validation: &Validation) -> Object {
    Object::from_iter([
        (
            "rows".to_owned(),
            validation.rows.iter().map(row).collect::<Value>(),
        ),
        (
            "fits".to_owned(),
            validation.fits.iter().map(fit).collect::<Value>(),
        ),
        ("plates".to_owned(), plate_object(&validation.plates)),
    ])
}

fn row(row: &Row) -> Value {
    let score = &row.score;
    Value::Object(Object::from_iter(
        [
            ("data_set", Value::from(row.data_set)),
            ("wheel", Value::from(row.wheel)),
            ("slip_angle_deg", Value::from(row.slip_angle_deg)),
            ("quantity", Value::from(row.quantity.key())),
            ("unit", Value::from(row.quantity.unit())),
            ("model", Value::from(row.model.key())),
            ("fit", Value::from(row.fit)),
            ("split", Value::from(row.split.key())),
            ("n", Value::from(score.n)),
            ("bias", Value::from(score.bias)),
            ("rmse", Value::from(score.rmse)),
            ("q75", Value::from(score.q75)),
            ("q99", Value::from(score.q99)),
            ("max", Value::from(score.max)),
            ("fitted_parameters", Value::from(row.fitted_parameters)),
            ("published_rmse", Value::from(row.published_rmse)),
            ("scatter", Value::from(row.scatter)),
            ("hub_buried", Value::from(row.hub_buried)),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    ))
}

fn fit(fit: &FitReport) -> Value {
    let numbers = fit
        .found
        .iter()
        .map(|found| {
            let entry = Object::from_iter([
                (
                    "value".to_owned(),
                    Value::from(found.parameter.to_key_unit(found.value)),
                ),
                (
                    "standard_error".to_owned(),
                    Value::from(found.parameter.to_key_unit(found.standard_error)),
                ),
                ("verdict".to_owned(), Value::from(found.verdict.key())),
            ]);
            (found.parameter.key().to_owned(), Value::Object(entry))
        })
        .collect::<Object>();
    Value::Object(Object::from_iter([
        ("data_set".to_owned(), Value::from(fit.data_set)),
        ("model".to_owned(), Value::from(fit.model.key())),
        ("fit".to_owned(), Value::from(fit.fit)),
        ("status".to_owned(), Value::from(fit.status.key())),
        ("condition".to_owned(), Value::from(fit.condition)),
        ("parameters".to_owned(), Value::Object(numbers)),
    ]))
}
