//! The optimisation problem of Ani et al. (2012) under several readings, and the curve on which its printed
//! optimum lies.
//!
//! The paper prints nine variables, three objectives and the method; not the bounds, the start, the scaling,
//! the constraints, the sense of the objectives or the utility. A [`Interpretation`] fills these in, each time
//! differently, so that it can be shown what the answer depends on. The printed slip of 0.1146 is not
//! claimed by any of them.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_files::Document;
use grouser_terra::{entry_angle, slip_ani};

use grouser_design::{Design, Result, parse};

/// The optimum slip that the paper prints.
pub const PRINTED_SLIP: f64 = 0.1146;

/// What is assumed where the paper is silent.
///
/// ```
/// use grouser_campaign::paper::INTERPRETATIONS;
///
/// assert!(INTERPRETATIONS[0].text(4, 1).starts_with("format = 1\n"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpretation {
    /// Its name in tables.
    pub name: &'static str,
    /// The sense and the scale of the objectives, in words.
    pub assumes: &'static str,
    /// The objectives of the problem file.
    objectives: &'static str,
}

/// The readings that are compared.
pub const INTERPRETATIONS: [Interpretation; 5] = [
    Interpretation {
        name: "as printed, in Pa",
        assumes: "τ_max, T(θ) and |S_0| all minimised, without scaling",
        objectives: "f1 = \"tau_max_pa\"\nf2 = \"strength_at_theta_pa\"\nf3 = { expr = \"s_0\", absolute = true }\n",
    },
    Interpretation {
        name: "stresses in 10 kPa",
        assumes: "all minimised, 10 kPa counts like a slip of 1",
        objectives: "f1 = { expr = \"tau_max_pa\", scale = 1e-4 }\nf2 = { expr = \"strength_at_theta_pa\", scale = 1e-4 }\nf3 = { expr = \"s_0\", absolute = true }\n",
    },
    Interpretation {
        name: "stresses in 100 kPa",
        assumes: "all minimised, 100 kPa counts like a slip of 1",
        objectives: "f1 = { expr = \"tau_max_pa\", scale = 1e-5 }\nf2 = { expr = \"strength_at_theta_pa\", scale = 1e-5 }\nf3 = { expr = \"s_0\", absolute = true }\n",
    },
    Interpretation {
        name: "strength wanted, 10 kPa",
        assumes: "10 kPa/τ_max, 10 kPa/T(θ) and |S_0| minimised",
        objectives: "f1 = \"1e4/tau_max_pa\"\nf2 = \"1e4/strength_at_theta_pa\"\nf3 = { expr = \"s_0\", absolute = true }\n",
    },
    Interpretation {
        name: "strength wanted, 2.5 kPa",
        assumes: "2.5 kPa/τ_max, 2.5 kPa/T(θ) and |S_0| minimised",
        objectives: "f1 = \"2.5e3/tau_max_pa\"\nf2 = \"2.5e3/strength_at_theta_pa\"\nf3 = { expr = \"s_0\", absolute = true }\n",
    },
];

/// The variables with the bounds that we assume: the ranges of the paper's figures and terrain table.
const VARIABLES: [(&str, f64, f64, f64); 9] = [
    ("radius_m", 0.10, 0.07, 0.18),
    ("sinkage_m", 0.014, 0.01, 0.03),
    ("theta_deg", 20.0, 0.0, 45.0),
    ("phi_deg", 25.0, 13.0, 30.0),
    ("cohesion_kpa", 2.0, 1.0, 4.14),
    ("k_c_kn_per_m_n1", 5.0, 0.9, 13.2),
    ("k_phi_kn_per_m_n2", 1000.0, 196.7, 1528.4),
    ("width_m", 0.10, 0.05, 0.20),
    ("n", 1.0, 0.5, 1.6),
];

impl Interpretation {
    /// The reading as a problem file.
    #[must_use]
    pub fn text(&self, starts: usize, seed: u64) -> String {
        let mut text = format!(
            "format = 1\ntitle = \"Ani et al. (2012), {}\"\nmethod = \"minimax\"\nstarts = {starts}\nseed = {seed}\n[variables]\n",
            self.name
        );
        for (name, start, lower, upper) in VARIABLES {
            let _ = writeln!(
                text,
                "{name} = {{ start = {start:?}, lower = {lower:?}, upper = {upper:?} }}"
            );
        }
        text.push_str("[objectives]\n");
        text.push_str(self.objectives);
        text.push_str("[constraints]\nin_contact = \"theta_deg <= theta_1_deg\"\n");
        text
    }

    /// The reading as a design, solved from `starts` starts.
    ///
    /// # Errors
    /// None for the readings that ship; what [`grouser_design::parse`] refuses.
    ///
    /// ```
    /// use grouser_campaign::paper::INTERPRETATIONS;
    ///
    /// let design = INTERPRETATIONS[1].design(1, 1)?;
    /// assert_eq!((design.variables.len(), design.objectives.len()), (9, 3));
    /// # Ok::<(), grouser_campaign::Error>(())
    /// ```
    pub fn design(&self, starts: usize, seed: u64) -> Result<Design> {
        let name = format!("the paper's problem ({})", self.name);
        parse(&Document::from_text(&name, self.text(starts, seed))?)
    }
}

/// The z/r at which |S_0| is `magnitude` at the angle `theta` (rad): S_0 depends on these two alone.
/// `None` where no sinkage below the hub gives it.
///
/// Source: Ani et al. 2012 (P19), solved by bisection to rounding; |S_0| grows with z.
///
/// ```
/// use grouser_campaign::paper::sinkage_ratio_of_slip;
/// let at = sinkage_ratio_of_slip(0.1146, 20_f64.to_radians()).expect("there is one");
/// assert!((at - 0.15188).abs() < 5e-6);
/// ```
#[must_use]
pub fn sinkage_ratio_of_slip(magnitude: f64, theta: f64) -> Option<f64> {
    let off = |ratio: f64| slip_ani(theta, entry_angle(ratio, 1.0)).abs() - magnitude;
    let (mut low, mut high) = (0.0, 1.0 - 1e-12);
    if !(off(low) <= 0.0 && off(high) >= 0.0) {
        return None;
    }
    while high - low > 2.0 * f64::EPSILON {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if off(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}
