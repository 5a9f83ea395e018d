//! How far the wheel tests lie from what the identified soil predicts.

use grouser_identify::WheelStage;
use grouser_identify::wheel::Quantity;

pub(super) fn unit_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pull | Quantity::Side => "n",
        Quantity::Torque => "nm",
        Quantity::Sinkage => "mm",
    }
}

/// Root mean square error of each quantity that was read, in its unit.
pub(super) fn errors(stage: &WheelStage) -> Vec<(Quantity, f64, usize)> {
    Quantity::ALL
        .into_iter()
        .filter_map(|quantity| {
            let errors: Vec<f64> = stage
                .tests
                .iter()
                .zip(&stage.said)
                .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
                .collect();
            let squares: f64 = errors.iter().map(|e| e * e).sum();
            let count = errors.len();
            (count > 0).then(|| {
                let rmse = (squares / count as f64).sqrt() / quantity.scale();
                (quantity, rmse, count)
            })
        })
        .collect()
}
