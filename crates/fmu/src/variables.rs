//! The variables of the unit, declared once: the description and the functions of the standard read this list.

use grouser_terra::Caution;

/// A continuous variable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Variable {
    /// Its name, with its unit.
    pub name: &'static str,
    /// Its unit in the description; empty for a pure number.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Its limits, if it is an input.
    pub limits: Option<(f64, f64)>,
}

/// How many inputs there are.
pub const INPUTS: usize = 3;
/// How many continuous outputs there are.
pub const OUTPUTS: usize = 4;

macro_rules! variables {
    ($($name:literal [$unit:literal] $meaning:literal $(, from $low:literal to $high:expr)?;)+) => {
        /// Inputs, then outputs; a value reference is the place in this list, plus 1 (0 is the time).
        pub const VARIABLES: [Variable; INPUTS + OUTPUTS] = [$(Variable {
            name: $name,
            unit: $unit,
            meaning: $meaning,
            limits: { let limits = None; $(let _: Option<(f64, f64)> = limits; let limits = Some(($low, $high));)? limits },
        }),+];
    };
}

variables! {
    "load_n" ["N"] "load that the wheel carries", from 0.0 to f64::MAX;
    "slip" [""] "slip, from -1 (locked) by 0 to 1 (spinning on the spot)", from -1.0 to 1.0;
    "slip_angle_deg" ["deg"] "slip angle, positive where the wheel drifts to its left", from -89.9 to 89.9;
    "sinkage_m" ["m"] "sinkage";
    "drawbar_pull_n" ["N"] "drawbar pull, forwards";
    "side_force_n" ["N"] "force of the soil on the wheel, to the left";
    "torque_nm" ["N.m"] "torque, positive where a motor drives";
}

/// Value reference of the time.
pub(crate) const TIME: u32 = 0;
/// Value reference of the status, an enumeration.
pub(crate) const STATUS: u32 = 50;
/// Value reference of the first caution, a Boolean each.
pub(crate) const CAUTIONS: u32 = 100;

/// The place of a value reference in [`VARIABLES`].
pub(crate) fn place(reference: u32) -> Option<usize> {
    let place = usize::try_from(reference).ok()?.checked_sub(1)?;
    (place < VARIABLES.len()).then_some(place)
}

/// The cautions with their value references.
pub(crate) fn cautions() -> impl Iterator<Item = (u32, Caution)> {
    (CAUTIONS..).zip(Caution::ALL)
}
