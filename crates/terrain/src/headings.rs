//! The directions in which a robot may look on a map.

use std::f64::consts::TAU;

use crate::error::{Error, Result};

/// 4, 8 or 16 directions, the first along x (east), then counter-clockwise.
///
/// ```
/// use grouser_terrain::Headings;
///
/// let headings = Headings::new(8)?;
/// assert!((headings.angle(2) - std::f64::consts::FRAC_PI_2).abs() < 1e-15); // north
/// assert_eq!(headings.step(1), (1, 1));
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Headings(u8);

/// Steps of 16 headings in cells; of 8 every second, of 4 every fourth. Those between the diagonals are knight's moves, whose
/// angle is 26.57° and not 22.5°: [`Headings::angle`] is the angle of the step.
const STEPS: [(i32, i32); 16] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

impl Headings {
    /// 4, 8 or 16 of them.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for another number.
    pub fn new(count: u8) -> Result<Self> {
        if matches!(count, 4 | 8 | 16) {
            return Ok(Self(count));
        }
        let value = f64::from(count);
        Err(Error::OutOfRange {
            of: "map (4, 8 or 16 are possible)".to_owned(),
            range: grouser_terra::OutOfRange {
                field: "headings",
                value,
                low: 4.0,
                high: 16.0,
                unit: "1",
            },
        })
    }

    /// How many.
    #[must_use]
    pub const fn count(self) -> usize {
        self.0 as usize
    }

    /// The step of a heading: cells to the right and up.
    #[must_use]
    pub const fn step(self, heading: usize) -> (i32, i32) {
        STEPS[heading % self.count() * (16 / self.count())]
    }

    /// The direction of a heading's step, rad from x towards y, in [0, 2π).
    #[must_use]
    pub fn angle(self, heading: usize) -> f64 {
        let (right, up) = self.step(heading);
        f64::from(up).atan2(f64::from(right)).rem_euclid(TAU)
    }

    /// The heading nearest to an angle (rad).
    ///
    /// ```
    /// let headings = grouser_terrain::Headings::new(8)?;
    /// assert_eq!(headings.nearest(-0.7), 7);
    /// # Ok::<(), grouser_terrain::Error>(())
    /// ```
    #[must_use]
    pub fn nearest(self, angle: f64) -> usize {
        let off = |heading: usize| {
            let difference = (self.angle(heading) - angle).rem_euclid(TAU);
            difference.min(TAU - difference)
        };
        (0..self.count())
            .min_by(|a, b| off(*a).total_cmp(&off(*b)))
            .unwrap_or(0)
    }
}
