//! A soil that was learnt, as an object and as text.

use grouser_report::{Fields, fields};
use grouser_slip::onboard::{SoilEstimate, SoilInterval};

pub(crate) fn soil<'a>() -> Fields<'a, &'a SoilEstimate> {
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

/// What was learnt in a sentence.
pub(crate) fn words(soil: &SoilEstimate) -> String {
    let interval = |of: SoilInterval, digits: usize| {
        format!(
            "{:.digits$} [{:.digits$}, {:.digits$}]",
            of.mean, of.low, of.high
        )
    };
    let SoilInterval {
        mean, low, high, ..
    } = soil.friction_angle;
    let contacts = match (
        soil.contact_readings,
        soil.contacts_refused,
        soil.contacts_stuck,
    ) {
        (0, 0, 0) => String::new(),
        (used, 0, 0) => format!(" ({used} with sinkages)"),
        (used, refused, stuck) => format!(
            " ({used} with sinkages; {refused} values refused, {stuck} readings of stuck sensors left out)"
        ),
    };
    let learnt = match soil.readings {
        0 => format!("nothing learnt about the soil (no usable reading){contacts}; assumed"),
        readings => format!(
            "soil learnt from {readings} readings{contacts}, {} changes of belief",
            soil.changes
        ),
    };
    format!(
        "{learnt}: strength {} and stiffness {} times the known soil's, \
         friction angle {:.1}° [{:.1}°, {:.1}°]\n90 % intervals for soils of the known kind; on other soils half of them held",
        interval(soil.strength, 2),
        interval(soil.stiffness, 2),
        mean.to_degrees(),
        low.to_degrees(),
        high.to_degrees()
    )
}
