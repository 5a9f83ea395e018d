//! What was learnt of a soil, with the keys of the command's `soil`.

use grouser_slip::onboard::{SoilEstimate, SoilInterval};
use serde_json::{Value, json};

/// The numbers that the page shows; null where nothing was learnt.
pub(super) fn soil(learnt: Option<&SoilEstimate>) -> Value {
    let Some(soil) = learnt else {
        return Value::Null;
    };
    let SoilInterval {
        mean, low, high, ..
    } = soil.friction_angle;
    json!({
        "strength": soil.strength.mean,
        "strength_low": soil.strength.low,
        "strength_high": soil.strength.high,
        "stiffness": soil.stiffness.mean,
        "stiffness_low": soil.stiffness.low,
        "stiffness_high": soil.stiffness.high,
        "phi_deg": mean.to_degrees(),
        "phi_low_deg": low.to_degrees(),
        "phi_high_deg": high.to_degrees(),
        "readings": soil.readings,
        "contact_readings": soil.contact_readings,
        "changes": soil.changes,
    })
}
