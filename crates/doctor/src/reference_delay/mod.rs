//! By how much the reference's stamps are later than those of wheels and gyro.
//!
//! A camera's pictures take time to evaluate, receivers average, and clocks of two computers differ. A delay that nobody states
//! turns each change of speed into a change of slip.

mod fit;
mod rims;
mod steps;
mod track;
mod tracks;

use std::fmt;

use grouser_files::robot::RobotFile;

pub(crate) use fit::{Delays, Kind, blocks_of, range};
use fit::{Fitted, fit};
use tracks::Passed;
pub use tracks::Tracks;

/// Possible delays wider than this are no measurement, s.
const MAX_POSSIBLE_S: f64 = 0.25;
/// A shorter delay is none, s: rates of wheels are means up to their stamp, or of its moment, which differ by half a sample; and
/// no possible one may be shorter than the tolerance.
const TOLERANCE_S: f64 = 0.02;
const MIN_DELAY_S: f64 = 0.03;
/// The delays that are corrected: the filter's latency is at most 1 s.
const CORRECTED: Delays = Delays {
    min_s: -0.5,
    max_s: 1.0,
    step_s: 0.025,
    max_readings: usize::MAX,
};
/// Those between clocks of two computers, which are reported. The readings limit the search to about a second of computing.
const CLOCKS: Delays = Delays {
    min_s: -8.0,
    max_s: 8.0,
    step_s: 0.05,
    max_readings: 1500,
};

/// By how much the reference's stamps are later than those of wheels and gyro, as logs show it.
///
/// Rates of wheels count as means since the reading before: if they are of the moment of
/// their stamp, half of their period is in the delay.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReferenceDelay {
    /// The delay, s, in all; negative where wheels and gyro are late.
    pub delay_s: f64,
    /// Half of its 95 % interval, s.
    pub half_width_s: f64,
    /// What the robot file states, s; 0 where it states none.
    pub stated_s: f64,
    /// Does the robot file state one? Then it is used, whatever the log shows.
    pub is_stated: bool,
    /// Does the delay differ from what is stated, by more than 0.03 s, and by 0.02 s with four standard deviations?
    pub is_clear: bool,
    /// Did the run use it?
    pub is_applied: bool,
    /// By how much the gyro's stamps are later than those of the wheels, s, where they differ: the delay is then that to the wheels.
    pub gyro_delay_s: Option<f64>,
}

impl fmt::Display for ReferenceDelay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (delay_s, half_width_s) = (self.delay_s, self.half_width_s);
        if delay_s < 0.0 {
            let early_s = -delay_s;
            write!(
                f,
                "the reference is stamped {early_s:.3} ± {half_width_s:.3} s early"
            )?;
        } else {
            write!(
                f,
                "the reference lags by {delay_s:.3} ± {half_width_s:.3} s"
            )?;
        }
        write!(f, " (95 %)")?;
        if !self.is_clear {
            return Ok(());
        }
        if self.is_beyond_correction() {
            return write!(
                f,
                ": not applied, too much for a delay. Do the clocks of two computers disagree? `time = \"log\"` in `[topics]` \
                 takes the recorder's times, `offset_s` in `time` of its table shifts those of a table"
            );
        }
        if self.is_stated {
            return write!(
                f,
                ", but `reference_latency_s` is {}: not applied",
                self.stated_s
            );
        }
        write!(f, ": {}applied", if self.is_applied { "" } else { "not " })?;
        if delay_s < 0.0 {
            write!(
                f,
                ", `offset_s = {:.3}` in `time` of its table states it",
                -delay_s
            )
        } else {
            write!(
                f,
                ", `reference_latency_s = {delay_s:.3}` in `[filter]` states it"
            )
        }
    }
}

impl ReferenceDelay {
    /// Is it longer than what is corrected, −0.5 s to 1 s? Then it is of clocks that are apart.
    #[must_use]
    pub fn is_beyond_correction(&self) -> bool {
        !(CORRECTED.min_s..=CORRECTED.max_s).contains(&self.delay_s)
    }

    /// The delay of the reference in several logs, each a run; `None` where they do not show it: too short, no absolute
    /// reference, hardly a change of speed or of turn, or where halves of the logs contradict each other. Where those of the wheels do,
    /// it is that of the gyro.
    #[must_use]
    pub fn find(logs: &[Tracks], file: &RobotFile) -> Option<Self> {
        let stated_s = file.filter.reference_latency;
        let within = |delays, kinds: &[Kind]| measured(logs, stated_s, delays, kinds);
        // wheels and gyro agree, or each has a delay of its own
        let both = |delays| {
            if let Some(joint) = within(delays, &[Kind::Way, Kind::Turn]) {
                return Some((joint, None));
            }
            let turn = within(delays, &[Kind::Turn])?;
            // a gyro does not slip: where slip hides the wheels' delay, or makes several of it, theirs is the gyro's
            Some(match within(delays, &[Kind::Way]) {
                Some(way) => (way, Some(way.delay_s - turn.delay_s)),
                None => (turn, None),
            })
        };
        let (fitted, gyro_delay_s) = both(CORRECTED).or_else(|| both(CLOCKS))?;
        let Fitted {
            delay_s,
            half_width_s,
            possible_s: [low, high],
            ..
        } = fitted;
        Some(Self {
            delay_s: stated_s + delay_s,
            half_width_s,
            stated_s,
            is_stated: file.is_reference_latency_stated || stated_s != 0.0,
            is_clear: (low > TOLERANCE_S || high < -TOLERANCE_S) && delay_s.abs() > MIN_DELAY_S,
            is_applied: false,
            gyro_delay_s,
        })
    }
}

/// How much later than the wheels' clock that of the gyro stamps the same moment, s, by the turns of both; `None` where the log does not
/// turn enough. `tracks` are those of [`Reference::Grip`](grouser_slip::Reference::Grip).
#[must_use]
pub fn gyro_offset(tracks: &Tracks) -> Option<f64> {
    let logs = std::slice::from_ref(tracks);
    Some(-measured(logs, 0.0, CORRECTED, &[Kind::Turn])?.delay_s)
}

/// The delay by ways, turns, or both, where the logs show one.
fn measured(logs: &[Tracks], stated_s: f64, delays: Delays, kinds: &[Kind]) -> Option<Fitted> {
    let pairs = logs.iter().flat_map(|tracks| {
        [
            (Kind::Way, &tracks.rims.track, tracks.ways.as_slice()),
            (Kind::Turn, &tracks.gyro, tracks.turns.as_slice()),
        ]
    });
    let is_measured = |fitted: &Fitted| {
        let [low, high] = fitted.possible_s;
        let is_clear = !fitted.is_contradicted && !fitted.is_ambiguous && !fitted.is_at_end;
        high - low < MAX_POSSIBLE_S && is_clear
    };
    let of_kinds = pairs.filter(|(kind, ..)| kinds.contains(kind));
    fit(of_kinds, stated_s, delays).filter(is_measured)
}
