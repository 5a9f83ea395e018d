//! By how much the reference's stamps are later than those of wheels and gyro.
//!
//! A camera's pictures take time to evaluate, receivers average, and clocks of two computers differ. A delay that nobody states
//! turns each change of speed into a change of slip.

mod fit;
mod postponed;
mod rims;
mod steps;
mod track;
mod tracks;

use std::fmt;

use grouser_files::robot::RobotFile;
use grouser_log::Log;

use crate::error::Result;
use crate::held::Held;
use crate::method::Method;
use crate::options::Options;
use fit::{Delays, Fitted, Kind, fit};
pub(crate) use postponed::Postponed;
use tracks::Tracks;

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
/// Wheels and gyro are on one clock. Rates of wheels count as means since the reading before: if they are of the moment of
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
                ": not applied, too much for a delay. Are the clocks of two computers apart? `time = \"log\"` in `[topics]` \
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

    /// Uses the delay where it is clear and the file states none: as the filter's latency, or, of a reference that is early, by
    /// postponing it. Returns by how much that is, ns.
    pub(crate) fn apply(&mut self, file: &mut RobotFile, method: Method) -> i64 {
        if !self.is_clear || self.is_stated || self.is_beyond_correction() {
            return 0;
        }
        if self.delay_s < 0.0 {
            self.is_applied = true;
            #[allow(
                clippy::cast_possible_truncation,
                reason = "it is at most half a second"
            )]
            return (self.delay_s * -1e9).round() as i64;
        }
        self.is_applied = method == Method::Filter;
        if self.is_applied {
            file.filter.reference_latency = self.delay_s;
        }
        0
    }
}

/// The delay of the reference in several logs, each a run. `None` where they do not show it: too short, no absolute reference, or
/// hardly a change of speed or of turn, or where halves of the logs or wheels and gyro contradict each other.
///
/// # Errors
/// What is wrong with a log.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_replay::{Options, calibrate_reference_delay};
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// // A free wheel is on the clock of the other wheels.
/// assert!(calibrate_reference_delay(&[log], &robot, &Options::default())?.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn calibrate_reference_delay(
    logs: &[Log],
    file: &RobotFile,
    options: &Options,
) -> Result<Option<ReferenceDelay>> {
    let tracks = logs
        .iter()
        .map(|log| Tracks::of(log, file, options, &[], Held::of(log, file, options, &[])?))
        .collect::<Result<Vec<_>>>()?;
    Ok(delay_of(&tracks, file))
}

/// The delay of the reference in a log, to whose clocks `shifts` are added, ns.
pub(crate) fn reference_delay(
    log: &Log,
    file: &RobotFile,
    options: &Options,
    shifts: &[i64],
    held: &Held,
) -> Result<Option<ReferenceDelay>> {
    let tracks = Tracks::of(log, file, options, shifts, held.clone())?;
    Ok(delay_of(&[tracks], file))
}

fn delay_of(logs: &[Tracks], file: &RobotFile) -> Option<ReferenceDelay> {
    let stated_s = file.filter.reference_latency;
    let within = |delays| {
        let pairs = logs.iter().flat_map(|tracks| {
            [
                (Kind::Way, &tracks.rims, tracks.ways.as_slice()),
                (Kind::Turn, &tracks.gyro, tracks.turns.as_slice()),
            ]
        });
        let is_measured = |fitted: &Fitted| {
            let [low, high] = fitted.possible_s;
            let is_clear = !fitted.is_contradicted && !fitted.is_ambiguous && !fitted.is_at_end;
            high - low < MAX_POSSIBLE_S && is_clear
        };
        fit(pairs, stated_s, delays).filter(is_measured)
    };
    let Fitted {
        delay_s,
        half_width_s,
        possible_s: [low, high],
        ..
    } = within(CORRECTED).or_else(|| within(CLOCKS))?;
    Some(ReferenceDelay {
        delay_s: stated_s + delay_s,
        half_width_s,
        stated_s,
        is_stated: file.is_reference_latency_stated || stated_s != 0.0,
        is_clear: (low > TOLERANCE_S || high < -TOLERANCE_S) && delay_s.abs() > MIN_DELAY_S,
        is_applied: false,
    })
}
