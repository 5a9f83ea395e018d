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
pub struct Elements<'a, T>(Source<'a, T>);

/// Where elements are.
#[derive(Clone, Copy)]
enum Source<'a, T> {
    Array(&'a [Value], fn(&'a Value) -> Option<T>),
    Fields(
        &'a Value,
        &'static [&'static str],
        fn(&'a Value) -> Option<T>,
    ),
    Given(&'a [T]),
}

impl<'a, T: Copy> Elements<'a, T> {
    /// `None` where the value is no array, or has an element that `of` does not read.
    pub(super) fn new(value: &'a Value, of: fn(&'a Value) -> Option<T>) -> Option<Self> {
        Self(Source::Array(value.elements()?, of)).whole()
    }

    /// The fields of a value by their paths; `None` where one is missing, or `of` does not read it.
    pub(super) fn of_fields(
        value: &'a Value,
        paths: &'static [&'static str],
        of: fn(&'a Value) -> Option<T>,
    ) -> Option<Self> {
        Self(Source::Fields(value, paths, of)).whole()
    }

    /// What the type of the message gives, and not the message.
    pub(super) const fn given(elements: &'a [T]) -> Self {
        Self(Source::Given(elements))
    }

    fn whole(self) -> Option<Self> {
        (self.iter().count() == self.len()).then_some(self)
    }

    /// The element at a place.
    #[must_use]
    pub fn get(&self, place: usize) -> Option<T> {
        match self.0 {
            Source::Array(values, of) => of(values.get(place)?),
            Source::Fields(value, paths, of) => of(value.at(paths.get(place)?)?),
            Source::Given(elements) => elements.get(place).copied(),
        }
    }

    /// All elements.
    pub fn iter(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let all = *self;
        (0..all.len()).filter_map(move |place| all.get(place))
    }
}

impl<T> Elements<'_, T> {
    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        match &self.0 {
            Source::Array(values, _) => values.len(),
            Source::Fields(_, paths, _) => paths.len(),
            Source::Given(elements) => elements.len(),
        }
    }

    /// Are there none?
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<T> Default for Elements<'_, T> {
    fn default() -> Self {
        Self(Source::Given(&[]))
    }
}

impl<T: Copy + PartialEq> PartialEq for Elements<'_, T> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl<T: Copy + fmt::Debug> fmt::Debug for Elements<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
