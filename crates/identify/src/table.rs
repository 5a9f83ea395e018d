//! Tables of tests: one header of names with units, then numbers.

use std::io::BufRead;
use std::path::{Path, PathBuf};

use grouser_files::{is_quantity_name, nearest};
use grouser_log::csv::{Lines, split};

use crate::error::{Error, Result};

/// The most bytes of a table of tests.
pub const TABLE_LIMIT: u64 = 64 << 20;

/// The most rows of a table of tests: every fit holds them all, several times.
pub const ROW_LIMIT: usize = 200_000;

/// A quantity by the names of its columns, each with the SI value of one of its unit.
#[derive(Clone, Copy, Debug)]
pub struct Column(pub &'static [(&'static str, f64)]);

/// A table in memory.
///
/// ```
/// use grouser_identify::table::{Column, Table};
///
/// let table = Table::parse("load.csv".as_ref(), "load_kn,test\n0.06,a\n# a remark\n0.08,b\n")?;
/// let load = Column(&[("load_n", 1.0), ("load_kn", 1e3)]);
/// assert_eq!(table.numbers(load)?, [60.0, 80.0]);
/// assert_eq!(table.texts("test").unwrap(), ["a", "b"]);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    path: PathBuf,
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a table: comma-separated, the first line names its columns; `#` begins a remark.
    ///
    /// # Errors
    /// [`Error::Log`] for a file that is absent or no text; [`Error::Content`] for text that is no table or
    /// that is too large, with the line.
    pub fn read(path: &Path) -> Result<Self> {
        Self::from_lines(path, Lines::open(path)?)
    }

    /// Reads a table out of text; `path` is for messages.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let lines = Lines::over(text.as_bytes(), &path.display().to_string());
        Self::from_lines(path, lines)
    }

    fn from_lines<R: BufRead>(path: &Path, mut lines: Lines<R>) -> Result<Self> {
        let wrong = |message: String| Error::Content {
            path: path.to_owned(),
            message,
        };
        let mut names: Option<Vec<String>> = None;
        let (mut rows, mut fields) = (Vec::new(), Vec::new());
        while lines.advance()? {
            let number = lines.number();
            if lines.bytes() > TABLE_LIMIT {
                return Err(wrong(format!(
                    "line {number} is beyond the limit of {TABLE_LIMIT} bytes"
                )));
            }
            let line = lines.text()?;
            if line.trim().is_empty() || line.trim_start().starts_with('#') {
                continue;
            }
            split(line, b',', &mut fields)
                .map_err(|quote| wrong(format!("line {number}: {}", quote.what)))?;
            let row: Vec<String> = fields
                .iter()
                .map(|field| field.value(line).into_owned())
                .collect();
            let Some(names) = &names else {
                names = Some(row);
                continue;
            };
            if row.len() != names.len() {
                return Err(wrong(format!(
                    "line {number} has {} fields, but the header has {}",
                    row.len(),
                    names.len()
                )));
            }
            if rows.len() == ROW_LIMIT {
                return Err(wrong(format!(
                    "line {number} is beyond the limit of {ROW_LIMIT} rows; thin the readings"
                )));
            }
            rows.push(row);
        }
        let names = names.ok_or_else(|| wrong("holds no header".to_owned()))?;
        if rows.is_empty() {
            return Err(wrong("holds a header and no data".to_owned()));
        }
        Ok(Self {
            path: path.to_owned(),
            names,
            rows,
        })
    }

    /// How many rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Is there no row? (Never: such a table is refused.)
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Does it have a column of this quantity?
    ///
    /// ```
    /// use grouser_identify::table::{Column, Table};
    ///
    /// let table = Table::parse("a.csv".as_ref(), "slip\n0.1\n")?;
    /// assert!(table.has(Column(&[("slip", 1.0)])) && !table.has(Column(&[("load_n", 1.0)])));
    /// # Ok::<(), grouser_identify::Error>(())
    /// ```
    #[must_use]
    pub fn has(&self, column: Column) -> bool {
        self.place(column).is_some()
    }

    /// Refuses a column that looks like a quantity and is in none of `read`, and a quantity in two columns.
    ///
    /// # Errors
    /// [`Error::Content`] with the column and what is read.
    ///
    /// ```
    /// use grouser_identify::table::{Column, Table};
    ///
    /// let table = Table::parse("a.csv".as_ref(), "slip,beta_deg,note\n0.1,20,x\n")?;
    /// let refused = table.refuse_unread(&[Column(&[("slip", 1.0)])]).unwrap_err();
    /// assert!(refused.to_string().contains("`beta_deg`"));
    /// # Ok::<(), grouser_identify::Error>(())
    /// ```
    pub fn refuse_unread(&self, read: &[Column]) -> Result<()> {
        let names = || {
            read.iter()
                .flat_map(|column| column.0)
                .map(|(name, _)| *name)
        };
        let is_unread =
            |own: &&String| is_quantity_name(own) && !names().any(|name| name == own.as_str());
        let mut places = read
            .iter()
            .map(|column| column.0.iter().map(|(name, _)| *name).collect::<Vec<_>>());
        let is_twice = |of: &Vec<&str>| {
            let found = self.names.iter().filter(|own| of.contains(&own.as_str()));
            found.count() > 1
        };
        if let Some(twice) = places.find(is_twice) {
            return Err(Error::Content {
                path: self.path.clone(),
                message: format!("more than one column is {}", twice.join(" or ")),
            });
        }
        let Some(unread) = self.names.iter().find(is_unread) else {
            return Ok(());
        };
        let known: Vec<&str> = names().collect();
        Err(Error::Content {
            path: self.path.clone(),
            message: format!(
                "column `{unread}` is a quantity that is not read; read are `{}`; rename a column that is only a \
                 remark, as `note_…` or `measured_…`",
                known.join("`, `")
            ),
        })
    }

    fn place(&self, column: Column) -> Option<(usize, f64)> {
        column.0.iter().find_map(|(name, scale)| {
            let place = self.names.iter().position(|own| own == name)?;
            Some((place, *scale))
        })
    }

    /// The column as SI numbers; an empty field is `None`.
    ///
    /// # Errors
    /// [`Error::Content`] where there is no such column, or a field that is no finite number.
    ///
    /// ```
    /// use grouser_identify::table::{Column, Table};
    ///
    /// let table = Table::parse("a.csv".as_ref(), "torque_nm,slip\n,0.1\n2.5,0.2\n")?;
    /// assert_eq!(table.optional(Column(&[("torque_nm", 1.0)]))?, [None, Some(2.5)]);
    /// # Ok::<(), grouser_identify::Error>(())
    /// ```
    pub fn optional(&self, column: Column) -> Result<Vec<Option<f64>>> {
        let Some((place, scale)) = self.place(column) else {
            return Err(self.absent(column));
        };
        self.rows
            .iter()
            .enumerate()
            .map(|(index, row)| {
                let text = row[place].as_str();
                if text.is_empty() {
                    return Ok(None);
                }
                match text.parse::<f64>() {
                    Ok(value) if value.is_finite() => Ok(Some(value * scale)),
                    _ => Err(Error::Content {
                        path: self.path.clone(),
                        message: format!(
                            "row {} of `{}` is \"{}\", but must be a finite number",
                            index + 1,
                            self.names[place],
                            text.chars().take(40).collect::<String>()
                        ),
                    }),
                }
            })
            .collect()
    }

    /// The column as SI numbers, every field filled.
    ///
    /// # Errors
    /// As [`Table::optional`]; an empty field too.
    pub fn numbers(&self, column: Column) -> Result<Vec<f64>> {
        let cells = self.optional(column)?;
        let name = self
            .place(column)
            .map_or("", |(place, _)| &self.names[place]);
        cells
            .into_iter()
            .enumerate()
            .map(|(index, cell)| {
                cell.ok_or_else(|| Error::Content {
                    path: self.path.clone(),
                    message: format!("row {} of `{name}` is empty", index + 1),
                })
            })
            .collect()
    }

    /// The column as text; `None` where there is no such column.
    #[must_use]
    pub fn texts(&self, name: &str) -> Option<Vec<&str>> {
        let place = self.names.iter().position(|own| own == name)?;
        Some(self.rows.iter().map(|row| row[place].as_str()).collect())
    }

    fn absent(&self, column: Column) -> Error {
        let wanted = column.0.first().map_or("", |(name, _)| name);
        let others: Vec<&str> = column.0.iter().map(|(name, _)| *name).collect();
        let meant = nearest(wanted, self.names.iter().map(String::as_str))
            .map_or(String::new(), |name| format!("; did you mean `{name}`?"));
        Error::Content {
            path: self.path.clone(),
            message: format!("there is no column {}{meant}", others.join(" or ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEPTH: Column = Column(&[("depth_m", 1.0), ("depth_mm", 1e-3)]);

    #[test]
    fn units_are_in_the_names() {
        let table = Table::parse(
            Path::new("t.csv"),
            "# a remark\nforce_n,depth_mm\n1,2\n3,\n",
        )
        .unwrap();
        assert_eq!(table.optional(DEPTH).unwrap(), [Some(0.002), None]);
        assert!(table.numbers(DEPTH).is_err());
    }

    #[test]
    fn an_error_names_its_place() {
        let parse = |text: &str| Table::parse(Path::new("t.csv"), text);
        let ragged = parse("a,b\n1,2\n3\n").unwrap_err().to_string();
        assert!(ragged.contains("line 3"), "{ragged}");
        let table = parse("dept_m\n1\n").unwrap();
        let absent = table.numbers(DEPTH).unwrap_err().to_string();
        assert!(absent.contains("did you mean `dept_m`?"), "{absent}");
        let word = parse("depth_m\nnan\n").unwrap();
        assert!(
            word.numbers(DEPTH)
                .unwrap_err()
                .to_string()
                .contains("row 1")
        );
        assert!(parse("").is_err() && parse("a\n").is_err());
        assert!(!parse("a\n1\n").unwrap().is_empty());
        // 64 MiB are read, a byte more is refused where it stands
        let blank = " ".repeat((1 << 20) - 1) + "\n";
        let full = "a\n1\n".to_owned() + &" ".repeat((1 << 20) - 5) + "\n" + &blank.repeat(63);
        assert!(full.len() as u64 == TABLE_LIMIT && parse(&full).is_ok());
        for end in ["\n", " \n"] {
            let text = full.clone() + end;
            let beyond = parse(&text).unwrap_err().to_string();
            assert!(beyond.contains("line 67 is beyond the limit"), "{beyond}");
        }
    }
}
