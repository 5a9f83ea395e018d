//! Values and derivatives at points by closed forms, and where an operation is continuous and smooth.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole numbers as products of which the bits are counted"
)]

use grouser_real::Interval;

use super::{Binary, Curvatures, Enclosures, Node, Tape, Unary};

/// Values, gradients and lower triangles of Hessians, where they exist.
struct Found {
    value: Interval,
    gradient: Option<[Interval; 2]>,
    hessian: Option<[Interval; 3]>,
}

fn over(x: [Interval; 2], make: impl Fn(&mut Tape, Node, Node) -> Node) -> Found {
    let mut tape = Tape::new();
    let (a, b) = (tape.variable(0), tape.variable(1));
    let node = make(&mut tape, a, b);
    let nodes = tape.needed(node);
    let mut enclosures = Enclosures::default();
    enclosures.forward(&tape, &x, &nodes);
    let mut gradient = [Interval::ZERO; 2];
    let terms = [(node, 1.0)];
    let is_regular = enclosures.gradient(&tape, &nodes, &terms, &mut gradient);
    let mut curvatures = Curvatures::default();
    curvatures.forward(&tape, 2, &enclosures.values, &nodes);
    let mut hessian = [Interval::ZERO; 3];
    let is_smooth = curvatures.add_to(node, Interval::ONE, &mut hessian);
    Found {
        value: enclosures.values[node as usize],
        gradient: is_regular.then_some(gradient),
        hessian: is_smooth.then_some(hessian),
    }
}

/// An enclosure of a number, and of hardly more.
fn assert_near(found: Interval, expected: f64, what: &str) {
    // the slope of a sinc is enclosed by two sums of its series, a part in ten thousand apart at most
    let room = if what.starts_with("sinc") {
        1e-3
    } else {
        1e-12
    };
    let room = room * expected.abs().max(0.1);
    assert!(
        found.low() >= expected - room && found.high() <= expected + room,
        "{what}: {found:?} {expected}"
    );
}

fn assert_same(found: Interval, expected: Interval) {
    for (found, expected) in [
        (found.low(), expected.low()),
        (found.high(), expected.high()),
    ] {
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
}

fn assert_all(
    found: &Found,
    [value, by_x, by_y, xx, yx, yy]: [f64; 6],
    has_bend: bool,
    what: &str,
) {
    assert_near(found.value, value, what);
    let [gx, gy] = found.gradient.expect(what);
    assert_near(gx, by_x, what);
    assert_near(gy, by_y, what);
    assert_eq!(found.hessian.is_some(), has_bend, "{what}");
    if let Some([a, b, c]) = found.hessian {
        assert_near(a, xx, what);
        assert_near(b, yx, what);
        assert_near(c, yy, what);
    }
}

/// f(x y), by f, f′ and f″ at x y.
fn assert_of_product(
    [x, y]: [f64; 2],
    [f, first, second]: [f64; 3],
    what: &str,
    make: &dyn Fn(&mut Tape, Node) -> Node,
) {
    let found = over([x, y].map(Interval::point), |tape, a, b| {
        let product = tape.binary(Binary::Mul, a, b);
        make(tape, product)
    });
    let bends = [second * y * y, first + second * x * y, second * x * x];
    let expected = [f, first * y, first * x, bends[0], bends[1], bends[2]];
    assert_all(&found, expected, true, what);
}

#[test]
fn functions_of_one_number() {
    // below 0, within 1 and beyond it; products of the two are exact
    for (x, y) in [
        (0.5, 0.75),
        (-0.5, 0.75),
        (2.0, 1.5),
        (-2.0, 1.25),
        (8.0, 0.125),
    ] {
        let u: f64 = x * y;
        let root = (1.0 - u * u).sqrt();
        let inside = u.abs() < 1.0;
        for function in super::tests::UNARY {
            let expected = match function {
                Unary::Neg => [-u, -1.0, 0.0],
                Unary::Abs => [u.abs(), u.signum(), 0.0],
                Unary::Sqrt if u > 0.0 => [u.sqrt(), 0.5 / u.sqrt(), -0.25 / (u * u.sqrt())],
                Unary::Exp => [u.exp(); 3],
                Unary::ExpM1 => [u.exp_m1(), u.exp(), u.exp()],
                Unary::Ln if u > 0.0 => [u.ln(), 1.0 / u, -1.0 / (u * u)],
                Unary::Ln1p if u > -1.0 => {
                    let share = 1.0 / (1.0 + u);
                    [u.ln_1p(), share, -share * share]
                }
                Unary::Log10 if u > 0.0 => {
                    let e = std::f64::consts::LOG10_E;
                    [u.log10(), e / u, -e / (u * u)]
                }
                Unary::Sin => [u.sin(), u.cos(), -u.sin()],
                Unary::Cos => [u.cos(), -u.sin(), -u.cos()],
                Unary::Tan => {
                    let (tan, square) = (u.tan(), u.cos().powi(-2));
                    [tan, square, 2.0 * tan * square]
                }
                Unary::Asin if inside => [u.asin(), 1.0 / root, u / root.powi(3)],
                Unary::Acos if inside => [u.acos(), -1.0 / root, -u / root.powi(3)],
                Unary::Atan => {
                    let share = 1.0 / (1.0 + u * u);
                    [u.atan(), share, -2.0 * u * share * share]
                }
                Unary::Sinh => [u.sinh(), u.cosh(), u.sinh()],
                Unary::Cosh => [u.cosh(), u.sinh(), u.cosh()],
                Unary::Tanh => {
                    let square = u.cosh().powi(-2);
                    [u.tanh(), square, -2.0 * u.tanh() * square]
                }
                Unary::Sinc => {
                    let (sin, cos) = u.sin_cos();
                    let second = -sin / u - 2.0 * cos / (u * u) + 2.0 * sin / (u * u * u);
                    [sin / u, cos / u - sin / (u * u), second]
                }
                _ => continue,
            };
            let what = format!("{} {u}", function.name());
            assert_of_product([x, y], expected, &what, &|tape, node| {
                tape.unary(function, node)
            });
        }
        for n in [-3, -2, -1, 0, 1, 2, 3, 4] {
            let p = f64::from(n);
            let power = |k: i32| u.powi(n - k);
            let expected = [power(0), p * power(1), p * (p - 1.0) * power(2)];
            let what = format!("{u}^{n}");
            assert_of_product([x, y], expected, &what, &|tape, node| {
                tape.whole_power(node, n)
            });
        }
    }
}

#[test]
fn functions_of_two_numbers() {
    for (x, y) in [
        (0.5, 0.75),
        (2.0, 1.5),
        (-2.0, 1.25),
        (0.5, -1.5),
        (8.0, 0.125),
    ] {
        // of x y and x + y²
        let (u, v): (f64, f64) = (x * y, x + y * y);
        for function in super::tests::BINARY {
            // the value, and the derivatives by u, v, uu, uv and vv
            let (value, [fu, fv], [uu, uv, vv]) = match function {
                Binary::Add => (u + v, [1.0, 1.0], [0.0; 3]),
                Binary::Sub => (u - v, [1.0, -1.0], [0.0; 3]),
                Binary::Mul => (u * v, [v, u], [0.0, 1.0, 0.0]),
                Binary::Div => {
                    let bends = [0.0, -1.0 / (v * v), 2.0 * u / (v * v * v)];
                    (u / v, [1.0 / v, -u / (v * v)], bends)
                }
                Binary::Power if u > 0.0 => {
                    let (power, ln) = (u.powf(v), u.ln());
                    let bends = [
                        v * (v - 1.0) * power / (u * u),
                        power / u * (1.0 + v * ln),
                        power * ln * ln,
                    ];
                    (power, [v * power / u, power * ln], bends)
                }
                Binary::Power => continue,
                Binary::Min if u < v => (u, [1.0, 0.0], [0.0; 3]),
                Binary::Max if u > v => (u, [1.0, 0.0], [0.0; 3]),
                Binary::Min | Binary::Max => (v, [0.0, 1.0], [0.0; 3]),
                Binary::Atan2 => {
                    let square = u * u + v * v;
                    (u.atan2(v), [v / square, -u / square], [0.0; 3])
                }
            };
            let found = over([x, y].map(Interval::point), |tape, a, b| {
                let product = tape.binary(Binary::Mul, a, b);
                let square = tape.whole_power(b, 2);
                let sum = tape.binary(Binary::Add, a, square);
                tape.binary(function, product, sum)
            });
            let ([ux, uy], [vx, vy]) = ([y, x], [1.0, 2.0 * y]);
            let expected = [
                value,
                fu * ux + fv * vx,
                fu * uy + fv * vy,
                uu * ux * ux + 2.0 * uv * ux * vx + vv * vx * vx,
                fu + uu * ux * uy + uv * (ux * vy + uy * vx) + vv * vx * vy,
                2.0 * fv + uu * uy * uy + 2.0 * uv * uy * vy + vv * vy * vy,
            ];
            let what = format!("{} {u} {v}", function.name());
            assert_all(&found, expected, function != Binary::Atan2, &what);
        }
    }
}

/// Whether an operation is continuous over a box, and smooth: the ends of its domain.
#[test]
fn where_operations_are_continuous_and_smooth() {
    let unary = |function: Unary, low: f64, high: f64| {
        let found = over([Interval::new(low, high), Interval::ONE], |tape, x, _| {
            tape.unary(function, x)
        });
        (found.gradient.is_some(), found.hessian.is_some())
    };
    for (function, end) in [
        (Unary::Sqrt, 0.0),
        (Unary::Ln, 0.0),
        (Unary::Log10, 0.0),
        (Unary::Ln1p, -1.0),
    ] {
        assert_eq!(
            unary(function, end + 0.125, 4.0),
            (true, true),
            "{function:?}"
        );
        // √x is continuous at 0, without a slope
        let is_root = function == Unary::Sqrt;
        assert_eq!(unary(function, end, 4.0), (is_root, false), "{function:?}");
        assert_eq!(
            unary(function, end - 0.125, 4.0),
            (false, false),
            "{function:?}"
        );
    }
    for function in [Unary::Asin, Unary::Acos] {
        assert_eq!(unary(function, -0.875, 0.875), (true, true));
        assert_eq!(unary(function, -1.0, 0.0), (true, false));
        assert_eq!(unary(function, 0.0, 1.0), (true, false));
        assert_eq!(unary(function, 0.0, 1.125), (false, false));
        assert_eq!(unary(function, -1.125, 0.0), (false, false));
    }
    assert_eq!(unary(Unary::Tan, -1.5, 1.5), (true, true));
    assert_eq!(unary(Unary::Tan, 1.5, 1.625), (false, false));
    // |x| has a slope between −1 and 1 where x changes its sign, and no bend
    for (low, high, slope, is_smooth) in [
        (0.0, 1.0, Interval::ONE, true),
        (-1.0, 0.0, -Interval::ONE, true),
        (-1.0, 1.0, Interval::new(-1.0, 1.0), false),
    ] {
        let found = over([Interval::new(low, high), Interval::ONE], |tape, x, _| {
            tape.unary(Unary::Abs, x)
        });
        assert_same(found.gradient.unwrap()[0], slope);
        assert_eq!(found.hessian.is_some(), is_smooth);
    }
    for n in [-2, -1, 0, 1, 2] {
        let found = over([Interval::new(-1.0, 1.0), Interval::ONE], |tape, x, _| {
            tape.whole_power(x, n)
        });
        let is_defined = n >= 0;
        assert_eq!(
            (found.gradient.is_some(), found.hessian.is_some()),
            (is_defined, is_defined)
        );
        let found = over([Interval::new(0.5, 1.0), Interval::ONE], |tape, x, _| {
            tape.whole_power(x, n)
        });
        assert!(found.gradient.is_some() && found.hessian.is_some());
    }
}

#[test]
fn where_operations_on_two_are_continuous_and_smooth() {
    let binary = |function: Binary, a: (f64, f64), b: (f64, f64)| {
        let x = [Interval::new(a.0, a.1), Interval::new(b.0, b.1)];
        over(x, |tape, x, y| tape.binary(function, x, y))
    };
    let kinds = |found: &Found| (found.gradient.is_some(), found.hessian.is_some());
    let unit = (0.5, 1.0);
    assert_eq!(
        kinds(&binary(Binary::Div, unit, (-1.0, 1.0))),
        (false, false)
    );
    assert_eq!(
        kinds(&binary(Binary::Div, unit, (-1.0, -0.5))),
        (true, true)
    );
    // 0 to a power that is positive, or may not be
    assert_eq!(
        kinds(&binary(Binary::Power, unit, (-1.0, 1.0))),
        (true, true)
    );
    assert_eq!(
        kinds(&binary(Binary::Power, (0.0, 1.0), unit)),
        (true, false)
    );
    assert_eq!(
        kinds(&binary(Binary::Power, (0.0, 1.0), (0.0, 1.0))),
        (false, false)
    );
    assert_eq!(
        kinds(&binary(Binary::Power, (-0.5, 1.0), unit)),
        (false, false)
    );
    assert_eq!(
        kinds(&binary(Binary::Atan2, (-1.0, 1.0), unit)),
        (true, false)
    );
    assert_eq!(
        kinds(&binary(Binary::Atan2, (-1.0, 1.0), (-1.0, -0.5))),
        (false, false)
    );
    // the less, the greater, and neither
    let (one, zero, either) = (Interval::ONE, Interval::ZERO, Interval::new(0.0, 1.0));
    for (a, b, min, is_smooth) in [
        ((0.0, 1.0), (2.0, 3.0), [one, zero], true),
        ((2.0, 3.0), (0.0, 1.0), [zero, one], true),
        ((0.0, 2.0), (1.0, 3.0), [either; 2], false),
        ((1.0, 3.0), (0.0, 2.0), [either; 2], false),
        ((0.0, 1.0), (1.0, 2.0), [either; 2], false),
        ((1.0, 2.0), (0.0, 1.0), [either; 2], false),
    ] {
        let [by_a, by_b] = min;
        for (function, expected) in [(Binary::Min, min), (Binary::Max, [by_b, by_a])] {
            let found = binary(function, a, b);
            assert_eq!(found.hessian.is_some(), is_smooth);
            for (found, expected) in found.gradient.unwrap().into_iter().zip(expected) {
                assert_same(found, expected);
            }
        }
    }
}

/// By hand: ∂xʸ/∂y = xʸ ln x over x from 0 on has its least value −1/(e y), and at x = 1 it is 0.
#[test]
fn the_slope_of_a_power_by_its_exponent() {
    let slope = |low: f64, high: f64, y: f64| {
        let x = [Interval::new(low, high), Interval::point(y)];
        over(x, |tape, x, y| tape.binary(Binary::Power, x, y))
            .gradient
            .unwrap()[1]
    };
    let least = |y: f64| -1.0 / (std::f64::consts::E * y);
    let of = slope(0.0, 0.5, 2.0);
    assert_near(Interval::point(of.low()), least(2.0), "least");
    assert!(of.high().abs() < 1e-300);
    assert!(slope(0.0, 1.0, 0.5).high().abs() < 1e-300);
    // up to 2² ln 2
    let of = slope(0.0, 2.0, 2.0);
    assert_near(Interval::point(of.low()), least(2.0), "least");
    assert_near(
        Interval::point(of.high()),
        4.0 * std::f64::consts::LN_2,
        "greatest",
    );
}

/// A multiple that is exact is one number; of one that is not the enclosure is as wide as its rounding.
#[test]
fn shares_are_exact_where_their_products_are() {
    let slope = |factors: &[f64]| {
        let found = over([Interval::ONE; 2], |tape, x, _| {
            factors.iter().fold(x, |node, &factor| {
                let factor = tape.constant(factor);
                tape.binary(Binary::Mul, factor, node)
            })
        });
        found.gradient.unwrap()[0]
    };
    assert_eq!(slope(&[0.5, 3.0, -0.25]), Interval::point(-0.375));
    // 53 bits are just enough: (2²⁷ + 1)(2²⁵ + 1) and (2²⁷ + 1)²
    let (a, b) = (134_217_729.0, 33_554_433.0);
    assert_eq!(slope(&[a, b]), Interval::point(a * b));
    assert!(slope(&[a, a]).width() > 0.0);
    assert!(slope(&[0.1, 0.1]).width() > 0.0);
    assert!(slope(&[1.0 + f64::EPSILON, 1.0 - f64::EPSILON]).width() > 0.0);
    // too small or great to tell
    assert!(slope(&[2e-141, 1.0]).width() > 0.0 && slope(&[2e-139, 1.0]).width() == 0.0);
    assert!(slope(&[1e141, 1.0]).width() > 0.0 && slope(&[0.5e140, 1.0]).width() == 0.0);
}

/// Of random numbers with few and many bits a multiple is one number just where the product of their whole parts is exact.
#[test]
fn multiples_are_exact_where_whole_numbers_are() {
    let mut random = crate::random::Random::new(2012);
    let (mut exact, mut rounded) = (0, 0);
    for _ in 0..2000 {
        let mut whole = || {
            // with low bits of 0
            let size = (1_u64 << (15 + random.below(25))) as f64;
            let zeros = (1_u64 << random.below(12)) as f64;
            ((random.uniform() * size).floor() + 1.0) * zeros
        };
        let (a, b) = (whole(), whole());
        let product = a as u128 * b as u128;
        let is_exact = (a * b) as u128 == product;
        for a in [a, -a] {
            let found = over([Interval::ONE; 2], |tape, x, _| {
                let (a, b) = (tape.constant(a), tape.constant(b));
                let multiple = tape.binary(Binary::Mul, a, x);
                tape.binary(Binary::Mul, multiple, b)
            });
            let slope = found.gradient.unwrap()[0];
            assert_eq!(slope.width() == 0.0, is_exact, "{a} {b} {slope:?}");
            assert!(slope.contains(a * b));
        }
        exact += usize::from(is_exact);
        rounded += usize::from(!is_exact);
    }
    assert!(exact > 500 && rounded > 500, "{exact} {rounded}");
}

/// The powers 0, 1 and 2 are smooth at 0 too.
#[test]
fn small_powers_at_0() {
    for (n, slope, bend) in [(0, 0.0, 0.0), (1, 1.0, 0.0), (2, 0.0, 2.0)] {
        for x in [Interval::ZERO, Interval::new(-1.0, 0.0)] {
            let found = over([x, Interval::ONE], |tape, x, _| tape.whole_power(x, n));
            let [bent, ..] = found.hessian.unwrap();
            assert!((bent.middle() - bend).abs() < 1e-15);
            if x == Interval::ZERO {
                assert!((found.gradient.unwrap()[0].middle() - slope).abs() < 1e-15);
            }
        }
    }
}

/// The same memory for two tapes: nothing of the first is left in the second.
#[test]
fn curvatures_forget_other_tapes() {
    let x = [Interval::point(0.5), Interval::point(0.75)];
    let mut curvatures = Curvatures::default();
    let mut hessian = |make: &dyn Fn(&mut Tape) -> Node| {
        let mut tape = Tape::new();
        let node = make(&mut tape);
        let nodes = tape.needed(node);
        let mut enclosures = Enclosures::default();
        enclosures.forward(&tape, &x, &nodes);
        curvatures.forward(&tape, 2, &enclosures.values, &nodes);
        let mut sum = [Interval::ZERO; 3];
        assert!(curvatures.add_to(node, Interval::ONE, &mut sum));
        sum.map(Interval::middle)
    };
    let squares = hessian(&|tape: &mut Tape| {
        let (x, y) = (tape.variable(0), tape.variable(1));
        let (a, b) = (tape.whole_power(x, 2), tape.whole_power(y, 2));
        let (a, b) = (tape.whole_power(a, 2), tape.whole_power(b, 2));
        tape.binary(Binary::Add, a, b)
    });
    for (found, expected) in squares.into_iter().zip([12.0 * 0.25, 0.0, 12.0 * 0.5625]) {
        assert!((found - expected).abs() < 1e-14);
    }
    let line = hessian(&|tape: &mut Tape| {
        let one = tape.constant(1.0);
        let nodes: Vec<Node> = [0, 1, 0, 1, 1, 0]
            .iter()
            .map(|index| tape.variable(*index))
            .collect();
        let more = tape.constant(2.0);
        let three = tape.constant(3.0);
        let sum = nodes
            .iter()
            .fold(one, |a, b| tape.binary(Binary::Add, a, *b));
        let sum = tape.binary(Binary::Mul, sum, more);
        tape.binary(Binary::Add, sum, three)
    });
    assert_eq!(line, [0.0; 3]);
}
