//! Tick counters of finite width, unwrapped.

use crate::error::{Error, Result};

/// How many bits a tick counter has, 8 to 64.
///
/// ```
/// use grouser_slip::CounterWidth;
///
/// assert_eq!(CounterWidth::new(16)?.bits(), 16);
/// assert!(CounterWidth::new(7).is_err());
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CounterWidth(u32);

impl CounterWidth {
    /// The widest counter, of 64 bits: it does not wrap in practice.
    pub const MAX: Self = Self(64);

    /// A counter of `bits` bits.
    ///
    /// # Errors
    /// [`Error::CounterWidth`] outside 8 to 64.
    pub const fn new(bits: u32) -> Result<Self> {
        if bits >= 8 && bits <= 64 {
            Ok(Self(bits))
        } else {
            Err(Error::CounterWidth { bits })
        }
    }

    /// Its number of bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The signed step from one raw reading to the next: the shortest way round, in
    /// [−2^(bits−1), 2^(bits−1)).
    ///
    /// Signed and unsigned counters are the same here: only the low bits are looked at.
    ///
    /// ```
    /// use grouser_slip::CounterWidth;
    /// let u16_counter = CounterWidth::new(16)?;
    /// assert_eq!(u16_counter.step(65_535, 2), 3); // forwards over the boundary
    /// assert_eq!(u16_counter.step(2, 65_535), -3); // and back
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    #[must_use]
    pub const fn step(self, from: u64, to: u64) -> i64 {
        let unused = 64 - self.0;
        // Shifting the counter's sign bit to the top makes 64-bit wrapping do the modulus.
        (to.wrapping_sub(from) << unused).cast_signed() >> unused
    }

    /// The step whose size is nearest to `expected` ticks: it finds steps of half a range and more, and
    /// several wraps between two readings, where a prediction is at hand.
    ///
    /// ```
    /// use grouser_slip::CounterWidth;
    ///
    /// let narrow = CounterWidth::new(8)?;
    /// assert_eq!(narrow.step(0, 44), 44);
    /// assert_eq!(narrow.step_near(0, 44, 310), 300); // one wrap more, where about 310 ticks are expected
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    #[must_use]
    pub fn step_near(self, from: u64, to: u64, expected: i64) -> i64 {
        let unused = 64 - self.0;
        let residue = self.step(from, to);
        let off = (expected.wrapping_sub(residue) << unused) >> unused;
        expected.wrapping_sub(off)
    }
}

/// A tick counter unwrapped into a running total.
///
/// The total is exact for ±2^127 ticks.
///
/// ```
/// use grouser_slip::{Counter, CounterWidth};
/// let mut counter = Counter::new(CounterWidth::new(8)?);
/// for raw in [250, 254, 2, 6] {
///     counter.advance(raw);
/// }
/// assert_eq!(counter.total(), 12); // counted from the first reading
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Counter {
    width: CounterWidth,
    last: Option<u64>,
    total: i128,
}

impl Counter {
    /// A counter that has not been read yet.
    #[must_use]
    pub const fn new(width: CounterWidth) -> Self {
        Self {
            width,
            last: None,
            total: 0,
        }
    }

    /// Takes the next raw reading; gives the step since the last one (0 for the first).
    pub fn advance(&mut self, raw: u64) -> i64 {
        self.advance_near(raw, 0)
    }

    /// [`Counter::advance`] for a step expected to be near `expected` ticks.
    ///
    /// ```
    /// use grouser_slip::{Counter, CounterWidth};
    ///
    /// let mut counter = Counter::new(CounterWidth::new(8)?);
    /// counter.advance(250);
    /// assert_eq!(counter.advance_near(4, 260), 266);
    /// # Ok::<(), grouser_slip::Error>(())
    /// ```
    pub fn advance_near(&mut self, raw: u64, expected: i64) -> i64 {
        let step = self
            .last
            .map_or(0, |last| self.width.step_near(last, raw, expected));
        self.last = Some(raw);
        self.total += i128::from(step);
        step
    }

    /// Ticks since the first reading.
    #[must_use]
    pub const fn total(&self) -> i128 {
        self.total
    }
}
