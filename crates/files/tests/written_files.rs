//! Files that are written read back to the same values.
#![allow(
    clippy::format_push_string,
    reason = "a file is put together line by line"
)]

use std::path::{Path, PathBuf};

use grouser_files::columns::{
    self, Column, ColumnMap, Frame, Meaning, Table, TimeColumn, TimeUnit,
};
use grouser_files::{Document, robot};
use proptest::prelude::*;

fn files(folder: &str, name: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let folder = root.join(folder);
    let all = std::fs::read_dir(folder).unwrap();
    let all = all.map(|entry| entry.unwrap().path());
    all.filter(|path| path.to_string_lossy().ends_with(name))
        .collect()
}

fn robot_again(file: &robot::RobotFile) -> robot::RobotFile {
    let text = robot::to_toml(file);
    robot::parse(&Document::from_text("again.toml", text.clone()).unwrap())
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn every_shipped_robot_is_the_same_again() {
    let mut count = 0;
    for folder in ["robots", "five-wheel", "jackal", "kobuki", "robotino"] {
        for path in files(folder, ".toml") {
            if path.ends_with("columns.toml") {
                let map = columns::read(&path).unwrap();
                let text = columns::to_toml(&map);
                let again = columns::parse(&Document::from_text("again", text).unwrap()).unwrap();
                assert_eq!(again, map, "{}", path.display());
                continue;
            }
            let file = robot::read(&path).unwrap();
            assert_eq!(robot_again(&file), file, "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 6, "{count}");
}

fn name() -> impl Strategy<Value = String> {
    "[a-zA-Z0-9_ \"\\\\/µ]{1,12}"
}

/// A robot file as text, every key with a value within its limits.
fn robot_text() -> impl Strategy<Value = String> {
    let wheel = (
        (name(), -2.0..2.0_f64, -2.0..2.0_f64, -180.0..180.0_f64),
        (0.01..1.0_f64, any::<bool>(), 1.0..50.0_f64, 8..=64_u32),
        (any::<bool>(), proptest::option::of(0.01..0.5_f64)),
        (0.1..3.0_f64, -20.0..20.0_f64, 0.0..90.0_f64),
    );
    let head = (
        name(),
        (0.01..2.0_f64, 0.001..0.1_f64, 0.1..5.0_f64),
        (-0.5..0.5_f64, 0.01..1.0_f64, 0.01..3.0_f64),
        (0.1..50.0_f64, -0.5..0.5_f64, 0.1..2.0_f64, any::<bool>()),
    );
    (head, proptest::collection::vec(wheel, 1..5)).prop_map(|(head, wheels)| {
        let (name, (fast, low, yaw), (mean, sigma, walk), (mass, x, inertia, has_body)) = head;
        // names that the topics have not
        let ignored = ["a", "b"].map(|end| format!("{name}{end}"));
        let mut text = format!(
            "format = 1\nname = {name:?}\n[estimator]\nmax_speed_m_per_s = {fast:?}\nlow_speed_m_per_s = {low:?}\n\
             yaw_sigma_deg = {yaw:?}\nposition_sigma_m = {:?}\nwheel_sensor = \"angle\"\n[filter]\nslip_mean = {mean:?}\n\
             slip_sigma = {sigma:?}\naccelerometer_drift_m_per_s2_sqrt_s = {walk:?}\nreference_latency_s = {:?}\n\
             [topics]\npose = {name:?}\n\
             imu_up = \"-y\"\nimu_forward = \"z\"\ntime = \"log\"\nignore = {ignored:?}\n",
            if has_body { 0.001 } else { low }, // the usual one is stated in half of the files
            x.max(0.0) // so is 0
        );
        if has_body {
            text += &format!(
                "[chassis]\nmass_kg = {mass:?}\ncg_x_m = {x:?}\ncg_y_m = 0.0\ncg_z_m = 0.3\n\
                 inertia_xx_kg_m2 = {inertia:?}\ninertia_yy_kg_m2 = {inertia:?}\ninertia_zz_kg_m2 = 1\n"
            );
        }
        for (index, ((name, x, y, heading), (radius, powered, gear, bits), (reversed, width), body)) in
            wheels.into_iter().enumerate()
        {
            let drive = if powered { "powered" } else { "free" };
            let name = format!("{name}{index}");
            text += &format!(
                "[[wheel]]\nname = {name:?}\nx_m = {x:?}\ny_m = {y:?}\nheading_deg = {heading:?}\n\
                 radius_m = {radius:?}\ndrive = \"{drive}\"\nencoder_on = \"motor\"\ngear = {gear:?}\n\
                 counter_bits = {bits}\nreversed = {reversed}\njoint = {name:?}\n"
            );
            if let Some(width) = width {
                text += &format!("width_m = {width:?}\n");
            }
            let (mass, camber, range) = body;
            if has_body {
                text += &format!(
                    "mass_kg = {mass:?}\ncamber_deg = {camber:?}\nsteer_range_deg = {range:?}\n"
                );
            }
        }
        text
    })
}

fn map() -> impl Strategy<Value = ColumnMap> {
    let table = (
        proptest::option::of("[a-z*]{1,8}"),
        proptest::sample::select(&b",;\t| "[..]),
        prop_oneof![Just((0, 0)), (1..10_usize, 1..10_usize)],
        (
            any::<bool>(),
            name(),
            proptest::sample::select(&TimeUnit::NAMES[..]),
        ),
        (
            name(),
            name(),
            1e-3..1e3_f64,
            proptest::collection::vec(name(), 0..3),
        ),
    );
    let table = table.prop_map(
        |(file, separator, (a, b), (align_clock, time, (_, unit)), rest)| {
            let (column, wheel, factor, missing) = rest;
            let of = |meaning, wheel, factor| Column {
                joint: None,
                column: column.clone(),
                meaning,
                wheel,
                factor,
                offset: 0.0,
                frame: Frame::default(),
                is_optional: align_clock && meaning == Meaning::Sinkage,
            };
            let way = Column {
                frame: if align_clock {
                    Frame::Previous
                } else {
                    Frame::Halfway
                },
                ..of(Meaning::DisplacementForward, None, 1.0)
            };
            Table {
                file,
                separator,
                header_lines: a.max(b),
                names_line: a.min(b),
                decimal: b'.',
                missing,
                align_clock,
                time: TimeColumn {
                    nanoseconds: Some("nanosec".into()),
                    column: time,
                    unit,
                    offset_ns: 0,
                },
                columns: vec![
                    of(Meaning::WheelRate, Some(wheel.clone()), factor),
                    of(Meaning::Sinkage, Some(wheel), 1.0),
                    of(Meaning::YawRate, None, std::f64::consts::PI / 180.0),
                    of(Meaning::SpeedForward, None, 1.0 / 3.6),
                    way,
                    of(Meaning::DisplacementLeft, None, 1.0),
                    of(Meaning::DisplacementTurn, None, 1.0),
                ],
            }
        },
    );
    proptest::collection::vec(table, 1..4).prop_map(|tables| ColumnMap { tables })
}

proptest! {
    #[test]
    fn any_robot_is_the_same_again(text in robot_text()) {
        let document = Document::from_text("robot.toml", text).unwrap();
        let file = robot::parse(&document).unwrap_or_else(|error| panic!("{error}"));
        prop_assert_eq!(robot_again(&file), file);
    }

    #[test]
    fn any_column_map_is_the_same_again(map in map()) {
        let text = columns::to_toml(&map);
        let again = columns::parse(&Document::from_text("again.toml", text).unwrap()).unwrap();
        prop_assert_eq!(again, map);
    }
}
