//! A proved bound of what the rule of integration of a contact leaves out, over a box of contacts.
//!
//! Over a piece of the contact each integrand is tⁿ G(t) or G(t), where t in [0, 1] is the share of its arc from the end
//! without stress and G is analytic. About the middle G is its Taylor polynomial in τ = t − ½ with enclosed
//! coefficients a_k, and Lagrange's remainder. The rule is linear in its integrand, so that its error is Σ a_k E_k with
//! the errors E_k of tⁿ τᵏ, which have closed forms. Signs are kept: what cancels in the error of a contact cancels in
//! its enclosure too, up to the width of the box.

use grouser_real::Interval;

/// Terms of a Taylor polynomial.
const ORDER: usize = 32;
/// Terms in the exponent n, and half the widest range of n that they serve.
const EXPONENT_ORDER: usize = 14;
const MAX_EXPONENT_REACH: f64 = 0.06;

/// The integrands of a piece; the first of them have the factor tⁿ.
const INTEGRANDS: usize = 8;
const WITH_STRESS: usize = 5;

/// Coefficients of τ⁰ and up.
type Series<const N: usize> = [Interval; N];
/// Those of a Taylor polynomial, and its remainder's over all of [0, 1].
type Enclosed = Series<{ ORDER + 1 }>;

/// What the error of the rule depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactShape<T> {
    /// The entry angle θ_1, rad.
    pub(crate) theta_1: T,
    /// θ_m/θ_1.
    pub(crate) position: T,
    /// 1 − s.
    pub(crate) q: T,
    /// r/K.
    pub(crate) stiffness: T,
    /// The exponent of the pressure.
    pub(crate) n: T,
    /// The pressure at a depth of r.
    pub(crate) amplitude: T,
    /// r b.
    pub(crate) area: T,
}

impl<T> ContactShape<T> {
    /// The same contact in other numbers.
    pub(crate) fn map<U>(self, f: impl Fn(T) -> U) -> ContactShape<U> {
        ContactShape {
            theta_1: f(self.theta_1),
            position: f(self.position),
            q: f(self.q),
            stiffness: f(self.stiffness),
            n: f(self.n),
            amplitude: f(self.amplitude),
            area: f(self.area),
        }
    }
}

/// What is proved about the rule for contacts of some shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RuleBound {
    /// What it leaves out of any integral at most, as a share of what it finds; ∞ where nothing is proved.
    pub(crate) share: f64,
    /// What the pressure alone carries at least, N.
    pub(crate) carried: f64,
}

/// What the rule leaves out of the integrals of tⁿ τᵏ over [0, 1], for k up to the order.
struct Moments {
    error: Enclosed,
}

fn number(x: usize) -> Interval {
    Interval::point(x as f64)
}

fn half() -> Interval {
    Interval::point(0.5)
}

/// ±x
fn within(x: f64) -> Interval {
    Interval::new(-x, x)
}

impl Moments {
    /// By a Taylor series about the middle of `n`, whose derivatives are the functionals of tⁿ τᵏ lnⁱ t.
    fn new(rule: &[(f64, f64)], n: Interval) -> Self {
        let middle = Interval::point(n.middle());
        let step = n - middle;
        let terms = if n.width() == 0.0 { 1 } else { EXPONENT_ORDER };
        let nodes: Vec<_> = rule
            .iter()
            .map(|(t, weight)| {
                let at = Interval::point(*t);
                let stress = Interval::point(*weight) * at.powf(middle);
                (at - half(), at.ln(), stress)
            })
            .collect();
        let mut error = [Interval::ZERO; ORDER + 1];
        // stepⁱ/i!, and i! (−1)ⁱ
        let (mut scale, mut factorial) = (Interval::ONE, Interval::ONE);
        for i in 0..terms {
            for (k, error) in error.iter_mut().enumerate() {
                let exact = factorial * whole_integral(middle, k, i);
                let sum = nodes.iter().fold(Interval::ZERO, |sum, (tau, ln, stress)| {
                    sum + *stress * tau.powi(exponent(k)) * ln.powi(exponent(i))
                });
                *error += scale * (exact - sum);
            }
            scale *= step / number(i + 1);
            factorial *= -number(i + 1);
        }
        if terms > 1 {
            // |tⁿ − its Taylor polynomial| ≤ |step ln t|ⁱ/i! t^(least n); |τ| ≤ 1/2
            let low = Interval::point(n.low());
            let sum = rule.iter().fold(Interval::ZERO, |sum, (t, weight)| {
                let at = Interval::point(*t);
                let size = Interval::point(at.ln().magnitude()).powi(exponent(terms));
                sum + Interval::point(*weight) * at.powf(low) * size
            });
            let area = factorial.abs() / (low + Interval::ONE).powi(exponent(terms + 1));
            let size = Interval::point(scale.magnitude());
            for (k, error) in error.iter_mut().enumerate() {
                let small = half().powi(exponent(k));
                *error += within((size * (area + sum) * small).high());
            }
        }
        Self { error }
    }

    /// What the rule leaves out of the integral of tⁿ G at most.
    fn error_of(&self, g: &Enclosed) -> f64 {
        let terms = g.iter().zip(&self.error).take(ORDER);
        let error = terms.fold(Interval::ZERO, |sum, (a, b)| sum + *a * *b);
        // the remainder a_K(t) τᴷ has either sign: the rule's weights are positive, and sum to 1 nearly
        let tail = g[ORDER].magnitude() * half().powi(exponent(ORDER)).high() * 2.1;
        (error + within(tail)).magnitude()
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "an order is small"
)]
fn exponent(k: usize) -> i32 {
    k as i32
}

/// (−1)ⁱ/i! ∫ tⁿ (t − ½)ᵏ lnⁱ t dt over [0, 1] = Σ_j C(k, j) (−½)^(k−j)/(n + j + 1)^(i+1).
fn whole_integral(n: Interval, k: usize, i: usize) -> Interval {
    let mut sum = Interval::ZERO;
    let mut factor = (-half()).powi(exponent(k));
    for j in 0..=k {
        sum += factor / (n + number(j + 1)).powi(exponent(i + 1));
        factor *= -number(2 * (k - j)) / number(j + 1);
    }
    sum
}

fn product<const N: usize>(a: &Series<N>, b: &Series<N>) -> Series<N> {
    std::array::from_fn(|k| (0..=k).fold(Interval::ZERO, |sum, i| sum + a[i] * b[k - i]))
}

/// sin and cos of `angle` + `slope` τ.
fn waves<const N: usize>(angle: Interval, slope: Interval) -> (Series<N>, Series<N>) {
    let (sin, cos) = (angle.sin(), angle.cos());
    let turn = [sin, cos, -sin, -cos];
    let mut scale = Interval::ONE;
    let (mut sines, mut cosines) = ([Interval::ZERO; N], [Interval::ZERO; N]);
    for k in 0..N {
        sines[k] = scale * turn[k % 4];
        cosines[k] = scale * turn[(k + 1) % 4];
        scale *= slope / number(k + 1);
    }
    (sines, cosines)
}

/// sin x/x of x = `angle` + `slope` τ: the derivative of order k is ∫ yᵏ cos^(k)(x y) dy over [0, 1], at most 1/(k + 1).
fn sinc<const N: usize>(angle: Interval, slope: Interval) -> Series<N> {
    let mut scale = Interval::ONE;
    std::array::from_fn(|k| {
        let own = match k {
            0 => angle.sinc(),
            1 => angle.sinc_slope(),
            2 => angle.sinc_curvature(),
            _ => within((Interval::ONE / number(k + 1)).high()),
        };
        let coefficient = scale * own;
        scale *= slope / number(k + 1);
        coefficient
    })
}

/// exp of a series.
fn exponential<const N: usize>(x: &Series<N>) -> Series<N> {
    let mut e = [Interval::ZERO; N];
    e[0] = x[0].exp();
    for k in 1..N {
        let sum = (1..=k).fold(Interval::ZERO, |sum, i| sum + number(i) * x[i] * e[k - i]);
        e[k] = sum / number(k);
    }
    e
}

/// dⁿ of a positive series.
fn power<const N: usize>(d: &Series<N>, n: Interval) -> Series<N> {
    let mut p = [Interval::ZERO; N];
    p[0] = d[0].powf(n);
    for k in 1..N {
        let sum = (1..=k).fold(Interval::ZERO, |sum, i| {
            sum + (n * number(i) - number(k - i)) * d[i] * p[k - i]
        });
        p[k] = sum / (number(k) * d[0]);
    }
    p
}

/// a + b τ.
fn line<const N: usize>(a: Interval, b: Interval) -> Series<N> {
    std::array::from_fn(|k| [a, b].get(k).copied().unwrap_or(Interval::ZERO))
}

/// ln(high/low) of a positive range; ∞ for others.
pub(crate) fn log_width(x: Interval) -> f64 {
    if x.low() > 0.0 {
        (x.ln().high() - x.ln().low()).max(0.0)
    } else {
        f64::INFINITY
    }
}

impl ContactShape<Interval> {
    /// How far the shape varies, as a sum of logarithms: what decides about its bound.
    pub(crate) fn spread(&self) -> f64 {
        let (sin, least) = ((half() * self.theta_1).sin(), Interval::point(1e-6));
        // 1 − q cos θ_1/2, which decides about the displacement at small slips
        let slid = Interval::ONE - self.q + self.q * sin.square() * half() + least;
        let all = [self.theta_1, slid, self.stiffness];
        all.map(log_width).iter().sum::<f64>() + self.position.width() + 2.0 * self.n.width()
    }

    /// What σ/tⁿ, cos θ, sin θ and the mobilised share are about `t`, up to positive factors that do not depend on t:
    /// the integrands with tⁿ, and those without.
    fn integrands<const N: usize>(&self, is_front: bool, t: Interval) -> [Series<N>; INTEGRANDS] {
        let Self {
            theta_1,
            position,
            q,
            stiffness,
            n,
            ..
        } = *self;
        let rest = Interval::ONE - position;
        // the depth over r t: sin(θ_1 − x) sin(x)/t with x = θ_1 rest t/2
        let slope = half() * theta_1 * rest;
        let x = slope * t;
        let left = Interval::ONE - half() * rest * t;
        // each factor has a power of its own: their product over all of [0, 1] would be too wide a divisor
        let upper = power(&sinc(theta_1 * left, -slope), n);
        let upper = product(&power(&line(left, -(half() * rest)), n), &upper);
        let stress = product(&upper, &power(&sinc(x, slope), n));
        // θ, and sin θ: behind the axle's front over θ_m, where it vanishes with t
        let (share, turn) = if is_front {
            (Interval::ONE - t * rest, -(theta_1 * rest))
        } else {
            (t * position, theta_1 * position)
        };
        let theta = theta_1 * share;
        let (sines, cosines) = waves(theta, turn);
        let sine = if is_front {
            sines
        } else {
            product(&line(t, Interval::ONE), &sinc(theta, turn))
        };
        // j/r = (θ_1 − θ) (1 − q cos((θ_1 + θ)/2) sinc((θ_1 − θ)/2)) = θ_1 − θ − q (sin θ_1 − sin θ)
        let arc = theta_1 * (Interval::ONE - share);
        let middle = half() * theta_1 * (Interval::ONE + share);
        let chord = q * middle.cos() * (half() * arc).sinc();
        let falling: Series<N> = std::array::from_fn(|k| match k {
            0 => -(stiffness * arc * (Interval::ONE - chord)),
            1 => stiffness * turn * (Interval::ONE - q * cosines[0]),
            _ => -(stiffness * q * sines[k]),
        });
        let lacking = exponential(&falling);
        let mut mobilised: Series<N> = std::array::from_fn(|k| -lacking[k]);
        mobilised[0] = -falling[0].exp_m1();
        let friction = product(&stress, &mobilised);
        [
            product(&stress, &cosines),
            product(&stress, &sine),
            product(&friction, &cosines),
            product(&friction, &sine),
            friction,
            product(&mobilised, &cosines),
            product(&mobilised, &sine),
            mobilised,
        ]
    }
}

/// The errors of a rule, for contacts of changing shape.
pub(crate) struct RuleError<'r> {
    rule: &'r [(f64, f64)],
    plain: Moments,
    /// The last range of n with its moments.
    known: Option<(Interval, Moments)>,
}

impl<'r> RuleError<'r> {
    pub(crate) fn new(rule: &'r [(f64, f64)]) -> Self {
        Self {
            rule,
            plain: Moments::new(rule, Interval::ZERO),
            known: None,
        }
    }

    /// Bounds over all contacts of a shape. Every integrand is positive, so that the share of a sum is at most that of its
    /// parts.
    pub(crate) fn bound(&mut self, shape: &ContactShape<Interval>) -> RuleBound {
        let mut bound = RuleBound {
            share: f64::INFINITY,
            carried: 0.0,
        };
        if !(shape.n.width() <= 2.0 * MAX_EXPONENT_REACH && shape.n.low() > 0.0) {
            return bound;
        }
        if self.known.as_ref().is_none_or(|(n, _)| *n != shape.n) {
            self.known = Some((shape.n, Moments::new(self.rule, shape.n)));
        }
        let Some((_, moments)) = &self.known else {
            return bound;
        };
        let rest = Interval::ONE - shape.position;
        // the pressure is A (θ_1² rest)ⁿ times the integrand
        let pressure = shape.amplitude * (shape.theta_1.square() * rest).powf(shape.n);
        let scale = shape.area * shape.theta_1 * pressure;
        bound.share = 0.0;
        for is_front in [true, false] {
            let found = self.found(shape, is_front);
            let mut series: [Enclosed; INTEGRANDS] = shape.integrands(is_front, half());
            let over: [Enclosed; INTEGRANDS] = shape.integrands(is_front, Interval::new(0.0, 1.0));
            for (index, (g, over)) in series.iter_mut().zip(over).enumerate() {
                g[ORDER] = over[ORDER];
                let moments = if index < WITH_STRESS {
                    moments
                } else {
                    &self.plain
                };
                let error = Interval::point(moments.error_of(g));
                let found = Interval::point(found[index]);
                let share = if found.low() > 0.0 && error.is_bounded() {
                    (error / found).high()
                } else {
                    f64::INFINITY
                };
                bound.share = bound.share.max(share);
                if index == 0 && share < 1.0 {
                    let length = if is_front { rest } else { shape.position };
                    let part = (scale * length * (found - error)).low();
                    bound.carried =
                        (Interval::point(bound.carried) + Interval::point(part.max(0.0))).low();
                }
            }
        }
        bound
    }

    /// The least that the rule finds of each integral.
    fn found(&self, shape: &ContactShape<Interval>, is_front: bool) -> [f64; INTEGRANDS] {
        let mut sums = [Interval::ZERO; INTEGRANDS];
        for (t, weight) in self.rule {
            let (at, weight) = (Interval::point(*t), Interval::point(*weight));
            let values: [Series<1>; INTEGRANDS] = shape.integrands(is_front, at);
            let stress = at.powf(shape.n);
            for (index, (sum, [value])) in sums.iter_mut().zip(values).enumerate() {
                let factor = if index < WITH_STRESS {
                    stress
                } else {
                    Interval::ONE
                };
                *sum += weight * factor * value;
            }
        }
        sums.map(Interval::low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::rule;

    /// The error of the rule against a composite rule of 600 nodes, over random contacts and boxes about them.
    #[test]
    fn the_error_of_the_rule_is_within_its_bound() {
        let fine: Vec<(f64, f64)> = (0..40)
            .flat_map(|panel| {
                // panels that shrink towards t = 0 like its cube
                let edge = |i: i32| (f64::from(i) / 40.0).powi(4);
                let (a, b) = (edge(panel), edge(panel + 1));
                rule().into_iter().map(move |(t, w)| {
                    // the rule is for [0, 1] in v with t = v^3: undo the substitution
                    let v = t.cbrt();
                    (a + (b - a) * v, (b - a) * w / (3.0 * v * v))
                })
            })
            .collect();
        let mut state = 7_u64;
        let mut within = |low: f64, high: f64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let rule = rule();
        let (mut tightest, mut worst, mut bounded) = (0.0_f64, 0.0_f64, 0);
        for case in 0..400 {
            let mut errors = RuleError::new(&rule);
            let width = [0.0, 1e-3, 1e-2, 0.05][case % 4];
            let mut side = |low: f64, high: f64| {
                let x = within(low, high);
                Interval::new(x * (1.0 - width), x * (1.0 + width))
            };
            let shape = ContactShape {
                theta_1: side(0.05, 1.4),
                position: side(0.05, 0.9),
                q: side(0.1, 0.95),
                stiffness: side(0.5, 15.0),
                n: side(0.4, 1.4),
                amplitude: Interval::ONE,
                area: Interval::ONE,
            };
            let share = errors.bound(&shape).share;
            if share.is_infinite() {
                continue;
            }
            bounded += 1;
            let pick = |x: Interval| Interval::point(x.low() + 0.3 * (x.high() - x.low()));
            let one = shape.map(pick);
            let sum = |rule: &[(f64, f64)], is_front: bool, index: usize| -> f64 {
                let term = |(t, w): &(f64, f64)| {
                    let [value] = one.integrands::<1>(is_front, Interval::point(*t))[index];
                    let stress = if index < WITH_STRESS {
                        t.powf(one.n.low())
                    } else {
                        1.0
                    };
                    w * stress * value.middle()
                };
                rule.iter().map(term).sum()
            };
            for is_front in [true, false] {
                for index in 0..INTEGRANDS {
                    let (own, exact) = (sum(&rule, is_front, index), sum(&fine, is_front, index));
                    let off = (own - exact).abs() / own;
                    assert!(
                        off <= share + 1e-13,
                        "{off:e} > {share:e}: {is_front} {index} {shape:?}"
                    );
                    worst = worst.max(off);
                    if width == 0.0 && share > 1e-11 {
                        tightest = tightest.max(off / share);
                    }
                }
            }
        }
        println!("{bounded} contacts, the worst off by {worst:e}, at best {tightest} of the bound");
        assert!(bounded > 300 && tightest > 0.9 && worst > 1e-9);
    }
}
