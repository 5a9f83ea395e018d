//! The numbers of a wheel, its soil and its state that no variable replaces.

use grouser_terra::{GrouserRule, Kernel, LawChoice, Pressure, RigidWheel, Soil};

use super::parameter::Parameter;

/// What the parameters do not describe of a soil and its wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Beside {
    /// The law that takes the place of Bekker's.
    pub(super) pressure: Option<Pressure>,
    pub(super) k_shear_1: f64,
    pub(super) k_shear_side: Option<f64>,
    pub(super) k_shear_side_1: f64,
    pub(super) unit_weight: Option<f64>,
    pub(super) rear_driving: f64,
    pub(super) rear_drift: f64,
    pub(super) transport_layer: f64,
    /// `None` for all of it.
    pub(super) sideways_support: Option<f64>,
    pub(super) laws: LawChoice,
    /// The share of the stress at the grousers' tips; `None`: all of it.
    pub(super) tip_share: Option<f64>,
}

/// One number a parameter, NaN where there is none, and what no parameter describes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fixed {
    pub(super) numbers: [f64; Parameter::COUNT],
    pub(super) beside: Beside,
}

impl Default for Fixed {
    fn default() -> Self {
        Self {
            numbers: Parameter::ALL.map(|(.., default)| default.unwrap_or(f64::NAN)),
            beside: Beside::default(),
        }
    }
}

impl Fixed {
    pub(crate) fn get(&self, parameter: Parameter) -> Option<f64> {
        let number = self.numbers[parameter as usize];
        (!number.is_nan()).then_some(number)
    }

    pub(crate) fn set(&mut self, parameter: Parameter, number: f64) {
        self.numbers[parameter as usize] = number;
    }

    /// Is the parameter given, or without meaning for this soil?
    pub(crate) fn has(&self, parameter: Parameter) -> bool {
        self.get(parameter).is_some() || self.is_meaningless(parameter)
    }

    /// Does the soil have another law than the one that this parameter belongs to?
    pub(crate) fn is_meaningless(&self, parameter: Parameter) -> bool {
        self.beside.pressure.is_some() && matches!(parameter, Parameter::KC | Parameter::KPhi)
    }

    /// Does it hold what no parameter describes?
    pub(crate) fn has_more_than_parameters(&self) -> bool {
        self.beside != Beside::default()
    }

    /// The first law of the soil that a kernel does not serve: what it is a law of, and its name.
    pub(crate) fn law_unserved_by(&self, kernel: Kernel) -> Option<(&'static str, &'static str)> {
        let pressure = self
            .beside
            .pressure
            .filter(|law| !law.kernels().contains(&kernel));
        pressure
            .map(|law| ("pressure law", law.key()))
            .or_else(|| self.beside.laws.unserved_by(kernel))
    }

    pub(super) fn laws(&self) -> LawChoice {
        self.beside.laws
    }

    pub(super) fn pressure(&self) -> Option<Pressure> {
        self.beside.pressure
    }

    pub(super) fn unit_weight(&self) -> Option<f64> {
        self.beside.unit_weight
    }

    pub(super) fn rear_driving(&self) -> f64 {
        self.beside.rear_driving
    }

    pub(super) fn transport_layer(&self) -> f64 {
        self.beside.transport_layer
    }

    pub(super) fn tip_share(&self) -> Option<f64> {
        self.beside.tip_share
    }

    /// The same without these parameters.
    pub(crate) fn without(&self, is_replaced: impl Fn(Parameter) -> bool) -> Self {
        let mut rest = *self;
        for (parameter, ..) in Parameter::ALL {
            if is_replaced(parameter) {
                rest.set(parameter, f64::NAN);
            }
        }
        rest
    }

    /// The sizes of a wheel.
    pub(crate) fn set_wheel(&mut self, wheel: &RigidWheel) {
        self.set(Parameter::Radius, wheel.radius());
        self.set(Parameter::Width, wheel.width());
        let grousers = wheel.grousers();
        self.set(
            Parameter::GrouserHeight,
            grousers.map_or(0.0, |grousers| grousers.height),
        );
        let (count, thickness, tip_share) = match grousers.map(|grousers| grousers.rule) {
            Some(GrouserRule::Lugs { count, thickness }) => (count, thickness, None),
            Some(GrouserRule::AreaShare { tips }) => (0.0, 0.0, Some(tips)),
            Some(GrouserRule::Tips) | None => (0.0, 0.0, None),
        };
        self.set(Parameter::GrouserCount, count);
        self.set(Parameter::GrouserThickness, thickness);
        self.beside.tip_share = tip_share;
    }

    /// The numbers and laws of a soil.
    pub(crate) fn set_soil(&mut self, soil: &Soil) {
        let p = soil.params();
        self.beside.pressure = match p.pressure {
            Pressure::Bekker(law) => {
                self.set(Parameter::KC, law.k_c / 1e3);
                self.set(Parameter::KPhi, law.k_phi / 1e3);
                None
            }
            law @ Pressure::Reece(_) => Some(law),
        };
        for (parameter, number) in [
            (Parameter::Exponent, p.n),
            (Parameter::ExponentDriving, p.n_1),
            (Parameter::ExponentBraking, p.n_2),
            (Parameter::Cohesion, p.cohesion / 1e3),
            (Parameter::Phi, p.phi.deg()),
            (Parameter::KShear, p.k_shear),
            (Parameter::C1, p.c_1),
            (Parameter::C2, p.c_2),
            (Parameter::Rebound, p.rebound),
        ] {
            self.set(parameter, number);
        }
        self.beside = Beside {
            k_shear_1: p.k_shear_1,
            k_shear_side: p.k_shear_side,
            k_shear_side_1: p.k_shear_side_1,
            unit_weight: p.unit_weight,
            rear_driving: p.rear_driving,
            rear_drift: p.rear_drift,
            transport_layer: p.transport_layer,
            sideways_support: (p.sideways_support != 1.0).then_some(p.sideways_support),
            laws: p.laws,
            ..self.beside
        };
    }
}
