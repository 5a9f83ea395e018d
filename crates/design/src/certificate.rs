//! The proof that a design's best point is the best.

use std::ops::ControlFlow;

use grouser_opt::{
    Certificate, CertifyError, CertifyProgress, CertifySettings, ProofSink, Tape, certify_with,
};

use crate::design::{Design, Task};
use crate::error::{Error, Result};
use crate::quantity::Quantity;

impl Design {
    /// The first quantity that has no bounds over a box.
    fn unbounded_quantity(&self) -> Option<Quantity> {
        let program = &self.program;
        let fixed = &self.worlds[0].fixed;
        let numbers = program
            .scope
            .taped(&mut Tape::new(), fixed, &program.quantities);
        let mut used = program.quantities.iter().copied();
        used.find(|q| numbers[program.scope.place(*q)].is_none())
    }

    /// Proves how good the best point over the whole box is: see [`grouser_opt::certify`]. `callback` is called after
    /// every batch of boxes and may stop the search; `proof` takes the lines of the proof.
    ///
    /// # Errors
    /// [`Error::NoCertificate`] for a front, for a quantity that is no formula of the parameters, and for a measure
    /// with helper variables; [`Error::Problem`] for an open box and for settings out of their range.
    ///
    /// ```
    /// use grouser_files::Document;
    /// use grouser_opt::CertifySettings;
    /// use std::ops::ControlFlow;
    ///
    /// let text = r#"
    /// format = 1
    /// method = "minimax"
    /// [variables]
    /// x = { start = 2.0, lower = -4.0, upper = 4.0 }
    /// [objectives]
    /// f = "sin(3*x) + 0.1*x^2"
    /// "#;
    /// let design = grouser_design::parse(&Document::from_text("waves.toml", text.into())?)?;
    /// let certificate =
    ///     design.certify(&CertifySettings::default(), &mut |_| ControlFlow::Continue(()), None)?;
    /// assert!(certificate.status.is_proved());
    /// assert!((certificate.upper + 0.973_284).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn certify(
        &self,
        settings: &CertifySettings,
        callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
        proof: Option<&mut ProofSink<'_>>,
    ) -> Result<Certificate> {
        let refuse = |reason: String| Error::NoCertificate {
            file: self.file.clone(),
            reason,
        };
        if self.task == Task::Pareto {
            return Err(refuse("a front has no single optimum".to_owned()));
        }
        if let Some(quantity) = self.unbounded_quantity() {
            return Err(refuse(format!(
                "`{}` has no bounds over a box; a certificate needs formulas of the variables and of quantities with a \
                 given sinkage",
                quantity.name()
            )));
        }
        let problem = self.problem()?;
        let inner = problem.problem();
        if inner.variables().len() > self.variables.len() {
            return Err(refuse(
                "this measure over several soils has helper variables; only \"worst_case\" has a certificate".to_owned(),
            ));
        }
        certify_with(inner, &self.method(&problem), settings, callback, proof).map_err(|error| {
            match error {
                CertifyError::Problem(source) => Error::Problem {
                    file: self.file.clone(),
                    source,
                },
                other => refuse(other.to_string()),
            }
        })
    }
}
