//! A problem file never returns less than the best feasible point that was evaluated.

use grouser_design::{Answer, parse};
use grouser_files::Document;

/// The start has 0.1; the optimum 0 is a kink, at which a step of a search cannot tell that it is one.
const KINK_IS_BEST: &str = r#"
format = 1
method = "minimax"
[variables]
x = { start = -0.9, lower = -4.0, upper = 5.0 }
[objectives]
f = "min(abs(x + 1), (x - 2)^2 + 0.5)"
"#;

#[test]
fn a_kink_that_is_the_optimum_is_found() {
    for starts in ["", "starts = 5\n"] {
        let text = format!("{starts}{KINK_IS_BEST}");
        let design = parse(&Document::from_text("kink.toml", text).unwrap()).unwrap();
        let Answer::Optimum(found) = design.solve().unwrap() else {
            panic!("not an optimum");
        };
        println!("{starts}: {found:?}");
        assert!(
            found.utility < 1e-6 && (found.x[0] + 1.0).abs() < 1e-6,
            "{found:?}"
        );
    }
}
