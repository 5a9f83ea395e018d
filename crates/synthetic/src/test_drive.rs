//! The drive on which the filter is tried, and the filter's description of the robot.

use grouser_slip::{CounterWidth, Encoder, Result, Robot, Wheel};

use crate::drive::Leg;
use crate::five_wheel::{FiveWheel, NAMES, WHEELS};

impl FiveWheel {
    /// A hundred rows a second, a free wheel of 500 ticks: rest until 2 s, at 0.3 m/s from 4 s to 20 s with a soft
    /// patch and a curve, braking, at rest from 23 s to 26 s.
    #[must_use]
    pub fn test_drive(seed: u64) -> Self {
        let leg = |seconds, speed, yaw_rate| Leg {
            seconds,
            speed,
            yaw_rate,
            brakes: false,
        };
        let mut robot = Self {
            seed,
            rate: 100,
            legs: vec![
                leg(2.0, 0.0, 0.0),
                leg(2.0, 0.30, 0.0),
                leg(8.0, 0.30, 0.0),
                leg(1.0, 0.30, 0.15),
                leg(6.0, 0.30, 0.15),
                leg(1.0, 0.30, 0.0),
                Leg {
                    brakes: true,
                    ..leg(3.0, 0.0, 0.0)
                },
                leg(3.0, 0.0, 0.0),
            ],
            free_slip: (-0.002, -0.005),
            ..Self::default()
        };
        robot.wheels[WHEELS - 1].ticks = 500.0;
        robot
    }

    /// The robot's description, with counters of `bits` bits.
    ///
    /// # Errors
    /// What a description may not say: a width of counters outside 8 to 64 bits, a radius of zero.
    pub fn described(&self, bits: u32) -> Result<Robot> {
        let counter = CounterWidth::new(bits)?;
        let wheels = self.wheels.iter().zip(NAMES).map(|(wheel, name)| {
            let described = if wheel.free {
                Wheel::free(name)
            } else {
                Wheel::powered(name)
            };
            described
                .at(wheel.x, wheel.y)
                .radius(wheel.radius)
                .encoder(Encoder::counting(wheel.ticks).counter(counter))
        });
        Robot::new("five wheels".into(), wheels.collect())
    }
}
