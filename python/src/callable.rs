//! Functions written in Python as a model of the optimiser.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use grouser::opt::{Differences, Jacobian, Model, Watch};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::error::{Details, input_error};

/// The first exception of a solve. From then on no function is called, and every value is NaN, so that the
/// solver ends.
#[derive(Clone, Debug, Default)]
pub(crate) struct Failure(Arc<(AtomicBool, Mutex<Option<PyErr>>)>);

impl Failure {
    pub(crate) fn is_set(&self) -> bool {
        self.0.0.load(Ordering::Acquire)
    }

    /// What a solver's callback returns: nothing goes on after a failure.
    pub(crate) fn goes_on(&self) -> ControlFlow<()> {
        if self.is_set() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// Ends the calls; the first error is kept.
    pub(crate) fn set(&self, error: Option<PyErr>) {
        let mut kept = self.0.1.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.is_none() {
            *kept = error;
        }
        self.0.0.store(true, Ordering::Release);
    }

    /// The exception, if there was one.
    pub(crate) fn raise(&self) -> PyResult<()> {
        let mut kept = self.0.1.lock().unwrap_or_else(PoisonError::into_inner);
        kept.take().map_or(Ok(()), Err)
    }
}

/// Python functions of a point (and, in robust problems, of a world): all objectives, inequalities and
/// equalities as one array, and optionally all their gradients as one matrix.
#[derive(Debug)]
pub(crate) struct Callable {
    functions: Py<PyAny>,
    gradients: Option<Py<PyAny>>,
    world: Option<usize>,
    bounds: (Vec<f64>, Vec<f64>),
    failure: Failure,
}

impl Callable {
    pub(crate) fn new(
        functions: Py<PyAny>,
        gradients: Option<Py<PyAny>>,
        world: Option<usize>,
        bounds: (Vec<f64>, Vec<f64>),
        failure: Failure,
    ) -> Self {
        Self {
            functions,
            gradients,
            world,
            bounds,
            failure,
        }
    }

    fn call<'py>(
        &self,
        py: Python<'py>,
        function: &Py<PyAny>,
        x: &[f64],
    ) -> PyResult<Bound<'py, PyAny>> {
        py.check_signals()?;
        let x = PyArray1::from_slice(py, x);
        let function = function.bind(py);
        match self.world {
            Some(world) => function.call1((x, world)),
            None => function.call1((x,)),
        }
    }

    /// Runs `call`, unless a call has failed; a failure is kept and leaves NaN.
    fn guarded(
        &self,
        values: &mut [f64],
        call: impl FnOnce(Python<'_>, &mut [f64]) -> PyResult<()>,
    ) {
        let failed = self.failure.is_set() || {
            let result = Python::attach(|py| call(py, values));
            let failed = result.is_err();
            if let Err(error) = result {
                self.failure.set(Some(error));
            }
            failed
        };
        if failed {
            values.fill(f64::NAN);
        }
    }

    fn plain_values(&self, x: &[f64], values: &mut [f64]) {
        self.guarded(values, |py, values| {
            let result = self.call(py, &self.functions, x)?;
            let array: PyReadonlyArray1<'_, f64> = result.extract()?;
            let found = array.as_slice()?;
            if found.len() != values.len() {
                let message = format!(
                    "the functions return {} values, but returned {} at the start",
                    found.len(),
                    values.len()
                );
                return Err(input_error(message, Details::field("objectives")));
            }
            values.copy_from_slice(found);
            Ok(())
        });
    }
}

impl Model for Callable {
    fn values(&self, x: &[f64], values: &mut [f64]) {
        self.plain_values(x, values);
    }

    fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
        self.evaluate(x, values, Some(jacobian), &mut || false);
    }

    fn evaluate(
        &self,
        x: &[f64],
        values: &mut [f64],
        jacobian: Option<&mut Jacobian>,
        watch: &mut dyn Watch,
    ) {
        let Some(gradients) = &self.gradients else {
            let differences = Differences::new(|x: &[f64], f: &mut [f64]| self.plain_values(x, f))
                .within(&self.bounds.0, &self.bounds.1);
            differences.evaluate(x, values, jacobian, watch);
            return;
        };
        self.plain_values(x, values);
        let Some(jacobian) = jacobian else {
            return;
        };
        let mut rows = vec![f64::NAN; jacobian.rows() * jacobian.columns()];
        let (height, width) = (jacobian.rows(), jacobian.columns());
        self.guarded(&mut rows, |py, rows| {
            let result = self.call(py, gradients, x)?;
            let array: PyReadonlyArray2<'_, f64> = result.extract()?;
            let shape = array.as_array().shape().to_vec();
            if shape != [height, width] {
                let message = format!(
                    "the gradients have the shape ({}, {}), but must have ({height}, {width})",
                    shape[0], shape[1]
                );
                return Err(input_error(message, Details::field("gradients")));
            }
            rows.copy_from_slice(&array.to_vec()?);
            Ok(())
        });
        for (k, row) in rows.chunks(width.max(1)).enumerate() {
            jacobian.row_mut(k).copy_from_slice(row);
        }
    }
}
