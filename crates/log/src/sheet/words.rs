//! The words of a column's name, and the unit that it ends with.

/// What people number by wheel.
const NUMBERED: &[&str] = &[
    "enc", "encoder", "ticks", "vel", "omega", "rpm", "torque", "current", "wheel", "motor",
];

/// The words of a name in lower case: `field.header.stamp`, `leftEncoder` and `gyro_z_rad_per_s` fall apart.
pub(super) fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = vec![String::new()];
    let mut lower = false;
    for letter in name.chars() {
        let new = !letter.is_alphanumeric() || (lower && letter.is_uppercase());
        if new {
            words.push(String::new());
        }
        if letter.is_alphanumeric() {
            let last = words.len() - 1;
            words[last].extend(letter.to_lowercase());
        }
        lower = letter.is_lowercase();
    }
    // `m1pos` is `m1`, `pos`, and `enc1` is `enc`, `w1`.
    let glued = |word: String| {
        let kind = word.trim_end_matches(|letter: char| letter.is_ascii_digit());
        if NUMBERED.contains(&kind) && kind.len() < word.len() {
            return vec![kind.to_owned(), format!("w{}", &word[kind.len()..])];
        }
        let tail = ["pos", "vel", "enc"].into_iter().find(|tail| {
            word.len() > tail.len() && word.len() <= tail.len() + 2 && word.ends_with(tail)
        });
        match tail {
            Some(tail) => vec![word[..word.len() - tail.len()].to_owned(), tail.to_owned()],
            None => vec![word],
        }
    };
    let words = words.into_iter().filter(|word| !word.is_empty());
    let mut all: Vec<String> = words.flat_map(glued).collect();
    // `NanoSec`
    if let Some(nano) = all
        .windows(2)
        .position(|two| two[0] == "nano" && two[1].starts_with("sec"))
    {
        let seconds = all.remove(nano + 1);
        all[nano].push_str(&seconds);
    }
    all
}

/// How people write units at the end of a name, in the words of [`words`]; the longer ones first. What is no unit of a column
/// map stands for one that fits no meaning.
pub(super) const UNIT_WORDS: &[(&str, &str)] = &[
    ("km per h", "km/h"),
    ("km h", "km/h"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("m per s2", "m/s2"),
    ("m s2", "m/s2"),
    ("m s²", "m/s2"),
    ("mm per s", "mm/s"),
    ("mm s", "mm/s"),
    ("cm per s", "cm/s"),
    ("cm s", "cm/s"),
    ("in per s", "in/s"),
    ("in s", "in/s"),
    ("ips", "in/s"),
    ("ft per s", "ft/s"),
    ("ft s", "ft/s"),
    ("m per s", "m/s"),
    ("m s", "m/s"),
    ("mps", "m/s"),
    ("mrad s", "mrad/s"),
    ("rad per s", "rad/s"),
    ("rad s", "rad/s"),
    ("deg per s", "deg/s"),
    ("deg s", "deg/s"),
    ("dps", "deg/s"),
    ("rpm", "rpm"),
    ("turns per s", "turn/s"),
    ("turn per s", "turn/s"),
    ("turns s", "turn/s"),
    ("turn s", "turn/s"),
    ("revs per s", "turn/s"),
    ("rev per s", "turn/s"),
    ("revs s", "turn/s"),
    ("rev s", "turn/s"),
    ("rps", "turn/s"),
    ("n m", "N m"),
    ("nm", "N m"),
    ("mnm", "mN m"),
    ("ma", "mA"),
    ("mm", "mm"),
    ("cm", "cm"),
    ("km", "km"),
    ("ft", "ft"),
    ("m", "m"),
    ("1e7", "1e-7 deg"),
    ("e7", "1e-7 deg"),
    ("degrees", "deg"),
    ("deg", "deg"),
    ("rad", "rad"),
    ("mrad", "mrad"),
    ("mg", "mg"),
    ("mph", "mph"),
    ("a", "A"),
    ("g", "g"),
    ("in", "in"),
    ("ticks", "tick"),
];

/// The words of a name without the unit that it ends with, and that unit.
pub(super) fn split_unit(name: &str) -> (Vec<String>, Option<&'static str>) {
    let mut all = words(name);
    let joined = all.join(" ");
    let ends = |(spelled, _): &&(&str, &str)| {
        let before = joined.strip_suffix(spelled);
        before.is_some_and(|before| before.ends_with(' '))
    };
    let Some((spelled, unit)) = UNIT_WORDS.iter().find(ends) else {
        return (all, is_of_another_unit(name).then_some("another unit"));
    };
    if *unit != "tick" {
        all.truncate(all.len() - spelled.split(' ').count());
    }
    (all, Some(unit))
}

/// Does a name end with a quotient in brackets, as `speed (furlong/h)` does?
fn is_of_another_unit(name: &str) -> bool {
    let inside = name.trim_end().strip_suffix([')', ']']);
    let inside = inside.and_then(|text| Some(text.rsplit_once(['(', '['])?.1));
    inside.is_some_and(|unit| unit.contains('/'))
}

/// The unit of a column whose name is one of `names` and at most a unit; `default` where it states none.
pub(super) fn bare_unit(
    name: &str,
    names: &[&str],
    default: Option<&'static str>,
) -> Option<&'static str> {
    let (words, unit) = split_unit(name);
    match words.as_slice() {
        [one] if names.contains(&one.as_str()) => unit.or(default),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn names_fall_apart_into_words() {
        for (name, expected) in [
            ("field.header.stamp", "field header stamp"),
            ("leftEncoder", "left encoder"),
            ("gyro_z_rad_per_s", "gyro z rad per s"),
            ("GPSx", "gpsx"),
            ("a1B", "a1b"),
            ("m1pos", "m1 pos"),
            ("m1enc", "m1 enc"),
            ("enc1_rad", "enc w1 rad"),
            ("vel12", "vel w12"),
            ("velocity1", "velocity1"),
            ("imu1", "imu1"),
            ("mvel", "m vel"),
            ("m12pos", "m12pos"),
            ("pos", "pos"),
            ("NanoSec", "nanosec"),
            ("velL", "vel l"),
            ("posm1", "posm1"),
            ("..", ""),
        ] {
            assert_eq!(words(name).join(" "), expected, "{name}");
        }
    }
}
