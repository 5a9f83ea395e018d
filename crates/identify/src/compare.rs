//! Which laws predict wheel tests that they were not fitted to.

use grouser_terra::LawPreset;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::identification::{Identification, fitted};
use crate::job::Job;
use crate::readings::Readings;
use crate::wheel::{Fixed, LawScore, Prediction, WheelTest, predict, rmse};

/// The step in which slip angles count as equal, deg.
const ANGLE_STEP_DEG: f64 = 1e-3;

/// Each set of laws, fitted again without one slip angle and compared with the tests there; without one test after the other
/// where all tests have one slip angle. Rows of the same tests lie next to each other.
///
/// # Errors
/// [`Error::Missing`] without wheel tests, and for a number that the laws need; those of the fits.
pub fn compare_laws(job: &Job) -> Result<Vec<LawScore>> {
    let readings = Readings::read(job)?;
    let Some((_, tests)) = &readings.wheel else {
        return Err(Error::Missing {
            what: "[wheel]",
            needed_by: "laws are compared on wheel tests".to_owned(),
        });
    };
    let step = |test: &WheelTest| {
        let degrees = test.kinematics.slip_angle().deg().abs();
        (degrees / ANGLE_STEP_DEG).round()
    };
    let mut angles: Vec<f64> = tests.iter().map(step).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let groups: Vec<(String, Vec<Vec<usize>>)> = if angles.len() > 1 {
        let at = |angle: &f64| {
            let here = (0..tests.len()).filter(|i| step(&tests[*i]) == *angle);
            let name = format!("slip angle {}", angle * ANGLE_STEP_DEG);
            (name, vec![here.collect()])
        };
        angles.iter().map(at).collect()
    } else {
        let single = (0..tests.len()).map(|i| vec![i]);
        vec![("each test".to_owned(), single.collect())]
    };
    let rows = groups
        .iter()
        .flat_map(|group| LawPreset::ALL.map(|laws| (group, laws)));
    let rows: Vec<_> = rows.collect();
    rows.into_par_iter()
        .map(|((name, folds), preset)| {
            let of = |left: &Vec<usize>| held_out(job, &readings, preset, left);
            let parts = folds.par_iter().map(of).collect::<Result<Vec<_>>>()?;
            let pairs: Vec<(WheelTest, Prediction)> = parts.into_iter().flatten().collect();
            Ok(LawScore {
                laws: preset.key,
                left_out: name.clone(),
                tests: pairs.len(),
                rmse: rmse(pairs.iter().map(|(test, said)| (test, said))),
            })
        })
        .collect()
}

/// The tests `left` out, with what laws that were fitted to all others predict of them.
fn held_out(
    job: &Job,
    readings: &Readings,
    preset: LawPreset,
    left: &[usize],
) -> Result<Vec<(WheelTest, Prediction)>> {
    let mut job = job.clone();
    job.soil.laws = preset.laws;
    job.soil.rear_drift = preset.rear_drift;
    job.soil.sideways_support = preset.sideways_support;
    let mut readings = readings.clone();
    readings.is_rough = true;
    let Some((wheel, tests)) = &mut readings.wheel else {
        return Ok(Vec::new());
    };
    let wheel = wheel.clone();
    let out: Vec<WheelTest> = left.iter().map(|i| tests[*i]).collect();
    let mut index = 0..;
    tests.retain(|_| index.next().is_some_and(|i| !left.contains(&i)));
    let Identification {
        soil, wheel: stage, ..
    } = fitted(&job, &readings)?;
    let x: Vec<f64> = stage
        .iter()
        .flat_map(|stage| &stage.numbers)
        .map(|n| n.value)
        .collect();
    let fixed = Fixed {
        wheel: wheel.wheel,
        soil,
        scatter: wheel.scatter,
    };
    let said = predict(&fixed, &out, &wheel.parameters, &x)?;
    Ok(out.into_iter().zip(said).collect())
}
