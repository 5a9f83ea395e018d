//! Numbers of laws and descriptions under the keys of files, in the keys' units.

use grouser_terra::OutOfRange;

/// Units of laws and descriptions, the endings of the keys that give such numbers, and one of the key's unit in SI.
const KEY_UNITS: [(&str, &str, f64); 13] = [
    ("1", "", 1.0),
    ("m", "_m", 1.0),
    ("N", "_n", 1.0),
    ("s", "_s", 1.0),
    ("rad", "_deg", core::f64::consts::PI / 180.0),
    ("rad/s", "_rad_per_s", 1.0),
    ("m/s", "_m_per_s", 1.0),
    ("Pa", "_kpa", 1e3),
    ("N/m^(n+1)", "_kn_per_m_n1", 1e3),
    ("N/m^(n+2)", "_kn_per_m_n2", 1e3),
    ("N/m^3", "_n_per_m3", 1.0),
    ("m/rad", "_m_per_rad", 1.0),
    ("kg", "_kg", 1.0),
];

/// A number that is refused in SI units, under the key that gives it in files and in the key's unit; `None` for a unit that no
/// key has.
///
/// ```
/// use grouser_files::of_key;
/// use grouser_terra::OutOfRange;
///
/// let range = OutOfRange::check("cohesion", -5000.0, (0.0, 1e8), "Pa").unwrap_err();
/// let shown = format!("{:#}", of_key(&range).expect("a key"));
/// assert_eq!(shown, "`cohesion_kpa` is -5, but must lie in [0, 100000]");
/// ```
#[must_use]
pub fn of_key(range: &OutOfRange) -> Option<OutOfRange<String>> {
    let (_, ending, unit) = KEY_UNITS.iter().find(|(unit, ..)| *unit == range.unit)?;
    let name = match range.field {
        "lug_count" => "grouser_count",
        "lug_thickness" => "grouser_thickness",
        field => field,
    };
    // 89° in radians and back are 89°
    let in_unit = |si: f64| {
        let value = si / unit;
        let rounded = (value * 1e9).round() / 1e9;
        if rounded.is_finite() { rounded } else { value }
    };
    Some(OutOfRange {
        field: format!("{name}{ending}"),
        value: in_unit(range.value),
        low: in_unit(range.low),
        // without a limit there is none in any unit
        high: if range.high >= f64::MAX {
            f64::MAX
        } else {
            in_unit(range.high)
        },
        unit: "",
    })
}
