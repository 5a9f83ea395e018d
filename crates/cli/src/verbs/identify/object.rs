//! What `identify` found, as a list of fields.

use grouser_identify::plate::PlateFit;
use grouser_identify::{Identification, WheelStage};
use grouser_report::{Fields, fields};

use super::lines::{Line, errors, plate_lines, shear_lines, unit_key, wheel_lines};

pub(super) fn fields<'a>() -> Fields<'a, &'a Identification> {
    fields! { |found: &'a Identification|
        "plates" "what plate tests showed" group(plates()) = found.plates.as_ref().map(|stage| &stage.fit);
        "shear" "what shear tests showed" maybe_named(line()) =
            found.shear.as_ref().map(|_| named(shear_lines(found)));
        "wheel" "what wheel tests showed" group(wheel()) = found.wheel.as_ref();
        "missing" "numbers that neither tests nor the file give" = found.missing();
    }
}

/// What plate tests showed.
pub(crate) fn plates<'a>() -> Fields<'a, &'a PlateFit> {
    fields! { |fit: &'a PlateFit|
        "n" "exponent of sinkage" = fit.n;
        "k_c_kn_per_m_n1" "cohesive modulus" = fit.k_c / 1e3;
        "k_phi_kn_per_m_n2" "frictional modulus" = fit.k_phi / 1e3;
        "redundancy" "readings for each independent one" = fit.redundancy;
        "relative_deviation" "scatter about the law" = fit.relative_deviation;
        "parameters" "the numbers that were fitted" named(line()) = named(plate_lines(fit));
    }
}

fn wheel<'a>() -> Fields<'a, &'a WheelStage> {
    fields! { |stage: &'a WheelStage|
        "status" "how the search ended" = stage.status.key();
        "tests" "tests" = stage.tests.len();
        "starts" "starts" = stage.starts;
        "reached" "starts that ended at the best point" = stage.reached;
        "condition" "condition number" = stage.condition;
        "parameters" "the numbers that were fitted" named(line()) = named(wheel_lines(stage));
        "correlation" "correlation of the numbers" = stage.correlation.clone();
        "rmse" "root mean square error of each quantity" values = Some(errors(stage).into_iter().map(
            |(quantity, rmse, _)| (format!("{}_{}", quantity.key(), unit_key(quantity)), rmse)
        ));
    }
}

fn named(lines: Vec<Line>) -> impl Iterator<Item = (String, Line)> {
    lines.into_iter().map(|line| (line.name.clone(), line))
}

fn line<'a>() -> Fields<'a, Line> {
    fields! { |line: Line|
        "value" "value" = line.value;
        "standard_error" "standard error" = line.standard_error;
        "low" "lower end of the 95 % interval" = line.interval.low;
        "high" "its upper end" = line.interval.high;
        "verdict" "whether the tests determine the number" = line.verdict.key();
    }
}
