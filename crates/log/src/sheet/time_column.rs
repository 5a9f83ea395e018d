//! Which column is the time, and in what unit.

use super::SheetColumn;
use super::words::words;

/// How likely a column of that name is the time, 0 the most.
pub(super) fn time_rank(name: &str) -> Option<u8> {
    let words = words(name);
    let is = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    if is(&["stamp"]) && !is(&["sec", "nsec", "nanosec", "secs", "nsecs"]) {
        Some(0)
    } else if is(&["time", "timestamp", "timestamps", "datetime", "zeit", "utc"])
        && !is(&["dt", "delta"])
    {
        Some(1)
    } else if matches!(words.as_slice(), [one] if one == "t" || is_time_unit(one))
        || matches!(words.as_slice(), [one, unit] if one == "t" && is_time_unit(unit))
    {
        Some(2)
    } else {
        None
    }
}

/// The columns of the seconds and of the nanoseconds beyond them, as ROS divides a time: `sec` and `nanosec`, say.
pub(super) fn seconds_and_nanoseconds(names: &[String]) -> Option<(usize, usize)> {
    let ends_with = |name: &str, wanted: &[&str]| {
        let mut words = words(name);
        let last = words.pop().filter(|last| wanted.contains(&last.as_str()));
        last.map(|_| words)
    };
    let all = |wanted: &'static [&'static str]| {
        let ending = move |(index, name): (usize, &String)| Some((index, ends_with(name, wanted)?));
        names.iter().enumerate().filter_map(ending)
    };
    all(&["sec", "secs"]).find_map(|(seconds, of)| {
        let mut beyond = all(&["nanosec", "nanosecs", "nsec", "nsecs"]);
        Some((seconds, beyond.find(|(_, other)| *other == of)?.0))
    })
}

fn is_time_unit(word: &str) -> bool {
    matches!(
        word,
        "s" | "ms" | "us" | "ns" | "sec" | "seconds" | "millis"
    )
}

/// The unit of a time, by its name, else by its size and its median interval.
pub(super) fn time_unit(column: &SheetColumn, median: Option<f64>) -> &'static str {
    let words = words(&column.name);
    for (names, unit) in [
        (["ns", "nanoseconds", "nanosec"], "ns"),
        (["us", "microseconds", "usec"], "us"),
        (["ms", "milliseconds", "msec"], "ms"),
        (["s", "seconds", "sec"], "s"),
    ] {
        if words
            .iter()
            .skip(1)
            .any(|word| names.contains(&word.as_str()))
        {
            return unit;
        }
    }
    // Since 1970, in any unit; else robots write one to a thousand rows a second, and count nanoseconds from their start for fast
    // ones alone.
    match (column.max, median) {
        (max, _) if max > 1e17 => "ns",
        (max, _) if max > 1e14 => "us",
        (max, _) if max > 1e11 => "ms",
        (_, Some(median)) if median > 1e6 => "ns",
        (_, Some(median)) if median >= 500.0 => "us",
        (_, Some(median)) if median >= 1.0 => "ms",
        _ => "s",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_known_by_name_size_and_rhythm() {
        for (name, rank) in [
            ("header.stamp", Some(0)),
            ("stamp.secs", None),
            ("time_ms", Some(1)),
            ("timestamp", Some(1)),
            ("delta_time", None),
            ("t", Some(2)),
            ("ms", Some(2)),
            ("millis", Some(2)),
            ("utc", Some(1)),
            ("t_left", None),
            ("x", None),
        ] {
            assert_eq!(time_rank(name), rank, "{name}");
        }
        let names = |all: &[&str]| {
            let all: Vec<String> = all.iter().map(|name| (*name).to_owned()).collect();
            seconds_and_nanoseconds(&all)
        };
        assert_eq!(names(&["x", "sec", "nanosec"]), Some((1, 2)));
        let two = ["a.stamp.sec", "stamp.secs", "stamp.nsecs"];
        assert_eq!(names(&two), Some((1, 2)));
        assert_eq!(names(&["a.sec", "b.nanosec"]), None);
        let unit = |name: &str, max: f64, median: Option<f64>| {
            let mut column = SheetColumn::new(name);
            column.max = max;
            time_unit(&column, median)
        };
        for (name, expected) in [
            ("time_ns", "ns"),
            ("time_usec", "us"),
            ("time_ms", "ms"),
            ("time_s", "s"),
            // a first word is no unit
            ("ms", "s"),
        ] {
            assert_eq!(unit(name, 1e10, None), expected, "{name}");
        }
        for (max, expected) in [
            (1.1e17, "ns"),
            (1e17, "us"),
            (1.1e14, "us"),
            (1e14, "ms"),
            (1.1e11, "ms"),
            (1e11, "s"),
        ] {
            assert_eq!(unit("time", max, None), expected, "{max}");
        }
        for (median, expected) in [
            (2e6, "ns"),
            (1e6, "us"),
            (500.0, "us"),
            (499.0, "ms"),
            (1.0, "ms"),
            (0.99, "s"),
        ] {
            assert_eq!(unit("time", 10.0, Some(median)), expected, "{median}");
        }
    }
}
