//! Mistakes in units: is the result called implausible, and the mistake named?

use std::fmt::Write;
use std::path::Path;

use grouser_files::Document;
use grouser_identify::{Job, identify};

use crate::coverage::{laboratory, wheel_tests};

/// The words for the result of a folder's job: its doubts, or its error.
fn words(folder: &Path, edit: impl Fn(&mut Job)) -> String {
    let mut job = Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap();
    edit(&mut job);
    match identify(&job) {
        Ok(found) => {
            let doubts = found.doubts();
            let doubts = doubts.iter().map(ToString::to_string);
            doubts.collect::<Vec<_>>().join("\n")
        }
        Err(error) => error.to_string(),
    }
}

/// A mistake: the file, the columns or keys whose numbers change, their factor, and the words that name it.
type Mistake = (&'static str, &'static [&'static str], f64, &'static str);

const MISTAKES: [Mistake; 21] = [
    (
        "plates.csv",
        &["force_n"],
        1e-3,
        "force of the plate tests is in kN",
    ),
    (
        "plates.csv",
        &["force_n"],
        1e3,
        "force of the plate tests is in N, not kN",
    ),
    (
        "plates.csv",
        &["depth_mm"],
        1e3,
        "depth of the plate tests is in mm, not m",
    ),
    (
        "plates.csv",
        &["depth_mm"],
        1e-3,
        "depth of the plate tests is in m, not mm",
    ),
    (
        "plates.csv",
        &["depth_mm"],
        0.1,
        "depth of the plate tests is in cm, not mm",
    ),
    (
        "plates.csv",
        &["plate_diameter_mm"],
        1e3,
        "plates' diameter is in mm, not m",
    ),
    (
        "plates.csv",
        &["plate_diameter_mm"],
        0.1,
        "plates' diameter is in cm, not mm",
    ),
    (
        "plates.csv",
        &["plate_diameter_mm"],
        0.5,
        "plates' diameter is the radius",
    ),
    (
        "shear.csv",
        &["shear_stress_kpa"],
        1e-3,
        "the shear stress is in MPa",
    ),
    (
        "shear.csv",
        &["normal_stress_kpa"],
        1e-3,
        "the normal stress of the shear tests is in MPa",
    ),
    (
        "shear.csv",
        &["normal_stress_kpa", "shear_stress_kpa"],
        1e-3,
        "normal and shear stress are in MPa",
    ),
    (
        "shear.csv",
        &["displacement_mm"],
        1e3,
        "displacement of the shear tests is in mm, not m",
    ),
    (
        "wheel.csv",
        &["load_n"],
        1e-3,
        "load of the wheel tests is in kN",
    ),
    (
        "wheel.csv",
        &["load_n"],
        0.101_971_6,
        "load of the wheel tests is in kg",
    ),
    (
        "wheel.csv",
        &["load_n", "drawbar_pull_n"],
        1e-3,
        "load and forces of the wheel tests are in kN",
    ),
    ("wheel.csv", &["torque_nm"], 100.0, "torque is in N cm"),
    ("wheel.csv", &["sinkage_m"], 1e3, "sinkage is in mm, not m"),
    ("wheel.csv", &["sinkage_m"], 1e2, "sinkage is in cm, not m"),
    (
        "tests.toml",
        &["radius_m"],
        2.0,
        "`radius_m` is the diameter",
    ),
    ("tests.toml", &["width_m"], 1e3, "`width_m` is in mm"),
    ("wheel.csv", &["slip"], 100.0, "percent"),
];

/// The text of a file with the mistake in it.
fn mistaken(text: &str, keys: &[&str], factor: f64) -> String {
    let mut out = Vec::new();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    for (index, line) in text.lines().enumerate() {
        if let Some((key, value)) = line.split_once(" = ")
            && keys.contains(&key)
        {
            out.push(format!(
                "{key} = {}",
                factor * value.parse::<f64>().unwrap()
            ));
        } else if index > 0 && header.len() > 1 {
            let fields = line.split(',').zip(&header).map(|(field, name)| {
                if keys.contains(name) {
                    (factor * field.parse::<f64>().unwrap()).to_string()
                } else {
                    field.to_owned()
                }
            });
            out.push(fields.collect::<Vec<_>>().join(","));
        } else {
            out.push(line.to_owned());
        }
    }
    out.join("\n")
}

#[test]
fn a_mistake_in_a_unit_is_named() {
    let mut missed = Vec::new();
    for (file, keys, factor, named) in MISTAKES {
        let folder = laboratory(1, 0.03, &wheel_tests());
        let text = std::fs::read_to_string(folder.join(file)).unwrap();
        std::fs::write(folder.join(file), mistaken(&text, keys, factor)).unwrap();
        let started = std::time::Instant::now();
        let words = words(&folder, |_| ());
        println!(
            "{file} {keys:?} x {factor} ({:.1} s): {words}\n",
            started.elapsed().as_secs_f64()
        );
        assert!(!words.is_empty(), "{file} {keys:?} {factor}");
        if !words.contains(named) {
            missed.push((keys, factor));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// Without wheel tests, which show that plates or shear tests are wrong, only a radius in the place of a diameter passes.
#[test]
fn a_mistake_in_plates_or_shear_tests_alone_is_named() {
    let mut missed = Vec::new();
    for (file, keys, factor, named) in MISTAKES {
        if !matches!(file, "plates.csv" | "shear.csv") {
            continue;
        }
        let folder = laboratory(1, 0.03, &wheel_tests());
        let text = std::fs::read_to_string(folder.join(file)).unwrap();
        std::fs::write(folder.join(file), mistaken(&text, keys, factor)).unwrap();
        let words = words(&folder, |job| {
            job.wheel = None;
            if file == "plates.csv" {
                job.shear = None;
            } else {
                job.plates.clear();
            }
        });
        println!("{file} {keys:?} x {factor}: {words}\n");
        if !words.contains(named) {
            missed.push((keys, factor));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
    assert_eq!(missed, [(&["plate_diameter_mm"][..], 0.5)]);
}

/// Every soil of the catalogue, under plates of 60 and 200 mm and in a shear box.
#[test]
fn published_soils_are_plausible() {
    for entry in grouser_terra::catalogue::entries() {
        let folder = laboratory(1, 0.03, &wheel_tests());
        let mut plates = String::from("test,plate_diameter_mm,depth_mm,force_n\n");
        for diameter in [60.0, 200.0_f64] {
            for step in 1..=40 {
                let depth = 0.003 * f64::from(step);
                let radius = 5e-4 * diameter;
                let area = std::f64::consts::PI * radius * radius;
                let modulus = 1e3 * (entry.k_c_kn / radius + entry.k_phi_kn);
                let noise = 1.0 + 0.02 * (1.7 * f64::from(step) + diameter).sin();
                let force = area * modulus * depth.powf(entry.n) * noise;
                let row = [diameter, 1e3 * depth, force].map(|x| x.to_string());
                writeln!(plates, "{diameter},{}", row.join(",")).unwrap();
            }
        }
        std::fs::write(folder.join("plates.csv"), plates).unwrap();
        let mut shear = String::from("normal_stress_kpa,displacement_mm,shear_stress_kpa\n");
        for normal in [3.0, 8.0, 15.0] {
            for step in 1..=30 {
                let displacement = 3.0 * f64::from(step);
                let strength = entry.cohesion_kpa + normal * entry.phi_deg.to_radians().tan();
                let shown = 1.0 - (-displacement / 20.0).exp();
                let stress = strength * (shown + 0.01 * (1.9 * f64::from(step) + normal).sin());
                writeln!(shear, "{normal},{displacement},{stress}").unwrap();
            }
        }
        std::fs::write(folder.join("shear.csv"), shear).unwrap();
        let words = words(&folder, |job| job.wheel = None);
        let is_unsound = words.contains("implausible") || words.contains("mistake");
        assert!(!is_unsound, "{}: {words}", entry.key);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
