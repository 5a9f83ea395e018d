//! A running node: messages in, slips out, to the summary.
//!
//! [`Node::run`] has one end for every reason to end: the robot is stopped first, then each of state, recording and
//! transport is ended, whatever became of the others.

use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use grouser_log::Intake;
use grouser_log::container::Channel;
use grouser_replay::messages::diagnostic_status;
use grouser_replay::{Engine, RobotSamples};

use crate::arguments::Arguments;
use crate::command::{self, CommandPath};
use crate::error::Result;
use crate::latency::Latency;
use crate::look::Subscriptions;
use crate::outputs::{Outputs, record};
use crate::print::{event_line, say, warn};
use crate::screen::{MAX_EVENTS, Screen, Snapshot};
use crate::senders::Senders;
use crate::transport::{Arrival, Arrivals, Inbox};
use ending::guarded;

/// The loop looks at least this often whether it is to end.
const TURN: Duration = Duration::from_millis(50);
/// Diagnostics come this often.
const DIAGNOSTICS_PERIOD: Duration = Duration::from_secs(1);
/// Wheels from which nothing came for so long are silent: as the filter's own limit for a reference.
const SILENCE: Duration = Duration::from_millis(500);

/// Where every topic has been silent for so long, the transport announces the node anew, and again after twice the time, up to
/// the limit: a peer that is off costs little, one that was lost is back soon.
const RENEWAL_TIMES: (Duration, Duration) = (Duration::from_secs(3), Duration::from_mins(1));

/// The last second that the 32 bits of a stamp hold.
const MAX_STAMP: Duration = Duration::from_secs(i32::MAX.unsigned_abs() as u64);
/// The zero at the end is begun again so often where sending it panics.
const MAX_STOP_TRIES: u32 = 3;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// With slips.
    Done,
    /// Without a slip.
    NoSlip,
    /// With doubts.
    Doubtful,
}

impl Outcome {
    /// The exit code, as of the other verbs.
    #[must_use]
    pub const fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::NoSlip => 1,
            Self::Doubtful => 3,
        }
    }
}

/// The parts of a running node.
pub(crate) struct Node {
    channels: Vec<Channel>,
    /// By channel: its number in the intake, where it is used.
    numbers: Vec<Option<usize>>,
    senders: Vec<Senders>,
    record_ids: Vec<Option<u16>>,
    last_received: Vec<Option<Instant>>,
    intake: Intake,
    samples: RobotSamples,
    engine: Engine,
    outputs: Outputs,
    inbox: Inbox,
    pub(crate) hold: Duration,
    latency: Latency,
    messages: u64,
    /// What was wrong when the diagnostics were last made.
    problems: Vec<String>,
    pub(crate) is_quiet: bool,
    names: Vec<String>,
    /// `None` where nothing but the first topics is used.
    pub(crate) subscriptions: Option<Subscriptions>,
    pub(crate) command: Option<CommandPath>,
    /// How long every topic is silent before the transport is renewed next.
    renewal_time: Duration,
    /// Messages that were not sent until the last diagnostics.
    unsent: u64,
    diagnostics_period: Duration,
    /// With the time of the next snapshot.
    pub(crate) screen: Option<(Screen, Instant)>,
    pub(crate) title: String,
    /// Events for the screen, the newest last.
    events: Vec<String>,
}

impl Node {
    /// A node with its channels, without options.
    pub(crate) fn new(
        channels: Vec<Channel>,
        mut intake: Intake,
        (samples, engine): (RobotSamples, Engine),
        outputs: Outputs,
        inbox: Inbox,
    ) -> Self {
        Self {
            senders: channels.iter().map(Senders::new).collect(),
            numbers: channels
                .iter()
                .map(|channel| intake.channel(channel))
                .collect(),
            record_ids: vec![None; channels.len()],
            last_received: vec![None; channels.len()],
            channels,
            intake,
            samples,
            engine,
            names: outputs.names().to_vec(),
            outputs,
            inbox,
            hold: Duration::ZERO,
            latency: Latency::new(),
            messages: 0,
            problems: Vec::new(),
            is_quiet: true,
            subscriptions: None,
            command: None,
            renewal_time: RENEWAL_TIMES.0,
            unsent: 0,
            diagnostics_period: DIAGNOSTICS_PERIOD,
            screen: None,
            title: String::new(),
            events: Vec::new(),
        }
    }

    /// Uses a message; `is_timed` where its latency counts: not where it waited for the choice of topics.
    pub(crate) fn take(&mut self, arrival: &Arrival, is_timed: bool) -> Result<()> {
        if arrival.subscription == command::SUBSCRIPTION {
            if let Some(path) = &mut self.command {
                path.take(arrival, &mut self.outputs);
            }
            return Ok(());
        }
        let index = arrival.subscription;
        let Some(channel) = self.channels.get(index) else {
            return Ok(());
        };
        let Some(number) = self.numbers[index] else {
            return Ok(());
        };
        self.last_received[index] = Some(arrival.received);
        if !self.senders[index].accepts(arrival, &channel.type_name) {
            return Ok(());
        }
        self.messages += 1;
        let recorder = &mut self.outputs.recorder;
        record(
            recorder,
            &mut self.record_ids[index],
            channel,
            arrival.received_ns,
            &arrival.bytes,
        );
        self.intake
            .push(Some(number), &arrival.bytes, arrival.received_ns);
        let steps = self.outputs.steps;
        let mut popped = false;
        while let Some(sample) = self.intake.pop() {
            popped = true;
            self.engine
                .push(self.samples.convert(sample), &mut self.outputs)?;
        }
        if popped {
            self.engine.flush(&mut self.outputs)?;
        }
        if is_timed && self.outputs.steps > steps {
            self.latency.add(arrival.received);
        }
        self.report_changes();
        Ok(())
    }

    /// Has nothing come for as long as messages are held back?
    fn has_held(&self, now: Instant) -> bool {
        let newest = self.last_received.iter().flatten().max();
        newest.is_some_and(|newest| now.saturating_duration_since(*newest) >= self.hold)
    }

    /// Estimates with what is still held back.
    fn release(&mut self) -> Result<()> {
        let mut popped = false;
        while let Some(sample) = self.intake.pop_held() {
            popped = true;
            self.engine
                .push(self.samples.convert(sample), &mut self.outputs)?;
        }
        if popped {
            self.engine.flush(&mut self.outputs)?;
            self.report_changes();
        }
        Ok(())
    }

    /// Runs until `stop`, or until something fails; the end is the same.
    pub(crate) fn run(
        mut self,
        backlog: &[Arrival],
        arrivals: &mut Arrivals,
        stop: &dyn Fn() -> bool,
        kept: (&Arguments, &grouser_slip::Robot),
    ) -> Result<Outcome> {
        let turned = guarded(|| {
            for arrival in backlog {
                self.take(arrival, false)?;
            }
            // what arrived meanwhile waited for these, not for the node's work
            while let Some(arrival) = arrivals.try_recv() {
                self.take(&arrival, false)?;
            }
            self.turn(arrivals, stop)
        });
        self.stop_robot();
        let drained = turned.and_then(|()| guarded(|| self.drain(arrivals)));
        self.end(drained, kept)
    }

    /// The loop.
    fn turn(&mut self, arrivals: &mut Arrivals, stop: &dyn Fn() -> bool) -> Result<()> {
        let mut diagnostics_due = Instant::now() + self.diagnostics_period;
        while !stop() {
            let wait = if self.hold.is_zero() {
                TURN
            } else {
                TURN.min(self.hold)
            };
            let wait =
                (self.command.as_ref()).map_or(wait, |path| wait.min(path.wait(Instant::now())));
            match arrivals.recv_timeout(wait) {
                Ok(arrival) => self.take(&arrival, true)?,
                Err(RecvTimeoutError::Timeout) if self.has_held(Instant::now()) => {
                    self.release()?;
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            let now = Instant::now();
            if let Some(path) = &mut self.command {
                path.tick(now, system_ns(), &mut self.outputs, &self.inbox)?;
            }
            self.show(now);
            if now >= diagnostics_due {
                diagnostics_due = now + self.diagnostics_period;
                self.diagnose(now);
            }
        }
        Ok(())
    }

    /// The last command is zero, if the transport still carries it. The base needs a timeout of its own for a transport
    /// that does not, and for a node that is killed.
    fn stop_robot(&mut self) {
        let Some(path) = &mut self.command else {
            return;
        };
        // a transport that fails once may carry the next one
        for _ in 0..MAX_STOP_TRIES {
            let stopped = guarded(|| {
                path.stop(system_ns(), &mut self.outputs);
                Ok(())
            });
            match stopped {
                Ok(()) => return,
                Err(error) => warn(&format!("the last command may not be zero: {error}")),
            }
        }
    }

    /// What has arrived by now still counts.
    fn drain(&mut self, arrivals: &mut Arrivals) -> Result<()> {
        while let Some(arrival) = arrivals.try_recv() {
            self.take(&arrival, true)?;
        }
        self.intake.finish();
        self.release()
    }

    /// Once a second: what is wrong, in diagnostics and, where it is new, in words.
    fn diagnose(&mut self, now: Instant) {
        let now_ns = system_ns();
        let mut problems: Vec<String> = self
            .senders
            .iter()
            .filter_map(|senders| senders.problem(now))
            .collect();
        let mut is_silent = false;
        for (channel, received) in self.channels.iter().zip(&self.last_received) {
            let silent = received.map(|at| now.saturating_duration_since(at));
            // what is held back is published first
            if silent.is_some_and(|silent| silent >= SILENCE + self.hold) {
                is_silent = true;
                problems.push(format!("`{}` is silent", channel.topic));
            }
        }
        self.renew_transport(now);
        let unsent = self.outputs.unsent();
        if unsent > self.unsent {
            problems
                .push("messages were not sent: a subscriber or the machine is too slow".to_owned());
        }
        self.unsent = unsent;
        let (unencoded, reason) = self.outputs.unencoded();
        if let Some(reason) = reason {
            problems.push(format!("messages cannot be encoded: {reason}"));
        }
        let left_out = self.intake.left_out();
        if let Some(problem) = &left_out.problem {
            problems.push(format!("messages cannot be decoded: {problem}"));
        }
        if self.inbox.dropped() > 0 {
            problems.push("messages were dropped: the machine is too slow".to_owned());
        }
        if let Some(path) = &self.command {
            problems.extend(path.problems(now));
        }
        let transport = self.outputs.transport.as_mut();
        if let Some(subscriptions) = &mut self.subscriptions {
            for topic in subscriptions.unknown(transport) {
                problems.push(format!(
                    "`{topic}` appeared after the topics were chosen and is not used"
                ));
            }
        }
        problems.extend(transport.warnings());
        let late = left_out.late;
        let undecoded = left_out.undecoded;
        for problem in problems
            .iter()
            .filter(|problem| !self.problems.contains(problem))
        {
            warn(problem);
        }
        let [median, high, longest] = self.latency.microseconds().unwrap_or_default();
        let level = u64::from(!problems.is_empty());
        let words = if problems.is_empty() {
            "running".to_owned()
        } else {
            problems.join("; ")
        };
        let status = diagnostic_status(
            level,
            "grouser: live",
            &words,
            "grouser",
            (self.command.iter().flat_map(CommandPath::values)).chain([
                ("messages", self.messages.to_string()),
                ("messages_late", late.to_string()),
                ("messages_undecoded", undecoded.to_string()),
                ("messages_unsent", unsent.to_string()),
                ("messages_unencoded", unencoded.to_string()),
                ("messages_dropped", self.inbox.dropped().to_string()),
                ("hold_ms", format!("{:.1}", 1e3 * self.hold.as_secs_f64())),
                ("latency_median_us", format!("{median:.0}")),
                ("latency_p999_us", format!("{high:.0}")),
                ("latency_longest_us", format!("{longest:.0}")),
            ]),
        );
        self.problems = problems;
        if is_silent {
            self.outputs.publish_silence(now_ns);
        }
        self.outputs.publish_diagnostics(now_ns, status);
        if !self.is_quiet {
            self.print_wheels();
        }
    }

    /// Hands the screen, where there is one, a new snapshot.
    fn show(&mut self, now: Instant) {
        let Some((screen, due)) = &mut self.screen else {
            return;
        };
        if now < *due {
            return;
        }
        *due = now + Screen::period();
        let motion = self.outputs.last_odometry.map(|odometry| {
            let (velocity, covariance) = (odometry.velocity, odometry.velocity_covariance);
            let sigma = |i: usize| covariance[i][i].max(0.0).sqrt();
            [velocity[0], sigma(0), velocity[2], sigma(2)]
        });
        screen.show(Snapshot {
            title: self.title.clone(),
            names: self.names.clone(),
            wheels: self.outputs.latest.clone(),
            motion,
            latency_us: self.latency.microseconds(),
            messages: self.messages,
            command_share: self.command.as_ref().map(CommandPath::share),
            events: self.events.clone(),
            problems: self.problems.clone(),
        });
    }

    /// Renews the transport where all topics have fallen silent.
    fn renew_transport(&mut self, now: Instant) {
        let Some(newest) = self.last_received.iter().flatten().max() else {
            return;
        };
        let silent = now.saturating_duration_since(*newest);
        if silent < RENEWAL_TIMES.0 {
            self.renewal_time = RENEWAL_TIMES.0;
        } else if silent >= self.renewal_time {
            self.renewal_time = (self.renewal_time * 2).min(silent + RENEWAL_TIMES.1);
            if let Err(error) = self.outputs.transport.renew() {
                warn(&format!("the transport is not renewed: {error}"));
            }
        }
    }

    fn print_wheels(&self) {
        let wheels = self
            .names
            .iter()
            .zip(&self.outputs.latest)
            .map(|(name, wheel)| match (wheel.slip, wheel.sigma) {
                (Some(slip), Some(sigma)) => {
                    format!("{name} {:.3} ± {sigma:.3} {}", slip.value(), wheel.health)
                }
                _ => format!("{name} – {}", wheel.health),
            });
        let wheels: Vec<String> = wheels.collect();
        say(&wheels.join(", "));
    }

    fn report_changes(&mut self) {
        for change in std::mem::take(&mut self.outputs.changes) {
            if !self.is_quiet {
                say(&event_line(&change, &self.names));
            }
            if self.screen.is_some() {
                if self.events.len() >= MAX_EVENTS {
                    self.events.remove(0);
                }
                self.events.push(event_line(&change, &self.names));
            }
        }
    }
}

#[cfg(test)]
mod cycle_tests;
#[cfg(test)]
mod end_tests;
mod ending;

/// The system's time, ns, as far as a stamp holds it.
fn system_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let since = since.unwrap_or_default().min(MAX_STAMP);
    i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
}
