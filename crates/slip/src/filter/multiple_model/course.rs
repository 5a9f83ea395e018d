//! The axes of a position's errors.

/// The course at a position's time, and the position's variance along it and across, m².
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) variances: [f64; 2],
}

impl Course {
    /// Both axes in the reference's frame, with the variance along each.
    pub(super) fn axes(&self) -> [([f64; 2], f64); 2] {
        let [along, across] = self.variances;
        [
            ([self.cos, self.sin], along),
            ([-self.sin, self.cos], across),
        ]
    }

    pub(super) fn wider(&self, factor: f64) -> Self {
        let variances = self.variances.map(|variance| variance * factor);
        Self { variances, ..*self }
    }
}
