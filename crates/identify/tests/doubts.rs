//! Is a result that does not describe the soil called doubtful, and one that does not?

use std::fmt::Write as _;

use grouser_files::Document;
use grouser_identify::least_squares::{Loss, Verdict};
use grouser_identify::plate::{Plate, PlateSettings, PlateTest, fit_plates};
use grouser_identify::shear::{ShearReading, fit_shear};
use grouser_identify::{Doubt, Identification, Job, Parameter, WheelNumber, identify};
use grouser_terra::{OpenSoil, RigidWheel};

use crate::coverage::{found, laboratory, open_soil, tests_on, wheel_tests};

/// Only wheel tests, on a soil that is known.
fn wheel_alone(job: &mut Job, known: &OpenSoil) {
    job.plates.clear();
    job.shear = None;
    job.soil = *known;
}

#[test]
fn tests_of_the_law_are_not_doubtful() {
    let wheel = wheel_tests();
    for seed in 1..=20 {
        let found = found(seed, 0.03, &wheel, |job| {
            wheel_alone(job, &open_soil());
            if seed % 2 == 0 {
                job.wheel.as_mut().unwrap().loss = Loss::Huber { threshold: 1.345 };
            }
        });
        assert_eq!(found.doubts(), [], "seed {seed}");
    }
}

/// Another exponent than the soil's, and forces of the other sign: residuals of many times their scatter.
#[test]
fn readings_off_the_law_are_doubtful() {
    let is_misfit =
        |doubt: &Doubt| matches!(doubt, Doubt::Misfit(misfits) if misfits[0].ratio > 2.0);
    let wheel = wheel_tests();
    let mut wrong = open_soil();
    wrong.n = Some(0.6);
    for loss in [Loss::Squares, Loss::Huber { threshold: 1.345 }] {
        let doubts = found(1, 0.03, &wheel, |job| {
            wheel_alone(job, &wrong);
            job.wheel.as_mut().unwrap().loss = loss;
        })
        .doubts();
        assert!(doubts.iter().any(is_misfit), "{doubts:?}");
        let negated: Vec<[f64; 5]> = wheel
            .iter()
            .map(|[slip, load, pull, torque, z]| [*slip, *load, -pull, *torque, *z])
            .collect();
        let doubts = found(1, 0.03, &negated, |job| {
            wheel_alone(job, &open_soil());
            job.wheel.as_mut().unwrap().loss = loss;
        })
        .doubts();
        assert!(doubts.iter().any(is_misfit), "{doubts:?}");
    }
}

#[test]
fn loads_that_the_soil_does_not_bear_are_doubtful() {
    let heavy: Vec<[f64; 5]> = wheel_tests()
        .into_iter()
        .map(|[slip, load, pull, torque, z]| [slip, 1000.0 * load, pull, torque, z])
        .collect();
    let doubts = found(1, 0.03, &heavy, |job| wheel_alone(job, &open_soil())).doubts();
    let (buried, tests) = (28, 28);
    assert!(
        doubts.contains(&Doubt::HubBuried { buried, tests }),
        "{doubts:?}"
    );
}

/// Wheel tests alone, with the first `columns` of slip, load, pull, torque and sinkage.
fn of_columns(wheel: &[[f64; 5]], columns: usize, fit: &[&str]) -> Vec<Doubt> {
    let folder = laboratory(3, 0.03, wheel);
    let table = std::fs::read_to_string(folder.join("wheel.csv")).unwrap();
    let cut = |line: &str| line.split(',').take(columns).collect::<Vec<_>>().join(",");
    let lines: Vec<String> = table.lines().map(cut).collect();
    std::fs::write(folder.join("wheel.csv"), lines.join("\n")).unwrap();
    let mut job = Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap();
    wheel_alone(&mut job, &open_soil());
    let parameters = fit.iter().map(|key| Parameter::named(key).unwrap());
    job.wheel.as_mut().unwrap().parameters = parameters.collect();
    let doubts = identify(&job).unwrap().doubts();
    std::fs::remove_dir_all(folder).unwrap();
    doubts
}

/// Tests of a soil whose stress peaks far in front of the axle: with torque or sinkage c_1 is what it is.
#[test]
fn a_peak_far_in_front_by_pull_alone_is_doubtful() {
    let is_pull_alone = |doubt: &Doubt| matches!(doubt, Doubt::PullAlone { c_1 } if *c_1 > 0.43);
    let tests = tests_on(&open_soil().stress_position(0.6, 0.2));
    for (columns, is_doubtful) in [(3, true), (4, false), (5, false)] {
        let doubts = of_columns(&tests, columns, &["c_1"]);
        assert_eq!(
            doubts.iter().any(is_pull_alone),
            is_doubtful,
            "{columns} {doubts:?}"
        );
    }
    let doubts = of_columns(&wheel_tests(), 3, &["c_1"]);
    assert!(!doubts.iter().any(is_pull_alone), "{doubts:?}");
}

/// Readings lie 1.5 mm above the sinkage.
#[test]
fn a_zero_that_is_off_is_doubtful_without_a_datum() {
    let fit = ["n_1", "c_1", "c_2"];
    let zero = |tests: &[[f64; 5]], fit: &[&str]| {
        let doubts = of_columns(tests, 5, fit);
        doubts.iter().find_map(|doubt| match doubt {
            Doubt::SinkageZero { shift } => Some(*shift),
            _ => None,
        })
    };
    let tests = wheel_tests();
    let shift = zero(&tests, &fit).unwrap();
    assert!((1.0e-3..2.0e-3).contains(&shift), "{shift}");
    assert_eq!(
        zero(&tests, &["n_1", "c_1", "c_2", "sinkage_datum_m"]),
        None
    );
    let right: Vec<[f64; 5]> = tests
        .iter()
        .map(|[slip, load, pull, torque, z]| [*slip, *load, *pull, *torque, z - 1.5e-3])
        .collect();
    assert_eq!(zero(&right, &fit), None);
}

#[test]
fn a_negative_datum_above_the_sinkage_is_doubtful() {
    let fit = ["n_1", "c_1", "c_2", "sinkage_datum_m"];
    let datum = |lowered: f64| {
        let tests: Vec<[f64; 5]> = wheel_tests()
            .iter()
            .map(|[slip, load, pull, torque, z]| [*slip, *load, *pull, *torque, z - lowered])
            .collect();
        let doubts = of_columns(&tests, 5, &fit);
        doubts.iter().find_map(|doubt| match doubt {
            Doubt::DatumAboveSinkage { datum, read } => Some((*datum, *read)),
            _ => None,
        })
    };
    assert_eq!([datum(0.0), datum(3e-3)], [None; 2]);
    let (datum, read) = datum(16e-3).unwrap();
    assert!(
        (datum + 14.5e-3).abs() < 1e-3 && read < 14e-3,
        "{datum} {read}"
    );
}

/// Plates of 80 to 180 mm, a wheel of 30 to 400 mm.
#[test]
fn a_wheel_of_another_size_than_the_plates_is_doubtful() {
    let wheel = wheel_tests();
    let size = |width: f64, more: Option<&str>| {
        let doubts = found(1, 0.03, &wheel, |job| {
            let job = job.wheel.as_mut().unwrap();
            job.wheel = RigidWheel::new(0.13, width).unwrap();
            job.parameters.extend(more.and_then(Parameter::named));
        })
        .doubts();
        doubts.into_iter().find_map(|doubt| match doubt {
            Doubt::PlateSize { plates, wheel } => Some((plates, wheel)),
            _ => None,
        })
    };
    assert_eq!([size(0.041, None), size(0.09, None)], [None; 2]);
    assert_eq!(size(0.039, None), Some(((0.08, 0.18), 0.039)));
    assert_eq!(size(0.37, None), Some(((0.08, 0.18), 0.37)));
    assert_eq!(size(0.039, Some("k_phi_kn_per_m_n2")), None);
}

/// One load leaves nine numbers open: some end on a bound, and what depends on them is not known better than they are.
#[test]
fn numbers_beside_one_on_its_bound_include_it() {
    let keys = [
        "c_1",
        "c_2",
        "n_1",
        "cohesion_kpa",
        "phi_deg",
        "k_shear_m",
        "n",
        "k_phi_kn_per_m_n2",
        "sinkage_datum_m",
    ];
    let parameters = keys.map(|key| Parameter::named(key).unwrap());
    let one_load: Vec<[f64; 5]> = wheel_tests()
        .into_iter()
        .filter(|row| row[1] < 100.0)
        .collect();
    let truth = open_soil();
    let (mut on_bound, mut wrong) = (0, 0);
    for seed in 1..=8 {
        let found = found(seed, 0.03, &one_load, |job| {
            wheel_alone(job, &open_soil());
            let wheel = job.wheel.as_mut().unwrap();
            wheel.parameters = parameters.to_vec();
            wheel.starts.starts = 4;
        });
        let numbers = &found.wheel.as_ref().unwrap().numbers;
        let is_on_bound = |number: &WheelNumber| number.verdict == Verdict::OnBound;
        if !numbers.iter().any(is_on_bound) {
            continue;
        }
        on_bound += 1;
        for number in numbers.iter().filter(|n| n.verdict == Verdict::Identified) {
            let (low, high) = (number.interval.low, number.interval.high);
            let truth = number.parameter.of(&truth).unwrap_or(1.5e-3);
            let holds = low.is_none_or(|low| low <= truth) && high.is_none_or(|high| truth <= high);
            println!("seed {seed}: {number:?}, truth {truth}");
            wrong += u32::from(!holds);
        }
    }
    println!("{on_bound} of 8 on a bound, {wrong} identified numbers wrong");
    assert!(on_bound >= 3 && wrong <= 1);
}

/// Three readings at one normal stress, from c 1 kPa, φ 32°, K 12 mm: c and K end on bounds, and φ is not known.
#[test]
fn friction_beside_a_cohesion_on_its_bound_is_not_identified() {
    let reading = |(displacement, shear): (f64, f64)| ShearReading {
        normal: 3e3,
        displacement,
        shear,
    };
    let readings = [(1e-3, 150.38), (2e-3, 426.4), (3e-3, 661.09)].map(reading);
    let found = fit_shear(&readings, Loss::Squares).unwrap();
    assert_eq!(found.uncertainty.verdicts[2], Verdict::OnBound);
    assert_ne!(found.uncertainty.verdicts[1], Verdict::Identified);
}

/// A disc of 60 mm in 20 depths, with forces of `sign`.
fn plate(sign: impl Fn(u32) -> f64) -> String {
    let mut table = String::from("plate_diameter_mm,depth_mm,force_n\n");
    for step in 1..=20 {
        let depth = 2.0 * f64::from(step);
        let force = sign(step) * 4.0 * depth.powf(1.1) * (1.0 + 0.01 * f64::from(step % 3));
        writeln!(table, "60,{depth},{force}").unwrap();
    }
    table
}

fn of_plates(name: &str, table: &str) -> grouser_identify::Result<Identification> {
    let folder = format!("grouser-doubts-{name}-{}", std::process::id());
    let folder = std::env::temp_dir().join(folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("plates.csv"), table).unwrap();
    let job = "format = 1\nname = \"x\"\n[[plate]]\ntable = \"plates.csv\"\n";
    std::fs::write(folder.join("tests.toml"), job).unwrap();
    let job = Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap();
    let found = identify(&job);
    std::fs::remove_dir_all(folder).unwrap();
    found
}

/// Moduli are of a single test where one of the widths has no second one.
#[test]
fn moduli_of_single_tests_are_named() {
    let of = |name: &str, diameters: &[u32]| {
        let mut table = String::from("test,plate_diameter_mm,depth_mm,force_n\n");
        for (index, diameter) in diameters.iter().enumerate() {
            for step in 1..=20 {
                let depth = 2.0 * f64::from(step);
                let wave = (0.02 * f64::from(step * 7 % 5) + 0.01 * index as f64).exp();
                let force = 1e-3 * f64::from(diameter * diameter) * depth.powf(1.1) * wave;
                writeln!(table, "{index},{diameter},{depth},{force}").unwrap();
            }
        }
        of_plates(name, &table).unwrap().of_single_tests()
    };
    assert_eq!(of("twice", &[60, 60, 100, 100]), [""; 0]);
    let narrow = [
        "k_pa_per_m_n_at_b_30_mm",
        "k_c_kn_per_m_n1",
        "k_phi_kn_per_m_n2",
    ];
    assert_eq!(of("narrow", &[60, 100, 100]), narrow);
    assert_eq!(of("one", &[60]), ["n", "k_pa_per_m_n"]);
}

#[test]
fn readings_without_a_force_are_counted() {
    let doubts = of_plates("sound", &plate(|_| 1.0)).unwrap().doubts();
    assert_eq!(doubts, []);
    let half = of_plates(
        "half",
        &plate(|step| if step % 4 == 0 { -1.0 } else { 1.0 }),
    )
    .unwrap()
    .doubts();
    let is_named = |doubt: &Doubt| {
        matches!(
            doubt,
            Doubt::WrongSign {
                readings: 5,
                of: 20,
                ..
            }
        )
    };
    assert!(half.iter().any(is_named), "{half:?}");
    let error = of_plates("none", &plate(|_| -1.0)).unwrap_err().to_string();
    assert!(
        error.contains("0 of 20 plate readings")
            && error.contains("20 others have a force of 0 or less"),
        "{error}"
    );
}

/// Two discs of 60 mm and `wide` mm with 1 % of scatter; k_c 3 kN/m^(n+1), k_phi 1500 kN/m^(n+2).
fn two_discs(wide: f64) -> grouser_identify::plate::PlateFit {
    let disc = |diameter: f64, wave: f64| {
        let plate = Plate::disc(diameter).unwrap();
        let depth: Vec<f64> = (2..=40).map(|step| 1e-3 * f64::from(step)).collect();
        let force = depth.iter().enumerate().map(|(i, z)| {
            let noise = 1.0 + 0.014 * (wave * i as f64).sin();
            plate.area * (3e3 / plate.width + 1.5e6) * z.powf(1.1) * noise
        });
        PlateTest {
            name: diameter.to_string(),
            plate,
            force: force.collect(),
            depth,
        }
    };
    fit_plates(
        &[disc(0.06, 1.9), disc(1e-3 * wide, 2.3)],
        &PlateSettings::default(),
    )
    .unwrap()
}

#[test]
fn moduli_are_known_as_well_as_the_widths_separate_them() {
    let [apart, near, same] = [100.0, 62.0, 60.0].map(two_discs);
    for fit in [&apart, &near] {
        for (modulus, truth) in fit.moduli.iter().zip([3e3, 1.5e6]) {
            let (low, high) = (
                modulus.interval.low.unwrap(),
                modulus.interval.high.unwrap(),
            );
            assert!(low < truth && truth < high, "{modulus:?}");
        }
    }
    assert_eq!(apart.moduli[1].verdict, Verdict::Identified);
    assert_eq!(near.moduli[0].verdict, Verdict::Loose);
    assert!(near.moduli[0].standard_error > 5.0 * apart.moduli[0].standard_error);
    assert!(apart.is_separable() && near.is_separable() && !same.is_separable());
    for modulus in &same.moduli {
        assert_eq!(modulus.verdict, Verdict::NotIdentifiable);
    }
}

/// Half of the readings obey another law: the error of k exceeds a third of it, that of ln k is 2 %.
#[test]
fn a_modulus_is_judged_by_itself_and_not_by_its_logarithm() {
    let plate = Plate::disc(0.06).unwrap();
    let depth = (2..=80).map(|step| 5e-4 * f64::from(step));
    let stress = |(i, z): (usize, f64)| match i % 2 {
        0 => 1.5e6 * z.powf(1.1),
        _ => 4.5e10 * z.powf(4.0),
    };
    let test = PlateTest {
        name: "x".to_owned(),
        plate,
        force: (depth.clone().enumerate().map(stress))
            .map(|stress| plate.area * stress)
            .collect(),
        depth: depth.collect(),
    };
    let fit = fit_plates(&[test], &PlateSettings::default()).unwrap();
    let k = &fit.parameters[1];
    assert!(k.standard_error > k.value / 3.0, "{k:?}");
    assert_eq!(k.verdict, Verdict::Loose);
}
