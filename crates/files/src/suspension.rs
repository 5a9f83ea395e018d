//! The joints of a suspension, as logs name them.

/// A joint of the suspension, by the link that it turns.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SuspensionJoint {
    /// The link's name.
    pub link: String,
    /// The number of the joint: links that a differential joins share one.
    pub joint: usize,
    /// The joint's angle over the link's: +1, or -1 on the other side of a differential.
    pub sign: f64,
}

impl SuspensionJoint {
    /// The joint of a link that is known by its name alone.
    pub(crate) fn of_link(link: &str) -> Self {
        Self {
            link: link.to_owned(),
            joint: 0,
            sign: 1.0,
        }
    }
}
