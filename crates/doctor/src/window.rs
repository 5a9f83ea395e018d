//! Means over a window of steps.

/// What the sensors showed over a window.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    pub(crate) seconds: f64,
    distance: f64,
    /// Turn by the gyro, rad; NaN where it is not known all the time.
    turn: f64,
    /// Distance of each wheel, m; NaN likewise.
    wheels: Vec<f64>,
}

impl Window {
    pub(crate) fn new(wheels: usize) -> Self {
        Self {
            seconds: 0.0,
            distance: 0.0,
            turn: 0.0,
            wheels: vec![0.0; wheels],
        }
    }

    pub(crate) fn add(&mut self, dt: f64, speed: f64, turn: Option<f64>, wheels: &[Option<f64>]) {
        self.seconds += dt;
        self.distance += speed * dt;
        self.turn += turn.unwrap_or(f64::NAN);
        for (sum, speed) in self.wheels.iter_mut().zip(wheels) {
            *sum += speed.unwrap_or(f64::NAN) * dt;
        }
    }

    /// Sets all sums to zero.
    pub(crate) fn clear(&mut self) {
        (self.seconds, self.distance, self.turn) = (0.0, 0.0, 0.0);
        self.wheels.fill(0.0);
    }

    /// Mean speed of the powered wheels, m/s.
    pub(crate) fn speed(&self) -> f64 {
        self.distance / self.seconds
    }

    /// Mean yaw rate by the gyro, rad/s.
    pub(crate) fn yaw_rate(&self) -> f64 {
        self.turn / self.seconds
    }

    /// Mean speed of each wheel, m/s.
    pub(crate) fn speeds(&self) -> impl Iterator<Item = f64> + Clone {
        self.wheels.iter().map(|distance| distance / self.seconds)
    }
}
