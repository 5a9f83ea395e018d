//! Short displacements of a robot without a free wheel.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Options, run};

const DT_S: f64 = 0.05;
const RADIUS_M: f64 = 0.1;
const HALF_TRACK_M: f64 = 0.3;
const SPEED_M_PER_S: f64 = 1.0;

/// 0.1, and twice 0.4 for some seconds.
fn slip(time_s: f64) -> f64 {
    let is_soft = (10.0..15.0).contains(&time_s) || (20.0..25.0).contains(&time_s);
    if is_soft { 0.4 } else { 0.1 }
}

/// A cart with a displacement every `every` rows, on a circle.
fn cart(every: i32, turn_rad_per_s: f64) -> (Log, robot::RobotFile) {
    cart_by_frame(every, turn_rad_per_s, "halfway")
}

/// As [`cart`], with displacements in the frame of halfway or of the previous row.
fn cart_by_frame(every: i32, turn_rad_per_s: f64, frame: &str) -> (Log, robot::RobotFile) {
    let mut table = String::from("t,left,right,gyro,dx,dy,dyaw");
    let (mut angles, mut way) = ([0.0; 2], 0.0);
    let turn = turn_rad_per_s * f64::from(every) * DT_S;
    let chord_over_arc = if turn == 0.0 {
        1.0
    } else {
        (0.5 * turn).sin() / (0.5 * turn)
    };
    for row in 0..600 {
        let time_s = f64::from(row) * DT_S;
        for (angle, y) in angles.iter_mut().zip([HALF_TRACK_M, -HALF_TRACK_M]) {
            let speed = SPEED_M_PER_S - turn_rad_per_s * y;
            *angle += speed / (1.0 - slip(time_s)) * DT_S / RADIUS_M;
        }
        // errors of 1 mm that no generator draws
        let error = 1e-3 * (f64::from(row * row) * 0.7).sin();
        way += SPEED_M_PER_S * DT_S + error;
        let time_s = time_s + DT_S;
        let [left, right] = angles;
        write!(
            table,
            "\n{time_s:.4},{left:.6},{right:.6},{turn_rad_per_s},"
        )
        .unwrap();
        if (row + 1) % every == 0 {
            let chord = way * chord_over_arc;
            let turned = turn + 0.1 * error;
            let ahead = if frame == "previous" {
                0.5 * turned
            } else {
                0.0
            };
            let [dx, dy] = [ahead.cos(), ahead.sin()].map(|part| chord * part);
            write!(table, "{dx:.6},{dy:.6},{turned:.6}").unwrap();
            way = 0.0;
        } else {
            table.push_str(",,");
        }
    }
    let map = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
        { column = \"left\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" },\n\
        { column = \"right\", meaning = \"wheel_angle\", wheel = \"right\", unit = \"rad\" },\n\
        { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n\
        { column = \"dx\", meaning = \"displacement_forward\", unit = \"m\", frame = \"FRAME\" },\n\
        { column = \"dy\", meaning = \"displacement_left\", unit = \"m\" },\n\
        { column = \"dyaw\", meaning = \"displacement_turn\", unit = \"rad\" },\n]\n";
    let map = map.replace("FRAME", frame);
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let log = Log::over(
        "log.csv".as_ref(),
        Cursor::new(table),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    let mut text = String::from(
        "format = 1\nname = \"cart\"\n[estimator]\nreference = \"displacement\"\nwheel_sensor = \"angle\"\n",
    );
    for (name, y) in [("left", HALF_TRACK_M), ("right", -HALF_TRACK_M)] {
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = {y}\nradius_m = {RADIUS_M}\ndrive = \"powered\""
        )
        .unwrap();
    }
    let file = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    (log, file)
}

/// Means over half a second know no motion beside them: "0.000 m driven, 0.000 m without compensation".
#[test]
fn displacements_that_come_seldom_have_their_way_in_the_odometry() {
    let (log, file) = cart(40, 0.0);
    let summary = run(&log, &file, &Options::default(), |_| Ok(())).unwrap();
    let odometry = summary.odometry.unwrap();
    println!("{odometry:?}");
    // 30 m, less the way up to the second displacement; of the rims 20 s at 1/0.9 m/s and 10 s at 1/0.6 m/s
    let [by_filter, by_rims] = [odometry.distance, odometry.distance_of_wheels];
    assert!((25.0..30.0).contains(&by_filter), "{odometry:?}");
    assert!((32.0..39.0).contains(&by_rims), "{odometry:?}");
}

/// The filter knows how the errors of displacements add up, and uses them as they come. Where they were added up over a quarter of
/// a second first, a jump of slip was seen so much later.
#[test]
fn short_displacements_show_a_jump_of_slip_at_once() {
    let (log, file) = cart(1, 0.0);
    let (mut square, mut count) = (0.0, 0.0);
    run(&log, &file, &Options::default(), |row| {
        let since_jump = [10.0, 15.0, 20.0, 25.0].map(|jump| row.time_s - jump);
        let just_jumped = since_jump.iter().any(|since| (0.1..0.6).contains(since));
        if let Some(found) = row.slip.filter(|_| just_jumped) {
            // the row's way ends at its time
            square += (found - slip(row.time_s - 1e-6)).powi(2);
            count += 1.0;
        }
        Ok(())
    })
    .unwrap();
    let rmse = f64::sqrt(square / count);
    println!("after jumps: rmse {rmse:.4}");
    assert!(rmse < 0.1, "{rmse}");
}

/// A displacement is that of the frame halfway, or of the previous row as its column states: a turn between two of them is no
/// motion to the side.
#[test]
fn displacements_of_bends_show_the_slip_of_each_wheel() {
    let bends = [(20, 0.4), (40, 0.3), (40, -0.3)];
    let frames = bends.map(|bend| ["halfway", "previous"].map(|frame| (bend, frame)));
    for ((every, turn_rad_per_s), frame) in frames.into_iter().flatten() {
        let (log, file) = cart_by_frame(every, turn_rad_per_s, frame);
        let mut worst: f64 = 0.0;
        run(&log, &file, &Options::default(), |row| {
            let is_steady = (5.0..10.0).contains(&row.time_s);
            if let Some(found) = row.slip.filter(|_| is_steady) {
                worst = worst.max((found - slip(row.time_s - 1e-6)).abs());
            }
            Ok(())
        })
        .unwrap();
        println!("every {every} rows, {turn_rad_per_s} rad/s, {frame}: {worst:.4}");
        assert!(worst > 0.0 && worst < 0.02, "{worst}");
    }
}

/// The way to the left alone does not show by which angle the frame has turned.
#[test]
fn a_frame_of_the_previous_row_needs_the_turn() {
    let parse = |columns: &str| {
        let text = format!(
            "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"s\" }}\ncolumns = [{columns}]\n"
        );
        columns::parse(&Document::from_text("map.toml", text).unwrap())
    };
    let dx = "{ column = \"dx\", meaning = \"displacement_forward\", unit = \"m\", frame = \"previous\" }";
    let dy = "{ column = \"dy\", meaning = \"displacement_left\", unit = \"m\" }";
    let error = parse(&format!("{dx}, {dy}")).unwrap_err().to_string();
    assert!(error.contains("needs `displacement_turn`"), "{error}");
    let error = parse(&format!(
        "{}, {dx}",
        dy.replace(" }", ", frame = \"previous\" }")
    ));
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("belongs to `displacement_forward`"),
        "{error}"
    );
}
