//! Forward and backward against the filter alone, on synthetic runs whose slips are known.

use grouser_replay::smoothed;
use grouser_slip::filter::FilterSettings;
use grouser_slip::{Health, Slip, WheelEstimate};
use grouser_synthetic::{Camera, Course, FiveWheel, Noise, Sensors, WHEELS};

const POWERED: usize = WHEELS - 1;

/// Squared errors, squared errors over variance, and how many.
#[derive(Default)]
struct Errors(f64, f64, f64);

impl Errors {
    fn add(&mut self, wheel: &WheelEstimate, truth: f64) {
        if let (Some(slip), Some(sigma), Health::Ok) = (wheel.slip, wheel.sigma, wheel.health) {
            let error = Slip::value(slip) - truth;
            self.0 += error * error;
            self.1 += (error / sigma).powi(2);
            self.2 += 1.0;
        }
    }

    fn rms(&self) -> f64 {
        (self.0 / self.2).sqrt()
    }

    fn nees(&self) -> f64 {
        self.1 / self.2
    }
}

#[test]
fn looking_back_makes_errors_smaller_and_sigmas_stay_honest() {
    for (what, camera, rim_noise) in [
        ("free wheel of 500 ticks", None, 0.0),
        (
            "and a camera",
            Some(Camera {
                every: 5,
                sigma: 0.001,
                late: 0,
            }),
            0.0,
        ),
        ("rough as the Pathfinder's slip", None, 0.07),
    ] {
        let (mut forward, mut both) = (Errors::default(), Errors::default());
        for seed in 0..6 {
            let mut noise = Noise::new(seed + 1000);
            let robot = FiveWheel {
                free_slip: (0.01 * noise.normal(), 0.01 * noise.normal()),
                ..FiveWheel::test_drive(seed)
            };
            let mut told = robot.clone();
            for wheel in &mut told.wheels[..POWERED] {
                wheel.radius *= 1.0 + 0.01 * noise.normal();
            }
            let mut course = Course::new(&robot, &robot.generate());
            let sensors = Sensors {
                seed: seed ^ 0x5eed,
                camera,
                rim_noise,
                ..Sensors::default()
            };
            let samples = sensors.samples(&robot, &mut course);
            let known = smoothed(
                &told.described(16).unwrap(),
                FilterSettings::default(),
                &samples,
            )
            .unwrap();
            assert_eq!(known.len(), course.steps.len());
            for (row, at) in known.iter().enumerate() {
                let step = &course.steps[row.saturating_sub(1)];
                if step.speed.abs() < 0.05 {
                    continue;
                }
                for wheel in 0..POWERED {
                    if let Some(truth) = course.slip(row.saturating_sub(1), wheel) {
                        forward.add(&at.forward[wheel], truth);
                        both.add(&at.wheels[wheel], truth);
                    }
                }
            }
        }
        println!(
            "{what}: RMSE {:.4} forward, {:.4} both ways; squared error over variance {:.2} and {:.2}",
            forward.rms(),
            both.rms(),
            forward.nees(),
            both.nees(),
        );
        assert!(both.rms() < forward.rms(), "{what}");
        // radii and the free wheel's skid are off for a whole run: six runs leave a wide band
        assert!(both.nees() > 0.3 && both.nees() < 2.5, "{what}");
    }
}
