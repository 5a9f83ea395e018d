//! Any text at all as a robot or a column map: what it says or an error, never a panic.

use grouser_files::robot::Revision;
use grouser_files::{Document, columns, robot};
use proptest::prelude::*;

const ROBOT: &str = include_str!("../../../examples/five-wheel/robot.toml");
const COLUMNS: &str = include_str!("../../../examples/robotino/columns.toml");

/// Reads a text as both; a place that an error names lies in it.
fn survives(text: &str) -> Result<(), TestCaseError> {
    let document = Document::from_text("any.toml", text.into()).unwrap();
    if let Ok(file) = robot::parse(&document) {
        for wheel in file.robot.wheels() {
            prop_assert!(wheel.radius.is_finite() && wheel.radius > 0.0);
        }
    }
    if let Ok(map) = columns::parse(&document) {
        prop_assert!(map.tables.iter().all(|table| !table.columns.is_empty()));
    }
    let revision = Revision {
        radius: Some(0.9),
        ..Revision::default()
    };
    let _ = robot::revised(&document, &revision);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn noise(text in any::<String>()) {
        survives(&text)?;
    }

    #[test]
    fn texts_out_of_the_letters_of_toml(text in "[a-z0-9_.=\\[\\]{}\"'\n# ,+\\-]{0,200}") {
        survives(&format!("format = 1\n{text}"))?;
    }

    #[test]
    fn good_files_with_pieces_cut_out_or_put_elsewhere(
        is_robot in any::<bool>(),
        cut in any::<prop::sample::Index>(),
        length in 0..40_usize,
        at in any::<prop::sample::Index>(),
    ) {
        let mut letters: Vec<char> = if is_robot { ROBOT } else { COLUMNS }.chars().collect();
        let start = cut.index(letters.len());
        let end = (start + length).min(letters.len());
        let piece: Vec<char> = letters.drain(start..end).collect();
        let to = at.index(letters.len());
        letters.splice(to..to, piece);
        survives(&letters.into_iter().collect::<String>())?;
    }
}
