//! What `identify` found, as a list of fields.

use grouser_identify::plate::PlateFit;
use grouser_identify::wheel::LawScore;
use grouser_identify::{Identification, IdentifiedNumber, WheelStage};
use grouser_report::{Fields, fields};

use super::errors::{errors, unit_key};

pub(super) fn fields<'a>() -> Fields<'a, &'a Identification> {
    fields! { |found: &'a Identification|
        "plates" "what plate tests showed" group(plates()) = found.plates.as_ref().map(|stage| &stage.fit);
        "shear" "what shear tests showed" maybe_named(line()) =
            found.shear.as_ref().map(|stage| named(stage.fit.numbers()));
        "wheel" "what wheel tests showed" group(wheel()) = found.wheel.as_ref();
        "doubts" "why the result is doubtful" =
            found.doubts().iter().map(ToString::to_string).collect::<Vec<_>>();
        "single_test" "numbers whose intervals do not contain how tests of the same soil differ" =
            found.of_single_tests();
        "unloading" "readings of shear tests that were not used, since the box goes back" =
            found.shear.as_ref().map(|stage| stage.unloading);
        "copies" "readings that repeat others in every number and do not count again" = copies(found);
        "comparison" "sets of laws on tests that they were not fitted to" rows(score()) = &found.comparison;
        "missing" "numbers that neither tests nor the file give" = found.missing();
    }
}

fn copies(found: &Identification) -> usize {
    let plates = found.plates.as_ref().map_or(0, |stage| stage.copies);
    let shear = found.shear.as_ref().map_or(0, |stage| stage.copies);
    plates + shear + found.wheel.as_ref().map_or(0, |stage| stage.copies)
}

/// What plate tests showed.
pub(crate) fn plates<'a>() -> Fields<'a, &'a PlateFit> {
    fields! { |fit: &'a PlateFit|
        "n" "exponent of sinkage" = fit.n;
        "k_c_kn_per_m_n1" "cohesive modulus; null with plates of one width" =
            fit.is_separable().then_some(fit.k_c / 1e3);
        "k_phi_kn_per_m_n2" "frictional modulus" = fit.k_phi / 1e3;
        "left_out" "readings that were not used" = fit.left_out.count();
        "redundancy" "readings for each independent one" = fit.redundancy;
        "relative_deviation" "scatter about the law" = fit.relative_deviation;
        "parameters" "the numbers that were fitted" named(line()) = named(fit.numbers());
        "moduli" "k_c and k_phi with their uncertainty" named(line()) = named(fit.moduli_in_key_units());
    }
}

fn wheel<'a>() -> Fields<'a, &'a WheelStage> {
    fields! { |stage: &'a WheelStage|
        "status" "how the search ended" = stage.status.key();
        "tests" "tests" = stage.tests.len();
        "starts" "starts" = stage.starts;
        "reached" "starts that ended at the best point" = stage.reached;
        "redundancy" "readings for each independent one" = stage.redundancy;
        "condition" "condition number" = stage.condition;
        "parameters" "the numbers that were fitted" named(line()) = named(stage.in_key_units());
        "correlation" "correlation of the numbers" = stage.correlation.clone();
        "rmse" "root mean square error of each quantity" values = Some(errors(stage).into_iter().map(
            |(quantity, rmse, _)| (format!("{}_{}", quantity.key(), unit_key(quantity)), rmse)
        ));
    }
}

fn score<'a>() -> Fields<'a, &'a LawScore> {
    fields! { |score: &'a LawScore|
        "laws" "the laws" = score.laws;
        "left_out" "the tests that were left out of the fit" = score.left_out.clone();
        "tests" "how many" = score.tests;
        "rmse" "root mean square error of each quantity" values = Some(score.rmse.iter().map(|(quantity, rmse, _)| {
            (format!("{}_{}", quantity.key(), unit_key(*quantity)), rmse / quantity.scale())
        }));
    }
}

fn named(numbers: Vec<IdentifiedNumber>) -> impl Iterator<Item = (String, IdentifiedNumber)> {
    numbers.into_iter().map(|line| (line.name.clone(), line))
}

fn line<'a>() -> Fields<'a, IdentifiedNumber> {
    fields! { |line: IdentifiedNumber|
        "value" "value" = line.value;
        "standard_error" "standard error" = line.standard_error;
        "low" "lower end of the 95 % interval" = line.interval.low;
        "high" "its upper end" = line.interval.high;
        "verdict" "whether the tests determine the number" = line.verdict.key();
    }
}
