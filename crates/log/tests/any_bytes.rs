//! Any bytes at all: records or an error, never a panic, and never more records than rows.

use std::sync::atomic::{AtomicUsize, Ordering};

use proptest::prelude::*;

use crate::scratch::read;

/// Each case has a folder of its own.
static CASE: AtomicUsize = AtomicUsize::new(0);

fn survives(options: &str, bytes: &[u8]) -> Result<(), TestCaseError> {
    let case = CASE.fetch_add(1, Ordering::Relaxed);
    if let Ok(records) = read(&format!("any{case}"), options, bytes) {
        let rows = bytes.split(|byte| *byte == b'\n').count();
        prop_assert!(records.len() <= 2 * rows);
        for record in records {
            if let grouser_slip::Measurement::YawRate { rate } = record.measurement {
                prop_assert!(rate.is_finite());
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn noise(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        survives("", &bytes)?;
    }

    #[test]
    fn noise_after_a_header(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        survives("", &[b"t,n,g\n", &bytes[..]].concat())?;
    }

    #[test]
    fn tables_out_of_the_letters_of_tables(
        text in "[0-9tng.,;\"eE+\\-\n\r \u{feff}naif]{0,200}",
        options in prop::sample::select(vec![
            "", "separator = \";\"\ndecimal = \",\"", "separator = \"tab\"", "missing = [\"nan\"]",
            "header_lines = 2\nnames_line = 1",
        ]),
    ) {
        survives(options, format!("t,n,g\n{text}").as_bytes())?;
    }

    #[test]
    fn a_good_table_with_bytes_changed(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = b"t,n,g\n0,1,0.5\n0.1,2,0.25\n\"0.2\",3,-1e-3\n0.3,,\n".to_vec();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        survives("", &bytes)?;
    }
}
