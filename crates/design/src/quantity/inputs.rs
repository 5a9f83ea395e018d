//! Parameters with their values, in numbers of any kind, and the parts of a wheel on soil made of them.

use grouser_real::Scalar;
use grouser_terra::{
    Angle, Bekker, GrouserRule, Grousers, MohrCoulomb, Motion, Pressure, RigidWheel, ShearLaw,
    SinkageExponent, Soil, SoilLaws, SoilParams, WheelSize,
};

use super::fixed::{Beside, Fixed};
use super::parameter::Parameter;

/// One value per parameter, NaN where there is none, and what no parameter describes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inputs<R> {
    pub(crate) values: [R; Parameter::COUNT],
    beside: Beside,
}

impl<R: Scalar> Inputs<R> {
    /// The fixed numbers, without derivatives.
    pub(crate) fn new(fixed: &Fixed) -> Self {
        Self {
            values: fixed.numbers.map(R::from_f64),
            beside: fixed.beside,
        }
    }

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

    /// Does the wheel have lugs that are counted?
    fn has_lugs(&self) -> bool {
        self.get(Parameter::GrouserCount).value() > 0.0
    }

    /// The radius for slip and sinkage, m: r of a smooth wheel and of one with lugs that are counted, else r + h.
    pub(super) fn radius(&self) -> R {
        let rim = self.get(Parameter::Radius);
        if self.has_lugs() {
            rim
        } else {
            rim + self.get(Parameter::GrouserHeight)
        }
    }

    pub(super) fn size(&self) -> WheelSize<R> {
        let smooth = WheelSize::smooth(self.radius(), self.get(Parameter::Width));
        if self.has_lugs() {
            return smooth.with_lugs(
                self.get(Parameter::GrouserHeight),
                self.get(Parameter::GrouserCount),
                self.get(Parameter::GrouserThickness),
            );
        }
        let Some(tips) = self.beside.tip_share else {
            return smooth;
        };
        let rim = self.get(Parameter::Radius);
        WheelSize {
            shear_radius: rim,
            rim_radius: rim,
            tip_share: R::from_f64(tips),
            ..smooth
        }
    }

    /// The law that makes shear stress of displacement.
    pub(super) fn shear_law(&self) -> ShearLaw {
        self.beside.laws.shear.unwrap_or_default()
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
        let c = R::from_f64;
        let (k_shear, beside) = (self.get(Parameter::KShear), &self.beside);
        SoilLaws {
            pressure: match beside.pressure {
                Some(law) => law.lifted(),
                None => Pressure::Bekker(self.modulus()),
            },
            exponent: SinkageExponent {
                n_0: self.get(Parameter::Exponent),
                n_1: self.get(Parameter::ExponentDriving),
                n_2: self.get(Parameter::ExponentBraking),
            },
            strength: self.strength(),
            k_shear,
            k_shear_1: c(beside.k_shear_1),
            k_shear_side: beside.k_shear_side.map_or(k_shear, c),
            k_shear_side_1: c(match beside.k_shear_side {
                Some(_) => beside.k_shear_side_1,
                None => beside.k_shear_1,
            }),
            c_1: self.get(Parameter::C1),
            c_2: self.get(Parameter::C2),
            rebound: self.get(Parameter::Rebound),
            unit_weight: c(beside.unit_weight.unwrap_or(0.0)),
            rear_driving: c(beside.rear_driving),
            rear_drift: c(beside.rear_drift),
            transport_layer: c(beside.transport_layer),
            sideways_support: c(beside.sideways_support.unwrap_or(1.0)),
            choice: beside.laws,
        }
    }

    /// The values without derivatives.
    pub(crate) fn plain(&self) -> Inputs<f64> {
        Inputs {
            values: self.values.map(Scalar::value),
            beside: self.beside,
        }
    }
}

impl Inputs<f64> {
    /// The values as constants of another kind of number.
    pub(crate) fn lifted<R: Scalar>(&self) -> Inputs<R> {
        Inputs {
            values: self.values.map(R::from_f64),
            beside: self.beside,
        }
    }

    /// The wheel, checked.
    pub(crate) fn wheel(&self) -> grouser_terra::Result<RigidWheel> {
        let width = self.get(Parameter::Width);
        let height = self.get(Parameter::GrouserHeight);
        if self.has_lugs() {
            let rule = GrouserRule::Lugs {
                count: self.get(Parameter::GrouserCount),
                thickness: self.get(Parameter::GrouserThickness),
            };
            return RigidWheel::new(self.radius(), width)?.with_grousers(Grousers { height, rule });
        }
        match self.beside.tip_share {
            Some(tips) => {
                RigidWheel::new(self.get(Parameter::Radius), width)?.with_grousers(Grousers {
                    height,
                    rule: GrouserRule::AreaShare { tips },
                })
            }
            None => RigidWheel::new(self.radius(), width),
        }
    }

    /// The soil, checked.
    pub(super) fn soil(&self) -> grouser_terra::Result<Soil> {
        let beside = &self.beside;
        Soil::new(SoilParams {
            pressure: beside.pressure.unwrap_or(Pressure::Bekker(self.modulus())),
            n: self.get(Parameter::Exponent),
            n_1: self.get(Parameter::ExponentDriving),
            n_2: self.get(Parameter::ExponentBraking),
            cohesion: self.strength().cohesion,
            phi: Angle::from_deg(self.get(Parameter::Phi)),
            k_shear: self.get(Parameter::KShear),
            k_shear_1: beside.k_shear_1,
            k_shear_side: beside.k_shear_side,
            k_shear_side_1: beside.k_shear_side_1,
            c_1: self.get(Parameter::C1),
            c_2: self.get(Parameter::C2),
            rebound: self.get(Parameter::Rebound),
            unit_weight: beside.unit_weight,
            rear_driving: beside.rear_driving,
            rear_drift: beside.rear_drift,
            transport_layer: beside.transport_layer,
            sideways_support: beside.sideways_support.unwrap_or(1.0),
            laws: beside.laws,
            fitted: None,
        })
    }
}
