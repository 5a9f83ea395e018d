//! The controller against the faults that concern it, and its promises.
#![allow(
    clippy::cast_possible_truncation,
    reason = "a test fails by panicking; its times are short"
)]

use grouser_slip::control::{
    Action, ControlInput, ControlSettings, Controller, Decides, Decision, Ending, Mode, Reason,
    Request, WheelCommand, WheelObservation,
};
use grouser_slip::{CounterWidth, Encoder, Robot};
use proptest::prelude::*;

use crate::four_wheels::{driving, four_wheels};

/// A robot of four powered wheels.
fn robot() -> Robot {
    let encoder = Encoder::counting(1000).counter(CounterWidth::new(32).unwrap());
    let wheels = four_wheels(1000).into_iter();
    Robot::new(
        "four wheels".into(),
        wheels.map(|wheel| wheel.encoder(encoder)).collect(),
    )
    .unwrap()
}

fn rolling(rim: f64) -> WheelObservation {
    WheelObservation {
        sigma: Some(0.01),
        ..driving(0.1, rim)
    }
}

fn input(time_s: f64, wheels: &[WheelObservation]) -> ControlInput<'_> {
    ControlInput {
        time_ns: (time_s * 1e9) as i64,
        wheels,
        speed: Some(0.2),
        heading: Some(0.0),
        pitch: Some(0.0),
        roll: Some(0.0),
        slip_demand: None,
        request: Request {
            speed: 0.2,
            heading: 0.0,
            yaw_rate: None,
        },
    }
}

/// Runs at 100 Hz from `from` to `to` (s); gives commands and decisions of every step.
fn run(
    controller: &mut Controller,
    (from, to): (u32, u32),
    seen: impl Fn(f64, &[WheelCommand]) -> [WheelObservation; 4],
) -> Vec<(f64, Vec<WheelCommand>, Option<Decision>)> {
    let mut commands = vec![WheelCommand::default(); 4];
    let mut out = Vec::new();
    for step in 100 * from..100 * to {
        let time = f64::from(step) * 0.01;
        let wheels = seen(time, &commands);
        let output = controller.step(&input(time, &wheels));
        commands = output.commands.to_vec();
        out.push((time, commands.clone(), output.decision));
    }
    out
}

fn following(commands: &[WheelCommand]) -> [WheelObservation; 4] {
    [0, 1, 2, 3].map(|index| rolling(commands[index].rim_speed))
}

#[test]
fn the_usual_acceleration_is_a_share_of_gravity() {
    let usual = ControlSettings::default();
    let under = ControlSettings::under_gravity;
    let share = |gravity: f64| under(gravity).max_acceleration / gravity;
    let expected = usual.max_acceleration / 9.806_65;
    assert!(
        [1.62, 3.71, 9.806_65, 25.0]
            .iter()
            .all(|gravity| (share(*gravity) / expected - 1.0).abs() < 1e-12)
    );
    // and nothing else
    let mut moon = under(1.62);
    moon.max_acceleration = usual.max_acceleration;
    assert_eq!(moon, usual);
}

#[test]
fn a_reversed_encoder_never_gets_full_torque_for_long() {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let log = run(&mut controller, (0, 6), |time, commands| {
        let mut seen = following(commands);
        if time >= 3.0 {
            // it pushes forwards, and its encoder says backwards
            seen[1].rim_speed = Some(-commands[1].rim_speed.abs());
            seen[1].torque_share = Some(1.0);
        }
        seen
    });
    let full = log[200].1[1].traction;
    let after: Vec<_> = log.iter().filter(|(time, ..)| *time >= 3.3).collect();
    assert!(
        after
            .iter()
            .all(|(_, commands, _)| commands[1].traction <= 0.11 * full)
    );
    assert!(
        after
            .iter()
            .all(|(_, commands, _)| commands[0].traction == full)
    );
    let reported = log.iter().find_map(|(time, _, d)| {
        d.filter(|d| d.reason == Reason::EncoderReversed)
            .map(|d| (*time, d))
    });
    let (time, decision) = reported.unwrap();
    assert!(time < 4.0 && decision.action == Action::ShedTorque && decision.wheel == Some(1));
}

#[test]
fn a_stalled_wheel_sheds_its_torque_within_50_ms() {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let log = run(&mut controller, (0, 8), |time, commands| {
        let mut seen = following(commands);
        if (3.0..5.0).contains(&time) {
            seen[2].rim_speed = Some(0.0);
            seen[2].torque_share = Some(0.98);
        }
        seen
    });
    let full = log[200].1[2].traction;
    let shed = log
        .iter()
        .find(|(_, commands, _)| commands[2].traction <= 0.11 * full)
        .unwrap();
    assert!(shed.0 - 3.0 <= 0.05, "{} s", shed.0 - 3.0);
    assert!(
        log.iter()
            .any(|(_, _, d)| d.is_some_and(|d| d.reason == Reason::Stall))
    );
    // and it comes back once the wheel turns again
    assert!(log.last().unwrap().1[2].traction > 0.99 * full);
}

#[test]
fn without_a_measured_torque_a_wheel_that_stands_sheds_its_torque_within_half_a_second() {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let log = run(&mut controller, (0, 8), |time, commands| {
        let mut seen = following(commands).map(|wheel| WheelObservation {
            torque_share: None,
            ..wheel
        });
        if (3.0..5.0).contains(&time) {
            seen[2].rim_speed = Some(0.0);
        }
        seen
    });
    let full = log[200].1[2].traction;
    // rims that start are no stalled ones
    assert!(log[..300].iter().all(|(_, c, _)| c[2].traction == full));
    let is_shed = |(_, c, _): &&(f64, Vec<WheelCommand>, _)| c[2].traction <= 0.11 * full;
    let shed = log.iter().find(is_shed).unwrap().0 - 3.0;
    assert!((0.45..=0.52).contains(&shed), "{shed} s");
    assert!(log.iter().all(|(_, c, _)| c[0].traction == full));
    assert!(log.last().unwrap().1[2].traction > 0.99 * full);
}

#[test]
fn a_requested_yaw_rate_turns_the_robot_as_rims_of_a_rigid_body() {
    let mut settings = ControlSettings::default();
    settings.decides = Decides::Stops;
    settings.max_feedforward = 0.0;
    settings.max_turn = 0.5;
    for (speed, yaw_rate, turns) in [(0.2, 0.3, 0.3), (0.2, 9.0, 0.5), (0.0, -0.3, -0.3)] {
        let mut controller = Controller::new(&robot(), settings).unwrap();
        for step in 0..300 {
            let seen = [0, 1, 2, 3].map(|i| rolling(controller.commands()[i].rim_speed));
            let request = Request {
                speed,
                heading: 0.0,
                yaw_rate: Some(yaw_rate),
            };
            // whatever the heading is, no other one is held
            let heading = Some(0.01 * f64::from(step));
            controller.step(&ControlInput {
                request,
                heading,
                ..input(f64::from(step) * 0.01, &seen)
            });
        }
        for (command, y) in controller.commands().iter().zip([0.2, -0.2, 0.2, -0.2]) {
            let rim = speed - turns * y;
            assert!(
                (command.rim_speed - rim).abs() < 1e-9,
                "{command:?}, not {rim}"
            );
        }
    }
}

#[test]
fn a_controller_that_decides_stops_alone_changes_no_direction_and_stops_without_sensors() {
    let mut settings = ControlSettings::default();
    settings.decides = Decides::Stops;
    let mut controller = Controller::new(&robot(), settings).unwrap();
    // wheels that spin for a minute: the default backs out
    let spinning = |commands: &[WheelCommand]| {
        following(commands).map(|wheel| WheelObservation {
            slip: Some(0.98),
            forward_speed: Some(0.0),
            ..wheel
        })
    };
    let log = run(&mut controller, (0, 60), |_, commands| spinning(commands));
    assert_eq!(controller.mode(), Mode::Forward);
    assert!(
        log.iter()
            .all(|(_, commands, _)| commands[0].rim_speed >= 0.0)
    );
    for step in 6000..6200 {
        controller.step(&ControlInput {
            speed: None,
            ..input(f64::from(step) * 0.01, &[])
        });
    }
    assert_eq!(controller.mode(), Mode::Stopped);
}

#[test]
fn without_any_sensor_it_stops_within_the_declared_time() {
    let settings = ControlSettings::default();
    let mut controller = Controller::new(&robot(), settings).unwrap();
    run(&mut controller, (0, 3), |_, commands| following(commands));
    let mut ended = None;
    let mut last = vec![WheelCommand {
        rim_speed: f64::NAN,
        ..WheelCommand::default()
    }];
    for step in 300..700_u32 {
        let time = f64::from(step) * 0.01;
        let output = controller.step(&ControlInput {
            speed: None,
            heading: None,
            pitch: None,
            roll: None,
            ..input(time, &[])
        });
        if let Some(decision) = output.decision
            && decision.action == Action::End(Ending::SensorsLost)
        {
            ended = Some(time);
        }
        last = output.commands.to_vec();
    }
    let ended = ended.unwrap();
    assert!(ended - 3.0 <= settings.blind_time + 0.03, "{ended}");
    assert_eq!(controller.mode(), Mode::Stopped);
    assert!(last.iter().all(|command| command.rim_speed == 0.0));
}

#[test]
fn a_leaning_robot_ends_its_drive() {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let wheels = [rolling(0.2); 4];
    let mut decision = None;
    for step in 0..200 {
        let tilted = ControlInput {
            roll: Some(0.7),
            ..input(f64::from(step) * 0.01, &wheels)
        };
        decision = decision.or(controller
            .step(&tilted)
            .decision
            .filter(|d| d.wheel.is_none()));
    }
    assert_eq!(decision.unwrap().action, Action::End(Ending::Tipping));
}

#[test]
fn a_step_allocates_nothing() {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let wheels = [rolling(0.2); 4];
    let info = allocation_counter::measure(|| {
        for step in 0..1000 {
            controller.step(&input(f64::from(step) * 0.01, &wheels));
        }
    });
    assert_eq!(info.count_total, 0);
}

proptest! {
    /// Whatever the numbers are, commands are finite.
    #[test]
    fn any_input_gives_finite_commands(
        times in prop::collection::vec(any::<i64>(), 1..20),
        numbers in prop::array::uniform12(any::<f64>()),
    ) {
        let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
        let [slip, sigma, forward, rim, torque, load, speed, heading, pitch, roll, requested_speed, requested_heading] =
            numbers;
        let seen = WheelObservation {
            slip: Some(slip),
            sigma: Some(sigma),
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            torque_share: Some(torque),
            load,
            ..rolling(0.1)
        };
        for time_ns in times {
            let output = controller.step(&ControlInput {
                time_ns,
                wheels: &[seen; 3],
                speed: Some(speed),
                heading: Some(heading),
                pitch: Some(pitch),
                roll: Some(roll),
                slip_demand: None,
                request: Request {
                    speed: requested_speed,
                    heading: requested_heading,
                    yaw_rate: None,
                },
            });
            for command in output.commands {
                prop_assert!(command.rim_speed.is_finite() && command.traction.is_finite());
                prop_assert!(command.steering_angle.is_finite());
            }
        }
    }
}

/// Runs 2000 steps at the times that `time_ns` gives, with every sensor alive where `is_measured`; gives the step of the
/// end and the rims' greatest speed after it.
fn run_on_clock(
    time_ns: impl Fn(i64) -> i64,
    is_measured: impl Fn(i64) -> bool,
) -> (Option<i64>, f64) {
    let mut controller = Controller::new(&robot(), ControlSettings::default()).unwrap();
    let mut commands = vec![WheelCommand::default(); 4];
    let mut ended = None;
    for step in 0..2000 {
        let wheels = following(&commands);
        let mut now = ControlInput {
            time_ns: time_ns(step),
            ..input(0.0, &wheels)
        };
        if !is_measured(step) {
            now.speed = None;
            now.wheels = &[];
        }
        let output = controller.step(&now);
        commands = output.commands.to_vec();
        if output.mode == Mode::Stopped {
            ended = ended.or(Some(step));
        }
    }
    let fastest = commands.iter().map(|command| command.rim_speed.abs());
    (ended, fastest.fold(0.0, f64::max))
}

#[test]
fn a_clock_that_stands_or_runs_back_stops_the_robot() {
    let period = 10_000_000;
    for direction in [0, -1] {
        // three seconds of a good clock, then one that does not advance
        let (ended, fastest) = run_on_clock(
            |step| step.min(300) * period + direction * (step - 300).max(0) * period,
            |_| true,
        );
        let ended = ended.unwrap();
        assert!((300..420).contains(&ended), "{direction}: {ended}");
        assert_eq!(fastest, 0.0, "{direction}");
    }
    // a clock that is set once is followed
    let (ended, fastest) =
        run_on_clock(|step| step * period - (step / 500) * 60 * period, |_| true);
    assert!(ended.is_none() && fastest > 0.1);
}

#[test]
fn sensors_that_are_silent_most_of_each_second_stop_the_robot() {
    let period = 10_000_000;
    let (ended, fastest) = run_on_clock(|step| step * period, |step| step < 300 || step % 100 == 0);
    assert!(ended.is_some_and(|step| step < 600), "{ended:?}");
    assert_eq!(fastest, 0.0);
    // a dropout of half a second now and then is driven through
    let (ended, _) = run_on_clock(|step| step * period, |step| step % 400 >= 50);
    assert_eq!(ended, None);
}

#[test]
fn no_rim_runs_faster_than_its_limit() {
    let mut settings = ControlSettings::default();
    settings.max_rim_speed = 0.25;
    let mut controller = Controller::new(&robot(), settings).unwrap();
    let mut fastest = 0.0_f64;
    let mut commands = vec![WheelCommand::default(); 4];
    for step in 0..1000 {
        // without a slip nothing else limits the rims
        let wheels = following(&commands).map(|wheel| WheelObservation {
            slip: None,
            sigma: None,
            forward_speed: None,
            ..wheel
        });
        let mut now = input(f64::from(step) * 0.01, &wheels);
        now.request.speed = 40.0;
        commands = controller.step(&now).commands.to_vec();
        fastest = commands
            .iter()
            .map(|command| command.rim_speed)
            .fold(fastest, f64::max);
    }
    assert_eq!(fastest, 0.25);
}
