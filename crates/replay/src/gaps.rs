//! Gaps of a log.

use crate::moment::seconds;

/// A longer time between two rows is a gap, s. A prior: nearly all recorded wheels are read more than twice a second.
const GAP_S: f64 = 0.5;
/// Where it is also more than this multiple of the time before. A prior: rows of a slow logger scatter by less than half a period.
const SCATTER: f64 = 1.5;

/// Tells gaps from rows that are seldom.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gaps {
    last_ns: Option<i64>,
    last_s: f64,
}

impl Gaps {
    /// The time since the last row, s, of which a gap counts as the longest that is none, and whether it is a gap; `None` where
    /// the clock was set back.
    pub(crate) fn passed(&mut self, now_ns: i64) -> Option<(f64, bool)> {
        let last_ns = self.last_ns.replace(now_ns).unwrap_or(now_ns);
        if now_ns < last_ns {
            return None;
        }
        let limit = GAP_S.max(SCATTER * self.last_s);
        self.last_s = seconds(last_ns, now_ns);
        Some((self.last_s.min(limit), self.last_s > limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_seldom_are_no_gaps_and_a_pause_is_one() {
        let passed = |times_ms: &[i64]| {
            let mut gaps = Gaps::default();
            let mut passed = times_ms.iter().map(|ms| gaps.passed(ms * 1_000_000));
            passed.by_ref().nth(times_ms.len() - 2);
            passed.next().unwrap()
        };
        assert_eq!(passed(&[0, 20, 40]), Some((0.02, false)));
        assert_eq!(passed(&[0, 20, 25_000]), Some((0.5, true)));
        assert_eq!(passed(&[0, 1300, 2600]), Some((1.3, false)));
        assert_eq!(passed(&[0, 2600, 1300]), None);
    }
}
