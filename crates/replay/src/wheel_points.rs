//! Where wheels touched the ground, and how they slipped there, as `sensor_msgs/PointCloud2`.
//!
//! Rerun draws point clouds and no markers; Foxglove, Lichtblick and `RViz` draw both.

use grouser_log::message::{Value, build};
use grouser_real::Real;

use crate::markers::slip_colour;

/// A message has the points of this time, ns.
const PIECE_NS: i64 = 1_000_000_000;
/// A point is this far from the last one of its wheel at least, m.
const MIN_STEP_M: f64 = 0.02;
/// The fields of a point, all of four bytes, with their types in `sensor_msgs/PointField`.
const FIELDS: [(&str, u64); 5] = [
    ("x", FLOAT32),
    ("y", FLOAT32),
    ("z", FLOAT32),
    ("slip", FLOAT32),
    ("colour", UINT32),
];
const UINT32: u64 = 6;
const FLOAT32: u64 = 7;
/// Bytes of a point.
const POINT_BYTES: usize = 4 * FIELDS.len();

/// The lowest points of the wheels, one message a second: x, y and z in m, the slip (NaN without one), and its colour as
/// 0xRRGGBBAA.
///
/// ```
/// use grouser_log::message::{Value, build};
/// use grouser_replay::messages::WheelPoints;
///
/// let mut points = WheelPoints::new(1);
/// let mut clouds = Vec::new();
/// for step in 0..=20_i32 {
///     let time_ns = i64::from(step) * 100_000_000;
///     points.add(0, [0.05 * f64::from(step), 0.0, -0.03], Some(0.3));
///     clouds.extend(points.piece(time_ns, || build::header(time_ns, "map")));
/// }
/// assert_eq!(clouds.len(), 2); // one for each second
/// assert_eq!(clouds[0].number_at("width"), Some(11.0));
/// ```
#[derive(Clone, Debug)]
pub struct WheelPoints {
    /// The last point of each wheel.
    last: Vec<Option<[f64; 3]>>,
    began_ns: Option<i64>,
    data: Vec<u8>,
}

impl WheelPoints {
    /// For a number of wheels.
    #[must_use]
    pub fn new(wheels: usize) -> Self {
        Self {
            last: vec![None; wheels],
            began_ns: None,
            data: Vec::new(),
        }
    }

    /// The next place of a wheel's lowest point, m, and its slip.
    pub fn add(&mut self, wheel: usize, bottom: [f64; 3], slip: Option<f64>) {
        let Some(last) = self.last.get_mut(wheel) else {
            return;
        };
        let is_near = last
            .is_some_and(|last| Real::hypot(bottom[0] - last[0], bottom[1] - last[1]) < MIN_STEP_M);
        if is_near {
            return;
        }
        *last = Some(bottom);
        let [x, y, z] = bottom;
        for value in [x, y, z, slip.unwrap_or(f64::NAN)] {
            #[allow(clippy::cast_possible_truncation, reason = "places to draw")]
            self.data.extend((value as f32).to_le_bytes());
        }
        let [r, g, b] = slip_colour(slip.map(f64::abs)).map(byte);
        self.data.extend([0xff, b, g, r]);
    }

    /// The points since the last message, once they are of a second. `header` has the frame of the places.
    pub fn piece(&mut self, time_ns: i64, header: impl FnOnce() -> Value) -> Option<Value> {
        let began = *self.began_ns.get_or_insert(time_ns);
        if time_ns.saturating_sub(began) < PIECE_NS || self.data.is_empty() {
            return None;
        }
        self.began_ns = Some(time_ns);
        let data = std::mem::take(&mut self.data);
        let size = |bytes: usize| Value::UInt(bytes as u64);
        let field = |(i, (name, kind)): (usize, (&str, u64))| {
            build::message([
                ("name", Value::Text(name.into())),
                ("offset", size(4 * i)),
                ("datatype", Value::UInt(kind)),
                ("count", Value::UInt(1)),
            ])
        };
        Some(build::message([
            ("header", header()),
            ("height", Value::UInt(1)),
            ("width", size(data.len() / POINT_BYTES)),
            (
                "fields",
                Value::Array(FIELDS.into_iter().enumerate().map(field).collect()),
            ),
            ("is_bigendian", Value::Bool(false)),
            ("point_step", size(POINT_BYTES)),
            ("row_step", size(data.len())),
            ("data", Value::Bytes(data)),
            ("is_dense", Value::Bool(true)),
        ]))
    }
}

/// A share of a colour from 0 to 1 as a byte.
fn byte(share: f64) -> u8 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to 255"
    )]
    let byte = (share.clamp(0.0, 1.0) * 255.0).round() as u8;
    byte
}
