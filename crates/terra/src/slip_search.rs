//! Roots and maxima over slip of what a wheel's laws give, which may have no value.

use grouser_real::Real;

/// How closely a root is found: far below what forces at standard accuracy can tell.
pub(crate) const ROOT_PRECISION: f64 = 1e-13;

/// The search for the root of a function between two points of opposite sign, one slip after the other: the secant with
/// Illinois' weight, which moves both ends, and a bisection now and then. A slip at which the function has no value counts as
/// below the root.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootSearch {
    low: (f64, f64),
    high: (f64, f64),
    precision: f64,
    moved_high: Option<bool>,
    steps: u32,
    slip: f64,
}

impl RootSearch {
    pub(crate) const fn new(low: (f64, f64), high: (f64, f64), precision: f64) -> Self {
        Self {
            low,
            high,
            precision,
            moved_high: None,
            steps: 0,
            slip: high.0,
        }
    }

    /// The slip at which the function is wanted next; `None` where the root is known.
    pub(crate) fn next_slip(&mut self) -> Option<f64> {
        let ((a, f_a), (b, f_b)) = (self.low, self.high);
        self.steps += 1;
        if self.steps >= 200 || b - a <= self.precision || f_b == 0.0 {
            return None;
        }
        let secant = b - f_b * (b - a) / (f_b - f_a);
        // past the root by less than the precision, so that the last step moves the other end
        let past = if self.moved_high == Some(true) {
            -1.0
        } else {
            1.0
        };
        let secant = secant + past * 0.4 * self.precision;
        self.slip = if !self.steps.is_multiple_of(6) && secant > a && secant < b {
            secant
        } else {
            0.5 * (a + b)
        };
        Some(self.slip)
    }

    /// Takes the function's value at that slip.
    pub(crate) fn feed(&mut self, value: Option<f64>) {
        match value {
            Some(value) if value >= 0.0 => {
                if self.moved_high == Some(true) {
                    self.low.1 *= 0.5;
                }
                self.moved_high = Some(true);
                self.high = (self.slip, value);
            }
            Some(value) => {
                if self.moved_high == Some(false) {
                    self.high.1 *= 0.5;
                }
                self.moved_high = Some(false);
                self.low = (self.slip, value);
            }
            None => {
                self.moved_high = None;
                self.low.0 = self.slip;
            }
        }
    }

    /// The end of the bracket at which the function is not negative.
    pub(crate) const fn root(&self) -> f64 {
        self.high.0
    }
}

/// The root of `f` between two points of opposite sign, to `precision`, where it is not negative ([`RootSearch`]).
pub(crate) fn root<E>(
    low: (f64, f64),
    high: (f64, f64),
    precision: f64,
    mut f: impl FnMut(f64) -> Result<Option<f64>, E>,
) -> Result<f64, E> {
    let mut search = RootSearch::new(low, high, precision);
    while let Some(slip) = search.next_slip() {
        search.feed(f(slip)?);
    }
    Ok(search.root())
}

/// The search for the greatest value of a function over slips within `reach` of a first one and from 0 to `end`, one slip after the
/// other: Brent's method, parabolas through the best three points and golden section where they do not serve. A slip without a
/// value is never the best.
///
/// Source: Brent, *Algorithms for Minimization without Derivatives* (1973), chapter 5.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaximumSearch {
    precision: f64,
    /// The search also ends where the best three values differ by less than this share.
    flat: f64,
    bracket: (f64, f64),
    /// Best, second and third point.
    best: [(f64, f64); 3],
    step: f64,
    before: f64,
    steps: u32,
    phase: Phase,
    end: f64,
    slip: f64,
}

/// What a search for a maximum does next.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// A search that starts at an end looks first whether the function falls from there.
    Beside,
    Inside,
    /// A maximum at an end of all slips is approached by golden section only: the ends themselves.
    AtLow,
    AtHigh,
    Done,
}

const MAXIMUM_STEPS: u32 = 60;

/// How far beside an end a search looks first, share of its reach: what a maximum in between exceeds the end by is the square of
/// that.
const BESIDE_SHARE: f64 = 1e-4;

impl MaximumSearch {
    /// A search that starts at a slip and its value.
    pub(crate) fn new(
        start: (f64, f64),
        end: f64,
        (reach, precision): (f64, f64),
        flat: f64,
    ) -> Self {
        let near = start.0;
        let is_at_end = near == 0.0 || near == end;
        Self {
            precision,
            flat,
            bracket: ((near - reach).max(0.0), (near + reach).min(end)),
            best: [start; 3],
            step: 0.0,
            before: 0.0,
            steps: 0,
            phase: if is_at_end && start.1 > f64::NEG_INFINITY {
                Phase::Beside
            } else {
                Phase::Inside
            },
            end,
            slip: near,
        }
    }

    /// The slip at which the function is wanted next; `None` where the maximum is known.
    pub(crate) fn next_slip(&mut self) -> Option<f64> {
        loop {
            let (phase, end) = match self.phase {
                Phase::Beside => {
                    let (low, high) = self.bracket;
                    let aside = BESIDE_SHARE * (high - low);
                    self.slip = if self.slip == 0.0 {
                        aside
                    } else {
                        self.slip - aside
                    };
                    return Some(self.slip);
                }
                Phase::Inside if self.steps < MAXIMUM_STEPS && !self.is_enclosed() => {
                    self.steps += 1;
                    self.slip = self.next_inside();
                    return Some(self.slip.clamp(0.0, self.end));
                }
                Phase::Inside => {
                    self.phase = Phase::AtLow;
                    continue;
                }
                Phase::AtLow => (Phase::AtHigh, 0.0),
                Phase::AtHigh => (Phase::Done, self.end),
                Phase::Done => return None,
            };
            self.phase = phase;
            if (self.best[0].0 - end).abs() <= self.precision {
                self.slip = end;
                return Some(end);
            }
        }
    }

    /// Takes the function's value at that slip.
    pub(crate) fn feed(&mut self, value: Option<f64>) {
        let u = (self.slip, value.unwrap_or(f64::NEG_INFINITY));
        if matches!(self.phase, Phase::Beside) {
            let falls = u.1 < self.best[0].1;
            self.phase = if falls { Phase::Done } else { Phase::Inside };
            return;
        }
        let [x, w, v] = &mut self.best;
        let (a, b) = &mut self.bracket;
        if !matches!(self.phase, Phase::Inside) {
            if u.1 >= x.1 {
                *x = u;
            }
        } else if u.1 >= x.1 {
            if u.0 >= x.0 {
                *a = x.0;
            } else {
                *b = x.0;
            }
            (*v, *w, *x) = (*w, *x, u);
        } else {
            if u.0 < x.0 {
                *a = u.0;
            } else {
                *b = u.0;
            }
            if u.1 >= w.1 || w.0 == x.0 {
                (*v, *w) = (*w, u);
            } else if u.1 >= v.1 || v.0 == x.0 || v.0 == w.0 {
                *v = u;
            }
        }
    }

    /// The slip of the greatest value, and that value.
    pub(crate) const fn best(&self) -> (f64, f64) {
        (self.best[0].0.clamp(0.0, self.end), self.best[0].1)
    }

    /// The least step.
    const fn least(&self) -> f64 {
        0.3 * self.precision
    }

    fn is_enclosed(&self) -> bool {
        let ([x, w, v], (a, b)) = (self.best, self.bracket);
        let is_flat = x.0 != w.0 && w.0 != v.0 && x.1 - v.1.min(w.1) < self.flat * x.1.abs();
        is_flat || (x.0 - 0.5 * (a + b)).abs() <= 2.0 * self.least() - 0.5 * (b - a)
    }

    /// The next slip inside the bracket: a parabola's, or golden section's.
    fn next_inside(&mut self) -> f64 {
        let ([x, w, v], (a, b), least) = (self.best, self.bracket, self.least());
        let mut parabola = None;
        if self.before.abs() > least {
            let r = (x.0 - w.0) * (x.1 - v.1);
            let q = (x.0 - v.0) * (x.1 - w.1);
            let p = (x.0 - v.0) * q - (x.0 - w.0) * r;
            let q = 2.0 * (q - r);
            let wish = if q == 0.0 { f64::NAN } else { -p / q };
            let inside = x.0 + wish > a && x.0 + wish < b;
            if inside && wish.abs() < 0.5 * self.before.abs() {
                parabola = Some(wish);
            }
        }
        let golden = 0.5 * (3.0 - Real::sqrt(5.0_f64));
        (self.before, self.step) = if let Some(wish) = parabola {
            (self.step, wish)
        } else {
            let side = if x.0 < 0.5 * (a + b) {
                b - x.0
            } else {
                a - x.0
            };
            (side, golden * side)
        };
        let moved = if self.step.abs() >= least {
            self.step
        } else if self.step < 0.0 {
            -least
        } else {
            least
        };
        x.0 + moved
    }
}

/// Slips at which a curve is sampled before its optimum or its root is refined.
pub(crate) const SAMPLES: u32 = 33;

/// Precision of the place of an optimum, and the share by which the best values differ at least: forces have rounding errors
/// of that size, so that the place is known to about its root.
const BEST_PRECISION: f64 = 1e-9;
const BEST_FLAT: f64 = 1e-13;

/// Slips between samples of a pull at most: it has one maximum or rises to the end.
const HELD_SPACING_SLIP: f64 = 0.05;

/// The search for the greatest value of a function over all slips from 0 to an end, one slip after the other: samples, then
/// [`MaximumSearch`] about each that may have the greatest value beside it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BestSearch {
    end: f64,
    count: usize,
    /// Nothing is looked for where the function may not reach this.
    floor: f64,
    taken: usize,
    values: [f64; SAMPLES as usize],
    best: (f64, f64),
    /// The samples before this one have been looked at.
    looked_at: usize,
    refined: Option<MaximumSearch>,
}

impl BestSearch {
    /// Over [0, 1], for a function with several maxima.
    pub(crate) const fn new() -> Self {
        Self {
            end: 1.0,
            count: SAMPLES as usize,
            floor: f64::NEG_INFINITY,
            taken: 0,
            values: [f64::NEG_INFINITY; SAMPLES as usize],
            best: (0.0, f64::NEG_INFINITY),
            looked_at: 0,
            refined: None,
        }
    }

    /// Over [0, `end`], for a pull.
    pub(crate) fn of_pull(end: f64) -> Self {
        let mut own = Self::new();
        own.end = end;
        let mut steps = 4;
        while steps + 1 < SAMPLES as usize && steps as f64 * HELD_SPACING_SLIP < end - 1e-9 {
            steps += 1;
        }
        own.count = 1 + steps;
        own
    }

    /// The slip of a sample.
    fn sample_slip(&self, k: usize) -> f64 {
        self.end * (k as f64 / (self.count - 1) as f64)
    }

    /// The slip at which the function is wanted next; `None` where the best is known.
    pub(crate) fn next_slip(&mut self) -> Option<f64> {
        if self.taken < self.count {
            return Some(self.sample_slip(self.taken));
        }
        loop {
            if let Some(refined) = &mut self.refined {
                if let Some(slip) = refined.next_slip() {
                    return Some(slip);
                }
                let found = refined.best();
                if found.1 > self.best.1 {
                    self.best = found;
                }
                self.refined = None;
            }
            let k = self.looked_at;
            let &value = self.values[..self.count].get(k)?;
            self.looked_at += 1;
            if self.may_be_best(k) {
                let (start, reach) = ((self.sample_slip(k), value), self.sample_slip(1));
                let reach = (reach, BEST_PRECISION);
                self.refined = Some(MaximumSearch::new(start, self.end, reach, BEST_FLAT));
            }
        }
    }

    /// Is a sample greater than its neighbours, and may the function be greatest beside it? One with a single maximum there
    /// exceeds it by no more than it changes to its neighbours.
    fn may_be_best(&self, k: usize) -> bool {
        let value = self.values[k];
        let before = k.checked_sub(1).map(|k| self.values[k]);
        let after = self.values[..self.count].get(k + 1).copied();
        let is_peak =
            before.is_none_or(|before| value > before) && after.is_none_or(|after| value >= after);
        let change = |other: Option<f64>| other.map_or(0.0, |other| value - other);
        is_peak
            && value > f64::NEG_INFINITY
            && value + change(before).max(change(after)) >= self.best.1.max(self.floor)
    }

    /// Takes the function's value at that slip.
    pub(crate) fn feed(&mut self, value: Option<f64>) {
        if let Some(refined) = &mut self.refined {
            return refined.feed(value);
        }
        let value = value.unwrap_or(f64::NEG_INFINITY);
        if value > self.best.1 {
            self.best = (self.sample_slip(self.taken), value);
        }
        if let Some(sample) = self.values.get_mut(self.taken) {
            *sample = value;
        }
        self.taken += 1;
    }

    /// Slip and value of the best; `None` where the function has no value at any sample.
    pub(crate) fn best(&self) -> Option<(f64, f64)> {
        (self.best.1 > f64::NEG_INFINITY).then_some(self.best)
    }
}

/// The search for the slip of smallest magnitude, up to a greatest one, at which a surplus of pull vanishes: driving where it is
/// negative at slip 0, else braking. Samples from 0 on, then the greatest surplus between them, then the root.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldSearch {
    samples: BestSearch,
    /// +1 driving, −1 braking.
    pub(crate) sense: f64,
    slip: f64,
    /// The sample before, with its value.
    before: Option<(f64, f64)>,
    root: Option<RootSearch>,
}

impl HeldSearch {
    /// With `is_brief` the greatest surplus of what is not held is known to its samples only.
    pub(crate) fn new(max_slip: f64, is_brief: bool) -> Self {
        let mut samples = BestSearch::of_pull(max_slip);
        if is_brief {
            samples.floor = 0.0;
        }
        Self {
            samples,
            sense: 1.0,
            slip: 0.0,
            before: None,
            root: None,
        }
    }

    /// The slip at which the surplus is wanted next; `None` at the end.
    pub(crate) fn next_slip(&mut self) -> Option<f64> {
        let next = match &mut self.root {
            Some(root) => root.next_slip(),
            None => self.samples.next_slip(),
        };
        self.slip = next?;
        Some(self.sense * self.slip)
    }

    /// Takes the surplus at that slip.
    pub(crate) fn feed(&mut self, surplus: Option<f64>) {
        let slip = self.slip;
        if slip == 0.0 && surplus.is_some_and(|surplus| surplus > 0.0) {
            self.sense = -1.0;
        }
        let value = surplus.map(|surplus| self.sense * surplus);
        if let Some(root) = &mut self.root {
            return root.feed(value);
        }
        if let Some(value) = value.filter(|value| *value >= 0.0) {
            let k = self.samples.looked_at.saturating_sub(1);
            let below = |k: usize| (self.samples.sample_slip(k), self.samples.values[k]);
            let low = match self.before {
                // between samples about the best one
                _ if self.samples.refined.is_some() => {
                    below(if slip > below(k).0 { k } else { k - 1 })
                }
                Some(before) => before,
                None => (slip, 0.0),
            };
            // where nothing carries the wheel there is no value: it counts as below
            let low = (low.0, if low.1.is_finite() { low.1 } else { -value });
            self.root = Some(RootSearch::new(low, (slip, value), ROOT_PRECISION));
            return;
        }
        self.before = Some((slip, value.unwrap_or(f64::NEG_INFINITY)));
        self.samples.feed(value);
    }

    /// The slip that holds.
    pub(crate) fn held(&self) -> Option<f64> {
        self.root.as_ref().map(|root| self.sense * root.root())
    }

    /// The greatest surplus of driving, with its slip first.
    pub(crate) fn best(&self) -> Option<(f64, f64)> {
        self.samples.best()
    }
}

/// The greatest value of `f` over slips within `reach` of `near` and from 0 to `end`, and where ([`MaximumSearch`]).
pub(crate) fn maximum<E>(
    near: f64,
    end: f64,
    (reach, precision): (f64, f64),
    f: impl Fn(f64) -> Result<Option<f64>, E>,
) -> Result<(f64, f64), E> {
    let start = (near, f(near)?.unwrap_or(f64::NEG_INFINITY));
    let mut search = MaximumSearch::new(start, end, (reach, precision), 0.0);
    while let Some(slip) = search.next_slip() {
        search.feed(f(slip)?);
    }
    Ok(search.best())
}

/// The root of a growing `f` beside a slip that is nearly right, within one of some reaches, the least first; `None` where there
/// is none.
pub(crate) fn root_near<E>(
    near: f64,
    reaches: &[f64],
    f: impl Fn(f64) -> Result<Option<f64>, E>,
) -> Result<Option<f64>, E> {
    for reach in reaches {
        let (low, high) = ((near - reach).max(-1.0), (near + reach).min(1.0));
        if let (Some(at_low), Some(at_high)) = (f(low)?, f(high)?)
            && at_low < 0.0
            && at_high >= 0.0
        {
            return root((low, at_low), (high, at_high), ROOT_PRECISION, f).map(Some);
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests;
