//! Windows that are refused, and what they change all the same.

use super::*;

/// A window of the first wheel by its innovation in sigma.
fn window(sigma: f64, is_off: bool) -> WheelWindow {
    WheelWindow {
        index: 0,
        to_ns: NOW_NS,
        rim: 0.5,
        forward: 0.4,
        faster: 0.5,
        innovation: 0.02 * sigma,
        variance: 0.0004,
        is_off,
        has_slip: true,
    }
}

#[test]
fn an_innovation_changes_the_noise_of_a_slip() {
    let weight = 1.0 - 0.8 * 0.8;
    for (sigma, r) in [(0.5, 0.5), (-3.0, -3.0), (5.0, 4.0), (-9.0, -4.0)] {
        let mut core = known(true);
        core.wheels.channels[0].mean_innovation = 0.25;
        core.wheels.channels[0].was_off = true;
        core.wheels.channels[0].noise_scale = 2.0;
        let common = core.state.covariance(COMMON_SLIP, COMMON_SLIP);
        assert!(core.accepts_powered_window(&window(sigma, false)));
        let wheel = &core.wheels.channels[0];
        near(wheel.mean_innovation, 0.25 + weight * (r - 0.25));
        near(wheel.noise_scale, 2.0 * f64::exp(0.005 * (r * r - 1.0)));
        assert!(!wheel.was_off);
        near(core.state.covariance(COMMON_SLIP, COMMON_SLIP), common);
        // all of them: the common slip may have changed by this share of the rim
        for wheel in &mut core.wheels.channels[..2] {
            wheel.mean_innovation = 2.0 * r.signum();
        }
        core.accepts_powered_window(&window(sigma, false));
        let step = 0.02 * sigma / 0.5;
        let changes = core.wheels.slips_change_together();
        let expected = common + if changes { step * step } else { 0.0 };
        near(core.state.covariance(COMMON_SLIP, COMMON_SLIP), expected);
        assert!(changes || r.abs() < 1.0);
    }
    for (before, sigma, limit) in [(0.1, 0.0, 0.1), (99.9, 4.0, 100.0)] {
        let mut core = known(true);
        core.wheels.channels[0].noise_scale = before;
        core.accepts_powered_window(&window(sigma, false));
        near(core.wheels.channels[0].noise_scale, limit);
    }
}

#[test]
fn a_wheel_that_breaks_away_gets_another_slip() {
    for (sigma, own) in [
        (6.0, 0.05 + 0.24),
        (-6.0, 0.05 - 0.24),
        (60.0, 2.0),
        (-60.0, -2.0),
    ] {
        let mut core = known(true);
        let before = core.clone();
        // the first one may be play
        assert!(!core.accepts_powered_window(&window(sigma, true)));
        assert!(core.wheels.channels[0].was_off);
        assert_same(&core.state, &before.state, 3);
        assert_eq!(core.wheels.channels[0].mean_innovation, 0.0);
        assert!(!core.accepts_powered_window(&window(sigma, true)));
        near(core.state.mean(own_slip(0)), own);
        near(core.state.sigma(own_slip(0)), 2.0 * 0.08);
        assert!((core.nis - sigma * sigma).abs() < 1e-9);
        near(core.state.covariance(own_slip(0), FORWARD), 0.0);
        near(core.state.mean(FORWARD), before.state.mean(FORWARD));
    }
}

#[test]
fn windows_beyond_the_gate_and_encoders_that_are_wrong_are_refused() {
    let refused = |core: &mut Core, rim: f64| {
        let before = core.state.mean(FORWARD);
        core.update_rim(0, span(rim));
        core.state.mean(FORWARD) == before
    };
    // beyond the gate by both variances
    let mut core = known(true);
    ran(&mut core, 0, 0.3, 0.2);
    let forward = 0.4 - 0.4 * 0.2;
    let gate = |rim: f64| {
        // 0.2 of the rim is slip
        let mut core = known(true);
        ran(&mut core, 0, 0.3, 0.2);
        core.settings.gate = 1e9;
        core.update_rim(0, span(rim));
        f64::sqrt(core.nis) * (0.8 * 1.01 * rim - forward).signum()
    };
    let (sigma_high, sigma_low) = (gate(0.9), gate(0.35));
    assert!(sigma_high > 1.0 && sigma_low < 0.0);
    for (factor, is_refused) in [(0.99, true), (1.01, false)] {
        let mut core = core.clone();
        core.settings.gate = factor * sigma_high;
        assert_eq!(refused(&mut core, 0.9), is_refused);
        assert_eq!(core.wheels.channels[0].was_off, is_refused);
    }
    // against the travel by more than the low speed, and beyond the error of the state: 3 · 0.0447 m/s
    for (forward, rim, against) in [
        (0.4, -0.03, true),
        (-0.4, 0.03, true),
        (0.4, 0.03, false),
        (0.4, -0.02, false),
        (0.16, -0.03, true),
        (0.15, -0.03, false),
    ] {
        let mut core = known(true);
        core.settings.gate = 1e9;
        core.state.set_mean(FORWARD, forward);
        core.state.set_mean(YAW, 0.0);
        ran(&mut core, 0, rim, rim);
        assert_eq!(refused(&mut core, rim), against, "{forward} {rim}");
        let since = core.wheels.channels[0].against_since_ns;
        assert_eq!(since, against.then_some(NOW_NS));
        if against {
            let later = Span {
                to_ns: NOW_NS + 100 * MS,
                ..span(rim)
            };
            core.update_rim(0, later);
            assert_eq!(core.wheels.channels[0].against_since_ns, since);
            assert!(!refused(&mut core, -rim));
            assert_eq!(core.wheels.channels[0].against_since_ns, None);
        }
    }
    // a rim that stands for a quarter of a second while the robot moves
    for (still_ms, gate, is_refused) in [(250, 1.0, true), (249, 1.0, false), (250, 1e9, false)] {
        let mut core = known(true);
        core.settings.gate = gate;
        core.settings.low_speed = 9.0;
        roll(&mut core, 0, NOW_NS, &[0.0; 2]);
        core.wheels.channels[0].still_since_ns = Some(NOW_NS - still_ms * MS);
        core.wheels.channels[0].mean_innovation = 0.5;
        core.state.set_mean(COMMON_SLIP, -0.4);
        assert_eq!(refused(&mut core, 0.0), is_refused, "{still_ms} {gate}");
        // without a slip there is no mean of it
        assert_eq!(core.wheels.channels[0].mean_innovation, 0.0);
    }
}

#[test]
fn a_slip_needs_more_than_the_low_speed() {
    for (rim, has_slip) in [(0.5, false), (0.501, true)] {
        let mut core = known(true);
        core.state.set_mean(radius(0), 0.0);
        core.settings.low_speed = 0.5;
        core.settings.gate = 1e9;
        ran(&mut core, 0, 0.3, 0.2);
        core.wheels.channels[0].mean_innovation = 0.5;
        core.update_rim(0, span(rim));
        assert_eq!(core.wheels.channels[0].mean_innovation != 0.0, has_slip);
    }
}

#[test]
fn sparse_readings_are_as_old_as_a_twentieth_of_a_second() {
    let mut core = known(true);
    assert!(!core.is_sparse(NOW_NS));
    roll(&mut core, 0, NOW_NS, &[0.5]);
    roll(&mut core, 1, NOW_NS - 30 * MS, &[0.5]);
    // the motion over the ground waits for the next of them
    for (ms, waits) in [(0, false), (60, true)] {
        let mut core = known(false);
        for wheel in 0..2 {
            roll(&mut core, wheel, NOW_NS - ms * MS, &[0.5; 2]);
        }
        let before = format!("{:?}", core.ground);
        core.settle_rims();
        assert_eq!(format!("{:?}", core.ground) == before, waits);
    }
    // by the newest one, of powered wheels
    for (ms, is_sparse) in [
        (0, false),
        (49, false),
        (50, true),
        (400, true),
        (401, false),
    ] {
        assert_eq!(core.is_sparse(NOW_NS + ms * MS), is_sparse, "{ms}");
    }
    roll(&mut core, 2, NOW_NS + 60 * MS, &[0.5]);
    assert!(core.is_sparse(NOW_NS + 60 * MS));
}

#[test]
fn a_reading_goes_to_each_part_of_its_wheel() {
    let rate = |wheel: usize, speed: f64| Measurement::WheelRate {
        wheel,
        rate: speed / RADIUS_M,
    };
    // beside a free wheel a window that ends updates the state at once
    let mut core = known(true);
    let mut expected = core.clone();
    for ms in [0, 100] {
        core.update_wheel(NOW_NS - 100 * MS + ms * MS, 0, &rate(0, 0.42))
            .unwrap();
    }
    expected.wheels.channels[0].track = core.wheels.channels[0].track.clone();
    let exact = Span {
        rim: Measured {
            value: 0.42,
            variance: 0.0,
        },
        ..span(0.42)
    };
    expected.update_rim(0, exact);
    assert_same(&core.state, &expected.state, 3);
    assert_eq!(core.wheels.channels[0].read_before_ns, NOW_NS - 100 * MS);
    assert!(!core.wheels.channels[0].has_ended);
    let mut repeated = RepeatedRate::default();
    for ms in [0, 100] {
        repeated.push(NOW_NS - 100 * MS + ms * MS, 0.42 / RADIUS_M);
    }
    assert_eq!(
        format!("{:?}", core.wheels.channels[0].repeated),
        format!("{repeated:?}")
    );
    let unknown = Fault::UnknownWheel {
        index: 3,
        wheels: 3,
    };
    assert_eq!(core.update_wheel(NOW_NS, 3, &rate(3, 0.1)), Err(unknown));
    // without one the windows of all wheels wait for the last of the row
    let mut core = known(false);
    for (ms, wheel, waits) in [
        (-100, 0, [false, false]),
        (-100, 1, [false, false]),
        (0, 0, [true, false]),
        (0, 1, [false, false]),
    ] {
        let before = core.wheels.channels[0].remainder;
        core.update_wheel(NOW_NS + ms * MS, wheel, &rate(wheel, 0.42))
            .unwrap();
        let ended = [0, 1].map(|wheel| core.wheels.channels[wheel].has_ended);
        assert_eq!(ended, waits);
        let settles = ms == 0 && wheel == 1;
        assert_eq!(core.wheels.channels[0].remainder != before, settles);
    }
    assert!(core.wheels.channels[1].remainder.is_some());
    // a force that was measured with them, too
    let mut core = known(false);
    for ms in [-100, 0] {
        for wheel in 0..2 {
            let now_ns = NOW_NS + ms * MS;
            let track = &mut core.wheels.channels[wheel];
            track.has_ended = false;
            core.update_wheel(now_ns, wheel, &rate(wheel, 0.42))
                .unwrap();
        }
    }
    assert!(core.wheels.channels.iter().all(|wheel| !wheel.has_ended));
    // nothing is settled without a motion over the ground, or before a time
    let mut core = known(true);
    core.wheels.channels[0].has_ended = true;
    core.settle_rims();
    assert!(core.wheels.channels[0].has_ended);
    let mut core = known(false);
    core.now_ns = None;
    core.wheels.channels[0].has_ended = true;
    core.settle_rims();
    assert!(core.wheels.channels[0].has_ended);
    // pulses are those of counters
    let counting = Wheel::powered("a").radius(RADIUS_M).ticks_per_turn(100);
    let mut core = core_of(vec![counting.clone(), Wheel::free("b")]);
    for (ms, raw) in [(0, 0), (10, 7)] {
        let count = Measurement::WheelCount { wheel: 0, raw };
        core.update_wheel(NOW_NS + ms * MS, 0, &count).unwrap();
    }
    let mut pulses =
        crate::filter::pulse_check::PulseCheck::new(counting.travel_per_tick().unwrap(), 100.0);
    for (ms, ticks) in [(0, 0.0), (10, 7.0)] {
        pulses.update(
            NOW_NS + ms * MS,
            ticks * counting.travel_per_tick().unwrap(),
        );
    }
    assert_eq!(
        format!("{:?}", core.wheels.channels[0].pulses),
        format!("{pulses:?}")
    );
}
