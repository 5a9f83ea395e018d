//! A cart for tests: four powered wheels and a free one, driven by a formula.

use std::f64::consts::TAU;

use grouser_slip::window::WindowSettings;
use grouser_slip::{CounterWidth, Encoder, Measurement, Robot, Sample, Wheel, WheelRole};

pub(crate) const TICKS: f64 = 4000.0;
pub(crate) const FREE: usize = 4;

pub(crate) fn encoder(bits: u32) -> Encoder {
    Encoder::counting(TICKS).counter(CounterWidth::new(bits).unwrap())
}

pub(crate) fn wheel(name: &str, (x, y): (f64, f64), role: WheelRole, bits: u32) -> Wheel {
    let wheel = match role {
        WheelRole::Powered => Wheel::powered(name),
        WheelRole::Free => Wheel::free(name),
    };
    wheel.at(x, y).radius(0.1).encoder(encoder(bits))
}

pub(crate) fn robot(bits: u32) -> Robot {
    let wheels = vec![
        wheel("fl", (0.3, 0.25), WheelRole::Powered, bits),
        wheel("fr", (0.3, -0.25), WheelRole::Powered, bits),
        wheel("rl", (-0.3, 0.25), WheelRole::Powered, bits),
        wheel("rr", (-0.3, -0.25), WheelRole::Powered, bits),
        wheel("fifth", (-0.45, 0.1), WheelRole::Free, bits),
    ];
    Robot::new("cart".into(), wheels).unwrap()
}

pub(crate) fn settings() -> WindowSettings {
    WindowSettings {
        max_speed: 5.0,
        ..WindowSettings::default()
    }
}

/// Speed of the body, m/s, its yaw rate, rad/s, and the slip of the powered wheels, constant.
#[derive(Clone, Copy)]
pub(crate) struct Drivers {
    pub(crate) speed: f64,
    pub(crate) yaw_rate: f64,
    pub(crate) slip: f64,
}

impl Drivers {
    /// Ticks (whole, since the start) of a wheel at `time`.
    pub(crate) fn ticks(&self, robot: &Robot, index: usize, time: f64) -> i64 {
        let wheel = &robot.wheels()[index];
        let forward = self.speed - self.yaw_rate * wheel.y;
        let rim = if index == FREE {
            forward
        } else if self.slip >= 0.0 {
            forward / (1.0 - self.slip)
        } else {
            forward * (1.0 + self.slip)
        };
        #[allow(clippy::cast_possible_truncation, reason = "a few thousand ticks")]
        let ticks = (rim * time / (TAU * wheel.radius) * TICKS).floor() as i64;
        ticks
    }

    /// The samples of one row.
    pub(crate) fn row(&self, robot: &Robot, time_ns: i64, start: u64) -> Vec<Sample> {
        let time = time_ns as f64 * 1e-9;
        let mut out: Vec<Sample> = (0..5)
            .map(|wheel| Sample {
                time_ns,
                measurement: Measurement::WheelCount {
                    wheel,
                    raw: start.wrapping_add_signed(self.ticks(robot, wheel, time)),
                },
            })
            .collect();
        out.push(Sample {
            time_ns,
            measurement: Measurement::YawRate {
                rate: self.yaw_rate,
            },
        });
        out
    }
}
