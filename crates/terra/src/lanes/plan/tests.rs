use super::super::Lanes;
use super::*;

/// Every place of a step is in one of its groups, in order, and a group that is not full repeats the last one.
#[test]
fn groups_hold_every_place_once() {
    let steps = |n: usize, seed: usize| (0..n).map(move |i| ((i * i + seed * i) % 7 % 6) as f64);
    for n in [0, 1, 7, 8, 9, 40, CHUNK] {
        for seed in 0..5 {
            let mut plan = Plan::EMPTY;
            // what an earlier chunk left
            plan.steps = [1.0; ROOM];
            plan.order = [9; ROOM];
            for (to, step) in plan.steps.iter_mut().zip(steps(n, seed)) {
                *to = step;
            }
            plan.sort(n);
            let mut found = [const { std::vec::Vec::new() }; Step::COUNT];
            for group in plan.groups() {
                assert!((1..=8).contains(&group.count));
                let (counted, rest) = group.places.split_at(group.count);
                assert!(rest.iter().all(|place| place == &counted[group.count - 1]));
                let of_step = &mut found[group.step.index()];
                assert!(of_step.len() % 8 == 0, "only the last group is not full");
                of_step.extend(counted.iter().map(|&place| usize::from(place)));
            }
            for (step, places) in found.iter().enumerate() {
                let of_step = steps(n, seed).enumerate();
                let expected = of_step.filter(|(_, of)| *of == step as f64).map(|(i, _)| i);
                assert!(places.iter().copied().eq(expected), "{n} {seed} {step}");
            }
            for (i, step) in steps(n, seed).enumerate() {
                assert_eq!(plan.is_single(i), step == 5.0);
            }
        }
    }
}

#[test]
fn one_rule_for_all() {
    let mut plan = Plan::EMPTY;
    plan.steps[..5].copy_from_slice(&[0.0, 3.0, 1.0, 4.0, 2.0]);
    plan.level(3);
    assert_eq!(plan.steps[..5], [3.0, 3.0, 3.0, 4.0, 2.0]);
}

/// By the limits of the ladder, whose own step for single numbers is the same below an entry angle of 60°.
#[test]
fn steps_are_those_of_the_ladder() {
    for i in 0..2000 {
        let stiffness = 0.05 * f64::from(i);
        let step = step_of(Lanes([stiffness; 8])).0[3];
        let least = Step::for_stiffness(stiffness, 0.5);
        let index = least.map_or(Step::COUNT, Step::index);
        assert_eq!(step, index as f64, "{stiffness}");
        assert_eq!(index_of(step), index);
    }
    assert_eq!(step_of(Lanes([f64::NAN; 8])).0[0], SINGLE_STEP);
}

#[test]
fn ranges_have_their_ends_and_no_nan() {
    let x = Lanes([-1.0, 0.999, 1.0, 1.5, 2.0, 2.001, f64::NAN, f64::INFINITY]);
    let expected = [false, false, true, true, true, false, false, false];
    assert_eq!(within(x, 1.0, 2.0).0, expected);
    assert_eq!(inside(x, (1.0, 2.0)).0, expected);
}
