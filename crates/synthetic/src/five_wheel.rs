//! The five-wheeled robot: four powered corner wheels, the fifth free behind them.

use std::f64::consts::TAU;
use std::fmt::Write;
use std::io;

use grouser_log::write::SampleWriter;
use grouser_slip::{Measurement, Sample};

use crate::drive::{Command, Leg, command};
use crate::noise::{Noise, Wander};

/// When the run begins in files with dates, ns since 1970: 1 September 2012.
pub const START_NS: i64 = 1_346_457_600_000_000_000;

/// Number of wheels.
pub const WHEELS: usize = 5;
/// Their names, in the order of every list.
pub const NAMES: [&str; WHEELS] = [
    "front_left",
    "front_right",
    "rear_left",
    "rear_right",
    "fifth",
];

/// A wheel as the generator sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Position forwards, m.
    pub x: f64,
    /// Position to the left, m.
    pub y: f64,
    /// Radius, m.
    pub radius: f64,
    /// Ticks per turn of the wheel.
    pub ticks: f64,
    /// What its counter shows at the start.
    pub count_at_start: i64,
    /// Is it free?
    pub free: bool,
}

/// A run to be generated.
#[derive(Clone, Debug, PartialEq)]
pub struct FiveWheel {
    /// Seed of all noise.
    pub seed: u64,
    /// The wheels.
    pub wheels: [Wheel; WHEELS],
    /// What the robot does.
    pub legs: Vec<Leg>,
    /// Rows of the log per second.
    pub rate: u32,
    /// The soft patch: from where to where along the way, m.
    pub patch: (f64, f64),
    /// Slip of a driving powered wheel on firm ground and in the patch.
    pub drive_slip: (f64, f64),
    /// Slip of a braking powered wheel on firm ground and in the patch.
    pub brake_slip: (f64, f64),
    /// Skid of the free wheel on firm ground and in the patch. The example's is what the soil model gives
    /// a free wheel of radius 0.1 m, width 0.05 m and load 2 N on sandy loam and on dry sand.
    pub free_slip: (f64, f64),
    /// Standard deviation of the powered wheels' slip about these, wandering within half a second.
    pub slip_sigma: f64,
    /// Standard deviation of the gyro, rad/s.
    pub gyro_sigma: f64,
    /// Bias of the gyro, rad/s.
    pub gyro_bias: f64,
}

/// One row of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Milliseconds since the start.
    pub time_ms: u64,
    /// 16-bit counters.
    pub counts: [u16; WHEELS],
    /// Gyro, rad/s.
    pub yaw_rate: f64,
}

/// What is true at a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Milliseconds since the start.
    pub time_ms: u64,
    /// Speed of the robot's origin, m/s.
    pub speed: f64,
    /// Yaw rate, rad/s.
    pub yaw_rate: f64,
    /// How far each wheel's centre has gone along its heading, m.
    pub way: [f64; WHEELS],
    /// How far each rim has run, m.
    pub rim: [f64; WHEELS],
    /// Slip of each wheel at this moment; `None` at standstill.
    pub slip: [Option<f64>; WHEELS],
}

/// A run with its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The log.
    pub rows: Vec<Row>,
    /// The truth at each row.
    pub truth: Vec<Truth>,
}

impl Default for FiveWheel {
    /// The run that ships as `examples/five-wheel`.
    fn default() -> Self {
        let corner = |x, y, count_at_start| Wheel {
            x,
            y,
            radius: 0.1,
            ticks: 960.0,
            count_at_start,
            free: false,
        };
        let leg = |seconds, speed, yaw_rate| Leg {
            seconds,
            speed,
            yaw_rate,
            brakes: false,
        };
        Self {
            seed: 20_120_901,
            wheels: [
                corner(0.3, 0.25, 60_000),
                corner(0.3, -0.25, 100),
                corner(-0.3, 0.25, 65_000),
                corner(-0.3, -0.25, 30_000),
                Wheel {
                    x: -0.45,
                    y: 0.0,
                    radius: 0.1,
                    ticks: 1000.0,
                    count_at_start: 64_000,
                    free: true,
                },
            ],
            legs: vec![
                leg(2.0, 0.0, 0.0),
                leg(2.0, 0.30, 0.0),
                leg(8.0, 0.30, 0.0),
                leg(1.0, 0.20, 0.0),
                leg(9.0, 0.20, 0.0),
                leg(1.0, 0.30, 0.15),
                leg(5.0, 0.30, 0.15),
                leg(1.0, 0.30, 0.0),
                Leg {
                    brakes: true,
                    ..leg(3.0, 0.0, 0.0)
                },
                leg(2.0, 0.0, 0.0),
                leg(1.0, -0.15, 0.0),
                leg(3.0, -0.15, 0.0),
                leg(1.0, 0.0, 0.0),
                leg(1.0, 0.0, 0.0),
            ],
            rate: 50,
            patch: (2.7, 4.5),
            drive_slip: (0.05, 0.35),
            brake_slip: (-0.12, -0.3),
            free_slip: (-0.002, -0.016),
            slip_sigma: 0.02,
            gyro_sigma: 0.003,
            gyro_bias: 0.001,
        }
    }
}

/// Steps of the truth between two rows.
const STEPS: u32 = 20;
/// A wheel enters and leaves the patch over this length, m.
const EDGE_LENGTH_M: f64 = 0.1;

impl FiveWheel {
    /// Generates the run.
    ///
    /// Each wheel's centre goes v_i = v − Ω y_i along its heading; its rim runs v_i/(1 − s) driving and
    /// v_i (1 + s) braking, with s by the ground under the wheel; its counter shows the whole ticks.
    #[must_use]
    pub fn generate(&self) -> Run {
        let mut noise = Noise::new(self.seed);
        let mut wander = [Wander::default(); WHEELS];
        let step = 1.0 / f64::from(self.rate * STEPS);
        let duration: f64 = self.legs.iter().map(|leg| leg.seconds).sum();
        let mut run = Run {
            rows: Vec::new(),
            truth: Vec::new(),
        };
        let (mut way, mut rim) = ([0.0; WHEELS], [0.0; WHEELS]);
        let mut along = 0.0;
        for row in 0_u32.. {
            let time = f64::from(row) / f64::from(self.rate);
            if time > duration {
                break;
            }
            let now = command(&self.legs, time);
            let place: [f64; WHEELS] = self.wheels.map(|wheel| along + wheel.x);
            for one in &mut wander {
                one.step(&mut noise, 2.0 / f64::from(self.rate), self.slip_sigma);
            }
            let slips: [f64; WHEELS] =
                std::array::from_fn(|i| self.slip(i, place[i], now, wander[i]));
            self.record(&mut run, row, now, &mut noise, (&way, &rim, &slips));
            for sub in 0..STEPS {
                let middle = time + (f64::from(sub) + 0.5) * step;
                let now = command(&self.legs, middle);
                for (index, wheel) in self.wheels.iter().enumerate() {
                    let speed = now.speed - now.yaw_rate * wheel.y;
                    let place = along + wheel.x;
                    let slip = self.slip(index, place, now, wander[index]);
                    let rim_speed = if slip >= 0.0 {
                        speed / (1.0 - slip)
                    } else {
                        speed * (1.0 + slip)
                    };
                    way[index] += speed * step;
                    rim[index] += rim_speed * step;
                }
                along += now.speed * step;
            }
        }
        run
    }

    fn slip(&self, index: usize, place: f64, now: Command, wander: Wander) -> f64 {
        let soft = ramp((place - self.patch.0) / EDGE_LENGTH_M)
            * ramp((self.patch.1 - place) / EDGE_LENGTH_M);
        let between = |(firm, patch): (f64, f64)| firm + soft * (patch - firm);
        if self.wheels[index].free {
            return between(self.free_slip);
        }
        let mean = if now.brakes {
            between(self.brake_slip)
        } else {
            between(self.drive_slip)
        };
        (mean + wander.value()).clamp(-0.95, 0.95)
    }

    fn record(
        &self,
        run: &mut Run,
        row: u32,
        now: Command,
        noise: &mut Noise,
        (way, rim, slips): (&[f64; WHEELS], &[f64; WHEELS], &[f64; WHEELS]),
    ) {
        let time_ms = u64::from(row) * 1000 / u64::from(self.rate);
        let counts = std::array::from_fn(|i| {
            let wheel = &self.wheels[i];
            let turned = (rim[i] / (TAU * wheel.radius) * wheel.ticks).floor();
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a counter of 16 bits keeps the low ones"
            )]
            let shown = (wheel.count_at_start + turned as i64) as u16;
            shown
        });
        let gyro = now.yaw_rate + self.gyro_bias + self.gyro_sigma * noise.normal();
        run.rows.push(Row {
            time_ms,
            counts,
            yaw_rate: (gyro * 1e4).round() / 1e4,
        });
        let moving = |i: usize| (now.speed - now.yaw_rate * self.wheels[i].y).abs() > 1e-9;
        run.truth.push(Truth {
            time_ms,
            speed: now.speed,
            yaw_rate: now.yaw_rate,
            way: *way,
            rim: *rim,
            slip: std::array::from_fn(|i| moving(i).then_some(slips[i])),
        });
    }
}

fn ramp(x: f64) -> f64 {
    x.clamp(0.0, 1.0)
}

impl Run {
    /// The log as CSV.
    #[must_use]
    pub fn log_csv(&self) -> String {
        let mut out = String::from("time_ms");
        for name in NAMES {
            // Writing to a String cannot fail.
            let _ = write!(out, ",{name}_ticks");
        }
        out.push_str(",gyro_z_rad_per_s\n");
        for row in &self.rows {
            let _ = write!(out, "{}", row.time_ms);
            for count in row.counts {
                let _ = write!(out, ",{count}");
            }
            let _ = writeln!(out, ",{:.4}", row.yaw_rate);
        }
        out
    }

    /// The log as an MCAP file of ROS 2 messages: counters by wheel, and the gyro as an IMU whose z axis
    /// points up. It begins at [`START_NS`].
    ///
    /// # Errors
    /// None for a run that [`FiveWheel::generate`] made.
    pub fn log_mcap(&self) -> io::Result<Vec<u8>> {
        let mut writer = SampleWriter::new(Vec::new(), &NAMES.map(str::to_owned))?;
        for row in &self.rows {
            let time_ns = START_NS + i64::try_from(row.time_ms).unwrap_or(0) * 1_000_000;
            let mut write = |measurement| {
                writer.sample(&Sample {
                    time_ns,
                    measurement,
                })
            };
            for (wheel, count) in row.counts.into_iter().enumerate() {
                let raw = u64::from(count);
                write(Measurement::WheelCount { wheel, raw })?;
            }
            write(Measurement::YawRate { rate: row.yaw_rate })?;
        }
        Ok(writer.finish()?.0)
    }

    /// The truth as CSV, every fifth row.
    #[must_use]
    pub fn truth_csv(&self) -> String {
        let mut out = String::from("time_ms,speed_m_per_s,yaw_rate_rad_per_s");
        for name in NAMES {
            let _ = write!(out, ",{name}_slip");
        }
        out.push('\n');
        for truth in self.truth.iter().step_by(5) {
            let _ = write!(
                out,
                "{},{:.5},{:.5}",
                truth.time_ms, truth.speed, truth.yaw_rate
            );
            for slip in truth.slip {
                match slip {
                    Some(slip) => {
                        let _ = write!(out, ",{slip:.4}");
                    }
                    None => out.push(','),
                }
            }
            out.push('\n');
        }
        out
    }
}
