//! The robot, its ruts and its way as `visualization_msgs/Marker`, coloured by slip, for viewers of ROS 2.
//!
//! `visualization_msgs` is what Foxglove, Lichtblick and `RViz` all draw without an extension; `foxglove_msgs/SceneUpdate`
//! is drawn by the first two only.

use grouser_log::message::{Value, build};
use grouser_real::Real;
use grouser_slip::WheelEstimate;

use crate::odometry::Odometry;

/// A piece of a line in one marker ends after this time, ns: viewers that follow a run get it at once.
const PIECE_NS: i64 = 1_000_000_000;
/// A point of a line is this far from the last one at least, m.
const MIN_STEP_M: f64 = 0.01;
/// Width of the way's line, m.
const WAY_WIDTH_M: f64 = 0.04;
/// Upper limits of slip and their colours, red, green, blue in [0, 1]; the page uses the same classes.
const COLOURS: [(f64, [f64; 3]); 6] = [
    (0.05, [0.80, 0.73, 0.54]),
    (0.1, [0.86, 0.64, 0.29]),
    (0.2, [0.85, 0.48, 0.16]),
    (0.35, [0.74, 0.31, 0.12]),
    (0.6, [0.56, 0.14, 0.09]),
    (f64::INFINITY, [0.30, 0.06, 0.11]),
];
/// Where no wheel has a slip.
const UNKNOWN: [f64; 3] = [0.6, 0.6, 0.6];
/// The robot's body.
const BODY: [f64; 3] = [0.35, 0.40, 0.45];
/// A rut without depth, and one of [`DARKEST_RUT_M`].
const RUTS: [[f64; 3]; 2] = [[0.72, 0.64, 0.50], [0.22, 0.16, 0.11]];
/// A rut of this depth is drawn darkest, m.
const DARKEST_RUT_M: f64 = 0.1;
/// Kinds of markers.
const CUBE: i64 = 1;
const CYLINDER: i64 = 3;
const LINE_STRIP: i64 = 4;

/// A line in pieces, each a marker with its own `id`, so that what was sent stays.
#[derive(Clone, Debug)]
struct Trail {
    namespace: String,
    width: f64,
    began_ns: Option<i64>,
    points: Vec<[f64; 3]>,
    colours: Vec<[f64; 3]>,
    sent: i64,
}

impl Trail {
    const fn new(namespace: String, width: f64) -> Self {
        Self {
            namespace,
            width,
            began_ns: None,
            points: Vec::new(),
            colours: Vec::new(),
            sent: 0,
        }
    }

    /// The next point; a marker when a piece is complete.
    fn add(
        &mut self,
        time_ns: i64,
        point: [f64; 3],
        colour: [f64; 3],
        header: impl FnOnce() -> Value,
    ) -> Option<Value> {
        let far = self
            .points
            .last()
            .is_none_or(|last| Real::hypot(point[0] - last[0], point[1] - last[1]) >= MIN_STEP_M);
        if far {
            self.points.push(point);
            self.colours.push(colour);
        }
        let began = *self.began_ns.get_or_insert(time_ns);
        if time_ns.saturating_sub(began) < PIECE_NS || self.points.len() < 2 {
            return None;
        }
        self.began_ns = Some(time_ns);
        let marker = marker(Marker {
            header: header(),
            namespace: &self.namespace,
            id: self.sent,
            kind: LINE_STRIP,
            pose: build::pose(0.0, 0.0, 0.0),
            scale: [self.width, 0.0, 0.0],
            colour: UNKNOWN,
            points: &self.points,
            colours: &self.colours,
        });
        // the next piece begins where this one ends
        self.points.drain(..self.points.len() - 1);
        self.colours.drain(..self.colours.len() - 1);
        self.sent += 1;
        Some(marker)
    }
}

/// The way of the robot, coloured by the greatest slip of its wheels.
#[derive(Clone, Debug)]
pub struct WayMarkers(Trail);

impl Default for WayMarkers {
    fn default() -> Self {
        Self(Trail::new("way".to_owned(), WAY_WIDTH_M))
    }
}

impl WayMarkers {
    /// The next place; a marker when a piece is complete. `header` is that of the marker, with the frame of the odometry.
    pub fn add(
        &mut self,
        time_ns: i64,
        odometry: &Odometry,
        wheels: &[WheelEstimate],
        header: impl FnOnce() -> Value,
    ) -> Option<Value> {
        let [x, y, _] = odometry.pose;
        let slips = wheels.iter().map(|wheel| Some(wheel.slip?.value()));
        self.add_point(time_ns, [x, y, 0.0], slips, header)
    }

    /// As [`WayMarkers::add`], of a place and the slips there.
    pub fn add_point(
        &mut self,
        time_ns: i64,
        point: [f64; 3],
        slips: impl Iterator<Item = Option<f64>>,
        header: impl FnOnce() -> Value,
    ) -> Option<Value> {
        let greatest = slips.flatten().map(f64::abs).reduce(f64::max);
        self.0.add(time_ns, point, slip_colour(greatest), header)
    }
}

/// The ruts of the wheels, the deeper the darker.
///
/// ```
/// use grouser_log::message::build;
/// use grouser_replay::messages::RutMarkers;
///
/// let mut ruts = RutMarkers::new([("left", 0.1)]);
/// let mut markers = Vec::new();
/// for step in 0..=20_i32 {
///     let time_ns = i64::from(step) * 100_000_000;
///     let bottom = [0.02 * f64::from(step), 0.0, -0.03];
///     markers.extend(ruts.add(time_ns, 0, bottom, 0.03, || build::header(time_ns, "map")));
/// }
/// assert_eq!(markers.len(), 2); // one for each second
/// ```
#[derive(Clone, Debug)]
pub struct RutMarkers(Vec<Trail>);

impl RutMarkers {
    /// For wheels by their names and widths, m.
    pub fn new<'a>(wheels: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let trail = |(name, width): (&str, f64)| Trail::new(format!("rut of {name}"), width);
        Self(wheels.into_iter().map(trail).collect())
    }

    /// The next place of a wheel's lowest point, and its sinkage, m; a marker when a piece is complete.
    pub fn add(
        &mut self,
        time_ns: i64,
        wheel: usize,
        bottom: [f64; 3],
        sinkage: f64,
        header: impl FnOnce() -> Value,
    ) -> Option<Value> {
        let share = (sinkage / DARKEST_RUT_M).clamp(0.0, 1.0);
        let [shallow, deep] = RUTS;
        let colour = [0, 1, 2].map(|i| shallow[i] + share * (deep[i] - shallow[i]));
        self.0.get_mut(wheel)?.add(time_ns, bottom, colour, header)
    }
}

/// A wheel in a picture of the robot.
#[derive(Clone, Copy, Debug)]
pub struct DrawnWheel {
    /// Its centre, m.
    pub centre: [f64; 3],
    /// The direction in which it drives, rad from x towards y.
    pub heading: f64,
    /// m.
    pub radius: f64,
    /// m.
    pub width: f64,
    /// Its slip, which colours it.
    pub slip: Option<f64>,
}

/// `visualization_msgs/MarkerArray` of the robot: a body of the size that its wheels span, and the wheels, coloured by slip.
/// `angles` are roll, pitch and yaw, rad.
///
/// ```
/// use grouser_log::message::build;
/// use grouser_replay::messages::{DrawnWheel, robot_markers};
///
/// let wheel = |y| DrawnWheel { centre: [0.0, y, 0.1], heading: 0.0, radius: 0.1, width: 0.05, slip: Some(0.3) };
/// let array = robot_markers(&build::header(0, "odom"), [0.0; 3], &[wheel(0.2), wheel(-0.2)]);
/// assert_eq!(array.at("markers").unwrap().elements().unwrap().len(), 3);
/// ```
#[must_use]
pub fn robot_markers(header: &Value, angles: [f64; 3], wheels: &[DrawnWheel]) -> Value {
    let one = |namespace, id, kind, pose, scale, colour| {
        marker(Marker {
            header: header.clone(),
            namespace,
            id,
            kind,
            pose,
            scale,
            colour,
            points: &[],
            colours: &[],
        })
    };
    let (low, high, radius) = extent(angles[2], wheels);
    let (sin, cos) = Real::sin_cos(angles[2]);
    let [ahead, left, up] = [0, 1, 2].map(|i| 0.5 * (low[i] + high[i]));
    let centre = [
        cos * ahead - sin * left,
        sin * ahead + cos * left,
        up + radius,
    ];
    let size = [
        (high[0] - low[0]).max(2.0 * radius),
        (0.7 * (high[1] - low[1])).max(radius),
        radius,
    ];
    let body = one(
        "body",
        0,
        CUBE,
        posed(centre, build::orientation(angles)),
        size,
        BODY,
    );
    let wheels = (0..).zip(wheels).map(|(id, wheel)| {
        let across = 2.0 * wheel.radius;
        one(
            "wheels",
            id,
            CYLINDER,
            posed(wheel.centre, axle(wheel.heading)),
            [across, across, wheel.width],
            slip_colour(wheel.slip.map(f64::abs)),
        )
    });
    let markers = std::iter::once(body).chain(wheels).collect();
    build::message([("markers", Value::Array(markers))])
}

/// The corners that the wheels' centres span along and across `yaw`, and the largest radius.
fn extent(yaw: f64, wheels: &[DrawnWheel]) -> ([f64; 3], [f64; 3], f64) {
    let (sin, cos) = Real::sin_cos(yaw);
    let (mut low, mut high, mut radius) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0_f64);
    for wheel in wheels {
        let [x, y, z] = wheel.centre;
        let along = [cos * x + sin * y, cos * y - sin * x, z];
        for i in 0..3 {
            low[i] = low[i].min(along[i]);
            high[i] = high[i].max(along[i]);
        }
        radius = radius.max(wheel.radius);
    }
    if wheels.is_empty() {
        return ([0.0; 3], [0.0; 3], 0.1);
    }
    (low, high, radius)
}

/// `geometry_msgs/Quaternion` of a cylinder about z that lies along an axle: a turn about x by 90°, then about z.
fn axle(heading: f64) -> Value {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let (sin, cos) = Real::sin_cos(0.5 * heading);
    build::message([
        ("x", Value::Float(half * cos)),
        ("y", Value::Float(half * sin)),
        ("z", Value::Float(half * sin)),
        ("w", Value::Float(half * cos)),
    ])
}

fn posed(place: [f64; 3], orientation: Value) -> Value {
    build::message([
        ("position", build::vector(place)),
        ("orientation", orientation),
    ])
}

/// What differs between markers.
struct Marker<'a> {
    header: Value,
    namespace: &'a str,
    id: i64,
    kind: i64,
    pose: Value,
    scale: [f64; 3],
    colour: [f64; 3],
    points: &'a [[f64; 3]],
    colours: &'a [[f64; 3]],
}

fn marker(marker: Marker<'_>) -> Value {
    let none = || Value::Text(String::new());
    let points = marker.points.iter().copied().map(build::vector);
    build::message([
        ("header", marker.header),
        ("ns", Value::Text(marker.namespace.into())),
        ("id", Value::Int(marker.id)),
        ("type", Value::Int(marker.kind)),
        ("action", Value::Int(0)),
        ("pose", marker.pose),
        ("scale", build::vector(marker.scale)),
        ("color", rgba(marker.colour)),
        (
            "lifetime",
            build::message([("sec", Value::Int(0)), ("nanosec", Value::UInt(0))]),
        ),
        ("frame_locked", Value::Bool(false)),
        ("points", Value::Array(points.collect())),
        (
            "colors",
            Value::Array(marker.colours.iter().copied().map(rgba).collect()),
        ),
        ("texture_resource", none()),
        (
            "texture",
            build::message([
                ("header", build::header(0, "")),
                ("format", none()),
                ("data", Value::Array(Vec::new())),
            ]),
        ),
        ("uv_coordinates", Value::Array(Vec::new())),
        ("text", none()),
        ("mesh_resource", none()),
        (
            "mesh_file",
            build::message([("filename", none()), ("data", Value::Array(Vec::new()))]),
        ),
        ("mesh_use_embedded_materials", Value::Bool(false)),
    ])
}

fn rgba([r, g, b]: [f64; 3]) -> Value {
    build::message([
        ("r", Value::Float(r)),
        ("g", Value::Float(g)),
        ("b", Value::Float(b)),
        ("a", Value::Float(1.0)),
    ])
}

/// The colour of the size of a slip.
pub(crate) fn slip_colour(slip: Option<f64>) -> [f64; 3] {
    slip.map_or(UNKNOWN, |slip| {
        let found = COLOURS.iter().find(|(limit, _)| slip < *limit);
        found.map_or(COLOURS[5].1, |(_, colour)| *colour)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_join_and_have_ids_of_their_own() {
        let mut way = WayMarkers::default();
        let mut odometry = Odometry {
            pose: [0.0; 3],
            pose_covariance: [[0.0; 3]; 3],
            velocity: [0.0; 3],
            velocity_covariance: [[0.0; 3]; 3],
            distance: 0.0,
            distance_of_wheels: 0.0,
        };
        let mut pieces = Vec::new();
        for step in 0..=40 {
            odometry.pose[0] = 0.05 * f64::from(step);
            let time = i64::from(step) * 100_000_000;
            pieces.extend(way.add(time, &odometry, &[], || build::header(time, "odom")));
        }
        assert_eq!(pieces.len(), 4);
        let ids: Vec<_> = pieces.iter().map(|piece| piece.number_at("id")).collect();
        assert_eq!(ids, [0.0, 1.0, 2.0, 3.0].map(Some));
        let x = |piece: usize, point: usize| {
            let points = pieces[piece].at("points").and_then(Value::elements);
            points.unwrap()[point].number_at("x")
        };
        let end = x(0, 10);
        assert_eq!(end, x(1, 0));
        assert!((end.unwrap() - 0.5).abs() < 1e-12);
        // one colour for each point, as viewers require
        for piece in &pieces {
            let count = |name| piece.at(name).unwrap().elements().unwrap().len();
            assert_eq!(count("points"), count("colors"));
        }
    }

    #[test]
    fn a_wheel_lies_along_its_axle_and_the_body_on_the_wheels() {
        let yaw = 0.7_f64;
        let (sin, cos) = Real::sin_cos(yaw);
        let at = |ahead: f64, left: f64| DrawnWheel {
            centre: [
                5.0 + cos * ahead - sin * left,
                2.0 + sin * ahead + cos * left,
                0.15,
            ],
            heading: yaw,
            radius: 0.15,
            width: 0.1,
            slip: None,
        };
        let wheels = [at(0.6, 0.4), at(0.6, -0.4), at(-0.6, 0.4), at(-0.6, -0.4)];
        let array = robot_markers(&build::header(0, "odom"), [0.0, 0.0, yaw], &wheels);
        let number = |path: &str| array.number_at(path).unwrap();
        for (path, expected) in [
            ("markers[0].pose.position.x", 5.0),
            ("markers[0].pose.position.y", 2.0),
            ("markers[0].pose.position.z", 0.3),
            ("markers[0].scale.x", 1.2),
            ("markers[0].scale.y", 0.56),
            ("markers[1].scale.z", 0.1),
        ] {
            assert!((number(path) - expected).abs() < 1e-12, "{path}");
        }
        // the cylinder's axis, z, turned by the quaternion: along the axle, to the left or right of the heading
        let [x, y, z, w] =
            ["x", "y", "z", "w"].map(|name| number(&format!("markers[1].pose.orientation.{name}")));
        let axis = [
            2.0 * (x * z + w * y),
            2.0 * (y * z - w * x),
            1.0 - 2.0 * (x * x + y * y),
        ];
        for (found, expected) in axis.iter().zip([sin, -cos, 0.0]) {
            assert!((found - expected).abs() < 1e-12, "{axis:?}");
        }
    }
}
