//! Left and right encoders exchanged: found in bends to both sides on robots of two, four and six wheels, and nowhere else.

use std::fmt::Write as _;
use std::io::Cursor;

use grouser_doctor::Mistake;
use grouser_files::{Document, columns, robot, topics::Topics};
use grouser_log::Log;
use grouser_replay::{Doubt, Options, Summary, run};
use grouser_synthetic::Noise;

use crate::shipped::{ROBOTINO, data, example, root};

const DT_S: f64 = 0.02;
const ROWS: u32 = 3000;
const RADIUS_M: f64 = 0.1;
const HALF_TRACK_M: f64 = 0.3;

/// A drive in arcs of a robot with wheels in pairs, by the kinematics of its wheels alone.
#[derive(Clone, Copy, Debug)]
struct World {
    pairs: usize,
    /// Turns to both sides of the first rate, to one side of the second, rad/s.
    turns: (f64, f64),
    /// Factor on the wheels' speeds by turning: a skid-steered robot scrubs.
    scrub: f64,
    /// Slip of the left wheels, and of the inner wheels in bends.
    slip: (f64, f64),
    /// Has the log poses?
    has_pose: bool,
    /// Factor on the gyro.
    gyro: f64,
}

const PLAIN: World = World {
    pairs: 1,
    turns: (0.2, 0.0),
    scrub: 1.0,
    slip: (0.0, 0.0),
    has_pose: false,
    gyro: 1.0,
};

/// The wheels of the first side are named `l0`, `l1`, …; `shown` maps each wheel to the one whose encoder it shows.
fn summary(world: World, shown: impl Fn(usize) -> usize) -> Summary {
    let count = 2 * world.pairs;
    let mut noise = Noise::new(7);
    let name = |wheel: usize| format!("{}{}", ["l", "r"][wheel % 2], wheel / 2);
    let mut table = String::from("t,gyro,x,y,yaw");
    for wheel in 0..count {
        write!(table, ",{}", name(wheel)).unwrap();
    }
    let (mut x, mut y, mut yaw) = (0.0, 0.0, 0.0_f64);
    for row in 0..ROWS {
        let time = f64::from(row) * DT_S;
        let (speed, rate) = (0.4, world.turns.0 * (0.4 * time).sin() + world.turns.1);
        let measured = world.gyro * rate + 0.004 + 0.003 * noise.normal();
        write!(table, "\n{time:.2},{measured:.5}").unwrap();
        if world.has_pose && row % 10 == 0 {
            write!(table, ",{x:.4},{y:.4},{yaw:.5}").unwrap();
        } else {
            table.push_str(",,,");
        }
        let rims: Vec<f64> = (0..count)
            .map(|wheel| {
                let side = [1.0, -1.0][wheel % 2];
                let along = speed - world.scrub * side * HALF_TRACK_M * rate;
                let in_bend = if side * rate > 0.02 {
                    world.slip.1
                } else {
                    0.0
                };
                let slip = in_bend + if side > 0.0 { world.slip.0 } else { 0.0 };
                along / (1.0 - slip) / RADIUS_M + 0.05 * noise.normal()
            })
            .collect();
        for wheel in 0..count {
            write!(table, ",{:.5}", rims[shown(wheel)]).unwrap();
        }
        x += DT_S * speed * yaw.cos();
        y += DT_S * speed * yaw.sin();
        yaw += DT_S * rate;
    }
    let mut map = String::from(
        "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"s\" }\ncolumns = [\n\
         { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n",
    );
    if world.has_pose {
        map.push_str(
            "{ column = \"x\", meaning = \"pose_x\", unit = \"m\" },\n\
             { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\n\
             { column = \"yaw\", meaning = \"pose_yaw\", unit = \"rad\" },\n",
        );
    }
    let mut text = String::from("format = 1\nname = \"cart\"\n");
    for wheel in 0..count {
        let (name, place) = (name(wheel), (wheel / 2) as f64);
        writeln!(
            map,
            "{{ column = \"{name}\", meaning = \"wheel_rate\", wheel = \"{name}\", unit = \"rad/s\" }},"
        )
        .unwrap();
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {:.2}\ny_m = {:.2}\nradius_m = 0.1\ndrive = \"powered\"",
            0.3 - 0.3 * place,
            [1.0, -1.0][wheel % 2] * HALF_TRACK_M,
        )
        .unwrap();
    }
    map.push(']');
    let map = columns::parse(&Document::from_text("map.toml", map).unwrap()).unwrap();
    let robot = robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap();
    let log = Log::over(
        "log.csv".as_ref(),
        Cursor::new(table),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    run(&log, &robot, &Options::default(), |_| Ok(())).unwrap()
}

/// The wheels that are exchanged, and whether that is certain.
fn exchange(summary: &Summary) -> Option<(Vec<usize>, bool)> {
    summary.doubts().iter().find_map(|doubt| match doubt {
        Doubt::Description(Mistake::Exchanged {
            wheels, is_certain, ..
        }) => Some((
            (0..64).filter(|wheel| wheels >> wheel & 1 == 1).collect(),
            *is_certain,
        )),
        _ => None,
    })
}

fn found(world: World, shown: impl Fn(usize) -> usize) -> Option<(Vec<usize>, bool)> {
    let summary = summary(world, shown);
    let exchange = exchange(&summary);
    if exchange.is_some() {
        assert_eq!(summary.findings.turns.unwrap().wheel, None);
    }
    exchange
}

/// The wheels of these pairs exchanged.
fn pairs(of: &'static [usize]) -> impl Fn(usize) -> usize {
    move |wheel| {
        if of.contains(&(wheel / 2)) {
            wheel ^ 1
        } else {
            wheel
        }
    }
}

#[test]
fn exchanged_encoders_are_found_on_two_four_and_six_wheels() {
    for (count, exchanged) in [
        (1, &[0][..]),
        (2, &[0]),
        (2, &[1]),
        (2, &[0, 1]),
        (3, &[1]),
        (3, &[0, 2]),
        (3, &[0, 1, 2]),
    ] {
        let wheels: Vec<usize> = exchanged
            .iter()
            .flat_map(|pair| [2 * pair, 2 * pair + 1])
            .collect();
        let is_whole = exchanged.len() == count;
        for world in [
            PLAIN,
            World {
                scrub: 3.0,
                ..PLAIN
            },
            World {
                slip: (0.2, 0.0),
                ..PLAIN
            },
            World {
                slip: (0.0, 0.2),
                turns: (0.3, 0.05),
                ..PLAIN
            },
        ] {
            for has_pose in [false, true] {
                let world = World {
                    pairs: count,
                    has_pose,
                    ..world
                };
                let here = found(world, pairs(exchanged));
                // Where all wheels are, only a measured turn shows that the gyro is right.
                let expected = Some((wheels.clone(), has_pose || !is_whole));
                assert_eq!(here, expected, "{world:?} {exchanged:?}");
            }
        }
    }
}

/// By the wheels alone it may be either; a pose that turns as the wheels do decides.
#[test]
fn a_gyro_of_the_wrong_sign_is_not_certainly_an_exchange() {
    let world = World {
        gyro: -1.0,
        pairs: 2,
        ..PLAIN
    };
    assert_eq!(found(world, |wheel| wheel), Some((vec![0, 1, 2, 3], false)));
    let world = World {
        has_pose: true,
        ..world
    };
    assert_eq!(found(world, |wheel| wheel), None);
    let doubts = summary(world, |wheel| wheel).doubts();
    let is_sign = |doubt: &Doubt| matches!(doubt, Doubt::Description(Mistake::YawRateScale(scale)) if (scale + 1.0).abs() < 0.1);
    assert!(doubts.iter().any(is_sign), "{doubts:?}");
}

#[test]
fn slip_and_straight_drives_are_no_exchange() {
    for count in 1..4 {
        for (turns, slip, scrub) in [
            ((0.2, 0.0), (0.0, 0.0), 1.0),
            ((0.2, 0.0), (0.5, 0.0), 1.0),
            ((0.2, 0.0), (0.0, 0.5), 1.0),
            ((0.1, 0.1), (0.3, 0.3), 1.0),
            ((0.3, 0.0), (0.0, 0.0), 7.0),
            ((0.0, 0.0), (0.3, 0.0), 1.0),
        ] {
            let world = World {
                pairs: count,
                turns,
                slip,
                scrub,
                ..PLAIN
            };
            assert_eq!(found(world, |wheel| wheel), None, "{world:?}");
        }
        // Straight, or in bends to one side alone, an exchange is not observable.
        for turns in [(0.0, 0.0), (0.0, 0.2), (0.02, 0.0)] {
            let world = World {
                pairs: count,
                turns,
                ..PLAIN
            };
            assert_eq!(found(world, |wheel| wheel ^ 1), None, "{world:?}");
        }
    }
}

/// Kobuki's columns with left and right exchanged.
fn kobuki(folder: &std::path::Path, run_name: &str, is_exchanged: bool) -> Summary {
    let mut text = std::fs::read_to_string(root().join("examples/kobuki/columns.toml")).unwrap();
    if is_exchanged {
        text = text.replace("wheel = \"left\"", "wheel = \"?\"");
        text = text
            .replace("wheel = \"right\"", "wheel = \"left\"")
            .replace("wheel = \"?\"", "wheel = \"right\"");
    }
    let map = columns::parse(&Document::from_text("columns.toml", text).unwrap()).unwrap();
    let log = Log::find(&[folder.join(run_name)], map).unwrap();
    run(&log, &example("kobuki").robot, &Options::default(), |_| {
        Ok(())
    })
    .unwrap()
}

#[test]
fn measured_logs_report_an_exchange_where_one_is_planted() {
    let (Some(kobuki_data), Some(jackal), Some(robotino)) =
        (data("kobuki"), data("jackal"), data("robotino"))
    else {
        return;
    };
    for name in ["nonfaulty", "left_faulty"] {
        assert_eq!(exchange(&kobuki(&kobuki_data, name, false)), None, "{name}");
    }
    let planted = kobuki(&kobuki_data, "nonfaulty", true);
    assert_eq!(exchange(&planted), Some((vec![0, 1], false)));
    let options = Options::default();
    let drives = example("jackal").summary(jackal.join("jackal_61s.bag"), &options);
    assert_eq!(exchange(&drives), None);
    let omni =
        example("robotino").summary(robotino.join(format!("{}.csv.gz", ROBOTINO[0])), &options);
    assert_eq!(exchange(&omni), None);
    let log = root().join("examples/five-wheel/log.csv");
    let five_wheel = example("five-wheel").summary(log, &options);
    assert_eq!(exchange(&five_wheel), None);
}
