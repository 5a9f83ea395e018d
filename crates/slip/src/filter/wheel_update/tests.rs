use super::*;
use crate::filter::kalman::Kalman;
use crate::filter::motion_model::size;
use crate::filter::recovery::tests::{MS, NOW_NS, RADIUS_M, core, core_of, near, roll, with_gyro};
use crate::filter::repeated_rate::RepeatedRate;
use crate::robot::Wheel;

mod gates;

const WINDOW_S: f64 = 0.1;
/// Of a rim over its window.
const RIM_VARIANCE_M2_PER_S2: f64 = 4e-4;

type Change = fn(&mut Core);

/// A robot whose numbers are all known, and correlated.
fn known(has_free: bool) -> Core {
    let mut core = core(has_free);
    fill(&mut core);
    core
}

fn fill(core: &mut Core) {
    let count = core.wheels.channels.len();
    for i in 0..size(count) {
        let (mean, variance) = (core.state.mean(i), core.state.covariance(i, i));
        core.state.reset(i, mean, variance.max(1e-6));
    }
    for (i, value, variance) in [
        (FORWARD, 0.4, 0.002),
        (LEFT, 0.03, 0.001),
        (YAW, 0.2, 0.003),
        (COMMON_SLIP, 0.15, 0.004),
    ] {
        core.state.reset(i, value, variance);
    }
    core.state.set_covariance(FORWARD, COMMON_SLIP, -0.001);
    core.state.set_covariance(FORWARD, YAW, 0.0005);
    core.state.set_covariance(LEFT, COMMON_SLIP, 0.0007);
    core.state.set_covariance(GYRO_BIAS, FORWARD, 0.0002);
    for wheel in 0..count {
        core.state.reset(own_slip(wheel), 0.05, 0.006);
        core.state.reset(radius(wheel), 0.01, 1e-4);
        core.state.set_covariance(own_slip(wheel), FORWARD, 0.0008);
    }
    core.speed_known_ns = Some(NOW_NS);
    core.path.record(NOW_NS);
}

fn span(rim: f64) -> Span {
    Span {
        rim: Measured {
            value: rim,
            variance: RIM_VARIANCE_M2_PER_S2,
        },
        from_ns: NOW_NS - 100 * MS,
        to_ns: NOW_NS,
    }
}

fn assert_same(found: &Kalman, expected: &Kalman, wheels: usize) {
    for i in 0..size(wheels) {
        near(found.mean(i), expected.mean(i));
        for j in 0..=i {
            near(found.covariance(i, j), expected.covariance(i, j));
        }
    }
}

/// What a window of a rim should do: u (1 + ρ) = v + s m + the difference of the remainders over the window.
struct Window {
    wheel: usize,
    rim: f64,
    braking: bool,
    /// Speed of the wheel's centre by the state, over the ground, and its derivative.
    forward: f64,
    longer: f64,
    /// Process noise density of the robot's speed within the window.
    density: f64,
    /// Tick of a counter, m.
    tick: f64,
    /// Which remainder ends it, and the variance of that.
    odd: bool,
    remainder_variance: f64,
    considered: Vec<usize>,
}

impl Window {
    fn of(core: &Core, wheel: usize, rim: f64, braking: bool) -> Self {
        let row = core.wheels.channels[wheel].row;
        let motion = [FORWARD, LEFT, YAW].map(|i| core.state.mean(i));
        Self {
            wheel,
            rim,
            braking,
            forward: row
                .iter()
                .zip(motion)
                .map(|(part, speed)| part * speed)
                .sum(),
            longer: 1.0,
            density: core.process_noise_density(),
            tick: 0.0,
            odd: false,
            remainder_variance: 0.0,
            considered: Vec::new(),
        }
    }

    /// The state after it.
    fn update(&self, core: &Core) -> Kalman {
        let mut state = core.state.clone();
        let channel = &core.wheels.channels[self.wheel];
        if channel.remainder.is_none() {
            state.reset(
                remainder(self.wheel, !self.odd),
                0.0,
                self.remainder_variance,
            );
        }
        state.reset(
            remainder(self.wheel, self.odd),
            0.0,
            self.remainder_variance,
        );
        let (common, own) = (state.mean(COMMON_SLIP), state.mean(own_slip(self.wheel)));
        let shared = if channel.free { 0.0 } else { 1.0 };
        let slip = shared * common + own;
        let rim = self.rim * (1.0 + state.mean(radius(self.wheel)));
        let (faster, earlier, by_speed) = if self.braking {
            (self.forward, self.forward, 1.0 + slip.min(0.0))
        } else {
            (rim, channel.smoothed_rim(), 1.0)
        };
        let mut h = vec![0.0; size(core.wheels.channels.len())];
        for (i, part) in [FORWARD, LEFT, YAW].into_iter().zip(channel.row) {
            h[i] = by_speed * self.longer * part;
        }
        h[COMMON_SLIP] = shared * earlier;
        h[own_slip(self.wheel)] = earlier;
        h[radius(self.wheel)] = -self.rim;
        h[remainder(self.wheel, self.odd)] = -1.0 / WINDOW_S;
        h[remainder(self.wheel, !self.odd)] = 1.0 / WINDOW_S;
        let jacobian: Vec<_> = h.into_iter().enumerate().collect();
        let slips = [(COMMON_SLIP, shared), (own_slip(self.wheel), 1.0)];
        let of_slip = (faster * faster - earlier * earlier).max(0.0) * state.variance_of(&slips);
        let counted = self.tick * self.tick / 6.0 / (WINDOW_S * WINDOW_S);
        let changed = self.density * self.density * WINDOW_S / 3.0;
        for i in &self.considered {
            state.set_considered(*i, true);
        }
        state.update(&ScalarMeasurement {
            jacobian: &jacobian,
            residual: rim
                - self.forward
                - slip * faster
                - state.mean(remainder(self.wheel, !self.odd)) / WINDOW_S,
            variance: (RIM_VARIANCE_M2_PER_S2 - counted).max(0.0) + changed + of_slip + 5e-4 * 5e-4,
        });
        for i in &self.considered {
            state.set_considered(*i, false);
        }
        state
    }
}

/// The wheel's rim ran at this speed in the two windows before.
fn ran(core: &mut Core, wheel: usize, before: f64, last: f64) {
    core.wheels.channels[wheel].smooth(before);
    core.wheels.channels[wheel].smooth(last);
}

#[test]
fn a_window_updates_speed_and_slips_driving_and_braking() {
    // (forward, common and own slip, rim speed): driving, and braking by the slip or beyond doubt
    for (forward, common, own, rim, braking) in [
        (0.4, 0.15, 0.05, 0.42, false),
        (0.4, 0.0, 0.0, 0.42, false),
        (-0.4, 0.15, 0.05, -0.6, false),
        // a slip below 0 that both speeds do not contradict, and one that they do
        (0.5, -0.15, 0.05, 0.37, true),
        (-0.5, -0.15, 0.05, -0.52, true),
        (0.4, -0.15, 0.05, 0.66, false),
        // a slip above 0, and a robot that is faster beyond doubt
        (0.7, 0.05, 0.02, 0.37, true),
        (0.7, 0.05, 0.02, 0.57, false),
    ] {
        let mut core = known(true);
        core.state.set_mean(FORWARD, forward);
        core.state.set_mean(COMMON_SLIP, common);
        core.state.set_mean(own_slip(1), own);
        ran(&mut core, 1, 0.3, 0.2);
        core.settings.gate = 100.0;
        let window = Window::of(&core, 1, rim, braking);
        let expected = window.update(&core);
        core.update_rim(1, span(rim));
        assert_same(&core.state, &expected, 3);
        assert_eq!(core.wheels.channels[1].remainder, Some(false));
        if common <= 0.0 || braking {
            continue;
        }
        // the remainder of its end comes in the next window, the other way round
        core.state.reset(remainder(1, false), 0.004, 1e-5);
        core.state
            .set_covariance(remainder(1, false), FORWARD, 1e-5);
        let mut next = Window::of(&core, 1, rim, braking);
        next.odd = true;
        let expected = next.update(&core);
        core.update_rim(1, span(rim));
        assert_same(&core.state, &expected, 3);
        assert_eq!(core.wheels.channels[1].remainder, Some(true));
    }
}

#[test]
fn a_free_wheel_measures_the_speed_beside_its_skid() {
    for accepted_ns in [None, Some(NOW_NS)] {
        let mut core = known(true);
        core.state.set_mean(own_slip(2), 0.0);
        core.reference.accepted_ns = accepted_ns;
        ran(&mut core, 2, 0.3, 0.2);
        let mut window = Window::of(&core, 2, 0.39, false);
        // its skid is estimated beside another reference
        if accepted_ns.is_none() {
            window.considered = vec![own_slip(2)];
        }
        let mut expected = window.update(&core);
        core.update_rim(2, span(0.39));
        // it hardly runs ahead of the robot: 3 sigma of 0.01
        expected.clamp_mean(own_slip(2), -2.0, 0.03);
        assert_same(&core.state, &expected, 3);
    }
    // a skid that is not known, beyond its limits; and beyond 3 sigma of a wide prior, where that is more
    for (prior_mean, prior_sigma, skid, rim, expected) in [
        (0.0, 0.01, 0.02, 0.8, 0.03),
        (0.0, 0.01, -1.95, 0.1, -2.0),
        (0.1, 0.9, -2.55, 0.1, 0.1 - 3.0 * 0.9),
    ] {
        let mut core = known(true);
        core.settings.free_slip.mean = prior_mean;
        core.settings.free_slip.sigma = prior_sigma;
        core.reference.accepted_ns = Some(NOW_NS);
        core.settings.gate = 100.0;
        core.state.reset(own_slip(2), skid, 4.0);
        ran(&mut core, 2, rim, rim);
        core.update_rim(2, span(rim));
        near(core.state.mean(own_slip(2)), expected);
    }
}

#[test]
fn ticks_carriers_and_process_noise_are_in_a_window() {
    let mut wheels = vec![
        Wheel::powered("left")
            .at(0.3, 0.4)
            .radius(RADIUS_M)
            .ticks_per_turn(200),
        Wheel::powered("right").at(0.3, -0.3).radius(RADIUS_M),
    ];
    wheels.push(Wheel::free("free").at(-0.5, 0.1).radius(RADIUS_M));
    let mut core = core_of(wheels);
    fill(&mut core);
    ran(&mut core, 0, 0.3, 0.2);
    let count = Measurement::WheelCount { wheel: 0, raw: 1 };
    core.wheels.channels[0].track.take(NOW_NS, &count).unwrap();
    // the wheel's centre moves forwards by 0.1 m/s beside the robot, and up by a third of its speed
    let level = 0.4 - 0.4 * 0.2 + 0.1;
    let carrier = [0.0, 0.1, level / 3.0];
    core.wheels.channels[0]
        .carrier
        .update(NOW_NS, carrier)
        .unwrap();
    let mut window = Window::of(&core, 0, 0.55, false);
    window.longer = f64::sqrt(1.0 + 1.0 / 9.0);
    window.forward = level * window.longer;
    window.tick = RADIUS_M * core::f64::consts::TAU / 200.0;
    window.remainder_variance = window.tick * window.tick / 12.0;
    let expected = window.update(&core);
    core.update_rim(0, span(0.55));
    assert_same(&core.state, &expected, 3);
    near(core.share_of_change(0), 1.0);
    // where the motion over the ground is known, a robot that is never fast changes little; its motion is the reference's
    let mut led = known(false);
    led.is_led = true;
    roll(&mut led, 0, NOW_NS, &[0.06, 0.06]);
    near(led.share_of_change(0), 0.4);
    roll(&mut led, 1, NOW_NS, &[0.2, 0.2]);
    near(led.share_of_change(1), 1.0);
    let mut window = Window::of(&led, 0, 0.42, false);
    window.density *= 0.4;
    window.considered = vec![YAW, GYRO_BIAS, FORWARD, LEFT, COMMON_SLIP];
    let expected = window.update(&led);
    led.update_rim(0, span(0.42));
    assert_same(&led.state, &expected, 2);
}

#[test]
fn what_a_window_does_not_show_is_considered() {
    // wheels 0.7 m apart: a bend from 0.03 rad/s on
    let straight: Change = |core| {
        roll(core, 0, NOW_NS, &[0.5; 2]);
        roll(core, 1, NOW_NS, &[0.52; 2]);
    };
    let bend: Change = |core| {
        roll(core, 0, NOW_NS, &[0.522; 2]);
        roll(core, 1, NOW_NS, &[0.5; 2]);
    };
    let slope: Change = |core| core.cross_slope = 0.2;
    for (changes, considered) in [
        (&[bend, with_gyro][..], &[YAW, GYRO_BIAS][..]),
        (&[bend], &[]),
        (&[straight, with_gyro], &[]),
        (&[slope], &[LEFT]),
    ] {
        let mut core = known(true);
        for change in changes {
            change(&mut core);
        }
        ran(&mut core, 0, 0.3, 0.2);
        let mut window = Window::of(&core, 0, 0.42, false);
        window.considered = considered.to_vec();
        let expected = window.update(&core);
        core.update_rim(0, span(0.42));
        assert_same(&core.state, &expected, 3);
        // and with no other sensor's reading
        let mut turned = core.state.clone();
        let before = turned.mean(YAW);
        turned.update(&ScalarMeasurement {
            jacobian: &[(YAW, 1.0), (LEFT, 1.0)],
            residual: 0.1,
            variance: 1e-3,
        });
        assert!((turned.mean(YAW) - before).abs() > 1e-3);
    }
    // a free wheel in a bend, and on a slope, shows the robot's motion
    let mut core = known(true);
    bend(&mut core);
    with_gyro(&mut core);
    slope(&mut core);
    core.state.set_mean(own_slip(2), 0.0);
    roll(&mut core, 2, NOW_NS, &[0.39; 2]);
    ran(&mut core, 2, 0.3, 0.2);
    let mut window = Window::of(&core, 2, 0.39, false);
    window.considered = vec![own_slip(2)];
    let expected = window.update(&core);
    core.update_rim(2, span(0.39));
    assert_same(&core.state, &expected, 3);
}
