//! Messages in, samples out.

use std::sync::Arc;
use std::time::Duration;

use grouser_files::columns::Meaning;
use grouser_slip::{Measurement, Sample};

use super::UsedTopic;
use super::choose::Choice;
use super::frames::{FramePose, is_static};
use super::job::Job;
use super::navigation::{FixColumns, Track};
use crate::container::Channel;
use crate::measures::Measures;
use crate::message::{Decoders, NavSatFix, SharedDecoder, Value, View, decode, is_spare, short};
use crate::messages::{Clock, LOOK_AHEAD, LeftOut, NO_STAMP, stamp_of};
use crate::order::{Limit, Ordered};
use crate::wrapped_angles::Angles;

/// A live message that stands this far before those already used shows a clock that was set, s.
const CLOCK_STEP_S: f64 = 1.0;
/// So many of them in a row show it: one alone is a straggler.
const STEP_MESSAGES: u32 = 3;

/// Turns the messages of chosen topics into samples in the order of time.
///
/// Files are read through it, and a live source can push into it: [`Preview`](crate::Preview) chooses the topics, by
/// the robot file and by the first messages, then every message goes in with [`Intake::push`], and samples come out of
/// [`Intake::pop`].
///
/// ```
/// use grouser_files::topics::Topics;
/// use grouser_log::container::{Container, Event};
/// use grouser_log::Preview;
///
/// let path = std::path::Path::new("../../examples/five-wheel/log.mcap");
/// let robot = grouser_files::robot::read(&path.with_file_name("robot.toml"))?;
/// let mut preview = Preview::new(&robot.topics);
/// preview.read(path)?;
/// let mut intake = preview.into_intake()?;
/// let mut container = Container::open(path)?;
/// let mut samples = 0;
/// while let Some(event) = container.next() {
///     if let Event::Message(message) = event {
///         let channel = intake.channel(message.of);
///         intake.push(channel, message.data, message.log_time_ns);
///     }
///     while intake.pop().is_some() {
///         samples += 1;
///     }
/// }
/// intake.finish();
/// while intake.pop().is_some() {
///     samples += 1;
/// }
/// assert_eq!(samples, 2001 * 6); // five counters and a gyro
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Intake {
    choice: Arc<Choice>,
    /// What is added to the times of each topic, ns.
    shifts_ns: Vec<i64>,
    /// The track of an antenna or a prism, where places without a heading are used.
    track: Option<Track>,
    /// Fixes that are numbers of a message.
    fixes: FixColumns,
    frame_pose: Option<FramePose>,
    channels: Vec<Known>,
    decoders: Decoders,
    rows: Rows,
    is_finished: bool,
    /// Where no reader of files does it, wrapped angles are put together here.
    angles: Option<Angles>,
}

/// Samples in the order of time, and what is left out of them.
struct Rows {
    ordered: Ordered<Sample>,
    /// Messages in a row that stand far before those already used, of a live source: its clock may be set.
    far_back: Option<u32>,
    left_out: LeftOut,
}

impl Rows {
    /// Announces a message; false for one that comes too late, which is counted.
    fn begin(&mut self, time_ns: i64) -> bool {
        let is_begun = self.begin_row(time_ns);
        self.left_out.late += u64::from(!is_begun);
        is_begun
    }

    fn begin_row(&mut self, time_ns: i64) -> bool {
        let begun = self.ordered.begin_row(time_ns);
        let Some(far_back) = &mut self.far_back else {
            return begun.is_ok();
        };
        match begun {
            Ok(()) => *far_back = 0,
            Err(behind_s) if behind_s < CLOCK_STEP_S => return false,
            Err(_) => {
                *far_back += 1;
                if *far_back < STEP_MESSAGES {
                    return false;
                }
                *far_back = 0;
                self.ordered.clear();
                self.ordered.forget_time();
                return self.ordered.begin_row(time_ns).is_ok();
            }
        }
        true
    }

    /// Takes what the message that was announced measures.
    fn push(&mut self, time_ns: i64, measurement: Measurement) {
        self.ordered.push(Sample {
            time_ns,
            measurement,
        });
    }
}

/// A channel of a topic that is used, with the value into which its messages are decoded.
struct Known {
    channel: Channel,
    /// Its type as views know it.
    type_name: String,
    topic: usize,
    decoder: SharedDecoder,
    value: Value,
}

/// A time of the recorder.
pub(super) fn recorded_ns(log_time_ns: u64) -> i64 {
    i64::try_from(log_time_ns).unwrap_or(i64::MAX)
}

impl Intake {
    pub(crate) fn new(choice: Arc<Choice>, shifts_ns: Vec<i64>) -> Self {
        let mut jobs = choice.topics.iter().flat_map(|topic| &topic.jobs);
        let has_places = jobs.any(|job| matches!(job, Job::Fix(_)) || job.gives_places());
        Self {
            track: has_places.then(|| Track::new(choice.antenna)),
            fixes: FixColumns::new(choice.stated_sigma),
            frame_pose: choice.frame_pose.clone(),
            choice,
            shifts_ns,
            channels: Vec::new(),
            decoders: Decoders::default(),
            rows: Rows {
                ordered: Ordered::new(LOOK_AHEAD),
                far_back: None,
                left_out: LeftOut::default(),
            },
            is_finished: false,
            angles: None,
        }
    }

    /// Without a reader of files around it.
    pub(super) fn alone(choice: Choice) -> Self {
        let wheels = choice.wheels.iter();
        let are_ways = wheels.map(|wheel| choice.measures_wheel(Meaning::WheelDistance, wheel));
        Self {
            angles: Some(Angles::new(are_ways)),
            ..Self::new(Arc::new(choice), Vec::new())
        }
    }

    /// For a live source: holds samples back until the newest stamp is later by `hold`, instead of [`LOOK_AHEAD`]
    /// messages. A clock that is set back is followed after three messages.
    #[must_use]
    pub fn with_hold(mut self, hold: Duration) -> Self {
        let hold_ns = i64::try_from(hold.as_nanos()).unwrap_or(i64::MAX);
        self.rows.ordered = Ordered::with_limit(Limit::Time(hold_ns));
        self.rows.far_back = Some(0);
        self
    }

    /// The wheels, to which the samples' indices refer.
    #[must_use]
    pub fn wheels(&self) -> &[String] {
        &self.choice.wheels
    }

    /// The topics that are used.
    pub fn topics(&self) -> impl Iterator<Item = UsedTopic> {
        self.choice.used()
    }

    /// How the topics were chosen, where a user should know it.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.choice.notes
    }

    /// The number under which messages of `channel` are pushed; `None` for a topic that is not used.
    pub fn channel(&mut self, channel: &Channel) -> Option<usize> {
        let topic = self
            .choice
            .topics
            .iter()
            .position(|chosen| chosen.topic == channel.topic)?;
        let known = self
            .channels
            .iter()
            .position(|known| known.channel == *channel);
        Some(known.unwrap_or_else(|| {
            self.channels.push(Known {
                type_name: short(&channel.type_name).into_owned(),
                channel: channel.clone(),
                topic,
                decoder: self.decoders.of(channel),
                value: Value::Null,
            });
            self.channels.len() - 1
        }))
    }

    /// Takes a message of a channel, recorded at `log_time_ns`. One that cannot be decoded, or comes too late, is
    /// counted in [`Intake::left_out`].
    pub fn push(&mut self, channel: Option<usize>, bytes: &[u8], log_time_ns: u64) {
        let Some(index) = channel.filter(|channel| *channel < self.channels.len()) else {
            return;
        };
        let known = &mut self.channels[index];
        match decode(&known.decoder, bytes, &mut known.value) {
            Ok(()) => self.take(index, log_time_ns),
            Err(problem) => {
                self.rows.left_out.undecoded += 1;
                self.rows.left_out.problem.get_or_insert(problem);
            }
        }
        if !is_spare(index, bytes.len()) {
            self.channels[index].value = Value::Null;
        }
    }

    /// Takes what was decoded of a channel.
    fn take(&mut self, channel: usize, log_time_ns: u64) {
        let known = &self.channels[channel];
        let is_stamped = self.choice.clock == Clock::Header;
        let recorded = recorded_ns(log_time_ns);
        let shift_ns = self.shifts_ns.get(known.topic).copied().unwrap_or(0);
        // a message without a stamp among others that have one
        let ahead_ns = self.choice.topics[known.topic]
            .ahead_ns
            .filter(|_| is_stamped);
        let unstamped = recorded.saturating_add(ahead_ns.unwrap_or(0));
        let time = |stamp: Option<i64>| {
            let stamp = stamp.filter(|_| is_stamped);
            stamp.unwrap_or(unstamped).saturating_add(shift_ns)
        };
        let view = View::new(&known.type_name, &known.value);
        let chosen = &self.choice.topics[known.topic];
        let gives_frames = (chosen.jobs.iter()).any(|job| matches!(job, Job::Transforms));
        let frame_pose = self.frame_pose.as_mut().filter(|_| gives_frames);
        let rows = &mut self.rows;
        if let (Some(View::Transforms(all)), Some(pose)) = (&view, frame_pose) {
            // each has its own time, and what never changes that of long ago
            for (stamp, measurement) in pose.follow(all, is_static(&chosen.topic)) {
                let time_ns = time(stamp);
                if rows.begin(time_ns) {
                    rows.push(time_ns, measurement);
                }
            }
            return;
        }
        let Ok(stamp) = stamp_of(&known.value) else {
            rows.left_out.undecoded += 1;
            (rows.left_out.problem).get_or_insert_with(|| NO_STAMP.to_owned());
            return;
        };
        let time_ns = time(stamp);
        if !rows.begin(time_ns) {
            return;
        }
        for job in &chosen.jobs {
            if let (Job::Fix(limit), Some(View::NavSatFix(fix)), Some(track)) =
                (job, &view, &mut self.track)
            {
                if let Some(fault) = fix.fault(*limit) {
                    rows.left_out.exclude(fault);
                } else {
                    for measurement in track.take_fix(time_ns, fix).into_iter().flatten() {
                        rows.push(time_ns, measurement);
                    }
                }
            }
            let (are_places, sigma) = (job.gives_places(), self.choice.position_sigma);
            let (track, fixes) = (&mut self.track, &mut self.fixes);
            let mut fault = None;
            let mut fix = |fix: NavSatFix| {
                let place = fixes.place(fix);
                place.map_err(|why| fault = Some(why)).ok()
            };
            job.measurements(view.as_ref(), &known.value, &mut fix, &mut |measurement| {
                let measurements = match (measurement, &mut *track) {
                    // the yaw of a fix is its standard deviation
                    (Measurement::Pose { x, y, yaw }, Some(track)) if are_places => {
                        let sigma = Some(yaw).filter(|yaw| *yaw > 0.0).or(sigma);
                        sigma.map_or([None; 2], |sigma| track.take(time_ns, [x, y], sigma))
                    }
                    (Measurement::YawRate { rate }, Some(track)) => {
                        track.turn(time_ns, rate);
                        [Some(measurement), None]
                    }
                    _ => [Some(measurement), None],
                };
                for measurement in measurements.into_iter().flatten() {
                    rows.push(time_ns, measurement);
                }
            });
            if let Some(fault) = fault {
                rows.left_out.exclude(fault);
            }
        }
    }

    /// The next sample in the order of time; `None` until more messages come.
    pub fn pop(&mut self) -> Option<Sample> {
        let is_due = self.is_finished || self.rows.ordered.is_ripe();
        is_due.then(|| self.pop_held()).flatten()
    }

    /// The next sample, held back or not: nothing more of its time is expected.
    pub fn pop_held(&mut self) -> Option<Sample> {
        let mut sample = self.rows.ordered.pop()?;
        if let Some(angles) = &mut self.angles {
            angles.unwrap(&mut sample);
        }
        Some(sample)
    }

    /// No more messages come: [`Intake::pop`] returns the samples that were held back.
    pub const fn finish(&mut self) {
        self.is_finished = true;
    }

    /// What was left out so far.
    #[must_use]
    pub const fn left_out(&self) -> &LeftOut {
        &self.rows.left_out
    }

    /// A part of the file was lost.
    pub(crate) const fn lose(&mut self, bytes: u64) {
        self.rows.left_out.damages += 1;
        self.rows.left_out.bytes_lost += bytes;
    }
}

impl Measures for Intake {
    fn wheels(&self) -> &[String] {
        self.wheels()
    }

    fn measures(&self, meaning: Meaning) -> bool {
        self.choice.measures(meaning)
    }

    fn measures_wheel(&self, meaning: Meaning, wheel: &str) -> bool {
        self.choice.measures_wheel(meaning, wheel)
    }

    fn position_sigma(&self) -> Option<f64> {
        self.choice.position_sigma
    }

    fn speed_place(&self) -> [f64; 2] {
        self.choice.speed_place
    }
}
