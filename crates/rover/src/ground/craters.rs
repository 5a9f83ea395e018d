//! Fields of craters, by the frequency of their sizes.

use super::shape::Lattice;
use grouser_real::Real;

/// Craters of a surface in equilibrium: as many form as fade.
///
/// N(≥D) = `density` / D² craters with diameters of D and more lie on a unit of area. A crater is a
/// paraboloid with a depth of 0.196 D from its rim, whose rim is 0.036 D above the plane, with a blanket that
/// falls as the cube of the distance and ends at 2 radii; all heights are faded by a factor that is uniform
/// from 0.1 to 1. Craters add up.
///
/// Source: D^−2 and the density 10^−1.1: Trask (1966), as the Moon's maria have it; Minton et al. (2019)
/// discuss both. Depth and rim of fresh craters: Pike (1977), whose exponents of 1.010 and 1.014 are taken
/// for 1. The factor of fading is this project's: fresh and faded craters alike.
/// Valid range: the law is counted from metres to some hundreds of metres.
///
/// ```
/// use grouser_rover::ground::Craters;
///
/// let craters = Craters { density: Craters::EQUILIBRIUM_DENSITY, min_diameter: 2.0, max_diameter: 16.0 };
/// let found = craters.within(7, (0.0, 0.0), (500.0, 500.0));
/// let expected = 250_000.0 * Craters::EQUILIBRIUM_DENSITY * (2.0_f64.powi(-2) - 16.0_f64.powi(-2));
/// assert!((found.len() as f64 / expected - 1.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Craters {
    /// N(≥D) D².
    pub density: f64,
    /// Least diameter, m.
    pub min_diameter: f64,
    /// Greatest diameter, m.
    pub max_diameter: f64,
}

/// A crater.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Crater {
    /// Middle, m.
    pub x: f64,
    /// m.
    pub y: f64,
    /// From rim to rim, m.
    pub diameter: f64,
    /// Heights as a share of those of a fresh crater.
    pub freshness: f64,
}

/// Depth below the rim and height of the rim of a fresh crater, as shares of the diameter.
const DEPTH_SHARE: f64 = 0.196;
const RIM_SHARE: f64 = 0.036;
/// The blanket ends at this many radii.
const BLANKET_RADII: f64 = 2.0;
/// The least freshness.
const MIN_FRESHNESS: f64 = 0.1;
/// Diameters of a class differ by up to this factor; its lattice has cells of twice the greatest diameter, so
/// that no crater reaches beyond the cells beside its own.
const CLASS_FACTOR: f64 = 2.0;
/// More craters of a class in a cell are not drawn: fewer than one cell in 10^5 has as many in equilibrium.
const MAX_IN_CELL: u64 = 8;
/// Random numbers of a crater, and of a cell.
const NUMBERS: u64 = 4;
const NUMBERS_OF_CLASS: u64 = NUMBERS * MAX_IN_CELL + 1;

impl Craters {
    /// N(≥D) D² in equilibrium: 10^−1.1.
    pub const EQUILIBRIUM_DENSITY: f64 = 0.079_432_823;

    /// The least diameter of each class.
    fn classes(self) -> impl Iterator<Item = (u64, f64)> {
        let classes = (0..).map(move |class: u32| {
            (
                u64::from(class),
                self.min_diameter * Real::powi(CLASS_FACTOR, class.cast_signed()),
            )
        });
        classes.take_while(move |(_, least)| *least < self.max_diameter)
    }

    /// Calls `see` for each crater of a class in a cell of its lattice.
    fn of_cell(
        self,
        seed: u64,
        (class, least): (u64, f64),
        (column, row): (i64, i64),
        mut see: impl FnMut(Crater),
    ) {
        let number = |index: u64| {
            let own = seed.wrapping_add(class * NUMBERS_OF_CLASS + index);
            Lattice::new(own).node(column, row)
        };
        let side = side(least);
        let share = 1.0 - Real::powi(CLASS_FACTOR, -2);
        let mean = self.density * share * Real::powi(side / least, 2);
        // Poisson's distribution by inversion
        let (mut left, mut probability, mut count) = (number(0), Real::exp(-mean), 0);
        while left > probability && count < MAX_IN_CELL {
            left -= probability;
            count += 1;
            probability *= mean / count as f64;
        }
        for index in 0..count {
            let first = 1 + NUMBERS * index;
            let diameter = least / (1.0 - share * number(first)).sqrt();
            if diameter <= self.max_diameter {
                see(Crater {
                    x: (column as f64 + number(first + 1)) * side,
                    y: (row as f64 + number(first + 2)) * side,
                    diameter,
                    freshness: MIN_FRESHNESS + (1.0 - MIN_FRESHNESS) * number(first + 3),
                });
            }
        }
    }

    /// The craters whose middles lie in a rectangle.
    #[must_use]
    pub fn within(&self, seed: u64, low: (f64, f64), high: (f64, f64)) -> Vec<Crater> {
        let mut out = Vec::new();
        for class in self.classes() {
            let side = side(class.1);
            for column in cell(low.0, side)..=cell(high.0, side) {
                for row in cell(low.1, side)..=cell(high.1, side) {
                    self.of_cell(seed, class, (column, row), |crater| {
                        let inside = (low.0..high.0).contains(&crater.x)
                            && (low.1..high.1).contains(&crater.y);
                        if inside {
                            out.push(crater);
                        }
                    });
                }
            }
        }
        out
    }

    /// The height at a place, m.
    #[must_use]
    pub fn height(&self, seed: u64, x: f64, y: f64) -> f64 {
        self.along(seed, y)(x)
    }

    /// The heights along x at one `y`: the craters of the cells around serve until the line leaves their middle.
    pub(super) fn along(self, seed: u64, y: f64) -> impl FnMut(f64) -> f64 {
        let mut classes: Vec<_> = self
            .classes()
            .map(|class| (class, i64::MIN, Vec::new()))
            .collect();
        move |x| {
            let mut sum = 0.0;
            for (class, around, craters) in &mut classes {
                let side = side(class.1);
                let (column, row) = (cell(x, side), cell(y, side));
                if column != *around {
                    *around = column;
                    craters.clear();
                    for column in column - 1..=column + 1 {
                        for row in row - 1..=row + 1 {
                            let see = |crater| craters.push(crater);
                            self.of_cell(seed, *class, (column, row), see);
                        }
                    }
                }
                for crater in &*craters {
                    sum += crater.height(x, y);
                }
            }
            sum
        }
    }
}

impl Crater {
    /// What it adds to the height at a place, m.
    #[must_use]
    pub fn height(&self, x: f64, y: f64) -> f64 {
        let radii = Real::hypot(x - self.x, y - self.y) / (0.5 * self.diameter);
        let scale = self.freshness * self.diameter;
        if radii < 1.0 {
            return scale * (RIM_SHARE - DEPTH_SHARE * (1.0 - radii * radii));
        }
        let end = Real::powi(BLANKET_RADII, -3);
        let blanket = (Real::powi(radii, -3) - end) / (1.0 - end);
        scale * RIM_SHARE * blanket.max(0.0)
    }
}

/// The side of a class's lattice, m.
fn side(least: f64) -> f64 {
    BLANKET_RADII * CLASS_FACTOR * least
}

fn cell(at: f64, side: f64) -> i64 {
    #[allow(clippy::cast_possible_truncation, reason = "maps end at 1e8 cells")]
    let cell = (at / side).floor() as i64;
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARIA: Craters = Craters {
        density: Craters::EQUILIBRIUM_DENSITY,
        min_diameter: 2.0,
        max_diameter: 32.0,
    };

    #[test]
    fn sizes_have_the_frequency_of_the_law() {
        let side = 1500.0;
        let found = MARIA.within(3, (-200.0, 100.0), (-200.0 + side, 100.0 + side));
        for least in [2.0, 3.1, 5.0, 8.0, 13.0, 20.0_f64] {
            let counted = found.iter().filter(|crater| crater.diameter >= least);
            let counted = counted.count() as f64;
            let law = Craters::EQUILIBRIUM_DENSITY * (least.powi(-2) - 32.0_f64.powi(-2));
            let expected = law * side * side;
            // four sigmas of a Poisson distribution
            let off = (counted - expected).abs() / expected.sqrt();
            assert!(off < 4.0, "{least}: {counted} of {expected}");
        }
        let mean = found.iter().map(|crater| crater.x).sum::<f64>() / found.len() as f64;
        assert!((mean - 550.0).abs() < 10.0, "{mean}");
    }

    #[test]
    fn the_relief_is_the_sum_of_its_craters_and_has_no_step() {
        let (low, high) = ((-80.0, -80.0), (120.0, 120.0));
        let craters = MARIA.within(9, low, high);
        let sum = |x: f64, y: f64| craters.iter().map(|c| c.height(x, y)).sum::<f64>();
        let (mut before, mut deepest) = (MARIA.height(9, 0.0, 7.3), 0.0_f64);
        for step in 1..4000 {
            let x = 0.01 * f64::from(step);
            let here = MARIA.height(9, x, 7.3);
            assert!((here - sum(x, 7.3)).abs() < 1e-12, "{x}");
            // the wall of a fresh crater is steeper than anything else: 4 × 0.196
            assert!((here - before).abs() < 0.01 * 3.0 * 0.8, "{x}");
            deepest = deepest.min(here);
            before = here;
        }
        assert!(deepest < -0.1);
    }

    #[test]
    fn a_fresh_crater_has_the_depth_and_the_rim_of_its_source() {
        let crater = Crater {
            x: 1.0,
            y: 2.0,
            diameter: 10.0,
            freshness: 1.0,
        };
        assert!((crater.height(6.0, 2.0) - 0.36).abs() < 1e-12);
        assert!((crater.height(6.0, 2.0) - crater.height(1.0, 2.0) - 1.96).abs() < 1e-12);
        assert!(crater.height(1.0, 12.0).abs() < 1e-12);
    }
}
