//! How steering moves a wheel: about its own centre, or about the joint of an articulated robot.

use grouser_real::Real;

use crate::robot::Wheel;

/// The steering of one wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steering {
    /// Heading at no angle, rad.
    pub(crate) heading: f64,
    /// The place of its centre, m.
    place: [f64; 2],
    row: [f64; 3],
    /// The point about which it turns, and the wheel's centre from there at no angle, m.
    pivot: [f64; 2],
    arm: [f64; 2],
    /// The last angle, rad, and whether it was ever another one.
    angle: Option<f64>,
    has_turned: bool,
    /// The way of its centre along its heading by steering alone, m: in all, and at the beginning of the open window.
    swung: f64,
    from: f64,
}

impl Steering {
    pub(crate) fn new(wheel: &Wheel) -> Self {
        let pivot = wheel.steers_about.unwrap_or([wheel.x, wheel.y]);
        Self {
            heading: wheel.heading.rad(),
            place: [wheel.x, wheel.y],
            row: wheel.speed_row(),
            pivot,
            arm: [wheel.x - pivot[0], wheel.y - pivot[1]],
            angle: None,
            has_turned: false,
            swung: 0.0,
            from: 0.0,
        }
    }

    /// Turns to `angle` (rad); false where it has stood there already.
    pub(crate) fn turn(&mut self, angle: f64) -> bool {
        if self.angle == Some(angle) {
            return false;
        }
        let [ahead, left] = self.arm;
        // Both the arm and the heading turn by the angle: d/dγ of the centre along the heading does not depend on it.
        let (sin, cos) = Real::sin_cos(self.heading);
        let last = self.angle.replace(angle);
        self.has_turned |= last.is_some();
        let turned = last.map_or(0.0, |last| angle - last);
        self.swung += turned * (ahead * sin - left * cos);
        let (sin, cos) = Real::sin_cos(angle);
        self.place = [
            self.pivot[0] + cos * ahead - sin * left,
            self.pivot[1] + sin * ahead + cos * left,
        ];
        let (sin, cos) = Real::sin_cos(self.heading + angle);
        self.row = [cos, sin, sin * self.place[0] - cos * self.place[1]];
        true
    }

    /// The row of its centre's speed along its heading, e · (v + Ω × p).
    pub(crate) const fn along(&self) -> [f64; 3] {
        self.row
    }

    /// The row of its centre's speed to the left of its heading, n · (v + Ω × p).
    pub(crate) fn across(&self) -> [f64; 3] {
        let [cos, sin, _] = self.row;
        [-sin, cos, cos * self.place[0] + sin * self.place[1]]
    }

    /// Has it been steered, by any angle?
    pub(crate) const fn is_used(&self) -> bool {
        self.angle.is_some()
    }

    /// Has its angle changed?
    pub(crate) const fn has_turned(&self) -> bool {
        self.has_turned
    }

    /// The way of its centre along its heading by steering alone so far, m.
    pub(crate) const fn swung_in_all(&self) -> f64 {
        self.swung
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
