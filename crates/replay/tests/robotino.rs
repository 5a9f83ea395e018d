//! Robotino against its overhead camera: the figures of the data page, from velocity, the first 60 rows
//! (1.9 s) cut.

use grouser_files::robot::WheelSensor;
use grouser_replay::{Options, calibrate_radius};
use grouser_slip::Robot;

use crate::shipped::{CUT, data, example};

/// Slip along the commanded direction as the data page gives it.
const FIGURES: [(&str, f64); 6] = [
    ("table_surface_exp01", 0.119),
    ("table_surface_exp26", 0.117),
    ("table_surface_exp53", 0.113),
    ("gray_surface_exp01", 0.361),
    ("gray_surface_exp26", 0.307),
    ("green_surface_exp01", 0.739),
];

#[test]
fn slip_of_the_whole_way_is_the_camera_pages() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let robotino = example("robotino");
    for (name, figure) in FIGURES {
        let summary = robotino.summary(folder.join(format!("{name}.csv.gz")), &CUT);
        let overall = summary.along.overall.unwrap();
        println!("{name}: {overall:.4}, page {figure}");
        // The page rounds to 0.0005; where the way begins (row 60 or 1.9 s) and ends within a step of
        // a quarter window shifts some 10 mm of 1.3 m with slips up to 0.3 apart: 0.003.
        assert!((overall - figure).abs() < 0.003, "{name}: {overall}");
        assert_eq!(summary.rejected.total(), 0);
    }
}

#[test]
fn median_over_windows_of_a_second_is_near_it() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let robotino = example("robotino");
    for (name, figure) in FIGURES {
        let summary = robotino.summary(folder.join(format!("{name}.csv.gz")), &CUT);
        let median = summary.along.slip.median.unwrap();
        let spread = summary.along.slip.p95.unwrap() - summary.along.slip.p5.unwrap();
        println!("{name}: median {median:.4}, page {figure}, p5-p95 {spread:.3}");
        // 16 windows without overlap, their spread about 3.3 sigma: a median's error is 1.25 sigma/4.
        assert!(
            (median - figure).abs() < 3.0 * 1.25 * spread / 3.3 / 4.0,
            "{name}: {median}"
        );
    }
}

#[test]
fn ticks_give_up_to_two_hundredths_less_than_velocity() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let robotino = example("robotino");
    for (name, _) in FIGURES {
        let path = folder.join(format!("{name}.csv.gz"));
        let by_rate = robotino.summary(path.clone(), &CUT).along.overall.unwrap();
        let ticks = Options {
            wheel_sensor: Some(WheelSensor::Count),
            ..CUT
        };
        let by_count = robotino.summary(path, &ticks).along.overall.unwrap();
        println!("{name}: rate {by_rate:.4}, count {by_count:.4}");
        assert!(
            by_rate - by_count > 0.0 && by_rate - by_count < 0.02,
            "{name}"
        );
    }
}

#[test]
fn every_wheel_that_moves_has_a_slip_and_a_sigma_that_covers_its_scatter() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let robotino = example("robotino");
    let summary = robotino.summary(folder.join("table_surface_exp53.csv.gz"), &CUT);
    for wheel in &summary.wheels {
        assert!(wheel.slip.count > 400, "{wheel:?}");
        let total: f64 = wheel.states.iter().map(|(_, share)| share).sum();
        assert!((total - 1.0).abs() < 1e-9);
        assert!((wheel.healths.values().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn calibrated_on_the_table_the_table_has_no_slip() {
    let Some(folder) = data("robotino") else {
        return;
    };
    let mut robotino = example("robotino");
    let tables = FIGURES.iter().filter(|(name, _)| name.starts_with("table"));
    let logs: Vec<_> = tables
        .clone()
        .map(|(name, _)| robotino.log(folder.join(format!("{name}.csv.gz"))))
        .collect();
    let calibration = calibrate_radius(&logs, &robotino.robot, &CUT).unwrap();
    println!("factor {:.4} {:?}", calibration.factor, calibration.factors);
    // The page: the table's slips (.113 to .119) are mostly scale, so the factor is 1 less these.
    assert!((calibration.factor - 0.8837).abs() < 0.002);
    assert!(calibration.half_spread().unwrap() < 0.005);
    let wheels = robotino.robot.robot.wheels().iter().cloned();
    let scaled = wheels.map(|wheel| {
        let radius = wheel.radius * calibration.factor;
        wheel.radius(radius)
    });
    robotino.robot.robot = Robot::new("robotino".into(), scaled.collect()).unwrap();
    for (name, figure) in FIGURES {
        let summary = robotino.summary(folder.join(format!("{name}.csv.gz")), &CUT);
        let overall = summary.along.overall.unwrap();
        // 1 − (1 − s)/factor, whichever the surface.
        let expected = 1.0 - (1.0 - figure) / calibration.factor;
        assert!(
            (overall - expected).abs() < 0.005,
            "{name}: {overall} {expected}"
        );
    }
}
