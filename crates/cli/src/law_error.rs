//! The laws' errors in the words of the command: flags and columns instead of fields, and their units:
//! degrees instead of radians, kPa instead of Pa.

use grouser_terra::{Error as LawError, OutOfRange};
use serde_json::Value;

use crate::error::{Details, Error, Kind};
use grouser_report::number::in_message;

/// Whose names a message uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Names {
    /// `--radius-m`
    Flags,
    /// `radius_m`
    Columns,
}

/// The laws' fields and the columns (flags) that give them.
const COLUMNS: [(&str, &str); 23] = [
    ("radius", "radius_m"),
    ("width", "width_m"),
    ("rebound", "rebound"),
    ("grouser_height", "grouser_height_m"),
    ("lug_count", "grouser_count"),
    ("lug_thickness", "grouser_thickness_m"),
    ("slip", "slip"),
    ("sinkage", "sinkage_m"),
    ("load", "load_n"),
    ("weight", "load_n"),
    ("mass", "mass_kg"),
    ("slip_angle", "slip_angle_deg"),
    ("slope", "slope_deg"),
    ("theta", "theta_deg"),
    ("mobilised", "mobilised"),
    ("k_shear", "k_shear_m"),
    ("c_1", "c_1"),
    ("c_2", "c_2"),
    ("unit_weight", "unit_weight_n_per_m3"),
    ("phi", "phi_deg"),
    ("cohesion", "cohesion_kpa"),
    ("k_c", "k_c_kn_per_m_n1"),
    ("k_phi", "k_phi_kn_per_m_n2"),
];

impl Names {
    /// The name of a law's field in backticks.
    pub(crate) fn of(self, field: &str) -> String {
        let column = COLUMNS
            .iter()
            .find(|(name, _)| *name == field)
            .map(|(_, column)| *column);
        match (self, column) {
            (Self::Flags, Some(column)) => format!("`--{}`", column.replace('_', "-")),
            (Self::Columns, Some(column)) => format!("`{column}`"),
            (_, None) => format!("`{field}`"),
        }
    }

    /// What the laws refuse, as an error of the command.
    pub(crate) fn error(self, error: &LawError) -> Error {
        let details = match *error {
            LawError::OutOfRange(OutOfRange {
                value,
                low,
                high,
                unit,
                ..
            }) => {
                let (scale, unit) = in_column(unit);
                let limit = vec![low * scale, high * scale].into();
                details((value * scale).into(), limit, &unit)
            }
            LawError::NotAbove {
                value, limit, unit, ..
            } => {
                let (scale, unit) = in_column(unit);
                details((value * scale).into(), (limit * scale).into(), &unit)
            }
            LawError::HubBuried { sinkage, radius } => details(sinkage.into(), radius.into(), " m"),
            _ => Details::default(),
        };
        Error::new(Kind::Value, self.message(error), None).with(Details {
            field: error
                .field()
                .map(|field| self.of(field).trim_matches('`').to_owned()),
            ..details
        })
    }

    /// What the laws refuse: the name, the value, the limit and the unit.
    pub(crate) fn message(self, error: &LawError) -> String {
        match *error {
            LawError::OutOfRange(OutOfRange {
                field,
                value,
                low,
                high,
                unit,
            }) => {
                let (scale, unit) = in_column(unit);
                let [value, low, high] = [value * scale, low * scale, high * scale];
                let limit = if high >= f64::MAX {
                    format!("be at least {}{unit}", in_message(low))
                } else {
                    format!("lie in [{}, {}]{unit}", in_message(low), in_message(high))
                };
                format!(
                    "{} is {}{unit}, but must {limit}",
                    self.of(field),
                    in_message(value)
                )
            }
            LawError::NotAbove {
                field,
                value,
                limit,
                unit,
            } => {
                let (scale, unit) = in_column(unit);
                let [value, limit] = [value * scale, limit * scale].map(in_message);
                format!(
                    "{} is {value}{unit}, but must be greater than {limit}{unit}",
                    self.of(field)
                )
            }
            LawError::NotFinite { field, value, unit } => {
                let (_, unit) = in_column(unit);
                format!(
                    "{} is {value}{unit}, but must be a finite number",
                    self.of(field)
                )
            }
            LawError::Missing { field, needed_by } => {
                format!("{} is missing, but {needed_by} needs it", self.of(field))
            }
            LawError::HubBuried { sinkage, radius } => format!(
                "{} is {} m, but must stay below the wheel's radius, {} m (the hub is buried)",
                self.of("sinkage"),
                in_message(sinkage),
                in_message(radius)
            ),
            LawError::ReboundAboveHub {
                rebound,
                sinkage,
                radius,
            } => format!(
                "{} is {} at a sinkage of {} m, but their product must stay below the wheel's radius, {} m",
                self.of("rebound"),
                in_message(rebound),
                in_message(sinkage),
                in_message(radius)
            ),
            ref other => other.to_string(),
        }
    }
}

fn details(value: Value, limit: Value, unit: &str) -> Details {
    Details {
        value,
        limit,
        unit: Some(unit.trim_start().to_owned()).filter(|unit| !unit.is_empty()),
        ..Details::default()
    }
}

/// What a value in `unit` is multiplied with for its column, and the column's unit with a space before it; a pure number has none.
fn in_column(unit: &str) -> (f64, String) {
    match unit {
        "rad" => (1_f64.to_degrees(), " deg".to_owned()),
        "Pa" | "N/m^(n+1)" | "N/m^(n+2)" => (1e-3, format!(" k{unit}")),
        "1" => (1.0, String::new()),
        unit => (1.0, format!(" {unit}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grouser_terra::{Angle, Kinematics, RigidWheel, Slip};

    #[test]
    fn flags_columns_and_degrees() {
        let error = Slip::new(2.0).unwrap_err();
        let flags = Names::Flags.message(&error);
        assert_eq!(flags, "`--slip` is 2, but must lie in [-1, 1]");
        let error = RigidWheel::new(f64::NAN, 0.1).unwrap_err();
        let columns = Names::Columns.message(&error);
        assert_eq!(
            columns,
            "`radius_m` is NaN m, but must lie in [0.001, 100] m"
        );
        let error = Kinematics::with_slip_angle(Slip::ZERO, Angle::from_deg(95.0)).unwrap_err();
        let flags = Names::Flags.message(&error);
        assert_eq!(
            flags,
            "`--slip-angle-deg` is 95 deg, but must lie in [-89.9, 89.9] deg"
        );
    }
}
