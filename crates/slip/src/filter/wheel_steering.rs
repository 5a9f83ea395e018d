//! How steering moves a wheel: about its own centre, or about the joint of an articulated robot.

use grouser_real::Real;

use crate::robot::Wheel;

/// The steering of one wheel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steering {
    /// Heading at no angle, rad.
    pub(super) heading: f64,
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
    pub(super) fn new(wheel: &Wheel) -> Self {
        let pivot = wheel.steers_about.unwrap_or([wheel.x, wheel.y]);
        Self {
            heading: wheel.heading.rad(),
            pivot,
            arm: [wheel.x - pivot[0], wheel.y - pivot[1]],
            angle: None,
            swung: 0.0,
            from: 0.0,
        }
    }

    /// Turns to `angle` (rad); returns the position of the wheel's centre, m.
    pub(super) fn turn(&mut self, angle: f64) -> [f64; 2] {
        let [ahead, left] = self.arm;
        // Both the arm and the heading turn by the angle: d/dγ of the centre along the heading does not depend on it.
        let (sin, cos) = Real::sin_cos(self.heading);
        let turned = self.angle.replace(angle).map_or(0.0, |last| angle - last);
        self.swung += turned * (ahead * sin - left * cos);
        let (sin, cos) = Real::sin_cos(angle);
        [
            self.pivot[0] + cos * ahead - sin * left,
            self.pivot[1] + sin * ahead + cos * left,
        ]
    }

    /// Has it been steered, by any angle?
    pub(super) const fn is_used(&self) -> bool {
        self.angle.is_some()
    }

    /// Marks the beginning of a window of the wheel.
    pub(super) const fn mark(&mut self) {
        self.from = self.swung;
    }

    /// The way of the centre along its heading by steering in this window, m: the rim rolls it beside the robot's motion.
    pub(super) const fn swung(&self) -> f64 {
        self.swung - self.from
    }
}
