//! `identify` for people and for programs.

use std::fmt::Write as _;

use grouser_identify::least_squares::Verdict;
use grouser_identify::wheel::LawScore;
use grouser_identify::{Identification, IdentifiedNumber, ShearStage, WheelStage};

use super::errors::errors;
use grouser_report::Table;
use grouser_report::number::rounded;

/// What was found, as tables.
pub(super) fn text(found: &Identification) -> String {
    let doubts = found.doubts();
    let doubts = doubts.iter().map(|doubt| format!("WARNING: {doubt}\n"));
    let mut out: String = doubts.collect();
    if let Some(stage) = &found.plates {
        let readings: usize = stage.fit.residuals.iter().map(Vec::len).sum();
        let _ = writeln!(
            out,
            "{} plate tests, {readings} readings, {} effective ones, {} % of scatter about the law",
            stage.fit.count,
            rounded(readings as f64 / stage.fit.redundancy, 3),
            rounded(100.0 * stage.fit.relative_deviation, 2),
        );
        out.push_str(&copies(stage.copies, "plate readings"));
        let left_out = stage.fit.left_out;
        if left_out.count() > 0 {
            let _ = writeln!(
                out,
                "{} of {} readings left out: {} shallower than the least depth, {} where the plate goes up or has been \
                 before, {} with a force of 0 or less",
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
                "{}: clocks {} s apart ({} s after time zones), surface at {} mm",
                record.test.name,
                rounded(record.zone_s + record.offset_s, 7),
                rounded(record.offset_s, 2),
                rounded(1e3 * record.contact_height, 4),
            );
        }
        if stage.fit.is_separable() {
            let moduli = [stage.fit.k_c, stage.fit.k_phi].map(|modulus| rounded(modulus / 1e3, 4));
            let [k_c, k_phi] = moduli;
            let _ = writeln!(out, "k_c {k_c} kN/m^(n+1), k_phi {k_phi} kN/m^(n+2)");
        } else {
            let widths = stage.tests.iter().map(|test| test.plate.width);
            let _ = writeln!(
                out,
                "k {} kN/m^(n+2) at b = {} mm; plates of one width do not separate k_c from k_phi, which hold for wheels \
                 of this width alone",
                rounded(stage.fit.k_phi / 1e3, 4),
                rounded(1e3 * widths.fold(0.0, f64::max), 4)
            );
        }
        let mut numbers = stage.fit.numbers();
        numbers.extend(stage.fit.moduli_in_key_units());
        out.push_str(&table(&numbers));
    }
    if let Some(stage) = &found.shear {
        out.push_str(&shear(stage));
    }
    let single = found.of_single_tests();
    if !single.is_empty() {
        let _ = writeln!(
            out,
            "not in the intervals of {}: how tests of the same soil differ, since one test alone determines them. Repeat \
             the tests on other spots",
            single.join(", ")
        );
    }
    if let Some(stage) = &found.wheel {
        let _ = writeln!(
            out,
            "{} wheel tests, {} effective ones: {}, {} of {} starts ended here, condition {}",
            stage.tests.len(),
            rounded(stage.tests.len() as f64 / stage.redundancy, 3),
            stage.status.key(),
            stage.reached,
            stage.starts,
            rounded(stage.condition, 2)
        );
        out.push_str(&copies(stage.copies, "wheel tests"));
        out.push_str(&table(&stage.in_key_units()));
        for (quantity, rmse, count) in errors(stage) {
            let _ = writeln!(
                out,
                "{} of {count} readings: RMSE {} {}",
                quantity.key(),
                rounded(rmse, 3),
                quantity.unit()
            );
        }
        if let Some((a, b, r)) = strongest(stage) {
            let _ = writeln!(
                out,
                "most alike: {a} and {b}, correlation {}",
                rounded(r, 2)
            );
        }
    }
    out.push_str(&comparison(&found.comparison));
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
        cells.extend(errors.map(|(quantity, rmse, _)| rounded(rmse / quantity.scale(), 3)));
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
    format!("{count} {of} repeat others in every number: copies, which do not count again\n")
}

/// What shear tests showed.
fn shear(stage: &ShearStage) -> String {
    let mut out = String::new();
    let readings = stage.readings.len();
    let _ = writeln!(
        out,
        "{readings} readings of {} shear tests, {} effective ones",
        stage.fit.tests,
        rounded(readings as f64 / stage.fit.redundancy, 3),
    );
    out.push_str(&copies(stage.copies, "shear readings"));
    if stage.unloading > 0 {
        let _ = writeln!(
            out,
            "{} of {} readings left out, where the displacement goes back or has been before",
            stage.unloading,
            stage.unloading + readings
        );
    }
    out.push_str(&table(&stage.fit.numbers()));
    out
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
                Verdict::Loose => "is hardly determined: its interval is as wide as its bounds, or its error exceeds a third of it",
                _ => return None,
            };
            Some(format!("{} {what}", line.name))
        })
        .collect()
}

fn table(lines: &[IdentifiedNumber]) -> String {
    let mut table = Table::new()
        .text("  number")
        .number("value")
        .number("± std. error")
        .number("95 % from")
        .number("to")
        .text("");
    let end = |value: Option<f64>| value.map_or("open".to_owned(), |v| rounded(v, 4));
    for line in lines {
        let error = if line.standard_error.is_nan() {
            String::new()
        } else {
            rounded(line.standard_error, 2)
        };
        table.row([
            format!("  {}", line.name),
            rounded(line.value, 4),
            error,
            end(line.interval.low),
            end(line.interval.high),
            line.verdict.key().to_owned(),
        ]);
    }
    table.render()
}

/// The two numbers that are hardest to tell apart.
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
