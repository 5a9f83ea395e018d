//! Without faults: how far the filter's slips are from the truth, whether its sigmas say so, and that it allocates nothing.

use grouser_synthetic::{Camera, Noise};

use crate::trial::{FREE, Trial};

/// How far one wheel's slip goes from the others' in these runs, as the filter has it (it halves its setting on calm ground).
const ASSUMED_OWN_SLIP: f64 = 0.046;

/// With the free wheel's skid and every radius off by what the filter is configured with they may be (1 %), over runs of their own
/// seed. The drive has a patch of loose ground, a bend and braking.
#[test]
fn slips_are_found_within_their_sigmas() {
    for (what, camera, rim_noise, window, reported, most) in [
        (
            "free wheel of 500 ticks",
            None,
            0.0,
            0.05,
            ASSUMED_OWN_SLIP,
            0.03,
        ),
        (
            "the default's wheel_slip_sigma",
            None,
            0.0,
            0.05,
            0.08,
            0.03,
        ),
        ("windows of 20 ms", None, 0.0, 0.02, 0.08, 0.03),
        (
            "and a camera",
            Some(Camera {
                every: 5,
                sigma: 0.001,
                late: 0,
            }),
            0.0,
            0.05,
            1.2 * ASSUMED_OWN_SLIP,
            0.03,
        ),
        (
            "rough as the Pathfinder's slip",
            None,
            0.07,
            0.05,
            0.08,
            0.06,
        ),
    ] {
        let (mut rms, mut steady, mut silence) = (0.0, 0.0, 0.0_f64);
        let mut nees = Vec::new();
        let runs = 24_u32;
        let share = 1.0 / f64::from(runs);
        for seed in 0..u64::from(runs) {
            let mut trial = Trial::new(seed);
            let mut noise = Noise::new(seed + 1000);
            trial.robot.free_slip = (0.01 * noise.normal(), 0.01 * noise.normal());
            trial.radius_error =
                std::array::from_fn(|i| if i < FREE { 0.01 * noise.normal() } else { 0.0 });
            trial.sensors.camera = camera;
            trial.sensors.rim_noise = rim_noise;
            trial.settings.wheel_window = window;
            // what the sensors of this run are: .1 m/s² a sample at 100 Hz, .003 rad/s
            trial.settings.accelerometer_noise = 0.01;
            trial.settings.yaw_rate_sigma = trial.robot.gyro_sigma;
            // and how far one wheel's slip goes from the others' here; the default is for ground that changes
            trial.settings.wheel_slip_sigma = reported;
            let out = trial.run();
            rms += share * out.rms(5.0, 23.0);
            steady += share * out.rms(6.0, 10.5);
            nees.push(out.nees(5.0, 23.0));
            silence = silence.max(out.silence().0);
        }
        let mean = share * nees.iter().sum::<f64>();
        let scatter = nees.iter().map(|n| (n - mean) * (n - mean)).sum::<f64>();
        // most of an error lasts for its whole run: the runs, not their moments, are what is independent
        let band = 1.96 * (scatter * share / f64::from(runs - 1)).sqrt();
        println!(
            "{what}: rms {rms:.4}, {steady:.4} on steady ground, squared error over variance {mean:.2} ± {band:.2}, longest silence {silence:.2} s"
        );
        assert!(rms < most, "{what}");
        assert!(silence <= 0.3, "{what}");
        if reported < 1.5 * ASSUMED_OWN_SLIP {
            assert!((mean - 1.0).abs() <= band, "{what}");
        } else {
            // rougher than its settings say, or with ticks that last from window to window: it must notice
            assert!(mean < 2.2, "{what}");
        }
    }
}

#[test]
fn nothing_is_allocated_and_the_same_samples_give_the_same_bits() {
    let mut trial = Trial::new(1);
    trial.sensors.camera = Some(Camera {
        every: 5,
        sigma: 0.001,
        late: 0,
    });
    let (_, samples) = trial.samples();
    let run = || {
        let mut filter = trial.filter();
        let counted = allocation_counter::measure(|| {
            for sample in &samples {
                let _ = filter.update(*sample);
            }
        });
        assert_eq!(counted.count_total, 0);
        format!("{:?}", filter.latest())
    };
    assert_eq!(run(), run());
}
