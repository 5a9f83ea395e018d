//! What a topic is used for, and the measurements that its messages hold.

use grouser_real::Real;
use grouser_slip::Measurement;

use super::mounting::{Base, dot};
use crate::message::{NavSatFix, Trust, Value, View};
use crate::orientation::yaw;
use crate::slots::Slots;

/// What a topic is used for.
#[derive(Clone, Debug)]
pub(crate) enum Job {
    /// Angles, rates or counts of wheels: each joint's name and its wheel.
    Joints(Vec<(String, usize)>),
    /// Angles of the suspension: each joint's name, its number and its sense.
    Suspension(Vec<(String, usize, f64)>),
    /// Specific force and angular rate along these directions: forwards, to the left, up.
    Inertial([[f64; 3]; 3]),
    /// Sinkages, entry angles and encoder edges of wheels, likewise.
    Contacts(Vec<(String, usize)>),
    /// The yaw rate about this direction.
    YawRate([f64; 3]),
    /// The acceleration along these directions, forwards and to the left.
    Acceleration([[f64; 3]; 2]),
    /// A pose, of the robot or of a sensor that is mounted on it.
    Pose(Option<Base>),
    /// Transforms, by which [`Intake`](super::Intake) follows the robot's pose.
    Transforms,
    /// A speed over ground, of the robot or of a sensor that is mounted on it.
    Speed(Option<Base>),
    /// A speed over ground to the east and north, whose size is the robot's speed.
    SpeedOnEarth,
    /// Fixes of a satellite receiver, whose motion [`Intake`](super::Intake) follows; the largest standard deviation that is
    /// used, m.
    Fix(f64),
    /// Places without a heading, whose motion it follows likewise.
    Place,
    /// A way since the last message.
    Displacement,
    /// A commanded speed.
    Command,
    /// Wheels by an odometry that was made of them.
    WheelOdometry(Vec<(usize, f64, f64)>),
    /// Numbers by their paths.
    Fields(Slots, Vec<String>),
}

impl Job {
    /// Are its poses places without a heading?
    pub(crate) fn gives_places(&self) -> bool {
        match self {
            Job::Place => true,
            Job::Fields(slots, _) => slots.gives_places(),
            _ => false,
        }
    }

    /// Gives every measurement of a message to `push`; `fix` makes places of fixes that are numbers.
    #[allow(clippy::too_many_lines, reason = "one arm a meaning")]
    pub(crate) fn measurements(
        &self,
        view: Option<&View<'_>>,
        value: &Value,
        fix: &mut dyn FnMut(NavSatFix) -> Option<Measurement>,
        push: &mut dyn FnMut(Measurement),
    ) {
        let usable = |trust: &[Trust]| trust.iter().all(|trust| trust.is_usable());
        match (self, view) {
            (Job::Joints(joints), Some(view)) => wheel_readings(joints, view, push),
            (Job::Suspension(joints), Some(View::JointState(state))) => {
                for (place, name) in state.names.iter().enumerate() {
                    let known = joints.iter().find(|(own, ..)| own == name);
                    if let (Some(&(_, joint, sign)), Some(angle)) =
                        (known, state.position.get(place))
                    {
                        let angle = sign * angle;
                        push(Measurement::JointAngle { joint, angle });
                    }
                }
            }
            (Job::Inertial(axes), Some(View::Imu(imu))) => {
                if let Some((force, rate)) = imu.acceleration.zip(imu.angular_rate) {
                    push(Measurement::Inertial {
                        force: axes.map(|axis| dot(axis, force)),
                        rate: axes.map(|axis| dot(axis, rate)),
                    });
                }
            }
            (Job::Contacts(joints), Some(View::WheelContacts { names, contacts })) => {
                for (name, [sinkage, entry_angle, edge]) in names.iter().zip(contacts.iter()) {
                    let Some(&(_, wheel)) = joints.iter().find(|(joint, _)| joint == name) else {
                        continue;
                    };
                    if let Some(depth) = sinkage {
                        push(Measurement::Sinkage { wheel, depth });
                    }
                    if let Some(angle) = entry_angle {
                        push(Measurement::EntryAngle { wheel, angle });
                    }
                    if let Some(direction) = edge {
                        let forward = direction > 0.0;
                        push(Measurement::WheelEdge { wheel, forward });
                    }
                }
            }
            (Job::YawRate(up), Some(View::Imu(imu))) => {
                let trusted = imu.angular_rate_trust.iter().zip(up);
                let usable = trusted
                    .clone()
                    .all(|(trust, u)| u.abs() < 0.1 || *trust != Trust::DoNotUse);
                if let Some(rate) = imu.angular_rate.filter(|_| usable) {
                    push(Measurement::YawRate {
                        rate: dot(*up, rate),
                    });
                }
            }
            (Job::Acceleration([forward, left]), Some(View::Imu(imu))) => {
                if let Some(acceleration) = imu.acceleration {
                    push(Measurement::Acceleration {
                        forward: dot(*forward, acceleration),
                        left: dot(*left, acceleration),
                    });
                }
            }
            (Job::Pose(base), Some(View::Odometry(odometry))) if usable(&odometry.pose_trust) => {
                push_pose(base.as_ref(), odometry.position, odometry.orientation, push);
            }
            (
                Job::Pose(base),
                Some(View::Pose {
                    position,
                    orientation,
                    trust,
                }),
            ) if usable(trust) => push_pose(base.as_ref(), *position, *orientation, push),
            (Job::Place, Some(View::Point([x, y, _]))) => {
                let (x, y) = (*x, *y);
                push(Measurement::Pose { x, y, yaw: 0.0 });
            }
            (Job::Speed(base), Some(View::Odometry(odometry))) => {
                push_speed(base.as_ref(), odometry.linear, odometry.twist_trust, push);
            }
            (Job::Speed(base), Some(View::Twist { linear, trust, .. })) => {
                push_speed(base.as_ref(), *linear, *trust, push);
            }
            (Job::SpeedOnEarth, Some(View::Twist { linear, trust, .. })) if usable(&trust[..2]) => {
                push(Measurement::Speed {
                    forward: Real::hypot(linear[0], linear[1]),
                    left: None,
                });
            }
            (Job::Command, Some(View::Twist { linear, .. })) => push(Measurement::Command {
                forward: linear[0],
                left: linear[1],
            }),
            (
                Job::Displacement,
                Some(View::Displacement {
                    forward,
                    left,
                    turn,
                }),
            ) => push(Measurement::Displacement {
                forward: *forward,
                left: *left,
                turn: *turn,
            }),
            (Job::WheelOdometry(wheels), Some(View::Odometry(odometry))) => {
                let [trust, _, turn_trust] = odometry.twist_trust;
                if usable(&[trust, turn_trust]) {
                    let (speed, turn) = (odometry.linear[0], odometry.angular[2]);
                    for (wheel, per_speed, per_turn) in wheels {
                        push(Measurement::WheelRate {
                            wheel: *wheel,
                            rate: per_speed * speed + per_turn * turn,
                        });
                    }
                }
            }
            (Job::Fields(slots, paths), _) => {
                // numbers of a message are never refused
                let _never = slots.readings(
                    &|part| {
                        let number = value.number_at(&paths[part.column]);
                        Ok(number.map(|number| part.si(number)))
                    },
                    &|part| {
                        let path = &paths[part.column];
                        Ok(value
                            .count_at(path)
                            .or_else(|| whole(value.number_at(path))))
                    },
                    fix,
                    push,
                );
            }
            _ => {}
        }
    }
}

/// The pose of the robot by that of what is mounted on it.
fn push_pose(
    base: Option<&Base>,
    position: [f64; 3],
    orientation: [f64; 4],
    push: &mut dyn FnMut(Measurement),
) {
    let pose = match base {
        Some(base) => base.pose(position, orientation),
        None => yaw(orientation).map(|yaw| [position[0], position[1], yaw]),
    };
    if let Some([x, y, yaw]) = pose {
        push(Measurement::Pose { x, y, yaw });
    }
}

/// The speed along the robot's axes.
fn push_speed(
    base: Option<&Base>,
    linear: [f64; 3],
    trust: [Trust; 3],
    push: &mut dyn FnMut(Measurement),
) {
    let [x, y, _] = trust.map(Trust::is_usable);
    let own = Some([linear[0], linear[1]]);
    let speed = base.map_or(own, |base| base.speed(linear, y));
    if let Some([forward, left]) = speed.filter(|_| x) {
        let left = y.then_some(left);
        push(Measurement::Speed { forward, left });
    }
}

/// A counter that is sent as a number with a point.
#[allow(
    clippy::cast_possible_truncation,
    reason = "whole and below 2^53 in size, as is checked"
)]
fn whole(number: Option<f64>) -> Option<u64> {
    let number = number?;
    (number.fract() == 0.0 && number.abs() < 9_007_199_254_740_992.0)
        .then(|| (number as i64).cast_unsigned())
}

fn wheel_readings(joints: &[(String, usize)], view: &View<'_>, push: &mut dyn FnMut(Measurement)) {
    let names = match view {
        View::JointState(state) => state.names,
        View::WheelTicks { names, .. } => *names,
        _ => return,
    };
    for (place, name) in names.iter().enumerate() {
        let Some(&(_, wheel)) = joints.iter().find(|(joint, _)| joint == name) else {
            continue;
        };
        match view {
            View::JointState(state) => {
                if let Some(angle) = state.position.get(place) {
                    push(Measurement::WheelAngle { wheel, angle });
                }
                if let Some(rate) = state.velocity.get(place) {
                    push(Measurement::WheelRate { wheel, rate });
                }
                // drivers that measure none say NaN
                if let Some(torque) = state.effort.get(place).filter(|e| e.is_finite()) {
                    push(Measurement::WheelTorque { wheel, torque });
                }
            }
            View::WheelTicks { ticks, .. } => {
                if let Some(raw) = ticks.get(place) {
                    push(Measurement::WheelCount { wheel, raw });
                }
            }
            _ => {}
        }
    }
}
