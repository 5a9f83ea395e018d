//! The robot's command: speed and yaw rate over time.

/// A stretch of time at whose end the robot has this speed and this yaw rate; in between both change
/// smoothly (3u² − 2u³).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// How long it lasts, s.
    pub seconds: f64,
    /// Speed at its end, m/s.
    pub speed: f64,
    /// Yaw rate at its end, rad/s.
    pub yaw_rate: f64,
    /// Does the robot brake in it?
    pub brakes: bool,
}

/// Speed (m/s), yaw rate (rad/s) and braking at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// m/s.
    pub speed: f64,
    /// rad/s.
    pub yaw_rate: f64,
    /// Does the robot brake?
    pub brakes: bool,
}

/// The command at `time` of a drive that starts at rest.
#[must_use]
pub fn command(legs: &[Leg], time: f64) -> Command {
    let mut from = Command::default();
    let mut start = 0.0;
    for leg in legs {
        let share = (time - start) / leg.seconds;
        if share < 1.0 {
            let smooth = share * share * (3.0 - 2.0 * share);
            return Command {
                speed: from.speed + smooth * (leg.speed - from.speed),
                yaw_rate: from.yaw_rate + smooth * (leg.yaw_rate - from.yaw_rate),
                brakes: leg.brakes,
            };
        }
        start += leg.seconds;
        from = Command {
            speed: leg.speed,
            yaw_rate: leg.yaw_rate,
            brakes: false,
        };
    }
    from
}
