//! The baseline of a controller: open loop at the mean speed of the controller's own drive.

use super::outcome::DriveResult;

/// Open loop has the controller's mean speed within this share of it.
const SPEED_TOLERANCE: f64 = 0.01;
/// Drives of the search at most. Mean speed is nearly proportional to wheel speed: two or three suffice.
const MAX_DRIVES: usize = 6;
/// Wheels run at most at this multiple of the requested speed.
const MAX_SHARE: f64 = 8.0;
/// A difference of energy below this share is no gain.
pub const MIN_GAIN: f64 = 0.05;

/// The share of the requested speeds at which an open-loop drive has the mean speed of the controller's drive
/// `controlled`. Wheels that slip must run faster than the robot, so the share exceeds
/// [`DriveResult::pace`]. `open_loop` drives at a share.
///
/// The search ends early where open loop does not end as the controller does: there is no equal speed to find.
///
/// # Errors
/// Those of `open_loop`.
///
/// ```
/// use grouser_rover::drive::{Pilot, Simulation, equal_speed_share, read_scenario};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/slope.toml");
/// let mut scenario = read_scenario(file.as_ref())?;
/// scenario.duration = 4.0;
/// let drive = |scenario: &_, pilot| {
///     let mut simulation = Simulation::new(scenario, pilot, 0.3, 1)?;
///     Ok::<_, grouser_rover::Error>(simulation.run(|_| true))
/// };
/// let controlled = drive(&scenario, Pilot::Controller)?;
/// let share = equal_speed_share(&controlled, |share| drive(&scenario.at_pace(share), Pilot::OpenLoop))?;
/// let open_loop = drive(&scenario.at_pace(share), Pilot::OpenLoop)?;
/// assert!((open_loop.mean_speed() / controlled.mean_speed() - 1.0).abs() < 0.02);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
pub fn equal_speed_share<E>(
    controlled: &DriveResult,
    mut open_loop: impl FnMut(f64) -> Result<DriveResult, E>,
) -> Result<f64, E> {
    let mut share = controlled.pace();
    for _ in 0..MAX_DRIVES {
        let driven = open_loop(share)?;
        let ratio = controlled.mean_speed() / driven.mean_speed();
        if driven.outcome != controlled.outcome
            || !(ratio > 0.0 && ratio.is_finite())
            || (ratio - 1.0).abs() < SPEED_TOLERANCE
        {
            break;
        }
        share = (share * ratio).min(MAX_SHARE);
    }
    Ok(share)
}
