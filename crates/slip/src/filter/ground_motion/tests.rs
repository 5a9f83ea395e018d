use grouser_terra::Angle;

use super::*;
use crate::filter::input::Input;
use crate::filter::settings::FilterSettings;
use crate::robot::{Robot, Wheel};
use crate::sample::Sample;
use crate::state::{Degraded, Health};

const MS: i64 = 1_000_000;
const RADIUS_M: f64 = 0.1;
/// The wheels' heading beside the robot's, rad.
const DIRECTION_RAD: f64 = 0.4;
/// The robot's speed along the wheels and across, m/s, and yaw rate, rad/s.
const SPEED_M_PER_S: f64 = 0.3;
const ACROSS_M_PER_S: f64 = 0.03;
const TURN_RAD_PER_S: f64 = 0.2;
/// What the gyro measures beyond the turn.
const GYRO_OFFSET_RAD_PER_S: f64 = 0.01;
const POSE_PERIOD_MS: i64 = 100;

/// A drive: rim speed of all wheels, m/s, and the other sensors.
#[derive(Clone, Copy)]
struct Drive {
    rim: f64,
    has_gyro: bool,
    by_angle: bool,
    /// Are the wheels in one line along their heading, so that they show no turn?
    in_line: bool,
}

const SLIPPING: Drive = Drive {
    rim: 0.4,
    has_gyro: false,
    by_angle: false,
    in_line: false,
};

impl Drive {
    fn core(self) -> Core {
        let places = if self.in_line {
            [-0.5, -0.2, 0.1, 0.6]
                .map(|x| (x * f64::cos(DIRECTION_RAD), x * f64::sin(DIRECTION_RAD)))
        } else {
            [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
        };
        let wheels = places.map(|(x, y)| {
            Wheel::powered(format!("{x} {y}"))
                .at(x, y)
                .heading(Angle::from_rad(DIRECTION_RAD))
                .radius(RADIUS_M)
        });
        let robot = Robot::new("crab".into(), wheels.into()).unwrap();
        Core::new(&robot, FilterSettings::default())
    }

    fn pose(time_ms: i64) -> Measurement {
        // along a circle: the way is its chord at the mean heading
        let time_s = time_ms as f64 * 1e-3;
        let middle = DIRECTION_RAD + 0.5 * TURN_RAD_PER_S * time_s;
        let chord = f64::sin(0.5 * TURN_RAD_PER_S * time_s) / (0.5 * TURN_RAD_PER_S);
        Measurement::Pose {
            x: chord * (SPEED_M_PER_S * f64::cos(middle) - ACROSS_M_PER_S * f64::sin(middle)),
            y: chord * (SPEED_M_PER_S * f64::sin(middle) + ACROSS_M_PER_S * f64::cos(middle)),
            yaw: TURN_RAD_PER_S * time_s,
        }
    }

    /// Goes on from one time to another, with the poses of the times that are their period's.
    fn go(self, core: &mut Core, from_ms: i64, to_ms: i64, has_poses: bool) {
        let input = Input::new(core.wheels.channels.len(), &core.settings);
        for time_ms in (from_ms..to_ms).step_by(10) {
            let mut add = |measurement| {
                let time_ns = time_ms * MS;
                let sample = Sample {
                    time_ns,
                    measurement,
                };
                core.step(&sample, &input).unwrap();
            };
            if self.has_gyro {
                // one that repeats its value to the bit is stuck
                let noise = 1e-6 * (time_ms % 30) as f64;
                let rate = TURN_RAD_PER_S + GYRO_OFFSET_RAD_PER_S + noise;
                add(Measurement::YawRate { rate });
            }
            let rate = self.rim / RADIUS_M;
            for wheel in 0..4 {
                add(if self.by_angle {
                    let angle = rate * time_ms as f64 * 1e-3;
                    Measurement::WheelAngle { wheel, angle }
                } else {
                    Measurement::WheelRate { wheel, rate }
                });
            }
            if has_poses && time_ms % POSE_PERIOD_MS == 0 {
                add(Self::pose(time_ms));
            }
        }
    }

    fn driven(self, to_ms: i64) -> Core {
        let mut core = self.core();
        self.go(&mut core, 0, to_ms, true);
        core
    }
}

fn near(value: f64, expected: f64) -> bool {
    (value - expected).abs() <= 1e-12 * expected.abs()
}

/// The state holds the models' motion in the robot's frame: v = R (v, δ v), and u = v + s m ties the speed to the slip.
#[test]
fn the_models_motion_and_its_covariance_are_turned_into_the_robot_s_frame() {
    for (rim, is_braking) in [(0.4, false), (0.24, true)] {
        let mut core = Drive { rim, ..SLIPPING }.driven(3_005);
        let now_ns = core.now_ns.unwrap();
        core.follow_ground_motion(now_ns, Some(0.7));
        let ground = core.ground.as_ref().unwrap();
        let (motion, direction, rim) = ground.motion(now_ns, &core.settings).unwrap();
        assert!((motion.slip < -0.1) == is_braking && motion.slip.abs() > 0.1);
        assert!(near(direction, DIRECTION_RAD) && motion.drift.abs() > 0.01);
        let axes = [
            [f64::cos(DIRECTION_RAD), f64::sin(DIRECTION_RAD)],
            [-f64::sin(DIRECTION_RAD), f64::cos(DIRECTION_RAD)],
        ];
        let faster = if is_braking { motion.speed } else { rim };
        let spreads = [
            motion.slip_sigma * faster,
            motion.drift_sigma * motion.speed,
        ];
        let velocity = [motion.speed, motion.drift * motion.speed];
        let state = &core.state;
        for (a, i) in [FORWARD, LEFT].into_iter().enumerate() {
            let mean: f64 = (0..2).map(|k| axes[k][a] * velocity[k]).sum();
            assert!(near(state.mean(i), mean), "{i}");
            for (b, j) in [FORWARD, LEFT].into_iter().enumerate() {
                let of = |k: usize| spreads[k] * spreads[k] + SPEED_VARIANCE_FLOOR;
                let expected: f64 = (0..2).map(|k| of(k) * axes[k][a] * axes[k][b]).sum();
                assert!((state.covariance(i, j) - expected).abs() < 1e-15, "{i} {j}");
            }
            let by_slip = -axes[0][a] * motion.slip_sigma * spreads[0];
            assert!(near(state.covariance(i, COMMON_SLIP), by_slip), "{i}");
        }
        assert_eq!(state.mean(COMMON_SLIP), motion.slip);
        assert!(near(
            state.covariance(COMMON_SLIP, COMMON_SLIP),
            motion.slip_sigma * motion.slip_sigma
        ));
        assert_eq!(state.mean(YAW), 0.7 - motion.turn_error.value);
        assert_eq!(state.covariance(YAW, YAW), motion.turn_error.variance);
    }
}

#[test]
fn the_gyro_s_bias_is_taken_from_the_models_where_they_know_it_better() {
    const KNOWN_BIAS_RAD_PER_S: f64 = 0.004;
    let drive = Drive {
        has_gyro: true,
        ..SLIPPING
    };
    let core = drive.driven(3_005);
    let now_ns = core.now_ns.unwrap();
    let ground = core.ground.as_ref().unwrap();
    let error = ground.motion(now_ns, &core.settings).unwrap().0.turn_error;
    // a variance whose share is that of the models to the bit
    let mut at = error.variance / BETTER_VARIANCE_SHARE * (1.0 - 1e-14);
    while BETTER_VARIANCE_SHARE * at < error.variance {
        at = at.next_up();
    }
    for (variance, is_taken) in [
        (at * (1.0 + 1e-9), true),
        (at * (1.0 - 1e-9), false),
        (2.0 * at, true),
        (at, error.variance < BETTER_VARIANCE_SHARE * at),
    ] {
        let mut core = core.clone();
        core.state.reset(GYRO_BIAS, KNOWN_BIAS_RAD_PER_S, variance);
        core.learn_gyro_bias(now_ns);
        let expected = if is_taken {
            (KNOWN_BIAS_RAD_PER_S + error.value, error.variance)
        } else {
            (KNOWN_BIAS_RAD_PER_S, variance)
        };
        let is = (
            core.state.mean(GYRO_BIAS),
            core.state.covariance(GYRO_BIAS, GYRO_BIAS),
        );
        assert_eq!(is, expected, "{variance}");
    }
    assert!(error.value.abs() > 0.0);
}

#[test]
fn readings_are_counted_and_a_turn_counts_where_neither_gyro_nor_wheels_show_it() {
    for (has_gyro, in_line, is_used) in [
        (false, true, true),
        (true, true, false),
        (true, false, false),
    ] {
        let drive = Drive {
            has_gyro,
            in_line,
            ..SLIPPING
        };
        let mut core = drive.driven(3_000);
        let counted = |core: &Core| {
            let output = &core.output;
            [output.reference_readings, output.reference_refused]
        };
        let before = counted(&core);
        let variance = core.state.covariance(YAW, YAW);
        let bias = core.state.covariance(GYRO_BIAS, GYRO_BIAS);
        let taken_ms = 3_000;
        drive.go(&mut core, taken_ms, taken_ms + 10, false);
        let variance = if has_gyro {
            core.state.covariance(YAW, YAW)
        } else {
            variance
        };
        core.update_ground_motion(taken_ms * MS, &Drive::pose(taken_ms))
            .unwrap();
        assert_eq!(counted(&core), [before[0] + 1, before[1]]);
        assert_eq!(
            core.state.covariance(YAW, YAW) < variance,
            is_used,
            "{has_gyro} {in_line}"
        );
        assert!(core.state.covariance(GYRO_BIAS, GYRO_BIAS) <= bias);
        // a jump of a metre is refused
        drive.go(&mut core, taken_ms + 10, taken_ms + 110, false);
        let Measurement::Pose { x, y, yaw } = Drive::pose(taken_ms + 100) else {
            unreachable!()
        };
        let (x, y) = (x + 1.0, y - 1.0);
        let jumped = Measurement::Pose { x, y, yaw };
        core.update_ground_motion((taken_ms + 100) * MS, &jumped)
            .unwrap();
        assert_eq!(counted(&core), [before[0] + 2, before[1] + 1]);
    }
}

/// Headings that contradict the gyro one after the other are right: its bias is as uncertain as at the start.
#[test]
fn a_gyro_that_headings_contradict_has_its_bias_in_doubt() {
    let drive = Drive {
        has_gyro: true,
        ..SLIPPING
    };
    let mut core = drive.driven(3_000);
    for index in 0..20 {
        let time_ms = 3_000 + POSE_PERIOD_MS * index;
        drive.go(&mut core, time_ms, time_ms + POSE_PERIOD_MS, false);
        let Measurement::Pose { x, y, yaw } = Drive::pose(time_ms) else {
            unreachable!()
        };
        let yaw = yaw + 1.0;
        core.update_ground_motion(time_ms * MS, &Measurement::Pose { x, y, yaw })
            .unwrap();
        if core.ground.as_ref().unwrap().has_wrong_turn() {
            let variance = core.settings.gyro_bias * core.settings.gyro_bias;
            let is = core.state.covariance(GYRO_BIAS, GYRO_BIAS);
            assert_eq!(is.to_bits(), variance.to_bits());
            return;
        }
    }
    panic!("no heading was found wrong");
}

#[test]
fn a_late_reading_waits_for_the_rims_of_its_time() {
    let drive = Drive {
        by_angle: true,
        ..SLIPPING
    };
    let core = drive.driven(3_000);
    let newest_ns = 2_990 * MS;
    assert!(core.are_rims_read_since(newest_ns) && !core.are_rims_read_since(newest_ns + 1));
    assert!(!drive.core().are_rims_read_since(0));
    // a period after the last, or more than 1.3 periods; beyond the last reading of the rims, or not
    for (to_ms, stamp_ms, is_used) in [
        (3_000, 2_999, true),
        (3_000, 3_000, true),
        (3_200, 3_190, true),
        (3_200, 3_195, false),
    ] {
        let mut core = core.clone();
        drive.go(&mut core, 3_000, to_ms, false);
        let before = core.output.reference_readings;
        core.update_ground_motion(stamp_ms * MS, &Drive::pose(stamp_ms))
            .unwrap();
        let is = core.output.reference_readings - before;
        assert_eq!(is, u64::from(is_used), "{to_ms} {stamp_ms}");
    }
}

/// Rims of 0.2 m/s and 0.5 m/s at 0.4 m to either side turn the robot by 0.3/0.8 rad/s.
#[test]
fn wheels_show_a_turn_by_how_unlike_their_rims_run() {
    let places = [(0.5, 0.4), (0.5, -0.4)];
    let wheels = places.map(|(x, y)| Wheel::powered(format!("{y}")).at(x, y).radius(RADIUS_M));
    let robot = Robot::new("cart".into(), wheels.into()).unwrap();
    let mut core = Core::new(&robot, FilterSettings::default());
    assert!(core.turn_by_wheels().is_none());
    for (wheel, value) in [(0, 0.2), (1, 0.5)] {
        let variance = 1e-4;
        core.wheels.channels[wheel].rim = Some((Measured { value, variance }, 0));
    }
    let turn = core.turn_by_wheels().unwrap();
    let sigma = core.wheels.turn_sigma(0.375, &core.settings);
    assert!(near(turn.value, 0.375) && near(turn.variance, sigma * sigma));
}

#[test]
fn a_reference_that_has_just_started_is_a_reservation() {
    let readmitted = Health::Degraded(Degraded::ReferenceReadmitted);
    let drive = Drive {
        has_gyro: true,
        ..SLIPPING
    };
    for (to_ms, expected) in [(1_500, readmitted), (3_000, Health::Ok)] {
        let mut core = drive.driven(to_ms);
        let input = Input::new(4, &core.settings);
        core.update_health(core.now_ns.unwrap(), &input);
        assert_eq!(core.output.estimates[0].health, expected, "{to_ms}");
    }
}
