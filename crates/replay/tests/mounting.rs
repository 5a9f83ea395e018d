//! References that are mounted beside the robot's origin and turned: stated, they show the slip as one at the origin does; a yaw
//! that is not stated is named.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::Cursor;

use grouser_doctor::Mistake;
use grouser_files::{Document, columns, robot};
use grouser_log::Log;
use grouser_replay::{Doubt, Options, Summary, run};
use grouser_synthetic::Noise;

const DT_S: f64 = 0.05;
const RADIUS_M: f64 = 0.1;
const WHEELS: [(&str, f64); 2] = [("left", 0.3), ("right", -0.3)];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Pose,
    Speed,
    SpeedForward,
    Displacement,
    DisplacementWithoutTurn,
    Place,
}

use Kind::{Displacement, DisplacementWithoutTurn, Place, Pose, Speed, SpeedForward};

impl Kind {
    /// Meaning and unit of each column.
    fn columns(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Pose => &[("pose_x", "m"), ("pose_y", "m"), ("pose_yaw", "rad")],
            Place => &[("pose_x", "m"), ("pose_y", "m")],
            Speed => &[("speed_forward", "m/s"), ("speed_left", "m/s")],
            SpeedForward => &[("speed_forward", "m/s")],
            Displacement => &[
                ("displacement_forward", "m"),
                ("displacement_left", "m"),
                ("displacement_turn", "rad"),
            ],
            DisplacementWithoutTurn => &[("displacement_forward", "m"), ("displacement_left", "m")],
        }
    }
}

/// Slip, speed (m/s) and turn (rad/s) of the robot.
fn motion(time_s: f64) -> [f64; 3] {
    let slip = 0.2 - 0.2 * (TAU * time_s / 9.0).cos();
    let turn = 0.08 + 0.4 * (TAU * time_s / 13.0).sin();
    [slip, 0.5 + 0.1 * (TAU * time_s / 7.0).sin(), turn]
}

fn turned(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// Where a sensor is mounted: forwards and to the left, m, and its yaw, rad.
type Mounting = ([f64; 2], f64);

/// A drive of a minute as a table.
fn table(kind: Kind, ([ahead, aside], mounted): Mounting) -> String {
    let mut text = String::from("t,left,right,gyro");
    for (name, _) in kind.columns() {
        write!(text, ",{name}").unwrap();
    }
    let mut noise = Noise::new(5);
    let (mut angles, mut origin, mut yaw) = ([0.0; 2], [0.0; 2], 0.2);
    let mut last = None;
    for row in 0..1800 {
        let time_s = f64::from(row) * DT_S;
        let [_, speed, turn] = motion(time_s);
        let [left, right] = angles;
        let gyro = turn + 0.003 + 0.002 * noise.normal();
        write!(text, "\n{time_s:.3},{left:.5},{right:.5},{gyro:.5}").unwrap();
        // the sensor's place on the ground, and its direction
        let arm = turned(yaw, [ahead, aside]);
        let sensor = [origin[0] + arm[0], origin[1] + arm[1]];
        let [before, yaw_before] = last.unwrap_or([sensor, [yaw; 2]]);
        let half = 0.5 * (yaw + yaw_before[0]);
        let moved = turned(-half, [0, 1].map(|i| sensor[i] - before[i]));
        let mut noisy = |value: f64, sigma: f64| value + sigma * noise.normal();
        let values = match kind {
            Pose | Place => vec![
                noisy(sensor[0], 0.003),
                noisy(sensor[1], 0.003),
                noisy(yaw + mounted, 0.003),
            ],
            // the errors are the same on the robot, however the sensor is turned
            Speed => {
                let own = [noisy(speed - turn * aside, 0.02), noisy(turn * ahead, 0.02)];
                turned(-mounted, own).to_vec()
            }
            SpeedForward => {
                let own = turned(-mounted, [speed - turn * aside, turn * ahead]);
                vec![own[0] + noisy(0.0, 0.02) * mounted.cos()]
            }
            Displacement | DisplacementWithoutTurn => {
                let own = turned(-mounted, [noisy(moved[0], 0.002), noisy(moved[1], 0.002)]);
                vec![own[0], own[1], noisy(yaw - yaw_before[0], 0.001)]
            }
        };
        for place in 0..kind.columns().len() {
            // five a second
            match values.get(place).filter(|_| row % 4 == 0) {
                Some(value) => write!(text, ",{value:.5}").unwrap(),
                None => text.push(','),
            }
        }
        if row % 4 == 0 {
            last = Some([sensor, [yaw; 2]]);
        }
        for step in 0..50 {
            let dt = DT_S / 50.0;
            let [slip, speed, turn] = motion(time_s + f64::from(step) * dt);
            let along = turned(yaw + 0.5 * turn * dt, [speed * dt, 0.0]);
            origin = [origin[0] + along[0], origin[1] + along[1]];
            yaw += turn * dt;
            for (angle, (_, y)) in angles.iter_mut().zip(WHEELS) {
                *angle += (speed - turn * y) / (1.0 - slip) * dt / RADIUS_M;
            }
        }
    }
    text
}

/// The RMSE of the slips, and what is doubted.
fn estimate(kind: Kind, mounting: Mounting, keys: &str) -> Result<(f64, Summary), String> {
    let (estimator, topics) = if keys.starts_with("antenna") {
        ("", keys)
    } else {
        (keys, "")
    };
    let mut text = format!(
        "format = 1\nname = \"cart\"\n[estimator]\nposition_sigma_m = 0.003\n{estimator}\n[topics]\n{topics}\n"
    );
    let mut map = String::from(
        "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
         { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n",
    );
    for (name, y) in WHEELS {
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = 0.0\ny_m = {y}\nradius_m = {RADIUS_M}\ndrive = \"powered\""
        )
        .unwrap();
        writeln!(
            map,
            "{{ column = \"{name}\", meaning = \"wheel_angle\", wheel = \"{name}\", unit = \"rad\" }},"
        )
        .unwrap();
    }
    for (name, unit) in kind.columns() {
        writeln!(
            map,
            "{{ column = \"{name}\", meaning = \"{name}\", unit = \"{unit}\" }},"
        )
        .unwrap();
    }
    let file = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let map = columns::parse(&Document::from_text("map.toml", map + "]\n").unwrap()).unwrap();
    let table = Cursor::new(table(kind, mounting));
    let log = Log::over("log.csv".as_ref(), table, Some(map), &file.topics).unwrap();
    let (mut square, mut count) = (0.0, 0.0);
    let summary = run(&log, &file, &Options::default(), |row| {
        if let Some(found) = row.slip.filter(|_| row.time_s > 5.0) {
            square += (found - motion(row.time_s)[0]).powi(2);
            count += 1.0;
        }
        Ok(())
    })
    .map_err(|error| error.to_string())?;
    Ok((f64::sqrt(square / count), summary))
}

fn keys(kind: Kind, ([x, y], yaw): Mounting) -> String {
    match kind {
        Place => format!("antenna_x_m = {x:?}\nantenna_y_m = {y:?}"),
        _ => format!(
            "reference_x_m = {x:?}\nreference_y_m = {y:?}\npose_yaw_offset_deg = {:?}",
            yaw.to_degrees()
        ),
    }
}

const PLACES: [[f64; 2]; 5] = [
    [0.5, 0.0],
    [-0.5, 0.0],
    [0.0, 0.5],
    [0.0, -0.5],
    [0.5, -0.5],
];

#[test]
fn a_stated_mounting_is_taken_out() {
    for kind in [
        Pose,
        Speed,
        SpeedForward,
        Displacement,
        DisplacementWithoutTurn,
        Place,
    ] {
        let (right, summary) = estimate(kind, ([0.0; 2], 0.0), "").unwrap();
        assert!(
            right < 0.05 && named(&summary) == (None, None),
            "{kind:?} {right}"
        );
        let mut worst: f64 = 0.0;
        for place in PLACES {
            for yaw_deg in [0.0, 30.0, 100.0, 180.0] {
                let is_measured = match kind {
                    // at 100° the errors of speed and gyro count six times
                    SpeedForward => yaw_deg != 100.0 && (place[1] != 0.0 || yaw_deg != 0.0),
                    Place => yaw_deg == 0.0,
                    _ => true,
                };
                if !is_measured {
                    continue;
                }
                let mounting = (place, f64::to_radians(yaw_deg));
                let (rmse, summary) = estimate(kind, mounting, &keys(kind, mounting)).unwrap();
                worst = worst.max(rmse / right);
                assert_eq!(named(&summary), (None, None), "{kind:?} {mounting:?}");
            }
        }
        println!("{kind:?}: rmse {right:.4}, mounted up to {worst:.3} of it");
        assert!(worst < 1.1, "{kind:?} {worst}");
    }
}

/// The yaw that is named, rad, and the position, m, each with half of its interval.
fn named(summary: &Summary) -> (Option<[f64; 2]>, Option<[[f64; 2]; 2]>) {
    let yaw = summary.doubts().into_iter().find_map(|doubt| match doubt {
        Doubt::Description(Mistake::ReferenceTurned([angle, half])) => Some([-angle, half]),
        _ => None,
    });
    let place = (summary.findings.possible().into_iter()).find_map(|possible| match possible {
        Mistake::ReferencePlace(place) => Some(place),
        _ => None,
    });
    (yaw, place)
}

#[test]
fn a_yaw_that_is_not_stated_is_named() {
    for kind in [Pose, Speed, Displacement, DisplacementWithoutTurn] {
        for (place, yaw_deg) in [
            ([0.0; 2], -7.0),
            ([0.3, -0.4], 7.0),
            ([0.0; 2], 20.0),
            ([0.3, -0.4], 100.0),
            ([0.0; 2], 180.0),
        ] {
            let (_, summary) = estimate(kind, (place, f64::to_radians(yaw_deg)), "").unwrap();
            let [yaw, half] = named(&summary).0.unwrap();
            let off_deg = (yaw.to_degrees() - yaw_deg + 540.0).rem_euclid(360.0) - 180.0;
            println!(
                "{kind:?} {yaw_deg}: off by {off_deg:.2} of {:.2}",
                half.to_degrees()
            );
            assert!(
                off_deg.abs() < 1.5 * half.to_degrees() && half < 0.03,
                "{kind:?} {yaw_deg}"
            );
        }
    }
    // of a speed along one axis its sign alone
    let (_, summary) = estimate(SpeedForward, ([0.0; 2], std::f64::consts::PI), "").unwrap();
    assert!(named(&summary).0.is_some());
}

/// In the lists of the causes it is one that may be slip as well.
#[test]
fn a_position_that_is_not_stated_is_possible() {
    // of places alone the heading is the course, which takes up what the turn adds
    for kind in [Pose, Speed, SpeedForward, Displacement] {
        for place in PLACES {
            let (_, summary) = estimate(kind, (place, 0.0), "").unwrap();
            let has_effect = kind != SpeedForward || place[1] != 0.0;
            let found = named(&summary).1;
            assert_eq!(found.is_some(), has_effect, "{kind:?} {place:?}");
            if let Some([found, half]) = found.filter(|_| kind != SpeedForward) {
                println!("{kind:?} {place:?}: {found:.2?} ± {half:.2?}");
                let is_near = |axis: usize| (found[axis] - place[axis]).abs() < half[axis] + 0.02;
                assert!(
                    is_near(0) && is_near(1),
                    "{kind:?} {place:?} {found:?} {half:?}"
                );
            }
        }
    }
}

#[test]
fn a_key_without_effect_is_refused() {
    let refused = |kind, keys: &str| estimate(kind, ([0.0; 2], 0.0), keys).unwrap_err();
    for (kind, key) in [
        (Place, "pose_yaw_offset_deg"),
        (SpeedForward, "reference_x_m"),
        // without an inertial unit nothing shows the tilt
        (Pose, "reference_z_m"),
    ] {
        let error = refused(kind, &format!("{key} = 0.5"));
        assert!(error.contains(key), "{error}");
    }
    let error = refused(SpeedForward, "pose_yaw_offset_deg = 90.0");
    assert!(error.contains("pose_yaw_offset_deg"), "{error}");
}
