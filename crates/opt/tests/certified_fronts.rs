//! Certified fronts of published problems: no random point is better than what is proved.

use std::ops::ControlFlow;

use grouser_opt::{
    CertifySettings, CertifyStatus, Exact, FrontCertificate, FrontWatch, Functions, Problem,
    ProblemParams, Variable, certify_front,
};
use grouser_real::Scalar;

use crate::random_starts::Stream;

/// Fonseca and Fleming 1995: a concave front, which no weighted sum reaches.
struct FonsecaFleming;
impl Functions for FonsecaFleming {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let shift = R::from_f64(1.0 / (x.len() as f64).sqrt());
        for (f, sign) in f.iter_mut().zip([R::ONE, -R::ONE]) {
            let mut sum = R::ZERO;
            for &x in x {
                sum += (x - sign * shift).square();
            }
            *f = R::ONE - (-sum).exp();
        }
    }
}

/// ZDT3 of two variables (Zitzler, Deb & Thiele 2000): a front of five pieces.
struct Zdt3;
impl Functions for Zdt3 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let g = R::ONE + R::from_f64(9.0) * x[1];
        f[0] = x[0];
        let wave = (R::from_f64(10.0) * R::PI * x[0]).sin();
        f[1] = g * (R::ONE - (x[0] / g).sqrt()) - x[0] * wave;
    }
}

/// Binh and Korn 1997, with two constraints.
pub(crate) struct BinhKorn;
impl Functions for BinhKorn {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let c = R::from_f64;
        f[0] = c(4.0) * (x[0].square() + x[1].square());
        f[1] = (x[0] - c(5.0)).square() + (x[1] - c(5.0)).square();
        f[2] = (x[0] - c(5.0)).square() + x[1].square() - c(25.0);
        f[3] = c(7.7) - (x[0] - c(8.0)).square() - (x[1] + c(3.0)).square();
    }
}

/// The greater of two functions against a third, as for designs on two soils: groups of objectives.
pub(crate) struct Grouped;
impl Functions for Grouped {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let c = R::from_f64;
        f[0] = (x[0] - c(1.0)).square() + x[1].square();
        f[1] = c(0.5) * (x[0] - c(2.0)).square() + x[1];
        f[2] = c(3.0) - x[0] - x[1];
    }
}

pub(crate) fn boxed(
    model: impl Functions + 'static,
    sides: &[(f64, f64)],
    m: usize,
) -> ProblemParams<'static> {
    let start: Vec<f64> = sides.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let variables = sides.iter().zip(&start).enumerate();
    ProblemParams::new(&start, m, Exact(model)).variables(
        variables
            .map(|(i, ((low, high), at))| Variable::bounded(format!("x{i}"), *at, *low, *high)),
    )
}

pub(crate) fn certified(
    problem: &Problem<'_>,
    groups: &[usize],
    share: f64,
    log: &mut Vec<String>,
) -> FrontCertificate {
    let mut settings = CertifySettings::default();
    settings.gap = share;
    settings.starts = 4;
    let watch = FrontWatch {
        callback: &mut |_| ControlFlow::Continue(()),
        suggest: &mut |_| Vec::new(),
        proof: Some(&mut |line: &str| {
            log.push(line.to_owned());
            ControlFlow::Continue(())
        }),
    };
    certify_front(problem, groups, &settings, watch).unwrap()
}

#[test]
fn no_random_point_is_better_than_a_proved_front() {
    let pi = std::f64::consts::PI;
    for (name, params, groups, share) in [
        (
            "Fonseca-Fleming",
            boxed(FonsecaFleming, &[(-4.0, 4.0); 2], 2),
            vec![0, 1],
            0.05,
        ),
        ("ZDT3", boxed(Zdt3, &[(0.0, 1.0); 2], 2), vec![0, 1], 0.05),
        (
            "Binh-Korn",
            boxed(BinhKorn, &[(0.0, 5.0), (0.0, 3.0)], 2)
                .inequalities(["first".to_owned(), "second".to_owned()]),
            vec![0, 1],
            0.02,
        ),
        (
            "groups",
            boxed(Grouped, &[(0.0, 3.0), (-1.0, pi)], 3),
            vec![0, 0, 1],
            0.05,
        ),
    ] {
        let problem = Problem::new(params).unwrap();
        let mut log = Vec::new();
        let front = certified(&problem, &groups, share, &mut log);
        println!(
            "{name}: {} to {:.4} with {} points, {} corners, {} proofs, {} boxes, {:.2} s",
            front.status.name(),
            front.share,
            front.points.len(),
            front.corners.len(),
            front.proofs,
            front.boxes,
            front.seconds
        );
        assert_eq!(front.status, CertifyStatus::Proved, "{name}");
        assert!(front.share <= share, "{name}: {}", front.share);
        let mut stream = Stream(3);
        let count = problem.objectives().len();
        let mut f = vec![0.0; count + problem.inequalities().len()];
        let (mut feasible, mut nearest) = (0, f64::INFINITY);
        for _ in 0..60_000 {
            let x: Vec<f64> = problem
                .variables()
                .iter()
                .map(|v| v.lower + (v.upper - v.lower) * stream.next())
                .collect();
            problem.model().values(&x, &mut f);
            if f[count..].iter().any(|c| *c > 0.0) {
                continue;
            }
            feasible += 1;
            let mut q = [f64::NEG_INFINITY; 2];
            for (f, group) in f.iter().zip(&groups) {
                q[*group] = q[*group].max(*f);
            }
            let room = |k: usize, p: [f64; 2]| q[k] + front.tolerance[k] - p[k];
            let best = front
                .points
                .iter()
                .map(|p| room(0, p.objectives).min(room(1, p.objectives)));
            let best = best.fold(f64::NEG_INFINITY, f64::max);
            assert!(
                best >= 0.0,
                "{name}: {q:?} at {x:?} is better than every listed point"
            );
            nearest = nearest.min(best);
            let is_above = |lower: [f64; 2]| q[0] >= lower[0] && q[1] >= lower[1];
            assert!(
                front.corners.iter().any(|corner| is_above(*corner)),
                "{name}: {q:?} is below every corner"
            );
        }
        println!("  {feasible} feasible points; the best is within {nearest:.3e} of the proof");
        assert!(feasible > 10_000, "{name}: {feasible}");
    }
}

/// A box whose every point is refused by a constraint has no front, and time that is over is no proof.
#[test]
fn no_front_and_no_time_are_told_apart() {
    let params = boxed(BinhKorn, &[(4.0, 5.0), (2.9, 3.0)], 2)
        .inequalities(["first".to_owned(), "second".to_owned()]);
    let mut log = Vec::new();
    let front = certified(&Problem::new(params).unwrap(), &[0, 1], 0.1, &mut log);
    println!("{front:?}");
    assert!(front.status == CertifyStatus::Proved);
    let nowhere = boxed(Nowhere, &[(0.0, 1.0); 2], 2).inequalities(["never".to_owned()]);
    let front = certified(&Problem::new(nowhere).unwrap(), &[0, 1], 0.1, &mut log);
    assert_eq!(front.status, CertifyStatus::Infeasible);
    assert!(front.points.is_empty() && front.corners.is_empty());
    let mut settings = CertifySettings::default();
    settings.gap = 1e-3;
    settings.time_limit_s = Some(0.0);
    let watch = FrontWatch {
        callback: &mut |_| ControlFlow::Continue(()),
        suggest: &mut |_| Vec::new(),
        proof: None,
    };
    let problem = Problem::new(boxed(Zdt3, &[(0.0, 1.0); 2], 2)).unwrap();
    let front = certify_front(&problem, &[0, 1], &settings, watch).unwrap();
    assert_eq!(front.status, CertifyStatus::TimeLimit);
    assert!(front.share > 1e-3);
}

/// x_0 ≤ −1 in a box of x_0 ≥ 0.
pub(crate) struct Nowhere;
impl Functions for Nowhere {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        (f[0], f[1], f[2]) = (x[0], x[1], x[0].exp());
    }
}

/// √f_1 + √f_2 = 2 along the front.
struct Pair;
impl Functions for Pair {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0].square();
        f[1] = (x[0] - R::from_f64(2.0)).square();
    }
}

/// A small front, as the checker replays it, in a time that is long enough.
#[test]
fn a_small_front_is_replayed() {
    let problem = Problem::new(boxed(Pair, &[(-1.0, 3.0)], 2)).unwrap();
    let mut settings = CertifySettings::default();
    (settings.gap, settings.starts, settings.time_limit_s) = (0.2, 2, Some(1e6));
    let mut gaps = Vec::new();
    for candidates in [&[][..], &[0.5], &[0.5, 1.5]] {
        settings.candidates = candidates.iter().map(|x| vec![*x]).collect();
        let (mut log, mut boxes) = (Vec::new(), 0);
        let watch = FrontWatch {
            callback: &mut |progress| {
                assert!(progress.boxes >= boxes);
                boxes = progress.boxes;
                ControlFlow::Continue(())
            },
            suggest: &mut |_| Vec::new(),
            proof: Some(&mut |line: &str| {
                log.push(line.to_owned());
                ControlFlow::Continue(())
            }),
        };
        let front = certify_front(&problem, &[0, 1], &settings, watch).unwrap();
        assert!(front.status == CertifyStatus::Proved && front.share <= 0.2);
        // all but those of the last proof were reported
        assert!(front.proofs > 2 && front.boxes >= boxes && 2 * boxes > front.boxes);
        let begins = |text: &str| log.iter().filter(|line| line.starts_with(text)).count();
        assert_eq!(begins("{\"least\""), front.proofs);
        assert_eq!(begins("{\"front\""), 1);
        // each point leaves as little open as is claimed: of f_1 = a there is f_2 = (2 − √a)²
        for i in 0..=100 {
            let x = 0.02 * f64::from(i);
            let q = [x * x, (x - 2.0).powi(2)];
            let is_near = |k: usize, p: [f64; 2]| p[k] <= q[k] + front.tolerance[k];
            let near = |p: &grouser_opt::ProvedPoint| (0..2).all(|k| is_near(k, p.objectives));
            assert!(front.points.iter().any(near));
        }
        let gap = &log[2][log[2].find("\"gap\":").unwrap() + 6..];
        gaps.push(gap[..gap.find(',').unwrap()].parse::<f64>().unwrap());
        if crate::proofs::python() {
            let verdicts = crate::proofs::verdicts(&crate::proofs::folder("small"), &[log]);
            assert!(verdicts[0].starts_with("accepted"), "{verdicts:?}");
        }
    }
    // of two candidates the first objective's range of 2 and size of 2.25 are known
    for (gap, expected) in gaps.into_iter().zip([1e-3, 1e-3, 0.2 * 0.2 * 2.0 / 3.25]) {
        assert!((gap - expected).abs() < 1e-15, "{gap} {expected}");
    }
}
