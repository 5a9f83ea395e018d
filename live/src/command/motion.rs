//! The motion that a `geometry_msgs/Twist` or `TwistStamped` requests.

use grouser_log::message::{CdrWriter, Header, MessageError, Value, View};

/// Forward speed and yaw rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MotionRequest {
    /// m/s.
    pub(crate) speed: f64,
    /// rad/s, to the left positive.
    pub(crate) yaw_rate: f64,
}

/// Why a command is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Refusal {
    /// It cannot be decoded.
    Undecoded,
    /// A component is NaN or infinite.
    NotFinite { component: &'static str, value: f64 },
    /// It moves otherwise than forwards and about the vertical.
    NotPlanar { component: &'static str, value: f64 },
}

impl Refusal {
    pub(crate) fn words(self) -> String {
        match self {
            Self::Undecoded => "a command was refused: it cannot be decoded".to_owned(),
            Self::NotFinite { component, value } => {
                format!("a command was refused: `{component}` is {value}, but must be finite")
            }
            Self::NotPlanar { component, value } => format!(
                "a command was refused: `{component}` is {value}, but must be 0: only forward speed and yaw rate can \
                 be limited"
            ),
        }
    }
}

impl MotionRequest {
    /// Of a decoded message.
    pub(crate) fn read(type_name: &str, value: &Value) -> Result<Self, Refusal> {
        let Some(View::Twist {
            linear, angular, ..
        }) = View::new(type_name, value)
        else {
            return Err(Refusal::Undecoded);
        };
        let components = [
            ("linear.x", linear[0]),
            ("angular.z", angular[2]),
            ("linear.y", linear[1]),
            ("linear.z", linear[2]),
            ("angular.x", angular[0]),
            ("angular.y", angular[1]),
        ];
        for (component, value) in components {
            if !value.is_finite() {
                return Err(Refusal::NotFinite { component, value });
            }
        }
        for (component, value) in &components[2..] {
            if *value != 0.0 {
                let (component, value) = (*component, *value);
                return Err(Refusal::NotPlanar { component, value });
            }
        }
        Ok(Self {
            speed: linear[0],
            yaw_rate: angular[2],
        })
    }

    /// Writes a message of the same type as the command; `header` where that has one.
    pub(crate) fn write(
        self,
        bytes: &mut Vec<u8>,
        header: Option<Header<'_>>,
    ) -> Result<(), MessageError> {
        let mut out = CdrWriter::new(bytes);
        if let Some(header) = header {
            out.header(header)?;
        }
        out.float64s([self.speed, 0.0, 0.0, 0.0, 0.0, self.yaw_rate]);
        Ok(())
    }

    pub(crate) fn is_zero(self) -> bool {
        self.speed == 0.0 && self.yaw_rate == 0.0
    }

    pub(crate) fn scaled(self, share: f64) -> Self {
        Self {
            speed: share * self.speed,
            yaw_rate: share * self.yaw_rate,
        }
    }

    /// The same arc at a speed and yaw rate within the limits.
    pub(crate) fn within(self, max_speed: f64, max_yaw_rate: f64) -> Self {
        let share = |value: f64, limit: f64| {
            if value.abs() > limit {
                limit / value.abs()
            } else {
                1.0
            }
        };
        let share = share(self.speed, max_speed).min(share(self.yaw_rate, max_yaw_rate));
        // rounding must not pass the limits
        let Self { speed, yaw_rate } = self.scaled(share);
        Self {
            speed: speed.clamp(-max_speed, max_speed),
            yaw_rate: yaw_rate.clamp(-max_yaw_rate, max_yaw_rate),
        }
    }
}
