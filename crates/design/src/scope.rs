//! What names mean inside the formulas of one problem.

use std::collections::BTreeMap;

use grouser_opt::{Node, Tape, Variable};
use grouser_real::Scalar;

use crate::formula::{Formula, Names};
use crate::quantity::{
    ContactShape, Evaluation, Fixed, Inputs, NoValue, Parameter, Quantity, Taped,
};

/// Variables first, then all parameters, then all quantities: the numbers that formulas are compiled to.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    variables: Vec<String>,
    /// The variable that replaces a parameter.
    replaced: [Option<usize>; Parameter::COUNT],
}

/// A loaded wheel on a tape.
pub(crate) struct Carried {
    /// What must be 0 for the load to be carried.
    pub(crate) balance: Node,
    /// The load at right angles to the ground, N.
    pub(crate) load: Node,
    /// What the error of the rule of integration depends on; `None` with rebound.
    pub(crate) shape: Option<ContactShape<Node>>,
}

impl Scope {
    pub(crate) fn new(variables: Vec<String>) -> Self {
        let mut replaced = [None; Parameter::COUNT];
        for (index, name) in variables.iter().enumerate() {
            if let Some(parameter) = Parameter::named(name) {
                replaced[parameter as usize] = Some(index);
            }
        }
        Self {
            variables,
            replaced,
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.variables.len()
    }

    pub(crate) fn is_replaced(&self, parameter: Parameter) -> bool {
        self.replaced[parameter as usize].is_some()
    }

    /// The parameters and quantities that a formula uses by name.
    pub(crate) fn used(&self, formula: &Formula) -> (Vec<Parameter>, Vec<Quantity>) {
        let mut used = (Vec::new(), Vec::new());
        for index in formula.variables() {
            let Some(past) = index.checked_sub(self.count()) else {
                continue;
            };
            if let Some((parameter, ..)) = Parameter::ALL.get(past) {
                used.0.push(*parameter);
            } else if let Some(quantity) = Quantity::at(past - Parameter::COUNT) {
                used.1.push(quantity);
            }
        }
        used
    }

    /// The parameters at `x`: the fixed ones, with variables in their places.
    pub(crate) fn inputs<R: Scalar>(&self, x: &[R], fixed: &Fixed) -> Inputs<R> {
        let mut inputs = Inputs::new(fixed);
        for (value, variable) in inputs.values.iter_mut().zip(self.replaced) {
            if let Some(index) = variable {
                *value = x[index];
            }
        }
        inputs
    }

    /// The numbers that formulas are evaluated on. A quantity without a value is NaN.
    pub(crate) fn numbers<R: Scalar>(
        &self,
        x: &[R],
        fixed: &Fixed,
        quantities: &[Quantity],
    ) -> Vec<R> {
        let inputs = self.inputs(x, fixed);
        let mut numbers = x.to_vec();
        numbers.extend(inputs.values);
        numbers.resize(
            self.count() + Parameter::COUNT + Quantity::COUNT,
            R::from_f64(f64::NAN),
        );
        let mut evaluation = Evaluation::new(&inputs);
        for &quantity in quantities {
            if let Ok(value) = evaluation.quantity(quantity) {
                numbers[self.count() + Parameter::COUNT + quantity as usize] = value;
            }
        }
        numbers
    }

    /// The place of a quantity among the numbers.
    pub(crate) fn place(&self, quantity: Quantity) -> usize {
        self.count() + Parameter::COUNT + quantity as usize
    }

    /// The nodes of the same numbers on a tape; `None` for what is not given or is no formula. With `contact`, the
    /// first of the variables that a wheel under a load adds, forces have nodes too, and the second result is what
    /// must be 0 for the load to be carried, with what the error of the rule of integration depends on.
    pub(crate) fn taped(
        &self,
        tape: &mut Tape,
        fixed: &Fixed,
        quantities: &[Quantity],
        contact: Option<usize>,
    ) -> (Vec<Option<Node>>, Option<Carried>) {
        let count = self.count();
        let fixed = &fixed.without(|parameter| self.is_replaced(parameter));
        let mut numbers: Vec<Option<Node>> = (0..count).map(|i| Some(tape.variable(i))).collect();
        let parameters =
            Parameter::ALL.map(|(parameter, ..)| match self.replaced[parameter as usize] {
                Some(index) => Some(tape.variable(index)),
                None => fixed.get(parameter).map(|value| tape.constant(value)),
            });
        numbers.extend(parameters);
        numbers.resize(count + Parameter::COUNT + Quantity::COUNT, None);
        let mut taped = Taped {
            tape,
            fixed,
            parameters,
            contact: None,
        };
        taped.contact = contact.and_then(|first| taped.contact(first));
        for &quantity in quantities {
            numbers[self.place(quantity)] = taped.quantity(quantity);
        }
        let carried = taped.contact.map(|contact| Carried {
            balance: taped.balance(&contact),
            load: contact.load,
            shape: contact.shape,
        });
        (numbers, carried)
    }

    /// Whether the load is given, so that the sinkage solves an equation.
    pub(crate) fn is_loaded(&self, fixed: &Fixed) -> bool {
        fixed.get(Parameter::Load).is_some() || self.is_replaced(Parameter::Load)
    }

    /// The least value that a variable or the state allows; `None` where there is none.
    pub(crate) fn min_value(
        &self,
        parameter: Parameter,
        fixed: &Fixed,
        variables: &[Variable],
    ) -> Option<f64> {
        match self.replaced[parameter as usize] {
            Some(index) => Some(variables[index].lower),
            None => fixed.get(parameter),
        }
    }

    /// Why a quantity has no value at `x`; the first that has none.
    pub(crate) fn no_value(
        &self,
        x: &[f64],
        fixed: &Fixed,
        quantities: &[Quantity],
    ) -> Option<(&'static str, NoValue)> {
        let inputs = self.inputs(x, fixed);
        let mut evaluation = Evaluation::new(&inputs);
        quantities.iter().find_map(|&quantity| {
            let reason = evaluation.quantity(quantity).err()?;
            Some((quantity.name(), reason))
        })
    }
}

impl Names for Scope {
    fn variable(&self, name: &str) -> Option<usize> {
        let variable = self.variables.iter().position(|known| known == name);
        variable.or_else(|| {
            // `sinkage_m` is both: given in the state it is a number, else it is solved for.
            let quantity = Quantity::named(name).map(|q| Parameter::COUNT + q as usize);
            let parameter = Parameter::named(name)
                .filter(|p| *p != Parameter::Sinkage)
                .map(|p| p as usize);
            parameter.or(quantity).map(|past| self.count() + past)
        })
    }

    fn meant(&self, name: &str) -> Option<String> {
        let mut known: Vec<&str> = Vec::new();
        for variable in &self.variables {
            known.push(variable);
        }
        for (_, name, ..) in &Parameter::ALL {
            known.push(name);
        }
        for name in Quantity::names() {
            known.push(name);
        }
        grouser_files::nearest(name, known).map(str::to_owned)
    }
}

/// Which of these parameters has no value, neither fixed nor by a variable.
pub(crate) fn first_missing(
    scope: &Scope,
    fixed: &Fixed,
    wanted: &[Parameter],
) -> Option<Parameter> {
    wanted
        .iter()
        .copied()
        .find(|p| !fixed.has(*p) && !scope.is_replaced(*p))
}

/// The parameters as a map by name, for reports.
pub(crate) fn by_name(fixed: &Fixed) -> BTreeMap<&'static str, f64> {
    Parameter::ALL
        .iter()
        .filter_map(|(parameter, name, ..)| Some((*name, fixed.get(*parameter)?)))
        .collect()
}
