//! Problems of the literature that the certificate was not made with: published optima, and no better random point.

use std::ops::ControlFlow;

use grouser_opt::{CertifySettings, CertifyStatus};

use crate::random_starts::Stream;

/// Each file of `problems/` with its published optimum; NaN where none is published.
const PROBLEMS: [(&str, f64); 9] = [
    ("goldstein-price", 3.0),
    ("hartmann3", -3.862_782),
    ("shekel5", -10.153_2),
    ("g06", -6_961.813_88),
    ("haverly", -4.0),
    ("exp-rational", f64::NAN),
    ("drop-wave-disc", f64::NAN),
    ("camel-plane", f64::NAN),
    ("kinky4", f64::NAN),
];

#[test]
fn no_point_is_better_than_the_proof_of_problems_of_the_literature() {
    for (name, published) in PROBLEMS {
        let path = format!("tests/problems/{name}.toml");
        let design = grouser_design::read(path.as_ref()).unwrap();
        let mut settings = CertifySettings::default();
        settings.max_boxes = 100_000;
        let certificate = design
            .certify(&settings, &mut |_| ControlFlow::Continue(()), None)
            .unwrap();
        println!(
            "{name}: {:?} [{}, {}], {} boxes",
            certificate.status, certificate.lower, certificate.upper, certificate.boxes
        );
        assert_eq!(certificate.status, CertifyStatus::Proved, "{name}");
        let slack = 1e-5 * (1.0 + published.abs());
        assert!(
            published.is_nan() || (certificate.upper - published).abs() < slack,
            "{name}: {}",
            certificate.upper
        );
        // random points of the box, every second one near the best
        let best = certificate.x.unwrap();
        let mut stream = Stream(2012);
        let (mut feasible, mut least) = (0, f64::INFINITY);
        for case in 0..20_000 {
            let reach = 10_f64.powf(-6.0 * stream.next());
            let x: Vec<f64> = design
                .variables
                .iter()
                .zip(&best)
                .map(|(v, best)| {
                    let side = v.upper - v.lower;
                    if case % 2 == 0 {
                        v.lower + side * stream.next()
                    } else {
                        let off = reach * side * (2.0 * stream.next() - 1.0);
                        (best + off).clamp(v.lower, v.upper)
                    }
                })
                .collect();
            let Ok(merit) = design.merit(&x) else {
                continue;
            };
            if merit.violation <= 0.0 {
                feasible += 1;
                least = least.min(merit.utility);
            }
        }
        println!("  {feasible} feasible points, the best has {least}");
        assert!(feasible > 1000 || name == "haverly" || name == "g06");
        assert!(least >= certificate.lower, "{name}: {least}");
    }
}
