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
use super::forces::{self, ForceSheet};
use super::load::{self, LoadSheet};
use super::nodes;
use super::plan::Chunk;
use crate::contact::quick::{QuickContact, QuickPart, QuickPlan};
use crate::contact::{Contact, Integrals, Panel};
use crate::quadrature::RuleView;

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

    /// The forces of a chunk at its sinkages.
    pub(super) fn forces(self, chunk: &mut Chunk<'_>, sheet: &mut ForceSheet) {
        match self {
            Self::Portable => forces::run::<Lanes>(chunk, sheet),
            // SAFETY: this value exists only where `best` found avx2 and fma on this machine.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { forces_avx2(chunk, sheet) },
            // SAFETY: this value exists only where `best` found avx512f, avx512dq, avx2 and fma.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { forces_avx512(chunk, sheet) },
        }
    }

    /// The sinkages and forces of a chunk under its loads.
    pub(super) fn load(self, chunk: &mut Chunk<'_>, sheet: &mut LoadSheet) {
        match self {
            Self::Portable => load::run::<Lanes>(chunk, sheet),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { load_avx2(chunk, sheet) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { load_avx512(chunk, sheet) },
        }
    }

    /// [`nodes::smooth`].
    pub(super) fn smooth_nodes(
        self,
        contact: &Contact<f64>,
        friction: RuleView<'_>,
        cohesion: RuleView<'_>,
    ) -> Integrals<f64> {
        match self {
            Self::Portable => nodes::smooth::<Lanes>(contact, friction, cohesion),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { smooth_avx2(contact, friction, cohesion) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { smooth_avx512(contact, friction, cohesion) },
        }
    }

    /// [`nodes::quick`].
    pub(super) fn quick_nodes(self, plan: &QuickPlan) -> Integrals<f64> {
        match self {
            Self::Portable => nodes::quick::<Lanes>(plan),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { quick_avx2(plan) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { quick_avx512(plan) },
        }
    }

    /// [`nodes::quick_part`].
    pub(super) fn quick_part(self, contact: &QuickContact<f64>, part: QuickPart) -> Integrals<f64> {
        match self {
            Self::Portable => nodes::quick_part::<Lanes>(contact, part),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { quick_part_avx2(contact, part) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { quick_part_avx512(contact, part) },
        }
    }

    /// [`nodes::rough`].
    pub(super) fn rough_contacts(self, contacts: &[Contact<f64>; 8]) -> [Integrals<f64>; 8] {
        match self {
            Self::Portable => nodes::rough::<Lanes>(contacts),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { rough_avx2(contacts) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { rough_avx512(contacts) },
        }
    }

    /// [`nodes::panel`].
    pub(super) fn panel_nodes(
        self,
        contact: &Contact<f64>,
        panel: Panel,
        rule: RuleView<'_>,
    ) -> Integrals<f64> {
        match self {
            Self::Portable => nodes::panel::<Lanes>(contact, panel, rule),
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx2 => unsafe { panel_avx2(contact, panel, rule) },
            // SAFETY: as in `forces`.
            #[cfg(all(feature = "std", target_arch = "x86_64"))]
            Self::Avx512 => unsafe { panel_avx512(contact, panel, rule) },
        }
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn forces_avx2(chunk: &mut Chunk<'_>, sheet: &mut ForceSheet) {
    forces::run::<avx2::Avx2>(chunk, sheet);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn load_avx2(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet) {
    load::run::<avx2::Avx2>(chunk, sheet);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn forces_avx512(chunk: &mut Chunk<'_>, sheet: &mut ForceSheet) {
    forces::run::<avx512::Avx512>(chunk, sheet);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn load_avx512(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet) {
    load::run::<avx512::Avx512>(chunk, sheet);
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn smooth_avx2(
    contact: &Contact<f64>,
    friction: RuleView<'_>,
    cohesion: RuleView<'_>,
) -> Integrals<f64> {
    nodes::smooth::<avx2::Avx2>(contact, friction, cohesion)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn panel_avx2(contact: &Contact<f64>, panel: Panel, rule: RuleView<'_>) -> Integrals<f64> {
    nodes::panel::<avx2::Avx2>(contact, panel, rule)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn smooth_avx512(
    contact: &Contact<f64>,
    friction: RuleView<'_>,
    cohesion: RuleView<'_>,
) -> Integrals<f64> {
    nodes::smooth::<avx512::Avx512>(contact, friction, cohesion)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn panel_avx512(contact: &Contact<f64>, panel: Panel, rule: RuleView<'_>) -> Integrals<f64> {
    nodes::panel::<avx512::Avx512>(contact, panel, rule)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn quick_avx2(plan: &QuickPlan) -> Integrals<f64> {
    nodes::quick::<avx2::Avx2>(plan)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn quick_avx512(plan: &QuickPlan) -> Integrals<f64> {
    nodes::quick::<avx512::Avx512>(plan)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn quick_part_avx2(contact: &QuickContact<f64>, part: QuickPart) -> Integrals<f64> {
    nodes::quick_part::<avx2::Avx2>(contact, part)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn quick_part_avx512(contact: &QuickContact<f64>, part: QuickPart) -> Integrals<f64> {
    nodes::quick_part::<avx512::Avx512>(contact, part)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma")]
fn rough_avx2(contacts: &[Contact<f64>; 8]) -> [Integrals<f64>; 8] {
    nodes::rough::<avx2::Avx2>(contacts)
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
fn rough_avx512(contacts: &[Contact<f64>; 8]) -> [Integrals<f64>; 8] {
    nodes::rough::<avx512::Avx512>(contacts)
}

#[cfg(test)]
pub(super) mod tests;
