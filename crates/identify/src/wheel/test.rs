//! One wheel test.

use grouser_terra::{FittedRange, Kinematics, RigidWheel};

/// A steady state that was measured: what was set, and what of the rest was read.
///
/// ```
/// use grouser_identify::wheel::{Quantity, Support, WheelTest};
/// use grouser_terra::{Kinematics, Slip};
///
/// let test = WheelTest {
///     kinematics: Kinematics::straight(Slip::new(0.2)?),
///     support: Support::Load(80.0), // N
///     pull: Some(12.0),             // N
///     side: None,
///     torque: None,
///     sinkage: None,
/// };
/// assert_eq!(test.read(Quantity::Pull), Some(12.0));
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelTest {
    /// How the wheel moved.
    pub kinematics: Kinematics,
    /// What holds it up.
    pub support: Support,
    /// Drawbar pull, N, forwards.
    pub pull: Option<f64>,
    /// Side force, N, to the left.
    pub side: Option<f64>,
    /// Torque, N m.
    pub torque: Option<f64>,
    /// Sinkage, m, above a datum that may be unknown.
    pub sinkage: Option<f64>,
}

/// What is known of how deep a wheel sits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Support {
    /// The soil carries this load, N; the model finds the sinkage.
    Load(f64),
    /// It is held at this sinkage, m (at most the radius); the load is not looked at.
    Sinkage(f64),
}

/// What a test reads.
///
/// ```
/// use grouser_identify::wheel::Quantity;
///
/// assert_eq!(Quantity::ALL.map(Quantity::unit), ["N", "N", "N m", "mm"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quantity {
    /// Drawbar pull.
    Pull,
    /// Side force.
    Side,
    /// Torque.
    Torque,
    /// Sinkage.
    Sinkage,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 4] = [Self::Pull, Self::Side, Self::Torque, Self::Sinkage];

    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Pull => "pull",
            Self::Side => "side_force",
            Self::Torque => "torque",
            Self::Sinkage => "sinkage",
        }
    }

    /// The unit in which tables show it.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Pull | Self::Side => "N",
            Self::Torque => "N m",
            Self::Sinkage => "mm",
        }
    }

    /// SI per unit of [`Quantity::unit`].
    #[must_use]
    pub const fn scale(self) -> f64 {
        match self {
            Self::Sinkage => 1e-3,
            _ => 1.0,
        }
    }
}

impl WheelTest {
    /// What the test reads of `quantity`, SI.
    #[must_use]
    pub const fn read(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Pull => self.pull,
            Quantity::Side => self.side,
            Quantity::Torque => self.torque,
            Quantity::Sinkage => self.sinkage,
        }
    }
}

/// The range of slip, slip angle, width and load of `tests` of a wheel; `None` without tests. Where a test holds
/// the wheel at a sinkage, its load is not known, and any load counts as fitted.
#[must_use]
pub fn fitted_range(wheel: &RigidWheel, tests: &[WheelTest]) -> Option<FittedRange> {
    /// No bound on the load.
    const ANY_LOAD: (f64, f64) = (0.0, 1e12);
    if tests.is_empty() {
        return None;
    }
    let span = |of: &dyn Fn(&WheelTest) -> f64| {
        let values = tests.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    let all_loaded = tests
        .iter()
        .all(|test| matches!(test.support, Support::Load(_)));
    Some(FittedRange {
        slip: span(&|test| test.kinematics.slip().value()),
        slip_angle: span(&|test| test.kinematics.slip_angle().rad().abs()),
        width: (wheel.width(), wheel.width()),
        load: if all_loaded {
            span(&|test| match test.support {
                Support::Load(load) => load,
                Support::Sinkage(_) => f64::NAN,
            })
        } else {
            ANY_LOAD
        },
    })
}

/// Standard deviation of one reading from trial to trial, SI: what residuals are divided by.
///
/// ```
/// use grouser_identify::wheel::{Quantity, Scatter};
///
/// let scatter = Scatter { pull: 0.5, side: 0.5, torque: 0.05, sinkage: 7e-4 };
/// assert_eq!(scatter.of(Quantity::Sinkage), 7e-4); // m
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Pull, N.
    pub pull: f64,
    /// Side force, N.
    pub side: f64,
    /// Torque, N m.
    pub torque: f64,
    /// Sinkage, m.
    pub sinkage: f64,
}

/// That of a bench with a load cell of a newton and a scale of millimetres.
impl Default for Scatter {
    fn default() -> Self {
        Self {
            pull: 1.0,
            side: 1.0,
            torque: 0.1,
            sinkage: 1e-3,
        }
    }
}

impl Scatter {
    /// That of `quantity`.
    #[must_use]
    pub const fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Pull => self.pull,
            Quantity::Side => self.side,
            Quantity::Torque => self.torque,
            Quantity::Sinkage => self.sinkage,
        }
    }
}
