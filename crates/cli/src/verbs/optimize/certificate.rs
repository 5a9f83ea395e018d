//! `--certify`: the proof beside the answer, with its progress and its log.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::PathBuf;

use grouser_design::{Answer, Design, ForceRemainder, FrontProof, Task};
use grouser_opt::{Certificate, CertifyProgress, CertifySettings, CertifyStatus, WrittenProblem};
use grouser_report::number::{rounded, shown};
use grouser_terra::ModelError;

use crate::error::{Error, Result};
use crate::interrupt::Search;
use crate::model_error;
use crate::output::OutputFile;
use crate::terminal::remark;

/// The first line of progress comes after this time, s; each further one after twice the time.
const FIRST_PROGRESS_S: f64 = 2.0;

/// The gap without a number: of a single optimum, and of a front as a share of its ranges.
const DEFAULT_GAP: f64 = 1e-6;
const DEFAULT_FRONT_SHARE: f64 = 0.05;

#[derive(clap::Args, Debug)]
pub(super) struct Certification {
    /// Prove the best point: stop at a gap of GAP (1 + |f|), 1e-6 by default, between it and the proved bound; of a front,
    /// GAP (0.05) is a share of the range of each objective (exit code 3 if not reached)
    #[arg(long, value_name = "GAP", num_args = 0..=1)]
    #[allow(
        clippy::option_option,
        reason = "the flag may be absent, or without a number"
    )]
    certify: Option<Option<f64>>,
    /// Time for the proof, s
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 60.0,
        requires = "certify"
    )]
    certify_time: f64,
    /// Memory for the parts of the box that are not proved yet, MB
    #[arg(
        long,
        value_name = "MB",
        default_value_t = 1000.0,
        requires = "certify"
    )]
    certify_memory_mb: f64,
    /// Size of the log of the proof, MB
    #[arg(long, value_name = "MB", default_value_t = 1000.0, requires = "proof")]
    proof_size_mb: f64,
    /// Write the proof as JSON lines, which checker/check.py replays
    #[arg(long, value_name = "FILE.jsonl", requires = "certify")]
    proof: Option<PathBuf>,
}

/// What is proved.
pub(super) enum Proof {
    Optimum(Certificate),
    Front(FrontProof),
}

/// A proof, and the local solver's answer from its best point.
pub(super) struct Certified {
    pub(super) proof: Proof,
    pub(super) gap: f64,
    /// A better answer than the search from the starts found.
    pub(super) better: Option<Answer>,
    /// What the rule of integration may leave out, where wheels carry loads.
    pub(super) remainder: Option<ForceRemainder>,
    /// The line that names the log.
    written: Option<String>,
    /// What the laws miss of measured wheels at the best point, where there is a wheel ([`Design::model_error`]).
    model_error: Option<ModelError>,
    /// Is there a wheel on a soil whose laws were not compared with measured wheels?
    is_not_compared: bool,
    /// What a lone maximised objective is called, and its scale: its bounds are then of its own sign.
    maximised: Option<(String, f64)>,
}

impl Certification {
    /// The gap required, if any.
    fn gap(&self, is_front: bool) -> Result<Option<f64>> {
        let Some(gap) = self.certify else {
            return Ok(None);
        };
        let gap = gap.unwrap_or(if is_front {
            DEFAULT_FRONT_SHARE
        } else {
            DEFAULT_GAP
        });
        let (low, limits) = if is_front {
            (1e-3, "lie between 0.001 and 1 for a front")
        } else {
            (1e-12, "lie between 1e-12 and 1")
        };
        if !(low..=1.0).contains(&gap) {
            let range = ([low, 1.0], None);
            return Err(Error::out_of_range("--certify", gap, range, limits));
        }
        let (time, limits) = (self.certify_time, "lie between 0 and 1e9 s");
        if !(0.0..=1e9).contains(&time) {
            let range = ([0.0, 1e9], Some("s"));
            return Err(Error::out_of_range("--certify-time", time, range, limits));
        }
        for (field, size) in [
            ("--certify-memory-mb", self.certify_memory_mb),
            ("--proof-size-mb", self.proof_size_mb),
        ] {
            if !(0.0..=1e9).contains(&size) {
                let range = ([0.0, 1e9], Some("MB"));
                return Err(Error::out_of_range(
                    field,
                    size,
                    range,
                    "lie between 0 and 1e9 MB",
                ));
            }
        }
        Ok(Some(gap))
    }

    pub(super) fn run(
        &self,
        design: &Design,
        text: &str,
        answer: &Answer,
    ) -> Result<Option<Certified>> {
        let Some(gap) = self.gap(matches!(answer, Answer::Trade(_)))? else {
            return Ok(None);
        };
        let mut settings = CertifySettings::default();
        settings.gap = gap;
        settings.time_limit_s = Some(self.certify_time);
        settings.max_open_bytes = bytes(self.certify_memory_mb);
        settings.max_proof_bytes = bytes(self.proof_size_mb);
        settings.written = Some(WrittenProblem {
            text: text.to_owned(),
            sha256: crate::input::digest(text.as_bytes()),
        });
        settings.solve = design.settings.clone();
        settings.starts = settings.starts.max(design.starts);
        settings.seed = design.seed;
        let mut log = self
            .proof
            .as_ref()
            .map(|path| OutputFile::create(path))
            .transpose()?;
        let mut refused = None;
        let search = Search::begin();
        let mut next = FIRST_PROGRESS_S;
        let mut callback = |progress: &CertifyProgress| {
            if progress.seconds >= next {
                next = 2.0 * progress.seconds;
                remark(&progress_line(progress));
            }
            if search.is_interrupted() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let proof = {
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
            match answer {
                Answer::Trade(trade) => {
                    Proof::Front(design.certify_front(trade, &settings, &mut callback, sink)?)
                }
                _ => Proof::Optimum(design.certify(&settings, &mut callback, sink)?),
            }
        };
        drop(search);
        let mut written = None;
        if let Some(log) = log {
            if let Some(error) = refused {
                return Err(Error::file("write", log.path(), &error));
            }
            written = Some(format!("wrote {}\n", crate::error::shown(log.path())));
            log.finish()?;
        }
        let better = match &proof {
            Proof::Optimum(certificate) => better(design, answer, certificate, gap)?,
            Proof::Front(_) => None,
        };
        let best = match (&proof, answer) {
            (Proof::Optimum(certificate), _) => certificate.x.as_deref(),
            (Proof::Front(_), Answer::Trade(trade)) => {
                trade.points.first().map(|point| &point.x[..])
            }
            _ => None,
        };
        let model_error = best.and_then(|x| design.model_error(x));
        let maximised = match design.objectives.as_slice() {
            [one] if one.maximise && design.task == Task::Minimax => {
                Some((one.name.clone(), one.scale))
            }
            _ => None,
        };
        Ok(Some(Certified {
            better,
            proof,
            gap,
            remainder: design.force_remainder(),
            model_error: model_error.flatten(),
            is_not_compared: model_error == Some(None),
            written,
            maximised,
        }))
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "checked to lie between 0 and 1e9 MB"
)]
fn bytes(size_mb: f64) -> u64 {
    (1e6 * size_mb) as u64
}

/// Significant digits of a proved bound.
const PROOF_DIGITS: usize = 6;

fn progress_line(progress: &CertifyProgress) -> String {
    format!(
        "{:.0} s: bounds {} and {}, gap {}, {} boxes, {} open\n",
        progress.seconds,
        shown(progress.lower),
        shown(progress.upper),
        shown(progress.upper - progress.lower),
        progress.boxes,
        progress.open
    )
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
    pub(super) fn status(&self) -> CertifyStatus {
        match &self.proof {
            Proof::Optimum(certificate) => certificate.status,
            Proof::Front(front) => front.status,
        }
    }

    /// Is the answer the optimum by the proof, however the local search ended?
    pub(super) fn proves(&self, design: &Design, answer: &Answer) -> bool {
        let (Proof::Optimum(c), Answer::Optimum(optimum)) = (&self.proof, answer) else {
            return false;
        };
        c.status == CertifyStatus::Proved
            && optimum.kkt.violation <= design.settings.constraint_tolerance
            && optimum.utility <= c.upper + self.gap * (1.0 + c.upper.abs())
    }

    pub(super) fn is_interrupted(&self) -> bool {
        self.status() == CertifyStatus::Stopped
    }

    pub(super) fn certificate(&self) -> Option<&Certificate> {
        match &self.proof {
            Proof::Optimum(certificate) => Some(certificate),
            Proof::Front(_) => None,
        }
    }

    pub(super) fn front(&self) -> Option<&FrontProof> {
        match &self.proof {
            Proof::Optimum(_) => None,
            Proof::Front(front) => Some(front),
        }
    }

    /// The lines below the answer.
    pub(super) fn text(&self, design: &Design) -> String {
        let mut text = String::from("\n");
        match &self.proof {
            Proof::Optimum(certificate) => self.optimum_text(&mut text, certificate),
            Proof::Front(front) => front_text(&mut text, design, front),
        }
        if let Some(remainder) = self.remainder {
            let _ = writeln!(
                text,
                "forces: error of the integrals at most {} of each force ({})",
                shown(remainder.share),
                if remainder.is_proved {
                    "proved"
                } else {
                    "measured, not proved"
                }
            );
        }
        if let Some(error) = self.pull_error() {
            let share = rounded(error, 2);
            let _ = writeln!(
                text,
                "laws: 90 % of measurements lie within ±{share} of the load of a pull that is proved"
            );
        }
        if let Some(written) = &self.written {
            text.push_str(written);
        }
        text
    }

    fn optimum_text(&self, text: &mut String, c: &Certificate) {
        // a maximised objective has its own sign
        let level = |utility: f64| match &self.maximised {
            Some((_, scale)) => rounded(-utility / scale, PROOF_DIGITS),
            None => rounded(utility, PROOF_DIGITS),
        };
        let claim = match &self.maximised {
            Some((name, _)) => format!("has `{name}` above"),
            None => "has a utility below".to_owned(),
        };
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
                "proved: no point of the box {claim} {} ({} boxes)",
                level(c.lower),
                c.boxes
            ),
            _ if !c.lower.is_finite() => {
                writeln!(text, "nothing is proved of the box yet ({} boxes)", c.boxes)
            }
            _ => writeln!(
                text,
                "not proved to the gap required: no point of the box {claim} {} ({} boxes)",
                level(c.lower),
                c.boxes
            ),
        };
        if c.x.is_some() && !c.gap().is_finite() {
            let _ = writeln!(text, "best point {}", level(c.upper));
        } else if c.x.is_some() {
            let _ = writeln!(
                text,
                "best point {}, gap {} of {} allowed; constraints met within {}",
                level(c.upper),
                shown(c.gap()),
                shown(self.gap * (1.0 + c.upper.abs())),
                shown(c.violation)
            );
        }
    }

    /// Half of the interval about a pull that holds 90 % of measurements, over the load.
    pub(super) fn pull_error(&self) -> Option<f64> {
        Some(self.model_error?.pull_per_load)
    }

    /// What the proof does not say, though it answers the question.
    pub(super) fn caution(&self) -> Option<String> {
        (self.is_not_compared).then(|| model_error::UNKNOWN.to_owned())
    }

    /// Why the proof does not answer the question.
    pub(super) fn doubt(&self) -> Option<String> {
        let reason = match self.status() {
            CertifyStatus::Proved | CertifyStatus::Infeasible => return None,
            CertifyStatus::TimeLimit => "the time is over (`--certify-time`)",
            CertifyStatus::BoxLimit => "too many boxes",
            CertifyStatus::MemoryLimit => "the memory is used (`--certify-memory-mb`)",
            CertifyStatus::ProofLimit => "the log is full (`--proof-size-mb`)",
            CertifyStatus::Precision => "some boxes are as small as numbers allow",
            _ => "interrupted",
        };
        Some(match &self.proof {
            Proof::Front(front) if front.share.is_finite() => format!(
                "the front is proved to {} of its ranges, not {}: {reason}",
                shown(front.share),
                shown(self.gap)
            ),
            Proof::Optimum(c) if c.x.is_some() && c.gap().is_finite() => format!(
                "the gap is {}, not {}: {reason}",
                shown(c.gap()),
                shown(self.gap * (1.0 + c.upper.abs()))
            ),
            Proof::Optimum(c) if c.x.is_some() => {
                format!("nothing is proved of the best point: {reason}")
            }
            _ => format!("neither a feasible point nor its absence is proved: {reason}"),
        })
    }
}

fn front_text(text: &mut String, design: &Design, front: &FrontProof) {
    if front.status == CertifyStatus::Infeasible {
        let _ = writeln!(
            text,
            "proved: no point of the box meets all constraints ({} boxes)",
            front.boxes
        );
        return;
    }
    let word = if front.status.is_proved() {
        "proved"
    } else {
        "not proved to the share required"
    };
    let by: Vec<String> = design
        .objectives
        .iter()
        .zip(&front.tolerance)
        .map(|(objective, by)| format!("{} in `{}`", shown(*by), objective.name))
        .collect();
    let _ = writeln!(
        text,
        "{word}: for any point of the box, one of {} listed points is at most {} worse ({} of the ranges; {} proofs, {} boxes)",
        front.points.len(),
        by.join(" and "),
        shown(front.share),
        front.proofs,
        front.boxes
    );
}
