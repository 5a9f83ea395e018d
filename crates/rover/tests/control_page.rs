//! The table of the controller's settings in docs/drive.md against the settings themselves.

use grouser_slip::control::ControlSettings;
use grouser_slip::settings::FileUnit;

/// The cells of the table's rows: key, default, unit, limits.
fn rows() -> Vec<[String; 4]> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/drive.md");
    let text = std::fs::read_to_string(page).unwrap();
    let (_, section) = text.split_once("\n## Limits of the controller\n").unwrap();
    let (section, _) = section.split_once("\n## ").unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.map(|line| {
        let mut cells = line.split('|').skip(1).map(str::trim);
        std::array::from_fn(|_| cells.next().unwrap().trim_matches('`').to_owned())
    })
    .collect()
}

/// Is `value` what was written, to its last digit?
fn is_written(value: f64, written: &str) -> bool {
    let decimals = written.split_once('.').map_or(0, |(_, after)| after.len());
    let half = 0.501 * 10_f64.powi(-i32::try_from(decimals).unwrap());
    let written: f64 = written.parse().unwrap();
    (value - written).abs() <= half
}

#[test]
fn the_page_has_every_key_with_its_default_unit_and_limits() {
    let rows = rows();
    let fields = ControlSettings::FIELDS.iter();
    let fields: Vec<_> = fields
        .filter_map(|field| Some((field.key?, field)))
        .collect();
    let keys: Vec<&str> = fields.iter().map(|(key, _)| *key).collect();
    let written: Vec<&str> = rows.iter().map(|[key, ..]| key.as_str()).collect();
    assert_eq!(written, keys);
    for ([key, default, unit, limits], (_, field)) in rows.iter().zip(fields) {
        let value = field.get(&ControlSettings::default());
        let (value, expected) = match (field.file_unit, field.unit) {
            (FileUnit::Same, unit) => (value, unit.replace('^', "").replace("s2", "s²")),
            (_, "rad") => (value.to_degrees(), "°".to_owned()),
            _ => (value.to_degrees(), "°/s".to_owned()),
        };
        assert_eq!(*unit, expected, "{key}");
        assert!(is_written(value, default), "{key}: {value}, not {default}");
        let (low, high) = limits.split_once(", ").unwrap();
        let own = field.limits_in_file();
        assert!(
            is_written(own.0, low) && is_written(own.1, high),
            "{key}: {own:?}, not {limits}"
        );
    }
}
