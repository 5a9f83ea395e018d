//! `f64` and `f32` as [`Real`] numbers: the standard library's functions with the feature `std`,
//! libm's without it.

use crate::real::{Real, Scalar};

macro_rules! real_for_float {
    ($float:ident, $($name:ident => $libm:ident),* ; powf => $pow:ident, atan2 => $atan2:ident) => {
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
            $(
                #[inline]
                fn $name(self) -> Self {
                    #[cfg(feature = "std")]
                    return $float::$name(self);
                    #[cfg(not(feature = "std"))]
                    return libm::$libm(self);
                }
            )*
            #[inline]
            fn atan2(self, x: Self) -> Self {
                #[cfg(feature = "std")]
                return $float::atan2(self, x);
                #[cfg(not(feature = "std"))]
                return libm::$atan2(self, x);
            }
            #[inline]
            fn powf(self, n: Self) -> Self {
                #[cfg(feature = "std")]
                return $float::powf(self, n);
                #[cfg(not(feature = "std"))]
                return libm::$pow(self, n);
            }
            #[inline]
            fn powi(self, n: i32) -> Self {
                #[cfg(feature = "std")]
                return $float::powi(self, n);
                #[cfg(not(feature = "std"))]
                return libm::$pow(self, n as $float);
            }
            #[inline]
            fn hypot(self, other: Self) -> Self {
                (self * self + other * other).sqrt()
            }
        }

        impl Scalar for $float {
            #[inline]
            fn value(self) -> f64 {
                f64::from(self)
            }
            const EPSILON: f64 = $float::EPSILON as f64;
        }
    };
}

real_for_float!(f64,
    sqrt => sqrt, exp => exp, exp_m1 => expm1, ln => log, ln_1p => log1p,
    sin => sin, cos => cos, tan => tan, asin => asin, acos => acos, atan => atan,
    sinh => sinh, cosh => cosh, tanh => tanh; powf => pow, atan2 => atan2);
real_for_float!(f32,
    sqrt => sqrtf, exp => expf, exp_m1 => expm1f, ln => logf, ln_1p => log1pf,
    sin => sinf, cos => cosf, tan => tanf, asin => asinf, acos => acosf, atan => atanf,
    sinh => sinhf, cosh => coshf, tanh => tanhf; powf => powf, atan2 => atan2f);
