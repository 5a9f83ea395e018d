//! What is written by hand in Python and on the page names all that is declared here.

use grouser_terra::{LoadSolution, LugPassage, SolveStatus};

#[test]
fn every_field_is_in_the_list_of_keys_and_in_the_stubs_of_python() {
    let keys = include_str!("../../cli/tests/result_keys.json");
    let stubs = include_str!("../../../python/python/grouser/_core.pyi");
    let (_, point) = stubs.split_once("\nclass OperatingPoint:").unwrap();
    let point = point.split("\nclass ").next().unwrap();
    let fields = LoadSolution::FIELDS.iter().map(|field| field.key);
    for key in fields.chain(LugPassage::FIELDS.iter().map(|field| field.key)) {
        let is_listed = keys.contains(&format!("\"{key}\""));
        assert!(is_listed, "{key} is not in result_keys.json");
        let is_typed = point.contains(&format!("def {key}(self) -> "));
        assert!(is_typed, "{key} is not in _core.pyi");
    }
}

#[test]
fn every_status_has_words_in_python_and_on_the_page() {
    let python = include_str!("../../../python/python/grouser/wheel.py");
    let page = include_str!("../../page/web/explore.js");
    for status in SolveStatus::ALL {
        let (key, row) = (status.key(), format!("\n{}        ", status.code()));
        assert!(python.contains(&row), "{key} has no row in wheel.py");
        // one is shown by its numbers, the other is an error of the request
        let is_silent = [SolveStatus::Solved, SolveStatus::BadInput].contains(&status);
        let is_shown = page.contains(&format!("'{key}'"));
        assert!(is_silent || is_shown, "{key} has no words in explore.js");
    }
}
