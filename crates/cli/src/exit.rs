//! How a job ends: the one table of exit codes.

/// Each exit code and what it means.
pub(crate) const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done"),
    (
        1,
        "no usable result: no solution, not converged, infeasible",
    ),
    (2, "bad usage or input"),
    (
        3,
        "a result was written, but it is incomplete or doubtful: rows failed, a check failed, data were lost",
    ),
    (INTERRUPTED, "interrupted by Ctrl-C, SIGTERM or SIGHUP"),
];

/// What a shell reports of a program ended by Ctrl-C.
pub(crate) const INTERRUPTED: u8 = 130;

/// The exit code of every bad usage and input.
pub(crate) const BAD_INPUT: u8 = 2;

/// How a job ended that was not refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// With its result.
    Done,
    /// Without a usable result.
    NoResult,
    /// With a result that is incomplete or doubtful.
    Doubtful,
    /// By Ctrl-C, with what was found until then.
    Interrupted,
}

impl Outcome {
    /// The exit code.
    pub(crate) fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::NoResult => 1,
            Self::Doubtful => 3,
            Self::Interrupted => INTERRUPTED,
        }
    }
}
