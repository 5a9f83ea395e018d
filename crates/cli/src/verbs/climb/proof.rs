//! `--certify`: the proof that no slip holds a slope a little steeper than the steepest one that was found.

use grouser_design::{SlopeProof, prove_no_slip_holds};
use grouser_report::number::{rounded, shown};
use grouser_report::{Fields, fields};
use grouser_terra::WheelOnSoil;

use crate::error::{Error, Result};

/// Time for the proof, s.
const TIME_LIMIT_S: f64 = 60.0;

/// Minimum and maximum of the margin, degrees.
const MARGIN_LIMITS_DEG: [f64; 2] = [0.001, 30.0];

/// A slope and what is proved about it.
pub(super) struct Proved {
    slope_deg: f64,
    max_slip: f64,
    proof: SlopeProof,
}

impl Proved {
    /// About the slope that lies `margin` degrees above the steepest one (rad); the level where not even that is climbed.
    pub(super) fn new(
        pair: &WheelOnSoil,
        weight: f64,
        steepest: Option<f64>,
        margin_deg: f64,
    ) -> Result<Self> {
        let [low, high] = MARGIN_LIMITS_DEG;
        if !(low..=high).contains(&margin_deg) {
            return Err(Error::out_of_range(
                "--certify",
                margin_deg,
                (MARGIN_LIMITS_DEG, Some("deg")),
                format!("lie between {low} and {high} deg"),
            ));
        }
        let slope_deg = steepest.map_or(0.0, |slope| slope.to_degrees() + margin_deg);
        let max_slip = pair.settings().max_slip;
        let proof = prove_no_slip_holds(
            pair.wheel(),
            pair.soil(),
            weight,
            slope_deg,
            max_slip,
            TIME_LIMIT_S,
        )?;
        Ok(Self {
            slope_deg,
            max_slip,
            proof,
        })
    }

    pub(super) const fn is_proved(&self) -> bool {
        self.proof.is_proved
    }

    /// `model_error` is that of the steepest slope, rad.
    pub(super) fn text(&self, model_error: Option<f64>) -> String {
        let slope = rounded(self.slope_deg, 6);
        if !self.proof.is_proved {
            return format!(
                "not proved: that no slip holds {slope}° could not be shown in {TIME_LIMIT_S} s\n"
            );
        }
        let how = if self.proof.is_rule_proved {
            "proved too"
        } else {
            "measured, not proved"
        };
        let max_slip = shown(self.max_slip);
        let lower = self.proof.certificate.as_ref().map_or(0.0, |c| c.lower);
        format!(
            "proved: no slip from 0 to {max_slip} holds {slope}°; at least {} N of pull are missing\n(error of the integrals of at most \
             1e-8 of each force: {how}){}\n",
            shown(lower),
            model_error.map_or_else(String::new, |error| {
                let degrees = rounded(error.to_degrees(), 2);
                format!("\n90 % of measurements lie within ±{degrees}° of what the laws say")
            })
        )
    }
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Proved> {
    fields! { |of: &'a Proved|
        "slope_deg" "the slope of the proof" = of.slope_deg;
        "max_slip" "slips from 0 to this are covered" = of.max_slip;
        "is_proved" "no such slip holds the slope" = of.proof.is_proved;
        "rule_is_proved" "the error of the rule of integration is proved; else it is measured" = of.proof.is_rule_proved;
        "shortage_n" "pull that is missing at the best slip that was found" = of.proof.shortage;
        "proved_shortage_n" "pull that is missing at least at every slip" =
            of.proof.certificate.as_ref().map(|c| c.lower).filter(|lower| lower.is_finite());
        "boxes" "boxes examined" = of.proof.certificate.as_ref().map(|c| c.boxes);
        "seconds" "time taken, s" = of.proof.certificate.as_ref().map(|c| c.seconds);
    }
}
