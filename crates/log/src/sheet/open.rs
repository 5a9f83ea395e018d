//! What name and numbers of a column leave open: questions, meanings on a condition, and units by size.

use grouser_files::columns::Meaning;
use grouser_files::unit::Quantity;

use super::guess::{Guess, by_name, guess, is_corner, wheel};
use super::words::{split_unit, words};
use super::{MAX_YAW_RAD, SheetColumn};
use crate::recording::is_over_ground;

/// Numbers of this size are speeds of a rim, m/s, as often as rates of a wheel.
const RIM_SPEED_M_PER_S: f64 = 3.0;
/// If it measures the ground: most odometry is computed from the wheels.
const OF_GROUND: &str =
    "if it measures the ground (camera, GNSS, lidar); not if it was made of the wheels";

/// What a column means on a condition, and the condition.
pub(crate) fn perhaps(column: &SheetColumn) -> Option<(Guess, &'static str)> {
    let name = &column.name;
    if !column.is_numeric() {
        return None;
    }
    // tools name columns by topics
    if name.starts_with('/') && !is_over_ground(name) {
        let found = guess(name, None, column.whole)?;
        let of_pose = [Meaning::PoseX, Meaning::PoseY, Meaning::PoseYaw];
        return (of_pose.contains(&found.meaning)).then_some((found, OF_GROUND));
    }
    let (words, stated) = split_unit(name);
    let of = |meaning, wheel: Option<&str>, unit| Guess {
        meaning,
        wheel: wheel.map(str::to_owned),
        unit,
    };
    let known = |own: Quantity, unit: Option<&'static str>| {
        let units = own.units().into_iter();
        unit.filter(|unit| units.map(|(known, _)| known).any(|known| known == *unit))
    };
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["distance" | "dist" | "odometer" | "odo" | "mileage"] => Some((
            of(
                Meaning::WheelDistance,
                Some("wheels"),
                known(Quantity::Length, stated.or(Some("m")))?,
            ),
            "if it is the distance driven by the wheels since some start: `wheel` names one",
        )),
        ["heading" | "yaw" | "theta"] => {
            let by_size = if column.size() > MAX_YAW_RAD {
                "deg"
            } else {
                "rad"
            };
            let unit = known(Quantity::Angle, stated.or(Some(by_size)))?;
            Some((
                of(Meaning::PoseYaw, None, unit),
                "if it is the heading of the pose and counts to the left; `scale = -1.0` if it counts to the right",
            ))
        }
        ["wz"] | ["w", "z" | "imu"] if stated.is_none() => Some((
            of(Meaning::YawRate, None, "rad/s"),
            "if it is the yaw rate, counted to the left, in rad/s (or deg/s)",
        )),
        ["acc" | "accel", "x", ..] if stated.is_none() => Some((
            of(Meaning::AccelerationForward, None, "m/s2"),
            "if it points forwards, in m/s2 (or g)",
        )),
        ["acc" | "accel", "y", ..] if stated.is_none() => Some((
            of(Meaning::AccelerationLeft, None, "m/s2"),
            "if it points to the left, in m/s2 (or g)",
        )),
        ["steering" | "steer"] if stated.is_none() => Some((
            of(Meaning::SteeringAngle, None, "rad"),
            "if it is the angle of the wheels, to the left, in rad (or deg), and no command",
        )),
        [before @ .., "speed"]
            if stated.is_none() && before.iter().any(|word| ["gps", "gnss"].contains(word)) =>
        {
            Some((
                of(Meaning::SpeedSize, None, "m/s"),
                "if it is the speed over ground, in m/s (or km/h)",
            ))
        }
        ["vel" | "velocity" | "speed"] => {
            let meaning = if column.min < 0.0 {
                Meaning::SpeedForward
            } else {
                Meaning::SpeedSize
            };
            Some((
                of(meaning, None, known(Quantity::Speed, stated)?),
                OF_GROUND,
            ))
        }
        _ => None,
    }
}

/// A yaw rate whose unit nothing states and whose numbers are often more than a turn a second, taken for rad/s, is in deg/s.
pub(super) fn of_turning(column: &SheetColumn, guess: Guess) -> Guess {
    let unit = if is_beyond_radians(column) && guess.meaning == Meaning::YawRate {
        "deg/s"
    } else {
        guess.unit
    };
    Guess { unit, ..guess }
}

/// Are its numbers often more than a turn a second in rad/s, and is no unit in its name?
pub(crate) fn is_beyond_radians(column: &SheetColumn) -> bool {
    split_unit(&column.name).1.is_none() && 100 * column.beyond_a_turn > column.numbers
}

/// What a column of a wheel may mean, where its name and its numbers leave it open: the wheel, and the question.
pub(crate) fn open_question(column: &SheetColumn) -> Option<(String, &'static str)> {
    let words = words(&column.name);
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let says_unit = split_unit(&column.name).1.is_some() || is(&["rad", "deg", "rpm", "m"]);
    if !column.is_numeric() {
        return None;
    }
    if is(&["odo", "odometer", "distance", "dist"])
        && is(&["wheel", "left", "right", "motor"])
        && guess(&column.name, None, column.whole).is_none()
    {
        let question = "`wheel_distance`, if it is the distance driven by a wheel since some start, and its unit?";
        return Some((wheel(&words)?, question));
    }
    if says_unit {
        return None;
    }
    if is(&["wheel"]) && is(&["vehicle"]) && is(&["speed"]) {
        let question =
            "`wheel_speed`, if it is the mean speed of the wheels, and its unit (J1939: km/h)?";
        return Some(("wheels".to_owned(), question));
    }
    match words.as_slice() {
        [kind, place] if kind == "w" && is_corner(place) => {
            return Some((
                place.clone(),
                "`wheel_rate`, if it is the rate of the wheel, and its unit (rad/s)?",
            ));
        }
        [kind, place] if ["vel", "v", "speed"].contains(&kind.as_str()) && is_corner(place) => {
            let question = "`wheel_speed` in m/s or `wheel_rate` in rad/s? its name does not say";
            return Some((place.clone(), question));
        }
        [kind, sensor] if kind == "vel" && sensor == "encoder" => {
            let question =
                "`wheel_speed` in m/s or `wheel_rate` in rad/s? is it negative in reverse?";
            return Some(("wheels".to_owned(), question));
        }
        _ => {}
    }
    let rate = Some(Meaning::WheelRate);
    if by_name(&words, None, column.whole).map(|guess| guess.meaning) == rate
        && is(&["vel", "velocity", "speed"])
        && column.size() <= RIM_SPEED_M_PER_S
    {
        let question = "`wheel_rate` in rad/s or `wheel_speed` in m/s? its numbers may be either";
        return Some((wheel(&words)?, question));
    }
    match words.as_slice() {
        [wheel, place] if wheel == "wheel" && is_corner(place) && !column.whole => {
            let question = "`wheel_angle`, `wheel_rate` or `wheel_speed`? its name does not say";
            Some((place.clone(), question))
        }
        _ => None,
    }
}
