//! The file of a unit.

use grouser_fmu::{Error, Model, package};
use grouser_terra::{RigidWheel, catalogue};

fn model() -> Model {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    Model::new(RigidWheel::new(0.125, 0.1).unwrap(), soil, [80.0, 0.2, 0.0]).unwrap()
}

#[test]
fn the_same_model_has_the_same_bytes() {
    let soil = ("sand \"<&>\"", "a source");
    let unit = package(&model(), "wheel", soil, b"library").unwrap();
    assert_eq!(unit, package(&model(), "wheel", soil, b"library").unwrap());
    // entries are stored, so that their text is in the file
    let text = String::from_utf8_lossy(&unit);
    assert!(text.contains("on sand &quot;&lt;&amp;&gt;&quot;"));
    assert!(text.contains("name=\"slip\" valueReference=\"2\" causality=\"input\" start=\"0.2\""));
}

#[test]
fn names_that_are_no_identifiers_are_refused() {
    for name in ["", "2wheels", "a-b", "é"] {
        let refused = package(&model(), name, ("sand", ""), b"library");
        assert!(matches!(refused, Err(Error::Name { .. })), "{name}");
    }
}
