//! The node: from the first message to the summary.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use grouser_files::robot::{self, RobotFile};
use grouser_log::Intake;
use grouser_log::container::Channel;
use grouser_replay::messages::diagnostic_status;
use grouser_replay::{Engine, Inputs, Options, RobotSamples, Status};
use grouser_slip::Reference;

use crate::arguments::Arguments;
use crate::command::{self, CommandPath};
use crate::environment::Environment;
use crate::error::{Error, Result};
use crate::latency::Latency;
use crate::look::{Subscriptions, look};
use crate::outputs::{Frames, Outputs, record};
use crate::print::{SCREEN_IS_OPEN, complain, event_line, say, say_choice, summary_line, warn};
use crate::recorder::Recorder;
use crate::screen::{MAX_EVENTS, Screen, Snapshot};
use crate::senders::Senders;
use crate::state_file;
use crate::transport::{self, Arrival, Inbox, Transport};

/// The loop looks at least this often whether it is to end.
const TURN: Duration = Duration::from_millis(50);
/// Diagnostics come this often.
const DIAGNOSTICS_PERIOD: Duration = Duration::from_secs(1);
/// Wheels from which nothing came for so long are silent: as the filter's own limit for a reference.
const SILENCE: Duration = Duration::from_millis(500);

/// Where every topic has been silent for so long, the transport announces the node anew, and again after twice the time, up to
/// the limit: a peer that is off costs little, one that was lost is back soon.
const RENEWAL_TIMES: (Duration, Duration) = (Duration::from_secs(3), Duration::from_mins(1));

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

/// Runs the node until Ctrl-C, SIGTERM, or the end of its time.
///
/// # Errors
/// Bad options, files and topics; a transport that does not open.
pub fn run(arguments: &Arguments) -> Result<Outcome> {
    let environment = Environment::read()?;
    let kind = arguments.transport.unwrap_or(environment.transport);
    // before anything is opened
    #[cfg(feature = "zenoh")]
    if kind == transport::Kind::Zenoh {
        transport::run_zenoh_on_one_thread();
    }
    let mut robot = robot::read(&arguments.robot)?;
    let (look_for, hold, duration) = (arguments.look()?, arguments.hold()?, arguments.duration()?);
    let learnt = match &arguments.state {
        Some(path) => state_file::read(path, &robot.robot)?,
        None => None,
    };
    let recorder = arguments
        .record
        .as_deref()
        .map(Recorder::create)
        .transpose()?;
    let own_name = arguments.full_name("grouser")?;
    let mut command = command_path(arguments, &robot)?;
    if let Some(path) = &command {
        // a requested speed is no measured one
        robot.topics.ignore.push(path.topic().to_owned());
    }
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // without a handler, Ctrl-C ends the process at once
    let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
    let ends = duration.map(|duration| Instant::now() + duration);
    let stop =
        || interrupted.load(Ordering::Relaxed) || ends.is_some_and(|end| Instant::now() >= end);

    let mut transport = transport::open(kind, &environment, &own_name)?;
    let (inbox, arrivals) = transport::inbox();
    let mut subscriptions = Subscriptions::new(&robot);
    if !arguments.quiet {
        say(&format!(
            "{own_name} listens on {}, domain {}",
            kind.name(),
            environment.domain
        ));
    }
    let queue = (&inbox, &arrivals);
    let looked = look(
        transport.as_mut(),
        (&robot, look_for),
        queue,
        &mut subscriptions,
        &stop,
    )?;
    let Some(looked) = looked else {
        transport.close();
        complain("it ended before any topic was chosen");
        return Ok(Outcome::NoSlip);
    };
    warn_of_others(transport.as_mut(), &arguments.full_name("grouser/slip")?);
    let hold = hold.unwrap_or(looked.hold);
    let intake = looked.intake.with_hold(hold);
    let inputs = Inputs::of(&intake, &robot, &Options::default())?;
    let samples = RobotSamples::new(&intake, &robot)?;
    let mut engine = Engine::new(&robot, inputs, &Options::default())?;
    if let Some(learnt) = &learnt {
        engine.restore(learnt)?;
    }
    if !arguments.quiet {
        say_choice(&intake, &inputs, hold);
    }
    check_reference(command.as_ref(), arguments, &inputs)?;
    let outputs = announce(transport, wheel_names(&robot), arguments, recorder)?;
    let mut node = Node::new(looked.channels, intake, (samples, engine), outputs, inbox);
    node.hold = hold;
    node.is_quiet = arguments.quiet;
    node.subscriptions = Some(subscriptions);
    node.command = command.take();
    node.title = format!(
        "{own_name} on {}, domain {}",
        kind.name(),
        environment.domain
    );
    if arguments.screen {
        node.is_quiet = true;
        node.screen = Some((Screen::open(Arc::clone(&interrupted))?, Instant::now()));
        SCREEN_IS_OPEN.store(true, Ordering::Relaxed);
    }
    for arrival in looked.backlog {
        node.take(&arrival, false)?;
    }
    // what arrived meanwhile waited for these, not for the node's work
    while let Ok(arrival) = arrivals.try_recv() {
        node.take(&arrival, false)?;
    }
    node.turn(&arrivals, &stop)?;
    node.finish(arguments, &robot.robot)
}

fn wheel_names(robot: &RobotFile) -> Vec<String> {
    let wheels = robot.robot.wheels().iter();
    wheels.map(|wheel| wheel.name.clone()).collect()
}

/// Announces the node's topics.
fn announce(
    transport: Box<dyn Transport>,
    names: Vec<String>,
    arguments: &Arguments,
    recorder: Option<Recorder>,
) -> Result<Outputs> {
    let frames = Frames {
        base: arguments.base_frame.clone(),
        odom: arguments.odom_frame.clone(),
    };
    let full_name = |name: &str| arguments.full_name(name);
    let publishes_tf = arguments.publish_tf;
    let mut outputs = Outputs::announce(transport, names, frames, publishes_tf, full_name)?;
    outputs.recorder = recorder;
    Ok(outputs)
}

/// The command path, where one is requested.
fn command_path(arguments: &Arguments, robot: &RobotFile) -> Result<Option<CommandPath>> {
    let Some(topic) = &arguments.command else {
        return Ok(None);
    };
    let topics = (
        arguments.topic("--command", topic)?,
        arguments.topic("--command-out", &arguments.command_out)?,
    );
    if topics.0 == topics.1 {
        return Err(Error::Option {
            name: "--command-out",
            value: topics.1,
            wanted: "another topic than --command".to_owned(),
        });
    }
    let described = (&robot.robot, robot.steering.is_some());
    let limits = arguments.command_limits()?;
    CommandPath::new(topics, arguments.base_frame.clone(), described, limits).map(Some)
}

/// Commands are limited only where something measures the robot's speed over ground.
fn check_reference(
    command: Option<&CommandPath>,
    arguments: &Arguments,
    inputs: &Inputs,
) -> Result<()> {
    let Some(path) = command else { return Ok(()) };
    if inputs.reference == Reference::Grip {
        return Err(Error::Option {
            name: "--command",
            value: path.topic().to_owned(),
            wanted: "left out: nothing measures the robot's speed over ground, so that a slip of all wheels is not \
                     observable"
                .to_owned(),
        });
    }
    if !arguments.quiet {
        say(&path.choice());
    }
    Ok(())
}

/// Another node that publishes `slip` would be mixed up with this one.
fn warn_of_others(transport: &mut dyn Transport, slip: &str) {
    let others = transport.graph().endpoints;
    if others
        .iter()
        .any(|other| other.is_publisher && other.topic == slip)
    {
        warn(&format!(
            "another node publishes `{slip}` too; `--namespace` separates the two"
        ));
    }
}

/// The parts of a running node.
struct Node {
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
    hold: Duration,
    latency: Latency,
    messages: u64,
    /// What was wrong when the diagnostics were last made.
    problems: Vec<String>,
    is_quiet: bool,
    names: Vec<String>,
    /// `None` where nothing but the first topics is used.
    subscriptions: Option<Subscriptions>,
    command: Option<CommandPath>,
    /// How long every topic is silent before the transport is renewed next.
    renewal_time: Duration,
    /// Messages that were not sent until the last diagnostics.
    unsent: u64,
    /// With the time of the next snapshot.
    screen: Option<(Screen, Instant)>,
    title: String,
    /// Events for the screen, the newest last.
    events: Vec<String>,
}

impl Node {
    /// A node with its channels, without options.
    fn new(
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
            screen: None,
            title: String::new(),
            events: Vec::new(),
        }
    }

    /// Uses a message; `is_timed` where its latency counts: not where it waited for the choice of topics.
    fn take(&mut self, arrival: &Arrival, is_timed: bool) -> Result<()> {
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

    /// Nothing came for as long as messages are held back.
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

    /// The loop.
    fn turn(&mut self, arrivals: &Receiver<Arrival>, stop: &dyn Fn() -> bool) -> Result<()> {
        let mut diagnostics_due = Instant::now() + DIAGNOSTICS_PERIOD;
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
                Err(RecvTimeoutError::Timeout) => self.release()?,
                Err(RecvTimeoutError::Disconnected) => break,
            }
            let now = Instant::now();
            if let Some(path) = &mut self.command {
                path.tick(now, system_ns(), &mut self.outputs, &self.inbox)?;
            }
            self.show(now);
            if now >= diagnostics_due {
                diagnostics_due = now + DIAGNOSTICS_PERIOD;
                self.diagnose(now)?;
            }
        }
        if let Some(path) = &mut self.command {
            path.stop(system_ns(), &mut self.outputs)?;
        }
        // what has arrived by now still counts
        while let Ok(arrival) = arrivals.try_recv() {
            self.take(&arrival, true)?;
        }
        self.intake.finish();
        self.release()
    }

    /// Once a second: what is wrong, in diagnostics and, where it is new, in words.
    fn diagnose(&mut self, now: Instant) -> Result<()> {
        let now_ns = system_ns();
        let mut problems: Vec<String> = self
            .senders
            .iter()
            .filter_map(|senders| senders.problem(now))
            .collect();
        let mut is_silent = false;
        for (channel, received) in self.channels.iter().zip(&self.last_received) {
            if received.is_some_and(|at| now.saturating_duration_since(at) >= SILENCE) {
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
                ("messages_dropped", self.inbox.dropped().to_string()),
                ("hold_ms", format!("{:.1}", 1e3 * self.hold.as_secs_f64())),
                ("latency_median_us", format!("{median:.0}")),
                ("latency_p999_us", format!("{high:.0}")),
                ("latency_longest_us", format!("{longest:.0}")),
            ]),
        );
        self.problems = problems;
        if is_silent {
            self.outputs
                .publish_silence(now_ns)
                .map_err(grouser_replay::Error::Sink)?;
        }
        self.outputs
            .publish_diagnostics(now_ns, status)
            .map_err(grouser_replay::Error::Sink)?;
        if !self.is_quiet {
            self.print_wheels();
        }
        Ok(())
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

    fn finish(mut self, arguments: &Arguments, robot: &grouser_slip::Robot) -> Result<Outcome> {
        // the terminal is given back before anything is printed
        self.screen = None;
        SCREEN_IS_OPEN.store(false, Ordering::Relaxed);
        if let (Some(path), Some(learnt)) = (&arguments.state, self.engine.learnt()) {
            state_file::write(path, robot, &learnt)?;
        }
        let latency = self.latency.microseconds();
        let summary = self.engine.finish(&mut self.outputs)?;
        let recorded = self
            .outputs
            .recorder
            .take()
            .map(Recorder::finish)
            .transpose()?;
        self.outputs.transport.close();
        if !arguments.quiet {
            say(&summary_line(&summary, self.messages, self.outputs.steps));
            if let Some([median, high, longest]) = latency {
                say(&format!(
                    "from a message to its slip: median {median:.0} µs, 99.9 % {high:.0} µs, longest {longest:.0} µs"
                ));
            }
            if let Some(path) = recorded {
                say(&format!("wrote {}", path.display()));
            }
        }
        let doubts = summary.doubts();
        for doubt in &doubts {
            warn(&doubt.to_string());
        }
        Ok(match summary.status {
            _ if !doubts.is_empty() => Outcome::Doubtful,
            Status::Done => Outcome::Done,
            _ => Outcome::NoSlip,
        })
    }
}

#[cfg(test)]
mod cycle_tests;

fn system_ns() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
    })
}
