//! Readings: means over half a turn of the wheels.

use alloc::{boxed::Box, vec::Vec};

use super::super::settings::WheelSetup;
use super::contact::ContactReadings;
use super::settings::SoilLearnSettings;
use crate::control::WheelObservation;
use crate::robot::Robot;
use crate::state::{Health, Motion};

/// A robot slower than this stands, m/s: the limit of the soft-ground test.
const STANDSTILL_SPEED_M_PER_S: f64 = 0.02;
/// Soil under a wheel that starts is sheared once it has rolled this far, m: ten times the shear modulus of the shipped
/// soils.
const SHEARED_DISTANCE_M: f64 = 0.25;
/// A wheel that moves by more than this share of the robot's speed by turning does not roll straight.
const MAX_TURN_SHARE: f64 = 0.2;
/// The wheels whose slip is `Ok` must carry this share of the powered wheels' load: they stand for the others.
const MIN_LOAD_SHARE: f64 = 0.5;
/// A reading is the mean over this angle of the rims, rad: half a turn, so that the lugs' pulses and the runout of a wheel
/// average out.
const READING_ANGLE_RAD: f64 = core::f64::consts::PI;

/// A powered wheel.
#[derive(Clone, Copy, Debug)]
struct PoweredWheel {
    load: f64,
    radius: f64,
}

/// What half a turn of the wheels has shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SoilReading {
    /// Mean slip of the powered wheels, and its standard deviation, which the wheels share.
    pub(super) slip: (f64, f64),
    /// Pull of all wheels over their load.
    pub(super) pull: f64,
    /// Torque of the powered wheels over load and radius, where it is measured.
    pub(super) torque: Option<f64>,
    /// Sinkage of the leading wheels over their radius, and its standard deviation, where it is measured.
    pub(super) sinkage: Option<(f64, f64)>,
}

/// No accelerometer of a robot measures more, m/s².
const MAX_FORCE_M_PER_S2: f64 = 1000.0;
/// No soil gives more pull or torque than this multiple of the load.
const MAX_LOAD_MULTIPLE: f64 = 10.0;

impl SoilReading {
    /// False for NaN.
    fn is_possible(&self) -> bool {
        let (slip, sigma) = self.slip;
        let is_share = |value: f64| value.abs() <= MAX_LOAD_MULTIPLE;
        slip.abs() <= 1.0
            && (0.0..=1.0).contains(&sigma)
            && is_share(self.pull)
            && self.torque.is_none_or(is_share)
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Angle of the rims, rad.
    angle: f64,
    ticks: f64,
    slip: f64,
    sigma: f64,
    torque: f64,
    torques: f64,
    force: [f64; 2],
}

/// Sums samples up to readings.
#[derive(Clone, Debug)]
pub(super) struct SoilReadings {
    wheels: Box<[Option<PoweredWheel>]>,
    /// N.
    powered_load: f64,
    /// Greatest distance of a wheel from the robot's middle line, m.
    half_width: f64,
    /// Specific force forwards and upwards since the last tick, m/s².
    force: [f64; 2],
    rolled: f64,
    sums: Sums,
    pub(super) contacts: ContactReadings,
}

impl SoilReadings {
    pub(super) fn new(robot: &Robot, setups: &[WheelSetup], settings: &SoilLearnSettings) -> Self {
        let pairs = robot.wheels().iter().zip(setups);
        let wheels: Vec<_> = pairs
            .map(|(wheel, setup)| {
                setup.max_torque.map(|_| PoweredWheel {
                    load: setup.load.max(0.0),
                    radius: wheel.radius,
                })
            })
            .collect();
        let powered_load: f64 = wheels.iter().flatten().map(|wheel| wheel.load).sum();
        Self {
            half_width: robot.wheels().iter().map(|w| w.y.abs()).fold(0.0, f64::max),
            wheels: wheels.into_boxed_slice(),
            powered_load,
            force: [0.0; 2],
            rolled: 0.0,
            sums: Sums::default(),
            contacts: ContactReadings::new(robot, settings),
        }
    }

    /// A sample of the accelerometer in the robot's axes, m/s².
    pub(super) fn add_force(&mut self, force: [f64; 3]) {
        let is_possible = |value: f64| value.abs() <= MAX_FORCE_M_PER_S2;
        if !(is_possible(force[0]) && is_possible(force[2])) {
            return;
        }
        self.force = [self.force[0] + force[0], self.force[1] + force[2]];
    }

    /// What was begun is no reading: the robot does something else than to drive on.
    pub(super) fn discard(&mut self) {
        self.sums = Sums::default();
        self.force = [0.0; 2];
        self.rolled = 0.0;
        self.contacts.discard();
    }

    /// One tick of `step` seconds at `speed` (m/s) and a turning rate (rad/s); a reading once there is one.
    pub(super) fn update(
        &mut self,
        observations: &[WheelObservation],
        torques: &[Option<f64>],
        (speed, yaw_rate): (f64, f64),
        step: f64,
    ) -> Option<SoilReading> {
        let force = core::mem::take(&mut self.force);
        let tick = self.tick(observations, torques, (speed, yaw_rate), step);
        let counts = tick.is_some() && force[1] > 0.0;
        self.contacts.tick(counts);
        let now = tick.filter(|_| counts)?;
        let sums = &mut self.sums;
        sums.ticks += 1.0;
        sums.slip += now.slip;
        sums.sigma += now.sigma;
        sums.angle += now.angle;
        sums.torque += now.torque;
        sums.torques += now.torques;
        sums.force = [sums.force[0] + force[0], sums.force[1] + force[1]];
        if sums.angle < READING_ANGLE_RAD {
            return None;
        }
        let sums = core::mem::take(&mut self.sums);
        let reading = SoilReading {
            slip: (sums.slip / sums.ticks, sums.sigma / sums.ticks),
            pull: sums.force[0] / sums.force[1],
            torque: (sums.torques > 0.0).then(|| sums.torque / sums.torques),
            sinkage: self.contacts.take(),
        };
        reading.is_possible().then_some(reading)
    }

    /// Means over the wheels of one tick; `None` where the robot does not drive straight on.
    fn tick(
        &mut self,
        observations: &[WheelObservation],
        torques: &[Option<f64>],
        (speed, yaw_rate): (f64, f64),
        step: f64,
    ) -> Option<Sums> {
        if !(speed >= STANDSTILL_SPEED_M_PER_S) {
            self.rolled = 0.0;
            return None;
        }
        self.rolled += speed * step;
        let is_straight = yaw_rate.abs() * self.half_width < MAX_TURN_SHARE * speed;
        if !is_straight || self.rolled < SHEARED_DISTANCE_M {
            return None;
        }
        let mut now = Sums::default();
        let mut load = 0.0;
        let mut lever = 0.0;
        for ((seen, torque), wheel) in observations.iter().zip(torques).zip(&self.wheels) {
            let Some(wheel) = wheel else { continue };
            let (Some(slip), Some(sigma), Some(rim)) = (seen.slip, seen.sigma, seen.rim_speed)
            else {
                continue;
            };
            let drives = matches!(seen.motion, Some(Motion::Driving | Motion::Braking));
            if seen.health != Health::Ok || !drives {
                continue;
            }
            load += wheel.load;
            now.slip += wheel.load * slip;
            now.sigma += wheel.load * sigma;
            now.angle += wheel.load * rim.abs() / wheel.radius * step;
            if let Some(torque) = torque.filter(|torque| torque.is_finite()) {
                now.torque += torque;
                lever += wheel.load * wheel.radius;
            }
        }
        let is_known = load > 0.0 && load >= MIN_LOAD_SHARE * self.powered_load;
        if !is_known || !now.slip.is_finite() {
            return None;
        }
        now.slip /= load;
        now.sigma /= load;
        now.angle /= load;
        if lever > 0.0 {
            (now.torque, now.torques) = (now.torque / lever, 1.0);
        }
        Some(now)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;
    use crate::robot::Wheel;

    /// Steps whose sums are exact, s.
    const STEP_S: f64 = 1.0 / 64.0;
    const SPEED_M_PER_S: f64 = 0.5;

    /// Two powered wheels of 30 and 60 N, 0.2 m aside, and a free one of 10 N.
    fn readings() -> SoilReadings {
        let wheels = vec![
            Wheel::powered("left").at(0.0, 0.2).radius(0.1),
            Wheel::powered("right").at(0.0, -0.2).radius(0.1),
            Wheel::free("free").at(-0.3, 0.0).radius(0.1),
        ];
        let robot = Robot::new("cart".into(), wheels).expect("a robot");
        let setup = |load, max_torque| WheelSetup {
            load,
            max_torque,
            ..WheelSetup::default()
        };
        let setups = [
            setup(30.0, Some(8.0)),
            setup(60.0, Some(8.0)),
            setup(10.0, None),
        ];
        SoilReadings::new(&robot, &setups, &SoilLearnSettings::default())
    }

    fn wheel(slip: f64, sigma: f64, rim_speed: f64) -> WheelObservation {
        WheelObservation {
            slip: Some(slip),
            sigma: Some(sigma),
            health: Health::Ok,
            motion: Some(Motion::Driving),
            rim_speed: Some(rim_speed),
            ..WheelObservation::unknown(1.0)
        }
    }

    /// What the three wheels show; the free one would spoil every mean.
    fn seen() -> [WheelObservation; 3] {
        [
            wheel(0.2, 0.01, 0.3),
            wheel(0.5, 0.04, -0.4),
            wheel(-0.9, 0.9, 9.0),
        ]
    }

    const TORQUES: [Option<f64>; 3] = [Some(1.0), Some(2.0), Some(50.0)];

    /// Ticks until a reading comes, and the reading.
    fn read(
        readings: &mut SoilReadings,
        seen: &[WheelObservation; 3],
        torques: &[Option<f64>; 3],
        motion: (f64, f64),
    ) -> Option<(usize, SoilReading)> {
        (1..400).find_map(|tick| {
            readings.add_force([1.0, 7.0, 10.0]);
            let reading = readings.update(seen, torques, motion, STEP_S);
            reading.map(|reading| (tick, reading))
        })
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn a_reading_is_the_mean_over_half_a_turn_once_the_soil_is_sheared() {
        let mut readings = readings();
        // 0.25 m at 0.5 m/s are 32 steps, the last of which counts; rims of (30 · 0.3 + 60 · 0.4)/90 m/s turn by π
        let rim = (30.0 * 0.3 + 60.0 * 0.4) / 90.0;
        let turning = (core::f64::consts::PI / (rim / 0.1 * STEP_S)).ceil();
        let (ticks, reading) =
            read(&mut readings, &seen(), &TORQUES, (SPEED_M_PER_S, 0.0)).expect("a reading");
        assert_eq!(ticks as f64, 31.0 + turning);
        assert!(close(reading.slip.0, 0.4) && close(reading.slip.1, 0.03));
        assert!(close(reading.pull, 0.1));
        assert!(close(reading.torque.expect("measured"), 3.0 / (90.0 * 0.1)));
        assert_eq!(reading.sinkage, None);
        // the next one follows at once
        let (ticks, next) =
            read(&mut readings, &seen(), &TORQUES, (SPEED_M_PER_S, 0.0)).expect("a reading");
        assert!(ticks as f64 == turning && close(next.pull, 0.1));
        // after a standstill, and where what was begun is discarded, the soil is sheared first
        for stands in [true, false] {
            if stands {
                let standing = (STANDSTILL_SPEED_M_PER_S.next_down(), 0.0);
                assert_eq!(readings.update(&seen(), &TORQUES, standing, STEP_S), None);
            } else {
                readings.add_force([900.0, 0.0, 900.0]);
                readings.update(&seen(), &TORQUES, (SPEED_M_PER_S, 0.0), STEP_S);
                readings.add_force([900.0, 0.0, 900.0]);
                readings.discard();
            }
            let (ticks, next) =
                read(&mut readings, &seen(), &TORQUES, (SPEED_M_PER_S, 0.0)).expect("a reading");
            assert_eq!(ticks as f64, 31.0 + turning);
            assert!(close(next.pull, 0.1));
        }
        // the least speed is no standstill
        assert!(
            read(
                &mut readings,
                &seen(),
                &TORQUES,
                (STANDSTILL_SPEED_M_PER_S, 0.0)
            )
            .is_some()
        );
    }

    #[test]
    fn wheels_that_tell_nothing_are_left_out() {
        type Change = fn(&mut WheelObservation);
        let changes: [Change; 6] = [
            |wheel| wheel.health = Health::Uninitialised,
            |wheel| wheel.motion = Some(Motion::Stall),
            |wheel| wheel.motion = None,
            |wheel| wheel.slip = None,
            |wheel| wheel.sigma = None,
            |wheel| wheel.rim_speed = None,
        ];
        for change in changes {
            // the heavy wheel carries two thirds, the light one less than half
            let mut heavy_alone = seen();
            change(&mut heavy_alone[0]);
            let found = read(
                &mut readings(),
                &heavy_alone,
                &TORQUES,
                (SPEED_M_PER_S, 0.0),
            );
            let (_, reading) = found.expect("a reading");
            assert!(
                close(reading.slip.0, 0.5) && close(reading.torque.expect("measured"), 2.0 / 6.0)
            );
            let mut light_alone = seen();
            change(&mut light_alone[1]);
            assert_eq!(
                read(
                    &mut readings(),
                    &light_alone,
                    &TORQUES,
                    (SPEED_M_PER_S, 0.0)
                ),
                None
            );
        }
        let mut braking = seen();
        braking[0].motion = Some(Motion::Braking);
        assert!(read(&mut readings(), &braking, &TORQUES, (SPEED_M_PER_S, 0.0)).is_some());
        // torques that are not measured, or no numbers, are those of the other wheels
        for torque in [None, Some(f64::NAN)] {
            let torques = [torque, Some(2.0), None];
            let (_, reading) =
                read(&mut readings(), &seen(), &torques, (SPEED_M_PER_S, 0.0)).expect("a reading");
            assert!(close(reading.torque.expect("measured"), 2.0 / 6.0));
        }
        let (_, reading) =
            read(&mut readings(), &seen(), &[None; 3], (SPEED_M_PER_S, 0.0)).expect("a reading");
        assert_eq!(reading.torque, None);
    }

    #[test]
    fn a_robot_that_turns_or_falls_gives_no_reading() {
        // 0.2 m aside a yaw rate of 0.5 rad/s is a fifth of 0.5 m/s
        for (yaw_rate, is_straight) in [(0.49, true), (-0.49, true), (0.5, false), (-0.51, false)] {
            let found = read(
                &mut readings(),
                &seen(),
                &TORQUES,
                (SPEED_M_PER_S, yaw_rate),
            );
            assert_eq!(found.is_some(), is_straight, "{yaw_rate}");
        }
        // forces that no accelerometer measures do not count, and without one there is no pull
        for force in [
            [f64::NAN, 0.0, 10.0],
            [1.0, 0.0, 1000.1],
            [1000.1, 0.0, 10.0],
            [1.0, 0.0, -1.0],
        ] {
            let mut readings = readings();
            for _ in 0..200 {
                readings.add_force(force);
                let reading = readings.update(&seen(), &TORQUES, (SPEED_M_PER_S, 0.0), STEP_S);
                assert_eq!(reading, None, "{force:?}");
            }
        }
        // the greatest force counts, and a tick without a force is none
        let mut readings = readings();
        let mut drive = |force: [f64; 3]| {
            readings.add_force(force);
            readings.update(&seen(), &TORQUES, (SPEED_M_PER_S, 0.0), STEP_S)
        };
        let most = [MAX_FORCE_M_PER_S2; 3];
        let ticks = (1..400).find(|_| drive(most).is_some()).expect("a reading");
        let again = (1..400).find(|_| drive(most).is_some()).expect("a reading");
        assert_eq!(drive([0.0; 3]), None);
        let reading = (1..=again).find_map(|tick| Some((tick, drive(most)?)));
        let (last, reading) = reading.expect("a reading");
        assert!(ticks > again && last == again && close(reading.pull, 1.0));
    }

    #[test]
    fn impossible_readings_are_none() {
        let possible = SoilReading {
            slip: (1.0, 1.0),
            pull: -MAX_LOAD_MULTIPLE,
            torque: Some(MAX_LOAD_MULTIPLE),
            sinkage: None,
        };
        assert!(possible.is_possible());
        let beyond = MAX_LOAD_MULTIPLE.next_up();
        for impossible in [
            SoilReading {
                slip: (1.0_f64.next_up(), 0.1),
                ..possible
            },
            SoilReading {
                slip: (f64::NAN, 0.1),
                ..possible
            },
            SoilReading {
                slip: (0.1, -0.1),
                ..possible
            },
            SoilReading {
                slip: (0.1, 1.1),
                ..possible
            },
            SoilReading {
                pull: beyond,
                ..possible
            },
            SoilReading {
                torque: Some(-beyond),
                ..possible
            },
        ] {
            assert!(!impossible.is_possible(), "{impossible:?}");
        }
    }
}
