//! The filter under every legal prior of a free wheel's skid.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::{Measurement, Robot, Sample, Wheel};

#[test]
fn no_legal_prior_of_a_skid_makes_it_panic() {
    let wheel = |wheel: Wheel, x| wheel.at(x, 0.0).radius(0.1).ticks_per_turn(1000);
    let wheels = vec![
        wheel(Wheel::powered("drive"), 0.3),
        wheel(Wheel::free("fifth"), -0.3),
    ];
    let robot = Robot::new("bicycle".into(), wheels).unwrap();
    for mean in [-0.95, -0.8, -0.5, 0.0, 0.5, 0.95] {
        for sigma in [1e-6, 0.01, 0.5, 2.0] {
            let settings = FilterSettings {
                free_slip: SlipPrior { mean, sigma },
                ..FilterSettings::default()
            };
            let mut filter = SlipFilter::new(&robot, settings).unwrap();
            for row in 0..300_u32 {
                let time_ns = i64::from(row) * 10_000_000;
                for (wheel, ticks) in [(0, 10), (1, 8)] {
                    let raw = u64::from(row * ticks);
                    let measurement = Measurement::WheelCount { wheel, raw };
                    filter
                        .update(Sample {
                            time_ns,
                            measurement,
                        })
                        .unwrap();
                }
            }
            let output = filter.latest();
            assert!(output.body.forward.value.is_finite(), "{mean} {sigma}");
        }
    }
}
