//! Units of columns: name → quantity and the factor to SI.

/// What a unit measures.
///
/// ```
/// use grouser_files::unit::{Quantity, UNITS};
///
/// let (_, quantity, factor) = UNITS.iter().find(|(name, ..)| *name == "rpm").expect("a unit");
/// assert_eq!(*quantity, Quantity::AngularRate);
/// assert!((60.0 * factor - std::f64::consts::TAU).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// s.
    Time,
    /// m.
    Length,
    /// rad.
    Angle,
    /// m/s.
    Speed,
    /// rad/s.
    AngularRate,
    /// m/s².
    Acceleration,
    /// N m.
    Torque,
    /// A.
    Current,
    /// Whole ticks of a counter.
    Ticks,
    /// A number without a unit.
    Number,
}

/// Every unit: its name in files, what it measures, and what one of it is in SI.
pub const UNITS: &[(&str, Quantity, f64)] = &[
    ("s", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("us", Quantity::Time, 1e-6),
    ("ns", Quantity::Time, 1e-9),
    ("m", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 1e-2),
    ("mm", Quantity::Length, 1e-3),
    ("in", Quantity::Length, 0.0254),
    ("ft", Quantity::Length, 0.3048),
    ("rad", Quantity::Angle, 1.0),
    ("deg", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("turn", Quantity::Angle, std::f64::consts::TAU),
    // how receivers write latitudes as whole numbers
    (
        "1e-7 deg",
        Quantity::Angle,
        1e-7 * (std::f64::consts::PI / 180.0),
    ),
    ("m/s", Quantity::Speed, 1.0),
    ("cm/s", Quantity::Speed, 1e-2),
    ("mm/s", Quantity::Speed, 1e-3),
    ("km/h", Quantity::Speed, 1.0 / 3.6),
    ("in/s", Quantity::Speed, 0.0254),
    ("ft/s", Quantity::Speed, 0.3048),
    ("mph", Quantity::Speed, 0.447_04),
    ("rad/s", Quantity::AngularRate, 1.0),
    ("deg/s", Quantity::AngularRate, std::f64::consts::PI / 180.0),
    ("rpm", Quantity::AngularRate, std::f64::consts::TAU / 60.0),
    ("turn/s", Quantity::AngularRate, std::f64::consts::TAU),
    ("m/s2", Quantity::Acceleration, 1.0),
    ("g", Quantity::Acceleration, 9.806_65),
    ("N m", Quantity::Torque, 1.0),
    ("mN m", Quantity::Torque, 1e-3),
    ("A", Quantity::Current, 1.0),
    ("mA", Quantity::Current, 1e-3),
    ("tick", Quantity::Ticks, 1.0),
    ("1", Quantity::Number, 1.0),
];

impl Quantity {
    /// The units that measure it, with their factors.
    ///
    /// ```
    /// use grouser_files::unit::Quantity;
    ///
    /// let lengths = Quantity::Length.units();
    /// assert!(lengths.contains(&("in", 0.0254)));
    /// ```
    #[must_use]
    pub fn units(self) -> Vec<(&'static str, f64)> {
        UNITS
            .iter()
            .filter(|(_, quantity, _)| *quantity == self)
            .map(|(name, _, factor)| (*name, *factor))
            .collect()
    }
}
