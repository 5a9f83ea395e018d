//! Faults by schedule.

use crate::error::{Error, Result};

/// What may be wrong; each kind says what its value means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FaultKind {
    /// The encoder gives nothing.
    EncoderSilent,
    /// The counter stands still.
    EncoderStuck,
    /// Value: share of the ticks that are lost at random.
    PulseLoss,
    /// One tick of each turn of the shaft is lost.
    BrokenSlot,
    /// The counter runs the wrong way.
    EncoderReversed,
    /// The counter begins again at 0.
    CounterReset,
    /// Value: ticks by which the counter jumps.
    TickJump,
    /// Value: factor of the ticks, as by a worn or wrong radius.
    RadiusError,
    /// Value: ticks of play.
    Backlash,
    /// The motor gives no torque.
    MotorOff,
    /// The wheel cannot turn.
    WheelBlocked,
    /// All sensors keep the stamp of the last fifth of a second.
    DuplicateTime,
    /// Value: s by which the clock is off while it lasts.
    ClockStep,
    /// Value: s by which the clock jumps for good where the window begins.
    ClockJump,
    /// Value: share of the period by which stamps are off.
    Jitter,
    /// Value: s by which all readings come late.
    Latency,
    /// Value: Hz at which the sensors read.
    SlowRate,
    /// The inertial unit gives NaN and infinity.
    Garbage,
    /// The inertial unit repeats itself.
    ImuStuck,
    /// Value: full scale in g and rad/s.
    ImuSaturated,
    /// Value: rad/s added to the gyro.
    GyroBias,
    /// No pictures.
    CameraLost,
    /// The camera sees no way.
    CameraFrozen,
    /// Value: m by which each way is too long.
    CameraJump,
    /// Value: factor of the camera's ways.
    CameraScale,
    /// Value: share of the greatest current added.
    CurrentOffset,
    /// The current reads 0.
    CurrentZero,
    /// The sensors of sinkage and entry angle repeat themselves.
    ContactStuck,
    /// They give NaN, sinkages below 0 and beyond the radius in turn.
    ContactGarbage,
    /// Every sensor is silent.
    AllSilent,
}

impl FaultKind {
    /// Every kind with its name in files and the range of its value, (0, 0) where it takes none.
    pub const NAMES: [(&'static str, Self, (f64, f64)); 30] = [
        ("encoder-silent", Self::EncoderSilent, (0.0, 0.0)),
        ("encoder-stuck", Self::EncoderStuck, (0.0, 0.0)),
        ("pulse-loss", Self::PulseLoss, (0.0, 1.0)),
        ("broken-slot", Self::BrokenSlot, (0.0, 0.0)),
        ("encoder-reversed", Self::EncoderReversed, (0.0, 0.0)),
        ("counter-reset", Self::CounterReset, (0.0, 0.0)),
        ("tick-jump", Self::TickJump, (-1e15, 1e15)),
        ("radius-error", Self::RadiusError, (0.1, 10.0)),
        ("backlash", Self::Backlash, (0.0, 1e6)),
        ("motor-off", Self::MotorOff, (0.0, 0.0)),
        ("wheel-blocked", Self::WheelBlocked, (0.0, 0.0)),
        ("duplicate-time", Self::DuplicateTime, (0.0, 0.0)),
        ("clock-step", Self::ClockStep, (-1e9, 1e9)),
        ("clock-jump", Self::ClockJump, (-1e9, 1e9)),
        ("jitter", Self::Jitter, (0.0, 2.0)),
        ("latency", Self::Latency, (0.0, 2.0)),
        ("slow-rate", Self::SlowRate, (0.1, 1e3)),
        ("garbage", Self::Garbage, (0.0, 0.0)),
        ("imu-stuck", Self::ImuStuck, (0.0, 0.0)),
        ("imu-saturated", Self::ImuSaturated, (1e-3, 100.0)),
        ("gyro-bias", Self::GyroBias, (-10.0, 10.0)),
        ("camera-lost", Self::CameraLost, (0.0, 0.0)),
        ("camera-frozen", Self::CameraFrozen, (0.0, 0.0)),
        ("camera-jump", Self::CameraJump, (-100.0, 100.0)),
        ("camera-scale", Self::CameraScale, (0.0, 100.0)),
        ("current-offset", Self::CurrentOffset, (-2.0, 2.0)),
        ("current-zero", Self::CurrentZero, (0.0, 0.0)),
        ("contact-stuck", Self::ContactStuck, (0.0, 0.0)),
        ("contact-garbage", Self::ContactGarbage, (0.0, 0.0)),
        ("all-silent", Self::AllSilent, (0.0, 0.0)),
    ];

    fn entry(self) -> (&'static str, Self, (f64, f64)) {
        let mut all = Self::NAMES.into_iter();
        all.find(|(_, kind, _)| *kind == self)
            .unwrap_or(("fault", self, (0.0, 0.0)))
    }

    /// Its name in files.
    ///
    /// ```
    /// # use grouser_rover::sensors::FaultKind;
    /// assert_eq!(FaultKind::PulseLoss.name(), "pulse-loss");
    /// ```
    #[must_use]
    pub fn name(self) -> &'static str {
        self.entry().0
    }
}

/// A fault from one time to another.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FaultWindow {
    /// What is wrong.
    pub kind: FaultKind,
    /// With which wheel; `None`: with every one, or with none.
    pub wheel: Option<usize>,
    /// From, s.
    pub from: f64,
    /// To, s.
    pub to: f64,
    /// As its kind has it.
    pub value: f64,
}

impl FaultWindow {
    /// A fault of every wheel or of none, from and to in seconds, with the value that its kind has.
    ///
    /// ```
    /// use grouser_rover::sensors::{FaultKind, FaultWindow, Schedule};
    ///
    /// let mut loss = FaultWindow::new(FaultKind::PulseLoss, (10.0, 20.0), 0.05);
    /// loss.wheel = Some(2);
    /// let schedule = Schedule::new(vec![loss])?;
    /// assert_eq!(schedule.active(FaultKind::PulseLoss, Some(2), 15.0), Some(0.05));
    /// assert_eq!(schedule.active(FaultKind::PulseLoss, Some(1), 15.0), None);
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    #[must_use]
    pub const fn new(kind: FaultKind, (from, to): (f64, f64), value: f64) -> Self {
        let wheel = None;
        Self {
            kind,
            wheel,
            from,
            to,
            value,
        }
    }
}

/// Faults by schedule.
///
/// ```
/// use grouser_rover::sensors::Schedule;
///
/// assert!(Schedule::default().windows().is_empty()); // no faults
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schedule {
    windows: Vec<FaultWindow>,
}

impl Schedule {
    /// A schedule of these faults.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a value outside what its kind takes, or a window that ends before it begins.
    pub fn new(windows: Vec<FaultWindow>) -> Result<Self> {
        for window in &windows {
            let (name, _, limits) = window.kind.entry();
            let of = format!("fault \"{name}\"");
            Error::check(&of, "from", window.from, (0.0, 1e9), "s")?;
            Error::check(&of, "to", window.to, (window.from, f64::INFINITY), "s")?;
            Error::check(&of, "value", window.value, limits, "")?;
        }
        Ok(Self { windows })
    }

    /// The faults.
    #[must_use]
    pub fn windows(&self) -> &[FaultWindow] {
        &self.windows
    }

    /// The value of a fault that is active for that wheel at that time (s).
    #[must_use]
    pub fn active(&self, kind: FaultKind, wheel: Option<usize>, time: f64) -> Option<f64> {
        self.windows
            .iter()
            .find(|w| {
                w.kind == kind
                    && (w.wheel.is_none() || w.wheel == wheel)
                    && time >= w.from
                    && time < w.to
            })
            .map(|w| w.value)
    }

    /// The sum of the values of all faults of a kind that have begun.
    fn begun(&self, kind: FaultKind, time: f64) -> f64 {
        self.windows
            .iter()
            .filter(|w| w.kind == kind && time >= w.from)
            .map(|w| w.value)
            .sum()
    }

    pub(super) fn settled(&self, kind: FaultKind, time: f64) -> f64 {
        if self.windows.is_empty() {
            0.0
        } else {
            self.begun(kind, time)
        }
    }
}
