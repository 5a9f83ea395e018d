//! A sum over time, such as a way, between any two times.

/// Sums that are closer than this are left out, s.
const MIN_STEP_S: f64 = 0.009;

/// A sum over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    times_s: Vec<f64>,
    /// NaN where a time without knowledge begins.
    sums: Vec<f64>,
    sum: f64,
}

impl Track {
    /// Reserves memory for this number of sums.
    pub(super) fn reserve(&mut self, count: usize) {
        self.times_s.reserve(count);
        self.sums.reserve(count);
    }

    /// Adds what has passed at a time, not earlier than those before.
    pub(crate) fn add(&mut self, time_s: f64, passed: f64) {
        self.sum += passed;
        let since_s = self
            .times_s
            .last()
            .map_or(f64::INFINITY, |last| time_s - last);
        if since_s >= MIN_STEP_S {
            self.push(time_s, self.sum);
        } else if since_s <= 0.0
            && let Some(sum) = self.sums.last_mut()
        {
            // another wheel of the same row
            *sum = self.sum;
        }
    }

    /// What passes until this time is not known.
    pub(super) fn interrupt(&mut self, time_s: f64) {
        self.push(time_s, f64::NAN);
        self.push(time_s, self.sum);
    }

    fn push(&mut self, time_s: f64, sum: f64) {
        self.times_s.push(time_s);
        self.sums.push(sum);
    }

    /// The sum at a time; NaN where it is not known. It is looked for about the place of the one before, `near`, and sets it.
    pub(super) fn at(&self, time_s: f64, near: &mut usize) -> f64 {
        let next = self.after(time_s, *near);
        *near = next;
        if next == 0 || next == self.times_s.len() {
            return f64::NAN;
        }
        let (t0, t1) = (self.times_s[next - 1], self.times_s[next]);
        let (s0, s1) = (self.sums[next - 1], self.sums[next]);
        s0 + (s1 - s0) * (time_s - t0) / (t1 - t0)
    }

    /// The first sum after a time, by steps that double from a place which is near.
    fn after(&self, time_s: f64, near: usize) -> usize {
        let times = &self.times_s;
        let is_before = |index: usize| times.get(index).is_some_and(|time| *time <= time_s);
        let (mut low, mut high, mut step) = (near.min(times.len()), near.min(times.len()), 1);
        while is_before(high) {
            low = high;
            high = (high + step).min(times.len());
            step *= 2;
        }
        while low > 0 && !is_before(low) {
            low = low.saturating_sub(step);
            step *= 2;
        }
        low + times[low..high.max(low)].partition_point(|time| *time <= time_s)
    }

    /// Is it known from one time to another?
    pub(super) fn is_known(&self, from_s: f64, to_s: f64) -> bool {
        let first = self.times_s.partition_point(|time| *time < from_s);
        let last = self.times_s.partition_point(|time| *time <= to_s);
        first > 0
            && last < self.times_s.len()
            && self.sums[first - 1..=last].iter().all(|sum| !sum.is_nan())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_its_readings_a_track_is_interpolated_and_across_an_interruption_it_is_not_known() {
        let mut track = Track::default();
        for (time_s, passed) in [(0.0, 0.0), (1.0, 2.0), (2.0, 4.0)] {
            track.add(time_s, passed);
        }
        track.add(2.0, 1.0); // another wheel of the same row
        track.interrupt(5.0);
        track.add(6.0, 3.0);
        let between = |from, to| track.at(to, &mut 0) - track.at(from, &mut 0);
        assert!((between(0.5, 1.5) - 3.5).abs() < 1e-12);
        for time in [-1.0, 0.0, 0.7, 1.0, 2.0, 5.0, 5.5, 6.0, 7.0] {
            let places = (0..9).map(|mut near| track.at(time, &mut near));
            let expected = track.at(time, &mut 0);
            assert!(
                places
                    .into_iter()
                    .all(|of| of.to_bits() == expected.to_bits())
            );
        }
        assert!((between(5.0, 5.5) - 1.5).abs() < 1e-12);
        assert!(between(1.0, 3.0).is_nan() && between(-1.0, 1.0).is_nan());
        assert!(track.is_known(0.5, 1.9) && track.is_known(5.1, 5.9));
        assert!(
            !track.is_known(1.0, 3.0) && !track.is_known(1.0, 5.5) && !track.is_known(5.5, 6.5)
        );
    }
}
