//! The noise of positions, learnt from them: of a robot that moves, along its course and across, and what it wanders.

use grouser_real::Real;

use super::reference_noise::{Errors, MEDIAN_OF_NORMAL, Noise, SECOND_DIFFERENCE, Scale};

/// Second differences are taken over one reading, two, and this many: 0.4 s at 10 Hz, in which slip changes little.
const WIDE_READINGS: usize = 4;
const KEPT_POSITIONS: usize = 2 * WIDE_READINGS + 1;
/// Weight of a new square in the means, and of how many the first ones are the mean. A wander that is none costs more than a short memory
/// gains.
const SQUARE_WEIGHT: f64 = 0.004;
const FIRST_SQUARES: u32 = 10;
/// A square counts at most as this multiple of their mean: outliers and jumps of slip are not learnt. Of normal errors the mean is 10 %
/// too small by that.
const MAX_SQUARE_FACTOR: f64 = 4.0;
/// The means are used from this many squares on.
const ENOUGH_SQUARES: u32 = 30;
/// Most second differences of rounded positions may be none, and so may their median: the noise is at least this share of their root
/// mean square, which that of normal errors reaches on its own.
const MIN_MEAN_SHARE: f64 = 0.8;
/// Errors are larger along the course where their variance is this multiple of that across.
const ALONG_FACTOR: f64 = 2.0;
/// Errors that wander are told from slip that changes where positions are read at least this often, s.
const MAX_WANDER_PERIOD_S: f64 = 0.25;
/// Errors that wander have at least this share of it for themselves: filters and trackers round the steps.
const MIN_OWN_SHARE: f64 = 0.2;

/// Standard deviation of positions about the way of the wheels. A delay that scatters is an error along the course alone. Errors of
/// trackers and maps wander: over m readings the second difference has the variance 6σ² + 2mq² + m³w², by independent errors σ, a
/// wander q from reading to reading and a slip that wanders by w.
#[derive(Clone, Debug)]
pub(crate) struct PositionNoise {
    /// Positions less the way of the wheels, the newest first, m.
    last: [[f64; 2]; KEPT_POSITIONS],
    seen: usize,
    has_moved: bool,
    /// Of second differences on either axis.
    scale: Scale,
    /// Mean squares of second differences across the course, and along it over one, two and four readings, m².
    across: f64,
    along: [f64; 3],
    squares: u32,
}

impl PositionNoise {
    pub(crate) const fn new() -> Self {
        Self {
            last: [[0.0; 2]; KEPT_POSITIONS],
            seen: 0,
            has_moved: false,
            scale: Scale::NEW,
            across: 0.0,
            along: [0.0; 3],
            squares: 0,
        }
    }

    /// Adds a position less the way of the wheels, which have a course (sine and cosine). Errors of a robot at rest are often smaller than
    /// those of one that moves: below the standard deviation that is stated (`at_rest`, m), or learnt in motion, they show nothing.
    pub(crate) fn push(&mut self, position: [f64; 2], course: (f64, f64), at_rest: Option<f64>) {
        self.last.rotate_right(1);
        self.last[0] = position;
        self.seen += 1;
        let Some(one) = self.second_difference(1, course) else {
            return;
        };
        let least = at_rest.map_or(0.0, |stated| {
            let stated = MEDIAN_OF_NORMAL * Real::sqrt(SECOND_DIFFERENCE) * stated;
            let learnt = self.scale.lasting.filter(|_| self.has_moved);
            learnt.unwrap_or(stated)
        });
        for size in one {
            self.scale.push(size.abs(), least);
        }
        self.scale.follow();
        if at_rest.is_some() {
            return;
        }
        self.has_moved = true;
        let wide = [2, WIDE_READINGS].map(|over| self.second_difference(over, course));
        if let ([Some(two), Some(four)], Some(deviation)) = (wide, self.scale.deviation()) {
            self.add_squares([one, two, four], deviation * deviation);
        }
    }

    /// The second difference over a number of readings, along a course (sine and cosine) and across.
    fn second_difference(&self, over: usize, (sin, cos): (f64, f64)) -> Option<[f64; 2]> {
        let [x, y] = core::array::from_fn(|axis| {
            let [end, middle, begin] = [0, over, 2 * over].map(|i| self.last[i][axis]);
            end - 2.0 * middle + begin
        });
        (self.seen > 2 * over).then_some([cos * x + sin * y, cos * y - sin * x])
    }

    fn add_squares(&mut self, [one, two, four]: [[f64; 2]; 3], first: f64) {
        if self.squares == 0 {
            self.across = first;
            self.along = [first; 3];
        }
        self.squares += 1;
        let weight = (1.0 / f64::from(FIRST_SQUARES + self.squares)).max(SQUARE_WEIGHT);
        let add = |mean: &mut f64, size: f64| {
            let most = MAX_SQUARE_FACTOR * *mean;
            *mean += weight * ((size * size).min(most) - *mean);
        };
        add(&mut self.across, one[1]);
        for (mean, [along, _]) in self.along.iter_mut().zip([one, two, four]) {
            add(mean, along);
        }
    }

    /// Restarts the differences after a gap or in a new frame; what was learnt stays.
    pub(crate) fn interrupt(&mut self) {
        self.seen = 0;
    }

    /// The learnt standard deviation on one axis, m.
    pub(crate) fn learnt(&self) -> Option<f64> {
        let deviation = self.scale.deviation()?;
        Some(deviation / Real::sqrt(SECOND_DIFFERENCE))
    }

    /// The noise along the course and across of positions that are read every `period_s`, by how errors depend on one another; `prior`
    /// (m) until it is learnt.
    pub(crate) fn noise(&self, errors: Errors, prior: f64, period_s: f64) -> [Noise; 2] {
        let both = Noise::of(errors, self.learnt(), prior);
        if errors == Errors::Summed || self.squares < ENOUGH_SQUARES {
            return [both; 2];
        }
        let [one, two, four] = self.along;
        let [mut along, across] = [one, self.across].map(|square| {
            let least = MIN_MEAN_SHARE * Real::sqrt(square / SECOND_DIFFERENCE);
            let reading = both.reading.max(least);
            Noise { reading, ..both }
        });
        if one > ALONG_FACTOR * self.across {
            along.reading = along.reading.max(Real::sqrt(one / SECOND_DIFFERENCE));
        }
        // the wander by all three, and at most that by the first and the last: a noise that is not normal is none
        let by_all = (9.0 * (two - one) - (four - one)) / 12.0;
        let wander = by_all.min((four - one) / 6.0);
        let own = ((one - 2.0 * wander) / SECOND_DIFFERENCE).max(0.0);
        // by chance independent errors seem to wander up to that
        if wander > own && period_s <= MAX_WANDER_PERIOD_S {
            along.wander = Real::sqrt(wander - own);
            along.reading = Real::sqrt(own).max(MIN_OWN_SHARE * along.wander);
        }
        [along, across]
    }
}

#[cfg(test)]
mod tests;
