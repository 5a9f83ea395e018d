//! The example that ships, against the truth it was made from.

use std::path::PathBuf;

use grouser_replay::{Options, Row, run, soil_readings};
use grouser_slip::{Health, Motion, Reference, Slip};
use grouser_synthetic::FiveWheel;
use grouser_terra::catalogue;

use crate::shipped::{example, root};

fn log() -> PathBuf {
    root().join("examples/five-wheel/log.csv")
}

#[test]
fn the_mcap_gives_the_same_slips_as_the_table() {
    let five = example("five-wheel");
    let rows = |name: &str| {
        let path = root().join("examples/five-wheel").join(name);
        let mut rows = Vec::new();
        let keep = |row: &Row<'_>| {
            rows.push((row.time_s, row.wheel, row.slip, row.slip_sigma, row.motion));
            Ok(())
        };
        let summary = run(&five.log(path), &five.robot, &Options::default(), keep).unwrap();
        (rows, summary)
    };
    // Whole numbers of nanoseconds and of ticks: not even a rounding apart.
    assert_eq!(rows("log.csv"), rows("log.mcap"));
}

/// A recorder that writes nothing for 0.8 s of every 4 s: over a gap wheels and reference count on, the filter does not.
#[test]
fn gaps_of_a_log_are_no_slip_of_the_whole_way() {
    let five = example("five-wheel");
    let text = std::fs::read_to_string(log()).unwrap();
    let is_kept = |line: &&str| {
        let time_ms = line.split(',').next().and_then(|time| time.parse().ok());
        time_ms.is_none_or(|time: u32| time % 4000 >= 800)
    };
    let kept: Vec<&str> = text.lines().filter(is_kept).collect();
    let folder = std::env::temp_dir().join(format!("grouser-gaps-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("log.csv");
    std::fs::write(&path, kept.join("\n")).unwrap();
    let summary = run(
        &five.log(path),
        &five.robot,
        &Options::default(),
        |_| Ok(()),
    )
    .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let ways = summary.fused.ways;
    println!("{ways:?} {:?}", summary.along);
    let found = (
        ways.slip_by_filter().unwrap(),
        ways.slip_by_reference().unwrap(),
    );
    assert!((found.0 - found.1).abs() < 0.02, "{found:?}");
    assert!(summary.doubts().is_empty(), "{:?}", summary.doubts());
}

#[test]
fn the_bias_of_an_uncorrected_free_wheel_is_the_stated_one() {
    // ignoring the skid s_f biases a slip by −s_f (1 − S).
    let described = FiveWheel::default();
    let truth = described.generate().truth;
    let (mut found, mut true_slip, mut count) = (0.0, 0.0, 0.0);
    let five = example("five-wheel");
    let summary = run(&five.log(log()), &five.robot, &Options::default(), |row| {
        let Some(slip) = row
            .slip
            .filter(|_| row.wheel == 2 && row.time_s > 16.5 && row.time_s < 19.0)
        else {
            return Ok(());
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a row of the log"
        )]
        let end = (row.time_s * 50.0).round() as usize;
        let (a, b) = (&truth[end - 3], &truth[end + 2]);
        found += slip;
        true_slip += 1.0 - (b.way[2] - a.way[2]) / (b.rim[2] - a.rim[2]);
        count += 1.0;
        Ok(())
    })
    .unwrap();
    assert_eq!(summary.reference, Reference::FreeWheel);
    assert_eq!(summary.rejected.total(), 0);
    let (found, true_slip) = (found / count, true_slip / count);
    let stated = -described.free_slip.1 * (1.0 - true_slip);
    println!("bias {:.4}, stated {stated:.4}", found - true_slip);
    // To first order in s_f: its square, 4e-4, is left; and the gyro's noise on wheels 0.25 m apart.
    assert!((found - true_slip - stated).abs() < 0.004);
}

#[test]
fn the_patch_the_brake_and_the_stops_are_told_apart() {
    let five = example("five-wheel");
    let mut motions = Vec::new();
    let summary = run(&five.log(log()), &five.robot, &Options::default(), |row| {
        motions.push((row.time_s, row.wheel, row.motion, row.slip));
        Ok(())
    })
    .unwrap();
    let share = |from: f64, to: f64, motion: Motion| {
        let within = motions.iter().filter(|m| m.0 > from && m.0 < to && m.1 < 4);
        let of = within.clone().filter(|m| m.2 == Some(motion)).count();
        of as f64 / within.count() as f64
    };
    assert!(share(0.6, 2.0, Motion::Standstill) > 0.99);
    assert!(share(4.0, 28.0, Motion::Driving) > 0.99);
    assert!(share(29.5, 31.5, Motion::Braking) > 0.99);
    assert!(share(35.7, 37.8, Motion::Driving) > 0.99); // backwards
    let patch = summary.wheels[2].slip.p95.unwrap();
    assert!(patch > 0.33 && patch < 0.42, "{patch}");
    assert!(summary.wheels[4].is_reference && summary.wheels[4].slip.median.is_none());
    assert!((summary.duration_s - 40.0).abs() < 1e-9);
}

#[test]
fn the_soil_says_what_the_slip_means() {
    let five = example("five-wheel");
    let summary = five.summary(log(), &Options::default());
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let readings = soil_readings(&summary, &five.robot.robot, &soil).unwrap();
    assert_eq!(readings.len(), 4);
    for reading in &readings {
        assert!(reading.sinkage.unwrap() > 0.001 && reading.sinkage.unwrap() < 0.1);
        assert!(reading.torque.unwrap() > 0.0);
        let best = reading.best_slip.unwrap();
        assert!((reading.above_best.unwrap() - (reading.slip - best)).abs() < 1e-15);
        assert!(
            reading
                .efficiency
                .is_none_or(|own| own <= reading.best_efficiency.unwrap())
        );
    }
}

#[test]
fn with_the_skid_of_the_right_soil_the_bias_is_gone() {
    // The example's free wheel skids as the model says on dry sand while it is in the patch.
    let five = example("five-wheel");
    let truth = FiveWheel::default().generate().truth;
    // All wheels are in the patch from 16.5 to 19 s.
    let options = Options {
        from_s: Some(17.0),
        to_s: Some(19.0),
        ..Options::whole_log()
    };
    let summary = five.summary(log(), &options);
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let readings = soil_readings(&summary, &five.robot.robot, &soil).unwrap();
    for (index, reading) in readings.iter().enumerate().skip(2) {
        let (a, b) = (&truth[825], &truth[950]);
        let slip = 1.0 - (b.way[index] - a.way[index]) / (b.rim[index] - a.rim[index]);
        let (plain, corrected) = (reading.slip - slip, reading.slip_with_skid.unwrap() - slip);
        println!(
            "{}: bias {plain:.4}, with the skid {corrected:.4}",
            reading.wheel
        );
        // Uncorrected: 0.016 × 0.65 = 0.010. Both: the gyro's bias, 0.001 × 0.25/0.2 = 0.001, and the
        // median of a slip that wanders by 0.02 over four correlation times, 0.006.
        assert!(corrected.abs() < plain.abs());
        assert!(corrected.abs() < 0.01, "{corrected}");
    }
}

/// Against the truth of the tenth of a second around each row, the free wheel's own skid left out as in P23.
#[test]
fn the_filter_follows_closer_than_the_bare_mean_and_looking_back_closer_still() {
    let truth = FiveWheel::default().generate().truth;
    let five = example("five-wheel");
    // of the true distances of wheels and centres between two rows, which no counter and no free wheel rounds
    let between = |wheel: usize, from: usize, to: usize| {
        let (a, b) = (&truth[from], &truth[to]);
        let skid = (b.way[4] - a.way[4]) - (b.rim[4] - a.rim[4]);
        let (rim, way) = (
            b.rim[wheel] - a.rim[wheel],
            b.way[wheel] - a.way[wheel] - skid,
        );
        let slip = Slip::from_speeds(way, rim).ok().filter(|_| way * rim > 0.0);
        (slip.map(Slip::value), way.abs().max(rim.abs()))
    };
    let rmse = |smooth| {
        let (mut squares, mut count, mut normalised, mut bare) = (0.0, 0.0, 0.0, 0.0);
        let options = Options {
            offline: smooth,
            ..Options::default()
        };
        run(&five.log(log()), &five.robot, &options, |row| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a row of the log"
            )]
            let at = (row.time_s * 50.0).round() as usize;
            if let (Some(slip), Some(sigma), Health::Ok) = (row.slip, row.slip_sigma, row.health)
                && (25..truth.len() - 3).contains(&at)
                // 5 cm/s: slower than that a slip says little
                && let (Some(expected), 0.005..) = between(row.wheel, at - 3, at + 2)
                && let (Some(mean), _) = between(row.wheel, at - 25, at)
            {
                squares += (slip - expected).powi(2);
                normalised += ((slip - expected) / sigma).powi(2);
                bare += (mean - expected).powi(2);
                count += 1.0;
            }
            Ok(())
        })
        .unwrap();
        [squares, bare]
            .map(|sum: f64| (sum / count).sqrt())
            .into_iter()
            .chain([normalised / count])
            .collect::<Vec<f64>>()
    };
    let (filter, both) = (rmse(false), rmse(true));
    println!(
        "RMSE, that of the mean over the last half second, squared error over variance: {filter:.4?}, both ways {both:.4?}"
    );
    assert!(filter[0] < filter[1] && both[0] < filter[0]);
    assert!(filter[2] < 2.0 && both[2] < 2.0);
}
