//! The slip that a slope requires, and the steepest slope: one solver for a wheel, for a robot, and for a cell of a map.
//!
//! A caller gives the surplus of pull at a slip, Σ drawbar pulls − W sin α, N; `None` where a wheel is not carried. A slope is
//! held where the surplus vanishes at a slip of at most the greatest one, driving or braking.

use crate::slip_search::{self, BestSearch, HeldSearch, ROOT_PRECISION, maximum};

/// The greatest slip at which a slope counts as held where no other is given: the laws do not count the thrust that disturbed
/// soil loses under a spinning wheel.
pub const MAX_SLIP: f64 = 0.6;

/// Limits of the greatest slip of a robot: beyond them a wheel spins nearly on the spot, or nothing is held.
pub const MAX_SLIP_LIMITS: (f64, f64) = (0.01, 0.95);

/// Slips between samples of the pull before the steepest slope is sought: the pull has one maximum, or rises to the end.
const SCAN_STEP: f64 = 1.0 / 8.0;

/// The first round of the search for the steepest slope, and all others: reach and precision of the slip, precision of the
/// slope (rad). What the slip lacks counts in the slope by its square, and forces at standard accuracy tell no more.
const FIRST_ROUND: (f64, f64, f64) = (SCAN_STEP, 3e-3, 1e-4);
const LAST_ROUND: (f64, f64, f64) = (0.02, 1e-5, ROOT_PRECISION);

/// What a slope of the first round may lack beside its precision: ten times what forces to 1e-6 tell, rad.
const ROUGH_RAD: f64 = 1e-5;

/// Slope and slip are found in turn at most so often; two rounds are enough.
const SLOPE_ROUNDS: u32 = 12;

/// What slip holds a slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeldSlip {
    /// This one, and none of smaller magnitude; negative: the wheels brake.
    Holds(f64),
    /// Too little pull at every slip up to the greatest. The greatest surplus, N; `None` where no slip carries the load.
    Immobilised(Option<f64>),
    /// Too much pull even where the wheels brake at the greatest slip.
    Slides,
}

/// The slip of smallest magnitude, at most `max_slip`, at which `surplus` (N) vanishes.
///
/// # Errors
/// Those of `surplus`.
///
/// ```
/// use grouser_terra::slope::{HeldSlip, held_slip};
/// let surplus = |slip: f64| Ok::<_, ()>(Some(10.0 * slip - 3.0));
/// let Ok(HeldSlip::Holds(slip)) = held_slip(0.6, surplus) else { panic!("0.3 holds it") };
/// assert!((slip - 0.3).abs() < 1e-12);
/// assert_eq!(held_slip(0.2, surplus), Ok(HeldSlip::Immobilised(Some(-1.0))));
/// ```
pub fn held_slip<E>(
    max_slip: f64,
    surplus: impl Fn(f64) -> Result<Option<f64>, E>,
) -> Result<HeldSlip, E> {
    let mut search = HeldSearch::new(max_slip, false);
    while let Some(slip) = search.next_slip() {
        search.feed(surplus(slip)?);
    }
    Ok(match search.held() {
        Some(slip) => HeldSlip::Holds(slip),
        None if search.sense < 0.0 => HeldSlip::Slides,
        None => HeldSlip::Immobilised(search.best().map(|best| best.1)),
    })
}

/// The slip from 0 to `max_slip` of the greatest surplus (N), and that surplus; `None` where no slip carries the load.
///
/// # Errors
/// Those of `surplus`.
///
/// ```
/// use grouser_terra::slope::greatest_surplus;
/// let found = greatest_surplus(0.6, |slip| Ok::<_, ()>(Some(slip * (1.0 - slip)))).unwrap();
/// let (slip, surplus) = found.expect("every slip has a value");
/// assert!((slip - 0.5).abs() < 1e-6 && (surplus - 0.25).abs() < 1e-12);
/// ```
pub fn greatest_surplus<E>(
    max_slip: f64,
    surplus: impl Fn(f64) -> Result<Option<f64>, E>,
) -> Result<Option<(f64, f64)>, E> {
    let mut search = BestSearch::of_pull(max_slip);
    while let Some(slip) = search.next_slip() {
        search.feed(surplus(slip)?);
    }
    Ok(search.best())
}

/// The slip between two at which a rising `surplus` vanishes, to `precision`: its values there are negative and not negative.
///
/// # Errors
/// Those of `surplus`.
pub fn crossing<E>(
    low: (f64, f64),
    high: (f64, f64),
    precision: f64,
    surplus: impl FnMut(f64) -> Result<Option<f64>, E>,
) -> Result<f64, E> {
    slip_search::root(low, high, precision, surplus)
}

/// Where the steepest slope is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeSearch {
    /// N: no slope takes less pull than its sine.
    pub weight: f64,
    /// The slopes, rad: from one that is held up to the steepest one that counts.
    pub slopes: (f64, f64),
    /// The greatest slip.
    pub max_slip: f64,
    /// A slip that holds the steepest slope nearly, of a neighbouring problem.
    pub near: Option<f64>,
}

impl SlopeSearch {
    /// The steepest slope (rad) at which the surplus, of slope and slip, is not negative at a slip of at most the greatest one,
    /// and that slip; `rough` is the same to 1e-6 of the weight. `None` where it is negative on the first slope.
    ///
    /// Slope and slip are found in turn: at a fixed slip the surplus falls with the slope, and at a fixed slope the slip of the
    /// greatest surplus is sought beside the last one. Since the pull is flat there, what the slip lacks counts in the slope by
    /// its square.
    ///
    /// # Errors
    /// Those of the surplus.
    ///
    /// ```
    /// use grouser_terra::slope::SlopeSearch;
    /// let search = SlopeSearch { weight: 20.0, slopes: (0.0, 1.4), max_slip: 0.6, near: None };
    /// let surplus = |slope: f64, slip: f64| Ok::<_, ()>(Some(20.0 * (0.5 * slip * slope.cos() - slope.sin())));
    /// let (slope, slip) = search.steepest(surplus, surplus).unwrap().expect("the level is held");
    /// assert!((slope - 0.3_f64.atan()).abs() < 1e-12 && slip == 0.6);
    /// ```
    pub fn steepest<E>(
        &self,
        rough: impl Fn(f64, f64) -> Result<Option<f64>, E>,
        surplus: impl Fn(f64, f64) -> Result<Option<f64>, E>,
    ) -> Result<Option<(f64, f64)>, E> {
        let from = self.slopes.0;
        let Some((mut slip, mut left)) = self.start(|slip| rough(from, slip))? else {
            return Ok(None);
        };
        if left < ROUGH_RAD * self.weight {
            // between two samples the wheel may still pull
            let reach = (SCAN_STEP, LAST_ROUND.1);
            (slip, left) = maximum(slip, self.max_slip, reach, |slip| surplus(from, slip))?;
            if left < 0.0 {
                return Ok(None);
            }
        }
        let mut slope = self.slope_held(slip, (from, left), FIRST_ROUND.2, &rough)?;
        (slope, slip) = self.round((slope, slip), FIRST_ROUND, &rough)?;
        slope = (slope - ROUGH_RAD).max(from);
        for _ in 0..SLOPE_ROUNDS {
            let before = slip;
            (slope, slip) = self.round((slope, slip), LAST_ROUND, &surplus)?;
            if (slip - before).abs() < FIRST_ROUND.1 {
                break;
            }
        }
        Ok(Some((slope, slip)))
    }

    /// The slip of a neighbouring problem, or the best of some samples, and its value; `None` where there is no value at all.
    fn start<E>(
        &self,
        of: impl Fn(f64) -> Result<Option<f64>, E>,
    ) -> Result<Option<(f64, f64)>, E> {
        if let Some(near) = self.near
            && let Some(value) = of(near)?
            && value >= 0.0
        {
            return Ok(Some((near, value)));
        }
        let mut steps = 1_u32;
        while f64::from(steps) * SCAN_STEP < self.max_slip - 1e-9 {
            steps += 1;
        }
        let mut best: Option<(f64, f64)> = None;
        for i in 0..=steps {
            let slip = self.max_slip * (f64::from(i) / f64::from(steps));
            if let Some(value) = of(slip)?
                && best.is_none_or(|best| value > best.1)
            {
                best = Some((slip, value));
            }
        }
        Ok(best)
    }

    /// The slip of the greatest surplus beside `slip` on `slope`, and the slope that it holds, first.
    fn round<E>(
        &self,
        (slope, slip): (f64, f64),
        (reach, precision, slope_precision): (f64, f64, f64),
        surplus: &impl Fn(f64, f64) -> Result<Option<f64>, E>,
    ) -> Result<(f64, f64), E> {
        let reach = (reach, precision);
        let (slip, left) = maximum(slip, self.max_slip, reach, |slip| surplus(slope, slip))?;
        let from = (slope, left.max(0.0));
        let slope = self.slope_held(slip, from, slope_precision, surplus)?;
        Ok((slope, slip))
    }

    /// The slope (rad) above `from` at which `surplus` at `slip` ends, its value at `from` being known and not negative.
    fn slope_held<E>(
        &self,
        slip: f64,
        from: (f64, f64),
        precision: f64,
        surplus: impl Fn(f64, f64) -> Result<Option<f64>, E>,
    ) -> Result<f64, E> {
        let (mut low, mut step) = (from, (from.1 / self.weight).max(precision).max(1e-9));
        loop {
            let alpha = (low.0 + step).min(self.slopes.1);
            let Some(left) = surplus(alpha, slip)? else {
                return Ok(low.0);
            };
            if left < 0.0 {
                let mirrored = |x: f64| surplus(-x, slip);
                let (first, last) = ((-alpha, left), (-low.0, low.1));
                return Ok(-slip_search::root(first, last, precision, mirrored)?);
            }
            if alpha >= self.slopes.1 {
                return Ok(alpha);
            }
            (low, step) = ((alpha, left), 2.0 * step);
        }
    }
}

#[cfg(test)]
mod tests;
