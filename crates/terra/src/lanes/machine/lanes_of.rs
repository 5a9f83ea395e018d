//! The number type over a kind of register: one list of instructions in, every operation out.

/// Defines a lane type and its mask over `Register`, `Mask`, `WIDTH` and `COUNT` of the calling module, and the
/// places 0 to COUNT - 1: written out, since the compiler needs far longer for `array::from_fn`.
///
/// SAFETY, for every `unsafe` block below: the instructions need features of the processor. A value of the
/// type is made and used only inside the functions of `machine` that are compiled for these features, and
/// [`Level`](super::Level) calls those only where it has found the features. `load` and `store` touch
/// `WIDTH` numbers from the k-th part of an array of WIDTH · COUNT = 8.
macro_rules! lanes_of {
    ($name:ident, $mask:ident, [$($k:tt)*], {
        splat: |$sx:ident| $splat:expr,
        load: |$lp:ident| $load:expr,
        store: |$tp:ident, $tx:ident| $store:expr,
        add: |$aa:ident, $ab:ident| $add:expr,
        sub: |$ba:ident, $bb:ident| $sub:expr,
        mul: |$ca:ident, $cb:ident| $mul:expr,
        div: |$da:ident, $db:ident| $div:expr,
        fused: |$fa:ident, $fb:ident, $fc:ident| $fused:expr,
        sqrt: |$qx:ident| $sqrt:expr,
        negate: |$nx:ident| $negate:expr,
        abs: |$mx:ident| $abs:expr,
        lt: |$ga:ident, $gb:ident| $lt:expr,
        le: |$ha:ident, $hb:ident| $le:expr,
        select: |$im:ident, $ia:ident, $ib:ident| $select:expr,
        and: |$ja:ident, $jb:ident| $and:expr,
        or: |$ka:ident, $kb:ident| $or:expr,
        not: |$oa:ident| $not:expr,
        any: |$pm:ident| $any:expr,
        features: $features:literal,
        power_of_two: |$ux:ident| $power:expr,
        times_power: |$ra:ident, $rb:ident| $times:expr,
        exponent: |$vx:ident| $exponent:expr,
        mantissa: |$wx:ident| $mantissa:expr $(,)?
    }) => {
        use crate::contact::ladder::{Closeness, LaneRules, SharedRules};
        use crate::contact::lean::{LeanContact, LeanSums, Short};
        use crate::lanes::portable::{EXPONENT_BIAS, TWO_52};
        use crate::lanes::vector::{self, Vector};
        use grouser_real::Real;

        /// Eight lanes.
        #[derive(Clone, Copy, Debug)]
        pub(in crate::lanes) struct $name([Register; COUNT]);

        /// Their truths.
        #[derive(Clone, Copy, Debug)]
        pub(in crate::lanes) struct $mask([Mask; COUNT]);

        impl $name {
            #[inline(always)]
            fn each(self, f: impl Fn(Register) -> Register) -> Self {
                Self([$(f(self.0[$k])),*])
            }
            #[inline(always)]
            fn with(self, other: Self, f: impl Fn(Register, Register) -> Register) -> Self {
                Self([$(f(self.0[$k], other.0[$k])),*])
            }
            #[inline(always)]
            fn compare(self, other: Self, f: impl Fn(Register, Register) -> Mask) -> $mask {
                $mask([$(f(self.0[$k], other.0[$k])),*])
            }
            /// A function of one number, lane by lane.
            #[inline(always)]
            fn one_by_one(self, f: impl Fn(f64) -> f64) -> Self {
                Self::from_array(self.to_array().map(f))
            }
        }

        impl core::ops::BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self([$({
                    let ($ja, $jb) = (self.0[$k], other.0[$k]);
                    #[allow(unused_unsafe, reason = "masks of some registers are plain bits")]
                    unsafe { $and }
                }),*])
            }
        }
        impl core::ops::BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self([$({
                    let ($ka, $kb) = (self.0[$k], other.0[$k]);
                    #[allow(unused_unsafe, reason = "masks of some registers are plain bits")]
                    unsafe { $or }
                }),*])
            }
        }
        impl core::ops::Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self([$({
                    let $oa = self.0[$k];
                    #[allow(unused_unsafe, reason = "masks of some registers are plain bits")]
                    unsafe { $not }
                }),*])
            }
        }

        impl core::ops::Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self.with(other, |$aa, $ab| unsafe { $add })
            }
        }
        impl core::ops::Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self.with(other, |$ba, $bb| unsafe { $sub })
            }
        }
        impl core::ops::Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                self.with(other, |$ca, $cb| unsafe { $mul })
            }
        }
        impl core::ops::Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                self.with(other, |$da, $db| unsafe { $div })
            }
        }
        impl core::ops::Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                self.each(|$nx| unsafe { $negate })
            }
        }
        impl core::ops::AddAssign for $name {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }
        impl core::ops::SubAssign for $name {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
        impl core::ops::MulAssign for $name {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }

        impl Real for $name {
            type Mask = $mask;
            // SAFETY: a register is eight bytes a lane, and every bit pattern is one.
            const ZERO: Self = unsafe { core::mem::transmute::<[f64; 8], Self>([0.0; 8]) };
            // SAFETY: as above.
            const ONE: Self = unsafe { core::mem::transmute::<[f64; 8], Self>([1.0; 8]) };
            // SAFETY: as above.
            const PI: Self =
                unsafe { core::mem::transmute::<[f64; 8], Self>([core::f64::consts::PI; 8]) };

            #[inline(always)]
            fn from_f64($sx: f64) -> Self {
                Self([unsafe { $splat }; COUNT])
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $mask {
                self.compare(other, |$ga, $gb| unsafe { $lt })
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                self.compare(other, |$ha, $hb| unsafe { $le })
            }
            #[inline(always)]
            fn select(mask: $mask, a: Self, b: Self) -> Self {
                Self([$({
                    let ($im, $ia, $ib) = (mask.0[$k], a.0[$k], b.0[$k]);
                    unsafe { $select }
                }),*])
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self([$({
                    let ($fa, $fb, $fc) = (self.0[$k], a.0[$k], b.0[$k]);
                    unsafe { $fused }
                }),*])
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.each(|$mx| unsafe { $abs })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.each(|$qx| unsafe { $sqrt })
            }
            #[inline(always)]
            fn exp(self) -> Self {
                vector::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                vector::ln(self)
            }
            #[inline(always)]
            fn powf(self, n: Self) -> Self {
                (n * self.ln()).exp()
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                let (y, x) = (self.to_array(), x.to_array());
                let mut out = y;
                for ((out, y), x) in out.iter_mut().zip(y).zip(x) {
                    *out = Real::atan2(y, x);
                }
                Self::from_array(out)
            }
            #[inline(always)]
            fn powi(self, n: i32) -> Self {
                self.one_by_one(|x| Real::powi(x, n))
            }
            #[inline(always)]
            fn exp_m1(self) -> Self {
                vector::exp_m1(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                vector::sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                vector::cos(self)
            }
            lanes_of!(@one_by_one ln_1p tan asin acos atan sinh cosh tanh);
        }

        // One function each on these instructions, which callers do not repeat.
        #[target_feature(enable = $features)]
        fn sums(contact: &LeanContact<$name>, rules: &SharedRules<'_>) -> LeanSums<$name> {
            contact.sums(rules)
        }
        #[target_feature(enable = $features)]
        fn lane_sums(contact: &LeanContact<$name>, rules: &LaneRules<$name>) -> LeanSums<$name> {
            contact.sums(rules)
        }
        #[target_feature(enable = $features)]
        fn set_rules(rules: &mut LaneRules<$name>, n: &$name, closeness: Closeness) {
            rules.set_rules(*n, closeness);
        }
        #[target_feature(enable = $features)]
        fn set_power(rules: &mut LaneRules<$name>, n: &$name) {
            rules.set_power(*n);
        }

        impl Short for $name {
            #[inline(always)]
            fn exp2_short(self) -> Self {
                vector::exp2_short(self)
            }
            #[inline(always)]
            fn exp2_short_each<const N: usize>(x: [Self; N]) -> [Self; N] {
                vector::exp2_short_each(x)
            }
            #[inline(always)]
            fn log2_short(self) -> Self {
                vector::log2_short(self)
            }
        }

        impl Vector for $name {
            #[inline(always)]
            fn from_array(array: [f64; 8]) -> Self {
                Self([$({
                    let $lp = array[$k * WIDTH..].as_ptr();
                    unsafe { $load }
                }),*])
            }
            #[inline(always)]
            fn to_array(self) -> [f64; 8] {
                let mut array = [0.0; 8];
                $({
                    let ($tp, $tx) = (array[$k * WIDTH..].as_mut_ptr(), self.0[$k]);
                    unsafe { $store }
                })*
                array
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                self.each(|$ux| unsafe { $power })
            }
            #[inline(always)]
            fn times_power_of_two(self, shifted: Self) -> Self {
                self.with(shifted, |$ra, $rb| unsafe { $times })
            }
            #[inline(always)]
            fn exponent_and_mantissa(self) -> (Self, Self) {
                let exponent = self.each(|$vx| unsafe { $exponent }) - Self::from_f64(EXPONENT_BIAS);
                (exponent, self.each(|$wx| unsafe { $mantissa }))
            }
            #[inline(always)]
            fn sums(contact: &LeanContact<Self>, rules: &SharedRules<'_>) -> LeanSums<Self> {
                unsafe { sums(contact, rules) }
            }
            #[inline(always)]
            fn lane_sums(contact: &LeanContact<Self>, rules: &LaneRules<Self>) -> LeanSums<Self> {
                unsafe { lane_sums(contact, rules) }
            }
            #[inline(always)]
            fn set_rules(rules: &mut LaneRules<Self>, n: &Self, closeness: Closeness) {
                unsafe { set_rules(rules, n, closeness) }
            }
            #[inline(always)]
            fn set_power(rules: &mut LaneRules<Self>, n: &Self) {
                unsafe { set_power(rules, n) }
            }
            #[inline(always)]
            fn any(mask: $mask) -> bool {
                mask.0.into_iter().any(|$pm| {
                    #[allow(unused_unsafe, reason = "masks of some registers are plain bits")]
                    unsafe { $any }
                })
            }
        }
    };
    (@one_by_one $($function:ident)*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            self.one_by_one(Real::$function)
        }
    )*};
}

pub(super) use lanes_of;
