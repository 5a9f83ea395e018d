//! Without faults: how far the filter's slips are from the truth, whether its sigmas say so, and that it allocates nothing.

use grouser_synthetic::{Camera, Noise};

use crate::trial::{FREE, Trial};

/// The free wheel's skid is off by 1 %, over runs of their own seed; next to it alone the radii are as well, which the skid's sigma
/// covers: slip is relative to the described radius. The drive has a patch of loose ground, a bend and braking.
#[test]
fn slips_are_found_within_their_sigmas() {
    for (what, camera, rim_noise, most) in [
        ("free wheel of 500 ticks", None, 0.0, 0.03),
        (
            "and a camera",
            Some(Camera {
                every: 5,
                sigma: 0.001,
                late: 0,
            }),
            0.0,
            0.03,
        ),
        ("rough as the Pathfinder's slip", None, 0.07, 0.06),
    ] {
        let (mut rms, mut steady, mut silence) = (0.0, 0.0, 0.0_f64);
        let mut nees = Vec::new();
        let runs = 24_u32;
        let share = 1.0 / f64::from(runs);
        for seed in 0..u64::from(runs) {
            let mut trial = Trial::new(seed);
            let mut noise = Noise::new(seed + 1000);
            trial.robot.free_slip = (0.01 * noise.normal(), 0.01 * noise.normal());
            trial.radius_error = std::array::from_fn(|i| {
                if i < FREE && camera.is_none() {
                    0.01 * noise.normal()
                } else {
                    0.0
                }
            });
            trial.sensors.camera = camera;
            trial.sensors.rim_noise = rim_noise;
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
        assert!(silence <= 0.5, "{what}");
        // a free wheel may skid by 3 % on unknown ground, and does by 1 % here; a camera's sigmas are small until the slip has jumped
        assert!(mean > 0.3 && mean <= 2.2, "{what}");
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
