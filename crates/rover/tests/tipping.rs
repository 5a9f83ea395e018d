//! Tip-over margins against the loads: a robot tips over where no loads balance it.

use std::path::Path;

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{stability_margins, wheel_loads};
use grouser_rover::vector::{Attitude, Vector};

const ROBOTS: [&str; 3] = ["five-wheel", "rocker-bogie", "skid-steer"];

fn robot(name: &str) -> RobotModel {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    RobotModel::read(&root.join(format!("{name}.toml"))).unwrap()
}

fn down(pitch: f64, roll: f64) -> Vector {
    Attitude::from_angles(roll, -pitch, 0.0).to_robot(-Vector::AXES[2])
}

/// Pitch and roll of the ground under a robot towards which gravity points `down`.
fn slope(down: Vector) -> (f64, f64) {
    let pitch = (-down.x).asin();
    (pitch, (-down.y / pitch.cos()).asin())
}

/// The smallest further tilt in `directions` even directions from which the loads report that the robot does not stand, by
/// halving; negative: the tilt back to where it stands.
fn by_loads(model: &RobotModel, (pitch, roll): (f64, f64), directions: u32) -> f64 {
    let from = down(pitch, roll);
    let first = from.cross(Vector::AXES[1]).unit();
    let second = from.cross(first);
    let stands_at = |at: Vector| {
        let (pitch, roll) = slope(at);
        wheel_loads(model, pitch, roll).stands
    };
    let stands = stands_at(from);
    let mut least = 1.2_f64;
    for direction in 0..directions {
        let angle = std::f64::consts::TAU * f64::from(direction) / f64::from(directions);
        let towards = first * angle.cos() + second * angle.sin();
        let changes = |tilt: f64| stands_at(from * tilt.cos() + towards * tilt.sin()) != stands;
        if !changes(least) {
            continue;
        }
        let (mut low, mut high) = (0.0, least);
        while high - low > 1e-7 {
            let middle = 0.5 * (low + high);
            if changes(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        least = high;
    }
    if stands { least } else { -least }
}

#[test]
fn margins_are_the_tilt_from_which_no_loads_balance_the_robot() {
    const DIRECTIONS: u32 = 180;
    let mut worst = 0.0_f64;
    for name in ROBOTS {
        let model = robot(name);
        for (pitch_deg, roll_deg) in [
            (0.0, 0.0),
            (20.0, 0.0),
            (45.0, 0.0),
            (48.0, 0.0),
            (-25.0, 0.0),
            (0.0, 20.0),
            (0.0, -30.0),
            (20.0, 20.0),
            (-15.0, 25.0),
            (60.0, 0.0),
            (14.3, -6.0),
        ] {
            let pose = (f64::to_radians(pitch_deg), f64::to_radians(roll_deg));
            let loads = by_loads(&model, pose, DIRECTIONS);
            let margin = stability_margins(&model, pose.0, pose.1).tip_over;
            if loads < 0.0 {
                assert!(margin < 0.0, "{name} at {pitch_deg}, {roll_deg}: {margin}");
                continue;
            }
            let off = (margin - loads).to_degrees();
            worst = worst.max(off.abs());
            assert!(off.abs() < 1.0, "{name} at {pitch_deg}, {roll_deg}: {off}");
        }
    }
    println!("worst {worst} deg");
    // the nearest direction is at most a degree from one of those that are tried
    assert!(worst < 0.01, "{worst}");
}

/// Of four wheels the load of one vanishes first where the robot is tilted across a corner, and it stands on the other three.
#[test]
fn a_robot_stands_on_those_wheels_that_can_carry_it() {
    let model = robot("skid-steer");
    let (mut three, mut falls) = (0, 0);
    for step in 0..40 {
        let tilt = 0.02 * f64::from(step);
        let found = wheel_loads(&model, tilt, tilt);
        let margin = stability_margins(&model, tilt, tilt).tip_over;
        assert_eq!(found.stands, margin > 0.0, "{tilt} {margin}");
        if found.stands {
            assert!(found.loads.iter().all(|load| *load >= 0.0), "{found:?}");
            three += u32::from(found.loads.contains(&0.0));
            // gravity across the ground
            let sum: f64 = found.loads.iter().sum();
            let expected = model.weight() * -down(tilt, tilt).z;
            assert!((sum / expected - 1.0).abs() < 1e-9, "{sum} {expected}");
        } else {
            falls += 1;
            assert!(found.loads.iter().any(|load| *load < 0.0));
        }
    }
    assert!(three > 2 && falls > 2, "{three} {falls}");
}
