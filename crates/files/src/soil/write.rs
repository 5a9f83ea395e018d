//! A soil as the text of a soil file.

use grouser_terra::{LawChoice, LawPreset, Pressure};

use super::SoilFile;
use crate::toml_text::TomlText;

/// The text of a soil file that reads back to the same numbers, bit for bit; a stress or an angle that no number of kPa or degrees
/// gives is written to the nearest one.
///
/// `remarks` stand above it as comments, one line each: what the numbers were identified from. A number that is open is left
/// out, and so are keys whose value is the usual one.
///
/// ```
/// use grouser_files::{Document, soil};
/// use grouser_terra::catalogue;
/// let lunar = catalogue::find("lunar").expect("in the catalogue");
/// let file = soil::SoilFile::new("Lunar", "Lunar Sourcebook", *lunar.soil()?.params());
/// let text = soil::to_toml(&file, &["copied from the catalogue"])?;
/// let again = soil::parse(&Document::from_text("lunar.toml", text.into())?)?;
/// assert_eq!(again, file);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`grouser_terra::Error::Missing`] for Reece's moduli, for which soil files have no keys.
pub fn to_toml(file: &SoilFile, remarks: &[&str]) -> Result<String, grouser_terra::Error> {
    let params = &file.soil;
    let Pressure::Bekker(modulus) = params.pressure else {
        return Err(grouser_terra::Error::Missing {
            field: "k_phi",
            needed_by: "a soil file",
        });
    };
    let preset = LawPreset::from_laws(&params.laws);
    let mut out = TomlText::new(remarks);
    out.optional_text("key", file.key.as_deref());
    out.text("name", &file.name);
    for (key, value) in [("source", &file.source), ("note", &file.note)] {
        out.optional_text(key, (!value.is_empty()).then_some(value));
    }
    out.optional_number("n", params.n);
    for (key, value) in [
        ("k_c_kn_per_m_n1", modulus.k_c),
        ("k_phi_kn_per_m_n2", modulus.k_phi),
        ("cohesion_kpa", params.cohesion),
    ] {
        if let Some(value) = value {
            out.scaled(key, value, 1e3);
        }
    }
    if let Some(phi) = params.phi {
        out.degrees("phi_deg", phi.rad());
    }
    for (key, value) in [
        ("k_shear_m", params.k_shear),
        ("c_1", params.c_1),
        ("c_2", params.c_2),
    ] {
        out.optional_number(key, value);
    }
    for (key, value) in [
        ("n_1", params.n_1),
        ("n_2", params.n_2),
        ("rebound", params.rebound),
        ("rear_driving", params.rear_driving),
        ("transport_layer_m", params.transport_layer),
        ("k_shear_1_m_per_rad", params.k_shear_1),
        ("k_shear_side_1_m_per_rad", params.k_shear_side_1),
    ] {
        out.nonzero(key, value);
    }
    for (key, value, usual) in [
        ("rear_drift", params.rear_drift, preset.rear_drift),
        (
            "sideways_support",
            params.sideways_support,
            preset.sideways_support,
        ),
    ] {
        out.optional_number(key, (value != usual).then_some(value));
    }
    out.optional_number("k_shear_side_m", params.k_shear_side);
    out.optional_number("unit_weight_n_per_m3", params.unit_weight);
    if preset == LawPreset::CLASSICAL {
        laws(&mut out, params.laws);
    } else {
        out.text("laws", preset.key);
    }
    if let Some(range) = params.fitted {
        out.header("[fitted]");
        out.degrees("slip_angle_min_deg", range.slip_angle.0);
        out.degrees("slip_angle_max_deg", range.slip_angle.1);
        for (key, value) in [
            ("slip_min", range.slip.0),
            ("slip_max", range.slip.1),
            ("width_min_m", range.width.0),
            ("width_max_m", range.width.1),
            ("load_min_n", range.load.0),
            ("load_max_n", range.load.1),
        ] {
            out.number(key, value);
        }
    }
    Ok(out.finish())
}

fn laws(out: &mut TomlText, laws: LawChoice) {
    let usual = LawPreset::CLASSICAL.laws;
    if laws.slip_norm != usual.slip_norm {
        out.text("slip_norm", laws.slip_norm.key());
    }
    if laws.slip_sinkage != usual.slip_sinkage {
        out.text("slip_sinkage", laws.slip_sinkage.key());
    }
    if laws.stress_position != usual.stress_position {
        out.text("stress_position", laws.stress_position.key());
    }
    out.optional_text("shear", laws.shear.map(grouser_terra::ShearLaw::key));
    out.optional_text(
        "bulldozing",
        laws.bulldozing.map(grouser_terra::Bulldozing::key),
    );
}
