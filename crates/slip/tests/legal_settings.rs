//! Filter, means and on-board computer under settings drawn from all that are legal, on robots of several kinds:
//! no panic, and nothing said that is not finite.

use grouser_slip::control::{ControlSettings, Request};
use grouser_slip::detect::DetectSettings;
use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::onboard::{OnBoard, OnBoardSettings};
use grouser_slip::settings::Field;
use grouser_slip::{Measurement, Sample, SensorSettings};
use proptest::prelude::*;

use crate::noise::Noise;
use crate::sane::is_sane;
use crate::world::{STEP_NS, World};

/// Settings of which about half of the numbers lie anywhere within their limits, some of them at a limit.
fn drawn<S: Copy + Default>(noise: &mut Noise, fields: &[Field<S>]) -> S {
    let mut settings = S::default();
    for field in fields {
        let (low, high) = field.limits;
        let share = noise.uniform();
        let value = match noise.uniform() {
            x if x < 0.5 => continue,
            x if x < 0.55 => low,
            x if x < 0.6 => high,
            // numbers of one sign spread over their powers of ten
            _ if low >= 0.0 => {
                let low = low.max(1e-7 * high);
                low * (high / low).powf(share)
            }
            _ => low + share * (high - low),
        };
        field.set(&mut settings, value);
    }
    settings
}

fn one_of<T: Copy>(noise: &mut Noise, [a, b, c]: [T; 3]) -> T {
    match noise.uniform() {
        x if x < 1.0 / 3.0 => a,
        x if x < 2.0 / 3.0 => b,
        _ => c,
    }
}

/// A short drive with a soft patch, of a robot of two to six powered wheels, with and without a free wheel and a camera.
fn drawn_world(noise: &mut Noise) -> World {
    World {
        powered: one_of(noise, [2, 4, 6]),
        free: noise.uniform() < 0.5,
        camera: one_of(noise, [0, 10, 25]),
        speed: one_of(noise, [0.02, 0.3, 3.0]),
        accelerometer: noise.uniform() < 0.5,
        legs: [0.5, 0.5, 3.0, 0.5],
        patch: (1.5, 2.5),
        ..World::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn no_legal_setting_of_the_filter_breaks_it(seed in any::<u64>()) {
        let mut noise = Noise::new(seed);
        let world = drawn_world(&mut noise);
        let settings: FilterSettings = drawn(&mut noise, FilterSettings::FIELDS);
        let mut filter = SlipFilter::new(&world.robot(), settings).unwrap();
        let mut failed = None;
        world.run(|_, row| {
            for sample in row {
                let _ = filter.update(*sample);
            }
            failed = failed.take().or_else(|| is_sane(&filter).err());
        });
        prop_assert!(failed.is_none(), "{failed:?} with {settings:?}");
    }

    #[test]
    fn no_legal_setting_of_the_computer_breaks_its_commands(seed in any::<u64>()) {
        let mut noise = Noise::new(seed);
        let world = drawn_world(&mut noise);
        let robot = world.robot();
        let mut settings = OnBoardSettings::new(&robot);
        settings.filter = drawn(&mut noise, FilterSettings::FIELDS);
        settings.detect = drawn(&mut noise, DetectSettings::FIELDS);
        let mut control: ControlSettings = drawn(&mut noise, ControlSettings::FIELDS);
        control.level = control.level.min(control.steep);
        settings.control = control;
        settings.warm_up = settings.warm_up.min(control.blind_time);
        for setup in &mut settings.wheels {
            setup.max_torque = (noise.uniform() < 0.7).then_some(5.0);
            setup.max_steering_angle = if noise.uniform() < 0.5 { 0.6 } else { 0.0 };
        }
        let mut on_board = OnBoard::new(&robot, settings).unwrap();
        let request = Request { speed: 3.0 * noise.normal(), heading: noise.normal(), yaw_rate: None };
        let mut wrong = None;
        let mut row_number = 0;
        world.run(|_, row| {
            for sample in row {
                on_board.update(*sample);
            }
            let time_ns = row_number * STEP_NS;
            row_number += 1;
            let [force, rate] = [3.0, 0.3].map(|size| core::array::from_fn(|_| size * noise.normal()));
            on_board.update(Sample { time_ns, measurement: Measurement::Inertial { force, rate } });
            for command in on_board.tick(time_ns, request) {
                let limits = [
                    (command.rim_speed, control.max_rim_speed),
                    (command.traction, f64::MAX),
                    (command.steering_angle, 0.6 + 1e-9),
                ];
                if limits.iter().any(|(value, limit)| !(value.abs() <= *limit)) {
                    wrong = Some(*command);
                }
            }
        });
        prop_assert!(wrong.is_none(), "{wrong:?} with {control:?}");
    }
}

/// `check` refuses values beside the limits of every field, which the message names; the limits themselves are legal.
fn check_limits<S: Copy + Default>(
    fields: &[Field<S>],
    check: impl Fn(&S) -> grouser_slip::Result<()>,
) {
    for field in fields {
        let (low, high) = field.limits;
        for value in [low.next_down(), high.next_up(), f64::NAN] {
            let mut settings = S::default();
            field.set(&mut settings, value);
            assert_eq!(field.get(&settings).to_bits(), value.to_bits());
            let refused = check(&settings).unwrap_err().to_string();
            assert!(refused.contains(field.name), "{}: {refused}", field.name);
        }
        for value in [low, high] {
            let mut settings = S::default();
            field.set(&mut settings, value);
            assert!(field.check("settings", &settings).is_ok());
        }
        let mut settings = S::default();
        field.set_from_file(&mut settings, 0.5);
        let expected = match field.key {
            Some(key) if key.ends_with("_deg") || key.contains("_deg_") => 0.5_f64.to_radians(),
            _ => 0.5,
        };
        assert!(
            (field.get(&settings) - expected).abs() < 1e-15,
            "{}",
            field.name
        );
    }
}

#[test]
fn what_is_outside_a_limit_is_refused_by_name() {
    check_limits(ControlSettings::FIELDS, ControlSettings::check);
    check_limits(FilterSettings::FIELDS, FilterSettings::check);
    check_limits(SensorSettings::FIELDS, SensorSettings::check);
    check_limits(DetectSettings::FIELDS, DetectSettings::check);
    let mut settings = ControlSettings::default();
    (settings.level, settings.steep) = (0.1, 0.05);
    assert!(settings.check().unwrap_err().to_string().contains("level"));
}
