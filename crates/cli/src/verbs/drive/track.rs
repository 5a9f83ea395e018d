//! What was seen on the way, for the report.

use grouser_rover::drive::Frame;

/// Frames kept a second: enough for a figure.
const FRAMES_PER_S: f64 = 10.0;
/// Slower than this, rim and centre, a slip is the quotient of two rests and is not shown, m/s.
const MIN_SHOWN_SPEED_M_PER_S: f64 = 0.02;

/// A wheel at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelPoint {
    /// True slip over the estimator's window.
    pub(super) slip: Option<f64>,
    /// The estimate and its standard deviation.
    pub(super) seen: Option<f64>,
    pub(super) sigma: Option<f64>,
    /// N m.
    pub(super) torque: f64,
}

/// A moment.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// s.
    pub(super) time: f64,
    /// m.
    pub(super) place: [f64; 3],
    /// Progress along the legs, m.
    pub(super) distance: f64,
    /// True, estimated and requested forward speed, m/s.
    pub(super) speed: f64,
    pub(super) speed_seen: Option<f64>,
    pub(super) requested_speed: f64,
    /// Electrical, J.
    pub(super) energy: f64,
    pub(super) wheels: Vec<WheelPoint>,
}

/// What was seen of one drive.
#[derive(Clone, Debug, Default)]
pub(super) struct Track {
    pub(super) points: Vec<Point>,
}

impl Track {
    /// One frame more, if it is due.
    pub(super) fn add(&mut self, frame: &Frame<'_>) {
        let due = self
            .points
            .last()
            .is_none_or(|last| frame.time - last.time >= 1.0 / FRAMES_PER_S - 1e-9);
        if !due {
            return;
        }
        let wheels = frame.wheels.iter().map(|wheel| {
            let fastest = wheel.speeds[0].abs().max(wheel.speeds[1].abs());
            WheelPoint {
                slip: wheel.slip.filter(|_| fastest >= MIN_SHOWN_SPEED_M_PER_S),
                seen: wheel.observation.slip,
                sigma: wheel.observation.sigma,
                torque: wheel.torque,
            }
        });
        self.points.push(Point {
            time: frame.time,
            place: frame.place,
            distance: frame.distance,
            speed: frame.speed,
            speed_seen: frame.estimated_speed,
            requested_speed: frame.requested_speed,
            energy: frame.energy,
            wheels: wheels.collect(),
        });
    }

    /// When it ends, s.
    pub(super) fn end(&self) -> f64 {
        self.points.last().map_or(1.0, |point| point.time.max(1.0))
    }

    /// A line of a value; NaN breaks it where there is none.
    pub(super) fn line(&self, of: impl Fn(&Point) -> Option<f64>) -> Vec<[f64; 2]> {
        let value = |point: &Point| of(point).unwrap_or(f64::NAN);
        self.points
            .iter()
            .map(|point| [point.time, value(point)])
            .collect()
    }

    /// The stretches over which two values exist, each with its lower and upper edge.
    pub(super) fn bands(&self, of: impl Fn(&Point) -> Option<[f64; 2]>) -> Vec<[Vec<[f64; 2]>; 2]> {
        let groups = self
            .points
            .chunk_by(|a, b| of(a).is_some() == of(b).is_some());
        groups
            .filter(|group| group.len() > 1 && of(&group[0]).is_some())
            .map(|group| {
                [0, 1].map(|edge| {
                    let place = |point: &Point| Some([point.time, of(point)?[edge]]);
                    group.iter().filter_map(place).collect()
                })
            })
            .collect()
    }
}
