use super::*;
use crate::robot::Wheel;

fn filter(wheels: usize) -> Result<SlipFilter> {
    let wheels = (0..wheels).map(|index| Wheel::powered(format!("{index}")).radius(0.1));
    let robot = Robot::new("robot".into(), wheels.collect())?;
    SlipFilter::new(&robot, FilterSettings::default())
}

#[test]
fn a_filter_has_at_most_eight_wheels() {
    assert!(filter(MAX_FILTER_WHEELS).is_ok());
    let error = filter(MAX_FILTER_WHEELS + 1).unwrap_err();
    assert!(
        matches!(error, Error::WheelCount { count: 9, limit: 8 }),
        "{error}"
    );
}

#[test]
fn angles_of_either_side_are_set_within_their_limits() {
    let mut filter = filter(2).unwrap();
    for angle in [-7.0, -0.3, 7.0] {
        filter.set_steering_angle(1, angle).unwrap();
        let row = filter.core.wheels.channels[1].row;
        assert!(
            (row[0] - f64::cos(angle)).abs() < 1e-12 && (row[1] - f64::sin(angle)).abs() < 1e-12
        );
    }
    assert!(
        filter.set_steering_angle(1, -7.1).is_err() && filter.set_steering_angle(1, 7.1).is_err()
    );
    for (roll, expected) in [
        (0.2, 0.2),
        (-0.3, 0.3),
        (f64::NAN, 0.3),
        (1.5, MAX_ROLL_RAD),
    ] {
        filter.set_roll(roll);
        assert!(
            (filter.core.cross_slope - f64::tan(expected)).abs() < 1e-12,
            "{roll}"
        );
    }
    filter.core.state.set_mean(YAW, 0.17);
    assert_eq!(filter.yaw_rate(), 0.17);
}
