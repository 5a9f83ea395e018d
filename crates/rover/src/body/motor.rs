//! A DC motor behind a gear, with limits of voltage and current.

/// A motor as the wheel sees it.
///
/// i = (V − k γ ω)/R with γ the gear's ratio and ω the wheel's rate against its link; |V| and |i| are limited;
/// the gear passes on the share η of the torque when the motor drives, and takes 1/η when it is driven.
///
/// ```
/// use grouser_rover::body::Motor;
///
/// let motor = Motor {
///     resistance: 0.6,  // Ω
///     constant: 0.03,   // N m/A
///     gear: 100.0,
///     efficiency: 0.85,
///     voltage: 24.0,    // V
///     current: 6.0,     // A
/// };
/// assert!((motor.max_torque() - 15.3).abs() < 1e-12); // 0.03 · 100 · 6 · 0.85 N m
/// let stalled = motor.drive(5.1, 0.0);
/// assert!((stalled.current - 2.0).abs() < 1e-12 && (stalled.heat - stalled.power).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// R, Ω.
    pub resistance: f64,
    /// k, N m/A and V s/rad.
    pub constant: f64,
    /// γ, motor turns per wheel turn.
    pub gear: f64,
    /// η.
    pub efficiency: f64,
    /// Limit of |V|, V.
    pub voltage: f64,
    /// Limit of |i|, A.
    pub current: f64,
}

/// What a motor does at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MotorNow {
    /// A.
    pub current: f64,
    /// V.
    pub voltage: f64,
    /// On the wheel, N m.
    pub torque: f64,
    /// Electrical power, W; negative while it brakes into the battery.
    pub power: f64,
    /// What copper and gear turn into heat, W.
    pub heat: f64,
}

impl Motor {
    /// The greatest torque on the wheel while driving, N m.
    #[must_use]
    pub fn max_torque(&self) -> f64 {
        self.constant * self.gear * self.current * self.efficiency
    }

    /// The motor with the setpoint `torque` (N m on the wheel) at the wheel's rate `rate` (rad/s against its link).
    ///
    /// ```
    /// use grouser_rover::body::Motor;
    ///
    /// let motor = Motor {
    ///     resistance: 0.6,
    ///     constant: 0.03,
    ///     gear: 100.0,
    ///     efficiency: 0.85,
    ///     voltage: 24.0,
    ///     current: 6.0,
    /// };
    /// // at 8 rad/s all of the voltage is needed for the speed: k γ ω = 24 V
    /// assert!(motor.drive(10.0, 8.0).torque.abs() < 1e-9);
    /// ```
    #[must_use]
    #[inline]
    pub fn drive(&self, torque: f64, rate: f64) -> MotorNow {
        let per_ampere = self.constant * self.gear;
        let driving = torque * rate >= 0.0;
        let passes = if driving {
            self.efficiency
        } else {
            1.0 / self.efficiency
        };
        let wanted = (torque / (per_ampere * passes)).clamp(-self.current, self.current);
        let back = per_ampere * rate;
        let voltage = (self.resistance * wanted + back).clamp(-self.voltage, self.voltage);
        let current = ((voltage - back) / self.resistance).clamp(-self.current, self.current);
        let shaft = per_ampere * current;
        let passes = if shaft * rate >= 0.0 {
            self.efficiency
        } else {
            1.0 / self.efficiency
        };
        let torque = shaft * passes;
        let power = voltage * current;
        MotorNow {
            current,
            voltage,
            torque,
            power,
            heat: power - torque * rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTOR: Motor = Motor {
        resistance: 0.5,
        constant: 0.03,
        gear: 60.0,
        efficiency: 0.8,
        voltage: 24.0,
        current: 8.0,
    };

    #[test]
    fn at_rest_the_current_makes_the_torque() {
        let now = MOTOR.drive(7.2, 0.0);
        // 7.2 N m / (0.03 · 60 · 0.8)
        assert!((now.current - 5.0).abs() < 1e-12);
        assert!((now.heat - 0.5 * 25.0).abs() < 1e-12);
        assert!((MOTOR.drive(1e9, 0.0).torque - MOTOR.max_torque()).abs() < 1e-12);
    }

    #[test]
    fn it_cannot_push_past_its_no_load_speed() {
        let no_load = 24.0 / (0.03 * 60.0);
        assert!(MOTOR.drive(5.0, no_load).torque.abs() < 1e-12);
        assert!(MOTOR.drive(5.0, 1.2 * no_load).torque < 0.0);
    }

    #[test]
    fn power_is_work_and_heat() {
        for rate in [-9.0, -1.0, 0.5, 6.0] {
            for torque in [-6.0, 0.3, 9.0] {
                let now = MOTOR.drive(torque, rate);
                assert!((now.power - now.torque * rate - now.heat).abs() < 1e-12);
                assert!(now.heat >= -1e-12, "{torque} {rate}");
            }
        }
    }
}
