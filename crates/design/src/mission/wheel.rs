//! What a mission chooses, the sizes of a wheel and where the chassis' mass lies, and their bounds.

use grouser_real::OutOfRange;
use grouser_terra::{GrouserRule, Grousers, RigidWheel};

use crate::error::{Error, Result};
use crate::quantity::Parameter;

/// How many numbers are chosen.
pub(super) const SIZES: usize = 6;
/// The place of the shift of the mass among them.
pub(super) const SHIFT: usize = 5;

/// The sizes in the order of [`WheelDesign::sizes`], with the parameter that each is.
pub(super) const PARAMETERS: [Parameter; WheelDesign::SIZES] = [
    Parameter::Radius,
    Parameter::Width,
    Parameter::GrouserHeight,
    Parameter::GrouserCount,
    Parameter::GrouserThickness,
];

/// No robot is longer.
const MAX_SHIFT_M: f64 = 100.0;

/// The place of the number of lugs among the sizes.
pub(super) const COUNT: usize = 3;

/// The sizes of a wheel, in m, smooth with 0 lugs; and where the mass of the chassis lies.
///
/// ```
/// use grouser_design::mission::WheelDesign;
///
/// let wheel = WheelDesign { radius: 0.15, width: 0.12, ..WheelDesign::default() };
/// assert_eq!(wheel.rigid()?.running_radius(), 0.15);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelDesign {
    /// Radius of the rim, m.
    pub radius: f64,
    /// Width, m.
    pub width: f64,
    /// Height of the lugs, m; 0 without lugs.
    pub grouser_height: f64,
    /// How many lugs there are; 0 for a smooth wheel.
    pub grouser_count: f64,
    /// Thickness of a lug along the rim, m.
    pub grouser_thickness: f64,
    /// How far the chassis' centre of mass lies in front of its present place, m: it shares the load out between the axles.
    pub mass_shift: f64,
}

impl WheelDesign {
    /// The sizes of a wheel; `None` for lugs that are a solid drum or a share of the surface, which have no number.
    #[must_use]
    pub fn from_wheel(wheel: &RigidWheel) -> Option<Self> {
        let smooth = Self {
            radius: wheel.radius(),
            width: wheel.width(),
            ..Self::default()
        };
        match wheel.grousers() {
            None => Some(smooth),
            Some(Grousers {
                height,
                rule: GrouserRule::Lugs { count, thickness },
            }) => Some(Self {
                grouser_height: height,
                grouser_count: count,
                grouser_thickness: thickness,
                ..smooth
            }),
            Some(_) => None,
        }
    }

    /// The wheel of these sizes.
    ///
    /// # Errors
    /// As [`RigidWheel::new`] and [`RigidWheel::with_grousers`].
    pub fn rigid(&self) -> grouser_terra::Result<RigidWheel> {
        let bare = RigidWheel::new(self.radius, self.width)?;
        match self.lugs() {
            Some(lugs) => bare.with_grousers(lugs),
            None => Ok(bare),
        }
    }

    /// Its lugs; `None` for a smooth wheel.
    #[must_use]
    pub fn lugs(&self) -> Option<Grousers> {
        (self.grouser_count > 0.0).then_some(Grousers {
            height: self.grouser_height,
            rule: GrouserRule::Lugs {
                count: self.grouser_count,
                thickness: self.grouser_thickness,
            },
        })
    }

    /// Its numbers in the order of [`WheelDesign::NAMES`].
    #[must_use]
    pub const fn sizes(&self) -> [f64; SIZES] {
        [
            self.radius,
            self.width,
            self.grouser_height,
            self.grouser_count,
            self.grouser_thickness,
            self.mass_shift,
        ]
    }

    /// How many of them are sizes of the wheel; they come first.
    pub const SIZES: usize = 5;

    /// Their names: the five sizes, as in files and in the formula of the mass, and the shift.
    pub const NAMES: [&'static str; SIZES] = [
        "radius_m",
        "width_m",
        "grouser_height_m",
        "grouser_count",
        "grouser_thickness_m",
        "mass_shift_m",
    ];

    pub(super) const fn from_sizes(sizes: [f64; SIZES]) -> Self {
        let [
            radius,
            width,
            grouser_height,
            grouser_count,
            grouser_thickness,
            mass_shift,
        ] = sizes;
        Self {
            radius,
            width,
            grouser_height,
            grouser_count,
            grouser_thickness,
            mass_shift,
        }
    }
}

/// The bounds of each size, (lowest, highest) in m; equal bounds fix a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelRanges {
    /// Of the rim's radius, m.
    pub radius: (f64, f64),
    /// Of the width, m.
    pub width: (f64, f64),
    /// Of the height of the lugs, m.
    pub grouser_height: (f64, f64),
    /// Of the number of lugs: whole numbers, (0, 0) for a smooth wheel.
    pub grouser_count: (f64, f64),
    /// Of the thickness of a lug, m.
    pub grouser_thickness: (f64, f64),
    /// Of the shift of the chassis' centre of mass forwards, m.
    pub mass_shift: (f64, f64),
}

impl WheelRanges {
    /// Every size fixed at that of `wheel`.
    ///
    /// ```
    /// use grouser_design::mission::{WheelDesign, WheelRanges};
    ///
    /// let wheel = WheelDesign { radius: 0.15, width: 0.12, ..WheelDesign::default() };
    /// assert_eq!(WheelRanges::fixed(&wheel).radius, (0.15, 0.15));
    /// ```
    #[must_use]
    pub const fn fixed(wheel: &WheelDesign) -> Self {
        Self {
            radius: (wheel.radius, wheel.radius),
            width: (wheel.width, wheel.width),
            grouser_height: (wheel.grouser_height, wheel.grouser_height),
            grouser_count: (wheel.grouser_count, wheel.grouser_count),
            grouser_thickness: (wheel.grouser_thickness, wheel.grouser_thickness),
            mass_shift: (wheel.mass_shift, wheel.mass_shift),
        }
    }

    /// The bounds in the order of [`WheelDesign::NAMES`].
    ///
    /// ```
    /// use grouser_design::mission::{WheelDesign, WheelRanges};
    ///
    /// let ranges = WheelRanges::fixed(&WheelDesign::default());
    /// assert_eq!(ranges.list()[1], ranges.width);
    /// ```
    #[must_use]
    pub const fn list(&self) -> [(f64, f64); SIZES] {
        [
            self.radius,
            self.width,
            self.grouser_height,
            self.grouser_count,
            self.grouser_thickness,
            self.mass_shift,
        ]
    }

    /// Bounds in their order, inside what the laws accept, and at least one size left to choose.
    pub(super) fn check(&self) -> Result<()> {
        for (name, (low, high)) in WheelDesign::NAMES.into_iter().zip(self.list()) {
            let unit = if name == "grouser_count" { "1" } else { "m" };
            let least = if name == WheelDesign::NAMES[SHIFT] {
                -MAX_SHIFT_M
            } else {
                0.0
            };
            OutOfRange::check(
                format!("lower bound of {name}"),
                low,
                (least, f64::MAX),
                unit,
            )
            .and_then(|()| {
                let limits = (low, f64::MAX);
                OutOfRange::check(format!("upper bound of {name}"), high, limits, unit)
            })
            .map_err(Error::OutOfRange)?;
        }
        let (fewest, most) = self.grouser_count;
        if fewest.fract() != 0.0 || most.fract() != 0.0 {
            return Err(Error::Mission(format!(
                "the bounds of grouser_count are {fewest} and {most}, but must be whole numbers"
            )));
        }
        if most > 0.0 && !(fewest >= 1.0 && self.grouser_height.0 > 0.0) {
            return Err(Error::Mission(
                "lugs need a grouser_count of at least 1 and a grouser_height_m above 0; design the smooth wheel in a \
                 run of its own"
                    .to_owned(),
            ));
        }
        if self.list().iter().all(|(low, high)| low == high) {
            return Err(Error::Mission(
                "every size of the wheel is fixed: nothing is left to choose".to_owned(),
            ));
        }
        // The corners of the box are wheels: thick lugs on a small rim have no room.
        for corner in [
            [self.radius.0, self.width.0, self.grouser_height.1, most],
            [self.radius.1, self.width.1, self.grouser_height.1, most],
        ] {
            let [radius, width, grouser_height, grouser_count] = corner;
            WheelDesign {
                radius,
                width,
                grouser_height,
                grouser_count,
                grouser_thickness: self.grouser_thickness.1,
                mass_shift: 0.0,
            }
            .rigid()
            .map_err(|source| Error::Law {
                of: format!("the wheel of {radius} m radius and {width} m width"),
                source,
            })?;
        }
        Ok(())
    }
}
