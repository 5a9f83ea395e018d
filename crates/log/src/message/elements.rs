//! Arrays of a message whose elements are all of one kind.

use std::fmt;

use super::Value;

/// The elements of an array of a message, each read where it stands.
///
/// ```
/// use grouser_log::message::{View, build};
///
/// let message = build::joint_state(build::header(0, "base"), &["left", "right"], [&[1.5, 1.6], &[], &[]]);
/// let Some(View::JointState(joints)) = View::new("sensor_msgs/msg/JointState", &message) else {
///     unreachable!("it has all fields of its type");
/// };
/// assert_eq!(joints.names.get(1), Some("right"));
/// assert_eq!(joints.position.iter().sum::<f64>(), 3.1);
/// assert!(joints.velocity.is_empty());
/// ```
#[derive(Clone, Copy)]
pub struct Elements<'a, T> {
    values: &'a [Value],
    of: fn(&'a Value) -> Option<T>,
}

impl<'a, T> Elements<'a, T> {
    /// `None` where the value is no array, or has an element that `of` does not read.
    pub(super) fn new(value: &'a Value, of: fn(&'a Value) -> Option<T>) -> Option<Self> {
        let values = value.elements()?;
        let all = values.iter().all(|value| of(value).is_some());
        all.then_some(Self { values, of })
    }

    /// The element at a place.
    #[must_use]
    pub fn get(&self, place: usize) -> Option<T> {
        (self.of)(self.values.get(place)?)
    }

    /// All elements.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        self.values.iter().filter_map(self.of)
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.values.len()
    }

    /// Are there none?
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.values.is_empty()
    }
}

impl<T> Default for Elements<'_, T> {
    fn default() -> Self {
        Self {
            values: &[],
            of: |_| None,
        }
    }
}

impl<T: PartialEq> PartialEq for Elements<'_, T> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: fmt::Debug> fmt::Debug for Elements<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
