//! Tables for people: aligned columns under a header, no frame, no colour.

use std::fmt::Write as _;

/// How a column stands.
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
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.sides.len()).map(width).collect();
        let mut text = String::new();
        for row in self.rows.iter().skip(first) {
            let mut line = String::new();
            for ((cell, side), width) in row.iter().zip(&self.sides).zip(&widths) {
                // Writing to a string cannot fail.
                let _ = match side {
                    Side::Left => write!(line, "{cell:<width$}  "),
                    Side::Right => write!(line, "{cell:>width$}  "),
                };
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
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
