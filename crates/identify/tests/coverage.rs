//! Are 95 % intervals of the wheel stage right in 95 of 100 laboratories, each with its own noise in plates, shear and
//! wheel tests?

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use grouser_files::Document;
use grouser_identify::least_squares::Verdict;
use grouser_identify::{Identification, Job, Parameter, identify};
use grouser_terra::{Angle, Kinematics, OpenSoil, RigidWheel, Settings, Slip, Soil, WheelOnSoil};

/// Normal numbers by Box and Muller, of a linear congruential generator.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Of folders.
static COUNT: AtomicU32 = AtomicU32::new(0);

/// Of the wheel tests, m.
const DATUM_M: f64 = 1.5e-3;
/// n_1, c_1, c_2 and the datum, as they are.
pub(crate) const TRUTH: [f64; 4] = [0.22, 0.27, 0.31, DATUM_M];

/// The soil of the tests.
pub(crate) fn open_soil() -> OpenSoil {
    let soil = Soil::bekker(9e3, 1.3e6, 0.92);
    let soil = soil.cohesion(1600.0).phi(Angle::from_deg(34.0));
    let mut soil = soil.k_shear(0.016).stress_position(TRUTH[1], TRUTH[2]);
    Parameter::named("n_1").unwrap().put(&mut soil, TRUTH[0]);
    soil
}

/// A folder with a job of noisy tests: plates of three sizes with a relative noise, a shear box with 80 Pa, and a wheel
/// whose readings scatter as the job states.
pub(crate) fn laboratory(seed: u64, plate_noise: f64, wheel: &[[f64; 5]]) -> PathBuf {
    laboratory_on_spots(seed, plate_noise, 0.0, wheel)
}

/// The same, each plate and shear test on a spot of its own, whose pressure or strength differs by a share of `spots`; three of
/// each where they do.
fn laboratory_on_spots(seed: u64, plate_noise: f64, spots: f64, wheel: &[[f64; 5]]) -> PathBuf {
    let times = if spots > 0.0 { 3 } else { 1 };
    let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("grouser-coverage-{}-{count}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let mut plates = String::from("test,plate_diameter_mm,depth_mm,force_n\n");
    for (index, diameter) in [0.08, 0.12, 0.18_f64].repeat(times).into_iter().enumerate() {
        let spot = 1.0 + spots * noise.normal();
        for depth in 1..=30 {
            let depth = 1e-3 * f64::from(depth);
            let area = 0.25 * std::f64::consts::PI * diameter * diameter;
            let pressure = (9e3 / (0.5 * diameter) + 1.3e6) * depth.powf(0.92);
            let force = spot * area * pressure * (1.0 + plate_noise * noise.normal());
            let (diameter, depth) = (1e3 * diameter, 1e3 * depth);
            writeln!(plates, "d{index},{diameter},{depth},{force}").unwrap();
        }
    }
    write("plates.csv", &plates);
    let mut shear = String::from("normal_stress_kpa,displacement_mm,shear_stress_kpa\n");
    for normal in [3.0, 6.0, 10.0, 15.0].repeat(times) {
        let spot = 1.0 + spots * noise.normal();
        for displacement in (1..=60).step_by(2).map(f64::from) {
            let strength = spot * (1.6 + normal * 34_f64.to_radians().tan());
            let stress = strength * (1.0 - (-displacement / 16.0).exp()) + 0.08 * noise.normal();
            writeln!(shear, "{normal},{displacement},{stress}").unwrap();
        }
    }
    write("shear.csv", &shear);
    let mut table = String::from("slip,load_n,drawbar_pull_n,torque_nm,sinkage_m\n");
    for [slip, load, pull, torque, sinkage] in wheel {
        for _ in 0..2 {
            let pull = pull + 0.5 * noise.normal();
            let torque = torque + 0.05 * noise.normal();
            let sinkage = sinkage + DATUM_M + 5e-4 * noise.normal();
            writeln!(table, "{slip},{load},{pull},{torque},{sinkage}").unwrap();
        }
    }
    write("wheel.csv", &table);
    write(
        "tests.toml",
        "format = 1\nname = \"a laboratory\"\n[[plate]]\ntable = \"plates.csv\"\n[shear]\ntable = \"shear.csv\"\n\
         [wheel]\ntable = \"wheel.csv\"\nradius_m = 0.13\nwidth_m = 0.09\n\
         fit = [\"n_1\", \"c_1\", \"c_2\", \"sinkage_datum_m\"]\npull_scatter_n = 0.5\ntorque_scatter_nm = 0.05\n\
         sinkage_scatter_m = 0.0005\nstarts = 1\n",
    );
    folder
}

/// Slip, load, pull, torque and sinkage without noise.
pub(crate) fn wheel_tests() -> Vec<[f64; 5]> {
    tests_on(&open_soil())
}

/// The same on another soil.
pub(crate) fn tests_on(soil: &OpenSoil) -> Vec<[f64; 5]> {
    let wheel = RigidWheel::new(0.13, 0.09).unwrap();
    let wheel = WheelOnSoil::new(wheel, soil.soil().unwrap(), Settings::default()).unwrap();
    let mut rows = Vec::new();
    for load in [70.0, 120.0] {
        for slip in [0.03, 0.08, 0.15, 0.25, 0.35, 0.5, 0.65] {
            let motion = Kinematics::straight(Slip::new(slip).unwrap());
            let point = wheel.under_load(load, &motion).unwrap().point().unwrap();
            rows.push([
                slip,
                load,
                point.forces.drawbar_pull,
                point.forces.torque,
                point.sinkage,
            ]);
        }
    }
    rows
}

pub(crate) fn found(
    seed: u64,
    plate_noise: f64,
    wheel: &[[f64; 5]],
    edit: impl Fn(&mut Job),
) -> Identification {
    found_on_spots(seed, plate_noise, 0.0, wheel, edit)
}

fn found_on_spots(
    seed: u64,
    plate_noise: f64,
    spots: f64,
    wheel: &[[f64; 5]],
    edit: impl Fn(&mut Job),
) -> Identification {
    let folder = laboratory_on_spots(seed, plate_noise, spots, wheel);
    let mut job = Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap();
    edit(&mut job);
    let found = identify(&job).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    found
}

/// n_1 is what the wheel adds to the plates' exponent, so that a noisy exponent makes it uncertain. Of 100 laboratories
/// an interval of 95 % holds the truth in 95 ± 2.2: 88 is three sigma away.
#[test]
fn intervals_of_the_wheel_hold_with_noisy_plates() {
    let wheel = wheel_tests();
    let mut hits = [0_u32; 4];
    for seed in 1..=100 {
        let stage = found(seed, 0.08, &wheel, |_| ()).wheel.unwrap();
        for ((hits, truth), number) in hits.iter_mut().zip(TRUTH).zip(&stage.numbers) {
            let (low, high) = (number.interval.low.unwrap(), number.interval.high.unwrap());
            *hits += u32::from(low <= truth && truth <= high);
        }
    }
    println!("n_1, c_1, c_2 and datum in {hits:?} of 100");
    assert!(hits.iter().all(|hits| *hits > 88), "{hits:?}");
    assert!(hits[0] < 100);
}

/// Plates and shear tests on spots that differ by 5 %, three of each: without that in the intervals n_1, c_1, c_2 and the datum
/// are in theirs in 79, 97, 76 and 89 of 100 laboratories.
#[test]
fn intervals_of_the_wheel_hold_on_spots_that_differ() {
    let wheel = wheel_tests();
    let mut hits = [0_u32; 4];
    for seed in 1..=100 {
        let stage = found_on_spots(seed, 0.03, 0.05, &wheel, |_| ())
            .wheel
            .unwrap();
        for ((hits, truth), number) in hits.iter_mut().zip(TRUTH).zip(&stage.numbers) {
            let low = number.interval.low.is_none_or(|low| low <= truth);
            let high = number.interval.high.is_none_or(|high| truth <= high);
            *hits += u32::from(low && high);
        }
    }
    println!("n_1, c_1, c_2 and datum in {hits:?} of 100");
    assert!(hits.iter().all(|hits| *hits > 88), "{hits:?}");
}

#[test]
fn profile_intervals_inherit_the_same() {
    let wheel = wheel_tests();
    for seed in 1..=4 {
        let of = |profile| {
            let edit = |job: &mut Job| job.wheel.as_mut().unwrap().profile = profile;
            found(seed, 0.08, &wheel, edit).wheel.unwrap().numbers
        };
        for (by_profile, linear) in of(true).iter().zip(of(false)) {
            for (a, b) in [
                (by_profile.interval.low, linear.interval.low),
                (by_profile.interval.high, linear.interval.high),
            ] {
                let (a, b) = (a.unwrap() - linear.value, b.unwrap() - linear.value);
                assert!((a / b - 1.0).abs() < 0.1, "{a} {b} {:?}", linear.parameter);
            }
        }
    }
}

/// Shear tests at one normal stress tell cohesion and friction only together, and the wheel has others.
#[test]
fn what_hangs_on_an_undetermined_number_is_loose() {
    let wheel = wheel_tests();
    let folder = laboratory(1, 0.03, &wheel);
    let read = || Job::read(&Document::read(&folder.join("tests.toml")).unwrap()).unwrap();
    let shear = std::fs::read_to_string(folder.join("shear.csv")).unwrap();
    let one: Vec<&str> = shear
        .lines()
        .filter(|line| line.starts_with(['n', '6']))
        .collect();
    std::fs::write(folder.join("shear.csv"), one.join("\n")).unwrap();
    let mut job = read();
    let stage = identify(&job).unwrap().wheel.unwrap();
    for number in &stage.numbers {
        assert_eq!(number.verdict, Verdict::Loose);
        assert!(number.standard_error.is_nan() && number.interval.low.is_none());
    }
    // with both found by the wheel nothing of the shear tests is taken but K
    let fitted = job.wheel.as_mut().unwrap();
    fitted.parameters = ["cohesion_kpa", "phi_deg"]
        .map(|key| Parameter::named(key).unwrap())
        .to_vec();
    fitted.parameters.push(Parameter::named("c_1").unwrap());
    fitted.parameters.push(Parameter::named("c_2").unwrap());
    let stage = identify(&job).unwrap().wheel.unwrap();
    assert!(
        stage
            .numbers
            .iter()
            .all(|number| number.standard_error.is_finite())
    );
    std::fs::remove_dir_all(folder).unwrap();
}
