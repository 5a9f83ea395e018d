//! By how much the stamps of a counter's readings scatter about the moments at which it was read.
//!
//! A stamp that is wrong by τ moves the way u τ of the rim into the window before it, which the one after it lacks. The rim speeds
//! of three windows that follow each other show that: the product of their two differences has the mean −4 (u τ / T)², 0 where
//! the speed wanders, and more where it grows or falls steadily. Where stamps are true, however uneven, it finds none.

/// Weight of a new window.
const SHARE: f64 = 0.01;
/// Differences of speeds are no larger than this many times the speed: what jumps further is no stamp.
const MAX_DIFFERENCE: f64 = 4.0;
/// Ticks explain this many times the variance that they have by themselves.
const TICKS_VARIANCE: f64 = 2.0 / 12.0;

/// The scatter of one counter's stamps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StampScatter {
    /// The two windows before: rim speed (m/s) and length (s).
    before: [Option<(f64, f64)>; 2],
    /// Means of the products (m²/s²), and of what they are for a variance of 1 s².
    product: f64,
    of_unit: f64,
}

impl StampScatter {
    /// Adds a window's rim speed (m/s) and length (s); `tick` is the way of a tick, m.
    pub(super) fn push(&mut self, speed: f64, length: f64, tick: f64) {
        let [first, second] = self.before;
        self.before = [second, Some((speed, length))];
        let (Some((first, first_length)), Some((second, second_length))) = (first, second) else {
            return;
        };
        let middle = second.abs();
        let most = MAX_DIFFERENCE * middle;
        let product = (speed - second).clamp(-most, most) * (second - first).clamp(-most, most);
        // of an error of 1 m in the place of the rim at each reading
        let unit = (1.0 / length + 2.0 / second_length + 1.0 / first_length) / second_length;
        let by_stamps = -product - TICKS_VARIANCE * tick * tick * unit;
        self.product += SHARE * (by_stamps - self.product);
        self.of_unit += SHARE * (middle * middle * unit - self.of_unit);
    }

    /// The variance of a stamp, s².
    pub(super) fn variance(&self) -> f64 {
        if self.product > 0.0 {
            self.product / self.of_unit
        } else {
            0.0
        }
    }

    /// The counter was reset: a window follows that does not continue the last.
    pub(super) fn interrupt(&mut self) {
        self.before = [None; 2];
    }
}
