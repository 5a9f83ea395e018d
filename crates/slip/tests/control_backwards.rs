//! A robot that drives backwards decides as one that drives forwards: seen from its other end it is the same robot.

use std::collections::BTreeMap;

use grouser_slip::control::{ControlSettings, Mode, WheelObservation};
use grouser_slip::filter::SlipPrior;

use crate::noise::Noise;
use crate::open_loop::{Last, OpenLoop};

const RUNS: u64 = 60;
const STEPS: usize = 6000;
/// Ground and attitude stay for this number of steps at most.
const MAX_STRETCH: u64 = 400;

/// The same robot at the same moment, seen from its other end: what was in front and left is behind and right, and speeds,
/// pitch and roll have the other sign. Headings differ by a constant half turn.
fn from_behind(open: &OpenLoop, behind: &mut OpenLoop) {
    let turned = |wheel: WheelObservation| WheelObservation {
        forward_speed: wheel.forward_speed.map(|speed| -speed),
        rim_speed: wheel.rim_speed.map(|speed| -speed),
        ..wheel
    };
    let [a, b, c, d] = open.wheels.map(turned);
    behind.wheels = [d, c, b, a];
    behind.speed = open.speed.map(|speed| -speed);
    behind.heading = open.heading;
    behind.pitch = open.pitch.map(|pitch| -pitch);
    behind.roll = open.roll.map(|roll| -roll);
    behind.slip_demand = open.slip_demand;
    behind.request.speed = -open.request.speed;
}

/// Ground and attitude for the next steps.
fn change(open: &mut OpenLoop, noise: &mut Noise) {
    let slip = noise.uniform() * if noise.uniform() < 0.3 { 1.0 } else { 0.4 };
    let firmness = (noise.uniform() < 0.5).then(|| 0.4 + noise.uniform());
    for wheel in &mut open.wheels {
        wheel.slip = Some(slip + 0.1 * noise.uniform());
        wheel.firmness = firmness.map(|firm| firm + 0.1 * noise.uniform());
    }
    let steep = if noise.uniform() < 0.3 { 0.4 } else { 0.05 };
    open.pitch = Some(steep * (2.0 * noise.uniform() - 1.0));
    open.roll = Some(0.05 * (2.0 * noise.uniform() - 1.0));
    open.slip_demand = (noise.uniform() < 0.7).then(|| SlipPrior {
        mean: 0.1 + 0.2 * noise.uniform(),
        sigma: 0.03,
    });
}

#[test]
fn backwards_it_decides_as_forwards() {
    let mut seen = BTreeMap::new();
    for seed in 0..RUNS {
        let mut noise = Noise::new(seed);
        let mut settings = ControlSettings::default();
        settings.max_attempts = if seed % 2 == 0 { 20 } else { 2 };
        let (mut open, mut behind) = (OpenLoop::new(&settings), OpenLoop::new(&settings));
        let mut stretch = 0;
        for step in 0..STEPS {
            if stretch == 0 {
                stretch = 1 + noise.bits() % MAX_STRETCH;
                change(&mut open, &mut noise);
            }
            stretch -= 1;
            from_behind(&open, &mut behind);
            let (one, other) = (open.step(), behind.step());
            // decisions about several wheels come in the wheels' order
            let of_robot = |last: Last| {
                let found = last.decision.filter(|found| found.wheel.is_none());
                found.map(|found| (found.action, found.reason, (found.value * 1e9).round()))
            };
            assert_eq!(of_robot(one), of_robot(other), "run {seed}, step {step}");
            assert!(
                (one.heading - other.heading).abs() < 1e-9,
                "run {seed}, step {step}: {} {}",
                one.heading,
                other.heading
            );
            let [a, b, c, d] = one.commands;
            for (forwards, backwards) in [a, b, c, d].iter().zip(other.commands.iter().rev()) {
                assert!(
                    (forwards.rim_speed + backwards.rim_speed).abs() < 1e-9,
                    "run {seed}, step {step}: {forwards:?} {backwards:?}"
                );
            }
            if let Some(decision) = one.decision {
                *seen.entry(format!("{:?}", decision.reason)).or_insert(0) += 1;
            }
            let mode = open.controller.mode();
            if mode == Mode::Stopped {
                break;
            }
            // rims and robot follow, the robot by its slip
            let rim = 0.25 * one.commands.iter().map(|c| c.rim_speed).sum::<f64>();
            let slip = open.wheels[0].slip.unwrap_or(0.0);
            open.speed = Some((1.0 - slip) * rim);
            let heading = open.heading.unwrap_or(0.0);
            open.heading = Some(heading + 0.02 * (one.heading - heading));
            let speed = open.speed;
            open.each(|wheel| {
                wheel.rim_speed = Some(rim);
                wheel.forward_speed = speed;
            });
        }
    }
    println!("{seen:?}");
    for reason in ["SoftGround", "ClearedSoftGround", "BackedOut", "DiggingIn"] {
        assert!(seen.contains_key(reason), "{reason}: {seen:?}");
    }
}
