//! The soil that the robot's computer has learnt, as an object and as text.

use std::fmt::Write as _;

use grouser_report::{Fields, fields};
use grouser_slip::onboard::{SoilEstimate, SoilInterval};

use super::run::Run;

pub(super) fn soil<'a>() -> Fields<'a, &'a SoilEstimate> {
    fields! { |soil: &'a SoilEstimate|
        "strength" "cohesion and tan φ as multiples of the known soil's, mean" = soil.strength.mean;
        "strength_low" "lower end of its 90 % interval" = soil.strength.low;
        "strength_high" "upper end" = soil.strength.high;
        "stiffness" "pressure-sinkage moduli as multiples of the known soil's, mean" = soil.stiffness.mean;
        "stiffness_low" "lower end of its 90 % interval" = soil.stiffness.low;
        "stiffness_high" "upper end" = soil.stiffness.high;
        "phi_deg" "angle of internal friction, mean" = soil.friction_angle.mean.to_degrees();
        "phi_low_deg" "lower end of its 90 % interval" = soil.friction_angle.low.to_degrees();
        "phi_high_deg" "upper end" = soil.friction_angle.high.to_degrees();
        "readings" "readings that were learnt from" = soil.readings;
        "contact_readings" "readings that had a sinkage or an entry angle" = soil.contact_readings;
        "contacts_refused" "sinkages and entry angles that no wheel can have" = soil.contacts_refused;
        "contacts_stuck" "readings left out because a wheel's sensor repeated itself" = soil.contacts_stuck;
        "changes" "changes of the belief in use" = soil.changes;
        "interval_scale" "width of the intervals of the pull over the computed one" = soil.error_scale;
    }
}

/// A line for each run that learnt.
pub(super) fn text(runs: &[Run], out: &mut String) {
    for run in runs {
        let Some(soil) = &run.result.soil else {
            continue;
        };
        let interval = |of: SoilInterval, digits: usize| {
            format!(
                "{:.digits$} [{:.digits$}, {:.digits$}]",
                of.mean, of.low, of.high
            )
        };
        let SoilInterval {
            mean, low, high, ..
        } = soil.friction_angle;
        // writing to a string cannot fail
        let _ = writeln!(
            out,
            "\nseed {}: soil learnt from {} readings, {} changes of belief: strength {} and stiffness {} of the known soil, \
             friction angle {:.1}° [{:.1}°, {:.1}°]; 90 % intervals within soils of this kind",
            run.seed,
            soil.readings,
            soil.changes,
            interval(soil.strength, 2),
            interval(soil.stiffness, 2),
            mean.to_degrees(),
            low.to_degrees(),
            high.to_degrees()
        );
    }
}
