//! Shapes of generated ground, each from a seed.

use grouser_real::Real;

use super::craters::Craters;
use super::noise::Noise;

/// A shape of the ground: height over (x, y) in m.
///
/// ```
/// use grouser_rover::ground::Shape;
///
/// let slope = Shape::Slope { angle: 0.2, from: 1.0 };
/// assert_eq!(slope.height(0, 0.5, 0.0), 0.0);
/// assert!((slope.height(0, 3.0, 0.0) - 2.0 * 0.2_f64.tan()).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// Level.
    Flat,
    /// A plane that rises towards `towards` from x = `from` on.
    Slope {
        /// rad.
        angle: f64,
        /// m.
        from: f64,
    },
    /// Ridges across x, gentle on the side of the wind, steep behind, wandering and of uneven height.
    Dunes {
        /// From trough to crest, m.
        height: f64,
        /// From crest to crest, m.
        length: f64,
    },
    /// Fractal ground: value noise, each octave half as long and `roughness` as high.
    Fractal {
        /// Standard deviation of the longest octave, m.
        height: f64,
        /// Its length, m.
        length: f64,
        /// In (0, 1).
        roughness: f64,
    },
    /// A field of craters.
    Craters(Craters),
}

/// Rocks strewn over the ground.
///
/// ```
/// use grouser_rover::ground::Rocks;
///
/// let rocks = Rocks { density: 0.5, size: 0.3 }.strew(1, (0.0, -2.0), (10.0, 2.0), 1.0);
/// assert!(rocks.iter().all(|[x, y, radius, _]| x.hypot(*y) > 1.0 && *radius <= 0.15));
/// let [x, y, _, height] = rocks[0];
/// assert!(Rocks::height(&rocks, x, y) >= height);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rocks {
    /// Per m².
    pub density: f64,
    /// Greatest diameter, m; the least is a quarter of it.
    pub size: f64,
}

/// Random values on a lattice, smooth between its nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    seed: u64,
}

impl Lattice {
    pub(crate) const fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Uniform in [0, 1) at a node, by the finaliser of splitmix64.
    pub(super) fn node(self, column: i64, row: i64) -> f64 {
        let mut z = self.seed
            ^ column.cast_unsigned().wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ row.cast_unsigned().wrapping_mul(0xD1B5_4A32_D192_ED03);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        (z >> 11) as f64 / 9_007_199_254_740_992.0
    }

    /// Smooth noise of mean 0 and standard deviation about 1 at (x, y) in units of the lattice.
    pub(crate) fn normal(self, x: f64, y: f64) -> f64 {
        self.along(y).normal(x)
    }

    /// The noise along x at one `y`.
    pub(crate) fn along(self, y: f64) -> LatticeLine {
        let row = y.floor();
        #[allow(clippy::cast_possible_truncation, reason = "maps end at 1e8 cells")]
        LatticeLine {
            lattice: self,
            row: row as i64,
            share: ease(y - row),
            column: f64::NAN,
            nodes: [[0.0; 2]; 2],
        }
    }
}

/// The noise of a [`Lattice`] along a line: nodes serve until the line leaves them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LatticeLine {
    lattice: Lattice,
    row: i64,
    /// Of the row above.
    share: f64,
    column: f64,
    /// Those of the column and of the next, in this row and in the one above.
    nodes: [[f64; 2]; 2],
}

impl LatticeLine {
    /// [`Lattice::normal`] at `x`.
    pub(crate) fn normal(&mut self, x: f64) -> f64 {
        let column = x.floor();
        if column != self.column {
            self.column = column;
            #[allow(clippy::cast_possible_truncation, reason = "maps end at 1e8 cells")]
            let column = column as i64;
            let node = |i: i64, j: i64| self.lattice.node(column + i, self.row + j);
            self.nodes = [[node(0, 0), node(1, 0)], [node(0, 1), node(1, 1)]];
        }
        let u = ease(x - column);
        let [low, high] = self.nodes.map(|[left, right]| left + u * (right - left));
        // a node's variance is 1/12; between the nodes it falls to (181/231)² = 0.614 of that on average
        (low + self.share * (high - low) - 0.5) * 4.42
    }
}

/// From 0 to 1 without a bend at either end.
fn ease(t: f64) -> f64 {
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

impl Shape {
    /// Height at (x, y), m.
    #[must_use]
    pub fn height(&self, seed: u64, x: f64, y: f64) -> f64 {
        self.along(seed, y)(x)
    }

    /// The heights along x at one `y`: what only depends on that is computed once.
    pub(crate) fn along(self, seed: u64, y: f64) -> Box<dyn FnMut(f64) -> f64> {
        let lattice = Lattice::new(seed);
        match self {
            Self::Flat => Box::new(|_| 0.0),
            Self::Slope { angle, from } => {
                let rise = Real::tan(angle);
                Box::new(move |x| rise * (x - from).max(0.0))
            }
            Self::Dunes { height, length } => {
                let wander = 0.25 * length * lattice.normal(y / (2.0 * length), 0.5);
                let (mut ridge, mut uneven) = (f64::NAN, 0.0);
                Box::new(move |x| {
                    let phase = (x + wander) / length;
                    if phase.floor() != ridge {
                        ridge = phase.floor();
                        let z = lattice.normal(ridge + 0.5, y / (3.0 * length));
                        uneven = 1.0 + 0.2 * z.clamp(-2.0, 2.0);
                    }
                    // the crest stands at 0.7 of the way: gentle before, steep behind
                    let t = phase - ridge;
                    let rise = if t < 0.7 { t / 0.7 } else { (1.0 - t) / 0.3 };
                    let smooth = rise * rise * (3.0 - 2.0 * rise);
                    // dunes begin after a level stretch
                    let begin = (x / length).clamp(0.0, 1.0);
                    height * uneven * smooth * begin * begin * (3.0 - 2.0 * begin)
                })
            }
            Self::Craters(craters) => Box::new(craters.along(seed, y)),
            Self::Fractal {
                height,
                length,
                roughness,
            } => {
                let (mut high, mut long) = (height, length);
                let mut octaves = [0, 1, 2, 3, 4, 5].map(|octave| {
                    let lattice = Lattice::new(seed.wrapping_add(octave));
                    let line = (high, long, lattice.along(y / long));
                    high *= roughness;
                    long *= 0.5;
                    line
                });
                Box::new(move |x| {
                    let heights = octaves.iter_mut();
                    heights.fold(0.0, |sum, (high, long, line)| {
                        sum + *high * line.normal(x / *long)
                    })
                })
            }
        }
    }
}

impl Rocks {
    /// The rocks of a rectangle: centre x, centre y, radius, height above the ground, all in m. None within
    /// `clear` of the origin.
    #[must_use]
    pub fn strew(&self, seed: u64, low: (f64, f64), high: (f64, f64), clear: f64) -> Vec<[f64; 4]> {
        let mut noise = Noise::new(seed, 77);
        let area = (high.0 - low.0) * (high.1 - low.1);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and at most 1e5"
        )]
        let count = (self.density * area).round().clamp(0.0, 1e5) as usize;
        let mut out = Vec::new();
        for _ in 0..count {
            let x = low.0 + (high.0 - low.0) * noise.uniform();
            let y = low.1 + (high.1 - low.1) * noise.uniform();
            // many small, few large
            let radius = 0.5 * self.size * (0.25 + 0.75 * noise.uniform() * noise.uniform());
            let height = radius * (0.4 + 0.6 * noise.uniform());
            if Real::hypot(x, y) > clear {
                out.push([x, y, radius, height]);
            }
        }
        out
    }

    /// Height that `rocks` add at (x, y), m: half ellipsoids.
    #[must_use]
    pub fn height(rocks: &[[f64; 4]], x: f64, y: f64) -> f64 {
        rocks
            .iter()
            .map(|[at_x, at_y, radius, height]| {
                let (d_x, d_y) = ((x - at_x) / radius, (y - at_y) / radius);
                height * (1.0 - d_x * d_x - d_y * d_y).max(0.0).sqrt()
            })
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lattice_has_unit_spread_and_depends_on_its_seed() {
        let lattice = Lattice::new(5);
        let (mut sum, mut square, mut count) = (0.0, 0.0, 0.0);
        for i in 0..300 {
            for j in 0..300 {
                let z = lattice.normal(f64::from(i) * 0.37, f64::from(j) * 0.41);
                sum += z;
                square += z * z;
                count += 1.0;
            }
        }
        // about 13 000 independent nodes lie in the square
        assert!((sum / count).abs() < 0.03, "{}", sum / count);
        assert!((square / count - 1.0).abs() < 0.1, "{}", square / count);
        assert_ne!(lattice.normal(0.3, 0.2), Lattice::new(6).normal(0.3, 0.2));
    }

    #[test]
    fn heights_along_a_line_are_those_of_its_points() {
        let (height, length) = (0.6, 1.7);
        let shapes = [
            Shape::Slope {
                angle: 0.2,
                from: 1.0,
            },
            Shape::Dunes { height, length },
            Shape::Fractal {
                height,
                length,
                roughness: 0.5,
            },
            Shape::Craters(Craters {
                density: Craters::EQUILIBRIUM_DENSITY,
                min_diameter: 0.5,
                max_diameter: 6.0,
            }),
        ];
        for shape in shapes {
            let mut line = shape.along(3, -0.83);
            // forwards over many nodes, and back and forth
            let mut different = 0;
            for step in 0..900_i32 {
                let x = 0.031 * f64::from(step - 300 * (step / 400) * (step % 3));
                let alone = shape.height(3, x, -0.83);
                assert_eq!(line(x).to_bits(), alone.to_bits(), "{shape:?} {x}");
                different += i32::from(alone != shape.height(3, x, 2.4));
            }
            assert!(matches!(shape, Shape::Slope { .. }) || different > 500);
        }
    }

    #[test]
    fn a_slope_rises_as_its_tangent() {
        let slope = Shape::Slope {
            angle: 15_f64.to_radians(),
            from: 2.0,
        };
        assert_eq!(slope.height(1, 1.0, 0.0), 0.0);
        assert!((slope.height(1, 5.0, 3.0) - 3.0 * 0.267_949_192_4).abs() < 1e-9);
    }
}
