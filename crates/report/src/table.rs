//! Tables for people: aligned columns under a header, no frame, no colour, no wider than a line.

use std::fmt::Write as _;

use crate::layout::Layout;
use crate::wrap::wrapped;

/// The alignment of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
}

/// A table under construction.
///
/// ```
/// use grouser_report::Table;
///
/// let mut table = Table::new().text("wheel").number("load");
/// table.row(["left", "60"]);
/// assert_eq!(table.render(), "wheel  load\nleft     60\n");
/// ```
#[derive(Debug, Default)]
pub struct Table {
    sides: Vec<Side>,
    /// The header first.
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without columns.
    #[must_use]
    pub fn new() -> Self {
        Self {
            sides: Vec::new(),
            rows: vec![Vec::new()],
        }
    }

    /// One more column, of words.
    #[must_use]
    pub fn text(self, header: &str) -> Self {
        self.column(header, Side::Left)
    }

    /// One more column, of numbers.
    #[must_use]
    pub fn number(self, header: &str) -> Self {
        self.column(header, Side::Right)
    }

    /// One more row: a cell for each column; missing cells stay empty.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The lines, each with a line end.
    #[must_use]
    pub fn render(&self) -> String {
        self.lines(0)
    }

    /// The lines without the header.
    #[must_use]
    pub fn render_body(&self) -> String {
        self.lines(1)
    }

    fn lines(&self, first: usize) -> String {
        let mut columns: Vec<usize> = (0..self.sides.len()).collect();
        let mut text = String::new();
        while !columns.is_empty() {
            // as many columns as fit; the others follow as another table, below the first column again
            let counts = (1..=columns.len()).rev();
            let mut fitting = counts.filter_map(|count| self.widths(&columns[..count], first));
            let widths = fitting.next().unwrap_or_default();
            let count = widths.len().max(1);
            text.push_str(if text.is_empty() { "" } else { "\n" });
            for row in self.rows.iter().skip(first) {
                self.push_row(&mut text, row, &columns, &widths);
            }
            columns.drain(usize::from(count < columns.len() && count > 1)..count);
        }
        text
    }

    /// Widths with which the columns fit on a line: as wide as their cells, or, from the widest down, no wider than their
    /// words. Two columns need not fit.
    fn widths(&self, columns: &[usize], first: usize) -> Option<Vec<usize>> {
        let longest = |column: usize, is_narrow: bool| {
            let rows = self.rows.iter().enumerate().skip(first);
            let cells = rows.filter_map(|(row, cells)| Some((row, cells.get(column)?)));
            let width = |(row, cell): (usize, &String)| {
                // a number stays on its line
                let is_wrapped = is_narrow && (row == 0 || self.sides[column] == Side::Left);
                let words = cell.split(' ').map(|word| word.chars().count());
                words
                    .max()
                    .filter(|_| is_wrapped)
                    .unwrap_or(cell.chars().count())
            };
            cells.map(width).max().unwrap_or(0)
        };
        let mut widths: Vec<usize> = columns.iter().map(|c| longest(*c, false)).collect();
        let narrowest: Vec<usize> = columns.iter().map(|c| longest(*c, true)).collect();
        let room = Layout::current()
            .columns
            .saturating_sub(2 * (columns.len() - 1));
        while widths.iter().sum::<usize>() > room {
            let places = (0..widths.len()).filter(|at| widths[*at] > narrowest[*at]);
            match places.max_by_key(|at| widths[*at]) {
                Some(widest) => widths[widest] -= 1,
                None if columns.len() <= 2 => break,
                None => return None,
            }
        }
        Some(widths)
    }

    fn push_row(&self, text: &mut String, row: &[String], columns: &[usize], widths: &[usize]) {
        let cells = columns.iter().zip(widths).map(|(column, width)| {
            let cell = row.get(*column).map_or("", String::as_str);
            wrapped(cell, *width, 0)
        });
        let cells: Vec<String> = cells.collect();
        let height = cells.iter().map(|cell| cell.lines().count()).max();
        for at in 0..height.unwrap_or(1).max(1) {
            let mut line = String::new();
            for ((cell, column), width) in cells.iter().zip(columns).zip(widths) {
                let part = cell.lines().nth(at).unwrap_or("");
                // Writing to a string cannot fail.
                let _ = match self.sides[*column] {
                    Side::Left => write!(line, "{part:<width$}  "),
                    Side::Right => write!(line, "{part:>width$}  "),
                };
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
    }

    fn column(mut self, header: &str, side: Side) -> Self {
        self.sides.push(side);
        if let Some(headers) = self.rows.first_mut() {
            headers.push(header.to_owned());
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wide_table_wraps_its_words_and_then_continues_below_its_first_column() {
        let mut table = Table::new().text("wheel").text("why").number("load N");
        table.row(["left", &"word ".repeat(30), "60"]);
        let text = table.render();
        assert!(
            text.lines().all(|line| line.chars().count() <= 80),
            "{text}"
        );
        assert_eq!(text.matches("word").count(), 30);
        assert_eq!(text.matches("60").count(), 1);
        let mut table = Table::new().text("wheel");
        for column in 0..30 {
            table = table.number(&format!("column {column}"));
        }
        table.row(std::iter::once("left".to_owned()).chain((0..30).map(|n| format!("12.3e{n}"))));
        let text = table.render();
        assert!(
            text.lines().all(|line| line.chars().count() <= 80),
            "{text}"
        );
        assert!(text.matches("left").count() > 1, "{text}");
        assert_eq!(text.matches("12.3e").count(), 30);
    }

    #[test]
    fn words_left_numbers_right() {
        let mut table = Table::new().text("soil").number("φ deg").text("note");
        table.row(["dry-sand", "30", ""]);
        table.row(["x", "8.5", "second-hand"]);
        assert_eq!(
            table.render(),
            "soil      φ deg  note\ndry-sand     30\nx           8.5  second-hand\n"
        );
    }
}
