//! Jobs that are written and read again.

use grouser_files::Document;
use grouser_identify::least_squares::{Loss, StartSettings};
use grouser_identify::plate::{BagSource, DepthColumn, Plate};
use grouser_identify::wheel::Scatter;
use grouser_identify::{BagTest, Error, Job, Parameter, PlateSource, WheelJob, to_toml};
use grouser_terra::{
    Angle, Bekker, Bulldozing, FittedRange, GrouserRule, Grousers, OpenSoil, Pressure, RigidWheel,
    ShearLaw, SlipNorm, SlipSinkage, StressPosition,
};
use proptest::prelude::*;

fn again(job: &Job) -> Job {
    let text = to_toml(job, &["drawn"]).unwrap();
    Job::read(&Document::from_text("drawn.toml", text.clone()).unwrap()).expect(&text)
}

fn number() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(prop_oneof![-1e6..1e6_f64, Just(0.0), Just(1e-300)])
}

/// What some number of kPa gives, in Pa.
fn kilo() -> impl Strategy<Value = Option<f64>> {
    number().prop_map(|kilo| kilo.map(|kilo| 1e3 * kilo))
}

fn angle() -> impl Strategy<Value = Option<Angle>> {
    prop::option::of((-90.0..90.0_f64).prop_map(Angle::from_deg))
}

fn loss() -> impl Strategy<Value = Loss> {
    prop_oneof![
        Just(Loss::Squares),
        (0.1..100.0_f64).prop_map(|threshold| Loss::Huber { threshold })
    ]
}

fn path() -> impl Strategy<Value = std::path::PathBuf> {
    "[a-zA-Zé][a-z é/._\"\\\\-]{0,20}".prop_map(Into::into)
}

prop_compose! {
    fn soil()(
        (k_c, k_phi, n, cohesion, phi) in (kilo(), kilo(), number(), kilo(), angle()),
        (k_shear, c_1, c_2, unit_weight, side) in (number(), number(), number(), number(), number()),
        (n_1, rebound, support, transport) in (-2.0..2.0_f64, 0.0..1.0_f64, 0.01..1.0_f64, prop_oneof![Just(0.0), 0.0..0.1_f64]),
        (shear, bulldozing) in (prop::option::of(prop::sample::select(ShearLaw::ALL.to_vec())),
            prop::option::of(prop::sample::select(Bulldozing::ALL.to_vec()))),
        (sinkage, position, root) in (prop::sample::select(SlipSinkage::ALL.to_vec()),
            prop::sample::select(StressPosition::ALL.to_vec()), any::<bool>()),
        fitted in prop::option::of((-1.0..0.0_f64, 0.0..1.0_f64, 0.0..90.0_f64, 0.01..1.0_f64, 1.0..1e4_f64)),
    ) -> OpenSoil {
        let mut soil = OpenSoil {
            pressure: Pressure::Bekker(Bekker { k_c, k_phi }),
            n, cohesion, phi, k_shear, c_1, c_2, unit_weight, k_shear_side: side,
            n_1, rebound, sideways_support: support, transport_layer: transport,
            ..OpenSoil::default()
        };
        (soil.laws.shear, soil.laws.bulldozing) = (shear, bulldozing);
        (soil.laws.slip_sinkage, soil.laws.stress_position) = (sinkage, position);
        soil.laws.slip_norm = if root { SlipNorm::Root } else { SlipNorm::Greater };
        soil.fitted = fitted.map(|(low, high, degrees, width, load)| FittedRange {
            slip: (low, high),
            slip_angle: (0.0, Angle::from_deg(degrees).rad()),
            width: (width, 2.0 * width),
            load: (load, 3.0 * load),
        });
        soil
    }
}

prop_compose! {
    fn bag_test()(
        (name, diameter) in ("[ -~é]{1,12}", 1e-3..100.0_f64),
        (bag, file) in (path(), path()),
        (topic, force, stamp) in (prop::option::of("/[a-z/]{1,9}"), "[a-z.]{1,9}", prop::option::of("[a-z.]{1,9}")),
        (sign, surface) in (any::<bool>(), prop::option::of(-1e3..1e3_f64)),
        (height, clock) in (1..=1000_usize, 1..=1000_usize),
        height_unit in prop::sample::select(vec![1.0, 1e-2, 1e-3, 0.0254]),
        controller in prop::option::of((1..=1000_usize, prop::sample::select(vec![1.0, 1e-3, 1e-6, 1e-9]))),
    ) -> PlateSource {
        let source = BagSource { bag, topic, force, stamp, sign: if sign { 1.0 } else { -1.0 } };
        let depth = DepthColumn { file, height, height_unit, clock, controller, surface };
        PlateSource::Bag(Box::new(BagTest::new(name, Plate::disc(diameter).unwrap(), source, depth)))
    }
}

prop_compose! {
    fn wheel()(
        (table, radius, width) in (path(), 1e-2..1.0_f64, 1e-2..1.0_f64),
        lugs in prop::option::of((0.001..0.5_f64, 3..40_u8, 0.0..0.5_f64)),
        parameters in prop::sample::subsequence(Parameter::all().collect::<Vec<_>>(), 0..18).prop_shuffle(),
        scatter in [1e-12..1e12_f64, 1e-6..10.0_f64, 1e-6..10.0_f64, 1e-6..10.0_f64],
        (loss, profile) in (loss(), any::<bool>()),
        (starts, seed) in (1..=1000_usize, 0..=i64::MAX.unsigned_abs()),
    ) -> WheelJob {
        let mut rigid = RigidWheel::new(radius, width).unwrap();
        if let Some((height, count, thickness)) = lugs {
            let pitch = 2.0 * core::f64::consts::PI * radius / f64::from(count);
            rigid = rigid.with_grousers(Grousers {
                height: height * radius,
                rule: GrouserRule::Lugs { count: count.into(), thickness: thickness * pitch },
            }).unwrap();
        }
        let mut job = WheelJob::new(table, rigid, parameters);
        job.scatter = Scatter { pull: scatter[0], side: scatter[1], torque: scatter[2], sinkage: scatter[3] };
        (job.loss, job.profile) = (loss, profile);
        job.starts = StartSettings { starts, seed };
        job
    }
}

prop_compose! {
    /// Any legal job.
    fn job()(
        (name, key) in ("[ -~é]{0,20}", prop::option::of("[a-z-]{1,9}")),
        soil in soil(),
        plates in prop::collection::vec(prop_oneof![path().prop_map(PlateSource::Table), bag_test()], 1..4),
        (least_depth, fit_datum, loss) in (1e-6..10.0_f64, any::<bool>(), loss()),
        shear in prop::option::of(path()),
        wheel in prop::option::of(wheel()),
    ) -> Job {
        let mut job = Job::new(name);
        (job.key, job.soil, job.plates, job.shear, job.wheel) = (key, soil, plates, shear, wheel);
        let usual = &mut job.plate_settings;
        (usual.least_depth, usual.fit_datum, usual.loss) = (least_depth, fit_datum, loss);
        job
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_job_read_again_is_the_same(job in job()) {
        prop_assert_eq!(again(&job), job);
    }
}

#[test]
fn the_shipped_job_is_written_and_read_again() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/bevameter/tests.toml"
    );
    let job = Job::read(&Document::read(file.as_ref()).unwrap()).unwrap();
    assert_eq!(again(&job), job);
}

/// What the file has no key for is refused, not left out.
#[test]
fn what_no_file_holds_is_refused() {
    let depth = DepthColumn {
        file: "a.txt".into(),
        height: 1,
        height_unit: 0.3048,
        clock: 2,
        controller: None,
        surface: None,
    };
    let source = BagSource {
        bag: "a.bag".into(),
        topic: None,
        force: "z".into(),
        stamp: None,
        sign: 1.0,
    };
    let mut job = Job::new("feet");
    for plate in [
        Plate::disc(0.1).unwrap(), // its depth is in feet
        Plate {
            area: 0.02,
            width: 0.1,
        },
    ] {
        let test = BagTest::new("a", plate, source.clone(), depth.clone());
        job.plates = vec![PlateSource::Bag(Box::new(test))];
        assert!(matches!(to_toml(&job, &[]), Err(Error::Unwritable(_))));
    }
}

#[test]
fn whole_numbers_out_of_their_limits_are_refused() {
    for line in ["starts = -5", "starts = 0", "starts = 1001", "seed = -1"] {
        let text = format!(
            "format = 1\nname = \"a\"\n[wheel]\ntable = \"w.csv\"\nradius_m = 0.1\nwidth_m = 0.1\nfit = [\"c_1\"]\n{line}\n"
        );
        let refused = Job::read(&Document::from_text("a.toml", text).unwrap()).unwrap_err();
        let key = line.split(' ').next().unwrap();
        assert!(refused.to_string().contains(key), "{line}: {refused}");
    }
}
