//! Numbers of laws and descriptions under the keys of files, in the keys' units.

use grouser_terra::OutOfRange;

/// Units of laws and descriptions, the endings of the keys that give such numbers, and the key's unit: its name, and one of it in SI.
const KEY_UNITS: [(&str, &str, &str, f64); 13] = [
    ("1", "", "", 1.0),
    ("m", "_m", "m", 1.0),
    ("N", "_n", "N", 1.0),
    ("s", "_s", "s", 1.0),
    ("rad", "_deg", "deg", core::f64::consts::PI / 180.0),
    ("rad/s", "_rad_per_s", "rad/s", 1.0),
    ("m/s", "_m_per_s", "m/s", 1.0),
    ("Pa", "_kpa", "kPa", 1e3),
    ("N/m^(n+1)", "_kn_per_m_n1", "kN/m^(n+1)", 1e3),
    ("N/m^(n+2)", "_kn_per_m_n2", "kN/m^(n+2)", 1e3),
    ("N/m^3", "_n_per_m3", "N/m^3", 1.0),
    ("m/rad", "_m_per_rad", "m/rad", 1.0),
    ("kg", "_kg", "kg", 1.0),
];

/// The unit that a key states in its name; empty for a pure number, and for a unit that no law has.
///
/// ```
/// use grouser_files::unit_of_key;
///
/// let keys = ["phi_deg", "speed_m_per_s", "c_1", "stiffness_n_per_m"];
/// assert_eq!(keys.map(unit_of_key), ["deg", "m/s", "", ""]);
/// ```
#[must_use]
pub fn unit_of_key(key: &str) -> &'static str {
    let stated = KEY_UNITS.iter().filter(|(_, ending, ..)| {
        let quantity = key.strip_suffix(ending);
        // `…_n_per_m` is no length
        quantity.is_some_and(|quantity| !quantity.ends_with("_per"))
    });
    stated
        .max_by_key(|(_, ending, ..)| ending.len())
        .map_or("", |(_, _, unit, _)| unit)
}

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
    let (_, ending, _, unit) = KEY_UNITS.iter().find(|(unit, ..)| *unit == range.unit)?;
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
        // the key states it
        unit: "",
    })
}
