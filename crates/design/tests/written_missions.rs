//! Missions that are written and read again.

use grouser_design::mission::{Choice, MissionFile, SoilMeasure, parse, to_toml};
use grouser_files::Document;
use proptest::prelude::*;

fn again(mission: &MissionFile) -> MissionFile {
    let text = to_toml(mission, &["drawn"]);
    parse(&Document::from_text("drawn.toml", text.clone()).unwrap()).expect(&text)
}

fn share() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(0.0..=1.0_f64)
}

fn bounds() -> impl Strategy<Value = Option<(f64, f64)>> {
    prop::option::of((0.001..1.0_f64, prop_oneof![Just(0.0), 0.0..5.0_f64])).prop_map(|bounds| {
        let (low, room) = bounds?;
        Some((low, low + room))
    })
}

prop_compose! {
    /// Any legal mission.
    fn mission()(
        (title, gravity) in (prop::option::of("[ -~é]{0,20}"), prop::option::of(0.01..100.0_f64)),
        soils in prop::collection::vec(("[a-z][a-z0-9/.-]{0,9}", share()), 0..4),
        slopes in prop::collection::vec((0.0..=60.0_f64, share()), 0..4),
        wheel in [bounds(), bounds(), bounds(), bounds(), bounds()],
        mass_shift in bounds(),
        wheel_mass in prop::option::of("[ -~]{0,20}"),
        measure in prop::sample::select(vec![None, Some(SoilMeasure::Worst), Some(SoilMeasure::Mean)]),
        (min_reserve, max_slip) in (share(), prop::option::of(0.01..=0.95_f64)),
        (points, seed) in (prop::option::of(2..=200_usize), prop::option::of(0..=i64::MAX.unsigned_abs())),
        choice in prop_oneof![
            Just(None),
            prop::sample::select(vec![Choice::Knee, Choice::Lightest, Choice::LeastEnergy]).prop_map(Some),
            (1e-9..1e9_f64).prop_map(|limit| Some(Choice::MaxMass(limit))),
        ],
    ) -> MissionFile {
        let mut file = MissionFile::default();
        (file.title, file.gravity) = (title, gravity);
        (file.soils, file.slopes) = (soils, slopes);
        file.mass_shift = mass_shift.map(|(low, high)| (low - 0.5, high - 0.5));
        (file.wheel, file.wheel_mass, file.measure) = (wheel, wheel_mass, measure);
        (file.min_reserve, file.max_slip) = (min_reserve, max_slip);
        (file.points, file.seed, file.choice) = (points, seed, choice);
        file
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn a_mission_read_again_is_the_same(mission in mission()) {
        prop_assert_eq!(again(&mission), mission);
    }

    /// What is behind counts where the first says nothing, key by key.
    #[test]
    fn the_first_of_two_missions_precedes(first in mission(), behind in mission()) {
        prop_assert_eq!(first.clone().or(MissionFile::default()), first.clone());
        prop_assert_eq!(MissionFile::default().or(behind.clone()), behind.clone());
        let both = first.clone().or(behind.clone());
        prop_assert_eq!(both.max_slip, first.max_slip.or(behind.max_slip));
        prop_assert_eq!(both.wheel[3], first.wheel[3].or(behind.wheel[3]));
        let slopes = if first.slopes.is_empty() { behind.slopes } else { first.slopes };
        prop_assert_eq!(both.slopes, slopes);
    }
}

#[test]
fn soil_files_lie_beside_the_mission() {
    let text = "format = 1\n[[soil]]\nsoil = \"dry-sand\"\n[[soil]]\nsoil = \"loam.toml\"\n[[soil]]\nsoil = \"/soils/a.toml\"\n";
    let document = Document::from_text("field/day.toml", text.into()).unwrap();
    let names: Vec<String> = parse(&document)
        .unwrap()
        .soils
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert_eq!(names, ["dry-sand", "field/loam.toml", "/soils/a.toml"]);
}
