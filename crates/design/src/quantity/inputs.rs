//! Parameters with their values, in numbers of any kind, and the parts of a wheel on soil made of them.

use grouser_real::Scalar;
use grouser_terra::{
    Angle, Bekker, LawChoice, MohrCoulomb, Motion, Pressure, RigidWheel, SinkageExponent, Soil,
    SoilLaws, SoilParams, WheelSize,
};

use super::parameter::Parameter;

/// One value per parameter; NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inputs<R> {
    pub(crate) values: [R; Parameter::COUNT],
}

impl<R: Scalar> Inputs<R> {
    pub(super) fn get(&self, parameter: Parameter) -> R {
        self.values[parameter as usize]
    }

    /// Is there a value?
    pub(super) fn has(&self, parameter: Parameter) -> bool {
        !self.get(parameter).value().is_nan()
    }

    fn scaled(&self, parameter: Parameter, factor: f64) -> R {
        self.get(parameter) * R::from_f64(factor)
    }

    pub(super) fn radians(&self, parameter: Parameter) -> R {
        self.scaled(parameter, std::f64::consts::PI / 180.0)
    }

    /// r + h, m.
    pub(super) fn radius(&self) -> R {
        self.get(Parameter::Radius) + self.get(Parameter::GrouserHeight)
    }

    pub(super) fn size(&self) -> WheelSize<R> {
        WheelSize::smooth(self.radius(), self.get(Parameter::Width))
    }

    pub(super) fn motion(slip: R) -> Motion<R> {
        Motion {
            slip,
            q_y: R::ZERO,
            slip_angle: R::ZERO,
        }
    }

    pub(super) fn modulus(&self) -> Bekker<R> {
        Bekker {
            k_c: self.scaled(Parameter::KC, 1e3),
            k_phi: self.scaled(Parameter::KPhi, 1e3),
        }
    }

    pub(super) fn strength(&self) -> MohrCoulomb<R> {
        MohrCoulomb {
            cohesion: self.scaled(Parameter::Cohesion, 1e3),
            phi: self.radians(Parameter::Phi),
        }
    }

    pub(super) fn laws(&self) -> SoilLaws<R> {
        let k_shear = self.get(Parameter::KShear);
        SoilLaws {
            pressure: Pressure::Bekker(self.modulus()),
            exponent: SinkageExponent {
                n_0: self.get(Parameter::Exponent),
                n_1: self.get(Parameter::ExponentDriving),
                n_2: self.get(Parameter::ExponentBraking),
            },
            strength: self.strength(),
            k_shear,
            k_shear_1: R::ZERO,
            k_shear_side: k_shear,
            k_shear_side_1: R::ZERO,
            c_1: self.get(Parameter::C1),
            c_2: self.get(Parameter::C2),
            rebound: self.get(Parameter::Rebound),
            unit_weight: R::ZERO,
            rear_driving: R::ZERO,
            rear_drift: R::ZERO,
            transport_layer: R::ZERO,
            choice: LawChoice::default(),
        }
    }

    /// The values without derivatives.
    pub(super) fn plain(&self) -> Inputs<f64> {
        Inputs {
            values: self.values.map(Scalar::value),
        }
    }
}

impl Inputs<f64> {
    /// The values as constants of another kind of number.
    pub(super) fn lifted<R: Scalar>(&self) -> Inputs<R> {
        Inputs {
            values: self.values.map(R::from_f64),
        }
    }

    /// The wheel, checked.
    pub(super) fn wheel(&self) -> grouser_terra::Result<RigidWheel> {
        RigidWheel::new(self.radius(), self.get(Parameter::Width))
    }

    /// The soil, checked.
    pub(super) fn soil(&self) -> grouser_terra::Result<Soil> {
        let modulus = self.modulus();
        Soil::new(SoilParams {
            n_1: self.get(Parameter::ExponentDriving),
            n_2: self.get(Parameter::ExponentBraking),
            cohesion: self.strength().cohesion,
            phi: Angle::from_deg(self.get(Parameter::Phi)),
            k_shear: self.get(Parameter::KShear),
            c_1: self.get(Parameter::C1),
            c_2: self.get(Parameter::C2),
            rebound: self.get(Parameter::Rebound),
            ..SoilParams::bekker(modulus.k_c, modulus.k_phi, self.get(Parameter::Exponent))
        })
    }
}
