//! Units: in keys, and as people read them.

/// Endings of keys and the unit that each stands for; longer ones first.
const ENDINGS: [(&str, &str); 23] = [
    ("_kn_per_m_n1", "kN/m^(n+1)"),
    ("_kn_per_m_n2", "kN/m^(n+2)"),
    ("_n_per_m3", "N/m³"),
    ("_m_per_rad", "m/rad"),
    ("_m_per_s2", "m/s²"),
    ("_rad_per_s", "rad/s"),
    ("_j_per_m", "J/m"),
    ("_m_per_s", "m/s"),
    ("_kpa", "kPa"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_kg", "kg"),
    ("_hz", "Hz"),
    ("_nm", "N m"),
    ("_mm", "mm"),
    ("_ns", "ns"),
    ("_ms", "ms"),
    ("_pa", "Pa"),
    ("_m", "m"),
    ("_n", "N"),
    ("_s", "s"),
    ("_j", "J"),
    ("_a", "A"),
];

/// The unit that a key carries; empty for a pure number.
///
/// ```
/// use grouser_report::unit_of;
///
/// assert_eq!(unit_of("sinkage_m"), "m");
/// assert_eq!(unit_of("energy_j_per_m"), "J/m");
/// assert_eq!(unit_of("slip"), "");
/// ```
#[must_use]
pub fn unit_of(key: &str) -> &'static str {
    ENDINGS
        .iter()
        .find(|(ending, _)| key.ends_with(ending))
        .map_or("", |(_, unit)| unit)
}

/// Factor between two units of one quantity; 1 for those that are the same.
pub(crate) fn factor(from: &str, to: &str) -> f64 {
    match (from, to) {
        ("m", "mm") => 1e3,
        ("", "%") => 100.0,
        ("rad", "deg") => 1_f64.to_degrees(),
        _ => 1.0,
    }
}
