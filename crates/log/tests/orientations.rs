//! Tables with the orientation of the robot as a quaternion: paths as SLAM and motion capture write them, with and without names.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::{Log, Sheet, suggest_for_sheets};
use grouser_slip::Measurement;

use crate::scratch::Folder;

const ROWS: i32 = 40;

/// Time in s, place in m, and yaw, pitch and roll in rad of a row.
fn motion(row: i32) -> (f64, [f64; 2], [f64; 3]) {
    let s = f64::from(row);
    let angles = [0.2 * s - 3.0, 0.2 * (0.3 * s).sin(), 0.1 * (0.2 * s).cos()];
    (1.7e9 + 0.1 * s, [0.05 * s, 0.5 - 0.02 * s], angles)
}

/// The rotation about z, then y, then x, as a quaternion x, y, z, w: the product of three half turns.
fn quaternion([yaw, pitch, roll]: [f64; 3]) -> [f64; 4] {
    let [(sy, cy), (sp, cp), (sr, cr)] = [yaw, pitch, roll].map(|angle| (0.5 * angle).sin_cos());
    [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
}

/// A path as SLAM writes it, below the given header.
fn path(header: &str, between: &str) -> String {
    let mut text = String::from(header);
    for row in 0..ROWS {
        let (time, [x, y], angles) = motion(row);
        let [i, j, k, w] = quaternion(angles);
        let numbers = [x, y, 0.3, i, j, k, w].map(|number| format!("{number:.9}"));
        writeln!(text, "{time:.3}{between}{}", numbers.join(between)).unwrap();
    }
    text
}

/// The poses that are read of a table with the column map that is proposed for it.
fn poses(text: &str) -> Vec<[f64; 3]> {
    let folder = Folder::new("orientation");
    let file = folder.file("path.txt", text.as_bytes());
    let sheet = Sheet::read(&file, |_| ()).unwrap();
    let proposed = suggest_for_sheets([(&sheet, "path.txt")]);
    let proposed = proposed.replace("\"measure\"", "0.1");
    let document = Document::from_text("robot.toml", proposed).unwrap();
    let map = robot::parse(&document).unwrap().columns.unwrap();
    of_log(text, map)
}

fn of_log(text: &str, map: columns::ColumnMap) -> Vec<[f64; 3]> {
    let bytes = Cursor::new(text.to_owned());
    let log = Log::over("path.txt".as_ref(), bytes, Some(map), &Topics::default()).unwrap();
    let samples = log.samples(&[]).unwrap().map(Result::unwrap);
    let pose = |sample: grouser_slip::Sample| match sample.measurement {
        Measurement::Pose { x, y, yaw } => Some([x, y, yaw]),
        _ => None,
    };
    samples.filter_map(pose).collect()
}

fn assert_are_the_motion(found: &[[f64; 3]], what: &str) {
    assert_eq!(found.len(), ROWS as usize, "{what}");
    for (row, [x, y, yaw]) in (0..).zip(found) {
        let (_, place, [expected, ..]) = motion(row);
        assert!(
            (x - place[0]).abs() < 1e-8 && (y - place[1]).abs() < 1e-8,
            "{what}"
        );
        let off = (yaw - expected + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU);
        assert!(
            (off - std::f64::consts::PI).abs() < 1e-7,
            "{what}: row {row}, {yaw} of {expected}"
        );
    }
}

#[test]
fn paths_of_slam_and_motion_capture_are_known_by_their_form() {
    for (header, between, what) in [
        (
            "# timestamp tx ty tz qx qy qz qw\n",
            " ",
            "names in a comment",
        ),
        (
            "# ground truth\n# file: 'run 1'\n# timestamp tx ty tz qx qy qz qw\n",
            " ",
            "three comments",
        ),
        ("", " ", "no names"),
        ("", "   ", "aligned"),
        ("", ",", "no names, commas"),
        (
            "time_s,pos_x,pos_y,pos_z,quat_x,quat_y,quat_z,quat_w\n",
            ",",
            "motion capture",
        ),
        (
            "%time,field.pose.position.x,field.pose.position.y,field.pose.position.z,field.pose.orientation.x,\
             field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n",
            ",",
            "of a bag",
        ),
    ] {
        assert_are_the_motion(&poses(&path(header, between)), what);
    }
}

#[test]
fn a_quaternion_about_z_needs_two_parts() {
    let mut text = String::from("t,x,y,z,w\n");
    for row in 0..ROWS {
        let (time, [x, y], [yaw, ..]) = motion(row);
        let (sin, cos) = (0.5 * yaw).sin_cos();
        // of any length
        writeln!(text, "{time},{x:.9},{y:.9},{},{}", 2.0 * sin, 2.0 * cos).unwrap();
    }
    let column = |name: &str, meaning: &str, unit: &str| {
        format!("{{ column = \"{name}\", meaning = \"{meaning}\", unit = \"{unit}\" }},\n")
    };
    let map = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [\n{}{}{}{}]\n",
        column("x", "pose_x", "m"),
        column("y", "pose_y", "m"),
        column("z", "orientation_z", "1"),
        column("w", "orientation_w", "1"),
    );
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    assert_are_the_motion(&of_log(&text, map.clone()), "two parts");
    // zeros are no rotation, and the row has no pose
    let zeros = text.replacen(&text.lines().nth(3).unwrap().to_owned(), "1.7e9,1,2,0,0", 1);
    assert_eq!(of_log(&zeros, map).len(), ROWS as usize - 1);
}

#[test]
fn eight_numbers_that_are_no_rotation_stay_open() {
    let mut text = String::new();
    for row in 0..ROWS {
        writeln!(text, "{} 1 2 3 0.5 0.6 0.7 0.9", 0.1 * f64::from(row)).unwrap();
    }
    let folder = Folder::new("eight");
    let sheet = Sheet::read(&folder.file("log.txt", text.as_bytes()), |_| ()).unwrap();
    assert!(sheet.columns.iter().all(|column| column.guess.is_none()));
    assert_eq!(sheet.time.unwrap().column, 0);
    assert_eq!((sheet.header_lines, sheet.rows), (0, ROWS as u64));
}

#[test]
fn the_orientation_of_an_imu_is_no_heading_of_a_pose() {
    let mut text =
        String::from("time_s,pose_x,pose_y,imu_quat_x,imu_quat_y,imu_quat_z,imu_quat_w\n");
    for row in 0..ROWS {
        let (time, [x, y], angles) = motion(row);
        let [i, j, k, w] = quaternion(angles);
        writeln!(text, "{time},{x},{y},{i},{j},{k},{w}").unwrap();
    }
    let folder = Folder::new("imu");
    let sheet = Sheet::read(&folder.file("log.csv", text.as_bytes()), |_| ()).unwrap();
    assert!(sheet.has(columns::Meaning::PoseX) && !sheet.has(columns::Meaning::OrientationZ));
}
