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

use super::Lanes;
use super::batch::{BatchOutcome, BatchPoints, Sheet, Work};
use super::nodes::{self, Carried, Single, Track};
use super::plan::Prepared;
use super::vector::Vector;
use super::{curve, forces, load};

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

    /// A chunk on these instructions.
    pub(super) fn run(
        self,
        prepared: &Prepared,
        points: &BatchPoints<'_>,
        given: &[f64],
        work: &mut Work<'_>,
        out: &mut [BatchOutcome],
    ) {
        match self {
            Self::Portable => run::<Lanes>(prepared, points, given, work, out),
            // SAFETY: this value exists only where `best` found avx2 and fma on this machine.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { run_avx2(prepared, points, given, work, out) },
            // SAFETY: this value exists only where `best` found avx512f, avx512dq, avx2 and fma.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { run_avx512(prepared, points, given, work, out) },
        }
    }

    /// One wheel's forces on these instructions.
    pub(super) fn single_forces(self, single: &Single<'_>, z_over_r: f64) -> Option<[f64; 3]> {
        match self {
            Self::Portable => nodes::forces::<Lanes>(single, z_over_r),
            // SAFETY: this value exists only where `best` found avx2 and fma on this machine.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { single_forces_avx2(single, z_over_r) },
            // SAFETY: this value exists only where `best` found avx512f, avx512dq, avx2 and fma.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { single_forces_avx512(single, z_over_r) },
        }
    }

    /// One wheel's sinkage on these instructions.
    pub(super) fn single_load(
        self,
        single: &Single<'_>,
        load: f64,
        track: &mut Option<Track>,
    ) -> Option<Carried> {
        match self {
            Self::Portable => nodes::under_load::<Lanes>(single, load, track),
            // SAFETY: as in `single_forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { single_load_avx2(single, load, track) },
            // SAFETY: as in `single_forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { single_load_avx512(single, load, track) },
        }
    }
}

#[inline(always)]
fn run<V: Vector>(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: &[f64],
    work: &mut Work<'_>,
    out: &mut [BatchOutcome],
) {
    let plan = &mut work.plan;
    match &mut work.sheet {
        Sheet::Forces(sheet) => forces::run::<V>(prepared, points, given, (sheet, plan), out),
        Sheet::Load(sheet) => {
            load::run::<V, false>(prepared, points, given, (sheet, plan), out);
        }
        Sheet::Curve(sheet) => curve::run_curve::<V>(prepared, points, given, (sheet, plan), out),
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: &[f64],
    work: &mut Work<'_>,
    out: &mut [BatchOutcome],
) {
    run::<avx2::Avx2>(prepared, points, given, work, out);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn run_avx512(
    prepared: &Prepared,
    points: &BatchPoints<'_>,
    given: &[f64],
    work: &mut Work<'_>,
    out: &mut [BatchOutcome],
) {
    run::<avx512::Avx512>(prepared, points, given, work, out);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn single_forces_avx512(single: &Single<'_>, z_over_r: f64) -> Option<[f64; 3]> {
    nodes::forces::<avx512::Avx512>(single, z_over_r)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn single_load_avx512(
    single: &Single<'_>,
    load: f64,
    track: &mut Option<Track>,
) -> Option<Carried> {
    nodes::under_load::<avx512::Avx512>(single, load, track)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn single_forces_avx2(single: &Single<'_>, z_over_r: f64) -> Option<[f64; 3]> {
    nodes::forces::<avx2::Avx2>(single, z_over_r)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn single_load_avx2(single: &Single<'_>, load: f64, track: &mut Option<Track>) -> Option<Carried> {
    nodes::under_load::<avx2::Avx2>(single, load, track)
}
