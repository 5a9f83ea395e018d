//! Which instructions the lanes run on, and the lanes made of them. The only place with `unsafe` code: an
//! instruction beyond the baseline may run only on a machine that has it.
#![allow(unsafe_code, reason = "instructions found at run time")]

#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod avx2;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod avx512;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
mod lanes_of;

#[cfg(all(feature = "std", target_arch = "x86_64"))]
use lanes_of::lanes_of;

use crate::contact::ladder::Step;

use super::Lanes;
use super::batch::{BatchOutcome, BatchPoints};
use super::group;
use super::plan::{Given, Group, Prepared};

/// A set of instructions that this machine has. A value other than `Portable` exists only where
/// [`Level::best`] has found the instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// What every machine of the target has.
    Portable,
    /// 256-bit vectors, fused multiply-add.
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    Avx2,
    /// 512-bit vectors.
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    Avx512,
}

impl Level {
    /// The best of this machine.
    pub(super) fn best() -> Self {
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        {
            let fused =
                std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
            if fused
                && std::is_x86_feature_detected!("avx512f")
                && std::is_x86_feature_detected!("avx512dq")
            {
                return Self::Avx512;
            }
            if fused {
                return Self::Avx2;
            }
        }
        Self::Portable
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => "avx2",
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => "avx512",
        }
    }

    /// The expected z/r of a chunk under its loads.
    pub(super) fn expected(
        self,
        prepared: &Prepared,
        points: &BatchPoints<'_>,
        load: &[f64],
        out: &mut [f64],
    ) {
        match self {
            Self::Portable => group::expected::<Lanes>(prepared, points, load, out),
            // SAFETY: as in `run`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { expected_avx2(prepared, points, load, out) },
            // SAFETY: as in `run`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { expected_avx512(prepared, points, load, out) },
        }
    }

    /// One group on these instructions.
    pub(super) fn run(
        self,
        prepared: &Prepared,
        points: &BatchPoints<'_>,
        given: Given<'_>,
        part: (Step, Group),
        out: &mut [BatchOutcome],
    ) {
        match self {
            Self::Portable => group::run::<Lanes>(prepared, points, given, part, out),
            // SAFETY: this value exists only where `best` found avx2 and fma on this machine.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { run_avx2(prepared, points, given, part, out) },
            // SAFETY: this value exists only where `best` found avx512f, avx512dq, avx2 and fma.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { run_avx512(prepared, points, given, part, out) },
        }
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: Given<'_>,
    part: (Step, Group),
    out: &mut [BatchOutcome],
) {
    group::run::<avx2::Avx2>(prepared, points, given, part, out);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn run_avx512(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: Given<'_>,
    part: (Step, Group),
    out: &mut [BatchOutcome],
) {
    group::run::<avx512::Avx512>(prepared, points, given, part, out);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn expected_avx2(prepared: &Prepared, points: &BatchPoints<'_>, load: &[f64], out: &mut [f64]) {
    group::expected::<avx2::Avx2>(prepared, points, load, out);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn expected_avx512(prepared: &Prepared, points: &BatchPoints<'_>, load: &[f64], out: &mut [f64]) {
    group::expected::<avx512::Avx512>(prepared, points, load, out);
}
