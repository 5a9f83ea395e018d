#![allow(
    clippy::cast_possible_truncation,
    reason = "numbers that are whole and small by construction"
)]

use super::Interval;
use crate::Real;

/// Numbers in [0, 1) from a seed (SplitMix64).
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn within(&mut self, low: f64, high: f64) -> f64 {
        (low + (high - low) * self.next()).clamp(low, high)
    }
}

/// What the tests of enclosures rest on.
#[test]
fn ends_belong_to_an_interval_and_their_neighbours_do_not() {
    let mut stream = Stream(2);
    for _ in 0..1000 {
        let (a, b) = (stream.within(-5.0, 5.0), stream.within(-5.0, 5.0));
        let (low, high) = (a.min(b), a.max(b));
        let x = Interval::new(low, high);
        assert!(x.contains(low) && x.contains(high) && x.contains(x.middle()));
        assert!(!x.contains(low.next_down()) && !x.contains(high.next_up()));
        assert!(!x.contains(f64::NAN) && !Interval::EMPTY.contains(low));
        for (inner, outer, expected) in [
            (x, x, true),
            (Interval::EMPTY, x, true),
            (x, Interval::EMPTY, false),
            (Interval::new(low.next_down(), high), x, false),
            (Interval::new(low, high.next_up()), x, false),
            (x, Interval::new(low.next_down(), high.next_up()), true),
        ] {
            assert_eq!(inner.is_inside(outer), expected, "{inner:?} {outer:?}");
        }
        assert!(x.width() > high - low && x.width() <= (high - low).next_up());
        assert!((x.middle() - 0.5 * (low + high)).abs() <= 1e-15 * x.magnitude());
        assert!(x.is_bounded() && Interval::point(low).width() == 0.0);
    }
    let (below, above) = (
        Interval::new(f64::NEG_INFINITY, 1.0),
        Interval::new(1.0, f64::INFINITY),
    );
    for unbounded in [below, above, Interval::ENTIRE, Interval::EMPTY] {
        assert!(!unbounded.is_bounded());
    }
    assert_eq!((below.middle(), above.middle()), (0.0, 1.0));
    assert_eq!(Interval::ENTIRE.middle(), 0.0);
    assert_eq!(Interval::new(f64::MAX, f64::INFINITY).middle(), f64::MAX);
    assert!(below.intersection(Interval::EMPTY).is_empty());
    assert!(Interval::EMPTY.intersection(below).is_empty());
    assert_eq!(below.intersection(above), Interval::point(1.0));
}

/// Sums and products of numbers with few digits, in whole numbers of 2⁻⁶⁰ and without rounding.
#[test]
fn sums_and_products_enclose_exact_ones_as_narrowly_as_can_be() {
    let whole = |x: f64, scale: i32| {
        let scaled = x * f64::powi(2.0, scale);
        assert!(scaled.fract() == 0.0 && scaled.abs() < 1e38, "{x:e}");
        scaled as i128
    };
    let mut stream = Stream(7);
    let mut rounded = [0, 0];
    for _ in 0..20_000 {
        // up to 2⁵³ steps of 2⁻⁶⁰ to 2⁻²⁰, so that most sums have more than 53 digits
        let mut number = || {
            let digits = ((stream.next() - 0.5) * f64::powi(2.0, 54)).round();
            digits * f64::powi(2.0, -20 - (40.0 * stream.next()) as i32)
        };
        let (a, b) = (number(), number());
        let exact = whole(a, 60) + whole(b, 60);
        for sum in [
            Interval::point(a) + Interval::point(b),
            Interval::point(a) - Interval::point(-b),
        ] {
            let (low, high) = (whole(sum.low(), 60), whole(sum.high(), 60));
            assert!(low <= exact && exact <= high, "{a:e} + {b:e}: {sum:?}");
            if low == exact || high == exact {
                assert_eq!(low, high, "{a:e} + {b:e} is a number: {sum:?}");
            } else {
                assert_eq!(sum.high(), sum.low().next_up());
                rounded[usize::from(a + b == sum.low())] += 1;
            }
        }
        // in [1, 2), in whole numbers of 2⁻⁵²
        let mut factor = || (stream.next() + 1.0) * if stream.next() < 0.5 { -1.0 } else { 1.0 };
        let (a, b) = (factor(), factor());
        let (i, j) = (whole(a, 60) >> 8, whole(b, 60) >> 8);
        let product = Interval::point(a) * Interval::point(b);
        let (low, high) = (whole(product.low(), 104), whole(product.high(), 104));
        assert!(low < i * j && i * j < high, "{a:e} × {b:e}: {product:?}");
        assert!(product.width() <= 2.0 * f64::EPSILON * product.magnitude() * 1.001);
        // a quotient's ends times the divisor are on both sides of the dividend
        let quotient = Interval::point(a) / Interval::point(b);
        let times = |x: f64| whole(x, 54) * (j << 2) - (i << 56);
        assert!(times(quotient.low()).signum() != times(quotient.high()).signum());
        assert!(quotient.width() <= 2.0 * f64::EPSILON * quotient.magnitude() * 1.001);
    }
    assert!(rounded[0] > 1000 && rounded[1] > 1000, "{rounded:?}");
}

type Operation = fn(Interval, Interval) -> Interval;

type Pair = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64);

const FUNCTIONS: [Pair; 23] = [
    ("exp", Interval::exp, Real::exp),
    ("exp_m1", Interval::exp_m1, Real::exp_m1),
    ("ln", Interval::ln, Real::ln),
    ("ln_1p", Interval::ln_1p, Real::ln_1p),
    ("log10", Interval::log10, f64::log10),
    ("sqrt", Interval::sqrt, Real::sqrt),
    ("abs", Interval::abs, Real::abs),
    ("sin", Interval::sin, Real::sin),
    ("cos", Interval::cos, Real::cos),
    ("tan", Interval::tan, Real::tan),
    ("asin", Interval::asin, Real::asin),
    ("acos", Interval::acos, Real::acos),
    ("atan", Interval::atan, Real::atan),
    ("sinh", Interval::sinh, Real::sinh),
    ("cosh", Interval::cosh, Real::cosh),
    ("tanh", Interval::tanh, Real::tanh),
    ("sinc", Interval::sinc, |x| {
        if x == 0.0 { 1.0 } else { x.sin() / x }
    }),
    ("sinc'", Interval::sinc_slope, |x| {
        if x.abs() < 0.3 {
            f64::NAN
        } else {
            (x.cos() - x.sin() / x) / x
        }
    }),
    ("sinc\"", Interval::sinc_curvature, |x| {
        if x.abs() < 0.3 {
            f64::NAN
        } else {
            -x.sin() / x - 2.0 * (x.cos() - x.sin() / x) / (x * x)
        }
    }),
    ("square", Interval::square, Real::square),
    ("cube", |x| x.powi(3), |x| x * x * x),
    ("powi -2", |x| x.powi(-2), |x| 1.0 / (x * x)),
    (
        "powf",
        |x| x.powf(Interval::point(1.3)),
        |x| Real::powf(x, 1.3),
    ),
];

#[test]
fn functions_enclose_their_values_over_intervals_of_all_sizes() {
    let mut stream = Stream(3);
    for (name, over, at) in FUNCTIONS {
        for _ in 0..20_000 {
            let centre = 10.0 * (stream.next() - 0.5) * 10.0_f64.powf(2.0 * stream.next() - 1.0);
            let radius = 10.0_f64.powf(3.0 * stream.next() - 2.5) * stream.next();
            let box_ = Interval::new(centre - radius, centre + radius);
            let enclosure = over(box_);
            for _ in 0..4 {
                let x = stream.within(box_.low(), box_.high());
                let value = at(x);
                // outside its domain a function has no value to enclose
                if !value.is_nan() {
                    assert!(
                        enclosure.contains(value),
                        "{name}({x:e}) = {value:e} not in {enclosure:?} over {box_:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn enclosures_of_single_numbers_are_tight() {
    for (name, over, at) in FUNCTIONS {
        for x in [-2.7, -0.9, -0.3, 0.1, 0.3, 0.7, 0.9, 2.7] {
            let (enclosure, value) = (over(Interval::point(x)), at(x));
            let size = f64::abs(x);
            // up to 2 the slope of sinc is enclosed by a series that is cut at its term of x⁷, the curvature by the slope
            let cut = size.powi(7) / 45_360.0;
            let slack = match name {
                "sinc'" if size <= 2.0 => cut,
                "sinc\"" if size <= 2.0 => 2.0 * cut / size,
                // a negative number's power may be any
                "powf" if x < 0.0 => continue,
                _ => 0.0,
            };
            if value.is_nan() {
                assert!(
                    enclosure.is_empty() || size < 0.3,
                    "{name}({x}): {enclosure:?}"
                );
            } else {
                let width = enclosure.width() - 1.01 * slack;
                assert!(
                    width <= 1e-14 * (1.0 + value.abs()),
                    "{name}({x}): {enclosure:?}"
                );
            }
        }
    }
}

#[test]
fn enclosures_over_intervals_are_tight_where_no_extreme_lies_between() {
    let i = Interval::new;
    let near = |found: Interval, low: f64, high: f64| {
        let exact = i(low, high);
        let outside = i(
            low - 1e-14 * (1.0 + low.abs()),
            high + 1e-14 * (1.0 + high.abs()),
        );
        assert!(
            exact.is_inside(found) && found.is_inside(outside),
            "{found:?} for {exact:?}"
        );
    };
    near(i(1.0, 2.0).sin(), 2.0_f64.sin().min(1.0_f64.sin()), 1.0);
    near(
        i(-2.0, -1.0).sin(),
        -1.0,
        f64::sin(-1.0).max(f64::sin(-2.0)),
    );
    near(i(2.0, 4.0).sin(), 4.0_f64.sin(), 2.0_f64.sin());
    near(i(-2.0, -1.0).powi(3), -8.0, -1.0);
    near(i(-1.0, 2.0).powi(4), 0.0, 16.0);
    near(i(0.0, 4.0).powf(Interval::point(0.5)), 0.0, 2.0);
    assert_eq!(Interval::ZERO.powi(3), Interval::ZERO);
    assert_eq!(i(-3.0, 5.0).powi(0), Interval::ONE);
    // angles in each quadrant and across three half axes; across the fourth they jump
    for (y, x) in [
        (i(1.0, 2.0), i(1.0, 2.0)),
        (i(1.0, 2.0), i(-2.0, -1.0)),
        (i(-2.0, -1.0), i(-2.0, -1.0)),
        (i(-2.0, -1.0), i(1.0, 2.0)),
        (i(1.0, 2.0), i(-1.0, 1.0)),
        (i(-2.0, -1.0), i(-1.0, 1.0)),
        (i(-1.0, 1.0), i(1.0, 2.0)),
    ] {
        assert!(!y.crosses_branch_cut(x));
        let corners = [y.low(), y.high()].map(|y| [x.low(), x.high()].map(|x| y.atan2(x)));
        let all = corners.as_flattened();
        let low = all.iter().copied().fold(f64::MAX, f64::min);
        near(
            y.atan2(x),
            low,
            all.iter().copied().fold(f64::MIN, f64::max),
        );
    }
    for (y, x) in [(i(-1.0, 1.0), i(-2.0, -1.0)), (i(0.0, 1.0), i(-1.0, 0.0))] {
        assert!(y.crosses_branch_cut(x));
        near(y.atan2(x), -core::f64::consts::PI, core::f64::consts::PI);
    }
}

/// Two neighbours of each multiple of a quarter turn hold an extreme or a pole that is no number.
#[test]
fn extremes_and_poles_between_neighbours_are_enclosed() {
    let mut stream = Stream(11);
    for _ in 0..5000 {
        let k = (f64::powf(10.0, 8.7 * stream.next())) as i64;
        let sign = if stream.next() < 0.5 { -1.0 } else { 1.0 };
        // rounded to within two steps
        let quarter = sign * k as f64 * core::f64::consts::FRAC_PI_2;
        let around = Interval::new(quarter.next_down().next_down(), quarter.next_up().next_up());
        let even = k % 2 == 0;
        assert_eq!(around.tan() == Interval::ENTIRE, !even, "{k} quarters");
        let wave = if even { around.cos() } else { around.sin() };
        assert!(wave.contains(1.0) != wave.contains(-1.0) && wave.width() < 1e-9);
        let half = if even { k / 2 } else { (k - 1) / 2 };
        let up = (half % 2 == 0) != (!even && sign < 0.0);
        assert_eq!(wave.high() == 1.0, up, "{k} quarters: {wave:?}");
    }
}

/// Thirty digits of each value: the enclosure of the single number must lie around them. From mpmath 1.3.
#[test]
fn enclosures_hold_values_of_thirty_digits() {
    // (function, x, value rounded down, value rounded up), the two ends neighbours around the exact value
    let table: [(&str, f64, &str); 8] = [
        ("exp", 1.0, "2.71828182845904523536028747135"),
        ("ln", 2.0, "0.693147180559945309417232121458"),
        ("sin", 1.0, "0.841470984807896506652502321630"),
        ("cos", 1.0, "0.540302305868139717400936607443"),
        ("tan", 1.0, "1.55740772465490223050697480746"),
        ("atan", 1.0, "0.785398163397448309615660845820"),
        ("sinh", 1.0, "1.17520119364380145688238185060"),
        ("tanh", 1.0, "0.761594155955764888119458282605"),
    ];
    for (name, x, digits) in table {
        let over = FUNCTIONS
            .iter()
            .find(|(n, ..)| *n == name)
            .expect("in the table")
            .1;
        let nearest: f64 = digits.parse().expect("a number");
        let enclosure = over(Interval::point(x));
        // the exact value is within half a unit of the nearest number
        assert!(
            enclosure.low() < nearest && nearest < enclosure.high(),
            "{name}({x}) = {digits} not in {enclosure:?}"
        );
    }
}

#[test]
fn two_numbers_at_a_time() {
    type Two = (fn(Interval, Interval) -> Interval, fn(f64, f64) -> f64);
    let functions: [Two; 8] = [
        (|a, b| a + b, |a, b| a + b),
        (|a, b| a - b, |a, b| a - b),
        (|a, b| a * b, |a, b| a * b),
        (|a, b| a / b, |a, b| a / b),
        (Interval::max, f64::max),
        (Interval::min, f64::min),
        (Interval::atan2, f64::atan2),
        (Interval::powf, f64::powf),
    ];
    let mut stream = Stream(5);
    for (index, (over, at)) in functions.into_iter().enumerate() {
        for _ in 0..50_000 {
            let mut interval = || {
                let centre = 4.0 * (stream.next() - 0.5);
                let radius = 2.0 * stream.next() * stream.next();
                Interval::new(centre - radius, centre + radius)
            };
            let (a, b) = (interval(), interval());
            let enclosure = over(a, b);
            let (x, y) = (
                stream.within(a.low(), a.high()),
                stream.within(b.low(), b.high()),
            );
            let value = at(x, y);
            if !value.is_nan() {
                assert!(
                    enclosure.contains(value),
                    "function {index}: {x:e}, {y:e}: {value:e} not in {enclosure:?}"
                );
            }
        }
    }
}

/// Quotients of powers of two, whose ends are known but for the step outwards.
#[test]
fn quotients_by_divisors_of_every_sign_are_tight() {
    let (inf, i) = (f64::INFINITY, Interval::new);
    for (dividend, divisor, expected) in [
        (i(1.0, 2.0), i(2.0, 4.0), i(0.25, 1.0)),
        (i(1.0, 2.0), i(-4.0, -2.0), i(-1.0, -0.25)),
        (i(-2.0, 1.0), i(-4.0, -2.0), i(-0.5, 1.0)),
        (i(1.0, 2.0), i(0.0, 4.0), i(0.25, inf)),
        (i(1.0, 2.0), i(-0.0, 4.0), i(0.25, inf)),
        (i(1.0, 2.0), i(-4.0, 0.0), i(-inf, -0.25)),
        (i(1.0, 2.0), i(-4.0, -0.0), i(-inf, -0.25)),
        (i(-2.0, -1.0), i(0.0, 4.0), i(-inf, -0.25)),
        (i(1.0, 2.0), i(4.0, inf), i(0.0, 0.5)),
        (i(-2.0, 2.0), i(0.0, 4.0), Interval::ENTIRE),
    ] {
        let found = dividend / divisor;
        let by_one = i(expected.low().next_down(), expected.high().next_up());
        let by_two = i(by_one.low().next_down(), by_one.high().next_up());
        let inside = expected.is_inside(found) && found.is_inside(by_two);
        assert!(inside, "{dividend:?} / {divisor:?}: {found:?}");
    }
    assert_eq!(Interval::ZERO / i(2.0, 4.0), Interval::ZERO);
}

#[test]
fn operations_with_assignment_and_with_no_numbers() {
    let (x, y) = (Interval::new(1.0, 3.0), Interval::new(-2.0, 5.0));
    let (mut sum, mut difference, mut product) = (x, x, x);
    sum += y;
    difference -= y;
    product *= y;
    assert_eq!((sum, difference, product), (x + y, x - y, x * y));
    assert_eq!((sum.low(), sum.high()), (-1.0, 8.0));
    assert_eq!((difference.low(), difference.high()), (-4.0, 5.0));
    let operations: [Operation; 9] = [
        |a, b| a + b,
        |a, b| a - b,
        |a, b| a * b,
        |a, b| a / b,
        Interval::max,
        Interval::min,
        Interval::atan2,
        Interval::powf,
        Interval::intersection,
    ];
    for (index, operation) in operations.into_iter().enumerate() {
        for other in [x, Interval::ENTIRE, Interval::ZERO] {
            let (first, second) = (
                operation(Interval::EMPTY, other),
                operation(other, Interval::EMPTY),
            );
            assert!(first.is_empty() && second.is_empty(), "operation {index}");
        }
    }
    assert_eq!((x.hull(Interval::EMPTY), Interval::EMPTY.hull(x)), (x, x));
    for (name, over, _) in FUNCTIONS {
        let found = over(Interval::EMPTY);
        assert!(found.is_empty() || name == "sinc\"", "{name}: {found:?}");
    }
}

#[test]
fn ends_without_limit_and_intervals_without_numbers() {
    let i = Interval::new;
    assert_eq!(i(1.0, 2.0) / i(-1.0, 1.0), Interval::ENTIRE);
    assert!((i(1.0, 2.0) / i(0.0, 1.0)).low() >= 0.999);
    assert!((Interval::ZERO * Interval::ENTIRE) == Interval::ZERO);
    assert!((i(1.0, 2.0) / Interval::ZERO).is_empty());
    assert!(i(-2.0, -1.0).ln().is_empty() && i(-2.0, -1.0).sqrt().is_empty());
    assert!(i(-1.0, 0.0).ln().is_empty() && i(-3.0, -1.0).ln_1p().is_empty());
    assert!(i(-3.0, 1.0).ln_1p().contains(f64::ln(2.0)));
    assert!(Interval::ZERO.sinc_curvature().contains(-1.0 / 3.0));
    assert!((Interval::EMPTY + i(1.0, 2.0)).is_empty() && Interval::EMPTY.exp().is_empty());
    assert_eq!(i(0.0, 1e300).sin(), i(-1.0, 1.0));
    assert_eq!(i(1.0, 2.0).tan(), Interval::ENTIRE);
    assert_eq!(i(-1.0, 1.0).powf(i(0.5, 1.0)), Interval::ENTIRE);
    assert!(i(f64::MAX, f64::MAX).powi(2).high().is_infinite());
    assert!((Interval::ENTIRE - Interval::ENTIRE) == Interval::ENTIRE);
}

#[test]
fn ends_that_are_0_belong_to_both_signs() {
    let zero = Interval::point(0.0);
    // the origin has no angle, and just below the negative axis the angle is −π
    assert!(zero.crosses_branch_cut(zero));
    assert!(Interval::new(-1.0, 0.0).crosses_branch_cut(Interval::new(-1.0, 1.0)));
    assert!(!Interval::new(-1.0, 1.0).crosses_branch_cut(Interval::new(0.1, 1.0)));
    // no power of what is not negative is
    assert_eq!(Interval::new(0.0, 2.0).powi(3).low, 0.0);
}
