//! The sensors that can measure how fast the robot travels.

/// What measures the robot's speed.
///
/// ```
/// use grouser_slip::Reference;
///
/// assert_eq!(Reference::ALL[0], Reference::Displacement); // preferred where there are several
/// assert_eq!(Reference::FreeWheel.name(), "free-wheel");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reference {
    /// The robot's free wheels, taken to roll without slip [Ani2012, P23]. They do skid a little on
    /// soft ground: the slips then come out too high by −s_f (1 − S).
    FreeWheel,
    /// Measured displacements, in the robot's frame (a camera, visual odometry).
    Displacement,
    /// A measured pose (a camera from above, motion capture, GNSS).
    Pose,
    /// A measured speed over ground.
    Speed,
    /// None of these: the wheel that runs slowest for the robot's yaw rate is taken to grip.
    Grip,
}

impl Reference {
    /// Every reference, the one to be preferred first.
    pub const ALL: [Self; 5] = [
        Self::Displacement,
        Self::Pose,
        Self::Speed,
        Self::FreeWheel,
        Self::Grip,
    ];

    /// Its name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FreeWheel => "free-wheel",
            Self::Displacement => "displacement",
            Self::Pose => "pose",
            Self::Speed => "speed",
            Self::Grip => "grip",
        }
    }
}
