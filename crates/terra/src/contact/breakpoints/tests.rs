use super::*;
use crate::ShearLaw;
use crate::shear::Displacement;

/// r 0.1, K 0.02, K across 0.01 m.
fn state(law: ShearLaw, theta_1: f64, q: f64, q_y: f64) -> ShearState<f64> {
    ShearState {
        law,
        displacement: Displacement {
            theta_1,
            q,
            one_minus_q: 1.0 - q,
        },
        radius: 0.1,
        k_shear: 0.02,
        k_side: 0.01,
        q_y,
        locked: false,
        sideways: q_y != 0.0,
        restart: None,
        lugs: 0.0,
    }
}

fn straight(theta_1: f64, q: f64) -> ShearState<f64> {
    state(ShearLaw::Coupled, theta_1, q, 0.0)
}

fn stretches(of: &ShearState<f64>, arc: f64, expected: &[f64]) {
    let got = of.monotone_stretches(arc);
    assert_eq!(got.as_slice().len() + 1, expected.len());
    for ((from, to), ends) in got.as_slice().iter().zip(expected.windows(2)) {
        assert!((from - ends[0]).abs() < 1e-12 && (to - ends[1]).abs() < 1e-12);
    }
}

#[test]
fn displacement_turns_where_the_rim_moves_as_the_ground() {
    let sixty = core::f64::consts::FRAC_PI_3;
    // cos θ = 1/q: 60° in front of the lowest point and behind it
    stretches(
        &straight(1.2, 2.0),
        2.4,
        &[0.0, 1.2 - sixty, 1.2 + sixty, 2.4],
    );
    stretches(&straight(1.2, 2.0), 1.0, &[0.0, 1.2 - sixty, 1.0]);
    stretches(&straight(0.8, 2.0), 1.0, &[0.0, 1.0]);
    for q in [0.9, 1.0] {
        stretches(&straight(1.2, q), 2.4, &[0.0, 2.4]);
    }
    let restart = |front| ShearState {
        restart: Some(Restart {
            arc: 0.5,
            displacement: 0.1,
            front,
        }),
        ..straight(1.2, 2.0)
    };
    stretches(&restart(None), 1.0, &[0.0, 1.2 - sixty, 0.5, 1.0]);
    // 1 + K_v q = q cos θ
    let turn = 1.2 - f64::acos(0.7);
    stretches(
        &restart(Some(0.4)),
        1.0,
        &[0.0, 1.2 - sixty, turn, 0.5, 1.0],
    );
    // it never turns, but the lowest point is a cut too
    stretches(&restart(Some(1.4)), 1.3, &[0.0, 1.2 - sixty, 0.5, 1.2, 1.3]);
    stretches(&restart(Some(-4.0)), 1.0, &[0.0, 1.2 - sixty, 0.5, 1.0]);

    assert!(straight(0.8, 2.0).is_one_signed(1.0) && !straight(1.2, 2.0).is_one_signed(1.0));
    let locked = ShearState {
        locked: true,
        ..straight(1.2, 2.0)
    };
    assert!(locked.is_one_signed(1.0) && !locked.reverses(1.2));
}

#[test]
fn displacement_reverses_where_it_has_both_signs() {
    // j/r = w − q (sin θ_1 − sin(θ_1 − w)) by hand at the ends of its stretches
    for (theta_1, q, arc, expected) in [
        (1.2, 2.0, 1.2, true),  // 0.01, −0.66
        (1.2, 2.0, 0.1, false), // 0.02
        (0.8, 2.0, 1.6, false), // −1.27
        (1.2, 0.8, 2.4, false), // 0.91
        (1.2, 1.27, 2.4, true), // 0.14, −0.10, 0.03
        (1.2, 2.0, 2.4, true),  // 0.01, −2.2, −1.3
        (1.2, 1.2, 2.4, false), // 0.16, 0.004, 0.16
        (0.3, 1.05, 1.2, true), // −0.02, 0.07
    ] {
        assert_eq!(
            straight(theta_1, q).reverses(arc),
            expected,
            "{theta_1} {q} {arc}"
        );
    }
}

#[test]
fn the_direction_swings_where_drift_is_small_beside_some_of_the_slip() {
    use ShearLaw::{Coupled, Independent, SlipVelocity, SlipVelocityRegular};
    let swings = |law, q_y| state(law, 0.8, 1.05, q_y).swings(0.8);
    assert!(swings(SlipVelocityRegular, 0.0) && swings(SlipVelocityRegular, 0.1));
    assert!(!swings(SlipVelocity, 0.0) && swings(SlipVelocity, 0.1));
    assert!(!swings(Independent, 0.1) && !swings(Coupled, 0.0));
    // 1 − q cos θ from 0.268 at the entry to −0.05 at the lowest point
    assert!(swings(Coupled, 0.1) && swings(Coupled, 0.53) && swings(Coupled, -0.53));
    assert!(!swings(Coupled, 0.54) && !swings(Coupled, -0.54));
    let locked = ShearState {
        locked: true,
        ..state(Coupled, 0.8, 1.05, 0.1)
    };
    assert!(!locked.swings(0.8));
    // from 0.1 to 0.39 and 0.41, from −1 to −0.26 and −0.24; and of the size of the drift
    for (q, slope, expected) in [
        (0.9, 0.39, false),
        (0.9, 0.41, true),
        (2.0, -0.26, false),
        (2.0, -0.24, true),
    ] {
        let theta_1 = f64::acos((1.0 - slope) / q);
        let of = |q_y| state(Coupled, theta_1, q, q_y).swings(theta_1);
        assert_eq!(of(0.05), expected, "{q} {slope}");
        assert!(!of(2.1));
    }
    let steep = state(Coupled, f64::acos(0.62), 2.0, 1.9);
    assert!(steep.swings(f64::acos(0.62)));
}

#[test]
fn stiffness_is_the_fastest_growth_over_the_arc() {
    // |1 − q| at the lowest point: 0.1 · 1.5 · 1/0.01, and with 0.1 · 0.5 · 1.5 across
    assert!((straight(1.2, 2.0).stiffness(1.5) - 15.0).abs() < 1e-12);
    let across = state(ShearLaw::Coupled, 1.2, 2.0, 0.5).stiffness(1.5);
    assert!((across - 0.15_f64.hypot(0.075) / 0.01).abs() < 1e-12);
    // at the entry 1 − cos(1.2)/2; with an arc that ends before the lowest point 1 − 2 cos(0.5)
    let entry = straight(1.2, 0.5).stiffness(1.5);
    assert!((entry - 15.0 * (1.0 - 0.5 * 1.2_f64.cos())).abs() < 1e-12);
    let short = straight(1.2, 2.0).stiffness(0.7);
    assert!((short - 7.0 * (2.0 * 0.5_f64.cos() - 1.0)).abs() < 1e-12);
}

fn breaks(shear: &ShearState<f64>, arc: f64, detail: Detail) -> std::vec::Vec<f64> {
    let mut cuts = Breakpoints {
        cuts: [0.0; CAPACITY],
        len: 0,
    };
    cuts.add_shear(shear, arc, detail);
    cuts.as_slice().to_vec()
}

#[test]
fn cuts_are_where_the_displacement_has_a_level() {
    // K_shear 0.02 · 1.5, 4 and 9 of j along; j(1.4) = 0.1 (1.4 + 3 (sin 0.8 + sin 0.6)) is 18.4 K
    let shear = ShearState {
        k_shear: 0.002,
        ..straight(0.8, 0.2)
    };
    let cuts = breaks(&shear, 1.4, Detail::Fine);
    let last = shear.along(1.4) / 0.002;
    let levels: std::vec::Vec<f64> = [1.5, 4.0, 9.0, 18.0, 42.0]
        .into_iter()
        .filter(|k| *k < last)
        .collect();
    assert_eq!(cuts.len(), levels.len());
    for (cut, level) in cuts.iter().zip(levels) {
        assert!((shear.along(*cut) - level * 0.002).abs() < 1e-12);
    }
    // backwards as well, and where the sign changes
    let shear = ShearState {
        k_shear: 0.002,
        ..straight(1.2, 2.0)
    };
    let cuts = breaks(&shear, 1.2, Detail::Fine);
    let zero = cuts
        .iter()
        .filter(|w| shear.along(**w).abs() < 1e-15)
        .count();
    assert_eq!(zero, 1);
    let most = shear.along(1.2) / 0.002;
    let count = [1.5, 4.0, 9.0, 18.0, 42.0]
        .into_iter()
        .filter(|k| -k > most)
        .count();
    // the turn too
    assert_eq!(cuts.len(), 2 + count, "{cuts:?}");
    // where the stress does not turn a tenth is close enough
    let cuts = breaks(&shear, 1.2, Detail::Standard);
    let levels = [0.0, 0.0, 2.0, 6.0, 13.0, 26.0].map(|level| -0.002 * level);
    assert!(cuts.len() > 3 && shear.along(1.2) < levels[cuts.len() - 1]);
    for (cut, level) in cuts.iter().zip(levels).skip(1) {
        let off = (shear.along(*cut) - level).abs();
        assert!(off <= -0.1 * level + 1e-15, "{off} {level}");
    }
    // across in proportion to the arc, by the K of its law
    for (law, k) in [(ShearLaw::Coupled, 0.02), (ShearLaw::Independent, 0.01)] {
        let cuts = breaks(&state(law, 0.8, 1.0, 2.0), 0.9, Detail::Standard);
        assert!((cuts[0] - 2.0 * k / 0.2).abs() < 1e-12, "{cuts:?}");
        assert!((cuts[1] - 6.0 * k / 0.2).abs() < 1e-12, "{cuts:?}");
    }
}

/// A locked wheel's shear is the same everywhere: only the sines over a long arc are cut.
#[test]
fn a_finer_rule_cuts_the_arc_into_equal_parts() {
    let soil = crate::catalogue::find("dry-sand").unwrap().soil().unwrap();
    let motion = crate::Motion {
        slip: -1.0,
        q_y: 0.0,
        slip_angle: 0.0,
    };
    let size = crate::WheelSize::smooth(0.1, 0.05);
    let contact = Contact::new(&size, &soil.laws(), ShearLaw::Coupled, &motion, 0.8);
    for (detail, parts) in [(Detail::Standard, 1), (Detail::Fine, 2), (Detail::Finer, 4)] {
        let cuts = Breakpoints::new(&contact, detail);
        let expected = (1..parts).map(|i| 0.8 * f64::from(i) / f64::from(parts));
        assert!(cuts.as_slice().iter().copied().eq(expected), "{detail:?}");
    }
}
