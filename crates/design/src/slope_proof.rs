//! The proof that no slip holds a slope.

use std::ops::ControlFlow;

use grouser_opt::{Certificate, CertifySettings, Variable};
use grouser_terra::{RigidWheel, Soil};

use crate::builder::State;
use crate::design::Design;
use crate::error::Result;
use crate::solve::Answer;

/// Starts of the local search for the greatest pull.
const STARTS: usize = 8;

/// The proved bound may lie this share of the shortage below it: its sign is what counts.
const GAP_SHARE: f64 = 0.5;

/// What is proved about a slope.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SlopeProof {
    /// No slip from 0 to the greatest holds the slope.
    pub is_proved: bool,
    /// The error of the rule of integration behind it is proved; else it is measured.
    pub is_rule_proved: bool,
    /// The pull that is missing at the best slip that was found, N; negative where that slip holds the slope.
    pub shortage: f64,
    /// The bound behind it: no slip leaves less of a shortage than `lower`, N. `None` where a slip holds the slope.
    pub certificate: Option<Certificate>,
}

/// Proves that a wheel of `weight` (N) holds the slope (degrees) at no slip from 0 to `max_slip`, by interval branch and bound within
/// `time_limit_s`.
///
/// The pull at a slip is W sin α at least where the wheel holds the slope and carries W cos α. With several sinkages that carry the load
/// each counts. The forces come from a fixed rule of integration, and the proof covers every error up to 1e-8 of each force; that
/// there is no larger one is proved too, but with rebound.
///
/// # Errors
/// [`Error::NoCertificate`](crate::Error::NoCertificate) for a law without bounds over a box, as [`Design::certify`].
///
/// ```
/// use grouser_design::prove_no_slip_holds;
/// use grouser_terra::{RigidWheel, catalogue};
///
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let wheel = RigidWheel::new(0.15, 0.12)?;
/// // The steepest slope that this wheel holds up to a slip of 0.9 is 15.0 degrees.
/// let proof = prove_no_slip_holds(&wheel, &soil, 40.0, 16.0, 0.9, 60.0)?;
/// assert!(proof.is_proved && proof.is_rule_proved && proof.shortage > 0.0);
/// let held = prove_no_slip_holds(&wheel, &soil, 40.0, 14.5, 0.9, 60.0)?;
/// assert!(!held.is_proved && held.shortage < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prove_no_slip_holds(
    wheel: &RigidWheel,
    soil: &Soil,
    weight: f64,
    slope_deg: f64,
    max_slip: f64,
    time_limit_s: f64,
) -> Result<SlopeProof> {
    let state = State::under_load(weight).slope_deg(slope_deg);
    let design = Design::builder(wheel, soil, state)
        .variable(Variable::bounded("slip", 0.5 * max_slip, 0.0, max_slip))
        .minimise(
            "shortage",
            "load_n * sin(slope_deg * pi / 180) - drawbar_pull_n",
        )
        .starts(STARTS, 1)
        .build()?;
    let mut proof = SlopeProof {
        is_proved: false,
        is_rule_proved: false,
        shortage: f64::NAN,
        certificate: None,
    };
    if let Answer::Optimum(optimum) = design.solve()?
        && optimum.status.is_solved()
    {
        proof.shortage = optimum.utility;
        if !(proof.shortage > 0.0) {
            return Ok(proof);
        }
    }
    let mut settings = CertifySettings::default();
    if proof.shortage > 0.0 {
        settings.gap = GAP_SHARE * proof.shortage / (1.0 + proof.shortage);
    }
    settings.time_limit_s = Some(time_limit_s);
    let certificate = design.certify(&settings, &mut |_| ControlFlow::Continue(()), None)?;
    proof.is_proved = certificate.lower > 0.0;
    proof.is_rule_proved = design.force_remainder().is_some_and(|r| r.is_proved);
    proof.certificate = Some(certificate);
    Ok(proof)
}
