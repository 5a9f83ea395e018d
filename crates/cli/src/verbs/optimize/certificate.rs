//! `--certify`: the proof beside the answer, with its progress and its log.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;

use grouser_design::{Answer, Design};
use grouser_opt::{Certificate, CertifyProgress, CertifySettings, CertifyStatus};
use grouser_report::number::shown;

use crate::error::{Error, Result};
use crate::output::OutputFile;
use crate::terminal::remark;

/// The first line of progress comes after this time, s; each further one after twice the time.
const FIRST_PROGRESS_S: f64 = 2.0;

#[derive(clap::Args, Debug)]
pub(super) struct Certification {
    /// Prove the best point: stop at a gap of GAP (1 + |f|) between it and the proved bound (exit code 3 if not reached)
    #[arg(long, value_name = "GAP", num_args = 0..=1, default_missing_value = "1e-6")]
    certify: Option<f64>,
    /// Time for the proof, s
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 60.0,
        requires = "certify"
    )]
    certify_time: f64,
    /// Write the proof as JSON lines, which checker/check.py replays
    #[arg(long, value_name = "FILE.jsonl", requires = "certify")]
    proof: Option<PathBuf>,
}

/// A certificate, and the local solver's answer from its best point.
pub(super) struct Certified {
    pub(super) certificate: Certificate,
    pub(super) gap: f64,
    /// A better answer than the search from the starts found.
    pub(super) better: Option<Answer>,
    /// What the rule of integration may leave out, as a share of a force, where wheels carry loads.
    pub(super) remainder: Option<f64>,
    /// The line that names the log.
    written: Option<String>,
}

impl Certification {
    pub(super) fn run(&self, design: &Design, answer: &Answer) -> Result<Option<Certified>> {
        let Some(gap) = self.certify else {
            return Ok(None);
        };
        for (flag, value, low, high, limits) in [
            ("--certify", gap, 1e-12, 1.0, "lie between 1e-12 and 1"),
            (
                "--certify-time",
                self.certify_time,
                0.0,
                1e9,
                "lie between 0 and 1e9 s",
            ),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::out_of_range(flag, value, [low, high], limits));
            }
        }
        let mut settings = CertifySettings::default();
        settings.gap = gap;
        settings.time_limit_s = Some(self.certify_time);
        settings.solve = design.settings.clone();
        settings.starts = settings.starts.max(design.starts);
        settings.seed = design.seed;
        let mut log = self
            .proof
            .as_ref()
            .map(|path| OutputFile::create(path))
            .transpose()?;
        let mut refused = None;
        let mut next = FIRST_PROGRESS_S;
        let mut tell = |progress: &CertifyProgress| {
            if progress.seconds >= next {
                next = 2.0 * progress.seconds;
                remark(&format!(
                    "{:.0} s: bounds {} and {}, gap {}, {} boxes, {} open\n",
                    progress.seconds,
                    shown(progress.lower),
                    shown(progress.upper),
                    shown(progress.upper - progress.lower),
                    progress.boxes,
                    progress.open
                ));
            }
            ControlFlow::Continue(())
        };
        let certificate = {
            let mut write = |line: &str| match &mut log {
                Some(log) => match writeln!(log, "{line}") {
                    Ok(()) => ControlFlow::Continue(()),
                    Err(error) => {
                        refused = Some(error);
                        ControlFlow::Break(())
                    }
                },
                None => ControlFlow::Continue(()),
            };
            let sink: Option<&mut grouser_opt::ProofSink<'_>> = if self.proof.is_some() {
                Some(&mut write)
            } else {
                None
            };
            design.certify(&settings, &mut tell, sink)?
        };
        let mut written = None;
        if let Some(log) = log {
            if let Some(error) = refused {
                return Err(Error::file("write", log.path(), &error));
            }
            written = Some(format!("wrote {}\n", crate::error::shown(log.path())));
            log.finish()?;
        }
        Ok(Some(Certified {
            better: better(design, answer, &certificate, gap)?,
            certificate,
            gap,
            remainder: design.force_remainder(),
            written,
        }))
    }
}

/// The answer from the certificate's best point, where the starts led to a worse one.
fn better(
    design: &Design,
    answer: &Answer,
    certificate: &Certificate,
    gap: f64,
) -> Result<Option<Answer>> {
    let (Answer::Optimum(optimum), Some(x)) = (answer, &certificate.x) else {
        return Ok(None);
    };
    let slack = gap * (1.0 + certificate.upper.abs());
    if optimum.status.is_solved() && optimum.utility <= certificate.upper + slack {
        return Ok(None);
    }
    let mut from = design.clone();
    from.starts = 1;
    for (variable, x) in from.variables.iter_mut().zip(x) {
        variable.start = *x;
    }
    Ok(Some(from.solve()?))
}

impl Certified {
    /// The lines below the answer.
    pub(super) fn text(&self) -> String {
        let c = &self.certificate;
        let mut text = String::from("\n");
        let _ = match c.status {
            CertifyStatus::Infeasible => {
                writeln!(
                    text,
                    "proved: no point of the box meets all constraints ({} boxes)",
                    c.boxes
                )
            }
            CertifyStatus::Proved => writeln!(
                text,
                "proved: no point of the box has a utility below {} ({} boxes)",
                shown(c.lower),
                c.boxes
            ),
            _ => writeln!(
                text,
                "not proved to the gap required: no point of the box has a utility below {} ({} boxes)",
                shown(c.lower),
                c.boxes
            ),
        };
        if c.x.is_some() {
            let _ = writeln!(
                text,
                "best point {}, gap {} of {} allowed; constraints hold to {}",
                shown(c.upper),
                shown(c.gap()),
                shown(self.gap * (1.0 + c.upper.abs())),
                shown(c.violation)
            );
        }
        if let Some(remainder) = self.remainder {
            let _ = writeln!(
                text,
                "forces: a rule of integration that is off by up to {} of each force (measured, not proved)",
                shown(remainder)
            );
        }
        if let Some(written) = &self.written {
            text.push_str(written);
        }
        text
    }

    /// Why the proof does not answer the question.
    pub(super) fn doubt(&self) -> Option<String> {
        let c = &self.certificate;
        let reason = match c.status {
            CertifyStatus::Proved | CertifyStatus::Infeasible => return None,
            CertifyStatus::TimeLimit => "the time is over (`--certify-time`)",
            CertifyStatus::BoxLimit => "too many boxes",
            CertifyStatus::Precision => "some boxes are as small as numbers allow",
            _ => "the search was stopped",
        };
        Some(if c.x.is_some() {
            format!(
                "the gap is {}, not {}: {reason}",
                shown(c.gap()),
                shown(self.gap * (1.0 + c.upper.abs()))
            )
        } else {
            format!("neither a feasible point nor its absence is proved: {reason}")
        })
    }
}
