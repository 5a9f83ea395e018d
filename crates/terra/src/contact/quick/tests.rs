use std::vec::Vec;

use super::super::Motion;
use super::*;
use crate::{Soil, SoilParams, WheelSize, catalogue};

/// A contact on dry sand with this K (m) and rebound ratio.
fn contact(k_shear: f64, rebound: f64, slip: f64, q_y: f64, theta_1: f64) -> Contact<f64> {
    let soil = Soil::new(SoilParams {
        k_shear,
        rebound,
        ..*catalogue::find("dry-sand")
            .unwrap()
            .soil()
            .unwrap()
            .params()
    })
    .unwrap();
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
