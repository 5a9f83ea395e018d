use std::vec;
use std::vec::Vec;

use super::super::Motion;
use super::*;
use crate::catalogue::tests::dry_sand_with;
use crate::{ShearLaw, WheelSize};

/// A contact on dry sand with this K (m) and rebound ratio.
fn contact(k_shear: f64, rebound: f64, slip: f64, q_y: f64, theta_1: f64) -> Contact<f64> {
    let soil = dry_sand_with(|params| (params.k_shear, params.rebound) = (k_shear, rebound));
    let motion = Motion {
        slip,
        q_y,
        slip_angle: 0.1,
    };
    let size = WheelSize::smooth(0.1, 0.05);
    Contact::new(&size, &soil.laws(), ShearLaw::Coupled, &motion, theta_1)
}

fn plan_of(contact: &Contact<f64>) -> Option<QuickPlan> {
    contact.quick(|plan| *plan)
}

#[test]
fn third_roots() {
    for i in 1..=1000 {
        let t = f64::from(i) / 1000.0;
        for t in [t, t * 1e-6, t * 1e-15] {
            assert!((third_root(t) / t.cbrt() - 1.0).abs() < 1e-9, "{t}");
        }
    }
}

/// Against the signs of j/r = w − q (sin θ_1 − sin(θ_1 − w)) at many arcs, and halving.
#[test]
fn cuts_are_where_the_displacement_changes_its_sign() {
    let mut counts = [0; 3];
    for theta_1 in [0.1_f64, 0.4, 0.7, 1.0] {
        for rebound in [0.0, 0.2, 0.6, 1.0] {
            for i in 0..60 {
                let skid = 0.5 * (f64::from(i) / 60.0).powi(2) + 1e-3;
                let contact = contact(0.1, rebound, -skid, 0.0, theta_1);
                let Some(plan) = plan_of(&contact) else {
                    continue;
                };
                let (q, arc) = (1.0 / (1.0 - skid), contact.arc());
                let j = |w: f64| w - q * (theta_1.sin() - (theta_1 - w).sin());
                let mut roots = Vec::new();
                let mut from = 1e-6 * arc;
                for k in 1..=500 {
                    let to = arc * f64::from(k) / 500.0;
                    if (j(from) < 0.0) != (j(to) < 0.0) {
                        let (mut low, mut high) = (from, to);
                        for _ in 0..50 {
                            let middle = 0.5 * (low + high);
                            if (j(middle) < 0.0) == (j(low) < 0.0) {
                                low = middle;
                            } else {
                                high = middle;
                            }
                        }
                        roots.push(low);
                    }
                    from = to;
                }
                let (cuts, count) = plan.contact.cuts(1.0 - q);
                assert_eq!(count, roots.len(), "{theta_1} {rebound} {skid}");
                counts[count] += 1;
                for (cut, root) in cuts.iter().zip(&roots) {
                    // beside the entry the displacement hardly differs from 0, wherever the cut is
                    let is_close = (cut - root).abs() < 2e-4 * arc || *root < 0.02 * arc;
                    assert!(is_close, "{cut} {root} {theta_1} {skid}");
                }
                // each piece from 0 to 1 without gaps, and a part for each piece and each cut
                let of = |is_front: bool| {
                    let parts = plan
                        .parts()
                        .iter()
                        .filter(move |part| part.is_front == is_front);
                    parts.map(|part| (part.from, part.to)).collect::<Vec<_>>()
                };
                let (front, rear) = (of(true), of(false));
                for piece in [&front, &rear] {
                    assert!(piece[0].0 == 0.0 && piece[piece.len() - 1].1 == 1.0);
                    assert!(piece.windows(2).all(|pair| pair[0].1 == pair[1].0));
                }
                assert_eq!(front.len() + rear.len(), 2 + count);
                assert_eq!(plan.is_whole(), count == 0);
                let (length, behind) = (plan.contact.front, plan.contact.rear);
                for cut in &cuts[..count] {
                    let ends = if *cut < length { &front } else { &rear };
                    let t = if *cut < length {
                        cut / length
                    } else {
                        1.0 - (cut - length) / behind
                    };
                    assert!(ends.iter().any(|(_, to)| (to - t.cbrt()).abs() < 1e-8));
                }
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 5), "{counts:?}");
}

/// r·arc (max|1 − q cos θ| + |q_y|)/K.
#[test]
fn the_rule_follows_the_stiffness() {
    // at slip 1 j is w: the stiffness is 0.1 · 0.6/K, and with a drift of 1 twice that
    let nodes = |stiffness: f64, q_y: f64| {
        let k_shear = 0.06 * (1.0 + q_y) / stiffness;
        plan_of(&contact(k_shear, 0.0, 1.0, q_y, 0.6)).map(|plan| plan.rule().nodes.len())
    };
    for q_y in [0.0, 1.0] {
        assert_eq!(nodes(1.499, q_y), Some(8));
        assert_eq!(nodes(1.501, q_y), Some(16));
        assert_eq!(nodes(15.99, q_y), Some(16));
        assert_eq!(nodes(16.01, q_y), None);
    }
    // where j changes its sign beside a drift; skid 0.1, |1 − q| the greatest
    let turning = |stiffness: f64, q_y: f64| {
        let fastest = (1.0 / 0.9 - 1.0_f64).max(1.0 - 0.6_f64.cos() / 0.9);
        let k_shear = 0.06 * (fastest + q_y) / stiffness;
        let plan = plan_of(&contact(k_shear, 0.0, -0.1, q_y, 0.6)).unwrap();
        assert!(!plan.is_whole());
        plan.rule().nodes.len()
    };
    assert_eq!((turning(0.299, 0.01), turning(0.301, 0.01)), (8, 16));
    assert_eq!((turning(1.499, 0.0), turning(1.501, 0.0)), (8, 16));
}

#[test]
fn what_the_quick_kernel_serves() {
    let serves = |contact: &Contact<f64>| plan_of(contact).is_some();
    let at = |theta_1: f64, rebound: f64| contact(0.1, rebound, 0.2, 0.1, theta_1);
    assert!(!serves(&at(0.009_99, 0.0)) && serves(&at(0.010_01, 0.0)));
    assert!(serves(&at(1.047, 0.0)) && !serves(&at(1.049, 0.0)));
    // an arc of 1.7
    assert!(serves(&at(0.849, 1.0)) && !serves(&at(0.851, 1.0)));
    assert!(!serves(&contact(0.1, 0.0, -1.0, 0.1, 0.4)));
    let mut other = at(0.4, 0.0);
    other.shear.law = ShearLaw::Independent;
    assert!(!serves(&other));
    let mut other = at(0.4, 0.0);
    other.shear.restart = Some(crate::shear::Restart {
        arc: 0.1,
        displacement: 0.0,
        front: None,
    });
    assert!(!serves(&other));
}

/// Newton's method alone, from where it begins, at contacts that it is fit for and others.
#[test]
fn how_many_cuts_newtons_method_finds() {
    /// Cuts within half of the precision, as the estimate of the error promises, those beyond, where the displacement is nearly
    /// stationary, and those that it leaves to the secant.
    const COUNTS: [u32; 3] = [88, 3, 5];
    let mut counts = [0; 3];
    for i in 0..400 {
        let share = |factor: f64| (f64::from(i) * factor).fract();
        let theta_1 = 0.05 + 0.98 * share(0.618_034);
        let skid = 1e-3 + 0.5 * share(0.754_878).powi(2);
        let contact = contact(0.1, share(0.569_840), -skid, 0.0, theta_1);
        let Some(plan) = plan_of(&contact) else {
            continue;
        };
        let (q, of) = (1.0 / (1.0 - skid), &plan.contact);
        let arc = of.theta_1 - of.theta_2;
        let close = CUT_PRECISION * arc;
        let turn = (1.0 / q).acos();
        let ends = [(theta_1 - turn).max(0.0), (theta_1 + turn).min(arc), arc];
        for (near, ends) in vanishing_arcs(theta_1, 1.0 - 1.0 / q)
            .into_iter()
            .zip(ends.windows(2))
        {
            let (mut low, mut high) = (ends[0], ends[1]);
            let rises = of.along(high) > 0.0;
            if (of.along(low) > 0.0) == rises || low == 0.0 {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (of.along(middle) > 0.0) == rises {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            let found = of.newton(near, [ends[0], ends[1]], close);
            counts[match found {
                Some(w) if (w - low).abs() <= 0.5 * close => 0,
                Some(w) if (w - low).abs() <= 2.0 * close => 1,
                Some(w) => panic!("{w} {low} {theta_1} {skid}"),
                None => 2,
            }] += 1;
            let ends = [ends[0], ends[1]].map(|w| (w, of.along(w)));
            // beside the entry the displacement hardly differs from 0, wherever the cut is
            let cut = of.cut(near, ends, close);
            let is_close = (cut - low).abs() <= 3.0 * close || low < 0.02 * arc;
            assert!(is_close, "{cut} {low} {found:?}");
        }
    }
    assert_eq!(counts, COUNTS);
}

#[test]
fn where_the_search_for_a_cut_begins() {
    for (degrees, off) in [(10.0_f64, 1e-7), (30.0, 2e-6), (60.0, 2e-4)] {
        let angle = degrees.to_radians();
        let series = turning_angle(1.0 - angle.cos());
        assert!((series - angle).abs() < off, "{degrees}: {series}");
    }
    for (theta_1, over) in [(0.4, 0.05), (0.7, 0.2), (0.9, 0.11)] {
        let third = |x: f64| x - x.powi(3) / 6.0;
        for w in vanishing_arcs(theta_1, over) {
            // q = 1/(1 − over)
            let j = w - (third(theta_1) - third(theta_1 - w)) / (1.0 - over);
            assert!(j.abs() < 1e-15, "{j}");
        }
    }
    // they would be complex
    assert_eq!(vanishing_arcs(0.9, 0.1), [1.35; 2]);
}

/// Contacts of which one piece is empty.
#[test]
fn a_single_piece() {
    let parts = |slip: f64, theta_m: fn(&Contact<f64>) -> f64| {
        let mut contact = contact(0.1, 0.0, slip, 0.0, 0.6);
        contact.angles.theta_m = theta_m(&contact);
        contact.shear.lugs = 0.25;
        let plan = plan_of(&contact).unwrap();
        assert_eq!(plan.contact.lugs, 1.25);
        // without a front there is no normal stress
        assert_eq!(plan.contact.amplitude == 0.0, plan.contact.front == 0.0);
        let is_front = plan.parts().iter().map(|part| part.is_front);
        (is_front.collect::<Vec<_>>(), plan.is_whole())
    };
    assert_eq!(
        parts(0.2, |contact| contact.angles.theta_2),
        (vec![true], false)
    );
    assert_eq!(
        parts(0.2, |contact| contact.angles.theta_1),
        (vec![false], false)
    );
    assert_eq!(
        parts(0.2, |contact| contact.angles.theta_m),
        (vec![true, false], true)
    );
    // cut where the displacement changes its sign
    assert_eq!(
        parts(-0.1, |contact| contact.angles.theta_2),
        (vec![true; 2], false)
    );
    assert_eq!(
        parts(-0.1, |contact| contact.angles.theta_1),
        (vec![false; 2], false)
    );
}

/// A plan of both pieces, and its strength times arc by hand, Pa.
fn plan_and_strength() -> (QuickPlan, f64) {
    let plan = plan_of(&contact(0.1, 0.3, 0.2, 0.1, 0.6)).unwrap();
    let of = &plan.contact;
    let drop = (of.theta_1 - of.front).cos() - of.theta_1.cos();
    let strength = of.amplitude * drop.powf(of.n) * of.tan_phi + of.cohesion;
    (plan, strength * (of.theta_1 - of.theta_2))
}

/// Parts whose rule does not agree with itself by 1e-10 of strength and arc are halved, and their halves.
#[test]
fn parts_are_halved_until_the_rule_agrees_with_itself() {
    let (plan, strength) = plan_and_strength();
    let close = 1e-10 * strength;
    let force = Integrals {
        sigma_cos: strength,
        ..Integrals::zero()
    };
    // (τ, |τ_y|) of the whole, the lower and the upper half of the front piece, over the limit; 0 elsewhere
    let calls = |whole: [f64; 2], low: [f64; 2], high: [f64; 2]| {
        let calls = core::cell::RefCell::new(Vec::new());
        plan.halved(|part| {
            calls.borrow_mut().push((part.is_front, part.from, part.to));
            let [tau, tau_side] = match (part.is_front, part.from, part.to) {
                (true, 0.0, 1.0) => whole,
                (true, 0.0, 0.5) => low,
                (true, 0.5, 1.0) => high,
                _ => [0.0; 2],
            };
            Integrals {
                tau: tau * close,
                tau_side: tau_side * close,
                ..force
            }
        })
        .unwrap();
        calls.into_inner()
    };
    let once = |is_front: bool| {
        [
            (is_front, 0.0, 1.0),
            (is_front, 0.0, 0.5),
            (is_front, 0.5, 1.0),
        ]
    };
    let both = [once(true), once(false)].concat();
    for (whole, low, high) in [
        ([0.999, 0.0], [0.0; 2], [0.0; 2]),
        ([7.0, 0.0], [4.5, 0.0], [1.501, 0.0]),
        ([0.0, 7.0], [0.0, 4.5], [0.0, 3.499]),
        ([7.0, 6.0], [4.5, 3.5], [2.0, 2.999]),
    ] {
        assert_eq!(calls(whole, low, high), both, "{whole:?}");
    }
    let front = [
        (0.0, 1.0),
        (0.0, 0.5),
        (0.5, 1.0),
        (0.0, 0.25),
        (0.25, 0.5),
        (0.5, 0.75),
        (0.75, 1.0),
    ];
    let front = front.map(|(from, to)| (true, from, to));
    let deeper = [&front[..], &once(false)].concat();
    for (whole, low, high) in [
        ([1.001, 0.0], [0.0; 2], [0.0; 2]),
        ([-0.6, 0.401], [0.0; 2], [0.0; 2]),
        ([0.401, -0.6], [0.0; 2], [0.0; 2]),
    ] {
        assert_eq!(calls(whole, low, high), deeper, "{whole:?}");
    }
}

/// What does not agree is halved sixteen times below the first halves: 2 (2¹⁸ − 1) parts.
#[test]
fn halving_ends() {
    let (plan, strength) = plan_and_strength();
    let calls = core::cell::Cell::new(0);
    let sums = plan.halved(|_| {
        calls.set(calls.get() + 1);
        Integrals {
            sigma_cos: strength,
            tau: 1.0,
            ..Integrals::zero()
        }
    });
    assert_eq!(calls.get(), 2 * ((1 << 18) - 1));
    // all of the last halves, and each once
    assert_eq!(sums.unwrap().tau, f64::from(1 << 18));
}

/// The greatest of vertical force, pull and torque has to be 0.4 of strength times arc.
#[test]
fn shear_that_cancels_is_left_to_the_panels() {
    let (plan, strength) = plan_and_strength();
    let is_served = |share: f64, forces: [f64; 5]| {
        let [sigma_cos, sigma_sin, tau_cos, tau_sin, tau] =
            forces.map(|force| share * strength * force);
        plan.halved(|part| {
            // both pieces have the length 1 in v
            let length = 0.5 * (part.to - part.from);
            Integrals {
                sigma_cos,
                sigma_sin,
                tau_cos,
                tau_sin,
                tau,
                tau_side: 0.0,
                lost: 0.0,
            }
            .map(|x| length * x)
        })
        .is_some()
    };
    for forces in [
        [5.0, 3.0, 2.5, -6.0, 0.7],
        [-3.0, -2.0, -2.5, 2.0, -0.7],
        [1.0, -3.0, -2.0, -0.3, -0.7],
        [3.0, 2.0, 1.2, -2.5, 1.0],
    ] {
        assert!(is_served(0.401, forces), "{forces:?}");
        assert!(!is_served(0.399, forces), "{forces:?}");
    }
}
