//! The paper's problem: what is known of it, and what it depends on.

use grouser_campaign::paper::{INTERPRETATIONS, PRINTED_SLIP, sinkage_ratio_of_slip};
use grouser_design::{Answer, Quantity};

/// The curve |S_0| = 0.1146 at angles found by another program.
#[test]
fn the_curve_of_the_printed_slip() {
    for (theta_deg, ratio) in [
        (0.0, 0.30189),
        (20.0, 0.15188),
        (24.0, 0.12005),
        (26.21, 0.10282),
        (32.0, 0.06026),
    ] {
        let theta = f64::to_radians(theta_deg);
        let found = sinkage_ratio_of_slip(PRINTED_SLIP, theta).unwrap();
        assert!((found - ratio).abs() < 1e-5, "{theta_deg}: {found}");
        let back = grouser_terra::slip_ani(theta, grouser_terra::entry_angle(found, 1.0));
        assert!((back + PRINTED_SLIP).abs() < 1e-12);
    }
    assert_eq!(
        sinkage_ratio_of_slip(PRINTED_SLIP, 89_f64.to_radians()),
        None
    );
    assert_eq!(sinkage_ratio_of_slip(f64::NAN, 0.1), None);
}

/// In pascals the slip is left where the start put it: equally good answers, different slips.
#[test]
fn the_answer_depends_on_start_and_scaling() {
    let slips = |index: usize| -> Vec<f64> {
        let design = INTERPRETATIONS[index].design(12, 1).unwrap();
        let Answer::Optimum(found) = design.solve().unwrap() else {
            panic!("minimax gives one point")
        };
        let best = found.utility;
        found
            .starts
            .iter()
            .filter(|s| s.status.is_solved() && s.utility <= best + 1e-6 * (1.0 + best.abs()))
            .map(|s| design.quantity(Quantity::S0, &s.x).unwrap().abs())
            .collect()
    };
    let spread = |slips: &[f64]| {
        let high = slips.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - slips.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let printed = slips(0);
    assert!(
        printed.len() >= 10 && spread(&printed) > 0.05,
        "{printed:?}"
    );
    let (ten, quarter) = (slips(3), slips(4));
    assert!(spread(&ten) < 1e-5 && spread(&quarter) < 1e-5);
    assert!((ten[0] - quarter[0]).abs() > 0.01, "{ten:?} {quarter:?}");
}
