//! The wheel.

use crate::error::{Error, Result};
use crate::kernel::Kernel;

/// The least and greatest radius and width in m: from a toy's castor to a mining truck.
const SIZE: (f64, f64) = (1e-3, 100.0);

/// More lugs than any wheel has.
const MAX_LUGS: f64 = 1e4;

/// A rigid wheel: radius, width and, if it has them, grousers.
///
/// ```
/// use grouser_terra::RigidWheel;
/// let wheel = RigidWheel::new(0.10, 0.05)?; // radius and width in m
/// assert!(RigidWheel::new(-0.10, 0.05).is_err());
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidWheel {
    radius: f64,
    width: f64,
    grousers: Option<Grousers>,
}

/// Bars (lugs) across the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grousers {
    /// Height above the rim, h_g in m.
    pub height: f64,
    /// Which of the wheel's radii each law uses.
    pub rule: GrouserRule,
}

/// Which radius serves which law, r being the rim's and r_s = r + h_g the tips'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GrouserRule {
    /// r_s everywhere: closely spaced grousers carry the soil between them along like a solid drum.
    Tips,
    /// The normal stress is the mean of σ(r_s) and σ(r) by the share of area that tips make up; the
    /// shear displacement uses r; slip, forces, torque and the contact angles use r_s. As in the
    /// 3d-terramechanics code of Carnegie Mellon's Robomechanics Lab.
    AreaShare {
        /// The share μ of the surface that is grouser tip, in [0, 1].
        tips: f64,
    },
    /// r everywhere; where the wheel drives, lugs carry soil backwards
    /// ([`lug_transport_layer`](crate::lug_transport_layer)) and mobilise its strength sooner
    /// ([`lug_mobilisation`](crate::lug_mobilisation)). The rule that was held against measured wheels.
    Lugs {
        /// How many around the rim, N ≥ 1; an optimiser may pass between whole numbers.
        count: f64,
        /// Thickness t along the rim, m; N t is at most the circumference.
        thickness: f64,
    },
}

impl GrouserRule {
    /// The kernels that compute it.
    #[must_use]
    pub const fn kernels(&self) -> &'static [Kernel] {
        match self {
            Self::Tips | Self::AreaShare { .. } | Self::Lugs { .. } => Kernel::BUT_LANES,
        }
    }
}

impl RigidWheel {
    /// A smooth wheel of `radius` and `width` in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside [0.001, 100] m and for NaN.
    pub fn new(radius: f64, width: f64) -> Result<Self> {
        Error::check_range("radius", radius, SIZE.0, SIZE.1, "m")?;
        Error::check_range("width", width, SIZE.0, SIZE.1, "m")?;
        Ok(Self {
            radius,
            width,
            grousers: None,
        })
    }

    /// The same wheel with grousers.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a height that is negative or above the radius, or a share outside
    /// [0, 1].
    ///
    /// ```
    /// use grouser_terra::{GrouserRule, Grousers, RigidWheel};
    ///
    /// let bars = Grousers { height: 0.01, rule: GrouserRule::Tips };
    /// let wheel = RigidWheel::new(0.1, 0.05)?.with_grousers(bars)?;
    /// assert!((wheel.running_radius() - 0.11).abs() < 1e-15);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn with_grousers(self, grousers: Grousers) -> Result<Self> {
        Error::check_range("grouser_height", grousers.height, 0.0, self.radius, "m")?;
        match grousers.rule {
            GrouserRule::Tips => {}
            GrouserRule::AreaShare { tips } => Error::check_range("tips", tips, 0.0, 1.0, "1")?,
            GrouserRule::Lugs { count, thickness } => {
                Error::check_range("lug_count", count, 1.0, MAX_LUGS, "1")?;
                let room = core::f64::consts::TAU * self.radius / count;
                Error::check_range("lug_thickness", thickness, 0.0, room, "m")?;
            }
        }
        Ok(Self {
            grousers: Some(grousers),
            ..self
        })
    }

    /// Radius of the rim, m.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// Width, m.
    #[must_use]
    pub const fn width(&self) -> f64 {
        self.width
    }

    /// The grousers, if any.
    #[must_use]
    pub const fn grousers(&self) -> Option<Grousers> {
        self.grousers
    }

    /// Does a kernel compute wheels with these grousers?
    #[must_use]
    pub fn is_served_by(&self, kernel: Kernel) -> bool {
        self.grousers
            .is_none_or(|grousers| grousers.rule.kernels().contains(&kernel))
    }

    /// The radius that slip, forces, torque and the contact angles refer to, m: r, or r_s = r + h_g
    /// ([`GrouserRule`]).
    #[must_use]
    pub fn running_radius(&self) -> f64 {
        self.grousers
            .map_or(self.radius, |grousers| match grousers.rule {
                GrouserRule::Tips | GrouserRule::AreaShare { .. } => self.radius + grousers.height,
                GrouserRule::Lugs { .. } => self.radius,
            })
    }

    /// The radius that the shear displacement refers to, m.
    #[must_use]
    pub fn shear_radius(&self) -> f64 {
        self.grousers
            .map_or(self.radius, |grousers| match grousers.rule {
                GrouserRule::Tips => self.running_radius(),
                GrouserRule::AreaShare { .. } | GrouserRule::Lugs { .. } => self.radius,
            })
    }

    /// The share of the stress that acts at the tips' radius; the rest acts at the rim's.
    #[must_use]
    pub fn tip_share(&self) -> f64 {
        self.grousers.map_or(1.0, |grousers| match grousers.rule {
            GrouserRule::AreaShare { tips } => tips,
            GrouserRule::Tips | GrouserRule::Lugs { .. } => 1.0,
        })
    }
}
