//! Whole jobs on the example's tests, which another program made of a soil that `truth.toml` states.

use std::fmt::Write as _;

use grouser_files::{Document, soil};
use grouser_identify::least_squares::{Loss, Verdict, student_quantile};
use grouser_identify::plate::read_table;
use grouser_identify::shear::{ShearReading, fit_shear};
use grouser_identify::{Error, Identification, Job, Parameter, identify};
use grouser_terra::{Angle, OpenSoil};
use proptest::prelude::*;

fn folder() -> std::path::PathBuf {
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/bevameter").into()
}

fn example() -> Job {
    Job::read(&Document::read(&folder().join("tests.toml")).unwrap()).unwrap()
}

fn parameters(keys: &[&str]) -> Vec<Parameter> {
    keys.iter()
        .map(|key| Parameter::named(key).unwrap())
        .collect()
}

fn truth() -> OpenSoil {
    soil::read(&folder().join("truth.toml")).unwrap().soil
}

fn close(found: f64, wanted: f64) -> bool {
    (found - wanted).abs() <= 1e-9 * wanted.abs()
}

/// The soil's file says what it was identified from, and its remarks the numbers.
fn check_file(found: &Identification, job: &Job) {
    let (file, remarks) = found.soil_file(job);
    assert_eq!(file.key.as_deref(), Some("example"));
    let source = format!(
        "identified by grouser from {} plate tests, {} shear readings, {} wheel tests",
        found.plates.as_ref().unwrap().tests.len(),
        found.shear.as_ref().unwrap().readings.len(),
        found.wheel.as_ref().unwrap().tests.len()
    );
    assert_eq!(file.source, source);
    // one plate of each width, and n that the wheel tests overrule
    assert!(remarks[0].starts_with("not in the intervals of k_pa_per_m_n_at_b_30_mm, "));
    assert_eq!(remarks.len(), found.numbers().len() + 2);
    let of = |name: &str| {
        remarks
            .iter()
            .filter(|remark| remark.starts_with(&format!("{name} ")))
            .collect::<Vec<_>>()
    };
    assert!(of("c_1")[0].starts_with("c_1 0.3") && of("c_1")[0].ends_with("], identified"));
    let modulus = of("k_pa_per_m_n_at_b_30_mm")[0];
    assert!(
        !modulus.split(',').next().unwrap().contains('.') && modulus.contains(", 95 % ["),
        "{modulus}"
    );
    assert!(of("phi_deg")[2].ends_with("was measured or stated"));
}

#[test]
fn the_example_is_what_it_was_made_of() {
    let mut job = example();
    job.key = Some("example".into());
    let wheel = job.wheel.as_mut().unwrap();
    (wheel.profile, wheel.starts.starts) = (false, 2);
    wheel.parameters = parameters(&["c_1", "c_2", "n_1", "sinkage_datum_m", "phi_deg"]);
    let found = identify(&job).unwrap();
    assert!(found.missing().is_empty());
    let truth = truth();
    let numbers = found.numbers();
    let shear_tests = found.shear.as_ref().unwrap();
    let stage = found.wheel.as_ref().unwrap();
    for number in &numbers {
        let made_of = match number.name.as_str() {
            "sinkage_datum_m" => 0.003,
            "k_pa_per_m_n_at_b_30_mm" => 2e3 / 0.03 + 2.4e6,
            name if name.starts_with("k_pa_per_m_n_at_b_") => {
                let b: f64 = name["k_pa_per_m_n_at_b_".len()..name.len() - 3]
                    .parse()
                    .unwrap();
                2e3 / (1e-3 * b) + 2.4e6
            }
            name => {
                let number = Parameter::named(name).unwrap();
                number.to_key_unit(number.of(&truth).unwrap())
            }
        };
        assert_eq!(number.verdict, Verdict::Identified, "{}", number.name);
        // one in twenty may miss its 95 %: three standard errors
        let off = (number.value - made_of) / number.standard_error;
        assert!(
            off.abs() < 3.0,
            "{} {} {made_of}: {off}",
            number.name,
            number.value
        );
        assert!(
            number.interval.low.unwrap() < number.value
                && number.interval.high.unwrap() > number.value
        );
    }
    assert_eq!(numbers.len(), 3 + 3 + 5);
    // in SI the same, in the same order
    let units = [1e3, std::f64::consts::PI / 180.0, 1.0];
    for (index, number) in numbers[3..6].iter().enumerate() {
        let fit = &shear_tests.fit;
        assert!(
            close(number.value * units[index], fit.values[index])
                && close(
                    number.standard_error * units[index],
                    fit.standard_errors[index]
                )
        );
        let (own, si) = (number.interval, fit.intervals[index]);
        assert!(
            close(own.low.unwrap() * units[index], si.low.unwrap())
                && close(own.high.unwrap() * units[index], si.high.unwrap())
        );
    }
    // linear intervals, and what the wheel tests overrule
    let readings = 3 * stage.tests.len();
    for (number, own) in numbers[6..].iter().zip(&stage.numbers) {
        let half = student_quantile(0.975, readings - 5) * number.standard_error;
        assert!(
            close(number.interval.high.unwrap() - number.value, half)
                && close(number.value - number.interval.low.unwrap(), half)
        );
        let measured = (number.name == "phi_deg").then_some(shear_tests.fit.values[1]);
        let unit = measured.map_or(1.0, |_| units[1]);
        assert_eq!(
            (number.overruled, own.overruled),
            (measured.map(|phi| phi / unit), measured)
        );
        assert!(
            close(number.value * unit, own.value)
                && close(number.standard_error * unit, own.standard_error)
        );
    }
    assert!(stage.starts == 2 && stage.reached >= 1 && stage.status.is_solved());
    // the prediction is near the readings, within a few of their scatter
    let squares: f64 = stage
        .tests
        .iter()
        .zip(&stage.said)
        .map(|(test, said)| ((said.pull - test.pull.unwrap()) / 0.4).powi(2))
        .sum();
    assert!(squares < 2.0 * stage.tests.len() as f64);
    let soil = found.soil;
    assert_eq!(
        (soil.phi.map(Angle::rad), soil.c_1),
        (Some(stage.numbers[4].value), Some(stage.numbers[0].value))
    );
    assert!(soil.fitted.is_some_and(|range| range.load == (60.0, 60.0)));
    check_file(&found, &job);
}

/// With uniform readings the pull's datum is the mean of what is left over.
#[test]
fn profile_intervals_are_wanted_by_name() {
    let mut job = example();
    let wheel = job.wheel.as_mut().unwrap();
    (wheel.profile, wheel.starts.starts) = (true, 1);
    wheel.parameters = parameters(&["pull_datum_n"]);
    (job.plates, job.shear, job.soil) = (Vec::new(), None, truth());
    let found = identify(&job).unwrap();
    assert!(found.plates.is_none() && found.shear.is_none());
    let stage = found.wheel.unwrap();
    // linear in the datum: profile and linear interval are the same
    let number = stage.numbers[0];
    let half = student_quantile(0.975, 3 * stage.tests.len() - 1) * number.standard_error;
    assert!((number.interval.high.unwrap() - number.value - half).abs() < 1e-3 * half);
    assert!(number.value.abs() < half && number.overruled.is_none());
}

/// Intervals of a profile are not symmetric where the law is not linear, and others are.
#[test]
fn linear_intervals_are_symmetric() {
    let mut job = example();
    (job.plates, job.shear, job.soil) = (Vec::new(), None, truth());
    let mut unevenness = |profile: bool| {
        let wheel = job.wheel.as_mut().unwrap();
        (wheel.profile, wheel.starts.starts) = (profile, 1);
        wheel.parameters = parameters(&["k_shear_m"]);
        let number = identify(&job).unwrap().wheel.unwrap().numbers[0];
        let [low, high] = [number.interval.low, number.interval.high].map(Option::unwrap);
        assert!(low < number.value && number.value < high);
        (high + low - 2.0 * number.value).abs() / (high - low)
    };
    let (profile, linear) = (unevenness(true), unevenness(false));
    assert!(profile > 1e-3 && linear < 1e-9, "{profile} {linear}");
}

/// The variance of a misfit is about what the fit leaves free.
#[test]
fn a_misfit_has_the_ratio_of_its_residuals() {
    let mut job = example();
    (job.plates, job.shear, job.soil) = (Vec::new(), None, truth());
    let wheel = job.wheel.as_mut().unwrap();
    wheel.starts.starts = 1;
    wheel.parameters = parameters(&["sinkage_datum_m"]);
    wheel.scatter.torque *= 0.1;
    let scatter = wheel.scatter.torque;
    let stage = identify(&job).unwrap().wheel.unwrap();
    let pairs = stage.tests.iter().zip(&stage.said);
    let residuals =
        pairs.map(|(test, predicted)| (test.torque.unwrap() - predicted.torque) / scatter);
    let squares: f64 = residuals.map(|r| r * r).sum();
    let readings = stage.tests.len() as f64;
    let free = readings - 1.0 / 3.0; // one number of three quantities
    let [misfit] = stage.misfits[..] else {
        panic!("{:?}", stage.misfits)
    };
    assert!(close(misfit.ratio, (squares / free).sqrt()), "{misfit:?}");
}

/// A shear box that is driven back at the end: eight readings that no fit uses.
#[test]
fn readings_of_the_way_back_are_counted() {
    let file = std::env::temp_dir().join(format!("grouser-shear-back-{}.csv", std::process::id()));
    let mut table = String::from("normal_stress_kpa,displacement_mm,shear_stress_kpa\n");
    for normal in [4.0, 8.0] {
        for mm in 1..=20 {
            let mobilised = 1.0 - (-0.2 * f64::from(mm)).exp();
            writeln!(table, "{normal},{mm},{}", (1.0 + 0.6 * normal) * mobilised).unwrap();
        }
        for mm in [19, 18, 17, 16] {
            writeln!(table, "{normal},{mm},0.1").unwrap();
        }
    }
    std::fs::write(&file, table).unwrap();
    let mut job = Job::new("a shear box");
    job.shear = Some(file.clone());
    let stage = identify(&job).unwrap().shear.unwrap();
    std::fs::remove_file(file).unwrap();
    assert_eq!((stage.readings.len(), stage.unloading), (40, 8));
}

#[test]
fn a_number_that_the_wheel_needs_is_named() {
    let mut job = example();
    (job.plates, job.shear) = (Vec::new(), None);
    let missing = |job: &Job| match identify(job) {
        Err(Error::Missing { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    assert_eq!(missing(&job), "n");
    job.soil = truth();
    job.soil.k_shear = None;
    assert_eq!(missing(&job), "k_shear_m");
    job.wheel.as_mut().unwrap().parameters = parameters(&["k_shear_m"]);
    job.wheel.as_mut().unwrap().starts.starts = 1;
    assert!(identify(&job).is_ok());
    // nothing at all gives nothing
    let nothing: Identification = identify(&Job::new("nothing")).unwrap();
    assert_eq!(
        nothing.missing(),
        [
            "n",
            "k_c_kn_per_m_n1",
            "k_phi_kn_per_m_n2",
            "cohesion_kpa",
            "phi_deg"
        ]
    );
    assert!(nothing.numbers().is_empty());
}

#[test]
fn a_job_lists_its_files_in_order() {
    let mut job = example();
    let names = |job: &Job| {
        job.files()
            .iter()
            .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&job), ["plates.csv", "shear.csv", "wheel.csv"]);
    job.shear = None;
    assert_eq!(names(&job), ["plates.csv", "wheel.csv"]);
    assert_eq!(
        read_table(job.files()[0]).unwrap().len(),
        identify(&job_of_plates(&job))
            .unwrap()
            .plates
            .unwrap()
            .tests
            .len()
    );
}

fn job_of_plates(job: &Job) -> Job {
    let mut plates = Job::new("plates");
    plates.plates.clone_from(&job.plates);
    plates
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// τ = (c + σ tan φ)(1 − e^(−j/K)) is found again, also from tests that end before the rise does.
    #[test]
    fn a_shear_law_is_found_again(
        (cohesion, phi, normal) in (0.0..5e3_f64, 0.05..0.9_f64, 1e3..3e4_f64),
        (reach, share) in (-2.7..0.0_f64, -1.9..0.6_f64),
    ) {
        let reach = 10_f64.powf(reach);
        let k_shear = reach * 10_f64.powf(share);
        let readings: Vec<ShearReading> = [normal, 3.0 * normal]
            .into_iter()
            .flat_map(|normal| (1..=25).map(move |i| (normal, reach * f64::from(i) / 25.0)))
            .map(|(normal, displacement)| {
                let shear = (cohesion + normal * phi.tan()) * (1.0 - (-displacement / k_shear).exp());
                ShearReading { normal, displacement, shear }
            })
            .collect();
        let found = fit_shear(&readings, Loss::Squares).unwrap();
        let strength = cohesion + normal * phi.tan();
        prop_assert!((found.values[0] - cohesion).abs() < 1e-4 * strength, "{} {cohesion}", found.values[0]);
        prop_assert!((found.values[1] - phi).abs() < 1e-4 && (found.values[2] / k_shear - 1.0).abs() < 1e-4);
    }
}

#[test]
fn readings_that_do_not_show_a_number_are_refused_or_named() {
    let line = |count: u32, reach: f64, slope: f64| -> Vec<ShearReading> {
        let reading = |i: u32| {
            let (normal, displacement) = (
                5e3 * f64::from(1 + i % 2),
                reach * f64::from(i) / f64::from(count),
            );
            ShearReading {
                normal,
                displacement,
                shear: slope * normal * displacement / reach,
            }
        };
        (1..=count).map(reading).collect()
    };
    let few = |readings: &[ShearReading]| {
        matches!(
            fit_shear(readings, Loss::Squares),
            Err(Error::TooFew { parameters: 3, .. })
        )
    };
    assert!(
        few(&line(2, 0.1, 0.5))
            && few(&line(9, 0.1, 0.0))
            && few(&line(9, 0.0, 0.5))
            && !few(&line(3, 0.1, 0.5))
    );
    assert!(few(&[]) && few(&line(9, 0.1, -0.5)));
    let unmoved: Vec<ShearReading> = line(9, 0.1, 0.5)
        .into_iter()
        .map(|reading| ShearReading {
            displacement: 0.0,
            ..reading
        })
        .collect();
    assert!(few(&unmoved));
    // a rise without an end: K is beyond ten times the longest displacement, or what a soil may have
    for (reach, bound) in [(0.06, 0.6), (3.0, 10.0)] {
        let found = fit_shear(&line(20, reach, 0.1), Loss::Squares).unwrap();
        assert!(
            (found.values[2] / bound - 1.0).abs() < 1e-9,
            "{}",
            found.values[2]
        );
        assert_eq!(found.uncertainty.verdicts[2], Verdict::OnBound);
    }
}

#[test]
fn a_search_begins_at_what_is_known_inside_its_bounds() {
    let rad = f64::to_radians;
    for (known, start) in [
        (None, 30.0),
        (Some(35.0), 35.0),
        (Some(5.0), 30.0),
        (Some(60.0), 30.0),
    ] {
        let soil = OpenSoil {
            phi: known.map(Angle::from_deg),
            ..OpenSoil::default()
        };
        let phi = Parameter::named("phi_deg").unwrap().bounded(&soil);
        for (found, degrees) in [(phi.lower, 10.0), (phi.start, start), (phi.upper, 50.0)] {
            assert!((found - rad(degrees)).abs() < 1e-12, "{known:?}: {found}");
        }
    }
    let cohesion = Parameter::named("cohesion_kpa")
        .unwrap()
        .bounded(&OpenSoil::default());
    assert_eq!(
        (cohesion.lower, cohesion.start, cohesion.upper),
        (0.0, 500.0, 20e3)
    );
}
