//! Numbers in and out as text.

use crate::layout::Layout;

/// A flag's value: any finite number, signed, with or without an exponent.
#[inline]
pub fn parse_finite(text: &str) -> Result<f64, String> {
    if let Some(value) = parse_plain(text) {
        return Ok(value);
    }
    // a minus sign as figures write it
    match text.replace('\u{2212}', "-").parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("must be a finite number".to_owned()),
    }
}

/// A decimal without sign and exponent, as most fields of a table are; `None` for any other text.
///
/// A float holds the digits and the power of ten exactly, so that their quotient has the bits of the nearest float
/// (W. D. Clinger, "How to read floating point numbers accurately", 1990).
#[must_use]
#[inline]
pub fn parse_plain(text: &str) -> Option<f64> {
    /// A point and fifteen digits, or sixteen digits.
    const MAX_BYTES: usize = 16;
    /// Integers up to here are floats.
    const MAX_DIGITS: u64 = 1 << f64::MANTISSA_DIGITS;
    const POWERS: [f64; MAX_BYTES] = [
        1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
    ];
    if text.len() > MAX_BYTES {
        return None;
    }
    let (mut digits, mut point) = (0_u64, None);
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'0'..=b'9' => digits = digits * 10 + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(at),
            _ => return None,
        }
    }
    let places = point.map_or(0, |point| text.len() - 1 - point);
    let has_digits = text.len() > usize::from(point.is_some());
    (has_digits && digits <= MAX_DIGITS).then(|| digits as f64 / POWERS[places])
}

/// As few digits as give the same bits again when read: for tables.
#[must_use]
pub fn exact(value: f64) -> String {
    let mut text = String::new();
    push_exact(&mut text, value);
    text
}

/// Appends [`exact`] to a text, without a text of its own.
#[inline]
pub fn push_exact(text: &mut String, value: f64) {
    let mut buffer = zmij::Buffer::new();
    let digits = buffer.format(value);
    text.push_str(digits.strip_suffix(".0").unwrap_or(digits));
}

/// As few digits as give the same bits again when read.
#[must_use]
pub fn short(value: f64) -> String {
    let (fixed, scientific) = (format!("{value}"), format!("{value:e}"));
    if fixed.len() <= scientific.len() + 4 {
        fixed
    } else {
        scientific
    }
}

/// A number in a message: as it was given, to twelve digits.
#[must_use]
pub fn in_message(value: f64) -> String {
    general(value, 12)
}

/// A number for people: with the significant digits of the [`Layout`], and all digits before the point.
#[must_use]
pub fn shown(value: f64) -> String {
    /// Integers below this are printed as they are.
    const MAX_WHOLE: f64 = 1e6;
    let digits = Layout::current().digits;
    if value.abs() >= 10_f64.powi(i32::try_from(digits).unwrap_or(i32::MAX))
        && value.abs() < MAX_WHOLE
    {
        return format!("{value:.0}");
    }
    rounded(value, digits)
}

/// A number with this many significant digits.
#[must_use]
pub fn rounded(value: f64, digits: usize) -> String {
    general(value, digits)
}

/// C's `%.{digits}g`: the shorter of fixed and scientific notation, without trailing zeros.
fn general(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let digits = digits.max(1);
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific; // never: the format has an exponent
    };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    // The rounded value's exponent decides, as in C.
    let places = i32::try_from(digits).unwrap_or(i32::MAX) - 1 - exponent;
    if exponent < -4 || places < 0 {
        let sign = if exponent < 0 { '-' } else { '+' };
        format!("{}e{sign}{:02}", trimmed(mantissa), exponent.abs())
    } else {
        let places = usize::try_from(places).unwrap_or(0);
        trimmed(&format!("{value:.places$}")).to_owned()
    }
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_few_digits_as_read_the_same() {
        for (value, text) in [
            (0.1, "0.1"),
            (0.5, "0.5"),
            (10060.0, "10060"),
            (0.0, "0"),
            (-162.142_260_266_540_43, "-162.14226026654043"),
            (1e-5, "0.00001"),
            (1e-7, "1e-7"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e22, "1e+22"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(exact(value), text);
        }
        let mut value = 1.0_f64;
        for _ in 0..2000 {
            value = -value * 1.377;
            assert_eq!(
                exact(value).parse::<f64>().unwrap().to_bits(),
                value.to_bits()
            );
            assert_eq!(exact(1.0 / value).parse::<f64>().unwrap(), 1.0 / value);
        }
    }

    #[test]
    fn people_get_three_digits() {
        assert_eq!(shown(-20.837_393_323_407_97), "-20.8");
        assert_eq!(shown(99_999.6), "100000");
        assert_eq!(shown(1234.5), "1234");
        assert_eq!(shown(1.2e7), "1.2e+07");
        assert_eq!(shown(0.02), "0.02");
    }

    #[test]
    fn plain_decimals_have_the_bits_of_the_standard_parser() {
        let pick = |bits: u64, count: usize| usize::try_from(bits).unwrap() % count;
        let mut state = 2012_u64;
        let mut plain = 0;
        for round in 0..200_000 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let length = 1 + pick(state >> 33, 17);
            let digits = format!("{:017}", (state >> 7) % 100_000_000_000_000_000);
            let mut text = digits[17 - length..].to_owned();
            if round % 4 > 0 {
                text.insert(pick(state >> 41, length + 1), '.');
            }
            if let Some(value) = parse_plain(&text) {
                plain += 1;
                assert_eq!(
                    value.to_bits(),
                    text.parse::<f64>().unwrap().to_bits(),
                    "{text}"
                );
            }
        }
        assert!(plain > 150_000, "{plain}");
        for (text, value) in [
            ("9007199254740992", Some(9_007_199_254_740_992.0)),
            ("9007199254740993", None),
            (".000000000000001", Some(1e-15)),
            ("5.", Some(5.0)),
            ("", None),
            (".", None),
            ("1.2.3", None),
            ("-1", None),
            ("1e3", None),
        ] {
            assert_eq!(parse_plain(text), value, "{text}");
        }
    }

    #[test]
    fn only_finite_numbers_are_read() {
        assert_eq!(parse_finite("-0.3"), Ok(-0.3));
        assert_eq!(parse_finite(&shown(-0.3)), Ok(-0.3));
        for text in ["nan", "inf", "-inf", "1e400", "", "0,5", "0x10"] {
            assert!(parse_finite(text).is_err(), "{text}");
        }
    }
}
