//! How far the wheel tests lie from what the identified soil predicts.

use grouser_identify::WheelStage;
use grouser_identify::wheel::{Quantity, rmse};

pub(super) fn unit_key(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Pull | Quantity::Side => "n",
        Quantity::Torque => "nm",
        Quantity::Sinkage => "mm",
    }
}

/// Root mean square error of each quantity that was read, in its unit.
pub(super) fn errors(stage: &WheelStage) -> Vec<(Quantity, f64, usize)> {
    let all = rmse(stage.tests.iter().zip(&stage.said));
    all.into_iter()
        .map(|(quantity, rmse, count)| (quantity, rmse / quantity.scale(), count))
        .collect()
}
