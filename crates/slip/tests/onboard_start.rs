//! The check of the sensors at the start of a drive, for any gravity, tilt, warm-up and policy.

use grouser_slip::control::Request;
use grouser_slip::onboard::{OnBoard, OnBoardSettings, StartPolicy};
use grouser_slip::{Measurement, Robot, Sample, Wheel};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;

use crate::noise::Noise;

const PERIOD_NS: i64 = 10_000_000;

fn robot() -> Robot {
    let side = |name: &str, y| {
        Wheel::powered(name)
            .at(0.0, y)
            .radius(0.1)
            .ticks_per_turn(1000)
    };
    let free = Wheel::free("free")
        .at(-0.3, 0.0)
        .radius(0.1)
        .ticks_per_turn(1000);
    Robot::new(
        "tricycle".into(),
        vec![side("left", 0.2), side("right", -0.2), free],
    )
    .unwrap()
}

/// One period: the counters, an inertial unit where there is one, and a tick; true where a rim is commanded to turn.
fn step(
    on_board: &mut OnBoard,
    row: i64,
    counts: [u64; 3],
    inertial: Option<([f64; 3], f64)>,
) -> bool {
    let time_ns = row * PERIOD_NS;
    let unit = inertial.map(|(force, yaw_rate)| Measurement::Inertial {
        force,
        rate: [0.0, 0.0, yaw_rate],
    });
    let counts = (0..3).map(|wheel| Measurement::WheelCount {
        wheel,
        raw: counts[wheel],
    });
    for measurement in unit.into_iter().chain(counts) {
        on_board.update(Sample {
            time_ns,
            measurement,
        });
    }
    let request = Request {
        speed: 0.3,
        ..Request::default()
    };
    let commands = on_board.tick(time_ns, request);
    commands.iter().any(|command| command.rim_speed != 0.0)
}

fn between(noise: &mut Noise, low: f64, high: f64) -> f64 {
    low + (high - low) * noise.uniform()
}

#[test]
fn gravity_is_compared_with_its_mean_over_the_warm_up() {
    let robot = robot();
    let mut noise = Noise::new(1);
    let mut faults = 0;
    for case in 0..300_u32 {
        let policy =
            [StartPolicy::Refuse, StartPolicy::Report, StartPolicy::Off][case as usize % 3];
        let mut settings = OnBoardSettings::new(&robot);
        settings.start_policy = policy;
        settings.gravity = between(&mut noise, 0.1, 30.0);
        // shorter than the time after which silent sensors end the drive
        settings.warm_up = between(&mut noise, 0.1, 0.9);
        settings.control.max_tilt = between(&mut noise, 0.3, 1.0);
        let (gravity, warm_up, max_tilt) = (
            settings.gravity,
            settings.warm_up,
            settings.control.max_tilt,
        );
        // a mean force whose size and tilt are right or wrong by a margin; single ones are off
        let share = [1.0, 1.0, 1.0, 0.8, 1.25][(noise.bits() % 5) as usize]
            * between(&mut noise, 0.95, 1.05);
        let tilt = max_tilt * [0.2, 0.9, 1.1, 1.4][(noise.bits() % 4) as usize];
        let aside = between(&mut noise, -3.0, 3.0);
        let size = share * gravity;
        let mean = [
            size * tilt.sin() * aside.cos(),
            size * tilt.sin() * aside.sin(),
            size * tilt.cos(),
        ];
        let is_fault =
            policy != StartPolicy::Off && (!(0.9..=1.1).contains(&share) || tilt > max_tilt);
        faults += i32::from(is_fault);
        let mut on_board = OnBoard::new(&robot, settings).unwrap();
        let mut drives_at = None;
        for row in 0..300 {
            let warms = (row as f64 * 0.01) < warm_up;
            let shake = [1.0, -1.0][usize::try_from(row % 2).unwrap()] * 0.5;
            let force = match row {
                // readings that are no numbers do not count; of the others an odd last one is the mean itself
                5 => [f64::NAN; 3],
                6 => [0.0, f64::INFINITY, 0.0],
                _ if ((row + 1) as f64 * 0.01) >= warm_up && row % 2 == 0 => mean,
                _ => mean.map(|part| part * (1.0 + shake)),
            };
            // afterwards the unit has fallen silent
            let drives = step(&mut on_board, row, [0; 3], warms.then_some((force, 0.0)));
            let is_found = !warms && is_fault;
            assert_eq!(
                on_board.start_fault().is_some(),
                is_found,
                "{case}: {share} {tilt}"
            );
            if drives && drives_at.is_none() {
                drives_at = Some(row as f64 * 0.01);
            }
        }
        if policy == StartPolicy::Refuse {
            assert_eq!(drives_at.is_none(), is_fault, "{case}");
            assert!(
                drives_at.is_none_or(|at| at >= warm_up && at < warm_up + 0.05),
                "{drives_at:?}"
            );
        } else {
            assert!(
                drives_at.is_some_and(|at| at < 0.05),
                "{policy:?} {drives_at:?}"
            );
        }
    }
    assert!(faults > 60 && faults < 200, "{faults}");
}

#[test]
fn a_warm_up_ends_before_the_controller_has_been_blind_for_too_long() {
    let robot = robot();
    let mut settings = OnBoardSettings::new(&robot);
    settings.control.blind_time = settings.warm_up;
    assert!(OnBoard::new(&robot, settings.clone()).is_ok());
    settings.control.blind_time = 0.49;
    let refused = OnBoard::new(&robot, settings).unwrap_err().to_string();
    for part in ["warm_up", "0.5", "0.49", " s"] {
        assert!(refused.contains(part), "{refused}");
    }
}

#[test]
fn without_an_inertial_unit_there_is_no_gravity_to_check() {
    let robot = robot();
    let mut settings = OnBoardSettings::new(&robot);
    settings.start_policy = StartPolicy::Refuse;
    let mut on_board = OnBoard::new(&robot, settings).unwrap();
    let drives = (0..200)
        .filter(|row| step(&mut on_board, *row, [0; 3], None))
        .count();
    assert_eq!((on_board.start_fault(), drives), (None, 150));
}

/// What the robot's wheels and its unit measure after the warm-up, per row.
fn drive(
    policy: StartPolicy,
    rows: i64,
    row: impl Fn(i64) -> ([u64; 3], f64, f64),
) -> (OnBoard, usize) {
    let robot = robot();
    let mut settings = OnBoardSettings::new(&robot);
    settings.start_policy = policy;
    let mut on_board = OnBoard::new(&robot, settings).unwrap();
    let mut last_driven = 0;
    for index in 0..rows {
        let (counts, forward, yaw_rate) = row(index);
        let force = [forward, 0.0, EARTH_GRAVITY_M_PER_S2];
        if step(&mut on_board, index, counts, Some((force, yaw_rate))) {
            last_driven = usize::try_from(index).unwrap();
        }
    }
    (on_board, last_driven)
}

#[test]
fn a_gyro_that_turns_at_rest_stops_the_robot_once_the_filter_runs() {
    for (policy, rows) in [
        (StartPolicy::Refuse, 400),
        (StartPolicy::Report, 400),
        (StartPolicy::Off, 400),
    ] {
        let (on_board, last_driven) = drive(policy, rows, |_| ([0; 3], 0.0, 0.7));
        let fault = on_board.start_fault().map(|fault| fault.to_string());
        let is_named = fault
            .as_ref()
            .is_some_and(|fault| fault.contains("yaw rate"));
        assert_eq!(is_named, policy != StartPolicy::Off, "{fault:?}");
        // after the warm-up of half a second and a window of 0.2 s its rims brake
        assert_eq!(
            last_driven < 150,
            policy == StartPolicy::Refuse,
            "{policy:?} {last_driven}"
        );
        assert!(last_driven > 50);
    }
}

#[test]
fn sensors_that_were_plausible_are_not_checked_again() {
    // speeds that rise and fall, and turns, in ticks of 0.628 mm: wheels 0.2 m aside
    let plausible = |index: i64| -> ([u64; 3], f64, f64) {
        let time = (index - 100).max(0) as f64 * 0.01;
        // v = 0.3 (1 − cos 2t), ω = 0.4 sin t
        let way = 0.3 * (time - 0.5 * (2.0 * time).sin());
        let turned = 0.4 * (1.0 - time.cos());
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a counter of whole ticks, of which it has had a million"
        )]
        let ticks = |way: f64| (1e6 + way / (0.1 * std::f64::consts::TAU) * 1000.0) as u64;
        let counts = [way - 0.2 * turned, way + 0.2 * turned, way].map(ticks);
        (counts, 0.6 * (2.0 * time).sin(), 0.4 * time.sin())
    };
    let broken = |from: i64| {
        move |index: i64| {
            let (counts, forward, yaw_rate) = plausible(index);
            let factor = if index >= from { 57.3 } else { 1.0 };
            (counts, forward, factor * yaw_rate)
        }
    };
    // degrees from the start are found; degrees after 15 s of a plausible drive are no matter of the start
    let (from_start, _) = drive(StartPolicy::Report, 2500, broken(0));
    let fault = from_start.start_fault().unwrap().to_string();
    assert!(fault.contains("yaw rate"), "{fault}");
    let (later, last_driven) = drive(StartPolicy::Refuse, 2500, broken(1500));
    assert_eq!(later.start_fault(), None);
    assert!(last_driven > 1600, "{last_driven}");
}
