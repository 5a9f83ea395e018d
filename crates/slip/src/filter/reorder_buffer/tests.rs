use super::*;

const HORIZON_NS: i64 = 10;

/// A sample of every kind, in the order in which those of one moment are used.
fn of_one_moment(time_ns: i64) -> Vec<Sample> {
    let pose = Measurement::Pose {
        x: 1.0,
        y: 0.0,
        yaw: 0.0,
    };
    let displaced = Measurement::Displacement {
        forward: 1.0,
        left: 0.0,
        turn: None,
    };
    let carrier = |wheel| Measurement::Carrier {
        wheel,
        turn: 0.0,
        forward: 0.0,
        up: 0.0,
    };
    [
        Measurement::Command {
            forward: 1.0,
            left: 0.0,
        },
        Measurement::SteeringAngle {
            wheel: 1,
            angle: 0.1,
        },
        Measurement::SteeringAngle {
            wheel: 2,
            angle: 0.1,
        },
        Measurement::Acceleration {
            forward: 1.0,
            left: 0.0,
        },
        Measurement::YawRate { rate: 1.0 },
        Measurement::WheelTorque {
            wheel: 1,
            torque: 1.0,
        },
        Measurement::WheelTorque {
            wheel: 2,
            torque: 1.0,
        },
        carrier(1),
        carrier(2),
        Measurement::WheelCount { wheel: 1, raw: 1 },
        Measurement::WheelCount { wheel: 2, raw: 1 },
        Measurement::WheelEdge {
            wheel: 1,
            forward: true,
        },
        Measurement::WheelEdge {
            wheel: 2,
            forward: true,
        },
        Measurement::WheelAngle {
            wheel: 1,
            angle: 1.0,
        },
        Measurement::WheelAngle {
            wheel: 2,
            angle: 1.0,
        },
        Measurement::WheelRate {
            wheel: 1,
            rate: 1.0,
        },
        Measurement::WheelRate {
            wheel: 2,
            rate: 1.0,
        },
        Measurement::Position { x: 1.0, y: 0.0 },
        displaced,
        pose,
        Measurement::Speed {
            forward: 1.0,
            left: None,
        },
    ]
    .map(|measurement| Sample {
        time_ns,
        measurement,
    })
    .to_vec()
}

#[test]
fn samples_come_out_by_time_and_kind_however_they_came_in() {
    let expected = [of_one_moment(3), of_one_moment(4)].concat();
    let count = expected.len();
    let mut buffer = ReorderBuffer::new(count, HORIZON_NS);
    for by in [1, 5, 11, 41] {
        // a stride without a common part with 42 takes each once
        for i in 0..count {
            assert!(!buffer.is_full());
            assert_eq!(buffer.offer(expected[(by * i) % count]), Offered::Waits);
        }
        assert!(buffer.is_full());
        assert_eq!(buffer.offer(expected[0]), Offered::TooLate);
        for sample in &expected {
            assert_eq!(buffer.release(true).as_ref(), Some(sample));
        }
        assert_eq!(buffer.release(true), None);
        assert_eq!(buffer.released_ns(), Some(4));
        buffer.clear();
        assert_eq!((buffer.newest_ns(), buffer.released_ns()), (None, None));
    }
}

#[test]
fn a_ring_of_three_keeps_the_order_wherever_it_begins() {
    let at = |time_ns: i64| Sample {
        time_ns,
        measurement: Measurement::YawRate {
            rate: time_ns as f64,
        },
    };
    let mut buffer = ReorderBuffer::new(3, HORIZON_NS);
    for begin in 0..7 {
        let now = 100 * (begin + 1);
        for time in [3, 1, 2] {
            assert_eq!(buffer.offer(at(now + time)), Offered::Waits);
        }
        assert_eq!(buffer.newest_ns(), Some(now + 3));
        // nothing is old enough
        assert_eq!(buffer.release(false), None);
        for time in 1..4 {
            assert_eq!(buffer.release(true), Some(at(now + time)));
            assert_eq!(buffer.released_ns(), Some(now + time));
        }
        // one step further each time
        assert_eq!(buffer.offer(at(now + 2)), Offered::TooLate);
        assert_eq!(buffer.offer(at(now + 3)), Offered::Waits);
        assert_eq!(buffer.release(true), Some(at(now + 3)));
    }
    // as old as the horizon
    buffer.offer(at(1000));
    buffer.offer(at(1009));
    assert_eq!(buffer.release(false), None);
    buffer.offer(at(1010));
    assert_eq!(buffer.release(false), Some(at(1000)));
    assert_eq!(buffer.release(false), None);
    assert!(!buffer.is_full());
    buffer.clear();
    assert_eq!(buffer.release(true), None);
    // what is of one kind, as it came
    for rate in [2.0, 1.0] {
        buffer.offer(Sample {
            measurement: Measurement::YawRate { rate },
            ..at(7)
        });
    }
    for expected in [2.0, 1.0] {
        let sample = buffer.release(true).unwrap();
        let Measurement::YawRate { rate } = sample.measurement else {
            unreachable!()
        };
        assert_eq!(rate, expected);
    }
    // room for one at least
    let mut least = ReorderBuffer::new(0, HORIZON_NS);
    assert_eq!(least.offer(at(7)), Offered::Waits);
    assert!(least.is_full());
}
