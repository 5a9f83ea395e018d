//! What was found over a log.

use grouser_slip::Reference;

use crate::axes::AxisCheck;
use crate::exchange::ExchangeCheck;
use crate::mistake::Mistake;
use crate::pose::PoseCheck;
use crate::steering::SteeringFault;
use crate::turns::TurnCheck;

/// What an estimate uses of a log: a mistake in what it leaves alone is none of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Uses {
    /// What measures the robot's motion.
    pub reference: Reference,
    /// Does the reference have a heading? Places alone do not show that the robot begins forwards.
    pub has_heading: bool,
    /// Are accelerations used?
    pub has_acceleration: bool,
}

/// What was found of how the sensors of a log are described.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Findings {
    /// Whether wheels and gyro disagree, and which wheel slips; of a robot with a gyro that turns by the speeds of its sides.
    pub turns: Option<TurnCheck>,
    /// Wheels that show the bends of the other side: their encoders are exchanged. `None` without, and without bends to both
    /// sides.
    pub exchange: Option<ExchangeCheck>,
    /// Whether accelerometer and reference point in the direction in which the wheels drive.
    pub axes: AxisCheck,
    /// Whether the accelerations of the whole log show another scale or sign.
    pub(crate) has_other_acceleration: Option<bool>,
    /// Whether the pose turns as gyro and wheels do, and moves where its yaw points.
    pub pose: PoseCheck,
    /// How far the wheels ran backwards beside a speed over ground that has no sign, m.
    pub speed_without_sign_m: Option<f64>,
    /// Wheels that turn against the reference while others turn with it, bit by bit in the robot's order.
    pub reversed: Option<u64>,
    /// How the angle of the steering disagrees with the robot's turns.
    pub steering: Option<SteeringFault>,
    pub(crate) uses: Uses,
}

impl Findings {
    /// Paths of the pose that are all far shorter than those of the wheels: another unit, or a robot that is stuck all the time.
    pub(crate) fn small_unit(&self) -> Option<Mistake> {
        self.pose.small_unit().map(Mistake::Pose)
    }

    /// The mistakes in what the estimate uses, the one first that explains others.
    #[must_use]
    pub fn mistakes(&self) -> Vec<Mistake> {
        let (exchange, is_pose) = (
            self.exchange.as_ref(),
            self.uses.reference == Reference::Pose,
        );
        let course = self.pose.course.filter(|_| is_pose);
        let acceleration = (self.axes.acceleration).filter(|_| self.uses.has_acceleration);
        let all = [
            self.speed_without_sign_m.map(Mistake::SpeedWithoutSign),
            exchange.map(|found| Mistake::Exchanged {
                is_certain: found.is_certain,
            }),
            self.pose.fault.filter(|_| is_pose).map(Mistake::Pose),
            (self.pose.gyro_scale)
                .filter(|_| exchange.is_none())
                .map(Mistake::YawRateScale),
            self.steering.map(Mistake::Steering),
            self.reversed.map(Mistake::Reversed),
            self.axes.reference.or(course).map(Mistake::ReferenceTurned),
            acceleration.map(Mistake::AccelerationTurned),
        ];
        all.into_iter().flatten().collect()
    }
}
