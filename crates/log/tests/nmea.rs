//! Sentences of a satellite receiver are a table of fixes.

use std::io::Cursor;

use grouser_files::Document;
use grouser_files::columns::{self, Meaning};
use grouser_files::topics::Topics;
use grouser_log::{Log, Sheet, suggest_for_sheets};
use grouser_slip::Measurement;

use crate::scratch::Folder;

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

/// 20 s to the north at 1 m/s, once a second; `quality` is that of each time.
fn drive(quality: impl Fn(u32) -> u32) -> String {
    let mut text = String::new();
    for second in 0..20_u32 {
        // a minute of latitude is 1852 m within 0.3 %
        let minutes = 30.0 + f64::from(second) / 1852.0;
        let (time, kind) = (format!("2359{:02}.00", 40 + second), quality(second));
        text += &sentence(&format!(
            "GNGGA,{time},46{minutes:09.6},N,00806.000000,E,{kind},12,0.6,1800.0,M,47.0,M,,"
        ));
        text += &sentence(&format!(
            "GNRMC,{time},A,46{minutes:09.6},N,00806.000000,E,1.944,0.0,020326,,,A"
        ));
        text += &sentence("GNGSV,1,1,01,05,40,083,46");
    }
    // a damaged sentence, and one that is truncated
    text.replace("GNGSV,1,1,01,05,40,083,46", "GNGGA,235950.00,1234.0,N") + "$GNGGA,2359"
}

#[test]
fn sentences_are_fixes_with_their_quality() {
    let folder = Folder::new("nmea");
    let path = folder.file(
        "run.nmea",
        drive(|second| if second < 5 { 0 } else { 4 }).as_bytes(),
    );
    let sheet = Sheet::read(&path, |_| ()).unwrap();
    let robot = suggest_for_sheets([(&sheet, "run.nmea")]);
    for meaning in ["latitude", "longitude", "fix_type", "fix_sigma"] {
        assert!(
            robot.contains(&format!("meaning = \"{meaning}\"")),
            "{meaning}: {robot}"
        );
    }
    let map = "format = 1\n[[table]]\nfile = \"*.nmea\"\ntime = { column = \"time\", unit = \"date\" }\ncolumns = [\n\
        { column = \"latitude\", meaning = \"latitude\", unit = \"deg\" },\n\
        { column = \"longitude\", meaning = \"longitude\", unit = \"deg\" },\n\
        { column = \"fix_type\", meaning = \"fix_type\", unit = \"1\" },\n\
        { column = \"horizontal_accuracy_m\", meaning = \"fix_sigma\", unit = \"m\" },\n]\n";
    let map = columns::parse(&Document::from_text("map.toml", map.into()).unwrap()).unwrap();
    let text = drive(|second| if second < 5 { 0 } else { 4 });
    let log = Log::over(
        "run.nmea".as_ref(),
        Cursor::new(text),
        Some(map),
        &Topics::default(),
    )
    .unwrap();
    assert!(log.measures(Meaning::DisplacementForward));
    assert_eq!(log.position_sigma(), Some(0.02));
    let samples: Vec<_> = log.samples(&[]).unwrap().map(Result::unwrap).collect();
    let places: Vec<(i64, f64)> = samples
        .iter()
        .filter_map(|sample| match sample.measurement {
            Measurement::Position { y, .. } => Some((sample.time_ns, y)),
            _ => None,
        })
        .collect();
    assert_eq!(places.len(), 15);
    let ((first_ns, first), (last_ns, last)) = (places[0], places[14]);
    assert_eq!(last_ns - first_ns, 14_000_000_000);
    assert!((last - first - 14.0).abs() < 0.1, "{last} {first}");
    // 2026-03-02T23:59:45Z
    assert_eq!(first_ns, 1_772_495_985_000_000_000);
}

#[test]
fn any_bytes_behind_the_mark_end() {
    let folder = Folder::new("nmea-bytes");
    let text = drive(|_| 1);
    for cut in (2..text.len()).step_by(37) {
        let mut bytes = text.as_bytes()[..cut].to_vec();
        bytes[cut / 2] ^= 0x55;
        if cut / 2 < 2 {
            continue;
        }
        let path = folder.file("run.nmea", &bytes);
        let _ = Sheet::read(&path, |_| ());
    }
}
