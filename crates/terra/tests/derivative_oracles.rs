//! Exact derivatives against two others that share no code with ours: num-dual's dual numbers, and the
//! complex step, f′(x) = Im f(x + ih)/h with h so small that nothing is left out.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use grouser_real::{Dual, Real, Scalar};
use grouser_terra::{
    Contact, DualInputs, Forces, Kinematics, Motion, Pressure, RigidWheel, Settings, ShearLaw,
    Slip, SoilLaws, WheelOnSoil, WheelSize, catalogue, entry_angle,
};
use num_complex::Complex64;
use num_dual::{Dual64, DualNum};

/// The step of the complex step: its square is far below the last digit of anything.
const STEP: f64 = 1e-40;

/// A number of another crate, made one of ours.
#[derive(Clone, Copy, Debug)]
struct Other<T>(T);

/// The functions that the laws use and the two crates name differently.
trait Number: Copy + core::fmt::Debug + 'static {
    const ZERO: Self;
    const ONE: Self;
    const PI: Self;
    fn real(self) -> f64;
    fn constant(x: f64) -> Self;
    fn exp_m1(self) -> Self;
    fn ln_1p(self) -> Self;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn power(self, n: Self) -> Self;
}

impl Number for Dual64 {
    const ZERO: Self = Self { re: 0.0, eps: 0.0 };
    const ONE: Self = Self {
        re: 1.0,
        ..Self::ZERO
    };
    const PI: Self = Self {
        re: core::f64::consts::PI,
        ..Self::ZERO
    };
    fn real(self) -> f64 {
        self.re
    }
    fn constant(x: f64) -> Self {
        Self::from_re(x)
    }
    fn exp_m1(self) -> Self {
        DualNum::exp_m1(&self)
    }
    fn ln_1p(self) -> Self {
        DualNum::ln_1p(&self)
    }
    fn asin(self) -> Self {
        DualNum::asin(&self)
    }
    fn acos(self) -> Self {
        DualNum::acos(&self)
    }
    fn atan(self) -> Self {
        DualNum::atan(&self)
    }
    fn power(self, n: Self) -> Self {
        DualNum::powd(&self, n)
    }
}

/// num-complex takes these by logarithms, in which an imaginary part of 1e-40 is lost; to first order in
/// it, which is all there is, they are these.
impl Number for Complex64 {
    const ZERO: Self = Self::new(0.0, 0.0);
    const ONE: Self = Self::new(1.0, 0.0);
    const PI: Self = Self::new(core::f64::consts::PI, 0.0);
    fn real(self) -> f64 {
        self.re
    }
    fn constant(x: f64) -> Self {
        Self::new(x, 0.0)
    }
    fn exp_m1(self) -> Self {
        Self::new(self.re.exp_m1(), self.re.exp() * self.im)
    }
    fn ln_1p(self) -> Self {
        Self::new(self.re.ln_1p(), self.im / (1.0 + self.re))
    }
    fn asin(self) -> Self {
        Self::new(self.re.asin(), self.im / (1.0 - self.re * self.re).sqrt())
    }
    fn acos(self) -> Self {
        Self::new(self.re.acos(), -self.im / (1.0 - self.re * self.re).sqrt())
    }
    fn atan(self) -> Self {
        Self::new(self.re.atan(), self.im / (1.0 + self.re * self.re))
    }
    fn power(self, n: Self) -> Self {
        (n * self.ln()).exp()
    }
}

macro_rules! operators {
    ($($number:ty),*) => {$(
        impl Add for Other<$number> {
            type Output = Self;
            fn add(self, other: Self) -> Self { Self(self.0 + other.0) }
        }
        impl Sub for Other<$number> {
            type Output = Self;
            fn sub(self, other: Self) -> Self { Self(self.0 - other.0) }
        }
        impl Mul for Other<$number> {
            type Output = Self;
            fn mul(self, other: Self) -> Self { Self(self.0 * other.0) }
        }
        impl Div for Other<$number> {
            type Output = Self;
            fn div(self, other: Self) -> Self { Self(self.0 / other.0) }
        }
        impl Neg for Other<$number> {
            type Output = Self;
            fn neg(self) -> Self { Self(-self.0) }
        }
        impl AddAssign for Other<$number> {
            fn add_assign(&mut self, other: Self) { *self = *self + other; }
        }
        impl SubAssign for Other<$number> {
            fn sub_assign(&mut self, other: Self) { *self = *self - other; }
        }
        impl MulAssign for Other<$number> {
            fn mul_assign(&mut self, other: Self) { *self = *self * other; }
        }
        impl PartialEq for Other<$number> {
            fn eq(&self, other: &Self) -> bool { self.0.real() == other.0.real() }
        }
        impl PartialOrd for Other<$number> {
            fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
                self.0.real().partial_cmp(&other.0.real())
            }
        }
        impl Real for Other<$number> {
            type Mask = bool;
            const ZERO: Self = Self(<$number as Number>::ZERO);
            const ONE: Self = Self(<$number as Number>::ONE);
            const PI: Self = Self(<$number as Number>::PI);
            fn from_f64(x: f64) -> Self { Self(Number::constant(x)) }
            fn lt(self, other: Self) -> bool { self.0.real() < other.0.real() }
            fn le(self, other: Self) -> bool { self.0.real() <= other.0.real() }
            fn select(mask: bool, a: Self, b: Self) -> Self { if mask { a } else { b } }
            fn mul_add(self, a: Self, b: Self) -> Self { self * a + b }
            fn abs(self) -> Self { if self.0.real() < 0.0 { -self } else { self } }
            fn exp_m1(self) -> Self { Self(Number::exp_m1(self.0)) }
            fn ln_1p(self) -> Self { Self(Number::ln_1p(self.0)) }
            fn asin(self) -> Self { Self(Number::asin(self.0)) }
            fn acos(self) -> Self { Self(Number::acos(self.0)) }
            fn atan(self) -> Self { Self(Number::atan(self.0)) }
            fn atan2(self, x: Self) -> Self { (self / x).atan() }
            fn powf(self, n: Self) -> Self { Self(self.0.power(n.0)) }
            operators!(@same sqrt exp ln sin cos tan sinh cosh tanh);
            fn powi(self, n: i32) -> Self { Self(self.0.powi(n)) }
        }
        impl Scalar for Other<$number> {
            fn value(self) -> f64 { self.0.real() }
        }
    )*};
    (@same $($name:ident)*) => {$(
        fn $name(self) -> Self { Self(self.0.$name()) }
    )*};
}
operators!(Dual64, Complex64);

/// r, b, z, s, c, φ, K, k_phi, n
const POINT: [f64; 9] = [0.125, 0.1, 0.02, 0.3, 1000.0, 0.52, 0.025, 1_528_400.0, 1.1];

fn soil<R: Scalar>(x: &[R; 9]) -> SoilLaws<R> {
    let mut soil: SoilLaws<R> = catalogue::find("dry-sand").unwrap().soil().unwrap().laws();
    soil.strength.cohesion = x[4];
    soil.strength.phi = x[5];
    soil.k_shear = x[6];
    if let Pressure::Bekker(law) = &mut soil.pressure {
        law.k_phi = x[7];
    }
    soil.exponent.n_0 = x[8];
    soil
}

fn forces_at<R: Scalar>(x: &[R; 9], theta_1: R) -> Forces<R> {
    let motion = Motion {
        slip: x[3],
        q_y: R::ZERO,
        slip_angle: R::ZERO,
    };
    let size = WheelSize::smooth(x[0], x[1]);
    Contact::new(&size, &soil(x), ShearLaw::Coupled, &motion, theta_1).forces()
}

fn three<R: Scalar>(f: &Forces<R>) -> [R; 3] {
    [f.vertical_force, f.drawbar_pull, f.torque]
}

/// The three-by-nine Jacobian, a column at a time.
fn by_others(point: [f64; 9]) -> [[[f64; 3]; 9]; 2] {
    let dual = core::array::from_fn(|i| {
        let x: [Other<Dual64>; 9] = core::array::from_fn(|k| {
            let seed = if k == i { 1.0 } else { 0.0 };
            Other(Dual64::new(point[k], seed))
        });
        three(&forces_at(&x, entry_angle(x[2], x[0]))).map(|f| f.0.eps)
    });
    let complex = core::array::from_fn(|i| {
        let x: [Other<Complex64>; 9] = core::array::from_fn(|k| {
            let seed = if k == i { STEP } else { 0.0 };
            Other(Complex64::new(point[k], seed))
        });
        three(&forces_at(&x, entry_angle(x[2], x[0]))).map(|f| f.0.im / STEP)
    });
    [dual, complex]
}

#[test]
fn the_jacobian_agrees_with_num_dual_and_the_complex_step() {
    // driving, braking with and without a reversal, stiff, near nothing
    for (slip, k_shear, sinkage) in [
        (0.3, 0.025, 0.02),
        (0.05, 0.004, 0.05),
        (-0.15, 0.025, 0.02),
        (-0.6, 0.025, 0.02),
        (0.9, 0.0005, 0.03),
        (0.2, 0.025, 1e-5),
    ] {
        let mut point = POINT;
        (point[3], point[6], point[2]) = (slip, k_shear, sinkage);
        let x: [Dual<9>; 9] = core::array::from_fn(|i| Dual::variable(point[i], i));
        let ours = three(&forces_at(&x, entry_angle(x[2], x[0])));
        for others in by_others(point) {
            for (i, column) in others.iter().enumerate() {
                for (k, theirs) in column.iter().enumerate() {
                    let scale = ours[0].value.abs() / point[i].abs();
                    let off = (ours[k].gradient[i] - theirs).abs();
                    // the same derivative by other roundings: hundreds of them, some through differences
                    assert!(
                        off < 1e-12 * scale.max(theirs.abs()),
                        "slip {slip} force {k} input {i}: {off:e} of {scale:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_solved_sinkages_derivatives_agree_too() {
    // dθ_1/dx = −(∂W/∂x)/(∂W/∂θ_1) with both partial derivatives from num-dual
    let wheel = RigidWheel::new(POINT[0], POINT[1]).unwrap();
    let contact = WheelOnSoil::new(
        wheel,
        catalogue::find("dry-sand").unwrap().soil().unwrap(),
        Settings::default(),
    )
    .unwrap();
    for slip in [0.05, 0.4, -0.2] {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let params = *contact.soil().params();
        let mut inputs = DualInputs::<3>::new(&contact, &motion);
        inputs.motion.slip = Dual::variable(slip, 0);
        inputs.soil.strength.phi = Dual::variable(params.phi.rad(), 1);
        inputs.soil.k_shear = Dual::variable(params.k_shear, 2);
        let load = 60.0;
        let solved = inputs
            .under_load(&contact, &motion, Dual::constant(load))
            .unwrap()
            .unwrap();
        let point = [
            POINT[0],
            POINT[1],
            0.0,
            slip,
            params.cohesion,
            params.phi.rad(),
            params.k_shear,
            1_528_400.0,
            params.n,
        ];
        let force = |seeds: [f64; 9], seed: f64| {
            let x: [Other<Dual64>; 9] =
                core::array::from_fn(|k| Other(Dual64::new(point[k], seeds[k])));
            let theta_1 = Other(Dual64::new(solved.theta_1.value, seed));
            forces_at(&x, theta_1).vertical_force.0.eps
        };
        let by_angle = force([0.0; 9], 1.0);
        for (direction, input) in [3, 5, 6].into_iter().enumerate() {
            let mut seeds = [0.0; 9];
            seeds[input] = 1.0;
            let expected = -force(seeds, 0.0) / by_angle;
            let ours = solved.theta_1.gradient[direction];
            // as above, and the solved angle's own rounding
            assert!(
                (ours - expected).abs() < 1e-11 * (expected.abs() + 1e-3 / point[input].abs()),
                "slip {slip} input {input}: {ours:e} {expected:e}"
            );
        }
    }
}

#[test]
fn a_load_of_zero_has_no_derivatives() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = RigidWheel::new(POINT[0], POINT[1]).unwrap();
    let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
    let motion = Kinematics::straight(Slip::new(0.2).unwrap());
    let inputs = DualInputs::<1>::new(&contact, &motion);
    let at = |load| inputs.under_load(&contact, &motion, Dual::variable(load, 0));
    let error = at(0.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "load is 0 N, but must be greater than 0 N"
    );
    // the sinkage of a power of the load: its derivative grows as the load vanishes
    let slopes = [1e-9, 1e-6, 1e-3].map(|load| at(load).unwrap().unwrap().sinkage.gradient[0]);
    assert!(
        slopes.is_sorted_by(|a, b| a > b && a.is_finite()),
        "{slopes:?}"
    );
}
