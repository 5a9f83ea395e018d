//! `OnBoard::tick` under any input: a robot that drives, with arbitrary samples, clocks and requests between.
//!
//! Each run is a drive of 20 s with real modes (slip, digging, soft ground, leaning), into which samples of any bit pattern are
//! put. What holds of every tick is checked at every tick; `mode_machine.rs` enumerates the modes.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test fails by panicking, and prints what it covered; its counts are small"
)]

use std::collections::BTreeMap;

use grouser_slip::control::{Decides, Mode, Request, WheelCommand};
use grouser_slip::onboard::{OnBoard, OnBoardSettings, SoilFamily, SoilLearnSettings, StartPolicy};
use grouser_slip::{Measurement, Robot, Sample, Wheel};
use grouser_terra::catalogue;

use crate::four_wheels::four_wheels;
use crate::noise::Noise;

const PERIOD_NS: i64 = 20_000_000;
const PERIOD_S: f64 = 0.02;
const TICKS: usize = 1000;
const RUNS: u64 = 150;
const POWERED: usize = 4;
const MAX_STEERING_RAD: f64 = 0.6;
/// The loop counts a step as at most this long, s (`SensorWatchdog`).
const MAX_STEP_S: f64 = 0.1;
/// The filter's wheels count as silent within this time after their last sample, s; `blind_time` begins then.
const NOTICED_S: f64 = 0.55;

fn robot() -> Robot {
    let mut wheels = four_wheels(4096);
    let free = Wheel::free("e").at(-0.5, 0.0).radius(0.1);
    wheels.push(free.ticks_per_turn(4096).load(3.0));
    Robot::new("five wheels".into(), wheels).unwrap()
}

/// Any bit pattern, or one of the numbers that break things more often.
fn any_number(noise: &mut Noise) -> f64 {
    const SPECIAL: [f64; 9] = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        -0.0,
        1e300,
        -1e19,
    ];
    if noise.uniform() < 0.5 {
        f64::from_bits(noise.bits())
    } else {
        SPECIAL[(noise.bits() % 9) as usize]
    }
}

fn any_measurement(noise: &mut Noise) -> Measurement {
    let wheel = if noise.uniform() < 0.9 {
        (noise.bits() % 5) as usize
    } else {
        usize::MAX
    };
    let mut number = || any_number(noise);
    let [a, b, c] = [number(), number(), number()];
    let [d, e, f] = [number(), number(), number()];
    match noise.bits() % 12 {
        0 => Measurement::WheelCount {
            wheel,
            raw: noise.bits(),
        },
        1 => Measurement::WheelAngle { wheel, angle: a },
        2 => Measurement::WheelRate { wheel, rate: a },
        3 => Measurement::Inertial {
            force: [a, b, c],
            rate: [d, e, f],
        },
        4 => Measurement::YawRate { rate: a },
        5 => Measurement::Acceleration {
            forward: a,
            left: b,
        },
        6 => Measurement::Displacement {
            forward: a,
            left: b,
            turn: Some(c),
        },
        7 => Measurement::Pose { x: a, y: b, yaw: c },
        8 => Measurement::Speed {
            forward: a,
            left: Some(b),
        },
        9 => Measurement::JointAngle {
            joint: wheel,
            angle: a,
        },
        10 => Measurement::MotorCurrent { wheel, share: a },
        _ => Measurement::Carrier {
            wheel,
            turn: a,
            forward: b,
            up: c,
        },
    }
}

/// The ground under a drive for a while.
#[derive(Clone, Copy)]
struct Ground {
    slip: f64,
    /// Share of the torque that the wheels need.
    torque: f64,
    pitch: f64,
    roll: f64,
}

fn any_ground(noise: &mut Noise) -> Ground {
    let kind = noise.uniform();
    Ground {
        slip: if kind < 0.4 {
            0.1
        } else {
            0.99 * noise.uniform()
        },
        torque: if kind > 0.8 { 0.98 } else { 0.3 },
        pitch: if noise.uniform() < 0.3 { -0.15 } else { 0.0 },
        roll: if kind > 0.97 { 0.8 } else { 0.0 },
    }
}

/// What a run is beside its seed.
#[derive(Clone, Copy)]
struct Kind {
    decides: Decides,
    start_policy: StartPolicy,
    is_hostile: bool,
    steers: bool,
}

/// A robot that follows its commands, with arbitrary samples in between.
struct Drive {
    on_board: OnBoard,
    noise: Noise,
    kind: Kind,
    max: (f64, f64, f64),
    time_ns: i64,
    ways: [f64; 5],
    commands: Vec<WheelCommand>,
    mode: Mode,
}

impl Drive {
    fn new(seed: u64, kind: Kind) -> Self {
        let robot = robot();
        let mut settings = OnBoardSettings::new(&robot);
        settings.control.decides = kind.decides;
        settings.start_policy = kind.start_policy;
        settings.control.max_rim_speed = 0.6;
        (settings.control.dig_time, settings.control.soft_time) = (0.3, 0.1);
        (settings.control.back_length, settings.control.soft_back) = (0.1, 0.1);
        (
            settings.control.traverse_length,
            settings.control.soft_across,
        ) = (0.3, 0.1);
        for setup in &mut settings.wheels[..POWERED] {
            setup.max_torque = Some(5.0);
            setup.max_steering_angle = if kind.steers { MAX_STEERING_RAD } else { 0.0 };
        }
        if seed.is_multiple_of(2) {
            let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
            let family = SoilFamily::solve(&robot, &settings.wheels, &soil);
            settings.soil.family = Some(family.unwrap());
            settings.learn = Some(SoilLearnSettings::default());
        }
        let control = settings.control;
        Self {
            on_board: OnBoard::new(&robot, settings).unwrap(),
            noise: Noise::new(seed),
            kind,
            max: (
                control.max_rim_speed,
                control.max_traction,
                control.max_acceleration,
            ),
            time_ns: 1_000_000_000,
            ways: [0.0; 5],
            commands: vec![WheelCommand::default(); 5],
            mode: Mode::Forward,
        }
    }

    /// The sensors' readings of one period in which the robot follows its commands.
    fn sense(&mut self, ground: Ground) {
        let rims: Vec<f64> = self
            .commands
            .iter()
            .map(|command| command.rim_speed)
            .collect();
        let speed = rims[..POWERED].iter().sum::<f64>() / POWERED as f64 * (1.0 - ground.slip);
        for (way, rim) in self.ways.iter_mut().zip(&rims) {
            *way += rim * PERIOD_S;
        }
        self.ways[POWERED] += speed * PERIOD_S - rims[POWERED] * PERIOD_S;
        let g = 9.81;
        let (sin, cos) = ground.pitch.sin_cos();
        let mut measurements = vec![Measurement::Inertial {
            force: [
                -g * sin,
                g * cos * ground.roll.sin(),
                g * cos * ground.roll.cos(),
            ],
            rate: [0.0; 3],
        }];
        for (wheel, way) in self.ways.iter().enumerate() {
            let ticks = (way / (0.2 * std::f64::consts::PI) * 4096.0).floor() as i64;
            measurements.push(Measurement::WheelCount {
                wheel,
                raw: ticks.cast_unsigned(),
            });
        }
        for wheel in 0..POWERED {
            measurements.push(Measurement::MotorCurrent {
                wheel,
                share: ground.torque,
            });
        }
        for measurement in measurements {
            if self.kind.is_hostile && self.noise.uniform() < 0.02 {
                let stamp = match self.noise.bits() % 3 {
                    0 => self.noise.bits().cast_signed(),
                    _ => self.time_ns,
                };
                let measurement = any_measurement(&mut self.noise);
                let now = if self.noise.uniform() < 0.5 {
                    self.time_ns
                } else {
                    stamp
                };
                self.on_board.update_at(
                    now,
                    Sample {
                        time_ns: stamp,
                        measurement,
                    },
                );
                let angle = any_number(&mut self.noise);
                // a refusal is an error, and no panic
                let _ = self
                    .on_board
                    .set_steering_angle(wheel_of(&mut self.noise), angle);
            }
            self.on_board.update(Sample {
                time_ns: self.time_ns,
                measurement,
            });
        }
    }

    fn any_request(&mut self) -> Request {
        let noise = &mut self.noise;
        let is_wild = self.kind.is_hostile && noise.uniform() < 0.05;
        if is_wild {
            return Request {
                speed: any_number(noise),
                heading: any_number(noise),
                yaw_rate: (noise.uniform() < 0.5).then(|| any_number(noise)),
            };
        }
        Request {
            speed: 0.3,
            heading: 0.0,
            yaw_rate: None,
        }
    }

    /// One tick, with what holds of every one.
    fn tick(&mut self, passed_s: f64, request: Request) {
        let (max_rim, max_traction, max_acceleration) = self.max;
        let before = std::mem::take(&mut self.commands);
        let commands = self.on_board.tick(self.time_ns, request).to_vec();
        assert_eq!(commands.len(), 5, "one command for each wheel");
        let max_change = 2.0 * max_acceleration * passed_s.min(MAX_STEP_S) + 1e-12;
        for (wheel, (command, before)) in commands.iter().zip(&before).enumerate() {
            assert!(
                command.rim_speed.is_finite() && command.rim_speed.abs() <= max_rim,
                "{command:?} for {request:?} with {:?}, heading {}, observations {:?}",
                self.on_board.speed(),
                self.on_board.attitude().heading(),
                self.on_board.observations()
            );
            assert!(
                (0.0..=max_traction).contains(&command.traction),
                "{command:?}"
            );
            let steering = if self.kind.steers && wheel < POWERED {
                MAX_STEERING_RAD
            } else {
                0.0
            };
            assert!(command.steering_angle.abs() <= steering, "{command:?}");
            if wheel >= POWERED {
                assert_eq!(
                    (command.rim_speed, command.traction),
                    (0.0, 0.0),
                    "a free wheel"
                );
            }
            let change = (command.rim_speed - before.rim_speed).abs();
            assert!(change <= max_change, "{change} m/s in {passed_s} s");
            if self.mode == Mode::Stopped {
                assert!(
                    command.rim_speed.abs() <= before.rim_speed.abs(),
                    "it stops"
                );
            }
        }
        let mode = self.on_board.mode();
        assert!(
            self.mode != Mode::Stopped || mode == Mode::Stopped,
            "a stop is final: {mode:?}"
        );
        match self.kind.decides {
            Decides::Nothing => assert_eq!(mode, Mode::Forward),
            Decides::Stops => assert!(matches!(mode, Mode::Forward | Mode::Stopped)),
            Decides::BacksOut => assert!(!matches!(mode, Mode::Traverse | Mode::Detour)),
            _ => {}
        }
        if let Some(decision) = self.on_board.decision() {
            assert!(
                decision.value.is_finite() && decision.limit.is_finite(),
                "{decision:?}"
            );
            assert!(
                decision.wheel.is_none_or(|wheel| wheel < POWERED),
                "{decision:?}"
            );
            assert_eq!(decision.time_ns, self.time_ns);
        }
        self.mode = mode;
        self.commands = commands;
    }

    fn run(&mut self, mut seen: impl FnMut(&Self)) {
        let mut ground = any_ground(&mut self.noise);
        for step in 0..TICKS {
            if step % 60 == 59 {
                ground = any_ground(&mut self.noise);
            }
            let passed = if self.kind.is_hostile && self.noise.uniform() < 0.01 {
                // a loop that was late, whose clock stood, or was set
                [0, 700_000_000, -3_000_000_000, i64::MAX / 4][(self.noise.bits() % 4) as usize]
            } else {
                PERIOD_NS
            };
            self.time_ns = self.time_ns.saturating_add(passed);
            self.sense(ground);
            let request = self.any_request();
            // a clock that stands or is set back counts as 0.025 s while the robot stops
            let passed_s = if passed > 0 {
                passed as f64 * 1e-9
            } else {
                0.025
            };
            self.tick(passed_s, request);
            seen(self);
        }
    }
}

fn wheel_of(noise: &mut Noise) -> usize {
    (noise.bits() % 6) as usize
}

const DECIDES: [Decides; 4] = [
    Decides::Everything,
    Decides::BacksOut,
    Decides::Stops,
    Decides::Nothing,
];

fn kinds() -> impl Iterator<Item = (u64, Kind)> {
    (0..RUNS).map(|seed| {
        let kind = Kind {
            decides: DECIDES[[0, 0, 1, 2, 3][(seed % 5) as usize]],
            start_policy: if seed % 7 == 0 {
                StartPolicy::Off
            } else {
                StartPolicy::Report
            },
            is_hostile: seed % 4 != 0,
            steers: seed % 3 == 0,
        };
        (seed, kind)
    })
}

#[test]
fn every_tick_of_any_drive_keeps_its_promises() {
    let mut modes: BTreeMap<&str, usize> = BTreeMap::new();
    for (seed, kind) in kinds() {
        let mut drive = Drive::new(seed, kind);
        drive.run(|drive| *modes.entry(drive.mode.name()).or_default() += 1);
    }
    println!("{modes:?}");
    // the drives visit the modes that the promises are about
    for mode in ["Forward", "BackOut", "Traverse", "Detour", "Stopped"] {
        assert!(
            modes.get(mode).is_some_and(|ticks| *ticks > 100),
            "{mode} of {modes:?}"
        );
    }
}

#[test]
fn from_any_moment_silent_sensors_end_in_the_safe_stop_within_its_time() {
    let mut slowest = 0.0_f64;
    for (seed, kind) in kinds() {
        if kind.decides == Decides::Nothing {
            continue;
        }
        let mut drive = Drive::new(seed, kind);
        let moment = 50 + (seed as usize * 37) % (TICKS - 50);
        let mut ticks = 0;
        let mut from = None;
        drive.run(|drive| {
            ticks += 1;
            if ticks == moment {
                from = Some((
                    drive.on_board.clone(),
                    drive.time_ns,
                    drive.commands.clone(),
                ));
            }
        });
        let (on_board, time_ns, commands) = from.unwrap();
        // beyond the range of times nothing passes any more: that is the clock's silence, tested below
        if time_ns > i64::MAX / 8 {
            continue;
        }
        let mut silent = Drive {
            on_board,
            time_ns,
            commands,
            mode: Mode::Forward,
            ..Drive::new(seed, kind)
        };
        silent.mode = silent.on_board.mode();
        let mut passed = 0.0;
        while silent.mode != Mode::Stopped {
            silent.time_ns += PERIOD_NS;
            passed += PERIOD_S;
            silent.tick(
                PERIOD_S,
                Request {
                    speed: 0.3,
                    heading: 0.0,
                    yaw_rate: None,
                },
            );
            assert!(
                passed <= NOTICED_S + 1.0,
                "seed {seed}, moment {moment}: {passed} s"
            );
        }
        slowest = slowest.max(passed);
        let braking = 0.6 / (2.0 * 0.5) / PERIOD_S + 2.0;
        for _ in 0..braking.ceil() as usize {
            silent.time_ns += PERIOD_NS;
            silent.tick(
                PERIOD_S,
                Request {
                    speed: 0.3,
                    heading: 0.0,
                    yaw_rate: None,
                },
            );
        }
        assert!(
            silent
                .commands
                .iter()
                .all(|command| command.rim_speed == 0.0),
            "seed {seed}"
        );
    }
    println!("slowest {slowest:.2} s");
    assert!(slowest > 0.5, "something was measured: {slowest}");
}

#[test]
fn from_any_moment_a_clock_that_stands_ends_in_the_safe_stop() {
    for (seed, kind) in kinds() {
        if kind.decides == Decides::Nothing {
            continue;
        }
        let mut drive = Drive::new(seed, kind);
        drive.run(|_| {});
        let ahead = Request {
            speed: 0.3,
            ..Request::default()
        };
        let mut ticks = 0;
        // a second of silence in steps of 0.025 s, and the way to rest at 1 m/s²
        while drive.mode != Mode::Stopped {
            ticks += 1;
            drive.tick(0.025, ahead);
            assert!(ticks <= 42, "seed {seed}");
        }
        for _ in 0..26 {
            drive.tick(0.025, ahead);
        }
        assert!(
            drive
                .commands
                .iter()
                .all(|command| command.rim_speed == 0.0),
            "seed {seed}"
        );
    }
}

#[test]
fn a_request_that_is_not_finite_is_one_for_nothing_and_the_same_inputs_give_the_same_bits() {
    for seed in 0..40 {
        let kind = Kind {
            decides: Decides::Everything,
            start_policy: StartPolicy::Report,
            is_hostile: seed % 2 == 1,
            steers: seed % 3 == 0,
        };
        let zero = Request::default();
        for wild in [
            Request {
                speed: f64::NAN,
                heading: f64::INFINITY,
                yaw_rate: None,
            },
            Request {
                speed: f64::NEG_INFINITY,
                ..zero
            },
            zero,
        ] {
            let mut drives = [(); 2].map(|()| Box::new(Drive::new(seed, kind)));
            for step in 0..300 {
                let ground = Ground {
                    slip: 0.3,
                    torque: 0.3,
                    pitch: 0.0,
                    roll: 0.0,
                };
                let is_wild = step > 150 && step % 3 == 0;
                let driving = Request { speed: 0.3, ..zero };
                for (drive, request) in drives.iter_mut().zip([wild, zero]) {
                    drive.time_ns += PERIOD_NS;
                    drive.sense(ground);
                    drive.tick(PERIOD_S, if is_wild { request } else { driving });
                }
                assert_eq!(
                    drives[0].commands, drives[1].commands,
                    "seed {seed}, step {step}"
                );
            }
        }
    }
}

#[test]
fn sensors_that_contradict_the_description_keep_a_guarded_robot_at_rest() {
    for seed in 0..20 {
        let kind = Kind {
            decides: Decides::Everything,
            start_policy: StartPolicy::Refuse,
            is_hostile: seed % 2 == 1,
            steers: false,
        };
        let mut drive = Drive::new(seed, kind);
        for _ in 0..200 {
            drive.time_ns += PERIOD_NS;
            // upside down
            let ground = Ground {
                slip: 0.1,
                torque: 0.3,
                pitch: std::f64::consts::PI,
                roll: 0.0,
            };
            drive.sense(ground);
            let request = drive.any_request();
            drive.tick(PERIOD_S, request);
            assert!(
                drive
                    .commands
                    .iter()
                    .all(|command| command.rim_speed == 0.0),
                "seed {seed}"
            );
        }
    }
}

#[test]
fn a_robot_that_leans_too_far_stops_within_half_a_second() {
    let kind = Kind {
        decides: Decides::Stops,
        start_policy: StartPolicy::Report,
        is_hostile: false,
        steers: false,
    };
    let mut drive = Drive::new(1, kind);
    let mut leaning = 0;
    for step in 0..3000 {
        drive.time_ns += PERIOD_NS;
        let roll = if step < 200 { 0.0 } else { 0.9 };
        drive.sense(Ground {
            slip: 0.1,
            torque: 0.3,
            pitch: 0.0,
            roll,
        });
        drive.tick(
            PERIOD_S,
            Request {
                speed: 0.3,
                ..Request::default()
            },
        );
        // the attitude follows gravity with a time constant of 10 s where the gyro measured no turn
        leaning +=
            usize::from(drive.on_board.attitude().roll() > 0.62 && drive.mode == Mode::Forward);
    }
    assert_eq!(drive.mode, Mode::Stopped);
    assert!(leaning as f64 * PERIOD_S <= 0.5, "{leaning} ticks");
}
