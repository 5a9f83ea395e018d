//! Which columns of a table are a pose: place and heading, or the fixes that stand for them.

use grouser_files::columns::Meaning;
use grouser_files::unit::Quantity;
use grouser_real::Real;

use super::guess::{Guess, is_quaternion};
use super::words::{bare_unit, words};
use super::{MAX_YAW_RAD, SheetColumn};
use crate::csv::finite;
use crate::recording::is_of_wheels;

/// Parts of a quaternion are at most 1, but for rounding, and so is the sum of their squares.
const MAX_QUATERNION_PART: f64 = 1.001;
const MAX_QUATERNION_ERROR: f64 = 2e-3;

/// Of a pose and fixes one counts: fixes before a pose that wheels may have a part in.
pub(super) fn choose_places(columns: &mut [SheetColumn]) {
    let of_pose = [Meaning::PoseX, Meaning::PoseY, Meaning::PoseYaw];
    let of_fixes = [
        Meaning::Latitude,
        Meaning::Longitude,
        Meaning::Altitude,
        Meaning::FixType,
        Meaning::FixStatus,
        Meaning::FixSigma,
    ];
    let means = |column: &SheetColumn, meanings: &[Meaning]| {
        let guess = column.guess.as_ref();
        guess.is_some_and(|guess| meanings.contains(&guess.meaning))
    };
    let [fixes, poses] = [&of_fixes[..2], &of_pose[..1]]
        .map(|meanings| columns.iter().find(|column| means(column, meanings)));
    let (Some(_), Some(pose)) = (fixes, poses) else {
        return;
    };
    let others = if is_of_wheels(&pose.name) {
        &of_pose[..]
    } else {
        &of_fixes
    };
    for column in columns.iter_mut().filter(|column| means(column, others)) {
        column.guess = None;
    }
}

/// The pose of a table that calls it `x`, `y` and `theta`, and has no other; and its yaw, where only that is bare.
pub(super) fn guess_pose(columns: &mut [SheetColumn]) {
    let has = |columns: &[SheetColumn], meaning| {
        let mut guesses = columns.iter().filter_map(|column| column.guess.as_ref());
        guesses.any(|guess| guess.meaning == meaning)
    };
    let find = |names: &[&str], default| {
        columns.iter().enumerate().find_map(|(index, column)| {
            let unit = bare_unit(&column.name, names, default).filter(|_| column.is_free())?;
            Some((index, unit))
        })
    };
    // `TX_mm`, `TY_mm`, `RZ_deg`: how Vicon exports a pose
    let yaw = find(&["theta", "yaw", "heading", "rz"], None);
    // in degrees, or counted on over several turns: the numbers do not say which
    let in_radians = |(index, _): &(usize, _)| columns[*index].size() <= MAX_YAW_RAD;
    let yaw = yaw.or_else(|| find(&["theta", "yaw", "heading"], Some("rad")).filter(in_radians));
    let found = if has(columns, Meaning::PoseX) {
        let yaw = find(&["theta", "yaw"], None).filter(|_| !has(columns, Meaning::PoseYaw));
        [yaw.map(|yaw| (Meaning::PoseYaw, yaw)), None, None]
    } else {
        if has(columns, Meaning::Latitude) {
            return;
        }
        // beside a quaternion, `tx` is in m, as SLAM writes it
        let has_quaternion = columns.iter().any(|column| {
            let part = orientation_part(&column.name);
            part.is_some_and(|(_, meaning)| meaning == Meaning::OrientationW)
        });
        let of_slam = Some("m").filter(|_| has_quaternion);
        let place =
            |bare, of_vicon| find(&[bare], Some("m")).or_else(|| find(&[of_vicon], of_slam));
        let (Some(x), Some(y)) = (place("x", "tx"), place("y", "ty")) else {
            return;
        };
        // places alone, where their names state the unit
        let has_unit =
            |(index, _): (usize, _)| bare_unit(&columns[index].name, &["x", "y"], None).is_some();
        if yaw.is_none() && !has_quaternion && !(has_unit(x) && has_unit(y)) {
            return;
        }
        [
            Some((Meaning::PoseX, x)),
            Some((Meaning::PoseY, y)),
            yaw.map(|yaw| (Meaning::PoseYaw, yaw)),
        ]
    };
    for (meaning, (index, unit)) in found.into_iter().flatten() {
        let quantity = if meaning == Meaning::PoseYaw {
            Quantity::Angle
        } else {
            Quantity::Length
        };
        if quantity.units().iter().any(|(known, _)| *known == unit) {
            columns[index].guess = Some(Guess {
                meaning,
                wheel: None,
                unit,
            });
        }
    }
}

/// A table of eight columns without names, of which the last four are a rotation, is a path as SLAM writes it (the format of the
/// TUM RGB-D benchmark): time, x, y, z, and the quaternion x, y, z, w.
pub(super) fn guess_trajectory(columns: &mut [SheetColumn]) {
    let [_, x, y, _, parts @ ..] = columns else {
        return;
    };
    let number = |column: &SheetColumn| finite(&column.first, b'.').unwrap_or(f64::NAN);
    let size: f64 = parts.iter().map(|part| Real::powi(number(part), 2)).sum();
    if parts.len() != 4 || !((size - 1.0).abs() < MAX_QUATERNION_ERROR) {
        return;
    }
    let [i, j, k, w] = parts else { return };
    for (column, meaning, unit) in [
        (x, Meaning::PoseX, "m"),
        (y, Meaning::PoseY, "m"),
        (i, Meaning::OrientationX, "1"),
        (j, Meaning::OrientationY, "1"),
        (k, Meaning::OrientationZ, "1"),
        (w, Meaning::OrientationW, "1"),
    ] {
        column.guess = Some(Guess {
            meaning,
            wheel: None,
            unit,
        });
    }
}

/// The quaternion of the pose, where no column is its yaw: of several the one whose name begins most as that of the place does.
pub(super) fn guess_orientation(columns: &mut [SheetColumn]) {
    let of = |meaning| {
        let means = move |column: &&SheetColumn| {
            let guess = column.guess.as_ref();
            guess.is_some_and(|guess| guess.meaning == meaning)
        };
        columns.iter().find(means)
    };
    let Some(place) = of(Meaning::PoseX).filter(|_| of(Meaning::PoseYaw).is_none()) else {
        return;
    };
    let place = words(&place.name);
    let is_part = |column: &SheetColumn| column.is_free() && column.size() <= MAX_QUATERNION_PART;
    let parts: Vec<(usize, Vec<String>, Meaning)> = (columns.iter().enumerate())
        .filter(|(_, column)| is_part(column))
        .filter_map(|(index, column)| {
            let (before, meaning) = orientation_part(&column.name)?;
            Some((index, before, meaning))
        })
        .collect();
    let real = parts.iter().filter(|part| part.2 == Meaning::OrientationW);
    let alike = |words: &[String]| words.iter().zip(&place).take_while(|(a, b)| a == b).count();
    let Some((_, before, _)) = real.max_by_key(|part| alike(&part.1)) else {
        return;
    };
    for (index, _, meaning) in parts.iter().filter(|part| part.1 == *before) {
        columns[*index].guess = Some(Guess {
            meaning: *meaning,
            wheel: None,
            unit: "1",
        });
    }
}

/// The part of a quaternion that a column is, with the words before it: `quat_x`, `pose.orientation.w`, `qz`. Not that of an
/// IMU, whose heading is none of a pose.
fn orientation_part(name: &str) -> Option<(Vec<String>, Meaning)> {
    let mut words = words(name);
    let last = words.pop()?;
    let part = match last.strip_prefix('q') {
        Some(part) => part,
        None if words.iter().any(|word| is_quaternion(word)) => &last,
        None => return None,
    };
    let meaning = match part {
        "x" => Meaning::OrientationX,
        "y" => Meaning::OrientationY,
        "z" => Meaning::OrientationZ,
        "w" => Meaning::OrientationW,
        _ => return None,
    };
    let is_of_imu = words.iter().any(|word| word == "imu");
    (!is_of_imu).then_some((words, meaning))
}
