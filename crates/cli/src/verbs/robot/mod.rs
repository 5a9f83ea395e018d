//! `robot`: a robot file of a URDF; the robot at rest.

mod stance;

use std::path::PathBuf;

use grouser_files::robot::RobotFile;
use grouser_files::{Document, regular, robot, urdf};
use grouser_slip::{Wheel, WheelRole};

use crate::error::{Error, Result};
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;
use grouser_report::{Fields, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Make a robot file from a URDF, or print the static loads and margins of a robot",
    long_about = "Make a robot file from a URDF: positions of its wheels, their radii, widths and masses, rockers with their \
        differential, steering, and the body's mass. Macros (xacro) must be expanded first. Motors and encoders are \
        not in a URDF and are added by hand; docs/robots.md says how.\n\nWith --stance: what each wheel of a robot file carries \
        on a slope, the tip-over margin of the robot, and the chassis adjusted for the slope.",
    after_help = "Examples:\n  grouser robot husky.urdf -o husky.toml\n  grouser estimate run.mcap --robot husky.toml\n  \
        grouser robot examples/robots/five-wheel.toml --stance --pitch-deg 15"
)]
pub(crate) struct Arguments {
    /// The robot's description (.urdf); with --stance its robot file (.toml)
    #[arg(value_name = "ROBOT")]
    description: PathBuf,
    /// Write the robot file here; without it, it is printed
    #[arg(short, long, value_name = "R.toml")]
    output: Option<PathBuf>,
    #[command(flatten)]
    stance: stance::Arguments,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let path = &arguments.description;
    if arguments.stance.is_given() {
        return stance::run(path, &arguments.stance, session);
    }
    let text = regular::read_text(path, urdf::SIZE_LIMIT)?;
    session.used_file(path)?;
    let made = urdf::robot_file(&text).map_err(|error| {
        let is_other = matches!(error, urdf::UrdfError::Xml { .. });
        let other = "a description is read in URDF, which is XML; `--stance` reads a robot file";
        let hint = error.hint().or_else(|| is_other.then(|| other.to_owned()));
        Error::content(path, &error, hint)
    })?;
    // what was made is read as any robot file is, so that nothing wrong is written
    let name = arguments
        .output
        .as_deref()
        .unwrap_or(path)
        .display()
        .to_string();
    let robot = robot::parse(&Document::from_text(&name, made.text.clone())?)?;
    let mut said = match &arguments.output {
        None => made.text.clone(),
        Some(output) => {
            let wrote = OutputFile::create(output)?.write_whole(made.text.as_bytes())?;
            format!("{wrote}\n{}", table(&robot))
        }
    };
    if arguments.output.is_some() {
        for note in &made.notes {
            said.extend(["NOTE: ", note, "\n"]);
        }
    }
    let object = fields().object((&robot, &made));
    Ok(match arguments.output {
        None => Report::file(object, said),
        Some(_) => Report::done(object, said),
    })
}

type Made<'a> = (&'a RobotFile, &'a urdf::Converted);

fn fields<'a>() -> Fields<'a, Made<'a>> {
    fields! { |made: Made<'a>|
        "name" "name of the robot" = made.1.name.as_str();
        "wheels" "its wheels" named(wheel()) =
            made.0.robot.wheels().iter().map(|wheel| (wheel.name.as_str(), wheel));
        "robot_file" "the robot file" = made.1.text.as_str();
        "notes" "what must be added or checked by hand" = made.1.notes.clone();
    }
}

fn wheel<'a>() -> Fields<'a, &'a Wheel> {
    fields! { |wheel: &'a Wheel|
        "x_m" "x" .shown("m") = wheel.x;
        "y_m" "y" .shown("m") = wheel.y;
        "heading_deg" "heading" = wheel.heading.deg();
        "radius_m" "radius" .shown("m") = wheel.radius;
        "width_m" "width" .shown("m") = wheel.width;
        "drive" "drive" .shown("") = drive(wheel.role);
    }
}

fn table(robot: &RobotFile) -> String {
    let columns = fields! { |wheel: &'_ Wheel|
        remark "wheel" = wheel.name.as_str();
        join(self::wheel()) = wheel;
    };
    columns.table(robot.robot.wheels())
}

const fn drive(drive: WheelRole) -> &'static str {
    match drive {
        WheelRole::Powered => "powered",
        WheelRole::Free => "free",
    }
}

/// The JSON schema: of a robot file, or of a robot at rest.
pub(crate) fn schema() -> serde_json::Value {
    serde_json::json!({"anyOf": [fields().schema(), stance::fields().schema()]})
}
