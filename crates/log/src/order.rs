//! Putting rows and messages into the order of time with a bounded look-ahead.

use std::collections::VecDeque;

/// Holds the newest rows back until `look_ahead` others have come, and returns their records by time;
/// records of equal time keep their order.
///
/// Rows come nearly in order, so each is sorted in from the back.
pub(crate) struct Ordered<T> {
    look_ahead: usize,
    /// By time, the earliest first.
    rows: VecDeque<Row<T>>,
    /// The row that was announced last.
    open: usize,
    records: usize,
    /// Emptied rows, whose memory is used again.
    spare: Vec<VecDeque<T>>,
    given_ns: Option<i64>,
}

struct Row<T> {
    time_ns: i64,
    records: VecDeque<T>,
}

impl<T> Ordered<T> {
    pub(crate) const fn new(look_ahead: usize) -> Self {
        Self {
            look_ahead,
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
        if self.records == 0 && self.rows.len() >= self.look_ahead {
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
        self.rows.len() > self.look_ahead && self.records > 0
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
}
