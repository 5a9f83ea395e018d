//! Putting rows and messages into the order of time: with a bounded look-ahead, or with a hold of time.

use std::collections::VecDeque;

/// Rows without a record that a hold of time keeps at most.
const MAX_EMPTY_ROWS: usize = 16;

/// Holds the newest rows back, and returns their records by time; records of equal time keep their order.
///
/// Rows come nearly in order, so each is sorted in from the back.
pub(crate) struct Ordered<T> {
    limit: Limit,
    /// By time, the earliest first.
    rows: VecDeque<Row<T>>,
    /// The row that was announced last.
    open: usize,
    records: usize,
    /// Emptied rows, whose memory is used again.
    spare: Vec<VecDeque<T>>,
    given_ns: Option<i64>,
}

/// How long a row is held back.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Limit {
    /// Until this number of later rows is there.
    Rows(usize),
    /// Until the newest is later by this, ns.
    Time(i64),
}

struct Row<T> {
    time_ns: i64,
    records: VecDeque<T>,
}

impl<T> Ordered<T> {
    pub(crate) const fn new(look_ahead: usize) -> Self {
        Self::with_limit(Limit::Rows(look_ahead))
    }

    pub(crate) const fn with_limit(limit: Limit) -> Self {
        Self {
            limit,
            rows: VecDeque::new(),
            open: 0,
            records: 0,
            spare: Vec::new(),
            given_ns: None,
        }
    }

    /// Announces a row. Its age in seconds if newer ones have already been returned.
    pub(crate) fn begin_row(&mut self, time_ns: i64) -> Result<(), f64> {
        if let Some(given) = self.given_ns
            && time_ns < given
        {
            return Err(given.saturating_sub(time_ns) as f64 * 1e-9);
        }
        // Rows without a record must not pile up.
        let most = match self.limit {
            Limit::Rows(most) => most,
            Limit::Time(_) => MAX_EMPTY_ROWS,
        };
        if self.records == 0 && self.rows.len() >= most {
            self.drop_front();
        }
        let row = Row {
            time_ns,
            records: self.spare.pop().unwrap_or_default(),
        };
        if self.rows.back().is_none_or(|last| last.time_ns <= time_ns) {
            self.open = self.rows.len();
            self.rows.push_back(row);
        } else {
            self.open = self.rows.partition_point(|other| other.time_ns <= time_ns);
            self.rows.insert(self.open, row);
        }
        Ok(())
    }

    /// A record of the row that was announced last.
    pub(crate) fn push(&mut self, record: T) {
        if let Some(row) = self.rows.get_mut(self.open) {
            row.records.push_back(record);
            self.records += 1;
        }
    }

    /// Are enough rows held that the first record may go?
    pub(crate) fn is_ripe(&self) -> bool {
        let is_due = match (self.limit, self.rows.front(), self.rows.back()) {
            (Limit::Rows(most), _, _) => self.rows.len() > most,
            (Limit::Time(hold_ns), Some(first), Some(last)) => {
                last.time_ns.saturating_sub(first.time_ns) >= hold_ns
            }
            (Limit::Time(_), _, _) => false,
        };
        is_due && self.records > 0
    }

    /// The earliest record.
    pub(crate) fn pop(&mut self) -> Option<T> {
        while self.records > 0 {
            let row = self.rows.front_mut()?;
            if let Some(record) = row.records.pop_front() {
                self.records -= 1;
                self.given_ns = Some(row.time_ns);
                if row.records.is_empty() {
                    self.drop_front();
                }
                return Some(record);
            }
            self.drop_front();
        }
        None
    }

    fn drop_front(&mut self) {
        if let Some(row) = self.rows.pop_front() {
            self.spare.push(row.records);
        }
    }

    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.records = 0;
    }

    /// Rows of any time are taken again: the clock was set.
    pub(crate) const fn forget_time(&mut self) {
        self.given_ns = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(ordered: &mut Ordered<u32>, time_ns: i64, records: &[u32]) {
        ordered.begin_row(time_ns).unwrap();
        for record in records {
            ordered.push(*record);
        }
    }

    fn all(ordered: &mut Ordered<u32>) -> Vec<u32> {
        std::iter::from_fn(|| ordered.pop()).collect()
    }

    #[test]
    fn records_come_by_time_and_those_of_one_time_in_their_order() {
        let mut ordered = Ordered::new(10);
        for (time, records) in [
            (30, &[1, 2][..]),
            (10, &[3]),
            (30, &[4]),
            (20, &[5, 6]),
            (10, &[7]),
            (40, &[]),
        ] {
            row(&mut ordered, time, records);
        }
        assert!(!ordered.is_ripe());
        assert_eq!(all(&mut ordered), [3, 7, 5, 6, 1, 2, 4]);
        assert_eq!(ordered.pop(), None);
        // what is as old as the last one given is taken, what is older is not
        row(&mut ordered, 30, &[8]);
        assert_eq!(ordered.begin_row(29), Err(1e-9));
        // nor does it become the open row
        ordered.push(9);
        assert_eq!(all(&mut ordered), [8, 9]);
        ordered.forget_time();
        row(&mut ordered, 5, &[10]);
        ordered.clear();
        assert_eq!(ordered.pop(), None);
        assert!(!ordered.is_ripe());
    }

    #[test]
    fn a_row_is_held_until_so_many_later_ones_are_there() {
        let mut ordered = Ordered::new(2);
        for (time, is_ripe) in [(1, false), (2, false), (3, true)] {
            row(&mut ordered, time, &[7]);
            assert_eq!(ordered.is_ripe(), is_ripe, "{time}");
        }
        assert_eq!(ordered.pop(), Some(7));
        assert!(!ordered.is_ripe());
        // rows without a record are not held
        let mut ordered: Ordered<u32> = Ordered::new(2);
        for time in 0..10 {
            row(&mut ordered, time, &[]);
            assert!(ordered.rows.len() <= 2 && !ordered.is_ripe());
        }
        assert_eq!(ordered.rows.len(), 2);
        // nor once all are given
        ordered.push(0);
        assert_eq!(ordered.pop(), Some(0));
        for time in 10..20 {
            row(&mut ordered, time, &[]);
        }
        assert_eq!(ordered.rows.len(), 2);
        // but that which is open
        assert_eq!(ordered.pop(), None);
        ordered.push(3);
        assert_eq!(ordered.pop(), Some(3));
        let mut ordered: Ordered<u32> = Ordered::new(2);
        row(&mut ordered, 8, &[]);
        row(&mut ordered, 9, &[]);
        row(&mut ordered, 10, &[1]);
        row(&mut ordered, 11, &[]);
        row(&mut ordered, 12, &[]);
        assert!(ordered.is_ripe() && ordered.rows.len() == 4);
        assert_eq!(ordered.pop(), Some(1));
        // nor is their memory given back: two before the record, and its own
        assert_eq!((ordered.rows.len(), ordered.spare.len()), (2, 2));
    }

    #[test]
    fn a_row_is_held_until_the_newest_is_later_by_so_much() {
        let mut ordered = Ordered::with_limit(Limit::Time(100));
        assert!(!ordered.is_ripe());
        for (time, is_ripe) in [(1000, false), (1099, false), (1100, true)] {
            row(&mut ordered, time, &[7]);
            assert_eq!(ordered.is_ripe(), is_ripe, "{time}");
        }
        let mut ordered: Ordered<u32> = Ordered::with_limit(Limit::Time(100));
        for time in 0..40 {
            row(&mut ordered, 1000 * time, &[]);
            assert!(!ordered.is_ripe());
        }
        assert_eq!(ordered.rows.len(), MAX_EMPTY_ROWS);
    }
}
