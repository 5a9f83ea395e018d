//! What of the paper is reproduced, item by item, and why the rest is not.

/// How far an item can be reproduced.
///
/// ```
/// use grouser_campaign::paper::Verdict;
///
/// assert!(!Verdict::Reproduced.key().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The whole item.
    Reproduced,
    /// A part of the item.
    InPart,
    /// Nothing of the item.
    NotPossible,
}

impl Verdict {
    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::InPart => "reproduced in part",
            Self::NotPossible => "not possible",
        }
    }
}

/// One equation, table or figure.
///
/// ```
/// use grouser_campaign::paper::{STATEMENTS, Verdict};
///
/// assert!(STATEMENTS.iter().any(|statement| statement.verdict == Verdict::Reproduced));
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Statement {
    /// The number that the paper gives it.
    pub item: &'static str,
    /// What it contains.
    pub about: &'static str,
    /// How far it is reproduced.
    pub verdict: Verdict,
    /// How it is reproduced, or why it is not.
    pub why: &'static str,
}

const fn statement(
    item: &'static str,
    about: &'static str,
    verdict: Verdict,
    why: &'static str,
) -> Statement {
    Statement {
        item,
        about,
        verdict,
        why,
    }
}

/// Every numbered item of the paper.
pub const STATEMENTS: &[Statement] = &[
    statement(
        "(P1)",
        "shear stress τ = (c + σ tan φ)(1 − e^(−j/K))",
        Verdict::Reproduced,
        "computed wherever a wheel meets soil; `grouser wheel --figure` draws it",
    ),
    statement(
        "(P2)",
        "strength τ_max = c + σ_max tan φ",
        Verdict::Reproduced,
        "the quantity `tau_max_pa` of problem files, with σ_max = (k_c/b + k_φ) zⁿ as our reading of σ_max",
    ),
    statement(
        "(P3)",
        "shear stress against displacement by Janosi and Hanamoto (1961): τ = τ_max (1 − e^(−j/K))",
        Verdict::Reproduced,
        "the law of shear of every soil whose file names no other; (P1) is (P3) with the strength of (P2) at the stress σ",
    ),
    statement(
        "(P4), (P5)",
        "slip in driving and braking",
        Verdict::InPart,
        "the printed forms are lost; the usual definitions stand for them, as named conversions",
    ),
    statement(
        "(P6)",
        "slip S = 1 − v_a/v_t",
        Verdict::Reproduced,
        "the driving branch of the slip used everywhere here",
    ),
    statement(
        "(P7)",
        "T(θ) = c + σ(θ) tan φ",
        Verdict::Reproduced,
        "the quantity `strength_at_theta_pa`, σ(θ) by the front law inside the contact and 0 outside: our reading",
    ),
    statement(
        "(P8)–(P16)",
        "the slip that mobilises a share of the strength",
        Verdict::Reproduced,
        "`grouser paper slip-model --mobilised`; shares that no slip can mobilise are a typed outcome",
    ),
    statement(
        "(P17), (P19)",
        "S_0 = 1 − (θ_1 − θ)/(sin θ_1 − sin θ)",
        Verdict::Reproduced,
        "figures 8 to 10 below; S_0 is never positive, and no soil parameter can move it",
    ),
    statement(
        "(P18)",
        "entry angle θ_1 = acos(1 − z/r)",
        Verdict::Reproduced,
        "in a form that keeps its digits at small sinkage",
    ),
    statement(
        "(P20)",
        "bounds and constraints",
        Verdict::InPart,
        "the kinds are known; the numbers are not printed, ours are the ranges of the paper's figures and terrain table",
    ),
    statement(
        "(P21)",
        "the utility F(x)",
        Verdict::NotPossible,
        "the equation is lost; the problem file takes minimax, weighted and Chebyshev forms",
    ),
    statement(
        "(P22)",
        "minimax by fminimax",
        Verdict::Reproduced,
        "the method, with exact derivatives and multipliers; the printed optimum is another matter, below",
    ),
    statement(
        "(P23)",
        "speed from the free fifth wheel, v = r_f ω_f",
        Verdict::Reproduced,
        "`grouser estimate`; the free wheel's own skid, which the paper neglects, is computed beside it",
    ),
    statement(
        "(P24)",
        "speed from encoder pulses",
        Verdict::NotPossible,
        "the equation is lost; `grouser estimate` uses an estimator of its own, with its quantisation error",
    ),
    statement(
        "Table 1",
        "terrain parameters",
        Verdict::InPart,
        "the table's own numbers are not in the text that we have; `grouser soils` holds the set that papers on rovers use, each entry with its source",
    ),
    statement(
        "Table 2",
        "the optimum, slip 0.1146",
        Verdict::NotPossible,
        "start, bounds, scaling, sense and utility are not printed; the table below shows how much the answer depends on them",
    ),
    statement(
        "Figures 1–3",
        "robot, chassis and fifth wheel",
        Verdict::InPart,
        "photographs and drawings without sizes; drawn here from the shipped robot file, whose sizes are ours",
    ),
    statement(
        "Figures 5–7",
        "classes of parameters, stress model",
        Verdict::InPart,
        "diagrams without numbers; `grouser wheel --figure` draws the stress under a wheel with its numbers",
    ),
    statement(
        "Figure 8",
        "slip against the angle θ",
        Verdict::InPart,
        "drawn below, signed and as magnitude; which of the two the paper shows is not said",
    ),
    statement(
        "Figure 9",
        "slip against sinkage at θ = 32°",
        Verdict::InPart,
        "drawn below; at small sinkage θ = 32° lies outside the contact, where the number means nothing under a wheel",
    ),
    statement(
        "Figure 10",
        "slip against radius at θ = 32°, z = 1 mm",
        Verdict::InPart,
        "drawn below; all of it lies outside the contact",
    ),
    statement(
        "Figure 11",
        "decisions from slip",
        Verdict::Reproduced,
        "the controller of `grouser drive`, which lists each decision with its reason, value and limit",
    ),
    statement(
        "Figures 12, 13",
        "the run on sand",
        Verdict::InPart,
        "its data are not published; in its place such a robot is simulated on dry sand (examples/scenarios/sandbox.toml), \
         and figure 13 is drawn of that: slip by the fifth wheel beside the truth",
    ),
];
