//! Slips by the whole log against the truth, and against centred means, on drives whose slip is known.

use std::fmt::Write as _;
use std::io;

use grouser_files::Document;
use grouser_files::robot::{self, RobotFile, WheelSensor};
use grouser_replay::{Engine, Inputs, Options, Row, Sink};
use grouser_slip::{Measurement, Reference, Sample};
use grouser_synthetic::{Disturbance, KnownTruth, SlipProfile, TruthStep};

/// Errors count from here on, and up to this before the end, s.
const MARGIN_S: f64 = 3.0;

/// Ticks a turn of the wheels as the drives have them.
const TICKS: u64 = 1000;

fn file(position_sigma: f64, ticks: u64) -> RobotFile {
    let mut text = format!(
        "format = 1\nname = \"known truth\"\n[estimator]\nposition_sigma_m = {position_sigma}\n"
    );
    for wheel in KnownTruth::robot().unwrap().wheels() {
        let (name, x, y) = (&wheel.name, wheel.x, wheel.y);
        writeln!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {x:?}\ny_m = {y:?}\nradius_m = 0.1\ndrive = \"powered\"\n\
             ticks_per_turn = {ticks}"
        )
        .unwrap();
    }
    robot::parse(&Document::from_text("robot.toml", text).unwrap()).unwrap()
}

/// Slips of four wheels over time.
#[derive(Default)]
struct Slips(Vec<(f64, usize, f64, f64)>);

impl Sink for Slips {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        if let Some((slip, sigma)) = row.slip.zip(row.slip_sigma) {
            assert!(
                slip.is_finite() && sigma.is_finite() && sigma > 0.0,
                "{row:?}"
            );
            self.0.push((row.time_s, row.wheel, slip, sigma));
        }
        Ok(())
    }
}

/// RMSE by the whole log, the smaller RMSE of the centred means over 1 s and 2 s, and the share of 90 % intervals that hold.
#[derive(Clone, Copy, Debug)]
struct Score {
    rmse: f64,
    centred: f64,
    held: f64,
}

/// RMSE of the mean over `window_s`, half before and half after.
fn centred_rmse(steps: &[TruthStep], window_s: f64) -> f64 {
    let readings: Vec<_> = (steps.iter())
        .filter_map(|step| Some((step.time_s, step.rim_way, step.position?)))
        .collect();
    let half = 0.5 * window_s + 1e-9;
    let (mut sum, mut count) = (0.0, 0.0);
    for step in steps {
        let next = readings.partition_point(|of| of.0 < step.time_s + half - 2e-9);
        let last = readings.partition_point(|of| of.0 <= step.time_s - half + 2e-9);
        if let (Some(a), Some(b)) = (last.checked_sub(1).map(|i| readings[i]), readings.get(next)) {
            let moved = (b.2[0] - a.2[0]).hypot(b.2[1] - a.2[1]);
            sum += (1.0 - moved / (b.1 - a.1) - step.slip).powi(2);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

fn drive(wheel_speed: f64, accelerations: bool, disturbance: Disturbance, seed: u64) -> KnownTruth {
    KnownTruth {
        rim_speed: wheel_speed,
        accelerations,
        disturbance,
        profile: SlipProfile::Steps,
        position_sigma: 0.02,
        duration_s: 120,
        seed: 1000 * seed + 17,
    }
}

/// The score of the drive's samples, each changed; errors count where `counts` of the time.
fn score<Logged: IntoIterator<Item = Sample>>(
    steps: &[TruthStep],
    (reference, position_sigma): (Reference, f64),
    change: impl FnMut(Sample) -> Logged,
    counts: impl Fn(f64) -> bool,
) -> Score {
    let file = file(position_sigma, TICKS);
    score_by(&file, steps, reference, change, counts)
}

/// The same by another description of the robot.
fn score_by<Logged: IntoIterator<Item = Sample>>(
    file: &RobotFile,
    steps: &[TruthStep],
    reference: Reference,
    mut change: impl FnMut(Sample) -> Logged,
    counts: impl Fn(f64) -> bool,
) -> Score {
    let inputs = Inputs {
        wheel_sensor: WheelSensor::Count,
        reference,
        speed_place: [0.0; 2],
        position_sigma: None,
        is_acceleration_forward_only: false,
    };
    let options = Options {
        offline: true,
        ..Options::default()
    };
    let mut engine = Engine::new(file, inputs, &options).unwrap();
    let mut slips = Slips::default();
    for sample in steps.iter().flat_map(|step| &step.samples) {
        for sample in change(*sample) {
            engine.push(sample, &mut slips).unwrap();
        }
    }
    engine.finish(&mut slips).unwrap();
    let (from, until) = (MARGIN_S, steps[steps.len() - 1].time_s - MARGIN_S);
    let begin = steps[0].time_s;
    let (mut squares, mut held, mut count) = (0.0, 0.0, 0.0);
    for (time, wheel, slip, sigma) in slips.0 {
        let at = steps.partition_point(|step| step.time_s - begin < time - 1e-6);
        let step = &steps[at.min(steps.len() - 1)];
        if (from..until).contains(&step.time_s) && counts(step.time_s) {
            let error = slip - step.wheel_slips[wheel];
            squares += error * error;
            held += f64::from(error.abs() <= 1.645 * sigma);
            count += 1.0;
        }
    }
    Score {
        rmse: f64::sqrt(squares / count),
        centred: centred_rmse(steps, 1.0).min(centred_rmse(steps, 2.0)),
        held: held / count,
    }
}

fn as_logged(sample: Sample) -> [Sample; 1] {
    [sample]
}

const POSE: (Reference, f64) = (Reference::Pose, 0.02);

#[test]
fn errors_are_half_of_the_centred_mean_s_and_intervals_hold() {
    for (wheel_speed, accelerations) in [
        (0.1, false),
        (0.1, true),
        (1.0, false),
        (1.0, true),
        (3.0, false),
    ] {
        let steps = drive(wheel_speed, accelerations, Disturbance::Clean, 1).steps();
        let one = score(&steps, POSE, as_logged, |_| true);
        println!("{wheel_speed} m/s {accelerations}: {one:?}");
        assert!(one.rmse <= 0.5 * one.centred, "{wheel_speed} m/s: {one:?}");
        assert!(one.held >= 0.85, "{wheel_speed} m/s: {one:?}");
    }
}

#[test]
fn places_replace_the_displacements_that_are_made_of_them() {
    for wheel_speed in [0.25, 1.0] {
        let steps = drive(wheel_speed, false, Disturbance::Clean, 6).steps();
        let mut before = None;
        let change = |sample: Sample| {
            let Measurement::Pose { x, y, yaw } = sample.measurement else {
                return [Some(sample), None].into_iter().flatten();
            };
            // as a log gives them
            let (at_x, at_y) = before.replace((x, y)).unwrap_or((x, y));
            let (sin, cos) = yaw.sin_cos();
            let (dx, dy) = (x - at_x, y - at_y);
            let displacement = Measurement::Displacement {
                forward: cos * dx + sin * dy,
                left: cos * dy - sin * dx,
                turn: None,
            };
            let place = Measurement::Position { x, y };
            let of = |measurement| {
                Some(Sample {
                    measurement,
                    ..sample
                })
            };
            [of(place), of(displacement)].into_iter().flatten()
        };
        let one = score(&steps, (Reference::Displacement, 0.02), change, |_| true);
        println!("{wheel_speed} m/s: {one:?}");
        assert!(one.rmse <= 0.5 * one.centred, "{wheel_speed} m/s: {one:?}");
        assert!(one.held >= 0.8, "{wheel_speed} m/s: {one:?}");
    }
}

#[test]
fn outliers_lose_their_weight() {
    let steps = drive(1.0, false, Disturbance::Outliers, 2).steps();
    let one = score(&steps, POSE, as_logged, |_| true);
    println!("{one:?}");
    assert!(one.rmse <= 0.5 * one.centred, "{one:?}");
}

#[test]
fn wheels_that_are_read_at_half_the_rate_of_the_accelerometer_are_as_good() {
    let steps = drive(0.5, true, Disturbance::Clean, 3).steps();
    let all = score(&steps, POSE, as_logged, |_| true);
    let mut is_read = false;
    let half = |sample: Sample| {
        is_read ^= matches!(sample.measurement, Measurement::YawRate { .. });
        (is_read || !sample.measurement.is_rotation()).then_some(sample)
    };
    let one = score(&steps, POSE, half, |_| true);
    println!("{all:?} {one:?}");
    assert!(one.rmse <= 1.25 * all.rmse, "{one:?}");
}

#[test]
fn long_logs_in_blocks_are_as_good_at_the_seams() {
    let long = KnownTruth {
        duration_s: 1000,
        profile: SlipProfile::Waves,
        ..drive(1.0, false, Disturbance::Clean, 4)
    };
    let steps = long.steps();
    let whole = score(&steps, POSE, as_logged, |_| true);
    let near = |time: f64| (time - 400.0).abs() < 5.0 || (time - 800.0).abs() < 5.0;
    let seams = score(&steps, POSE, as_logged, near);
    println!("{whole:?} {seams:?}");
    assert!(seams.rmse <= 1.3 * whole.rmse, "{seams:?} {whole:?}");
}

#[test]
fn gaps_and_readings_that_are_none_leave_the_rest_as_it_is() {
    let steps = drive(1.0, true, Disturbance::Clean, 5).steps();
    let begin = steps[0].samples[0].time_ns;
    let change = |mut sample: Sample| {
        let time = (sample.time_ns - begin) as f64 * 1e-9;
        // all silent for 3 s, one wheel for 20 s, garbage in the others
        if (50.0..53.0).contains(&time) {
            return None;
        }
        match &mut sample.measurement {
            Measurement::WheelCount { wheel: 2, .. } if (60.0..80.0).contains(&time) => {
                return None;
            }
            Measurement::Pose { x, .. } if (90.0..91.0).contains(&time) => *x = f64::NAN,
            Measurement::YawRate { rate } if (95.0..95.2).contains(&time) => *rate = f64::INFINITY,
            Measurement::Acceleration { forward, .. } if (97.0..98.0).contains(&time) => {
                *forward = f64::MAX;
            }
            _ => {}
        }
        Some(sample)
    };
    let away = |time: f64| !(48.0..55.0).contains(&time);
    let all = score(&steps, POSE, as_logged, away);
    let one = score(&steps, POSE, change, away);
    println!("{all:?} {one:?}");
    assert!(one.rmse <= 1.3 * all.rmse, "{one:?} {all:?}");
}

/// The filter's first steps are shorter than those of wheels that are read seldom: the whole log is smoothed all the same.
#[test]
fn wheels_that_are_read_five_times_a_second_are_smoothed_too() {
    let steps = drive(1.0, true, Disturbance::Clean, 6).steps();
    let begin = steps[0].samples[0].time_ns;
    let seldom = |sample: Sample| {
        let is_read = (sample.time_ns - begin) % 200_000_000 == 0;
        let is_count = matches!(sample.measurement, Measurement::WheelCount { .. });
        (is_read || !is_count).then_some(sample)
    };
    let [all, five] = [
        score(&steps, POSE, as_logged, |_| true),
        score(&steps, POSE, seldom, |_| true),
    ];
    println!("{all:?} {five:?}");
    assert!(five.rmse <= 0.5 * five.centred, "{five:?} {all:?}");
}

/// A tick is as long as the distance over a step of 50 ms: what is noise in a distance must not become slip.
#[test]
fn coarse_encoders_do_not_bias_the_slip() {
    const COARSE: u64 = 20;
    let steps = drive(0.25, false, Disturbance::Clean, 7).steps();
    let coarse = |mut sample: Sample| {
        if let Measurement::WheelCount { raw, .. } = &mut sample.measurement {
            *raw /= COARSE;
        }
        Some(sample)
    };
    let fine = score(&steps, POSE, as_logged, |_| true);
    let file = file(POSE.1, TICKS / COARSE);
    let one = score_by(&file, &steps, POSE.0, coarse, |_| true);
    println!("{fine:?} {one:?}");
    assert!(one.rmse <= 0.5 * one.centred, "{one:?} {fine:?}");
}

/// Visual odometry that lost track for 8 s: what moved meanwhile is in none of its displacements.
#[test]
fn a_gap_of_displacements_is_no_standstill() {
    let steps = drive(0.5, false, Disturbance::Clean, 8).steps();
    let begin = steps[0].samples[0].time_ns;
    let is_out = |time: f64| (60.0..68.0).contains(&time);
    let mut before = None;
    let moved = |sample: Sample| {
        let Measurement::Pose { x, y, yaw } = sample.measurement else {
            return Some(sample);
        };
        let (at_x, at_y, was) = before.replace((x, y, yaw)).unwrap_or((x, y, yaw));
        let (sin, cos) = (0.5 * (yaw + was)).sin_cos();
        let (dx, dy) = (x - at_x, y - at_y);
        let measurement = Measurement::Displacement {
            forward: cos * dx + sin * dy,
            left: cos * dy - sin * dx,
            turn: Some(yaw - was),
        };
        let time = (sample.time_ns - begin) as f64 * 1e-9;
        (!is_out(time)).then_some(Sample {
            measurement,
            ..sample
        })
    };
    let reference = (Reference::Displacement, 0.02);
    let near = |time: f64| (58.0..70.0).contains(&time);
    let one = score(&steps, reference, moved, near);
    println!("{one:?}");
    assert!(one.rmse <= 0.1 && one.held >= 0.8, "{one:?}");
}

/// A slip that neither wanders nor jumps for good: what the two priors differ by belongs to the interval.
#[test]
fn intervals_hold_where_neither_prior_of_the_slip_does() {
    let blips = KnownTruth {
        profile: SlipProfile::Blips,
        ..drive(1.0, false, Disturbance::Clean, 10)
    };
    let one = score(&blips.steps(), POSE, as_logged, |_| true);
    println!("{one:?}");
    assert!(one.held >= 0.9, "{one:?}");
}
