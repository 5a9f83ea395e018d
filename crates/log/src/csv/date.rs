//! Dates with a time of day (ISO 8601, RFC 3339) as nanoseconds since 1970.

const DAY_S: i64 = 86_400;

/// `2026-03-02T09:15:30.25Z`, `2026-03-02 09:15:30+01:00`; without a zone it is UTC. Also `2026/03/02/09:15:30.25` and
/// `2026_03_02_09_15_30_250`. `None` for anything else.
pub(super) fn nanoseconds(text: &str) -> Option<i64> {
    match text.as_bytes().get(4) {
        Some(mark @ (b'/' | b'_' | b'.')) => of_iso(&iso(text, char::from(*mark))?),
        _ => of_iso(text),
    }
}

/// A date and a time of day that stand in two columns.
pub(super) fn of_two(day: &str, time: &str) -> Option<i64> {
    let is_bare = |text: &str, length: usize| text.len() >= length && !text.contains(['T', ' ']);
    (day.len() == 10 && is_bare(time, 5)).then(|| nanoseconds(&format!("{day} {time}")))?
}

/// The same in the form of ISO 8601.
fn iso(text: &str, mark: char) -> Option<String> {
    let (day, rest) = text.split_at_checked(10)?;
    let (between, time) = rest.split_at_checked(1)?;
    let is_known = between.starts_with([mark, 'T', 't', ' ', '/', '-']);
    let time = if mark == '_' {
        time.replacen('_', ":", 2).replacen('_', ".", 1)
    } else {
        time.to_owned()
    };
    let is_known = is_known && day.get(7..8) == day.get(4..5);
    is_known.then(|| format!("{}T{time}", day.replace(mark, "-")))
}

fn of_iso(text: &str) -> Option<i64> {
    let (day, rest) = text.split_at_checked(10)?;
    let mut parts = day.split('-');
    let (year, month, date) = (
        number(parts.next()?, 4)?,
        number(parts.next()?, 2)?,
        number(parts.next()?, 2)?,
    );
    let rest = rest.strip_prefix(['T', 't', ' '])?;
    let zone_at = rest.find(['Z', 'z', '+', '-']).unwrap_or(rest.len());
    let (time, zone) = rest.split_at(zone_at);
    let mut parts = time.split(':');
    let (hour, minute) = (number(parts.next()?, 2)?, number(parts.next()?, 2)?);
    let (whole, fraction) = parts.next().map_or(Some((0, 0)), seconds)?;
    let valid = (1..=12).contains(&month)
        && (1..=31).contains(&date)
        && hour < 24
        && minute < 60
        && whole <= 60
        && parts.next().is_none();
    if !valid {
        return None;
    }
    let s = days(year, month, date) * DAY_S + hour * 3600 + minute * 60 + whole - offset_s(zone)?;
    s.checked_mul(1_000_000_000)?.checked_add(fraction)
}

fn number(text: &str, digits: usize) -> Option<i64> {
    let plain = text.len() == digits && text.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| text.parse().ok()).flatten()
}

/// Whole seconds, and the nanoseconds behind the point.
fn seconds(text: &str) -> Option<(i64, i64)> {
    let (whole, fraction) = text.split_once(['.', ',']).unwrap_or((text, "0"));
    let plain = !fraction.is_empty() && fraction.bytes().all(|byte| byte.is_ascii_digit());
    let nine: String = fraction
        .chars()
        .chain(std::iter::repeat('0'))
        .take(9)
        .collect();
    Some((
        number(whole, 2)?,
        plain.then(|| nine.parse().ok()).flatten()?,
    ))
}

/// How far a zone is ahead of UTC, s.
fn offset_s(zone: &str) -> Option<i64> {
    let (sign, digits) = match zone.chars().next() {
        None | Some('Z' | 'z') if zone.len() <= 1 => return Some(0),
        Some('+') => (1, &zone[1..]),
        Some('-') => (-1, &zone[1..]),
        _ => return None,
    };
    let digits = digits.replace(':', "");
    let (hours, minutes) = match digits.len() {
        2 => (digits.as_str(), "00"),
        4 => digits.split_at(2),
        _ => return None,
    };
    Some(sign * (number(hours, 2)? * 3600 + number(minutes, 2)? * 60))
}

/// Days since 1970-01-01 in the Gregorian calendar (Fliegel and Van Flandern 1968, shifted).
const fn days(year: i64, month: i64, date: i64) -> i64 {
    let a = (month - 14) / 12;
    let julian = (1461 * (year + 4800 + a)) / 4 + (367 * (month - 2 - 12 * a)) / 12
        - (3 * ((year + 4900 + a) / 100)) / 4
        + date
        - 32_075;
    julian - 2_440_588
}

#[cfg(test)]
mod tests {
    use super::{days, nanoseconds, of_two};

    /// What every day of seven centuries is by counting them.
    #[test]
    fn days_are_counted_by_the_calendar() {
        let is_leap = |year: i64| year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let mut day = days(1970, 1, 1);
        assert_eq!(day, 0);
        for year in (1970..2420).chain(1600..1970) {
            if year == 1600 {
                // 370 years with 90 leap years
                day = -(370 * 365 + 90);
            }
            let february = if is_leap(year) { 29 } else { 28 };
            let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
            for (month, length) in (1..).zip(lengths) {
                for date in 1..=length {
                    assert_eq!(days(year, month, date), day, "{year}-{month}-{date}");
                    day += 1;
                }
            }
        }
        assert_eq!(day, 0);
    }

    #[test]
    fn zones_fractions_and_limits() {
        for (text, expected_ms) in [
            ("1970-01-02t01:02:03z", 90_123_000),
            ("1970-01-02 01:02:03", 90_123_000),
            ("1970-01-02T01:02", 90_120_000),
            ("1970-01-02T01:02Z", 90_120_000),
            ("1970-01-02T01:02:03+05:30", 70_323_000),
            ("1970-01-02T01:02:03+0530", 70_323_000),
            ("1970-01-02T01:02:03-08", 118_923_000),
            ("1970-01-02T01:02:03.25", 90_123_250),
            ("1970-01-02T01:02:03,25-01:00", 93_723_250),
            ("1970-01-01T23:59:60Z", 86_400_000),
            ("1970-12-31T00:00:00Z", 31_449_600_000),
        ] {
            assert_eq!(nanoseconds(text), Some(expected_ms * 1_000_000), "{text}");
        }
        // what is below a nanosecond is left out
        let long = nanoseconds("1970-01-01T00:00:01.1234567899");
        assert_eq!(long, Some(1_123_456_789));
        let last = nanoseconds("2262-04-11T23:47:16.854775807Z");
        assert_eq!(last, Some(i64::MAX));
        for bad in [
            "2262-04-11T23:47:16.854775808Z",
            "9999-12-31T23:59:59Z",
            "2024-00-01T00:00:00Z",
            "2024-01-00T00:00:00Z",
            "2024-01-32T00:00:00Z",
            "2024-01-01T24:00:00Z",
            "2024-01-01T00:60:00Z",
            "2024-01-01T00:00:61Z",
            "2024-01-01T00:00:00:00Z",
            "2024-01-01T00:00:00.Z",
            "2024-01-01T00:00:00.5xZ",
            "2024-01-01T00:00:0.5Z",
            "2024-01-01T00:00:00ZZ",
            "2024-01-01T00:00:00+",
            "2024-01-01T00:00:00+01000",
            "2024-01-01T00:00:00+0x",
            "2024-+1-01T00:00:00Z",
            "02024-1-1T00:00:00Z",
            "2024-01-01_00:00:00Z",
        ] {
            assert_eq!(nanoseconds(bad), None, "{bad}");
        }
    }

    #[test]
    fn dates_in_other_forms_are_read() {
        let right = nanoseconds("2026-03-02T09:15:30.25Z");
        for text in [
            "2026/03/02/09:15:30.25",
            "2026/03/02 09:15:30.25",
            "2026_03_02_09_15_30_250",
            "2026.03.02 09:15:30.25",
        ] {
            assert_eq!(nanoseconds(text), right, "{text}");
        }
        assert_eq!(of_two("2026-03-02", "09:15:30.25"), right);
        assert_eq!(of_two("2026/03/02", "09:15:30.25"), right);
        for bad in [
            "2026/03/02",
            "2026/03-02/09:15",
            "2026_03_02_09",
            "2026.03.02",
        ] {
            assert_eq!(nanoseconds(bad), None, "{bad}");
        }
        assert_eq!(of_two("0.25000000", "0.5"), None);
    }

    #[test]
    fn dates_are_exact_to_the_nanosecond() {
        assert_eq!(nanoseconds("1970-01-01T00:00:00Z"), Some(0));
        assert_eq!(
            nanoseconds("2012-09-01 00:00:00"),
            Some(1_346_457_600_000_000_000)
        );
        assert_eq!(
            nanoseconds("2024-02-29T12:30:15.000000001+01:00"),
            Some(1_709_206_215_000_000_001)
        );
        assert_eq!(nanoseconds("1969-12-31T23:59:59.5Z"), Some(-500_000_000));
        for bad in [
            "2024-13-01T00:00:00Z",
            "2024-01-01",
            "2024-01-01T25:00:00Z",
            "yesterday",
            "2024-01-01T00:00:00+1",
            "",
        ] {
            assert_eq!(nanoseconds(bad), None, "{bad}");
        }
    }
}
