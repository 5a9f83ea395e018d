//! Columns of tables that look like quantities.

/// Names of quantities of a wheel, its motion and its soil, as people write them.
const WORDS: [&str; 55] = [
    "alpha",
    "angle",
    "beta",
    "camber",
    "caster",
    "cleat",
    "cleats",
    "cohesion",
    "density",
    "depth",
    "diameter",
    "drift",
    "exponent",
    "force",
    "friction",
    "gamma",
    "gradient",
    "gravity",
    "grouser",
    "grousers",
    "inclination",
    "incline",
    "kc",
    "kphi",
    "lean",
    "load",
    "lug",
    "lugs",
    "mass",
    "modulus",
    "omega",
    "payload",
    "phi",
    "pitch",
    "pressure",
    "pull",
    "radius",
    "rebound",
    "roll",
    "rpm",
    "shear",
    "sideslip",
    "sinkage",
    "skid",
    "slip",
    "slope",
    "speed",
    "steering",
    "stress",
    "thrust",
    "tilt",
    "torque",
    "velocity",
    "weight",
    "width",
];

/// Units at the end of a name; a name with `per` has one too.
const UNITS: [&str; 26] = [
    "cm", "deg", "degrees", "ft", "g", "hz", "in", "inch", "kg", "km", "kn", "kpa", "lb", "lbf",
    "m", "mm", "mpa", "n", "newton", "nm", "pa", "pct", "percent", "rad", "rpm", "w",
];

/// Symbols that mean a quantity where they are the whole name, numbers and units aside.
const SYMBOLS: [&str; 14] = [
    "b", "c", "d", "g", "h", "k", "n", "p", "q", "r", "s", "v", "w", "z",
];

/// Words that make a remark of a name: what was read elsewhere, and names of things.
const REMARKS: [&str; 18] = [
    "case", "class", "comment", "expected", "file", "group", "id", "index", "kind", "label",
    "measured", "name", "note", "observed", "remark", "set", "trial", "type",
];

/// Where and when a row was measured: no quantity of a wheel.
const PLACES: [&str; 5] = ["x", "y", "time", "latitude", "longitude"];

/// Does the name of a table's column look like a quantity of a wheel, its motion or its soil?
///
/// A reader of tables refuses such a column where it does not read it: a result for another slip angle or load than
/// the row states would be wrong without a word. A name looks so with a word of the model in it, with a unit at its end,
/// or as a symbol, in any letter case and with any separators. `measured_…`, notes, labels, places and times do not.
///
/// ```
/// use grouser_files::is_quantity_name;
///
/// for name in ["slip_angle_deg", "Load (N)", "wheelLoad", "lug-height", "camber_deg", "k_mm", "n_1"] {
///     assert!(is_quantity_name(name), "{name}");
/// }
/// for name in ["note", "name", "measured_pull_n", "load_case", "time_s", "x_m", "run"] {
///     assert!(!is_quantity_name(name), "{name}");
/// }
/// ```
#[must_use]
pub fn is_quantity_name(name: &str) -> bool {
    let tokens = tokens(name);
    let has = |list: &[&str]| tokens.iter().any(|token| list.contains(&token.as_str()));
    if has(&REMARKS) || tokens.first().is_some_and(|t| PLACES.contains(&t.as_str())) {
        return false;
    }
    let last = tokens.last().is_some_and(|t| UNITS.contains(&t.as_str()));
    let has_unit = tokens.len() > 1 && last || tokens.iter().any(|token| token == "per");
    has(&WORDS) || has_unit || is_symbol(&tokens)
}

/// A symbol with numbers or one unit after it.
fn is_symbol(tokens: &[String]) -> bool {
    let Some((first, rest)) = tokens.split_first() else {
        return false;
    };
    let bare = first.trim_end_matches(|c: char| c.is_ascii_digit());
    SYMBOLS.contains(&bare)
        && rest
            .iter()
            .all(|token| token.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The words of a name in small letters: `slipAngle-deg` is slip, angle and deg.
fn tokens(name: &str) -> Vec<String> {
    let mut tokens = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        let starts = was_small && letter.is_uppercase();
        if starts || !letter.is_alphanumeric() {
            tokens.push(String::new());
        }
        if letter.is_alphanumeric()
            && let Some(token) = tokens.last_mut()
        {
            token.extend(letter.to_lowercase());
        }
        was_small = letter.is_lowercase();
    }
    tokens.retain(|token| !token.is_empty());
    tokens
}
