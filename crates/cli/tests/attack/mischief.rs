//! What is done to a verb.

use super::random::Random;

/// One kind of mischief a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mischief {
    /// A file that it reads is damaged.
    Damage,
    /// A flag's value is another.
    Value,
    /// Flags twice, missing, unknown, in another order.
    Flags,
    /// What it reads is no file.
    NoFile,
    /// What it writes is no place for a file, or a file that must stay.
    NoPlace,
    /// Standard output is closed, full, or its reader goes away.
    Closed,
    /// A signal in the middle.
    Signal,
    /// A limit of the system.
    Limit,
}

impl Mischief {
    pub(crate) fn choose(random: &mut Random) -> Self {
        match random.below(20) {
            0..8 => Self::Damage,
            8..12 => Self::Value,
            12..14 => Self::Flags,
            14 => Self::NoFile,
            15 => Self::NoPlace,
            16 => Self::Closed,
            17 => Self::Signal,
            _ => Self::Limit,
        }
    }

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Damage => "damaged file",
            Self::Value => "hostile value",
            Self::Flags => "flags",
            Self::NoFile => "input is no file",
            Self::NoPlace => "output is no place",
            Self::Closed => "standard output",
            Self::Signal => "signal",
            Self::Limit => "limit",
        }
    }
}
