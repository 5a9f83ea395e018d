//! What to keep in mind about a result that was computed outside a law's comfortable range.

use core::fmt;

/// A reason to look twice at a result.
///
/// ```
/// use grouser_terra::Caution;
///
/// assert_eq!(Caution::DeepSinkage.key(), "deep-sinkage");
/// assert_eq!(Caution::DeepSinkage.to_string(), "sinkage is more than a sixth of the wheel's diameter");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Caution {
    /// c_1 + c_2 s ≥ 1: the greatest stress would lie at the entry, where there is none; σ ≡ 0.
    NoNormalStress,
    /// c_1 + c_2 s < 0: the greatest stress was held at θ = 0.
    MaximumStressHeld,
    /// z > D/6, where Bekker's theory is said to lose its grip \[Wong08\].
    DeepSinkage,
    /// For s < 0 the shear changes its sign within the contact by a law beyond the literature.
    ShearReversal,
    /// Shear along and across were taken apart; together they exceed the soil's strength.
    ShearAboveStrength,
    /// The soil's unit weight is unknown: side force without bulldozing.
    NoBulldozing,
    /// More than one sinkage carries the load; this is the lowest on a rising branch.
    SeveralSinkages,
    /// The contact gives energy back, which soil cannot.
    WorkGained,
    /// The lugs are further apart than Skonieczny's rule allows at this slip and sinkage: the rim between them
    /// pushes soil forwards ([`lug_spacing_skonieczny`](crate::lug_spacing_skonieczny)).
    LugSpacing,
    /// The lugs are higher than a tenth of the radius, beyond every wheel that their law was chosen on
    /// ([`lug_mobilisation`](crate::lug_mobilisation)).
    LugHeight,
    /// Slip, slip angle, width or load lie outside the tests that the soil's numbers were fitted on.
    OutsideFit,
    /// The hub lies below the ground: axle and motor, which are not in the model, touch the soil.
    HubInSoil,
    /// The load is smaller than the search for the sinkage resolves: the vertical force misses it by more than a
    /// millionth. Stresses that nearly cancel leave no more digits.
    LoadBelowResolution,
}

impl Caution {
    /// Every caution, in a fixed order.
    pub const ALL: [Self; 13] = [
        Self::NoNormalStress,
        Self::MaximumStressHeld,
        Self::DeepSinkage,
        Self::ShearReversal,
        Self::ShearAboveStrength,
        Self::NoBulldozing,
        Self::SeveralSinkages,
        Self::WorkGained,
        Self::LugSpacing,
        Self::LugHeight,
        Self::OutsideFit,
        Self::HubInSoil,
        Self::LoadBelowResolution,
    ];

    /// Its name in files and on the wire.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::NoNormalStress => "no-normal-stress",
            Self::MaximumStressHeld => "maximum-stress-held",
            Self::DeepSinkage => "deep-sinkage",
            Self::ShearReversal => "shear-reversal",
            Self::ShearAboveStrength => "shear-above-strength",
            Self::NoBulldozing => "no-bulldozing",
            Self::SeveralSinkages => "several-sinkages",
            Self::WorkGained => "work-gained",
            Self::LugSpacing => "lug-spacing",
            Self::LugHeight => "lug-height",
            Self::OutsideFit => "outside-fit",
            Self::HubInSoil => "hub-in-soil",
            Self::LoadBelowResolution => "load-below-resolution",
        }
    }
}

impl fmt::Display for Caution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoNormalStress => {
                "c_1 + c_2 s reaches 1, so the law gives no normal stress anywhere"
            }
            Self::MaximumStressHeld => "c_1 + c_2 s is negative; the angle of the peak stress is limited to 0",
            Self::DeepSinkage => "sinkage is more than a sixth of the wheel's diameter",
            Self::ShearReversal => {
                "shear changes its sign within the contact, by a law beyond the literature"
            }
            Self::ShearAboveStrength => {
                "shear along and across together exceed the strength of the soil"
            }
            Self::NoBulldozing => {
                "the soil's unit weight is unknown: side force without bulldozing"
            }
            Self::SeveralSinkages => "more than one sinkage carries this load; this is the lowest",
            Self::WorkGained => "the contact gives energy back, which soil cannot",
            Self::LugSpacing => {
                "lugs are so far from each other that the wheel between them pushes soil forwards"
            }
            Self::LugHeight => {
                "lugs are higher than a tenth of the radius, beyond the wheels that their law was chosen on"
            }
            Self::LoadBelowResolution => {
                "the load is smaller than the search for the sinkage resolves: the vertical force differs from it"
            }
            Self::HubInSoil => {
                "the hub lies below the ground: axle and motor, which are not in the model, touch the soil"
            }
            Self::OutsideFit => {
                "slip, slip angle, width or load lie outside the tests that the soil was fitted on"
            }
        })
    }
}

/// Does a wheel of `radius` sink by more than a sixth of its diameter, where [`Caution::DeepSinkage`] applies?
///
/// ```
/// assert!(grouser_terra::is_deep(0.06, 0.15) && !grouser_terra::is_deep(0.04, 0.15));
/// ```
#[must_use]
pub const fn is_deep(sinkage: f64, radius: f64) -> bool {
    sinkage > radius / 3.0
}

/// The numbers of a contact that cautions follow from, whoever found them.
pub(crate) struct Judged {
    /// θ_m/θ_1 before it is held in [0, 1].
    pub(crate) position: f64,
    /// Sinkage, m.
    pub(crate) sinkage: f64,
    /// Radius, m.
    pub(crate) radius: f64,
    /// Does the shear change its sign?
    pub(crate) reverses: bool,
    /// Does the point lie outside the tests of its soil?
    pub(crate) outside_fit: bool,
    /// Work lost in the contact, per radian, and what its rounding is measured by, N m.
    pub(crate) lost_work: (f64, f64),
}

/// A set of cautions.
///
/// ```
/// use grouser_terra::{Caution, Cautions};
///
/// let mut cautions = Cautions::default();
/// cautions.insert(Caution::DeepSinkage);
/// cautions.insert_if(false, Caution::WorkGained);
/// assert!(cautions.contains(Caution::DeepSinkage) && cautions.iter().count() == 1);
///
/// let mut both = Cautions::default();
/// both.insert(Caution::WorkGained);
/// both.insert_all(cautions);
/// assert_eq!(both.iter().count(), 2);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cautions(u16);

impl Cautions {
    /// Adds those that follow from numbers.
    pub(crate) fn judge(&mut self, of: &Judged) {
        self.insert_if(of.position >= 1.0, Caution::NoNormalStress);
        self.insert_if(of.position < 0.0, Caution::MaximumStressHeld);
        self.insert_if(is_deep(of.sinkage, of.radius), Caution::DeepSinkage);
        self.insert_if(of.sinkage > of.radius, Caution::HubInSoil);
        self.insert_if(of.reverses, Caution::ShearReversal);
        self.insert_if(of.outside_fit, Caution::OutsideFit);
        let (lost, scale) = of.lost_work;
        // rounding of the balance's terms, which may cancel
        self.insert_if(lost < -1e-9 * scale, Caution::WorkGained);
    }

    /// Adds one.
    pub fn insert(&mut self, caution: Caution) {
        self.0 |= 1 << caution as u16;
    }

    /// Adds those of another result.
    pub fn insert_all(&mut self, others: Self) {
        self.0 |= others.0;
    }

    /// Adds one if `condition` holds.
    pub fn insert_if(&mut self, condition: bool, caution: Caution) {
        if condition {
            self.insert(caution);
        }
    }

    /// Is it there?
    #[must_use]
    pub const fn contains(self, caution: Caution) -> bool {
        self.0 & (1 << caution as u16) != 0
    }

    /// Is none there?
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Those that are there, in a fixed order.
    pub fn iter(self) -> impl Iterator<Item = Caution> {
        Caution::ALL
            .into_iter()
            .filter(move |caution| self.contains(*caution))
    }
}

#[cfg(test)]
mod tests {
    use std::vec;

    use super::*;

    /// Exactly at a limit nothing is cautioned, and just beyond it one thing.
    #[test]
    fn cautions_begin_beyond_their_limits() {
        let at = Judged {
            position: 0.0,
            sinkage: 0.25,
            radius: 0.75,
            reverses: false,
            outside_fit: false,
            lost_work: (-1e-9 * 7.0, 7.0),
        };
        let of = |judged: &Judged| {
            let mut cautions = Cautions::default();
            cautions.judge(judged);
            cautions.iter().collect::<std::vec::Vec<_>>()
        };
        assert_eq!(of(&at), []);
        let position = |position: f64| of(&Judged { position, ..at });
        assert_eq!(position(1.0_f64.next_down()), []);
        assert_eq!(position(1.0), [Caution::NoNormalStress]);
        assert_eq!(
            position((-0.0_f64).next_down()),
            [Caution::MaximumStressHeld]
        );
        let sinkage = |sinkage: f64| of(&Judged { sinkage, ..at });
        assert_eq!(sinkage(0.25_f64.next_up()), [Caution::DeepSinkage]);
        assert_eq!(sinkage(0.75), [Caution::DeepSinkage]);
        let hub = [Caution::DeepSinkage, Caution::HubInSoil];
        assert_eq!(sinkage(0.75_f64.next_up()), hub);
        let lost = |lost: f64| {
            of(&Judged {
                lost_work: (lost, 7.0),
                ..at
            })
        };
        assert_eq!(lost(-7.001e-9), [Caution::WorkGained]);
        assert_eq!((lost(0.0), lost(7.0)), (vec![], vec![]));
        assert_eq!(
            of(&Judged {
                reverses: true,
                ..at
            }),
            [Caution::ShearReversal]
        );
        assert_eq!(
            of(&Judged {
                outside_fit: true,
                ..at
            }),
            [Caution::OutsideFit]
        );
    }

    #[test]
    fn sets_are_joined() {
        let of = |of: &[Caution]| {
            let mut cautions = Cautions::default();
            for caution in of {
                cautions.insert(*caution);
            }
            cautions
        };
        let mut both = of(&[Caution::WorkGained, Caution::LugSpacing]);
        both.insert_all(of(&[Caution::WorkGained, Caution::OutsideFit]));
        let expected = [
            Caution::WorkGained,
            Caution::LugSpacing,
            Caution::OutsideFit,
        ];
        assert!(both.iter().eq(expected));
        both.insert_if(false, Caution::HubInSoil);
        both.insert_if(true, Caution::DeepSinkage);
        assert!(both.contains(Caution::DeepSinkage) && !both.contains(Caution::HubInSoil));
        assert!(!both.is_empty() && Cautions::default().is_empty());
    }
}
