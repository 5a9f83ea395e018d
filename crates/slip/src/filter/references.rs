//! Readings of places, headings and speeds, and the frame in which they are.

use alloc::vec::Vec;

use grouser_real::{Real, wrap_angle};

use super::repeats::Repeats;
use crate::fault::Fault;
use crate::history::{nanoseconds, seconds_between, whole};
use crate::motion::{Belief, HEADING, NewFrame, Reading, Step, Value, X, Y};
use crate::period::{GAP_PERIODS, Period};
use crate::sample::{Measurement, Sample};

/// Readings that can wait: a burst, as the memory of a microcontroller allows, and those of two references at 100 Hz during the
/// latency. Beyond, the oldest two are joined.
pub(super) const BURST: usize = 16;
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
        /// Is it the first one, or the first after a gap? What moved in the gap is not in it.
        is_first: bool,
    },
    Speed(f64),
}

impl Read {
    /// This reading and the next one as one: a place and a speed hold by themselves, displacements add up.
    fn then(self, next: Self) -> Self {
        let (
            Self::Moved { by, turn, is_first },
            Self::Moved {
                by: on,
                turn: turned,
                is_first: false,
            },
        ) = (self, next)
        else {
            return next;
        };
        let half = 0.5 * (turn.unwrap_or(0.0) + turned.unwrap_or(0.0));
        // each is in the heading of its middle, and their sum in that of its own
        let [a, b] = [
            0.5 * turn.unwrap_or(0.0) - half,
            half - 0.5 * turned.unwrap_or(0.0),
        ];
        let turn_by =
            |[x, y]: [f64; 2], (sin, cos): (f64, f64)| [cos * x - sin * y, sin * x + cos * y];
        let [first, second] = [turn_by(by, Real::sin_cos(a)), turn_by(on, Real::sin_cos(b))];
        Self::Moved {
            by: [first[0] + second[0], first[1] + second[1]],
            turn: turn.zip(turned).map(|(turn, on)| turn + on),
            is_first,
        }
    }
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
    /// The sum of the displacements since the last gap, in the frame that began there; `None` before the first.
    sum: Option<[f64; 3]>,
    /// When the last displacement came, and their period.
    moved_ns: Option<i64>,
    period: Period,
    has_places: bool,
    /// When it measured a heading or a turn last.
    heading_ns: Option<i64>,
    /// Displacements and speeds that go on repeating themselves are no readings, and no place is one that repeats itself where others
    /// scattered while the wheels were stationary, or that never changed.
    motions: Repeats,
    places: Repeats,
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
            moved_ns: None,
            period: Period::default(),
            has_places: false,
            heading_ns: None,
            motions: Repeats::default(),
            places: Repeats::default(),
            lost: 0,
        }
    }

    /// The clock was set.
    pub(super) fn restart_clock(&mut self) {
        self.waiting.clear();
        (self.heading_ns, self.moved_ns) = (None, None);
    }

    /// Takes a reading; the motion up to `settled_ns` cannot be changed by much any more. Are the wheels stationary?
    pub(super) fn take(
        &mut self,
        sample: &Sample,
        settled_ns: Option<i64>,
        is_stationary: bool,
    ) -> Result<(), Fault> {
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
                let is_first = self.follows_gap(sample.time_ns);
                Read::Moved { by, turn, is_first }
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
        let now_ns = sample.time_ns;
        let mut of_motion = |motion: [f64; 3]| {
            // a stationary robot repeats zero, which is no fault
            let moves = motion != [0.0; 3];
            if moves {
                self.motions.push(now_ns, motion, true);
            }
            moves && self.motions.has_stopped()
        };
        let is_repeated = match read {
            Read::Moved { by, turn, .. } => of_motion([by[0], by[1], turn.unwrap_or(0.0)]),
            Read::Speed(speed) => of_motion([speed, 0.0, 0.0]),
            Read::Fixed { place, yaw } => {
                let reading = [place[0], place[1], yaw.unwrap_or(0.0)];
                self.places.push(now_ns, reading, is_stationary);
                !is_stationary && self.places.is_repeated()
            }
        };
        if is_repeated {
            return Ok(());
        }
        let time_ns = sample.time_ns.saturating_sub(nanoseconds(self.latency));
        if let Some(last_ns) = settled_ns.filter(|of| seconds_between(time_ns, *of) > MAX_DELAY_S) {
            return Err(Fault::NotLater { time_ns, last_ns });
        }
        if self.waiting.len() == self.waiting.capacity() {
            let (_, oldest) = self.waiting.remove(0);
            self.waiting[0].1 = oldest.then(self.waiting[0].1);
        }
        let after = self.waiting.partition_point(|of| of.0 <= time_ns);
        self.waiting.insert(after, (time_ns, read));
        Ok(())
    }

    /// Does a displacement follow a gap, or is it the first one?
    fn follows_gap(&mut self, time_ns: i64) -> bool {
        let period = self.period.mean();
        let Some(passed) =
            (self.moved_ns.replace(time_ns)).map(|then| seconds_between(then, time_ns))
        else {
            return true;
        };
        let is_gap = period > 0.0 && passed > GAP_PERIODS * period;
        if !is_gap {
            self.period.push(passed);
        }
        is_gap
    }

    /// Gives the readings up to a step's end to it, and the frame that begins there, as the belief before the step has the frame; `sigmas` are those of a place and a
    /// heading. Where the frame is found, place and heading are known to the variances that it returns.
    pub(super) fn give(
        &mut self,
        end_ns: i64,
        belief: &Belief,
        [place_sigma, yaw_sigma]: [f64; 2],
        step: &mut Step,
    ) -> Option<[f64; 2]> {
        let out = &mut step.readings;
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
                    is_first,
                } => {
                    if is_first {
                        self.sum = None;
                    }
                    let sum = self.sum.get_or_insert_with(|| {
                        let heading = turn.map(|_| mean[HEADING]);
                        step.frame = Some(NewFrame {
                            place: here,
                            heading,
                        });
                        [here[0], here[1], mean[HEADING]]
                    });
                    if !is_first {
                        // a sensor that does not measure the turn moves in the heading that is known
                        let half = turn.map_or(mean[HEADING], |turn| sum[2] + 0.5 * turn);
                        let (sin, cos) = Real::sin_cos(half);
                        sum[0] += cos * forward - sin * left;
                        sum[1] += sin * forward + cos * left;
                        sum[2] += turn.unwrap_or(0.0);
                    }
                    push(Value::Place([sum[0], sum[1]]));
                    if turn.is_some() {
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
