//! The way of the robot as `visualization_msgs/Marker`, coloured by slip, for viewers of ROS 2.

use grouser_log::message::{Value, build};
use grouser_slip::WheelEstimate;

use crate::odometry::Odometry;

/// A piece of way in one marker ends after this time, ns: viewers that follow a run get it at once.
const PIECE_NS: i64 = 1_000_000_000;
/// A point of the way is this far from the last one at least, m.
const MIN_STEP_M: f64 = 0.01;
/// Width of the line, m.
const WIDTH_M: f64 = 0.04;
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

/// The way in pieces, each a marker with its own `id`, so that what was sent stays.
#[derive(Clone, Debug, Default)]
pub struct WayMarkers {
    began_ns: Option<i64>,
    points: Vec<[f64; 2]>,
    colours: Vec<[f64; 3]>,
    sent: i64,
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
        let place = [odometry.pose[0], odometry.pose[1]];
        let far = self
            .points
            .last()
            .is_none_or(|last| (place[0] - last[0]).hypot(place[1] - last[1]) >= MIN_STEP_M);
        if far {
            self.points.push(place);
            self.colours.push(colour(wheels));
        }
        let began = *self.began_ns.get_or_insert(time_ns);
        if time_ns.saturating_sub(began) < PIECE_NS || self.points.len() < 2 {
            return None;
        }
        self.began_ns = Some(time_ns);
        let marker = self.marker(header());
        // the next piece begins where this one ends
        self.points.drain(..self.points.len() - 1);
        self.colours.drain(..self.colours.len() - 1);
        self.sent += 1;
        Some(marker)
    }

    fn marker(&self, header: Value) -> Value {
        let none = || Value::Text(String::new());
        let points = self
            .points
            .iter()
            .map(|[x, y]| build::vector([*x, *y, 0.0]));
        build::message([
            ("header", header),
            ("ns", Value::Text("way".into())),
            ("id", Value::Int(self.sent)),
            ("type", Value::Int(4)), // LINE_STRIP
            ("action", Value::Int(0)),
            ("pose", build::pose(0.0, 0.0, 0.0)),
            ("scale", build::vector([WIDTH_M, 0.0, 0.0])),
            ("color", rgba(UNKNOWN)),
            (
                "lifetime",
                build::message([("sec", Value::Int(0)), ("nanosec", Value::UInt(0))]),
            ),
            ("frame_locked", Value::Bool(false)),
            ("points", Value::Array(points.collect())),
            (
                "colors",
                Value::Array(self.colours.iter().copied().map(rgba).collect()),
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
}

fn rgba([r, g, b]: [f64; 3]) -> Value {
    build::message([
        ("r", Value::Float(r)),
        ("g", Value::Float(g)),
        ("b", Value::Float(b)),
        ("a", Value::Float(1.0)),
    ])
}

/// The colour of the greatest slip of the wheels.
fn colour(wheels: &[WheelEstimate]) -> [f64; 3] {
    let slips = wheels
        .iter()
        .filter_map(|wheel| Some(wheel.slip?.value().abs()));
    let greatest = slips.fold(None, |most: Option<f64>, slip| {
        Some(most.map_or(slip, |most| most.max(slip)))
    });
    greatest.map_or(UNKNOWN, |slip| {
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
}
