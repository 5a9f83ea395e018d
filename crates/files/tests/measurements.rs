//! Every kind of measurement is in Python's stubs and has a column, or a reason why it has none, and every column a line in
//! the documentation.

use grouser_files::columns::Meaning;
use grouser_slip::{MeasurementKind, MeasurementPart};

#[test]
fn every_kind_has_a_column_or_a_reason() {
    for kind in MeasurementKind::ALL {
        let has_column = Meaning::ALL
            .iter()
            .any(|(_, meaning, _)| meaning.kind() == *kind);
        let reason = match kind {
            MeasurementKind::Carrier => Some("it follows from the angles of the joints"),
            MeasurementKind::MotorCurrent => {
                Some("a current is a torque once the robot file has its factor")
            }
            _ => None,
        };
        assert_eq!(has_column, reason.is_none(), "{}", kind.name());
    }
}

#[test]
fn every_kind_is_in_the_stubs_of_python() {
    let stubs = include_str!("../../../python/python/grouser/_core.pyi");
    let stubs: String = stubs.split_whitespace().collect();
    for kind in MeasurementKind::ALL {
        let mut wanted = format!("def{}(*,time_ns:int", kind.name().replace('-', "_"));
        if kind.is_of_a_wheel() {
            wanted += ",wheel:int";
        }
        for field in kind.fields() {
            let annotation = match field.part {
                MeasurementPart::Index | MeasurementPart::Count => "int",
                MeasurementPart::Number => "float",
                MeasurementPart::YesOrNo => "bool",
                MeasurementPart::OptionalNumber => "float|None=None",
                MeasurementPart::Vector => "Sequence[float]",
            };
            wanted = wanted + "," + field.key + ":" + annotation;
        }
        wanted += ")->Sample:...";
        assert!(stubs.contains(&wanted), "{wanted}");
    }
}

#[test]
fn every_column_is_in_the_documentation_with_its_units() {
    let page = include_str!("../../../docs/estimate.md");
    for (name, _, quantity) in Meaning::ALL {
        let mut rows = page.lines().filter(|line| line.starts_with('|'));
        let row = rows.find(|row| row.contains(&format!("`{name}`")));
        let row = row.unwrap_or_else(|| panic!("{name} has no row"));
        let units = quantity.units().into_iter().map(|(unit, _)| unit);
        // the unit in which receivers state latitudes is one of all angles
        for unit in units.filter(|unit| *unit != "1e-7 deg") {
            assert!(row.contains(&format!("`{unit}`")), "{name}: {unit}: {row}");
        }
    }
}
