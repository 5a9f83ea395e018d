//! The error of a number outside its limits, shared by all crates.

use core::fmt::{self, Debug, Display, Formatter};

/// A number lies outside its limits (NaN always does).
///
/// The message omits the unit of a pure number, and an upper limit of `f64::MAX`, which is none; where `-f64::MAX` is the
/// lower limit it asks for a finite number. `{:#}` puts the field's name in backticks.
///
/// ```
/// use grouser_real::OutOfRange;
///
/// let error = OutOfRange::<&str>::check("width", 200.0, (0.001, 100.0), "m").unwrap_err();
/// assert_eq!(error.to_string(), "width is 200 m, but must lie in [0.001, 100] m");
/// assert_eq!(error.named("width_m").to_string(), "width_m is 200 m, but must lie in [0.001, 100] m");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange<Field = &'static str> {
    /// The field's name.
    pub field: Field,
    /// The value that was given.
    pub value: f64,
    /// The minimum value allowed.
    pub low: f64,
    /// The maximum value allowed; `f64::MAX` where there is none.
    pub high: f64,
    /// The unit of all three; `1` for a pure number.
    pub unit: &'static str,
}

impl<Field> OutOfRange<Field> {
    /// Checks that `value` lies in [low, high].
    ///
    /// # Errors
    /// Itself, for a value outside and for NaN.
    ///
    /// ```
    /// use grouser_real::OutOfRange;
    ///
    /// assert!(OutOfRange::<&str>::check("slip", 1.0, (-1.0, 1.0), "1").is_ok());
    /// let error = OutOfRange::<String>::check("slip", f64::NAN, (-1.0, 1.0), "1").unwrap_err();
    /// assert_eq!(error.to_string(), "slip is NaN, but must lie in [-1, 1]");
    /// ```
    pub fn check(
        field: impl Into<Field>,
        value: f64,
        (low, high): (f64, f64),
        unit: &'static str,
    ) -> Result<(), Self> {
        if value >= low && value <= high {
            return Ok(());
        }
        Err(Self {
            field: field.into(),
            value,
            low,
            high,
            unit,
        })
    }

    /// The same number under another name, such as a column's or a flag's.
    ///
    /// ```
    /// use grouser_real::OutOfRange;
    ///
    /// let error = OutOfRange::<&str>::check("slip", 2.0, (-1.0, 1.0), "1").unwrap_err();
    /// assert_eq!(format!("{:#}", error.named("--slip")), "`--slip` is 2, but must lie in [-1, 1]");
    /// ```
    pub fn named<Other>(self, field: Other) -> OutOfRange<Other> {
        OutOfRange {
            field,
            value: self.value,
            low: self.low,
            high: self.high,
            unit: self.unit,
        }
    }
}

/// A number without hundreds of zeros.
struct Plain(f64);

impl Display for Plain {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size < 1e-6 && size > 0.0 || size >= 1e15 && size.is_finite() {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

impl<Field: Display> Display for OutOfRange<Field> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let quote = if f.alternate() { "`" } else { "" };
        let (space, unit) = match self.unit {
            "" | "1" => ("", ""),
            unit => (" ", unit),
        };
        write!(
            f,
            "{quote}{}{quote} is {}{space}{unit}, but must ",
            self.field,
            Plain(self.value)
        )?;
        let [low, high] = [self.low, self.high].map(Plain);
        if self.low <= f64::MIN && self.high >= f64::MAX {
            let finite = if self.low.is_finite() { "finite " } else { "" };
            write!(f, "be a {finite}number")
        } else if self.high >= f64::MAX {
            write!(f, "be at least {low}{space}{unit}")
        } else {
            write!(f, "lie in [{low}, {high}]{space}{unit}")
        }
    }
}

impl<Field: Debug + Display> core::error::Error for OutOfRange<Field> {}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::{format, string::ToString};

    use super::*;

    fn check(value: f64, limits: (f64, f64)) -> Result<(), OutOfRange<&'static str>> {
        OutOfRange::check("load", value, limits, "N")
    }

    #[test]
    fn numbers_of_many_digits_have_an_exponent() {
        for (number, text) in [
            (1e-6, "0.000001"),
            (9.5e-7, "9.5e-7"),
            (-1e-7, "-1e-7"),
            (0.0, "0"),
            (-1e15_f64.next_down(), "-999999999999999.9"),
            (1e15, "1e15"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Plain(number).to_string(), text);
        }
    }

    #[test]
    fn limits_belong_to_the_range_and_nan_does_not() {
        for value in [-1.0, 0.0, 2.0] {
            assert!(check(value, (-1.0, 2.0)).is_ok(), "{value}");
        }
        for value in [
            (-1.0_f64).next_down(),
            2.0_f64.next_up(),
            f64::NAN,
            f64::INFINITY,
        ] {
            let error = check(value, (-1.0, 2.0)).expect_err("outside");
            assert_eq!(error.value.to_bits(), value.to_bits());
            assert_eq!((error.low, error.high), (-1.0, 2.0));
        }
        assert!(
            check(1.0, (2.0, 0.0)).is_err(),
            "an empty range holds nothing"
        );
    }

    #[test]
    fn a_message_has_value_limits_and_unit() {
        let both = check(3.0, (-1.0, 2.0)).expect_err("outside");
        assert_eq!(both.to_string(), "load is 3 N, but must lie in [-1, 2] N");
        assert_eq!(
            format!("{both:#}"),
            "`load` is 3 N, but must lie in [-1, 2] N"
        );
        let least = check(-3.0, (0.5, f64::MAX)).expect_err("outside");
        assert_eq!(
            least.to_string(),
            "load is -3 N, but must be at least 0.5 N"
        );
        for (value, low, message) in [
            (
                f64::INFINITY,
                f64::MIN,
                "load is inf N, but must be a finite number",
            ),
            (
                f64::NAN,
                f64::MIN,
                "load is NaN N, but must be a finite number",
            ),
            (
                f64::NAN,
                f64::NEG_INFINITY,
                "load is NaN N, but must be a number",
            ),
        ] {
            let error = check(value, (low, -low)).expect_err("outside");
            assert_eq!(error.to_string(), message);
        }
        let below = OutOfRange::<&str>::check("share", 3.0, (0.0, 1.0), "1").expect_err("outside");
        assert_eq!(below.to_string(), "share is 3, but must lie in [0, 1]");
        let huge = check(1e308, (f64::MIN_POSITIVE, 1e18)).expect_err("outside");
        assert_eq!(
            huge.to_string(),
            "load is 1e308 N, but must lie in [2.2250738585072014e-308, 1e18] N"
        );
    }
}
