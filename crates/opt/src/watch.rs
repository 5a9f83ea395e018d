//! Who follows an evaluation of a model, and may end it.

/// Who follows an evaluation of a model.
#[doc(hidden)]
pub trait Watch {
    /// Called where an evaluation takes long; `true` ends it, and what it writes is worthless.
    fn stop(&mut self) -> bool;

    /// The values of all functions at another point, which the derivatives needed.
    fn seen(&mut self, _x: &[f64], _functions: &[f64]) {}
}

impl<F: FnMut() -> bool> Watch for F {
    fn stop(&mut self) -> bool {
        self()
    }
}
