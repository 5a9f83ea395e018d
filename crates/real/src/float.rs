//! `f64` and `f32` as [`Real`] numbers: the standard library's functions with the feature `std`, libm's without it and
//! with the feature `deterministic`.
//!
//! The standard library calls the platform's functions, which differ in the last bit between C libraries, versions and
//! processors: glibc alone chooses between two sines by whether the processor has fused instructions. libm is plain
//! code, rounded operation by operation.

use crate::real::{Real, Scalar};

/// The platform's function of a name, or libm's.
macro_rules! function {
    ($float:ident::$name:ident or $libm:ident($($x:expr),*)) => {{
        #[cfg(all(feature = "std", not(feature = "deterministic")))]
        return $float::$name($($x),*);
        #[cfg(not(all(feature = "std", not(feature = "deterministic"))))]
        return libm::$libm($($x),*);
    }};
}

macro_rules! real_for_float {
    ($float:ident, $($name:ident => $libm:ident),* ;
        sqrt => $sqrt:ident, powf => $pow:ident, atan2 => $atan2:ident, sin_cos => $sin_cos:ident) => {
        impl Real for $float {
            type Mask = bool;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const PI: Self = core::$float::consts::PI;

            #[inline]
            #[allow(clippy::cast_possible_truncation, reason = "rounding to this type's precision is the job")]
            #[allow(trivial_numeric_casts, reason = "the macro serves f32 and f64")]
            fn from_f64(x: f64) -> Self {
                x as $float
            }
            #[inline]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // Without a fused instruction the library's `mul_add` is a slow software routine;
                // two roundings are what every machine does fast and alike.
                self * a + b
            }
            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                // one instruction, and rounded correctly everywhere
                #[cfg(feature = "std")]
                return $float::sqrt(self);
                #[cfg(not(feature = "std"))]
                return libm::$sqrt(self);
            }
            $(
                #[inline]
                fn $name(self) -> Self {
                    function!($float::$name or $libm(self))
                }
            )*
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                function!($float::sin_cos or $sin_cos(self))
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                function!($float::atan2 or $atan2(self, x))
            }
            #[inline]
            fn powf(self, n: Self) -> Self {
                function!($float::powf or $pow(self, n))
            }
            #[inline]
            fn powi(self, n: i32) -> Self {
                // by squaring, in the order of the compilers' own routine, which promises no order
                let (mut power, mut square, mut left) = (1.0, self, n.unsigned_abs());
                while left > 0 {
                    if left & 1 == 1 {
                        power *= square;
                    }
                    left >>= 1;
                    if left > 0 {
                        square *= square;
                    }
                }
                if n < 0 { 1.0 / power } else { power }
            }
            #[inline]
            fn hypot(self, other: Self) -> Self {
                let root = (self * self + other * other).sqrt();
                let most = self.abs().max(other.abs());
                if root.is_finite() || most.is_infinite() {
                    return root;
                }
                // the squares overflow
                let (a, b) = (self / most, other / most);
                most * (a * a + b * b).sqrt()
            }
        }

        impl Scalar for $float {
            const IS_PLAIN: bool = true;

            #[inline]
            fn value(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

real_for_float!(f64,
    exp => exp, exp_m1 => expm1, ln => log, log10 => log10, ln_1p => log1p,
    sin => sin, cos => cos, tan => tan, asin => asin, acos => acos, atan => atan,
    sinh => sinh, cosh => cosh, tanh => tanh; sqrt => sqrt, powf => pow, atan2 => atan2, sin_cos => sincos);
real_for_float!(f32,
    exp => expf, exp_m1 => expm1f, ln => logf, log10 => log10f, ln_1p => log1pf,
    sin => sinf, cos => cosf, tan => tanf, asin => asinf, acos => acosf, atan => atanf,
    sinh => sinhf, cosh => coshf, tanh => tanhf; sqrt => sqrtf, powf => powf, atan2 => atan2f, sin_cos => sincosf);

#[cfg(test)]
mod tests {
    use crate::Real;

    /// Against the platform's, which scales always.
    #[test]
    fn lengths_beyond_the_range_of_squares_are_finite() {
        for (x, y) in [
            (3e200_f64, 4e200),
            (-1e300, 1.0),
            (f64::MAX, 0.0),
            (0.0, -1e155),
        ] {
            let expected = f64::hypot(x, y);
            assert!(
                (Real::hypot(x, y) / expected - 1.0).abs() < 1e-15,
                "{x} {y}"
            );
        }
        assert_eq!(Real::hypot(f64::INFINITY, 1.0), f64::INFINITY);
        assert!(Real::hypot(f64::NAN, 1e300).is_nan());
        assert_eq!(Real::hypot(3e30_f32, 4e30), 5e30);
    }
}
