//! A dense matrix of derivatives, one row per function.

/// Row-major derivatives: row = function, column = variable.
///
/// ```
/// use grouser_opt::Jacobian;
///
/// let mut jacobian = Jacobian::zeros(2, 3);
/// jacobian.set(1, 2, -4.0);
/// assert_eq!(jacobian.row(1), [0.0, 0.0, -4.0]);
/// assert_eq!(jacobian.row_norm(1), 4.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Jacobian {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl Jacobian {
    /// A matrix of zeros.
    #[must_use]
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
        }
    }

    /// The number of functions.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The number of variables.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The gradient of function `row`; empty if there is no such row.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        self.entries
            .get(row * self.columns..(row + 1) * self.columns)
            .unwrap_or(&[])
    }

    /// The gradient of function `row`, to be written; empty if there is no such row.
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        self.entries
            .get_mut(row * self.columns..(row + 1) * self.columns)
            .unwrap_or(&mut [])
    }

    /// Writes one entry; outside the matrix it does nothing.
    pub fn set(&mut self, row: usize, column: usize, value: f64) {
        if let Some(entry) = self.row_mut(row).get_mut(column) {
            *entry = value;
        }
    }

    /// The greatest magnitude in a row.
    #[must_use]
    pub fn row_norm(&self, row: usize) -> f64 {
        self.row(row).iter().fold(0.0, |m, g| g.abs().max(m))
    }
}
