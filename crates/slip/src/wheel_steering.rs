//! How steering moves a wheel: about its own centre, or about the joint of an articulated robot.

use grouser_real::Real;

use crate::robot::Wheel;

/// The steering of one wheel.
#[derive(Clone, Copy, Debug)]
pub struct Steering {
    /// Heading at no angle, rad.
    pub(crate) heading: f64,
    /// The place of its centre, m.
    place: [f64; 2],
    row: [f64; 3],
    /// The point about which it turns, and the wheel's centre from there at no angle, m.
    pivot: [f64; 2],
    arm: [f64; 2],
    /// The last angle, rad.
    angle: Option<f64>,
    /// The way of its centre along its heading by steering alone, m: in all, and at the beginning of the open window.
    swung: f64,
    from: f64,
}

impl Steering {
    /// Of a wheel, at no angle.
    #[must_use]
    pub fn new(wheel: &Wheel) -> Self {
        let pivot = wheel.steers_about.unwrap_or([wheel.x, wheel.y]);
        Self {
            heading: wheel.heading.rad(),
            place: [wheel.x, wheel.y],
            row: wheel.speed_row(),
            pivot,
            arm: [wheel.x - pivot[0], wheel.y - pivot[1]],
            angle: None,
            swung: 0.0,
            from: 0.0,
        }
    }

    /// Turns to `angle` (rad); false where it has stood there already.
    pub fn turn(&mut self, angle: f64) -> bool {
        if self.angle == Some(angle) {
            return false;
        }
        let [ahead, left] = self.arm;
        let last = self.angle.replace(angle);
        let turned = last.map_or(0.0, |last| angle - last);
        self.swung += turned * self.swing();
        let (sin, cos) = Real::sin_cos(angle);
        self.place = [
            self.pivot[0] + cos * ahead - sin * left,
            self.pivot[1] + sin * ahead + cos * left,
        ];
        let (sin, cos) = Real::sin_cos(self.heading + angle);
        self.row = [cos, sin, sin * self.place[0] - cos * self.place[1]];
        true
    }

    /// Way of its centre along its heading for a radian of steering, m. Both the arm and the heading turn by the angle, so that it
    /// does not depend on it.
    #[must_use]
    pub fn swing(&self) -> f64 {
        let [ahead, left] = self.arm;
        let (sin, cos) = Real::sin_cos(self.heading);
        ahead * sin - left * cos
    }

    /// The row of its centre's speed along its heading, e · (v + Ω × p).
    #[must_use]
    pub const fn along(&self) -> [f64; 3] {
        self.row
    }

    /// The row of its centre's speed to the left of its heading, n · (v + Ω × p).
    #[must_use]
    pub fn across(&self) -> [f64; 3] {
        let [cos, sin, _] = self.row;
        [-sin, cos, cos * self.place[0] + sin * self.place[1]]
    }

    /// Marks the beginning of a window of the wheel.
    pub(crate) const fn mark(&mut self) {
        self.from = self.swung;
    }

    /// The way of the centre along its heading by steering in this window, m: the rim rolls it beside the robot's motion.
    pub(crate) const fn swung(&self) -> f64 {
        self.swung - self.from
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grouser_terra::Angle;

    /// Where a wheel's centre is and its heading, by steps of rotation about a point.
    #[test]
    fn a_steered_wheel_is_turned_about_its_point() {
        let joint = [0.3, -0.2];
        let wheel = Wheel::powered("wheel")
            .at(0.9, 0.4)
            .heading(Angle::from_rad(0.5));
        for (wheel, joint) in [
            (wheel.clone().steered_about(joint[0], joint[1]), joint),
            (wheel, [0.9, 0.4]),
        ] {
            let mut steering = Steering::new(&wheel);
            // the first angle is one that it has, not a turn
            let first = 0.3;
            assert!(steering.turn(first));
            assert!(!steering.turn(first));
            assert_eq!(steering.swung, 0.0);
            let centre = |angle: f64| {
                let (sin, cos) = f64::sin_cos(angle);
                let arm = [0.9 - joint[0], 0.4 - joint[1]];
                [
                    joint[0] + arm[0] * cos - arm[1] * sin,
                    joint[1] + arm[0] * sin + arm[1] * cos,
                ]
            };
            // its way along its heading, summed over small steps
            let way = |from: f64, to: f64| -> f64 {
                let step = (to - from) / 1e4;
                let part = |index: u32| {
                    let at = from + step * f64::from(index);
                    let (a, b) = (centre(at), centre(at + step));
                    let heading = 0.5 + at + 0.5 * step;
                    (b[0] - a[0]) * heading.cos() + (b[1] - a[1]) * heading.sin()
                };
                (0..10_000).map(part).sum()
            };
            let mut last = first;
            for angle in [0.8, -0.7, 1.9] {
                steering.mark();
                assert!(steering.turn(angle));
                assert!((steering.swung() - way(last, angle)).abs() < 1e-6);
                assert!((steering.swung - way(first, angle)).abs() < 1e-6);
                last = angle;
                // its speed where the robot moves at 0.4 m/s, 0.1 m/s to the left, and turns at 0.7 rad/s
                let place = centre(angle);
                let speed = [0.4 - 0.7 * place[1], 0.1 + 0.7 * place[0]];
                let (sin, cos) = f64::sin_cos(0.5 + angle);
                let of = |row: [f64; 3]| row[0] * 0.4 + row[1] * 0.1 + row[2] * 0.7;
                let along = speed[0] * cos + speed[1] * sin;
                let across = speed[1] * cos - speed[0] * sin;
                assert!((of(steering.along()) - along).abs() < 1e-12);
                assert!((of(steering.across()) - across).abs() < 1e-12);
            }
        }
    }
}
