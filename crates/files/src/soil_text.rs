//! A soil as the text of a soil file.

use std::fmt::Write as _;

use grouser_terra::{LawChoice, Pressure, SoilParams};

use crate::soil::SoilFile;

/// The text of a soil file that reads back to the same numbers, bit for bit.
///
/// `remarks` stand above it as comments, one line each: what the numbers were identified from. A number that
/// is open (NaN) is left out. Keys whose value is the usual one are left out too.
///
/// ```
/// use grouser_files::{Document, soil};
/// use grouser_terra::catalogue;
/// let lunar = catalogue::find("lunar").expect("in the catalogue");
/// let file = soil::SoilFile::new("Lunar", "Lunar Sourcebook", *lunar.soil()?.params());
/// let text = soil::text(&file, &["copied from the catalogue"])?;
/// let again = soil::parse(&Document::from_text("lunar.toml", text.into())?)?;
/// assert_eq!(again, file);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`grouser_terra::Error::Missing`] for Reece's moduli, for which soil files have no keys.
pub fn text(file: &SoilFile, remarks: &[&str]) -> Result<String, grouser_terra::Error> {
    let params = file.params();
    let Pressure::Bekker(modulus) = params.pressure else {
        return Err(grouser_terra::Error::Missing {
            field: "k_phi",
            needed_by: "a soil file",
        });
    };
    let mut out = String::new();
    for remark in remarks {
        for line in remark.lines() {
            let line: String = line.chars().filter(|c| !c.is_control()).collect();
            push(&mut out, format_args!("# {line}"));
        }
    }
    push(&mut out, format_args!("format = 1"));
    if let Some(key) = &file.key {
        push(&mut out, format_args!("key = {}", quoted(key)));
    }
    push(&mut out, format_args!("name = {}", quoted(&file.name)));
    for (key, value) in [("source", &file.source), ("note", &file.note)] {
        if !value.is_empty() {
            push(&mut out, format_args!("{key} = {}", quoted(value)));
        }
    }
    number(&mut out, "n", params.n);
    scaled(&mut out, "k_c_kn_per_m_n1", modulus.k_c, 1e3);
    scaled(&mut out, "k_phi_kn_per_m_n2", modulus.k_phi, 1e3);
    scaled(&mut out, "cohesion_kpa", params.cohesion, 1e3);
    degrees(&mut out, "phi_deg", params.phi.rad());
    for (key, value) in [
        ("k_shear_m", params.k_shear),
        ("c_1", params.c_1),
        ("c_2", params.c_2),
    ] {
        if !value.is_nan() {
            number(&mut out, key, value);
        }
    }
    optional(&mut out, params);
    laws(&mut out, params.laws);
    Ok(out)
}

/// What is written only where it is not the usual value.
fn optional(out: &mut String, p: &SoilParams) {
    for (key, value) in [
        ("n_1", p.n_1),
        ("n_2", p.n_2),
        ("rebound", p.rebound),
        ("rear_driving", p.rear_driving),
        ("rear_drift", p.rear_drift),
        ("transport_layer_m", p.transport_layer),
        ("k_shear_1_m_per_rad", p.k_shear_1),
        ("k_shear_side_1_m_per_rad", p.k_shear_side_1),
    ] {
        if value != 0.0 {
            number(out, key, value);
        }
    }
    for (key, value) in [
        ("k_shear_side_m", p.k_shear_side),
        ("unit_weight_n_per_m3", p.unit_weight),
    ] {
        if let Some(value) = value {
            number(out, key, value);
        }
    }
}

fn laws(out: &mut String, laws: LawChoice) {
    let usual = LawChoice::default();
    if laws.slip_sinkage != usual.slip_sinkage {
        let key = laws.slip_sinkage.key();
        push(out, format_args!("slip_sinkage = \"{key}\""));
    }
    if laws.stress_position != usual.stress_position {
        let key = laws.stress_position.key();
        push(out, format_args!("stress_position = \"{key}\""));
    }
    if let Some(law) = laws.shear {
        push(out, format_args!("shear = \"{}\"", law.key()));
    }
    if let Some(law) = laws.bulldozing {
        push(out, format_args!("bulldozing = \"{}\"", law.key()));
    }
}

fn push(out: &mut String, line: std::fmt::Arguments<'_>) {
    // writing to a String cannot fail
    let _ = writeln!(out, "{line}");
}

fn number(out: &mut String, key: &str, value: f64) {
    push(out, format_args!("{key} = {value:?}"));
}

/// A number in a unit `scale` times the SI one, such that the reader's product is the same to the last bit.
fn scaled(out: &mut String, key: &str, value: f64, scale: f64) {
    number(out, key, nearest(value / scale, |x| scale * x, value));
}

fn degrees(out: &mut String, key: &str, value: f64) {
    number(
        out,
        key,
        nearest(value.to_degrees(), f64::to_radians, value),
    );
}

/// Of `guess` and its neighbours the one that `back` takes to `value` exactly, where there is one.
fn nearest(guess: f64, back: impl Fn(f64) -> f64, value: f64) -> f64 {
    let (up, down) = (guess.next_up(), guess.next_down());
    [guess, up, down, up.next_up(), down.next_down()]
        .into_iter()
        .find(|x| back(*x) == value)
        .unwrap_or(guess)
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
