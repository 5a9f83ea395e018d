use super::*;
use crate::filter::recovery::tests::{MS, NOW_NS, rolling};
use crate::wheel_estimate::WheelEstimate;

/// Slip that grows with torque, and half as much at none, beside a described radius.
const RADIUS_EXCESS_SHARE: f64 = 0.04;
const SLIP_SIGMA: f64 = 0.01;

/// The checks after torques and slips, 0.1 s apart.
fn after(health: Health) -> Core {
    let mut core = rolling(&[0.5, 0.5, 0.4]);
    for (i, torque) in (0..).zip([-2.0, -1.0, 0.0, 1.0, 2.0].repeat(4)) {
        for wheel in &mut core.wheels.channels {
            wheel.radius.push(torque);
            wheel.estimate = WheelEstimate {
                health,
                slip: grouser_terra::Slip::new(RADIUS_EXCESS_SHARE + 0.02 * torque).ok(),
                sigma: Some(SLIP_SIGMA),
                ..WheelEstimate::NOTHING
            };
        }
        core.check_sensors(NOW_NS + 100 * i * MS);
    }
    core
}

#[test]
fn the_radius_of_a_powered_wheel_follows_from_its_slips() {
    let core = after(Health::Ok);
    let free = core.settings.free_slip.sigma;
    // of 20 slips one of six is independent, 0.03 about the law, beside that of the skid
    let variance = 6.0 * (SLIP_SIGMA * SLIP_SIGMA + 0.0009) / 20.0 + free * free;
    for (wheel, is_known) in [(0, true), (1, true), (2, false)] {
        let excess = core.output.checks[wheel].radius_excess;
        assert_eq!(excess.is_some(), is_known);
        if let Some(excess) = excess {
            assert!((excess.value - RADIUS_EXCESS_SHARE).abs() < 1e-9);
            assert!((excess.variance - variance).abs() < 1e-9);
        }
    }
    assert_eq!(
        after(Health::Uninitialised).output.checks[0].radius_excess,
        None
    );
}

#[test]
fn sensors_are_checked_ten_times_a_second() {
    let mut core = rolling(&[0.5, 0.5, 0.4]);
    for (ms, checked_ms) in [(0, 0), (99, 0), (100, 100), (150, 100)] {
        core.check_sensors(NOW_NS + ms * MS);
        assert_eq!(core.output.checked_ns, Some(NOW_NS + checked_ms * MS));
    }
}
