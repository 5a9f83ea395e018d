//! Without faults: how far the filter's slips are from the truth, and whether its sigmas say so.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and may say what it measured"
)]

mod trial;

use grouser_synthetic::Camera;
use trial::Trial;

#[test]
fn slips_without_faults() {
    for seed in 1..4 {
        let trial = Trial::new(seed);
        let out = trial.run();
        println!(
            "seed {seed}: rms {:.4} nees {:.2} silence {:?} speed {:.4} refused {}",
            out.rms(5.0, 23.0),
            out.nees(5.0, 23.0),
            out.silence(),
            out.speed_rms(5.0, 23.0),
            out.refused
        );
        for k in 5..23 {
            print!(
                "{k}: {:.3} {:.1}; ",
                out.rms(k as f64, k as f64 + 1.0),
                out.nees(k as f64, k as f64 + 1.0)
            );
        }
        println!();
        let mut camera = Trial::new(seed);
        camera.sensors.camera = Some(Camera {
            every: 5,
            sigma: 0.001,
            late: 0,
        });
        let out = camera.run();
        println!(
            "   camera rms {:.4} nees {:.2} silence {:?}",
            out.rms(5.0, 23.0),
            out.nees(5.0, 23.0),
            out.silence()
        );
        let mut rough = Trial::new(seed);
        rough.sensors.rim_noise = 0.07;
        let out = rough.run();
        println!(
            "   rough rms {:.4} nees {:.2} silence {:?}",
            out.rms(5.0, 23.0),
            out.nees(5.0, 23.0),
            out.silence()
        );
    }
}
