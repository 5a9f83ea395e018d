//! Where a function that changes its sign vanishes.

/// Most steps of a search: halving alone would be at rounding after as many.
const MAX_STEPS: u32 = 60;

/// The place between two ends (place, value) of opposite sign where a function vanishes, by the secant in their bracket. It ends
/// where the value is at most `close.0`, or where the place moves by at most `close.1`.
///
/// Source: the Illinois method (Dowell & Jarratt, *A modified regula falsi method*, BIT 11, 1971).
pub(crate) fn crossing(
    value_at: impl Fn(f64) -> f64,
    [mut a, mut b]: [(f64, f64); 2],
    close: (f64, f64),
) -> f64 {
    for _ in 0..MAX_STEPS {
        let place = b.0 - b.1 * (b.0 - a.0) / (b.1 - a.1);
        let value = value_at(place);
        let step = (place - a.0).abs().min((place - b.0).abs());
        if value.is_sign_negative() == b.1.is_sign_negative() {
            // the same end again: the other end's value is halved so that it moves too
            a.1 *= 0.5;
        } else {
            a = b;
        }
        b = (place, value);
        if value.abs() <= close.0 || step <= close.1 {
            break;
        }
    }
    b.0
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::*;

    /// A root between two ends, how often the function was evaluated, and its value there.
    fn root(f: impl Fn(f64) -> f64, (a, b): (f64, f64), close: (f64, f64)) -> (f64, u32, f64) {
        let count = Cell::new(0);
        let counted = |x: f64| {
            count.set(count.get() + 1);
            assert!(a.min(b) < x && x < a.max(b), "{x} between {a} and {b}");
            f(x)
        };
        let place = crossing(counted, [(a, f(a)), (b, f(b))], close);
        (place, count.get(), f(place))
    }

    /// Two secant steps and one with a halved value multiply the digits by three: from a tenth to rounding within four such rounds.
    #[test]
    fn roots_in_closed_form() {
        /// Of places around 1: a few units in their last place.
        const ROUNDING_OF_PLACE: f64 = 1e-15;
        const MAX_EVALUATIONS: u32 = 12;
        let check = |f: &dyn Fn(f64) -> f64, ends: (f64, f64), expected: f64| {
            let mirrored = |x: f64| -f(x);
            for (ends, f) in [
                (ends, f),
                ((ends.1, ends.0), f),
                (ends, &mirrored as &dyn Fn(f64) -> f64),
            ] {
                let (place, count, _) = root(f, ends, (0.0, ROUNDING_OF_PLACE));
                assert!(
                    (place - expected).abs() < 2.0 * ROUNDING_OF_PLACE,
                    "{place} {expected}"
                );
                assert!(count <= MAX_EVALUATIONS, "{count} for {expected}");
            }
        };
        check(&|x| x * x - 0.3, (0.1, 1.3), 0.3_f64.sqrt());
        check(&|x| x * x * x - 0.2, (0.0, 1.0), 0.2_f64.cbrt());
        check(&|x| x.exp() - 3.0, (0.2, 2.0), 3.0_f64.ln());
        check(&|x| x.sin() - 0.6, (-0.4, 1.5), 0.6_f64.asin());
        check(&|x| 1.0 / x - 4.0, (0.1, 0.9), 0.25);
        // a straight line at once
        assert_eq!(
            root(|x| 3.0 * x - 1.5, (0.0, 2.0), (0.0, 0.0)),
            (0.5, 1, 0.0)
        );
    }

    /// y² − 1, y = x − ½, between y = 0 and 3 by hand: 1/3 with −8/9, 3/5 with −16/25, and with 8 halved at the far end 27/29.
    #[test]
    fn it_ends_by_value_or_by_step() {
        let f = |x: f64| (x - 0.5) * (x - 0.5) - 1.0;
        let of = |close: (f64, f64)| root(f, (0.5, 3.5), close);
        for (close, expected, evaluations) in [
            ((0.889, 0.0), 1.0 / 3.0, 1),
            ((0.888, 0.0), 0.6, 2),
            ((0.639, 0.0), 27.0 / 29.0, 3),
            // steps of 1/3 from the end at 0, 4/15 from the last place, 0.331 and 0.129
            ((0.0, 0.334), 1.0 / 3.0, 1),
            ((0.0, 0.333), 0.6, 2),
            ((0.0, 0.266), 1.0602, 4),
        ] {
            let (place, count, _) = of(close);
            assert!((place - 0.5 - expected).abs() < 1e-4, "{place} {close:?}");
            assert_eq!(count, evaluations, "{close:?}");
        }
        let (place, _, value) = of((0.889, 0.0));
        assert!(of((-value, 0.0)).1 == 1 && of((0.0, place - 0.5)).1 == 1);
        // from the other side the near end is the second one
        assert_eq!(root(f, (3.5, 0.5), (0.0, 0.334)).1, 1);
        // and a function that never comes close
        let jump = |x: f64| if x < 0.3 { -1.0 } else { 1.0 };
        assert_eq!(root(jump, (0.0, 1.0), (0.5, -1.0)).1, MAX_STEPS);
    }
}
