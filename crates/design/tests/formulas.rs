//! The grammar of formulas, against values worked out by hand or by the standard library.

use grouser_design::{DEPTH_LIMIT, Formula, FormulaError, VariableNames};
use grouser_real::Dual;
use proptest::prelude::*;

fn names() -> VariableNames {
    VariableNames::new(["x", "y", "x1"])
}

fn value(text: &str) -> f64 {
    let formula = Formula::parse(text, &names()).unwrap_or_else(|e| panic!("{text}: {e}"));
    formula.evaluate(&[3.0, -2.0, 0.5])
}

fn refused(text: &str) -> FormulaError {
    match Formula::parse(text, &names()) {
        Ok(formula) => panic!("{text} was read as {formula:?}"),
        Err(error) => error,
    }
}

#[test]
fn precedence_and_association() {
    for (text, expected) in [
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("2 - 3 - 4", -5.0),
        ("24/4/3", 2.0),
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("-x^2", -9.0),
        ("(-x)^2", 9.0),
        ("x^-1", 1.0 / 3.0),
        ("2^-x", 0.125),
        ("2^-x^2", 2.0_f64.powi(-9)),
        ("-2^-2", -0.25),
        ("2*-3", -6.0),
        ("2 - -3", 5.0),
        ("--x", 3.0),
        ("+x - +y", 5.0),
        ("-x*y", 6.0),
        ("6/-x", -2.0),
        ("-x + y", -5.0),
        ("y^3", -8.0),
        ("2^0.5", std::f64::consts::SQRT_2),
        ("x^x1", 3.0_f64.sqrt()),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn numbers() {
    for (text, expected) in [
        ("1e-8", 1e-8),
        ("1E3", 1000.0),
        ("2.5e+2", 250.0),
        (".5", 0.5),
        ("2.", 2.0),
        ("1e308", 1e308),
        ("0.1", 0.1),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert!(matches!(
        refused("1e999"),
        FormulaError::NumberTooLarge { column: 1, .. }
    ));
    assert!(matches!(
        refused("1 + ."),
        FormulaError::Character { column: 5, .. }
    ));
    // An exponent without digits is no exponent: a name follows a number.
    assert!(matches!(
        refused("2e"),
        FormulaError::Unexpected { column: 2, .. }
    ));
}

#[test]
fn functions_and_constants() {
    for (text, expected) in [
        ("exp(1)", std::f64::consts::E),
        ("ln(2)", std::f64::consts::LN_2),
        ("log10(1000)", 3.0),
        ("log10(1e-5)", -5.0),
        ("sqrt(2)", std::f64::consts::SQRT_2),
        ("abs(y)", 2.0),
        ("sin(1)", 1.0_f64.sin()),
        ("cos(1)", 1.0_f64.cos()),
        ("tan(1)", 1.0_f64.tan()),
        ("asin(x1)", 0.5_f64.asin()),
        ("acos(x1)", 0.5_f64.acos()),
        ("atan(x1)", 0.5_f64.atan()),
        ("sinh(1)", 1.0_f64.sinh()),
        ("cosh(1)", 1.0_f64.cosh()),
        ("tanh(1)", 1.0_f64.tanh()),
        ("min(x, y)", -2.0),
        ("max(x, y, 7, -1)", 7.0),
        ("atan2(1, -1)", 0.75 * std::f64::consts::PI),
        ("pow(2, 10)", 1024.0),
        ("2*pi", std::f64::consts::TAU),
        ("max(min(x, 1), sqrt(4)) + 1", 3.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    assert!(value("ln(y)").is_nan());
    assert!(value("max(ln(y), 1)").is_nan());
    assert!(value("min(1, ln(y))").is_nan());
}

#[test]
fn mistakes_have_columns() {
    for (text, column) in [
        ("", 1),
        ("   ", 4),
        ("1 +", 4),
        ("1 2", 3),
        ("x y", 3),
        ("(1 + 2", 1),
        ("1 + 2)", 6),
        ("()", 2),
        ("sin()", 5),
        ("sin(1, 2)", 1),
        ("min(1)", 1),
        ("atan2(1, 2, 3)", 1),
        ("1, 2", 2),
        ("* 2", 1),
        ("2 ** 3", 4),
        ("x + X", 5),
        ("x & y", 3),
        ("x + zz", 5),
        ("3 + sine(x)", 5),
        ("x <= 3", 3),
        ("x < 3", 3),
        ("é + 1", 1),
        ("x + é", 5),
        ("sin x", 1),
    ] {
        let message = refused(text).to_string();
        assert!(
            message.starts_with(&format!("column {column}:")),
            "`{text}`: {message}"
        );
    }
    assert_eq!(refused("sine(x)").hint().unwrap(), "did you mean `sin`?");
    assert!(refused("X1").hint().unwrap().contains("small letters"));
}

#[test]
fn nesting_is_limited_and_length_is_not() {
    let nested = |depth: usize| format!("{}x{}", "(".repeat(depth), ")".repeat(depth));
    assert_eq!(value(&nested(DEPTH_LIMIT)), 3.0);
    let error = refused(&nested(DEPTH_LIMIT + 1));
    assert_eq!(
        error,
        FormulaError::TooDeep {
            column: DEPTH_LIMIT + 1,
            limit: 200
        }
    );
    assert!(matches!(
        refused(&nested(500_000)),
        FormulaError::TooDeep { .. }
    ));
    let calls = "abs(".repeat(200) + "y" + &")".repeat(200);
    assert_eq!(value(&calls), 2.0);
    // 64 KiB and more, of every shape that could recurse.
    assert_eq!(value(&format!("x{}", "+x".repeat(40_000))), 3.0 * 40_001.0);
    assert_eq!(value(&format!("{}x", "-".repeat(100_000))), 3.0);
    assert_eq!(value(&format!("1{}", "^1".repeat(40_000))), 1.0);
    assert_eq!(value(&format!("max(0{})", ",x".repeat(40_000))), 3.0);
    assert!(matches!(
        refused(&"(".repeat(100_000)),
        FormulaError::TooDeep { column: 201, .. }
    ));
}

#[test]
fn derivatives_are_exact() {
    // d/dx of x³ e^(−x) |y| at (3, −2).
    let formula = Formula::parse("x^3*exp(-x)*abs(y)", &names()).unwrap();
    let at = formula.evaluate(&[
        Dual::<2>::variable(3.0, 0),
        Dual::variable(-2.0, 1),
        Dual::constant(0.5),
    ]);
    let e = (-3.0_f64).exp();
    assert!((at.gradient[0] - 2.0 * e * (27.0 - 27.0)).abs() < 1e-12);
    assert!((at.gradient[1] + 27.0 * e).abs() < 1e-12);
    let log = Formula::parse("log10(x)", &names()).unwrap();
    let at = log.evaluate(&[Dual::<1>::variable(1000.0, 0), Dual::constant(0.0)]);
    assert_eq!(at.value, 3.0);
    assert!((at.gradient[0] - 1e-3 / std::f64::consts::LN_10).abs() < 1e-18);
}

/// A random formula as text with its value, built side by side.
fn tree() -> impl Strategy<Value = (String, f64)> {
    let leaf = prop_oneof![
        (-9_i32..10).prop_map(|k| if k < 0 {
            (format!("({k})"), f64::from(k))
        } else {
            (k.to_string(), f64::from(k))
        }),
        Just(("x".to_owned(), 3.0)),
        Just(("y".to_owned(), -2.0)),
    ];
    leaf.prop_recursive(6, 64, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone())
                .prop_map(|(a, b)| (format!("({} + {})", a.0, b.0), a.1 + b.1)),
            (inner.clone(), inner.clone())
                .prop_map(|(a, b)| (format!("({}-{})", a.0, b.0), a.1 - b.1)),
            (inner.clone(), inner.clone())
                .prop_map(|(a, b)| (format!("({}*{})", a.0, b.0), a.1 * b.1)),
            (inner.clone(), inner.clone())
                .prop_map(|(a, b)| (format!("({} / {})", a.0, b.0), a.1 / b.1)),
            inner.clone().prop_map(|a| (format!("(-{})", a.0), -a.1)),
            inner
                .clone()
                .prop_map(|a| (format!("sin({})", a.0), a.1.sin())),
            (inner.clone(), inner).prop_map(|(a, b)| (
                format!("max({}, {})", a.0, b.0),
                if a.1.is_nan() || b.1.is_nan() {
                    f64::NAN
                } else {
                    a.1.max(b.1)
                }
            )),
        ]
    })
}

proptest! {
    #[test]
    fn parsing_agrees_with_building((text, expected) in tree()) {
        let got = value(&text);
        prop_assert!(got == expected || (got.is_nan() && expected.is_nan()), "{}: {} {}", text, got, expected);
    }

    #[test]
    fn no_text_panics(text in "[-+*/^(),.0-9a-z_<>=éX \t]{0,60}") {
        if let Ok(formula) = Formula::parse(&text, &names()) {
            let _: f64 = formula.evaluate(&[1.0, 2.0, 3.0]);
        }
    }
}
