//! Which signal of a turning robot is described wrongly: hypotheses weighed by the disagreement that each explains.
//!
//! A row compares two signals. Its disagreement is 1 − r for the correlation r of signals in the range of scales that right ones have,
//! and 1 at least where the interval of their scale is outside it. A hypothesis takes a signal for a multiple of what it should be, or
//! for unrelated, and the sum over all rows, each by its independent parts, shows how much it leaves.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::comparison::{Comparison, Line};

/// What turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Signal {
    Gyro,
    /// The yaw of the reference.
    Yaw,
    /// The course of its places.
    Course,
    /// These wheels, bit by bit in the robot's order.
    Wheels(u64),
}

/// How a signal may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// It is this multiple of what it should be.
    Factor(f64),
    /// It has nothing to do with the others.
    Unrelated,
}

/// A signal with its fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cause {
    pub(crate) signal: Signal,
    pub(crate) fault: Fault,
}

/// y = a x of two signals.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    x: Signal,
    y: Signal,
    line: Line,
    /// The scales that right signals have.
    range: RangeInclusive<f64>,
    /// Of the row among rows of the same sensors.
    share: f64,
}

/// Turns of this sum of squares are no noise of a gyro or yaw, rad². Sensor noise.
const MIN_TURNS_SQUARE: f64 = 0.5;
/// Signals that agree have this correlation at least. Limit.
pub(crate) const MIN_CORRELATION: f64 = 0.7;
/// The disagreement of a signal with others to which it is unrelated: less than that of two right ones that hardly agree. Prior.
const UNRELATED: f64 = 0.5;
/// What turns by less than this share of the others is constant. Limit.
const CONSTANT_SHARE: f64 = 0.1;
/// Independent parts that a cause explains beyond the right description. Limit.
const MIN_GAIN: f64 = 3.0;
/// Causes that explain this share of what the first one does are listed with it. Limit.
const LISTED_SHARE: f64 = 0.8;
/// Degrees that are taken for radians.
const DEGREES: f64 = 180.0 / PI;
/// Scales of sensors of one quantity: only signs, units and axes are to be found. Limit.
pub(crate) const SENSORS: RangeInclusive<f64> = 0.5..=2.0;

impl Row {
    /// `None` where neither turns, or the parts do not suffice.
    pub(crate) fn new(
        [x, y]: [Signal; 2],
        comparison: &Comparison,
        range: &RangeInclusive<f64>,
        share: f64,
    ) -> Option<Self> {
        let line = comparison.line()?;
        let is_known = line.whole[0].max(line.whole[1]) > MIN_TURNS_SQUARE;
        is_known.then(|| Self {
            x,
            y,
            line,
            range: range.clone(),
            share,
        })
    }

    pub(crate) const fn line(&self) -> &Line {
        &self.line
    }

    fn touches(&self, signal: Signal) -> bool {
        let is_same = |own| match (own, signal) {
            (Signal::Wheels(own), Signal::Wheels(all)) => own & all != 0,
            (own, other) => own == other,
        };
        is_same(self.x) || is_same(self.y)
    }

    /// The disagreement that is left where `cause` holds.
    fn disagreement(&self, cause: Option<&Cause>) -> f64 {
        let Some(cause) = cause.filter(|cause| self.touches(cause.signal)) else {
            return self.at_factor(1.0);
        };
        match cause.fault {
            Fault::Unrelated => UNRELATED,
            Fault::Factor(factor) if self.x == cause.signal => self.at_factor(factor),
            Fault::Factor(factor) => self.at_factor(1.0 / factor),
        }
    }

    /// The disagreement where a is multiplied by a factor.
    fn at_factor(&self, factor: f64) -> f64 {
        let correlation = self.line.correlation * factor.signum();
        let (slope, half_width) = (
            self.line.slope * factor,
            self.line.half_width * factor.abs(),
        );
        let is_outside =
            slope + half_width < *self.range.start() || slope - half_width > *self.range.end();
        if is_outside {
            1.0 - correlation.min(0.0)
        } else {
            1.0 - correlation
        }
    }

    /// Is the scale outside its range with certainty?
    pub(crate) fn is_wrong(&self) -> bool {
        self.line.is_below(*self.range.start()) || self.line.is_above(*self.range.end())
    }

    pub(crate) fn is_between(&self, x: Signal, y: Signal) -> bool {
        self.x == x && self.y == y
    }

    pub(crate) fn agrees(&self) -> bool {
        !self.is_wrong() && self.line.correlation > MIN_CORRELATION
    }

    /// Is a signal constant where the other turns?
    fn is_constant(&self, signal: Signal) -> bool {
        let squares = self.line.squares;
        let (own, other) = if self.x == signal {
            (squares.xx, squares.yy)
        } else {
            (squares.yy, squares.xx)
        };
        own < CONSTANT_SHARE * CONSTANT_SHARE * other
    }

    /// Do the turns agree where `cause` holds?
    fn is_good(&self, cause: &Cause) -> bool {
        self.disagreement(Some(cause)) < 1.0 - MIN_CORRELATION
    }
}

/// The causes that explain the disagreement of rows best, the first one first; those of which each explains nearly the same. `is_steered`:
/// do the wheels turn the robot as they are steered?
pub(crate) fn weigh(rows: &[Row], exchanged: u64, is_steered: bool) -> Vec<Cause> {
    let candidates = candidates(rows, exchanged, is_steered);
    let left = |cause: Option<&Cause>| -> f64 {
        let each = rows
            .iter()
            .map(|row| row.share * row.line.parts * row.disagreement(cause));
        each.sum()
    };
    let all = left(None);
    let is_possible = |cause: &Cause| {
        let mut touched = rows.iter().filter(|row| row.touches(cause.signal));
        match cause.fault {
            Fault::Factor(_) => touched.any(|row| row.is_wrong() && row.is_good(cause)),
            // angles of steering may have nothing to do with the bends
            Fault::Unrelated if matches!(cause.signal, Signal::Wheels(_)) => {
                touched.next().is_some()
            }
            Fault::Unrelated => {
                touched.clone().next().is_some() && touched.all(|row| row.is_constant(cause.signal))
            }
        }
    };
    let possible = candidates.into_iter().filter(is_possible);
    let mut ranked: Vec<(f64, Cause)> = possible
        .map(|cause| (all - left(Some(&cause)), cause))
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = ranked.first().map_or(0.0, |(gain, _)| *gain);
    let listed = ranked
        .into_iter()
        .filter(|(gain, _)| best > MIN_GAIN && *gain > LISTED_SHARE * best);
    listed.map(|(_, cause)| cause).collect()
}

/// Faults that sensors have: signs, units, and other quantities.
fn candidates(rows: &[Row], exchanged: u64, is_steered: bool) -> Vec<Cause> {
    let mut all = Vec::new();
    let mut add = |signal, fault| all.push(Cause { signal, fault });
    if exchanged != 0 {
        add(Signal::Wheels(exchanged), Fault::Factor(-1.0));
    }
    // the scale of a gyro is measured by that of the yaw
    let by_yaw = rows
        .iter()
        .find(|row| row.is_between(Signal::Yaw, Signal::Gyro));
    match by_yaw.map(|row| row.line.slope) {
        Some(scale) if scale != 0.0 => add(Signal::Gyro, Fault::Factor(scale)),
        _ => {
            for factor in [-1.0, DEGREES, -DEGREES] {
                add(Signal::Gyro, Fault::Factor(factor));
            }
        }
    }
    for factor in [-1.0, DEGREES, -DEGREES, 1.0 / DEGREES] {
        add(Signal::Yaw, Fault::Factor(factor));
    }
    add(Signal::Course, Fault::Factor(-1.0));
    add(Signal::Gyro, Fault::Unrelated);
    add(Signal::Yaw, Fault::Unrelated);
    if is_steered {
        let wheels = Signal::Wheels(u64::MAX);
        let scales = rows.iter().filter_map(|row| match (row.x, row.y) {
            (Signal::Wheels(_), _) => Some(1.0 / row.line.slope),
            (_, Signal::Wheels(_)) => Some(row.line.slope),
            _ => None,
        });
        for factor in scales.filter(|scale| scale.is_finite() && *scale != 0.0) {
            add(wheels, Fault::Factor(factor));
        }
        add(wheels, Fault::Unrelated);
    }
    all
}
