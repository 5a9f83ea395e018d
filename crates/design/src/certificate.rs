//! The proof that a design's best point is the best.
//!
//! A wheel under a load adds variables: its entry angle, which must carry the load, and the remainder of each integral.
//! The problem is then one of formulas, with the same bounds, multipliers and proof logs as any other. The entry angle
//! is examined from 0.001 rad to a right angle.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use grouser_opt::{
    Certificate, CertifyError, CertifyProgress, CertifySettings, Measure, Node, Problem, Progress,
    ProofSink, Tape, TapedFunctions, Variable, certify_with,
};
use grouser_terra::Kernel;

use crate::design::{Design, Task};
use crate::error::{Error, Result};
use crate::quantity::{
    CONTACT_VARIABLES, Evaluation, Parameter, QUADRATURE_REMAINDER_SHARE, Quantity,
};
use crate::solve::Answer;

/// The greatest entry angle, rad: the hub is at the surface.
pub(crate) const MAX_ENTRY_RAD: f64 = std::f64::consts::FRAC_PI_2;
/// The least entry angle that is examined, rad: the sinkage is 5e-7 of the radius there.
pub(crate) const MIN_ENTRY_RAD: f64 = 1e-3;

/// The kernel's solves before a proof end after this share of its time.
const SOLVES_TIME_SHARE: f64 = 0.5;

/// When the kernel's solves end, where the time is limited.
pub(crate) fn end_of(began: Instant, settings: &CertifySettings) -> Option<Instant> {
    let share = SOLVES_TIME_SHARE * settings.time_limit_s?;
    began.checked_add(Duration::try_from_secs_f64(share).ok()?)
}

/// What a solve calls that ends at a time.
pub(crate) fn goes_on(until: Option<Instant>) -> impl FnMut(&Progress<'_>) -> ControlFlow<()> {
    move |_| {
        if until.is_some_and(|until| Instant::now() >= until) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

impl Design {
    /// Why there are no bounds over a box: the first quantity without them, in the first world that has such a one.
    fn without_bounds(&self) -> Option<String> {
        let program = &self.program;
        let scope = &program.scope;
        self.worlds.iter().find_map(|world| {
            let first = scope.is_loaded(&world.fixed).then_some(self.variables.len());
            let (numbers, balance) =
                scope.taped(&mut Tape::new(), &world.fixed, &program.quantities, first);
            let mut used = program.quantities.iter().copied();
            let missing = used.find(|q| numbers[scope.place(*q)].is_none());
            let min = |p| scope.min_value(p, &world.fixed, &self.variables);
            let Some(missing) = missing else {
                if balance.is_some() && min(Parameter::Slip).is_some_and(|slip| !(slip >= 0.0)) {
                    return Some("forces have bounds for slips of 0 and above only".to_owned());
                }
                let is_counted = scope.is_replaced(Parameter::GrouserCount)
                    && !program.quantities.is_empty();
                return (is_counted && !min(Parameter::GrouserCount).is_some_and(|n| n > 0.0)).then(|| {
                    "`grouser_count` must be above 0 in the whole box: the radius is another one without lugs".to_owned()
                });
            };
            let name = missing.name();
            let instead = match missing {
                Quantity::SlipDemand | Quantity::MaxGradeability => Some("drawbar_pull_n >= load_n * sin(slope_deg * pi / 180)"),
                Quantity::MaxPull => Some("drawbar_pull_n"),
                Quantity::MaxEfficiency => Some("tractive_efficiency"),
                _ => None,
            };
            Some(match (instead, world.fixed.law_unserved_by(Kernel::Tape)) {
                (Some(formula), _) => format!(
                    "`{name}` is a search over slip and has no bounds over a box; with `slip` as a variable, write `{formula}`"
                ),
                (None, Some((of, law))) if first.is_some() => {
                    format!("`{name}` has no bounds over a box with the {of} `{law}`")
                }
                (None, _) if first.is_none() && missing.is_of_forces() => {
                    format!("`{name}` has bounds over a box under a given load, not at a given sinkage")
                }
                _ => format!("`{name}` has no bounds over a box"),
            })
        })
    }

    /// The problem with the entry angle of each loaded wheel as a variable, which must carry the load.
    pub(crate) fn lifted(&self) -> Result<Option<Problem<'static>>> {
        let program = &self.program;
        let n = self.variables.len();
        if !self.has_loaded_wheels() {
            return Ok(None);
        }
        let mut params = self.params();
        let mut tape = Tape::new();
        let mut rows: Vec<Vec<Node>> = Vec::new();
        let mut balances = Vec::new();
        for (index, world) in self.worlds.iter().enumerate() {
            let first = n + index * CONTACT_VARIABLES;
            let (numbers, balance) =
                program
                    .scope
                    .taped(&mut tape, &world.fixed, &program.quantities, Some(first));
            let (Some(nodes), Some(balance)) = (program.rows_on(&mut tape, &numbers), balance)
            else {
                return Ok(None);
            };
            rows.push(nodes);
            balances.push(balance.balance);
            let entry = 0.25 * (MIN_ENTRY_RAD + MAX_ENTRY_RAD);
            let name = |what: &str| format!("{what} {index}");
            params.variables.push(Variable::bounded(
                name("entry angle"),
                entry,
                MIN_ENTRY_RAD,
                MAX_ENTRY_RAD,
            ));
            for integral in 1..CONTACT_VARIABLES {
                let name = name(&format!("remainder {integral} of contact"));
                params.variables.push(Variable::bounded(
                    name,
                    0.0,
                    -QUADRATURE_REMAINDER_SHARE,
                    QUADRATURE_REMAINDER_SHARE,
                ));
            }
        }
        let count = self.worlds.len();
        let mut functions: Vec<Node> = (0..program.rows.len())
            .flat_map(|f| rows.iter().map(move |world| world[f]))
            .collect();
        functions.extend(balances);
        let by_world = |names: Vec<String>| -> Vec<String> {
            let worlds = || (0..count).map(|w| format!(" @ {w}"));
            names
                .iter()
                .flat_map(|name| worlds().map(move |w| format!("{name}{w}")))
                .collect()
        };
        params.objectives = by_world(params.objectives);
        params.inequalities = by_world(params.inequalities);
        params.equalities = by_world(params.equalities);
        params
            .equalities
            .extend((0..count).map(|w| format!("load is carried @ {w}")));
        params.absolute *= count;
        params.worlds = count;
        for row in &mut params.linear {
            row.coefficients.resize(n + count * CONTACT_VARIABLES, 0.0);
        }
        params.model = Box::new(TapedFunctions { tape, functions });
        let problem = Problem::new(params).map_err(|source| Error::Problem {
            file: self.file.clone(),
            source,
        })?;
        Ok(Some(problem))
    }

    /// The ends of the kernel's solves as points of the lifted problem.
    fn candidates(&self, until: Option<Instant>) -> Result<Vec<Vec<f64>>> {
        let Answer::Optimum(optimum) = self.solve_with(&mut goes_on(until))? else {
            return Ok(Vec::new());
        };
        Ok(optimum
            .starts
            .iter()
            .filter_map(|start| self.with_entry_angles(&start.x))
            .collect())
    }

    /// A point of the design as one of the lifted problem; `None` where a wheel is not carried.
    pub(crate) fn with_entry_angles(&self, x: &[f64]) -> Option<Vec<f64>> {
        let mut point = x.to_vec();
        for world in &self.worlds {
            let inputs = self.program.scope.inputs(x, &world.fixed);
            let entry = Evaluation::new(&inputs).quantity(Quantity::Theta1).ok()?;
            point.push(entry.to_radians());
            point.extend([0.0; CONTACT_VARIABLES - 1]);
        }
        Some(point)
    }

    pub(crate) fn has_loaded_wheels(&self) -> bool {
        !self.program.quantities.is_empty() && self.program.scope.is_loaded(&self.worlds[0].fixed)
    }

    /// Proves how good the best point over the whole box is: see [`grouser_opt::certify`]. `callback` is called after
    /// every batch of boxes and may stop the search; `proof` takes the lines of the proof.
    ///
    /// # Errors
    /// [`Error::NoCertificate`] for a front, for a quantity or a law without bounds over a box (slips below 0, searches
    /// over slip), and for a measure other than `worst_case`; [`Error::Problem`] for an open box and for settings out of their range.
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
    /// assert!((certificate.upper + 0.973_180).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn certify(
        &self,
        settings: &CertifySettings,
        callback: &mut dyn FnMut(&CertifyProgress) -> ControlFlow<()>,
        proof: Option<&mut ProofSink<'_>>,
    ) -> Result<Certificate> {
        if self.task == Task::Pareto {
            return Err(self.uncertified("a front has no single optimum".to_owned()));
        }
        let began = Instant::now();
        self.check_bounds()?;
        let lifted = self.lifted()?;
        let problem = self.problem()?;
        let certified = lifted.as_ref().unwrap_or(&problem);
        let mut settings = settings.clone();
        if lifted.is_some() {
            // the kernel searches faster than the lifted problem can
            settings.starts = 0;
            settings.candidates = self.candidates(end_of(began, &settings))?;
        }
        let before = began.elapsed().as_secs_f64();
        settings.time_limit_s = settings.time_limit_s.map(|limit| (limit - before).max(0.0));
        let mut certificate = certify_with(
            certified,
            &self.method(certified),
            &settings,
            callback,
            proof,
        )
        .map_err(|error| self.certify_error(error))?;
        certificate.seconds += before;
        if let (Some(x), true) = (&mut certificate.x, lifted.is_some()) {
            // the level at the point is that of the kernel, not of the rule with its remainders
            x.truncate(self.variables.len());
            certificate.upper = certificate.upper.max(self.merit(x)?.utility);
        }
        Ok(certificate)
    }

    /// Refuses what has no bounds over a box.
    pub(crate) fn check_bounds(&self) -> Result<()> {
        if let Some(reason) = self.without_bounds() {
            return Err(self.uncertified(reason));
        }
        if self.worlds.len() > 1 && self.measure != Measure::WorstCase {
            return Err(self.uncertified(
                "only the measure \"worst_case\" over several soils has a certificate".to_owned(),
            ));
        }
        Ok(())
    }

    pub(crate) fn certify_error(&self, error: CertifyError) -> Error {
        match error {
            CertifyError::Problem(source) => Error::Problem {
                file: self.file.clone(),
                source,
            },
            other => self.uncertified(other.to_string()),
        }
    }
}
