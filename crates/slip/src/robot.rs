//! The description of a robot: its wheels, their places and their encoders.

use alloc::{string::String, vec::Vec};

use grouser_terra::{Angle, Grousers, RigidWheel};

use crate::counter::CounterWidth;
use crate::error::{Error, Result, check_range};

/// The largest number of wheels of a robot.
pub const MAX_WHEELS: usize = 64;

/// The role of a wheel: powered by a motor or rolling freely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WheelRole {
    /// A motor turns it.
    Powered,
    /// It rolls freely (a "fifth wheel", dead wheel or odometry pod).
    Free,
}

/// Which shaft carries the wheel's sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shaft {
    /// The wheel's own.
    Wheel,
    /// The motor's, before the gear.
    Motor,
}

/// The sensor of a wheel's rotation. The default sits on the wheel's own shaft and has a 64-bit counter, but no ticks: it
/// gives angles or rates.
///
/// ```
/// use grouser_slip::{Encoder, Wheel};
///
/// let encoder = Encoder::counting(500).on_motor(20.0).reversed();
/// let wheel = Wheel::powered("left").radius(0.1).encoder(encoder);
/// // 10 000 ticks per turn of the wheel, counted down
/// let way = wheel.travel_per_tick().unwrap() * -10_000.0;
/// assert!((way - 0.1 * std::f64::consts::TAU).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Encoder {
    /// Which shaft it sits on.
    pub shaft: Shaft,
    /// Motor turns per wheel turn (1 without a gear).
    pub gear: f64,
    /// Ticks per turn of its shaft; `None` where it gives angles or rates without ticks.
    pub ticks_per_turn: Option<f64>,
    /// The width of its counter.
    pub counter: CounterWidth,
    /// Does it count down when the wheel drives the robot along its heading?
    pub reversed: bool,
    /// The step of its rate readings, rad/s of its shaft; 0 where they are continuous.
    pub rate_step: f64,
}

impl Default for Encoder {
    fn default() -> Self {
        Self {
            shaft: Shaft::Wheel,
            gear: 1.0,
            ticks_per_turn: None,
            counter: CounterWidth::MAX,
            reversed: false,
            rate_step: 0.0,
        }
    }
}

impl Encoder {
    /// An encoder on the wheel's own shaft that counts `ticks` a turn with a 64-bit counter.
    #[must_use]
    pub fn counting(ticks: impl Into<f64>) -> Self {
        Self {
            ticks_per_turn: Some(ticks.into()),
            ..Self::default()
        }
    }

    /// The same encoder on the motor's shaft, which turns `gear` times per wheel turn.
    #[must_use]
    pub const fn on_motor(self, gear: f64) -> Self {
        Self {
            shaft: Shaft::Motor,
            gear,
            ..self
        }
    }

    /// The same encoder with a counter of another width.
    #[must_use]
    pub const fn counter(self, counter: CounterWidth) -> Self {
        Self { counter, ..self }
    }

    /// The same encoder, counting down when the wheel drives the robot along its heading.
    #[must_use]
    pub const fn reversed(self) -> Self {
        Self {
            reversed: true,
            ..self
        }
    }

    /// The same encoder with rate readings in steps of `step` (rad/s of its shaft).
    #[must_use]
    pub const fn rate_step(self, step: f64) -> Self {
        Self {
            rate_step: step,
            ..self
        }
    }
}

/// One wheel, with x forwards and y to the left of the robot's origin.
///
/// [`Wheel::powered`] and [`Wheel::free`] begin a description; [`Robot::new`] checks it.
///
/// ```
/// use grouser_slip::{Robot, Wheel};
///
/// let robot = Robot::new(
///     "bicycle".into(),
///     vec![
///         Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000),
///         Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
///     ],
/// )?;
/// assert_eq!(robot.wheel_index("fifth"), Some(1));
/// # Ok::<(), grouser_slip::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Wheel {
    /// Its name in tables and files.
    pub name: String,
    /// Position of its centre, forwards, m.
    pub x: f64,
    /// Position of its centre, to the left, m.
    pub y: f64,
    /// The direction in which it drives, from x towards y.
    pub heading: Angle,
    /// The point about which it is steered, forwards and to the left, m: the joint of an articulated robot, which moves the
    /// wheel beside turning it. `None`: its own centre.
    pub steers_about: Option<[f64; 2]>,
    /// Effective rolling radius, m.
    pub radius: f64,
    /// Powered by a motor or rolling freely.
    pub role: WheelRole,
    /// What measures its rotation.
    pub encoder: Encoder,
    /// Width, m; the soil model needs it.
    pub width: Option<f64>,
    /// Load that it carries, N; the soil model needs it.
    pub load: Option<f64>,
    /// Lugs across its rim, for the soil model.
    pub grousers: Option<Grousers>,
}

impl Wheel {
    /// A wheel that a motor turns; its place is the robot's origin and its radius 0.1 m until they are set.
    #[must_use]
    pub fn powered(name: impl Into<String>) -> Self {
        Self::new(name.into(), WheelRole::Powered)
    }

    /// A wheel that rolls freely; its place is the robot's origin and its radius 0.1 m until they are set.
    #[must_use]
    pub fn free(name: impl Into<String>) -> Self {
        Self::new(name.into(), WheelRole::Free)
    }

    fn new(name: String, role: WheelRole) -> Self {
        Self {
            name,
            x: 0.0,
            y: 0.0,
            heading: Angle::from_rad(0.0),
            steers_about: None,
            radius: 0.1,
            role,
            encoder: Encoder::default(),
            width: None,
            load: None,
            grousers: None,
        }
    }

    /// The wheel as the soil model takes it, with `width` in m.
    ///
    /// # Errors
    /// As [`RigidWheel::new`] and [`RigidWheel::with_grousers`].
    pub fn rigid(&self, width: f64) -> grouser_terra::Result<RigidWheel> {
        let bare = RigidWheel::new(self.radius, width)?;
        self.grousers
            .map_or(Ok(bare), |grousers| bare.with_grousers(grousers))
    }

    /// The same wheel with its centre at `x` (forwards) and `y` (to the left), m.
    #[must_use]
    pub fn at(self, x: f64, y: f64) -> Self {
        Self { x, y, ..self }
    }

    /// The same wheel driving along `heading`.
    #[must_use]
    pub fn heading(self, heading: Angle) -> Self {
        Self { heading, ..self }
    }

    /// The same wheel steered about the point `x` (forwards) and `y` (to the left), m, instead of its own centre.
    #[must_use]
    pub fn steered_about(self, x: f64, y: f64) -> Self {
        Self {
            steers_about: Some([x, y]),
            ..self
        }
    }

    /// The same wheel with an effective rolling radius, m.
    #[must_use]
    pub fn radius(self, radius: f64) -> Self {
        Self { radius, ..self }
    }

    /// The same wheel with ticks per turn of its sensor's shaft.
    #[must_use]
    pub fn ticks_per_turn(mut self, ticks: impl Into<f64>) -> Self {
        self.encoder.ticks_per_turn = Some(ticks.into());
        self
    }

    /// The same wheel with another encoder.
    #[must_use]
    pub fn encoder(self, encoder: Encoder) -> Self {
        Self { encoder, ..self }
    }

    /// The same wheel with a width, m.
    #[must_use]
    pub fn width(self, width: f64) -> Self {
        Self {
            width: Some(width),
            ..self
        }
    }

    /// The same wheel under a load, N.
    #[must_use]
    pub fn load(self, load: f64) -> Self {
        Self {
            load: Some(load),
            ..self
        }
    }

    fn check(&self) -> Result<()> {
        let (of, e) = (self.name.as_str(), &self.encoder);
        check_range(of, "x", self.x, (-100.0, 100.0), "m")?;
        check_range(of, "y", self.y, (-100.0, 100.0), "m")?;
        for (field, place) in ["joint x", "joint y"]
            .into_iter()
            .zip(self.steers_about.iter().flatten())
        {
            check_range(of, field, *place, (-100.0, 100.0), "m")?;
        }
        check_range(of, "heading", self.heading.rad(), (-7.0, 7.0), "rad")?;
        check_range(of, "radius", self.radius, (1e-3, 10.0), "m")?;
        check_range(of, "gear", e.gear, (1e-3, 1e5), "1")?;
        check_range(of, "rate_step", e.rate_step, (0.0, 1e4), "rad/s")?;
        if let Some(ticks) = e.ticks_per_turn {
            check_range(of, "ticks_per_turn", ticks, (1.0, 1e9), "1")?;
        }
        if let Some(width) = self.width {
            check_range(of, "width", width, (1e-3, 10.0), "m")?;
        }
        if let Some(load) = self.load {
            check_range(of, "load", load, (0.0, 1e7), "N")?;
        }
        Ok(())
    }

    /// Rim travel per radian of the sensor's shaft, m/rad, forwards positive.
    ///
    /// ```
    /// use grouser_slip::Wheel;
    ///
    /// assert_eq!(Wheel::free("fifth").radius(0.05).travel_per_radian(), 0.05); // m
    /// ```
    #[must_use]
    pub fn travel_per_radian(&self) -> f64 {
        let size = match self.encoder.shaft {
            Shaft::Wheel => self.radius,
            Shaft::Motor => self.radius / self.encoder.gear,
        };
        if self.encoder.reversed { -size } else { size }
    }

    /// Rim travel per tick, m, forwards positive; `None` without ticks.
    #[must_use]
    pub fn travel_per_tick(&self) -> Option<f64> {
        let ticks = self.encoder.ticks_per_turn?;
        Some(self.travel_per_radian() * core::f64::consts::TAU / ticks)
    }

    /// The row c of v_i = c · (v_x, v_y, Ω): speed of the wheel's centre along its heading,
    /// e_i · (v_body + Ω × p_i).
    ///
    /// ```
    /// use grouser_slip::Wheel;
    ///
    /// assert_eq!(Wheel::powered("left").at(0.2, 0.25).speed_row(), [1.0, 0.0, -0.25]);
    /// ```
    #[must_use]
    pub fn speed_row(&self) -> [f64; 3] {
        let (e_x, e_y) = (self.heading.cos(), self.heading.sin());
        [e_x, e_y, e_y * self.x - e_x * self.y]
    }
}

/// A robot with any number of wheels up to [`MAX_WHEELS`], checked.
///
/// ```
/// use grouser_slip::{Error, Robot, Wheel};
///
/// let robot = Robot::new("cart".into(), vec![Wheel::powered("left"), Wheel::powered("right")])?;
/// assert_eq!(robot.wheel_index("right"), Some(1));
/// let twice = Robot::new("cart".into(), vec![Wheel::powered("left"), Wheel::free("left")]);
/// assert!(matches!(twice, Err(Error::WheelName { .. })));
/// # Ok::<(), Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    name: String,
    wheels: Vec<Wheel>,
}

impl Robot {
    /// A robot of these wheels.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a wheel's number outside its limits, [`Error::WheelName`] for a name
    /// that is empty or used twice, [`Error::WheelCount`] for none or too many.
    pub fn new(name: String, wheels: Vec<Wheel>) -> Result<Self> {
        if wheels.is_empty() || wheels.len() > MAX_WHEELS {
            return Err(Error::WheelCount {
                count: wheels.len(),
                limit: MAX_WHEELS,
            });
        }
        for (index, wheel) in wheels.iter().enumerate() {
            if wheel.name.is_empty() || wheels[..index].iter().any(|w| w.name == wheel.name) {
                return Err(Error::WheelName {
                    name: wheel.name.clone(),
                });
            }
            wheel.check()?;
        }
        Ok(Self { name, wheels })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its wheels, in the order of its description.
    #[must_use]
    pub fn wheels(&self) -> &[Wheel] {
        &self.wheels
    }

    /// The index of the wheel of that name.
    #[must_use]
    pub fn wheel_index(&self, name: &str) -> Option<usize> {
        self.wheels.iter().position(|wheel| wheel.name == name)
    }
}
