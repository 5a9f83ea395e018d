//! `identify` for people and for programs.

use std::fmt::Write as _;

use grouser_identify::least_squares::Verdict;
use grouser_identify::wheel::LawScore;
use grouser_identify::{Identification, IdentifiedNumber, WheelStage};

use super::errors::errors;
use grouser_report::number::{rounded, shown};
use grouser_report::{Layout, Table};

/// What was found: the numbers in one table, then what restricts them.
pub(super) fn text(found: &Identification) -> String {
    let numbers = numbers(found);
    let counts = [
        (found.plates.as_ref().map(|stage| stage.fit.count), "plate"),
        (found.shear.as_ref().map(|stage| stage.fit.tests), "shear"),
        (found.wheel.as_ref().map(|stage| stage.tests.len()), "wheel"),
    ];
    let counts = counts
        .iter()
        .filter_map(|(count, name)| Some(format!("{} {name}", (*count)?)));
    let identified = numbers
        .iter()
        .filter(|line| line.verdict == Verdict::Identified);
    let mut out = format!(
        "{} of {} numbers of the soil identified from tests: {}\n",
        identified.count(),
        numbers.len(),
        counts.collect::<Vec<_>>().join(", ")
    );
    let doubts = found.doubts();
    out.extend(doubts.iter().map(|doubt| format!("WARNING: {doubt}\n")));
    let _ = writeln!(out, "\n{}", table(&numbers));
    let single = found.of_single_tests();
    if !single.is_empty() {
        let _ = writeln!(
            out,
            "NOTE: the intervals of {} do not contain the between-test variation, since one test alone determines them: repeat \
             the tests on other spots",
            single.join(", ")
        );
    }
    if let Some(stage) = found
        .plates
        .as_ref()
        .filter(|stage| !stage.fit.is_separable())
    {
        let widths = stage.tests.iter().map(|test| test.plate.width);
        let _ = writeln!(
            out,
            "NOTE: plates of one width (b = {} mm) do not separate k_c from k_phi, which hold for wheels of this width only",
            shown(1e3 * widths.fold(0.0, f64::max))
        );
    }
    if let Some(stage) = &found.wheel {
        let errors = errors(stage).into_iter().map(|(quantity, rmse, _)| {
            format!("{} {} {}", quantity.key(), shown(rmse), quantity.unit())
        });
        let errors: Vec<String> = errors.collect();
        let _ = writeln!(out, "RMSE on the wheel tests: {}", errors.join(", "));
    }
    let plates = found
        .plates
        .as_ref()
        .map_or(0, |stage| stage.fit.left_out.count());
    let is_partial = plates + found.shear.as_ref().map_or(0, |stage| stage.unloading) > 0;
    if Layout::current().details || is_partial {
        out.push_str(&details(found));
    }
    out.push_str(&comparison(&found.comparison));
    out
}

/// All numbers, in the units of their keys.
fn numbers(found: &Identification) -> Vec<IdentifiedNumber> {
    let mut all = Vec::new();
    if let Some(stage) = &found.plates {
        all.extend(stage.fit.numbers());
        all.extend(stage.fit.moduli_in_key_units());
    }
    all.extend(found.shear.iter().flat_map(|stage| stage.fit.numbers()));
    all.extend(found.wheel.iter().flat_map(WheelStage::in_key_units));
    all
}

/// How each group of tests was evaluated.
fn details(found: &Identification) -> String {
    let mut out = String::from("\n");
    if let Some(stage) = &found.plates {
        let readings: usize = stage.fit.residuals.iter().map(Vec::len).sum();
        let _ = writeln!(
            out,
            "plate tests: {readings} readings ({} effective), {} % of scatter about the law",
            shown(readings as f64 / stage.fit.redundancy),
            rounded(100.0 * stage.fit.relative_deviation, 2),
        );
        out.push_str(&copies(stage.copies, "plate readings"));
        let left_out = stage.fit.left_out;
        if left_out.count() > 0 {
            let _ = writeln!(
                out,
                "{} of {} plate readings left out: {} below the minimum depth, {} in unloading or reloading, {} with a force of \
                 0 or less",
                left_out.count(),
                left_out.count() + readings,
                left_out.shallow,
                left_out.unloading,
                left_out.unloaded
            );
        }
        for record in &stage.records {
            let _ = writeln!(
                out,
                "{}: clocks differ by {} s ({} s after time zones), surface at {} mm",
                record.test.name,
                rounded(record.zone_s + record.offset_s, 7),
                rounded(record.offset_s, 2),
                shown(1e3 * record.contact_height),
            );
        }
    }
    if let Some(stage) = &found.shear {
        let readings = stage.readings.len();
        let _ = writeln!(
            out,
            "shear tests: {readings} readings ({} effective)",
            shown(readings as f64 / stage.fit.redundancy),
        );
        out.push_str(&copies(stage.copies, "shear readings"));
        if stage.unloading > 0 {
            let _ = writeln!(
                out,
                "{} of {} shear readings left out, in unloading or reloading",
                stage.unloading,
                stage.unloading + readings
            );
        }
    }
    if let Some(stage) = &found.wheel {
        let _ = writeln!(
            out,
            "wheel tests: {} effective, {}, {} of {} starts agree, condition number {}",
            shown(stage.tests.len() as f64 / stage.redundancy),
            stage.status.key(),
            stage.reached,
            stage.starts,
            rounded(stage.condition, 2)
        );
        out.push_str(&copies(stage.copies, "wheel tests"));
        if let Some((a, b, r)) = strongest(stage) {
            let _ = writeln!(out, "strongest correlation: {a}, {b} ({})", rounded(r, 2));
        }
    }
    out
}

/// Sets of laws on tests that they were not fitted to.
fn comparison(scores: &[LawScore]) -> String {
    let Some(first) = scores.first() else {
        return String::new();
    };
    let mut table = Table::new().text("left out").text("laws").number("tests");
    for (quantity, ..) in &first.rmse {
        table = table.number(&format!("{} {}", quantity.key(), quantity.unit()));
    }
    for score in scores {
        let mut cells = vec![
            score.left_out.clone(),
            score.laws.to_owned(),
            score.tests.to_string(),
        ];
        let errors = score.rmse.iter();
        cells.extend(errors.map(|(quantity, rmse, _)| shown(rmse / quantity.scale())));
        table.row(cells);
    }
    format!(
        "RMSE of tests that were left out of the fit:\n{}",
        table.render()
    )
}

/// Rows that count once, however often the table has them.
fn copies(count: usize, of: &str) -> String {
    if count == 0 {
        return String::new();
    }
    format!("{count} {of} are exact copies of others and are not counted again\n")
}

/// What must not be overlooked.
pub(super) fn warnings(found: &Identification) -> Vec<String> {
    let moduli = found.plates.iter();
    let moduli = moduli.flat_map(|stage| stage.fit.moduli_in_key_units());
    found
        .numbers()
        .into_iter()
        .chain(moduli)
        .filter_map(|line| {
            let what = match line.verdict {
                Verdict::NotIdentifiable => "cannot be determined from these tests",
                Verdict::OnBound => "lies on its bound",
                Verdict::Loose => "is poorly determined: its interval is as wide as its bounds, or its error exceeds a third of it",
                _ => return None,
            };
            Some(format!("{} {what}", line.name))
        })
        .collect()
}

fn table(lines: &[IdentifiedNumber]) -> String {
    let mut table = Table::new()
        .text("number")
        .number("value")
        .number("± std. error")
        .number("95 % from")
        .number("to")
        .text("");
    let end = |value: Option<f64>| value.map_or("open".to_owned(), shown);
    for line in lines {
        let error = if line.standard_error.is_nan() {
            String::new()
        } else {
            rounded(line.standard_error, 2)
        };
        table.row([
            line.name.clone(),
            shown(line.value),
            error,
            end(line.interval.low),
            end(line.interval.high),
            line.verdict.key().to_owned(),
        ]);
    }
    table.render()
}

/// The two numbers of the strongest correlation.
fn strongest(stage: &WheelStage) -> Option<(&'static str, &'static str, f64)> {
    let mut best: Option<(&'static str, &'static str, f64)> = None;
    for (i, row) in stage.correlation.iter().enumerate() {
        for (j, r) in row.iter().enumerate().take(i) {
            if r.is_finite() && best.is_none_or(|(_, _, most)| r.abs() > most.abs()) {
                let key = |index: usize| stage.numbers[index].parameter.key();
                best = Some((key(j), key(i), *r));
            }
        }
    }
    best
}
