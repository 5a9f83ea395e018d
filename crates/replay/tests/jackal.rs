//! The Jackal's bag: an IMU and the odometry of the wheels' driver.

use grouser_log::series;
use grouser_replay::Options;
use grouser_slip::Reference;

use crate::shipped::{data, example};

const ODOMETRY: &str = "/jackal_velocity_controller/odom";

/// The integral of a series by the trapezoid rule.
fn integral(samples: &[(f64, f64)]) -> f64 {
    let pairs = samples.windows(2);
    pairs
        .map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0))
        .sum()
}

#[test]
fn the_gyro_turns_far_less_than_the_wheels_say() {
    let Some(folder) = data("jackal") else { return };
    let bag = folder.join("jackal_61s.bag");
    let jackal = example("jackal");
    let summary = jackal.summary(bag.clone(), &Options::default());
    assert_eq!(
        (summary.reference, summary.wheel_sensor),
        (Reference::Grip, "rate")
    );
    assert_eq!(summary.rejected.total(), 0);
    // 84.17 m by the twist of the odometry and 84.18 m by its positions, read by another program (rosbags).
    let travel = summary.along.travel_wheels;
    println!("the wheels ran {travel:.3} m");
    assert!((travel - 84.17).abs() < 0.2, "{travel}");
    // The same program: the wheels turned by 35.67 rad in all, the gyro by 4.80 rad.
    let of = |topic, field| series(&bag, topic, field).unwrap().samples;
    let wheels = integral(&of(ODOMETRY, "twist.twist.angular.z"));
    let gyro = integral(&of("/imu/data", "angular_velocity.z"));
    assert!(
        (wheels - 35.6749).abs() < 1e-3 && (gyro - 4.8012).abs() < 1e-3,
        "{wheels} {gyro}"
    );
    // The wheels' rates are taken back out of the odometry: v -+ 0.5634/2 W. What a robot without slip would
    // turn with wheels 0.3756 m apart is 1.5 times the driver's turn; in half a second, at its median:
    let residual = summary.yaw.unwrap().residual;
    println!(
        "turns {:?} rad apart in 0.5 s (p5, median, p95)",
        (residual.p5, residual.median, residual.p95)
    );
    assert!(residual.median.unwrap() > 0.1, "{residual:?}");
}

/// What the odometry says of itself: its speeds and turns, replayed, lead along its own poses.
#[test]
fn the_odometry_replayed_ends_where_it_says() {
    let Some(folder) = data("jackal") else { return };
    let bag = folder.join("jackal_61s.bag");
    let of = |field| series(&bag, ODOMETRY, field).unwrap().samples;
    let (speed, turn) = (of("twist.twist.linear.x"), of("twist.twist.angular.z"));
    let (x, y) = (of("pose.pose.position.x"), of("pose.pose.position.y"));
    let (z, w) = (of("pose.pose.orientation.z"), of("pose.pose.orientation.w"));
    let mut yaw = 2.0 * z[0].1.atan2(w[0].1);
    let mut at = (x[0].1, y[0].1);
    let mut worst = 0.0_f64;
    for k in 1..speed.len() {
        let seconds = speed[k].0 - speed[k - 1].0;
        let mean = |s: &[(f64, f64)]| 0.5 * (s[k].1 + s[k - 1].1);
        let half = 0.5 * mean(&turn) * seconds;
        at.0 += mean(&speed) * seconds * (yaw + half).cos();
        at.1 += mean(&speed) * seconds * (yaw + half).sin();
        yaw += 2.0 * half;
        worst = worst.max((at.0 - x[k].1).hypot(at.1 - y[k].1));
    }
    println!("replayed, the odometry is at most {worst:.3} m from its own poses");
    // Rosbags and the same sum in Python: 0.386 m, over 84.2 m with 36 rad of turning. It is the driver's
    // smoothing of its speeds that the poses do not have.
    assert!((worst - 0.386).abs() < 0.005, "{worst}");
}

/// The filter has no reference here: its slips are Relative.
#[test]
fn without_a_reference_no_slip_is_ok() {
    let Some(folder) = data("jackal") else { return };
    let jackal = example("jackal");
    let summary = jackal.summary(folder.join("jackal_61s.bag"), &Options::default());
    assert!(
        summary
            .wheels
            .iter()
            .all(|wheel| !wheel.healths.contains_key("Ok"))
    );
    // What it rests on is the rims: their way is that of another program, to a part in a thousand.
    let odometry = summary.odometry.unwrap();
    println!("{odometry:?}");
    assert!(
        (odometry.distance_of_wheels - 84.17).abs() < 0.09,
        "{odometry:?}"
    );
}
