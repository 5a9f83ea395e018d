//! Readings of places, headings and speeds, and the frame in which they are.

use alloc::vec::Vec;

use grouser_real::{Real, wrap_angle};

use super::repeats::Repeats;
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between, whole};
use crate::motion::{Belief, HEADING, Reading, Value, X, Y};
use crate::sample::{Measurement, Sample};

/// Readings that can wait: a burst, and those of two references at 100 Hz during the latency. Beyond, the oldest is counted as refused.
const BURST: usize = 32;
const MAX_RATE_HZ: f64 = 200.0;
/// Readings older than this are refused, s: a robot of 1 m/s has moved by a metre since.
pub(super) const MAX_DELAY_S: f64 = 1.0;
/// What no ground robot reaches: a place (m), a heading (rad), a step of a displacement (m, rad).
const MAX_PLACE: f64 = 1e8;
const MAX_DISPLACEMENT: f64 = 1e3;
/// Two places show a heading when their distance is at least this many of their sigmas: then it is known to 0.14 rad.
const COURSE_SIGMAS: f64 = 10.0;

/// What a reference read.
#[derive(Clone, Copy, Debug)]
enum Read {
    /// A pose or a place in the reference's frame.
    Fixed {
        place: [f64; 2],
        yaw: Option<f64>,
    },
    /// A displacement in the robot's own frame.
    Moved {
        by: [f64; 2],
        turn: Option<f64>,
    },
    Speed(f64),
}

/// How the reference's frame lies in that of the start.
#[derive(Clone, Copy, Debug)]
enum Frame {
    Unknown,
    /// A place of the reference and the same one in the frame of the start; its rotation is not known yet.
    Anchored([[f64; 2]; 2]),
    /// Rotation, and a place in both.
    Known(f64, [[f64; 2]; 2]),
}

/// Readings of references until their step is complete.
#[derive(Clone, Debug)]
pub(super) struct References {
    waiting: Vec<(i64, Read)>,
    latency: f64,
    frame: Frame,
    /// The sum of the displacements in the frame of the start; `None` before the first.
    sum: Option<[f64; 3]>,
    has_places: bool,
    /// When it measured a heading or a turn last.
    heading_ns: Option<i64>,
    /// Displacements and speeds, which are no motion where they repeat themselves.
    repeats: Repeats,
    /// Readings that found no room.
    pub(super) lost: u64,
}

impl References {
    pub(super) fn new(latency: f64) -> Self {
        Self {
            waiting: Vec::with_capacity(
                BURST + usize::try_from(whole(latency * MAX_RATE_HZ)).unwrap_or(0),
            ),
            latency,
            frame: Frame::Unknown,
            sum: None,
            has_places: false,
            heading_ns: None,
            repeats: Repeats::default(),
            lost: 0,
        }
    }

    /// The clock was set.
    pub(super) fn restart_clock(&mut self) {
        self.waiting.clear();
        self.heading_ns = None;
    }

    /// Takes a reading; the motion up to `settled_ns` cannot be changed by much any more.
    pub(super) fn take(&mut self, sample: &Sample, settled_ns: Option<i64>) -> Result<(), Fault> {
        let range = |field, value: f64, limit: f64, unit| {
            Fault::check_range(field, value, -limit, limit, unit)
        };
        let read = match sample.measurement {
            Measurement::Pose { x, y, yaw } => {
                range("pose x", x, MAX_PLACE, "m")?;
                range("pose y", y, MAX_PLACE, "m")?;
                range("pose yaw", yaw, MAX_PLACE, "rad")?;
                let place = [x, y];
                Read::Fixed {
                    place,
                    yaw: Some(yaw),
                }
            }
            Measurement::Position { x, y } => {
                range("position x", x, MAX_PLACE, "m")?;
                range("position y", y, MAX_PLACE, "m")?;
                let place = [x, y];
                Read::Fixed { place, yaw: None }
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                range("displacement forward", forward, MAX_DISPLACEMENT, "m")?;
                range("displacement left", left, MAX_DISPLACEMENT, "m")?;
                range(
                    "displacement turn",
                    turn.unwrap_or(0.0),
                    MAX_DISPLACEMENT,
                    "rad",
                )?;
                let by = [forward, left];
                Read::Moved { by, turn }
            }
            Measurement::Speed { forward, left } => {
                range("speed forward", forward, MAX_DISPLACEMENT, "m/s")?;
                range("speed left", left.unwrap_or(0.0), MAX_DISPLACEMENT, "m/s")?;
                Read::Speed(forward)
            }
            _ => return Ok(()),
        };
        if let Read::Fixed { yaw: Some(_), .. } | Read::Moved { turn: Some(_), .. } = read {
            self.heading_ns = Some(sample.time_ns);
        }
        let motion = match read {
            Read::Moved { by, turn } => [by[0], by[1], turn.unwrap_or(0.0)],
            Read::Speed(speed) => [speed, 0.0, 0.0],
            Read::Fixed { .. } => [0.0; 3],
        };
        if motion != [0.0; 3] {
            self.repeats.push(sample.time_ns, motion);
            if self.repeats.has_stopped() {
                return Ok(());
            }
        }
        let time_ns = sample.time_ns.saturating_sub(nanoseconds(self.latency));
        if let Some(last_ns) = settled_ns.filter(|of| seconds_between(time_ns, *of) > MAX_DELAY_S) {
            return Err(Fault::NotLater { time_ns, last_ns });
        }
        if self.waiting.len() == self.waiting.capacity() {
            self.waiting.remove(0);
            self.lost = self.lost.saturating_add(1);
        }
        let after = self.waiting.partition_point(|of| of.0 <= time_ns);
        self.waiting.insert(after, (time_ns, read));
        Ok(())
    }

    /// Gives the readings up to a step's end to it, as the belief before the step has the frame; `sigmas` are those of a place and a
    /// heading. Where the frame is found, place and heading are known to the variances that it returns.
    pub(super) fn give(
        &mut self,
        end_ns: i64,
        belief: &Belief,
        [place_sigma, yaw_sigma]: [f64; 2],
        out: &mut Vec<Reading>,
    ) -> Option<[f64; 2]> {
        let mut found = None;
        let of_place = place_sigma * place_sigma;
        let ripe = self.waiting.partition_point(|of| of.0 <= end_ns);
        for (time_ns, read) in self.waiting.drain(..ripe) {
            let since = seconds_between(time_ns, end_ns);
            let lost = &mut self.lost;
            let mut push = |value: Value| {
                if out.len() == out.capacity() {
                    *lost = lost.saturating_add(1);
                } else {
                    out.push(Reading {
                        value,
                        since,
                        scale: 1.0,
                    });
                }
            };
            let mean = &belief.mean;
            let here = [mean[X], mean[Y]];
            match read {
                Read::Speed(speed) => push(Value::Speed(speed)),
                Read::Moved { .. } if self.has_places => {}
                Read::Moved {
                    by: [forward, left],
                    turn,
                } => {
                    let Some(sum) = self.sum.as_mut() else {
                        self.sum = Some([here[0], here[1], mean[HEADING]]);
                        continue;
                    };
                    // a sensor that does not measure the turn moves in the heading that is known
                    let half = match turn {
                        Some(turn) => sum[2] + 0.5 * turn,
                        None => mean[HEADING],
                    };
                    let (sin, cos) = Real::sin_cos(half);
                    sum[0] += cos * forward - sin * left;
                    sum[1] += sin * forward + cos * left;
                    push(Value::Place([sum[0], sum[1]]));
                    if let Some(turn) = turn {
                        sum[2] += turn;
                        push(Value::Heading(sum[2]));
                    }
                }
                Read::Fixed { place, yaw } => {
                    self.has_places = true;
                    self.frame = match (self.frame, yaw) {
                        (Frame::Unknown, Some(yaw)) => {
                            found = Some([of_place, yaw_sigma * yaw_sigma]);
                            Frame::Known(wrap_angle(mean[HEADING] - yaw), [place, here])
                        }
                        (Frame::Unknown, None) => Frame::Anchored([place, here]),
                        (Frame::Anchored([from, start]), None) => {
                            let [a, b] = [sub(place, from), sub(here, start)];
                            let length = Real::hypot(a[0], a[1]).min(Real::hypot(b[0], b[1]));
                            if length <= COURSE_SIGMAS * place_sigma {
                                continue;
                            }
                            let angle = |of: [f64; 2]| Real::atan2(of[1], of[0]);
                            found = Some([of_place, 2.0 * of_place / (length * length)]);
                            Frame::Known(wrap_angle(angle(b) - angle(a)), [from, start])
                        }
                        (frame, _) => frame,
                    };
                    if let Frame::Known(rotation, [from, start]) = self.frame {
                        let (sin, cos) = Real::sin_cos(rotation);
                        let off = sub(place, from);
                        let x = start[0] + cos * off[0] - sin * off[1];
                        let y = start[1] + sin * off[0] + cos * off[1];
                        push(Value::Place([x, y]));
                        if let Some(yaw) = yaw {
                            push(Value::Heading(yaw + rotation));
                        }
                    }
                }
            }
        }
        found
    }

    /// Has it measured a heading or a turn within the last second?
    pub(super) fn has_headings(&self, now_ns: i64) -> bool {
        (self.heading_ns).is_some_and(|then| seconds_between(then, now_ns) <= MAX_DELAY_S)
    }

    /// The kind of noise of a place: of a displacement's sum it wanders.
    pub(super) const fn is_by_displacements(&self) -> bool {
        self.sum.is_some() && !self.has_places
    }
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
