//! Rows that repeat a reference's last update.

use std::convert::Infallible;

use grouser_doctor::Held;
use grouser_slip::{Measurement, Reference, Sample};

/// Updates each half second in rows of 20 ms, then a rest of four seconds whose updates are equal to the bit.
#[test]
fn a_rest_remains_observable_at_the_pace_of_the_updates() {
    let row = |row: i64| Sample {
        time_ns: 20_000_000 * row,
        measurement: Measurement::Pose {
            x: (row / 25).min(40) as f64,
            y: 0.0,
            yaw: 0.0,
        },
    };
    let rows = (0..1200).map(|i| Ok::<_, Infallible>(row(i)));
    let Ok(mut held) = Held::find(Reference::Pose, rows);
    let kept: Vec<i64> = (0..1200).filter(|i| held.keeps(&row(*i))).collect();
    assert!((held.counts().unwrap().interval_s - 0.5).abs() < 1e-9);
    let (driving, resting) = kept.split_at(41);
    let mut updates = driving.iter().zip(0..);
    assert!(updates.all(|(row, update)| *row == 25 * update));
    // one update may be missing
    assert_eq!(resting, [1055, 1080, 1105, 1130, 1155, 1180]);
}

/// Angles of a wheel and its rate in rows of 50 ms, whose angle is updated in every fourth one.
#[test]
fn an_angle_that_rows_repeat_is_no_reading() {
    let rows = || {
        (0..400).flat_map(|row: i64| {
            let angle = (row / 4) as f64 * 0.8;
            let rate = 4.0 + 0.01 * (row as f64).sin();
            [
                Measurement::WheelAngle { wheel: 0, angle },
                Measurement::WheelRate { wheel: 0, rate },
            ]
            .map(|measurement| Sample {
                time_ns: 50_000_000 * row,
                measurement,
            })
        })
    };
    let Ok(mut held) = Held::find(Reference::Pose, rows().map(Ok::<_, Infallible>));
    let kept: Vec<Sample> = rows().filter(|of| held.keeps(of)).collect();
    let is_angle = |of: &&Sample| matches!(of.measurement, Measurement::WheelAngle { .. });
    assert_eq!(kept.iter().filter(is_angle).count(), 100);
    assert_eq!(kept.len(), 500);
}
