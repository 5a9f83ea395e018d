//! Numbers in fields: finite ones, with a declared decimal mark, and times to the nanosecond.

use grouser_files::columns::TimeUnit;

use super::date;
use crate::error::NotANumber;

/// A finite number whose decimal mark is `decimal`; blanks around it are ignored.
///
/// ```
/// use grouser_log::csv::finite;
///
/// assert_eq!(finite(" 0,25", b','), Ok(0.25));
/// assert!(finite("nan", b'.').is_err());
/// ```
///
/// # Errors
/// [`NotANumber`] for anything else, NaN and infinities included.
pub fn finite(text: &str, decimal: u8) -> Result<f64, NotANumber> {
    let text = text.trim();
    let parsed = if decimal == b',' {
        if text.contains('.') {
            return Err(bad(Some("the column map says `decimal = \",\"`")));
        }
        text.replacen(',', ".", 1).parse::<f64>()
    } else {
        text.parse::<f64>()
    };
    match parsed {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(bad(Some(NO_VALUE))),
        Err(_) if text.contains(',') => Err(bad(Some(
            "a decimal comma is declared by `decimal = \",\"`; thousands may not be separated",
        ))),
        Err(_) => Err(bad(word_hint(text))),
    }
}

const NO_VALUE: &str = "if it means no value, list it under `missing` in the column map";

/// `None`, `null` and the like stand for no value.
fn word_hint(text: &str) -> Option<&'static str> {
    const WORDS: [&str; 8] = ["none", "null", "nil", "na", "n/a", "nan", "inf", "-"];
    let is_word = |word: &&str| text.eq_ignore_ascii_case(word);
    WORDS.iter().any(is_word).then_some(NO_VALUE)
}

const fn bad(hint: Option<&'static str>) -> NotANumber {
    NotANumber {
        expected: "a finite number",
        hint,
    }
}

/// A whole number that fits a 64-bit counter, signed or unsigned; signed ones are cast.
pub(crate) fn count(text: &str) -> Result<u64, NotANumber> {
    let text = text.trim();
    // Some loggers write whole numbers with a fraction of zeros.
    let digits = match text.split_once('.') {
        Some((digits, zeros)) if zeros.bytes().all(|b| b == b'0') => digits,
        _ => text,
    };
    digits
        .parse::<u64>()
        .or_else(|_| digits.parse::<i64>().map(i64::cast_unsigned))
        .map_err(|_| NotANumber {
            expected: "a whole number of at most 64 bits",
            hint: word_hint(text),
        })
}

/// A time by the unit of its column, ns.
pub(crate) fn time_ns(text: &str, decimal: u8, unit: TimeUnit) -> Result<i64, NotANumber> {
    match unit {
        TimeUnit::Nanoseconds(unit) => nanoseconds(text, decimal, unit),
        TimeUnit::Date => date::nanoseconds(text.trim()).ok_or(NotANumber {
            expected: "a date with a time such as 2026-03-02T09:15:30.25Z",
            hint: None,
        }),
    }
}

/// A time in two columns, ns: a date and the time of day.
pub(crate) fn time_of_two(day: &str, time: &str) -> Result<i64, NotANumber> {
    date::of_two(day.trim(), time.trim()).ok_or(NotANumber {
        expected: "a date next to a time of day, such as 2026-03-02 and 09:15:30.25",
        hint: None,
    })
}

/// A time in nanoseconds; `unit` is one of the field's unit in nanoseconds.
///
/// Plain decimals are exact, to the nanosecond below (a clock that counts nanoseconds from 1970 has
/// more digits than an f64 holds); others go through f64.
fn nanoseconds(text: &str, decimal: u8, unit: i64) -> Result<i64, NotANumber> {
    let text = text.trim();
    if let Some(time) = exact(text, decimal, unit) {
        return i64::try_from(time).map_err(|_| too_far());
    }
    let time = finite(text, decimal)? * unit as f64;
    // i64::MAX as a float is 2^63, the first that does not fit.
    if time.abs() < i64::MAX as f64 {
        #[allow(clippy::cast_possible_truncation, reason = "checked on the line above")]
        Ok(time.round() as i64)
    } else {
        Err(too_far())
    }
}

const fn too_far() -> NotANumber {
    NotANumber {
        expected: "a time within 292 years of its clock's zero",
        hint: Some("is its unit in the column map right?"),
    }
}

/// The time of a plain decimal; `None` for anything else.
fn exact(text: &str, decimal: u8, unit: i64) -> Option<i128> {
    let (negative, digits) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text.strip_prefix('+').unwrap_or(text)),
    };
    let mark = char::from(decimal);
    let (whole, fraction) = digits.split_once(mark).unwrap_or((digits, ""));
    let plain = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    if !plain(whole) || !plain(fraction) {
        return None;
    }
    let mut time = whole.parse::<i128>().ok()?.checked_mul(i128::from(unit))?;
    let mut scale = i128::from(unit);
    for digit in fraction.bytes() {
        if scale % 10 != 0 {
            break;
        }
        scale /= 10;
        time = time.checked_add(i128::from(digit - b'0') * scale)?;
    }
    Some(if negative { -time } else { time })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_to_the_nanosecond() {
        let ns = |text, unit| nanoseconds(text, b'.', unit).unwrap();
        assert_eq!(ns("1494527466140809171", 1), 1_494_527_466_140_809_171);
        assert_eq!(ns("39.0077", 1_000_000), 39_007_700);
        assert_eq!(ns("-0.5", 1_000_000_000), -500_000_000);
        assert_eq!(ns("1.0000000019", 1_000_000_000), 1_000_000_001);
        assert_eq!(ns("1e3", 1_000_000), 1_000_000_000);
        assert_eq!(ns("9223372036854775807", 1), i64::MAX);
        assert!(nanoseconds("9223372036854775808", b'.', 1).is_err());
        assert!(nanoseconds("1e300", b'.', 1).is_err());
        // 2^63 by way of a float
        assert!(nanoseconds("9223372036854775808e0", b'.', 1).is_err());
        assert_eq!(ns("-.5", 1_000_000_000), -500_000_000);
        assert_eq!(ns("0000000000000000000000000000000000000000000007", 1), 7);
        // 2^127 is beyond what is computed exactly
        for far in [
            "170141183460469231731687303715.884105727",
            "1e30",
            "99999999999999999999999999",
        ] {
            assert!(nanoseconds(far, b'.', 1_000_000_000).is_err(), "{far}");
        }
        assert_eq!(ns("+2", 1000), 2000);
        for bad in ["--5", "+-5", "-", "", "1.5.5"] {
            assert!(nanoseconds(bad, b'.', 1).is_err(), "{bad}");
        }
        assert_eq!(nanoseconds("0,25", b',', 1000).unwrap(), 250);
    }

    #[test]
    fn numbers_are_finite_and_counts_are_whole() {
        assert_eq!(finite(" -1.5e-3 ", b'.').unwrap(), -0.0015);
        assert_eq!(finite("1,5", b',').unwrap(), 1.5);
        for text in ["", "nan", "inf", "1e999", "1,5", "1,234.5", "0x10", "1_0"] {
            assert!(finite(text, b'.').is_err(), "{text}");
        }
        assert!(finite("1.5", b',').is_err());
        assert_eq!(count("-1").unwrap(), u64::MAX);
        assert_eq!(count("18446744073709551615").unwrap(), u64::MAX);
        assert_eq!(count("12.000").unwrap(), 12);
        assert!(count("12.5").is_err() && count("1e3").is_err() && count("").is_err());
    }
}
