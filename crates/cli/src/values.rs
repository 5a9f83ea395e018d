//! Numbers that a flag may give several of.

use std::str::FromStr;

use grouser_report::number::parse_finite;

/// What a flag gives: `0.1`, `0.1,0.2` or `0.1:0.2`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values {
    List(Vec<f64>),
    Range([f64; 2]),
}

impl FromStr for Values {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| {
            parse_finite(part).map_err(|_| {
                "must be a finite number, a list `a,b,c` or a range `from:to`".to_owned()
            })
        };
        match text.split_once(':') {
            Some((from, to)) => {
                let range = [number(from)?, number(to)?];
                if range[0] < range[1] {
                    Ok(Self::Range(range))
                } else {
                    Err("must rise from its first number to its second".to_owned())
                }
            }
            None => text
                .split(',')
                .map(number)
                .collect::<Result<_, _>>()
                .map(Self::List),
        }
    }
}

impl Values {
    /// The only number, where it is one.
    pub(crate) fn single(&self) -> Option<f64> {
        match self {
            Self::List(list) => match list.as_slice() {
                [value] => Some(*value),
                _ => None,
            },
            Self::Range(_) => None,
        }
    }

    /// All numbers; a range has `points`, evenly spaced, and ends exactly at its last.
    pub(crate) fn spread(&self, points: u32) -> Vec<f64> {
        match self {
            Self::List(list) => list.clone(),
            Self::Range([from, to]) => {
                let last = points - 1;
                let at = |i: u32| from + (to - from) * (f64::from(i) / f64::from(last));
                (0..=last)
                    .map(|i| if i == last { *to } else { at(i) })
                    .collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lists_and_ranges() {
        assert_eq!("-3.5".parse(), Ok(Values::List(vec![-3.5])));
        assert_eq!("1,2".parse(), Ok(Values::List(vec![1.0, 2.0])));
        assert_eq!("-10:40".parse(), Ok(Values::Range([-10.0, 40.0])));
        for text in ["", "1,", "1:", "2:1", "nan", "0:inf", "1:2:3"] {
            assert!(text.parse::<Values>().is_err(), "{text}");
        }
    }
}
