//! How text for people is laid out.

use std::sync::OnceLock;

/// What the caller of a program chose.
///
/// ```
/// use grouser_report::Layout;
///
/// assert_eq!(Layout::current(), Layout { digits: 3, columns: 80, details: false });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Significant digits of a number.
    pub digits: usize,
    /// Characters of a line.
    pub columns: usize,
    /// Are details printed?
    pub details: bool,
}

static CHOSEN: OnceLock<Layout> = OnceLock::new();

impl Layout {
    /// The layout of this process: three digits, 80 columns and no details until [`Layout::choose`] is called.
    #[must_use]
    pub fn current() -> Self {
        CHOSEN.get().copied().unwrap_or(Self {
            digits: 3,
            columns: 80,
            details: false,
        })
    }

    /// Sets the layout for the rest of the process; only the first call has an effect.
    pub fn choose(self) {
        let _ = CHOSEN.set(self);
    }
}
