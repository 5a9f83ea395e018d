use super::*;
use ClockOutcome::{Continues, Set};

const MS: i64 = 1_000_000;
const WHEELS: usize = 2;

const fn rate(wheel: usize) -> Measurement {
    Measurement::WheelRate { wheel, rate: 1.0 }
}

const GYRO: Measurement = Measurement::YawRate { rate: 0.1 };
const PLACE: Measurement = Measurement::Position { x: 1.0, y: 2.0 };

/// Clocks that take each time as the newest one, used up to a time.
struct Clocks {
    sensors: SensorClocks,
    newest_ns: Option<i64>,
    used_ns: Option<i64>,
}

impl Clocks {
    fn new() -> Self {
        Self {
            sensors: SensorClocks::new(WHEELS),
            newest_ns: None,
            used_ns: None,
        }
    }

    fn check(&mut self, ms: i64, measurement: Measurement) -> Result<ClockOutcome, Fault> {
        let sample = Sample {
            time_ns: ms * MS,
            measurement,
        };
        let outcome = self.sensors.check(&sample, self.newest_ns, self.used_ns)?;
        if outcome == Set {
            self.newest_ns = None;
        }
        self.newest_ns = self.newest_ns.max(Some(ms * MS));
        Ok(outcome)
    }

    fn is_clock_step(&mut self, ms: i64, measurement: Measurement) -> bool {
        matches!(self.check(ms, measurement), Err(Fault::ClockStep { time_ns, last_ns })
            if time_ns == ms * MS && Some(last_ns) == self.newest_ns)
    }
}

#[test]
fn each_sensor_has_a_clock() {
    let all = [
        Measurement::Command {
            forward: 0.1,
            left: 0.0,
        },
        Measurement::Acceleration {
            forward: 0.1,
            left: 0.0,
        },
        GYRO,
        Measurement::Pose {
            x: 0.1,
            y: 0.0,
            yaw: 0.0,
        },
        Measurement::Speed {
            forward: 0.1,
            left: None,
        },
        PLACE,
        rate(0),
        Measurement::WheelTorque {
            wheel: 0,
            torque: 1.0,
        },
        Measurement::Carrier {
            wheel: 0,
            turn: 0.0,
            forward: 0.0,
            up: 0.0,
        },
        rate(1),
    ];
    // each at times apart; a gap of eight periods lacks seven, of each but a command
    for (i, measurement) in all.into_iter().enumerate() {
        let mut clocks = Clocks::new();
        for ms in [0, 20, 40] {
            for (j, other) in (0..).zip(all) {
                assert_eq!(clocks.check(ms + j, other), Ok(Continues));
            }
        }
        let after_gap = 200 + i64::try_from(i).unwrap();
        clocks.check(after_gap, measurement).unwrap();
        let expected = if i == 0 { 0 } else { 7 };
        assert_eq!(clocks.sensors.dropped, expected, "{measurement:?}");
    }
    let mut clocks = Clocks::new();
    let unknown = Err(Fault::UnknownWheel {
        index: 2,
        wheels: WHEELS,
    });
    assert_eq!(clocks.check(0, rate(2)), unknown);
    // edges and angles of the wheel's own encoder
    for (ms, measurement) in [
        (0, rate(1)),
        (10, Measurement::WheelCount { wheel: 1, raw: 1 }),
        (
            20,
            Measurement::WheelAngle {
                wheel: 1,
                angle: 0.1,
            },
        ),
    ] {
        assert_eq!(clocks.check(ms, measurement), Ok(Continues));
    }
    let edge = Measurement::WheelEdge {
        wheel: 1,
        forward: true,
    };
    assert_eq!(clocks.check(400, edge), Ok(Continues));
    assert_eq!(clocks.sensors.dropped, 0);
}

#[test]
fn a_gap_lacks_what_its_period_has() {
    // one and a half periods are none
    let mut clocks = Clocks::new();
    for ms in [0, 500, 1000, 1750] {
        clocks.check(ms, GYRO).unwrap();
    }
    assert_eq!(clocks.sensors.dropped, 0);
    // by which the period has become 5 % of a quarter of a second longer: 0.5125 s. 0.97 s are 1.9 of them and lack one
    let period = |clocks: &mut Clocks| clocks.sensors.sensor(&GYRO).unwrap().0.period;
    assert!((period(&mut clocks) - 0.5125).abs() < 1e-12);
    clocks.check(1750, GYRO).unwrap();
    assert!((period(&mut clocks) - 0.5125).abs() < 1e-12);
    clocks.check(1750 + 970, GYRO).unwrap();
    assert_eq!(clocks.sensors.dropped, 1);
    // 0.535 s by now
    clocks.check(1750 + 970 + 800, GYRO).unwrap();
    assert_eq!(clocks.sensors.dropped, 1);
    // at most a million at once, and no more than can be counted
    let sensor = |clocks: &mut Clocks| {
        let (sensor, _) = clocks.sensors.sensor(&GYRO).unwrap();
        sensor.period = 1e-9;
    };
    sensor(&mut clocks);
    clocks.check(3620, GYRO).unwrap();
    assert_eq!(clocks.sensors.dropped, 1_000_001);
    sensor(&mut clocks);
    clocks.sensors.dropped = u64::MAX - 3;
    clocks.check(3720, GYRO).unwrap();
    assert_eq!(clocks.sensors.dropped, u64::MAX);
}

#[test]
fn a_clock_that_was_set_is_followed_by_its_second_sample() {
    for (first, second) in [(5000, 5010), (-5000, -4990), (5000, 6000)] {
        let mut clocks = Clocks::new();
        for ms in [0, 10, 20] {
            clocks.check(ms, GYRO).unwrap();
            clocks.check(ms, rate(0)).unwrap();
        }
        assert!(clocks.is_clock_step(first, GYRO));
        // that of another sensor, the same once more, one before, and one too far from it
        assert!(clocks.is_clock_step(second, rate(0)));
        assert!(clocks.is_clock_step(first, GYRO));
        assert!(clocks.is_clock_step(first - 10, GYRO));
        assert!(clocks.is_clock_step(first + 1010, GYRO));
        assert!(clocks.is_clock_step(first, GYRO));
        assert_eq!(clocks.check(second, GYRO), Ok(Set));
        assert_eq!(clocks.sensors.steps, 1);
        // what follows continues it, also of sensors that were refused
        assert_eq!(clocks.check(second, rate(0)), Ok(Continues));
        assert_eq!(clocks.check(second + 10, GYRO), Ok(Continues));
        assert_eq!(clocks.sensors.dropped, 0);
    }
    // exactly a second is no step
    let mut clocks = Clocks::new();
    clocks.check(0, GYRO).unwrap();
    assert_eq!(clocks.check(1000, rate(0)), Ok(Continues));
    assert!(clocks.is_clock_step(2001, GYRO));
    // a sample that fits shows that no clock was set
    assert_eq!(clocks.check(1010, rate(0)), Ok(Continues));
    assert!(clocks.is_clock_step(2011, GYRO));
    assert_eq!(clocks.check(2021, GYRO), Ok(Set));
}

#[test]
fn late_samples_are_refused_but_those_of_a_reference() {
    let mut clocks = Clocks::new();
    for ms in [0, 500, 1000] {
        clocks.check(ms, GYRO).unwrap();
    }
    clocks.check(450, PLACE).unwrap();
    clocks.used_ns = Some(900 * MS);
    let not_later = |ms: i64| {
        Err(Fault::NotLater {
            time_ns: ms * MS,
            last_ns: 900 * MS,
        })
    };
    assert_eq!(clocks.check(890, rate(0)), not_later(890));
    assert_eq!(clocks.check(900, rate(0)), Ok(Continues));
    // a reference may be late, but not behind its own last reading, nor at it
    assert_eq!(clocks.check(600, PLACE), Ok(Continues));
    assert_eq!(clocks.check(600, PLACE), not_later(600));
    assert_eq!(clocks.check(590, PLACE), not_later(590));
    // back by more than 0.1 s is a clock that was set, if another follows
    for ms in [490, 500, 489] {
        assert_eq!(clocks.check(ms, PLACE), not_later(ms));
    }
    assert_eq!(clocks.check(495, PLACE), Ok(Set));
}

#[test]
fn a_reference_is_late_by_its_longest_delay() {
    let delay_ms = whole(MAX_DELAY_S * 1e3);
    for (late_ms, is_taken) in [(delay_ms, true), (delay_ms + 1, false)] {
        let mut clocks = Clocks::new();
        clocks.check(0, GYRO).unwrap();
        clocks.newest_ns = Some(5000 * MS);
        clocks.used_ns = Some(5000 * MS);
        let found = clocks.check(5000 - late_ms, PLACE);
        assert_eq!(found.is_ok(), is_taken, "{found:?}");
    }
}
