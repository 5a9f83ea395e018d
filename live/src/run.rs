//! A run of the node: from the options to its end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use grouser_files::robot::{self, RobotFile};
use grouser_replay::{Engine, Inputs, Options, RobotSamples};
use grouser_slip::Reference;

use crate::arguments::Arguments;
use crate::command::CommandPath;
use crate::environment::{Environment, restart_with};
use crate::error::{Error, Result};
use crate::look::{Subscriptions, look};
use crate::node::{Node, Outcome};
use crate::outputs::{Frames, Outputs};
use crate::print::{SCREEN_IS_OPEN, complain, say, say_choice, warn};
use crate::recorder::Recorder;
use crate::screen::Screen;
use crate::state_file;
use crate::transport::{self, Transport};

/// Runs the node until Ctrl-C, SIGTERM, or the end of its time.
///
/// # Errors
/// Bad options, files and topics; a transport that does not open.
pub fn run(arguments: &Arguments) -> Result<Outcome> {
    let environment = Environment::read()?;
    let kind = arguments.transport.unwrap_or(environment.transport);
    // before anything is opened
    restart_with(kind.variable());
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
    let (inbox, mut arrivals) = transport::inbox();
    let mut subscriptions = Subscriptions::new(&robot);
    if !arguments.quiet {
        say(&format!(
            "{own_name} listens on {}, domain {}",
            kind.name(),
            environment.domain
        ));
    }
    let queue = (&inbox, &mut arrivals);
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
    let kept = (arguments, &robot.robot);
    node.run(&looked.backlog, &mut arrivals, &stop, kept)
}

pub(crate) fn wheel_names(robot: &RobotFile) -> Vec<String> {
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
