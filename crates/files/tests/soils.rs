//! Soil files: read, completed, refused.

use grouser_files::{Document, Error, soil};
use grouser_terra::catalogue::{self, Completion};
use grouser_terra::{LawChoice, LawPreset, OpenSoil, ShearLaw};

const SAND: &str = r#"format = 1
name = "Dry sand"
source = "rover papers"
n = 1.1
k_c_kn_per_m_n1 = 0.9
k_phi_kn_per_m_n2 = 1528.4
cohesion_kpa = 1.0
phi_deg = 30.0
k_shear_m = 0.025
c_1 = 0.18
c_2 = 0.32
"#;

fn parse(text: &str) -> Result<soil::SoilFile, Error> {
    soil::parse(&Document::from_text("sand.toml", text.into()).unwrap())
}

#[test]
fn a_file_with_the_catalogues_numbers_is_the_catalogues_soil() {
    let file = parse(SAND).unwrap();
    let own = file.completed(&Completion::default()).unwrap();
    assert_eq!(own, catalogue::find("dry-sand").unwrap().soil().unwrap());
    assert_eq!(
        (file.name.as_str(), file.source.as_str()),
        ("Dry sand", "rover papers")
    );
}

#[test]
fn one_key_names_all_laws() {
    let preset = LawPreset::DRIFT;
    let text = format!("{SAND}unit_weight_n_per_m3 = 13000.0\nlaws = \"drift\"\n");
    let chosen = |soil: &OpenSoil| (soil.laws, soil.rear_drift, soil.sideways_support);
    let file = parse(&text).unwrap();
    let whole = (preset.laws, preset.rear_drift, preset.sideways_support);
    assert_eq!(chosen(&file.soil), whole);
    let written = soil::to_toml(&file, &[]).unwrap();
    assert!(written.contains("laws = \"drift\"") && !written.contains("bulldozing"));
    assert_eq!(parse(&written).unwrap(), file);
    // a key of its own replaces its part of the preset
    let other = parse(&format!("{text}shear = \"coupled\"\nrear_drift = 0.5\n")).unwrap();
    let laws = LawChoice {
        shear: Some(ShearLaw::Coupled),
        ..preset.laws
    };
    assert_eq!(chosen(&other.soil), (laws, 0.5, preset.sideways_support));
    assert_eq!(parse(&soil::to_toml(&other, &[]).unwrap()).unwrap(), other);
    // the soil beside a drifting wheel has a weight
    let weightless = parse(&text.replace("unit_weight_n_per_m3 = 13000.0\n", "")).unwrap_err();
    assert!(
        weightless.to_string().contains("unit_weight"),
        "{weightless}"
    );
}

#[test]
fn what_is_left_open_is_named_and_can_be_completed() {
    let open = parse(&SAND.replace("k_shear_m = 0.025\n", "")).unwrap();
    assert_eq!(open.soil.missing().collect::<Vec<_>>(), ["k_shear"]);
    let missing = open.completed(&Completion::default()).unwrap_err();
    assert_eq!(missing.field(), Some("k_shear"));
    let given = Completion {
        k_shear: Some(0.025),
        ..Completion::default()
    };
    assert_eq!(
        open.completed(&given).unwrap(),
        catalogue::find("dry-sand").unwrap().soil().unwrap()
    );
}

#[test]
fn bad_numbers_and_keys_are_refused_with_their_place() {
    let degrees = parse(&SAND.replace("phi_deg = 30.0", "phi_deg = 95")).unwrap_err();
    assert!(
        degrees.to_string() == "sand.toml:8:11: `phi_deg` is 95, but must lie in [0, 89]",
        "{degrees}"
    );
    for (from, to) in [
        ("n = 1.1", "n = 0.0"),
        ("c_1 = 0.18", "c_1 = 3"),
        ("0.9", "1e10"),
    ] {
        assert!(parse(&SAND.replace(from, to)).is_err(), "{to}");
    }
    // by the limits of the soil, whatever is no finite number
    for (from, to, message) in [
        (
            "n = 1.1",
            "n = nan",
            "sand.toml:4:5: `n` is NaN, but must lie in [0.1, 3]",
        ),
        (
            "c_2 = 0.32",
            "c_2 = -nan",
            "sand.toml:11:7: `c_2` is NaN, but must lie in [-2, 2]",
        ),
        (
            "phi_deg = 30.0",
            "phi_deg = inf",
            "sand.toml:8:11: `phi_deg` is inf, but must lie in [0, 89]",
        ),
        (
            "cohesion_kpa = 1.0",
            "cohesion_kpa = -inf",
            "sand.toml:7:16: `cohesion_kpa` is -inf, but must lie in [0, 100000]",
        ),
        (
            "0.025",
            "1e400",
            "sand.toml:9:13: `k_shear_m` is inf, but must lie in [0.000001, 10]",
        ),
    ] {
        let error = parse(&SAND.replace(from, to)).unwrap_err();
        assert_eq!(error.to_string(), message);
    }
    let keys = [
        "n_1",
        "n_2",
        "k_c_kn_per_m_n1",
        "k_phi_kn_per_m_n2",
        "k_shear_1_m_per_rad",
        "k_shear_side_m",
        "k_shear_side_1_m_per_rad",
        "rebound",
        "unit_weight_n_per_m3",
        "rear_driving",
        "rear_drift",
        "transport_layer_m",
        "sideways_support",
    ];
    for key in keys {
        let rest = SAND.lines().filter(|line| !line.starts_with(key));
        let text = rest
            .chain([format!("{key} = nan").as_str()])
            .fold(String::new(), |text, line| text + line + "\n");
        let error = parse(&text).unwrap_err().to_string();
        assert!(
            error.contains(&format!("`{key}` is NaN, but must lie in [")),
            "{error}"
        );
    }
    let unknown = parse(&SAND.replace("cohesion_kpa", "cohesion_pa")).unwrap_err();
    assert!(unknown.to_string().contains("cohesion_pa"), "{unknown}");
    let unknown = parse(&format!("{SAND}rebund = 0.1\n")).unwrap_err();
    assert_eq!(unknown.hint().unwrap(), "did you mean `rebound`?");
    // the key that is missing is named, not the one of the same family that is there
    let missing = parse(&SAND.replace("k_c_kn_per_m_n1 = 0.9\n", "")).unwrap_err();
    let is_missing = matches!(&missing, Error::MissingKey { key, .. } if *key == "k_c_kn_per_m_n1");
    assert!(is_missing, "{missing}");
}

#[test]
fn what_is_written_reads_back_to_the_same_bits() {
    use grouser_terra::{Bulldozing, LawChoice, ShearLaw, SlipNorm, SlipSinkage, StressPosition};
    let sand = parse(SAND).unwrap();
    let changed = grouser_terra::OpenSoil {
        n_1: -0.1 / 3.0,
        n_2: 0.1 + 0.2,
        k_shear_1: 0.01 / 3.0,
        k_shear_side: Some(0.02 / 3.0),
        k_shear_side_1: 0.05 / 3.0,
        cohesion: Some(1000.0 / 3.0),
        phi: Some(grouser_terra::Angle::from_deg(100.0 / 3.1)),
        unit_weight: Some(13.1e3 / 7.0),
        rebound: 0.25,
        rear_driving: 2.0,
        rear_drift: 1.0,
        transport_layer: 1e-3 / 3.0,
        sideways_support: 0.7 / 3.0,
        fitted: Some(grouser_terra::FittedRange {
            slip: (-0.7, 0.75),
            slip_angle: (0.0, grouser_terra::Angle::from_deg(100.0 / 3.3).rad()),
            width: (0.05, 0.05),
            load: (16.1, 26.0 / 1.1),
        }),
        laws: LawChoice {
            slip_norm: SlipNorm::Root,
            slip_sinkage: SlipSinkage::Whole,
            stress_position: StressPosition::Whole,
            shear: Some(ShearLaw::SlipVelocity),
            bulldozing: Some(Bulldozing::Disc),
        },
        ..sand.soil
    };
    let mut file = soil::SoilFile::new("a \"quoted\" \\ name", "plate tests", changed);
    file.note = "two\nlines".to_owned();
    let text = soil::to_toml(&file, &["made by a test", "of two lines\nand more"]).unwrap();
    assert_eq!(parse(&text).unwrap(), file);
    let wrong = parse(&text.replace("\"whole\"", "\"hole\"")).unwrap_err();
    assert!(wrong.to_string().contains("slip_sinkage"), "{wrong}");
}
