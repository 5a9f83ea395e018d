//! What a column probably means, by its name.

use std::borrow::Cow;

use grouser_files::columns::Meaning;
use grouser_files::unit::{Quantity, UNITS};

use super::SheetColumn;
use super::words::{UNIT_WORDS, split_unit};

/// What a column probably means.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Guess {
    /// What it means.
    pub meaning: Meaning,
    /// The wheel it belongs to.
    pub wheel: Option<String>,
    /// Its unit, as column maps name it.
    pub unit: &'static str,
}

/// `m1`, `w2`: how people number motors and wheels.
fn is_numbered(word: &str) -> bool {
    let digits = word.strip_prefix(['m', 'w']).unwrap_or("");
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// The guess for a column; `unit` is what a header line says. It, or the unit in the name, must fit.
pub(crate) fn guess(name: &str, unit: Option<&str>, whole: bool) -> Option<Guess> {
    let (words, in_name) = split_unit(&named_axis(name));
    // `CAN2.gnss_pos.Latitude`: what a bus calls itself is no part of the meaning
    if let Some((_, last)) = name.rsplit_once('.')
        && let Some((meaning, unit)) = of_fix(&super::words::words(last))
        && matches!(meaning, Meaning::Latitude | Meaning::Longitude)
    {
        return Some(Guess {
            meaning,
            wheel: None,
            unit,
        });
    }
    let Some(unit) = unit.filter(|unit| !unit.is_empty()) else {
        let found = by_name_and_unit(&words, in_name, whole);
        return match in_name {
            // or a channel, say
            Some("A" | "g" | "in") => {
                found.or_else(|| by_name(&super::words::words(name), None, whole))
            }
            _ => found,
        };
    };
    let spelled = super::words::words(unit).join(" ");
    let known = UNIT_WORDS.iter().find(|(words, _)| *words == spelled);
    by_name_and_unit(&words, known.map(|(_, unit)| *unit).or(Some(unit)), whole)
}

/// The name of a gyro with the letter of its axis: `gyro_rad[2]` is `gyro_rad z`.
fn named_axis(name: &str) -> Cow<'_, str> {
    let axes = [("[0]", "x"), ("[1]", "y"), ("[2]", "z")];
    let ends = |(index, axis): (&str, &'static str)| Some((name.strip_suffix(index)?, axis));
    match axes.into_iter().find_map(ends) {
        Some((bare, axis)) if bare.to_lowercase().contains("gyro") => {
            format!("{bare} {axis}").into()
        }
        _ => name.into(),
    }
}

fn by_name_and_unit(words: &[String], stated: Option<&str>, whole: bool) -> Option<Guess> {
    let quantity_of = |unit| UNITS.iter().find(|(name, ..)| *name == unit).map(|of| of.1);
    let mut guess = by_name(words, stated.and_then(quantity_of), whole)?;
    let Some(stated) = stated else {
        return Some(guess);
    };
    if (guess.meaning, quantity_of(stated)?) == (Meaning::WheelRate, Quantity::Speed) {
        guess.meaning = Meaning::WheelSpeed;
    }
    let (_, _, own) = Meaning::ALL
        .iter()
        .find(|(_, meaning, _)| *meaning == guess.meaning)?;
    // `rate_deg` is in degrees per second
    let unit = match (own, stated) {
        (Quantity::AngularRate, "deg") => "deg/s",
        (Quantity::AngularRate, "rad") => "rad/s",
        _ => stated,
    };
    (guess.unit, _) = own.units().into_iter().find(|(known, _)| *known == unit)?;
    Some(guess)
}

pub(super) fn by_name(words: &[String], stated: Option<Quantity>, whole: bool) -> Option<Guess> {
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let of = |meaning, unit| {
        Some(Guess {
            meaning,
            wheel: None,
            unit,
        })
    };
    let of_wheel = |meaning, unit| {
        Some(Guess {
            meaning,
            wheel: Some(wheel(words)?),
            unit,
        })
    };
    if let Some((meaning, unit)) = of_fix(words) {
        return of(meaning, unit);
    }
    if let Some(found) = of_wheel_encoder(words) {
        return Some(found);
    }
    let command = is(&["cmd", "command", "commanded", "setpoint", "target", "set"]);
    let other = [
        "covariance",
        "current",
        "torque",
        "effort",
        "voltage",
        "temperature",
        "seq",
        "acc",
        "acceleration",
        "accel",
    ];
    let of_a_wheel = is(&["wheel", "motor", "left", "right", "joint"])
        || words.iter().any(|word| is_numbered(word))
        || ((stated.is_some() || is(&["rpm"]))
            && words.iter().any(|word| word.len() == 2 && is_corner(word)))
        || (stated == Some(Quantity::Speed)
            && matches!(words, [speed, place] if speed == "v" && is_corner(place)));
    if !command && let Some(found) = stated.and_then(|stated| by_unit(words, stated, of_a_wheel)) {
        return Some(found);
    }
    let of_quaternion = words.iter().any(|word| is_quaternion(word));
    if is(&other) || (of_quaternion && !of_a_wheel) {
        return None;
    }
    if command {
        let forward = is(&["x", "forward", "linear", "v", "speed"]);
        return if forward && !of_a_wheel && !is(&["angular", "y", "z", "left"]) {
            of(Meaning::CommandForward, "m/s")
        } else {
            None
        };
    }
    let bare = matches!(words, [wheel, place] if wheel == "wheel" && is_corner(place));
    let counts = is(&["tick", "ticks", "count", "counts", "encoder", "enc"]);
    if whole && (counts || bare || stated == Some(Quantity::Ticks)) {
        return of_wheel(Meaning::WheelCount, "tick");
    }
    if is_yaw_rate(words, stated) {
        return of(Meaning::YawRate, "rad/s");
    }
    let is_speed = matches!(stated, Some(Quantity::Speed | Quantity::AngularRate));
    if of_a_wheel && (is_speed || is(&["velocity", "vel", "speed", "rate", "omega", "rpm"])) {
        let unit = if is(&["rpm"]) { "rpm" } else { "rad/s" };
        return of_wheel(Meaning::WheelRate, unit);
    }
    let is_angle = is(&["position", "pos", "angle"])
        || stated == Some(Quantity::Angle) && (counts || names_a_wheel(words));
    if of_a_wheel && is_angle {
        return of_wheel(Meaning::WheelAngle, "rad");
    }
    if let [one] = words {
        match one.as_str() {
            "dx" => return of(Meaning::DisplacementForward, "m"),
            "dy" => return of(Meaning::DisplacementLeft, "m"),
            "dang" | "dyaw" => return of(Meaning::DisplacementTurn, "rad"),
            _ => {}
        }
    }
    if !is(&[
        "pose", "position", "pos", "odom", "gps", "vicon", "mocap", "truth",
    ]) {
        None
    } else if is(&["yaw", "heading", "theta"]) {
        of(Meaning::PoseYaw, "rad")
    } else if is(&["x"]) {
        of(Meaning::PoseX, "m")
    } else if is(&["y"]) {
        of(Meaning::PoseY, "m")
    } else {
        None
    }
}

/// Do the words name the rate of a turn about z?
fn is_yaw_rate(words: &[String], stated: Option<Quantity>) -> bool {
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let turns = is(&["gyro", "gyroscope", "imu"])
        || (is(&["angular"]) && is(&["velocity", "rate"]))
        || (is(&["ang"]) && is(&["vel"]));
    (turns && (is(&["z"]) || is_gyro(words)))
        || (is(&["yaw"]) && is(&["rate", "velocity"]))
        || is(&["yawrate"])
        || (stated == Some(Quantity::AngularRate) && is(&["wz"]))
}

/// Do the words name a wheel and nothing else, as those of `left_rad` and `rear_right_wheel_deg` do?
fn names_a_wheel(words: &[String]) -> bool {
    let is_part = |word: &String| {
        ["front", "rear", "wheel", "motor", "joint"].contains(&word.as_str())
            || is_corner(word)
            || is_numbered(word)
    };
    words.iter().all(is_part)
}

/// The ways of ArduPilot's encoders of wheels, m: `WENC.Dist0`.
fn of_wheel_encoder(words: &[String]) -> Option<Guess> {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let ["w", "enc", way] = words.as_slice() else {
        return None;
    };
    let index = way.strip_prefix("dist")?;
    Some(Guess {
        meaning: Meaning::WheelDistance,
        wheel: Some(format!("wheel_{index}")),
        unit: "m",
    })
}

/// What a satellite receiver says of its fix, with the usual unit.
fn of_fix(words: &[String]) -> Option<(Meaning, &'static str)> {
    const AROUND: &[&str] = &[
        "gps",
        "gnss",
        "rtk",
        "ublox",
        "navsat",
        "nav",
        "pvt",
        "position",
        "pos",
        "field",
        "data",
        "msg",
        "raw",
        "antenna",
        "wgs84",
        "dd",
        "deg",
        "msl",
        "ellipsoid",
        "vehicle",
    ];
    let is_receiver = |word: &str| ["gps", "gnss", "navsat", "fix"].contains(&word);
    let of_receiver = words.iter().any(|word| is_receiver(word));
    let bare = words.iter().map(String::as_str);
    let bare =
        bare.filter(|word| !AROUND.contains(word) && !word.bytes().all(|b| b.is_ascii_digit()));
    let bare: Vec<&str> = bare.collect();
    let without_fix: Vec<&str> = bare.iter().copied().filter(|word| *word != "fix").collect();
    match without_fix.as_slice() {
        ["lat" | "latitude"] => Some((Meaning::Latitude, "deg")),
        ["lon" | "lng" | "long" | "longitude"] => Some((Meaning::Longitude, "deg")),
        ["alt" | "altitude"] => Some((Meaning::Altitude, "m")),
        ["hacc" | "eph"] | ["h" | "horizontal", "acc" | "accuracy"] => {
            Some((Meaning::FixSigma, "m"))
        }
        ["fixtype" | "type" | "quality" | "mode"] if of_receiver || bare == ["fixtype"] => {
            Some((Meaning::FixType, "1"))
        }
        ["status"] | ["status", "status"] if of_receiver => Some((Meaning::FixStatus, "1")),
        [] if bare == ["fix"] => Some((Meaning::FixType, "1")),
        _ => None,
    }
}

/// The guess for a column of a fix by its numbers; `None` where they do not fit.
pub(super) fn of_fix_numbers(column: &SheetColumn, mut guess: Guess) -> Option<Guess> {
    let size = column.size();
    match guess.meaning {
        Meaning::Latitude | Meaning::Longitude if guess.unit == "deg" && size > 180.0 => {
            // degrees and minutes in one number are no angle
            guess.unit = "1e-7 deg";
            (column.whole && size > 1e6).then_some(guess)
        }
        // whole numbers without a unit may be mm
        Meaning::FixSigma if guess.unit == "m" && column.whole && size > 0.0 => None,
        Meaning::FixType | Meaning::FixStatus => {
            // of a status from 0 to 2 it is open whether 0 is a position
            let kinds = [
                (column.min < 0.0, Meaning::FixStatus),
                (column.max > 2.0, Meaning::FixType),
            ];
            let by_numbers = kinds
                .into_iter()
                .find_map(|(is, meaning)| is.then_some(meaning));
            let is_type = guess.meaning == Meaning::FixType && column.max > 0.0;
            guess.meaning = by_numbers.or(is_type.then_some(Meaning::FixType))?;
            column.whole.then_some(guess)
        }
        _ => Some(guess),
    }
}

/// What only a stated unit makes clear.
fn by_unit(words: &[String], stated: Quantity, of_a_wheel: bool) -> Option<Guess> {
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let of = |meaning, unit| Guess {
        meaning,
        wheel: None,
        unit,
    };
    let found = match stated {
        Quantity::Torque if of_a_wheel && is(&["torque", "effort"]) => {
            of(Meaning::WheelTorque, "N m")
        }
        Quantity::Current if of_a_wheel && is(&["current", "amps"]) => {
            of(Meaning::MotorCurrent, "A")
        }
        Quantity::Length if of_a_wheel && is(&["odo", "odometer"]) => {
            of(Meaning::WheelDistance, "m")
        }
        Quantity::Angle if is(&["steering", "steer"]) && of_a_wheel => {
            of(Meaning::WheelSteering, "rad")
        }
        Quantity::Angle if is(&["steering", "steer"]) => of(Meaning::SteeringAngle, "rad"),
        Quantity::Acceleration if is(&["x", "forward"]) => of(Meaning::AccelerationForward, "m/s2"),
        Quantity::Acceleration if is(&["y", "left"]) => of(Meaning::AccelerationLeft, "m/s2"),
        Quantity::Speed if is(&["gps", "gnss", "ground", "sog"]) && is(&["speed", "sog"]) => {
            of(Meaning::SpeedSize, "m/s")
        }
        Quantity::Speed if is(&["speed", "velocity"]) && is(&["forward"]) && !of_a_wheel => {
            of(Meaning::SpeedForward, "m/s")
        }
        _ => return None,
    };
    let wheel = found.meaning.is_of_a_wheel().then(|| wheel(words));
    match wheel {
        Some(None) => None,
        wheel => Some(Guess {
            wheel: wheel.flatten(),
            ..found
        }),
    }
}

/// Is it the name of a gyro of one axis, with its unit at most?
fn is_gyro(words: &[String]) -> bool {
    const WORDS: &[&str] = &[
        "gyro",
        "gyroscope",
        "rad",
        "deg",
        "degrees",
        "dps",
        "per",
        "s",
    ];
    words.iter().all(|word| WORDS.contains(&word.as_str()))
}

/// Does a word name a quaternion?
pub(super) fn is_quaternion(word: &str) -> bool {
    ["orientation", "quat", "quaternion", "rotation", "q"].contains(&word)
}

/// How people shorten the places of wheels.
pub(super) fn is_corner(word: &str) -> bool {
    const CORNERS: &[&str] = &[
        "fl", "fr", "rl", "rr", "bl", "br", "ml", "mr", "lf", "rf", "lr", "rb", "lb", "l", "r",
        "left", "right",
    ];
    CORNERS.contains(&word)
}

/// The wheel that a name speaks of: what is left without the words of what is measured.
pub(super) fn wheel(words: &[String]) -> Option<String> {
    const MEASURED: &[&str] = &[
        "field", "wheel", "tick", "ticks", "count", "counts", "encoder", "enc", "velocity", "vel",
        "speed", "rate", "omega", "rpm", "position", "pos", "angle", "joint", "rad", "deg", "per",
        "s", "data", "msg", "raw", "degrees", "motor", "m", "mps", "torque", "effort", "current",
        "steering", "steer", "state", "states", "odo", "odometer", "distance", "dist", "mm", "cm",
        "ft", "v",
    ];
    let kept: Vec<&str> = words
        .iter()
        .map(String::as_str)
        .filter(|word| !MEASURED.contains(word))
        .collect();
    (!kept.is_empty()).then(|| kept.join("_"))
}

#[cfg(test)]
mod tests;
