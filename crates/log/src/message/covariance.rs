//! What a variance in a message says about its value.

/// What a variance in a message says about its value, by REP 103 and what drivers do.
///
/// ```
/// use grouser_log::message::Trust;
///
/// assert_eq!(Trust::from_variance(0.01), Trust::Variance(0.01));
/// assert!(!Trust::from_variance(-1.0).is_usable());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trust {
    /// 0, or nothing that a variance can be (NaN, less than -1): the variance is not known.
    Unknown,
    /// -1: the message does not hold the value.
    Absent,
    /// Beyond 1e300 (Kobuki's driver writes 1.8e308): the value is not to be used.
    DoNotUse,
    /// The variance.
    Variance(f64),
}

impl Trust {
    /// By the number that stands in the message.
    ///
    /// ```
    /// use grouser_log::message::Trust;
    ///
    /// assert_eq!(Trust::from_variance(f64::MAX), Trust::DoNotUse); // as Kobuki's driver writes it
    /// ```
    #[must_use]
    pub fn from_variance(variance: f64) -> Self {
        if variance == -1.0 {
            Self::Absent
        } else if variance > 1e300 {
            Self::DoNotUse
        } else if variance > 0.0 {
            Self::Variance(variance)
        } else {
            Self::Unknown
        }
    }

    /// May the value be used?
    #[must_use]
    pub const fn is_usable(self) -> bool {
        matches!(self, Self::Unknown | Self::Variance(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_mean_what_drivers_mean_by_them() {
        assert_eq!(Trust::from_variance(0.0), Trust::Unknown);
        assert_eq!(Trust::from_variance(-0.0), Trust::Unknown);
        assert_eq!(Trust::from_variance(-1.0), Trust::Absent);
        assert_eq!(
            Trust::from_variance(1.797_693_134_862_315_7e308),
            Trust::DoNotUse
        );
        assert_eq!(Trust::from_variance(f64::INFINITY), Trust::DoNotUse);
        assert_eq!(Trust::from_variance(2.5e-5), Trust::Variance(2.5e-5));
        assert_eq!(Trust::from_variance(1e6), Trust::Variance(1e6));
        for nonsense in [f64::NAN, -2.0, f64::NEG_INFINITY] {
            assert_eq!(Trust::from_variance(nonsense), Trust::Unknown);
        }
    }
}
