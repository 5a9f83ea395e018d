//! Jobs are read from files of tests.

use std::path::Path;

use grouser_files::Document;
use grouser_identify::least_squares::{Loss, StartSettings};
use grouser_identify::plate::{BagSource, DepthColumn, Plate, PlateSettings};
use grouser_identify::wheel::Scatter;
use grouser_identify::{Job, Parameter, PlateSource};
use grouser_terra::{Angle, GrouserRule, Grousers, RigidWheel};

fn read(text: &str) -> Job {
    Job::read(&Document::from_text("drawn/a.toml", text.into()).unwrap()).unwrap()
}

const EVERY_KEY: &str = r#"format = 1
key = "bed"
name = "Sand of our test bed"
[[plate]]
table = "plates.csv"
[[plate]]
name = "60 mm disc"
diameter_m = 0.06
bag = "test.bag"
topic = "/wrench"
force_field = "wrench.force.z"
stamp_field = "header.stamp"
force_sign = -1.0
depth_file = "test.txt"
height_field = 5
height_unit = "mm"
clock_field = 7
controller_field = 6
controller_unit = "us"
surface_m = -0.0096
[plate_fit]
least_depth_m = 0.003
fit_datum = true
huber = 2.0
[shear]
table = "/tests/shear.csv"
[wheel]
table = "wheel.csv"
radius_m = 0.1
width_m = 0.05
grouser_height_m = 0.005
grouser_count = 24
grouser_thickness_m = 0.002
fit = ["c_2", "k_shear_m", "c_2", "sinkage_datum_m"]
pull_scatter_n = 0.5
side_scatter_n = 0.6
torque_scatter_nm = 0.05
sinkage_scatter_m = 0.0007
huber = 1.5
intervals = "profile"
starts = 12
seed = 9
[soil]
cohesion_kpa = 0.2
phi_deg = 29.0
"#;

#[test]
fn every_key_is_read() {
    let job = read(EVERY_KEY);
    assert_eq!(job.key.as_deref(), Some("bed"));
    assert_eq!(job.name, "Sand of our test bed");
    let [PlateSource::Table(table), PlateSource::Bag(bag)] = job.plates.as_slice() else {
        panic!("{:?}", job.plates)
    };
    assert_eq!(table, Path::new("drawn/plates.csv"));
    assert_eq!(bag.name, "60 mm disc");
    assert_eq!(bag.plate, Plate::disc(0.06).unwrap());
    let source = BagSource {
        bag: "drawn/test.bag".into(),
        topic: Some("/wrench".into()),
        force: "wrench.force.z".into(),
        stamp: Some("header.stamp".into()),
        sign: -1.0,
    };
    assert_eq!(bag.source, source);
    let depth = DepthColumn {
        file: "drawn/test.txt".into(),
        height: 5,
        height_unit: 1e-3,
        clock: 7,
        controller: Some((6, 1e-6)),
        surface: Some(-0.0096),
    };
    assert_eq!(bag.depth, depth);
    let PlateSettings {
        least_depth,
        fit_datum,
        loss,
        ..
    } = job.plate_settings;
    assert_eq!((least_depth, fit_datum), (0.003, true));
    assert_eq!(loss, Loss::Huber { threshold: 2.0 });
    assert_eq!(job.shear.as_deref(), Some(Path::new("/tests/shear.csv")));
    let wheel = job.wheel.unwrap();
    assert_eq!(wheel.table, Path::new("drawn/wheel.csv"));
    let lugs = Grousers {
        height: 0.005,
        rule: GrouserRule::Lugs {
            count: 24.0,
            thickness: 0.002,
        },
    };
    let rigid = RigidWheel::new(0.1, 0.05).unwrap();
    assert_eq!(wheel.wheel, rigid.with_grousers(lugs).unwrap());
    let fit = ["c_2", "k_shear_m", "sinkage_datum_m"].map(|key| Parameter::named(key).unwrap());
    assert_eq!(wheel.parameters, fit);
    let scatter = Scatter {
        pull: 0.5,
        side: 0.6,
        torque: 0.05,
        sinkage: 0.0007,
    };
    assert_eq!(wheel.scatter, scatter);
    assert_eq!(wheel.loss, Loss::Huber { threshold: 1.5 });
    assert!(wheel.profile);
    let starts = StartSettings {
        starts: 12,
        seed: 9,
    };
    assert_eq!(wheel.starts, starts);
    assert_eq!(job.soil.cohesion, Some(200.0));
    assert_eq!(job.soil.phi, Some(Angle::from_deg(29.0)));
}

#[test]
fn what_a_file_leaves_out_is_usual() {
    let job = read(
        "format = 1\nname = \"a\"\n[[plate]]\ndiameter_m = 0.1\nbag = \"some/b.bag\"\nforce_field = \"z\"\n\
         depth_file = \"b.txt\"\nheight_field = 1\nheight_unit = \"in\"\nclock_field = 2\n\
         [wheel]\ntable = \"w.csv\"\nradius_m = 0.1\nwidth_m = 0.1\nfit = [\"c_1\"]\n",
    );
    assert!(job.key.is_none() && job.shear.is_none());
    let [PlateSource::Bag(bag)] = job.plates.as_slice() else {
        panic!("{:?}", job.plates)
    };
    assert_eq!(bag.name, "b");
    assert_eq!((&bag.source.topic, &bag.source.stamp), (&None, &None));
    assert_eq!((bag.source.sign, bag.depth.height_unit), (1.0, 0.0254));
    assert_eq!((bag.depth.controller, bag.depth.surface), (None, None));
    assert_eq!(job.plate_settings, PlateSettings::default());
    let wheel = job.wheel.unwrap();
    assert!(wheel.wheel.grousers().is_none() && !wheel.profile);
    assert_eq!(wheel.scatter, Scatter::default());
    assert_eq!(
        (wheel.loss, wheel.starts),
        (Loss::Squares, StartSettings::default())
    );
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
