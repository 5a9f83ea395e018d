//! The estimator on a stream of messages: the five-wheeled robot's MCAP file, pushed message by message as a live
//! source would push them. Prints each wheel's slip once a second.

use std::io::Write as _;
use std::path::Path;

use grouser_files::robot::{self, WheelSensor};
use grouser_log::Preview;
use grouser_log::container::{Container, Event};
use grouser_replay::{Engine, Inputs, Options, Row, Sink};
use grouser_slip::Reference;

/// Prints the first row of each wheel in every second.
#[derive(Default)]
struct EverySecond {
    second: i64,
    printed: u64,
}

impl Sink for EverySecond {
    #[allow(
        clippy::cast_possible_truncation,
        reason = "a log is shorter than 2^63 s"
    )]
    fn row(&mut self, row: &Row<'_>) -> std::io::Result<()> {
        let second = row.time_s as i64;
        if second != self.second {
            (self.second, self.printed) = (second, 0);
        }
        if self.printed >> row.wheel & 1 == 0 {
            self.printed |= 1 << row.wheel;
            let out = &mut std::io::stdout();
            writeln!(
                out,
                "{:5.1} s  {:12} slip {:?}",
                row.time_s, row.name, row.slip
            )?;
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let example = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/five-wheel"
    ));
    let robot = robot::read(&example.join("robot.toml"))?;
    let recording = example.join("log.mcap");

    // The first messages tell which topics measure what; a live source pushes them into the preview as well.
    let mut preview = Preview::new(&robot.topics);
    preview.read(&recording)?;
    let mut intake = preview.into_intake()?;
    let inputs = Inputs {
        wheel_sensor: WheelSensor::Count,
        reference: Reference::FreeWheel,
        speed_place: [0.0; 2],
        position_sigma: None,
        is_acceleration_forward_only: false,
    };
    let mut engine = Engine::new(&robot, inputs, &Options::default())?;

    let mut sink = EverySecond::default();
    let mut messages = Container::open(&recording)?;
    while let Some(event) = messages.next() {
        if let Event::Message(message) = event {
            let channel = intake.channel(message.of);
            intake.push(channel, message.data, message.log_time_ns);
        }
        while let Some(sample) = intake.pop() {
            engine.push(sample, &mut sink)?;
        }
    }
    intake.finish();
    while let Some(sample) = intake.pop() {
        engine.push(sample, &mut sink)?;
    }
    let summary = engine.finish(&mut sink)?;
    let out = &mut std::io::stdout();
    writeln!(out, "slip of the whole way: {:?}", summary.along.overall)?;
    Ok(())
}
