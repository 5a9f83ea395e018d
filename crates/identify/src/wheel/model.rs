//! Residuals of wheel tests with exact derivatives in the parameters.

use grouser_opt::{Jacobian, Model};
use grouser_real::Dual;
use grouser_terra::{DualInputs, DualSolution, OpenSoil, RigidWheel, Settings, WheelOnSoil};

use super::test::{Quantity, Scatter, Support, WheelTest};
use crate::error::{Error, Result};
use crate::parameter::Parameter;

/// How close to the hub a wheel is taken to sit whose load nothing below the hub carries, as a share of r.
const HUB_SINKAGE_PER_RADIUS: f64 = 1.0 - 1e-6;

/// What does not change in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// The wheel.
    pub wheel: RigidWheel,
    /// The soil, whose other numbers are fixed; what is fitted may be open.
    pub soil: OpenSoil,
    /// What residuals are divided by.
    pub scatter: Scatter,
}

/// The residuals (model − measured)/scatter of wheel tests, in the order of the tests and within each of
/// [`Quantity::ALL`], as functions of the chosen parameters (SI).
#[derive(Clone, Debug)]
pub struct WheelModel<'a> {
    fixed: Fixed,
    tests: &'a [WheelTest],
    parameters: &'a [Parameter],
}

/// The model's prediction of a test, SI, as it would be read: datum offsets included.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Prediction {
    /// Drawbar pull, N.
    pub pull: f64,
    /// Side force, N, to the left.
    pub side: f64,
    /// Torque, N m.
    pub torque: f64,
    /// Sinkage, m.
    pub sinkage: f64,
    /// Does nothing below the hub carry the load? The numbers are then those with the hub at the ground.
    pub hub_buried: bool,
}

impl Prediction {
    /// Its `quantity`.
    #[must_use]
    pub const fn of(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Pull => self.pull,
            Quantity::Side => self.side,
            Quantity::Torque => self.torque,
            Quantity::Sinkage => self.sinkage,
        }
    }
}

/// Parameters of one run: each other number of them would be the whole stress model once more in the program.
const DIRECTIONS: usize = 9;

impl<'a> WheelModel<'a> {
    /// Of `tests`, as functions of `parameters`.
    #[must_use]
    pub const fn new(fixed: Fixed, tests: &'a [WheelTest], parameters: &'a [Parameter]) -> Self {
        Self {
            fixed,
            tests,
            parameters,
        }
    }

    /// How many residuals there are.
    #[must_use]
    pub fn count(&self) -> usize {
        let read = |test: &WheelTest| {
            let all = Quantity::ALL.into_iter();
            all.filter(|q| test.read(*q).is_some()).count()
        };
        self.tests.iter().map(read).sum()
    }

    /// The residuals of each quantity in the order of the tests, out of a list of all.
    pub(crate) fn series(&self, residuals: &[f64]) -> Vec<Vec<f64>> {
        let mut series = vec![Vec::new(); Quantity::ALL.len()];
        let mut rest = residuals.iter();
        for test in self.tests {
            for (quantity, own) in Quantity::ALL.into_iter().zip(&mut series) {
                if test.read(quantity).is_some() {
                    own.extend(rest.next());
                }
            }
        }
        series
    }

    /// The soil at the parameters `x`.
    #[must_use]
    pub fn soil_at(&self, x: &[f64]) -> OpenSoil {
        let mut soil = self.fixed.soil;
        for (parameter, value) in self.parameters.iter().zip(x) {
            parameter.put(&mut soil, *value);
        }
        soil
    }

    fn contact_at(&self, x: &[f64]) -> Option<WheelOnSoil> {
        let soil = self.soil_at(x).soil().ok()?;
        WheelOnSoil::new(self.fixed.wheel, soil, Settings::default()).ok()
    }

    /// Each row with its gradient in N parameters, those from `first` on.
    fn run<const N: usize>(
        &self,
        x: &[f64],
        first: usize,
        mut row_of: impl FnMut(Option<Dual<N>>),
    ) {
        let contact = self.contact_at(x);
        let number = |value: f64, index: usize| match index.checked_sub(first) {
            // beyond N a variable is a constant
            Some(direction) => Dual::<N>::variable(value, direction),
            None => Dual::constant(value),
        };
        let mut offsets = [Dual::<N>::constant(0.0); 3];
        for (index, (parameter, value)) in self.parameters.iter().zip(x).enumerate() {
            if let Some(slot) = nuisance(*parameter) {
                offsets[slot] = number(*value, index);
            }
        }
        for test in self.tests {
            let solved = contact.as_ref().and_then(|contact| {
                let mut inputs = DualInputs::<N>::new(contact, &test.kinematics);
                for (index, (parameter, value)) in self.parameters.iter().zip(x).enumerate() {
                    let side = self.fixed.soil.k_shear_side;
                    parameter.put_dual(&mut inputs.soil, side, number(*value, index));
                }
                solve(&inputs, contact, test)
            });
            for quantity in Quantity::ALL {
                let Some(measured) = test.read(quantity) else {
                    continue;
                };
                let scatter = Dual::constant(self.fixed.scatter.of(quantity));
                row_of(solved.as_ref().map(|(solved, _)| {
                    (read(solved, quantity, &offsets) - Dual::constant(measured)) / scatter
                }));
            }
        }
    }
}

/// The place of a nuisance in the list of offsets.
const fn nuisance(parameter: Parameter) -> Option<usize> {
    match parameter {
        Parameter::SinkageDatum => Some(0),
        Parameter::SideDatum => Some(1),
        Parameter::PullDatum => Some(2),
        _ => None,
    }
}

fn read<const N: usize>(
    solved: &DualSolution<N>,
    quantity: Quantity,
    offsets: &[Dual<N>; 3],
) -> Dual<N> {
    match quantity {
        Quantity::Pull => solved.forces.drawbar_pull + offsets[2],
        Quantity::Side => solved.side_force + offsets[1],
        Quantity::Torque => solved.forces.torque,
        Quantity::Sinkage => solved.sinkage + offsets[0],
    }
}

/// Under the test's load, or at the hub where nothing below carries it; and whether that is so.
fn solve<const N: usize>(
    inputs: &DualInputs<N>,
    contact: &WheelOnSoil,
    test: &WheelTest,
) -> Option<(DualSolution<N>, bool)> {
    let radius = contact.wheel().running_radius();
    let at = |sinkage: f64| {
        let sinkage = Dual::constant(sinkage.clamp(0.0, HUB_SINKAGE_PER_RADIUS * radius));
        let theta_1 = inputs.soil.entry_at(sinkage, &inputs.motion, &inputs.size);
        inputs.at_entry_angle(theta_1)
    };
    match test.support {
        Support::Sinkage(sinkage) => Some((at(sinkage), sinkage >= radius)),
        Support::Load(load) => {
            match inputs.under_load(contact, &test.kinematics, Dual::constant(load)) {
                Ok(Some(solved)) => Some((solved, false)),
                Ok(None) => Some((at(radius), true)),
                Err(_) => None,
            }
        }
    }
}

impl Model for WheelModel<'_> {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        let mut slots = values.iter_mut();
        self.run::<0>(x, 0, |row| {
            if let Some(slot) = slots.next() {
                *slot = row.map_or(f64::NAN, |dual| dual.value);
            }
        });
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        for first in (0..x.len().max(1)).step_by(DIRECTIONS) {
            let mut index = 0;
            self.run::<DIRECTIONS>(x, first, |row| {
                let row = row.unwrap_or(Dual {
                    value: f64::NAN,
                    gradient: [f64::NAN; DIRECTIONS],
                });
                values[index] = row.value;
                let slots = jacobian.row_mut(index).iter_mut().skip(first);
                for (slot, slope) in slots.zip(row.gradient) {
                    *slot = slope;
                }
                index += 1;
            });
        }
    }
}

/// The model's prediction of each test, with the offsets that `parameters` name at the values `x`.
///
/// # Errors
/// [`Error::Law`] for a soil that the laws refuse.
pub fn predict(
    fixed: &Fixed,
    tests: &[WheelTest],
    parameters: &[Parameter],
    x: &[f64],
) -> Result<Vec<Prediction>> {
    let law = |source| Error::Law {
        what: "predicting wheel tests".to_owned(),
        source,
    };
    let model = WheelModel::new(*fixed, tests, parameters);
    let soil = model.soil_at(x).soil().map_err(law)?;
    let contact = WheelOnSoil::new(fixed.wheel, soil, Settings::default()).map_err(law)?;
    let offset = |slot| {
        let mut named = parameters.iter().zip(x);
        named
            .find(|(parameter, _)| nuisance(**parameter) == Some(slot))
            .map_or(0.0, |(_, value)| *value)
    };
    let offsets = [offset(0), offset(1), offset(2)].map(Dual::constant);
    tests
        .iter()
        .map(|test| {
            let inputs = DualInputs::<0>::new(&contact, &test.kinematics);
            let Some((solved, hub_buried)) = solve(&inputs, &contact, test) else {
                // the solver names what is wrong with this motion or this load
                let load = match test.support {
                    Support::Load(load) => load,
                    Support::Sinkage(_) => 1.0,
                };
                let refused = contact.sinkage_under(load, &test.kinematics);
                return Err(law(refused.err().unwrap_or(
                    grouser_terra::Error::NotFinite {
                        field: "sinkage",
                        value: f64::NAN,
                        unit: "m",
                    },
                )));
            };
            let of = |quantity| read(&solved, quantity, &offsets).value;
            Ok(Prediction {
                pull: of(Quantity::Pull),
                side: of(Quantity::Side),
                torque: of(Quantity::Torque),
                sinkage: of(Quantity::Sinkage),
                hub_buried,
            })
        })
        .collect()
}
