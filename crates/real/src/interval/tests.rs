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

type Pair = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64);

const FUNCTIONS: [Pair; 22] = [
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
        for x in [0.1, 0.3, 0.7, 0.9] {
            // the slope of sinc is enclosed by a series
            if name == "sinc'" {
                continue;
            }
            let (enclosure, value) = (over(Interval::point(x)), at(x));
            assert!(
                enclosure.width() <= 4e-15 * (1.0 + value.abs()),
                "{name}({x}): {enclosure:?}"
            );
        }
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

#[test]
fn ends_without_limit_and_intervals_without_numbers() {
    let i = Interval::new;
    assert_eq!(i(1.0, 2.0) / i(-1.0, 1.0), Interval::ENTIRE);
    assert!((i(1.0, 2.0) / i(0.0, 1.0)).low() >= 0.999);
    assert!((Interval::ZERO * Interval::ENTIRE) == Interval::ZERO);
    assert!((i(1.0, 2.0) / Interval::ZERO).is_empty());
    assert!(i(-2.0, -1.0).ln().is_empty() && i(-2.0, -1.0).sqrt().is_empty());
    assert!((Interval::EMPTY + i(1.0, 2.0)).is_empty() && Interval::EMPTY.exp().is_empty());
    assert_eq!(i(0.0, 1e300).sin(), i(-1.0, 1.0));
    assert_eq!(i(1.0, 2.0).tan(), Interval::ENTIRE);
    assert_eq!(i(-1.0, 1.0).powf(i(0.5, 1.0)), Interval::ENTIRE);
    assert!(i(f64::MAX, f64::MAX).powi(2).high().is_infinite());
    assert!((Interval::ENTIRE - Interval::ENTIRE) == Interval::ENTIRE);
}
