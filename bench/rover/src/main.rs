//! Our linkage beside rapier's reduced-coordinate multibody: the same chassis, rockers and arms, without soil.
//!
//! Both are pushed from rest by the same force and moment on the chassis; then they fly, or stand on springs under
//! the wheels' centres. Each differs from its own limit of small steps by an amount that goes with the step, or with its
//! square; when both are right, the limits are one.
#![forbid(unsafe_code)]

mod ours;
mod scene;
mod theirs;

use scene::{Positions, Scene};

const STEPS: [f64; 4] = [2e-3, 1e-3, 5e-4, 2.5e-4];

/// Greatest distance of the chassis' place (mm), attitude (mrad) and joints (mrad).
fn apart(a: &Positions, b: &Positions) -> [f64; 3] {
    let place = (0..3)
        .map(|i| (a.place[i] - b.place[i]).powi(2))
        .sum::<f64>()
        .sqrt();
    let cosine: f64 = (0..4).map(|i| a.attitude[i] * b.attitude[i]).sum();
    let turn = 2.0 * (1.0 - cosine * cosine).max(0.0).sqrt();
    let joints = a.joints.iter().zip(&b.joints).map(|(a, b)| (a - b).abs());
    [1e3 * place, 1e3 * turn, 1e3 * joints.fold(0.0, f64::max)]
}

/// The limit of small steps of a method of order `p`, by Richardson: x(h) + (x(h) − x(2 h))/(2ᵖ − 1).
fn limit(fine: &Positions, coarse: &Positions, order: i32) -> Positions {
    let share = 1.0 / (2.0_f64.powi(order) - 1.0);
    let mix = |a: f64, b: f64| a + share * (a - b);
    let mut attitude = [0, 1, 2, 3].map(|i| mix(fine.attitude[i], coarse.attitude[i]));
    let size = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
    attitude.iter_mut().for_each(|x| *x /= size);
    Positions {
        centre: [0, 1, 2].map(|i| mix(fine.centre[i], coarse.centre[i])),
        place: [0, 1, 2].map(|i| mix(fine.place[i], coarse.place[i])),
        attitude,
        joints: fine
            .joints
            .iter()
            .zip(&coarse.joints)
            .map(|(a, b)| mix(*a, *b))
            .collect(),
    }
}

fn main() {
    for scene in Scene::all() {
        println!("{}", scene.about);
        println!(
            "step, ms   ours and rapier apart: mm, mrad, joints mrad   each from its limit, mm: ours, rapier"
        );
        let runs = STEPS.map(|step| (ours::run(&scene, step), theirs::run(&scene, step)));
        let ours = limit(&runs[3].0, &runs[2].0, 2);
        let theirs = limit(&runs[3].1, &runs[2].1, 1);
        for (step, (a, b)) in STEPS.iter().zip(&runs) {
            let [place, turn, joints] = apart(a, b);
            let [from_ours, ..] = apart(a, &ours);
            let [from_theirs, ..] = apart(b, &theirs);
            println!(
                "{:8} {place:12.4} {turn:10.4} {joints:10.4} {from_ours:22.4} {from_theirs:10.4}",
                1e3 * step
            );
        }
        let [place, turn, joints] = apart(&ours, &theirs);
        println!("limits   {place:12.4} {turn:10.4} {joints:10.4}");
        let moved = ours
            .joints
            .iter()
            .fold(0.0_f64, |most, joint| most.max(joint.abs()));
        let fell = ours.place.iter().map(|x| x * x).sum::<f64>().sqrt();
        println!("         of a way of {fell:.2} m, joints turned by up to {moved:.3} rad");
        if scene.springs.is_none() {
            let parabola = scene.parabola();
            let off = |seen: &Positions| {
                let off = (0..3).map(|i| (seen.centre[i] - parabola[i]).powi(2));
                1e3 * off.sum::<f64>().sqrt()
            };
            println!(
                "centre of mass beside its parabola, mm: {:.5} {:.5}",
                off(&ours),
                off(&theirs)
            );
        }
        println!();
    }
}
