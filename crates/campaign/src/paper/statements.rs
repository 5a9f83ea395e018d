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
    /// The command that does it; empty where none can.
    pub command: &'static str,
    /// How it is reproduced, or why it is not.
    pub why: &'static str,
}

const fn statement(
    item: &'static str,
    about: &'static str,
    verdict: Verdict,
    command: &'static str,
    why: &'static str,
) -> Statement {
    Statement {
        item,
        about,
        verdict,
        command,
        why,
    }
}

/// Every numbered item of sections 2 to 6 of the paper, in its order.
pub const STATEMENTS: &[Statement] = &[
    statement(
        "Section 2.1, figures 1, 2",
        "robot with four wheels on two rockers with a differential; wheelbase, stance, rocker length and centre of mass adjustable; camber and caster; stability margins",
        Verdict::InPart,
        "grouser robot examples/robots/five-wheel.toml --stance --pitch-deg 15",
        "loads, tip-over margin and posture at rest of a robot file; the sizes are ours, photographs print none. Not part of it: the unloading (vibration) mechanism",
    ),
    statement(
        "Section 2.1, reconfiguration",
        "the chassis adjusts rocker angles, centre of mass, camber and caster to the ground",
        Verdict::InPart,
        "grouser drive examples/scenarios/side-slope.toml --compare controller,fixed-chassis --sweep 20",
        "actuators of links and of a mass in the robot file, moved by the controller to the maximum tip-over margin. Not part of it: actuators of camber and caster, on which the margin does not depend here",
    ),
    statement(
        "Section 2.2, figure 3",
        "the fifth wheel: a powered and a free wheel on one arm, the free one with an encoder",
        Verdict::Reproduced,
        "grouser drive examples/scenarios/sandbox.toml",
        "both wheels with their springs and encoder are simulated; the robot file has their sizes, which are ours",
    ),
    statement(
        "Sections 3.1, 3.2, figures 5–7",
        "three classes of parameters (wheel, soil, interface) and the stress model that joins them",
        Verdict::Reproduced,
        "grouser wheel --soil dry-sand --radius-m 0.15 --width-m 0.12 --load-n 28 --slip 0.36 --figure stress.svg",
        "the diagrams print no numbers; ours has the stresses of one wheel with theirs",
    ),
    statement(
        "(P1)",
        "shear stress τ = (c + σ tan φ)(1 − e^(−j/K))",
        Verdict::Reproduced,
        "grouser wheel --soil dry-sand --radius-m 0.15 --width-m 0.12 --load-n 28 --slip 0.1146",
        "computed wherever a wheel meets soil, to 1e-9 of 30-digit quadrature",
    ),
    statement(
        "(P2)",
        "strength τ_max = c + σ_max tan φ",
        Verdict::Reproduced,
        "grouser optimize examples/problems/paper.toml",
        "the quantity `tau_max_pa` of problem files, with σ_max = (k_c/b + k_φ) zⁿ as our reading of σ_max",
    ),
    statement(
        "(P3)",
        "shear stress against displacement by Janosi and Hanamoto (1961): τ = τ_max (1 − e^(−j/K))",
        Verdict::Reproduced,
        "grouser wheel --soil dry-sand --radius-m 0.15 --width-m 0.12 --load-n 28 --slip 0.1146",
        "the law of shear of every soil whose file names no other; (P1) is (P3) with the strength of (P2) at the stress σ",
    ),
    statement(
        "(P4), (P5)",
        "slip in driving and braking",
        Verdict::InPart,
        "grouser estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml",
        "the printed forms are lost; the usual definitions are used: s = 1 − v/(rω) driving, s = rω/v − 1 braking",
    ),
    statement(
        "(P6)",
        "slip S = 1 − v_a/v_t",
        Verdict::Reproduced,
        "grouser estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml",
        "the driving branch of the slip used everywhere here",
    ),
    statement(
        "(P7)",
        "T(θ) = c + σ(θ) tan φ",
        Verdict::Reproduced,
        "grouser optimize examples/problems/paper.toml",
        "the quantity `strength_at_theta_pa`, σ(θ) by the front law inside the contact and 0 outside: our reading",
    ),
    statement(
        "(P8)–(P16)",
        "the slip that mobilises a share of the strength",
        Verdict::Reproduced,
        "grouser paper slip-model --theta-deg 10 --sinkage-m 0.02 --radius-m 0.1 --mobilised 0.5 --soil dry-sand",
        "shares that no slip can mobilise are a typed outcome",
    ),
    statement(
        "(P17), (P19)",
        "S_0 = 1 − (θ_1 − θ)/(sin θ_1 − sin θ)",
        Verdict::Reproduced,
        "grouser paper slip-model --theta-deg 32 --sinkage-m 0.03 --radius-m 0.1",
        "S_0 is never positive, and no soil parameter can move it: the paper apparently prints magnitudes",
    ),
    statement(
        "(P18)",
        "entry angle θ_1 = acos(1 − z/r)",
        Verdict::Reproduced,
        "grouser paper slip-model --theta-deg 32 --sinkage-m 0.03 --radius-m 0.1",
        "in a form that keeps its digits at small sinkage",
    ),
    statement(
        "Figure 8",
        "slip against the angle θ",
        Verdict::InPart,
        "grouser paper slip-model --theta-deg 0:45 --sinkage-m 0.01,0.014,0.02,0.03 --radius-m 0.1 -o figure-8.svg",
        "signed and as magnitude; which of the two the paper shows is not stated",
    ),
    statement(
        "Figure 9",
        "slip against sinkage at θ = 32°",
        Verdict::InPart,
        "grouser paper slip-model --theta-deg 32 --sinkage-m 0.001:0.04 --radius-m 0.07,0.08,0.1,0.18 -o figure-9.svg",
        "at small sinkage θ = 32° lies outside the contact, where the number means nothing under a wheel",
    ),
    statement(
        "Figure 10",
        "slip against radius at θ = 32°, z = 1 mm",
        Verdict::InPart,
        "grouser paper slip-model --theta-deg 32 --sinkage-m 0.001 --radius-m 0.05:0.2 -o figure-10.svg",
        "all of it lies outside the contact",
    ),
    statement(
        "Table 1",
        "terrain parameters",
        Verdict::InPart,
        "grouser soils",
        "the table's own numbers are not in the text that we have; the catalogue holds the set that papers on rovers use, each entry with its source",
    ),
    statement(
        "(P20)",
        "bounds and constraints",
        Verdict::InPart,
        "grouser optimize examples/problems/paper.toml",
        "the kinds are known; the numbers are not printed, ours are the ranges of the paper's figures and terrain table",
    ),
    statement(
        "(P21)",
        "the utility F(x)",
        Verdict::NotPossible,
        "",
        "the equation is lost; problem files have minimax, goal attainment, weighted and Chebyshev forms",
    ),
    statement(
        "(P22)",
        "minimax by fminimax",
        Verdict::Reproduced,
        "grouser optimize examples/problems/paper.toml --certify",
        "exact derivatives and multipliers, and a proof that no other point is better",
    ),
    statement(
        "Table 2",
        "the optimum, slip 0.1146",
        Verdict::NotPossible,
        "",
        "start, bounds, scaling, sense and utility are not printed; five readings of the problem show how much the answer depends on them",
    ),
    statement(
        "Section 4.1, (P23)",
        "speed from the free fifth wheel, v = r_f ω_f",
        Verdict::Reproduced,
        "grouser estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml --soil dry-sand",
        "the free wheel's own skid, which the paper neglects, is computed with `--soil`",
    ),
    statement(
        "(P24)",
        "speed from encoder pulses",
        Verdict::InPart,
        "grouser paper --end-to-end -o run",
        "the equation is lost; ours extrapolates from the last three pulses and bounds by the pulse that has not come. The run stamps each pulse of the free wheel (`edge_clock_s`)",
    ),
    statement(
        "Figure 11",
        "decisions from slip",
        Verdict::Reproduced,
        "grouser drive examples/scenarios/slope.toml -v",
        "the controller lists each decision with its reason, value and limit; it also accepts a slip that a slope demands, and ends a drive",
    ),
    statement(
        "Section 4.2, figures 12, 13",
        "the run on sand",
        Verdict::InPart,
        "grouser paper --end-to-end -o run",
        "its data are not published; such a robot is simulated on dry sand, and figure 13 is the estimate of its log next to the true slip",
    ),
    statement(
        "Sections 5, 6.3",
        "θ, θ_1 and z measured by a camera, a displacement sensor or the kinematics of the suspension",
        Verdict::Reproduced,
        "grouser drive examples/scenarios/sinkage.toml",
        "sinkages and entry angles are samples of the estimator, which learns the soil's stiffness from them; how a camera finds the angle in a picture is not part of it",
    ),
    statement(
        "Section 6.5",
        "future work: fusion of fifth wheel, inertial unit and vision; terrain parameters identified online",
        Verdict::Reproduced,
        "grouser drive examples/scenarios/unknown-soil.toml",
        "one filter over modes of slip on board; strength and stiffness of the soil are learnt while driving",
    ),
];
