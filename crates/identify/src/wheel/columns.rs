//! The columns of tables of wheel tests, for `identify` and for the measured data of `validate`: one list of names.
//!
//! A test bed that states the forces on its sensor has them with the other sign: `vertical_force_n`, `drag_force_n`, and
//! then `side_force_n` as well; its `height_mm` counts upwards.

use crate::error::Result;
use crate::table::{Column, Table};

/// Slip, in the wheel's plane or along the travel.
pub const SLIP: Column = Column(&[("slip", 1.0)]);
/// Slip angle, degrees: positive where the wheel drifts to its left.
pub const SLIP_ANGLE: Column = Column(&[("slip_angle_deg", 1.0)]);
/// Circumferential speed.
pub const RIM: Column = Column(&[
    ("rim_speed_m_per_s", 1.0),
    ("rim_speed_mm_per_s", 1e-3),
    ("rim_speed_mm_s", 1e-3),
]);
/// Travel speed.
pub const TRAVEL: Column = Column(&[
    ("travel_speed_m_per_s", 1.0),
    ("travel_speed_mm_per_s", 1e-3),
    ("carriage_speed_mm_s", 1e-3),
]);
/// Load.
pub const LOAD: Column = Column(&[
    ("load_n", 1.0),
    ("vertical_load_n", 1.0),
    (VERTICAL_FORCE, -1.0),
]);
/// Drawbar pull.
pub const PULL: Column = Column(&[
    ("drawbar_pull_n", 1.0),
    ("meas_drawbar_pull_n", 1.0),
    ("drag_force_n", -1.0),
]);
/// Side force, by [`side_force`].
pub const SIDE: Column = Column(&[("side_force_n", 1.0)]);
/// Torque.
pub const TORQUE: Column = Column(&[("torque_nm", 1.0), ("meas_torque_nm", 1.0)]);
/// Sinkage.
pub const SINKAGE: Column = Column(&[
    ("sinkage_m", 1.0),
    ("sinkage_mm", 1e-3),
    ("meas_sinkage_m", 1.0),
    ("height_mm", -1e-3),
]);
/// Standard deviation of the pull within a trial.
pub const PULL_DEVIATION: Column = Column(&[("drawbar_pull_sd_n", 1.0), ("drag_force_sd_n", 1.0)]);
/// Standard deviation of the side force within a trial.
pub const SIDE_DEVIATION: Column = Column(&[("side_force_sd_n", 1.0)]);
/// Standard deviation of the load within a trial.
pub const LOAD_DEVIATION: Column = Column(&[("load_sd_n", 1.0), ("vertical_force_sd_n", 1.0)]);
/// Standard deviations within a trial.
pub(crate) const DEVIATIONS: [Column; 3] = [PULL_DEVIATION, SIDE_DEVIATION, LOAD_DEVIATION];

const VERTICAL_FORCE: &str = "vertical_force_n";

/// Side forces, N, to the left; `None` where a row has none.
///
/// # Errors
/// As [`Table::optional`].
///
/// ```
/// use grouser_identify::table::Table;
/// use grouser_identify::wheel::columns::side_force;
///
/// let of_wheel = Table::parse("a.csv".as_ref(), "load_n,side_force_n\n20,-3\n")?;
/// let of_sensor = Table::parse("b.csv".as_ref(), "vertical_force_n,side_force_n\n-20,3\n")?;
/// assert_eq!(side_force(&of_wheel)?, side_force(&of_sensor)?);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn side_force(table: &Table) -> Result<Vec<Option<f64>>> {
    if !table.has(SIDE) {
        return Ok(vec![None; table.len()]);
    }
    let of_sensor = table.has(Column(&[(VERTICAL_FORCE, 1.0)]));
    let sign = if of_sensor { -1.0 } else { 1.0 };
    let forces = table.optional(SIDE)?.into_iter();
    Ok(forces
        .map(|force| force.map(|force| sign * force))
        .collect())
}
