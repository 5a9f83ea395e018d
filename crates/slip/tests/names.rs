//! Names that logs and other languages know: each is its variant's, and the wheel of a measurement.

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{
    Degraded, Health, Invalid, Measurement, Motion, Reference, Robot, Sample, Wheel,
};

#[test]
fn a_state_is_written_as_its_variant() {
    use Motion::{Braking, Driving, LiftOff, RollBack, Stall, Standstill};
    for motion in [Driving, Braking, Standstill, RollBack, LiftOff, Stall] {
        assert_eq!(motion.name(), format!("{motion:?}"));
    }
    let degraded = [
        Degraded::LowSpeed,
        Degraded::Quantised,
        Degraded::ReferenceLost,
        Degraded::Relative,
        Degraded::Suspect,
    ];
    let invalid = [
        Invalid::Dropout,
        Invalid::NoReference,
        Invalid::Inconsistent,
    ];
    let all = [Health::Uninitialised, Health::Ok].into_iter();
    let all = all.chain(degraded.map(Health::Degraded));
    for health in all.chain(invalid.map(Health::Invalid)) {
        assert_eq!(health.to_string(), format!("{health:?}"));
    }
    // words of a command line: lower case, with hyphens
    for reference in Reference::ALL {
        let words = reference.name().split('-').map(|word| {
            let (first, rest) = word.split_at(1);
            first.to_uppercase() + rest
        });
        assert_eq!(words.collect::<String>(), format!("{reference:?}"));
    }
}

#[test]
fn a_measurement_of_a_wheel_knows_which() {
    let of = |wheel| {
        [
            Measurement::WheelCount { wheel, raw: 1 },
            Measurement::WheelAngle { wheel, angle: 1.0 },
            Measurement::WheelRate { wheel, rate: 1.0 },
            Measurement::Carrier {
                wheel,
                turn: 1.0,
                forward: 0.0,
                up: 0.0,
            },
            Measurement::MotorCurrent { wheel, share: 1.0 },
            Measurement::Sinkage { wheel, depth: 1.0 },
            Measurement::EntryAngle { wheel, angle: 1.0 },
            Measurement::SteeringAngle { wheel, angle: 1.0 },
        ]
    };
    for (index, (before, after)) in of(2).into_iter().zip(of(5)).enumerate() {
        assert_eq!((before.wheel(), after.wheel()), (Some(2), Some(5)));
        assert_eq!(before.with_wheel(5), after);
        assert_eq!(before.is_rotation(), index < 3);
    }
    let robots_own = Measurement::YawRate { rate: 1.0 };
    assert_eq!(robots_own.wheel(), None);
    assert_eq!(robots_own.with_wheel(5), robots_own);
    assert!(!robots_own.is_rotation());
}

/// Raw readings are for what runs on board: the filter waits for what that makes of them.
#[test]
fn a_raw_reading_changes_nothing_in_the_filter() {
    let wheel = Wheel::powered("wheel").ticks_per_turn(100);
    let robot = Robot::new("cart".into(), vec![wheel]).unwrap();
    let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    for step in 0..100 {
        let measurement = Measurement::YawRate { rate: 0.0 };
        let time_ns = step * 10_000_000;
        filter
            .update(Sample {
                time_ns,
                measurement,
            })
            .unwrap();
    }
    let (time_ns, wheel) = (filter.latest().time_ns, 0);
    for measurement in [
        Measurement::Inertial {
            force: [0.0; 3],
            rate: [0.0; 3],
        },
        Measurement::JointAngle {
            joint: 0,
            angle: 0.1,
        },
        Measurement::Steering { angle: 0.1 },
        Measurement::Sinkage { wheel, depth: 0.1 },
        Measurement::EntryAngle { wheel, angle: 0.1 },
        Measurement::MotorCurrent { wheel, share: 0.1 },
    ] {
        // even an hour later
        let sample = Sample {
            time_ns: 3_600_000_000_000,
            measurement,
        };
        let output = filter.update(sample).unwrap();
        assert_eq!((output.time_ns, output.clock_steps), (time_ns, 0));
        assert_eq!(output.rejected.total(), 0);
    }
}
