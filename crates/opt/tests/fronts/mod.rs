//! Fronts of published problems: hypervolume before and after polishing, exactness, determinism.

pub(crate) mod hypervolume;
mod problems;

use grouser_opt::{Front, ParetoSettings, Problem, pareto};
use hypervolume::hypervolume;
use problems::{dtlz2, zdt1};

fn volumes((problem, settings): (Problem<'_>, ParetoSettings)) -> (f64, f64, Front) {
    let reference = vec![1.1; problem.objectives().len()];
    let mut raw = settings.clone();
    raw.polish = false;
    let raw = pareto(&problem, &raw).unwrap();
    let polished = pareto(&problem, &settings).unwrap();
    let volume = |front: &Front| hypervolume(&front.objectives(), &reference).unwrap();
    let (before, after) = (volume(&raw), volume(&polished));
    println!(
        "before {before:.5}, after {after:.5}, {:?}",
        polished.counts
    );
    (before, after, polished)
}

/// pymoo's NSGA-II reaches 0.8698; no 100 points reach more than 0.8720.
#[test]
fn zdt1_hypervolume() {
    let (before, after, front) = volumes(zdt1());
    assert!(before >= 0.8705, "{before}");
    assert!(after >= 0.8715, "{after}");
    assert!(front.points.len() > 90);
    for point in &front.points {
        // Exact to the solver's tolerance, except where the front is vertical.
        let (f1, f2) = (point.objectives[0], point.objectives[1]);
        assert!((f2 - (1.0 - f1.max(0.0).sqrt())).abs() < 1e-5, "{f1} {f2}");
    }
}

/// pymoo's NSGA-III reaches 0.7442; the 91 directions' exact points have 0.74485.
#[test]
fn dtlz2_hypervolume() {
    let (before, after, front) = volumes(dtlz2());
    assert!(before >= 0.7441, "{before}");
    assert!(after >= 0.7448, "{after}");
    assert_eq!(front.points.len(), 91);
    for point in &front.points {
        let radius: f64 = point.objectives.iter().map(|f| f * f).sum();
        assert!((radius - 1.0).abs() < 1e-6, "{radius}");
    }
}
