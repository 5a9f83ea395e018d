//! `robot`: a robot file of a URDF; the robot at rest.

mod stance;

use std::path::PathBuf;

use grouser_files::robot::RobotFile;
use grouser_files::{Document, regular, robot, urdf};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::input::Input;
use crate::output::OutputFile;
use crate::report::{Object, Report};
use crate::session::Session;
use grouser_report::Table;
use grouser_report::number::rounded;

#[derive(clap::Args, Debug)]
#[command(
    about = "Make a robot file of a URDF, or print how a robot stands",
    long_about = "Make a robot file of a URDF: where its wheels stand, their radii, widths and masses, rockers with their \
        differential, steering, and the body's mass. Macros (xacro) must be expanded first. Motors and encoders are \
        not in a URDF and are added by hand; docs/robots.md says how.\n\nWith --stance: what each wheel of a robot file carries \
        on a slope, how far the robot is from tipping over, and the chassis adjusted for the slope.",
    after_help = "Examples:\n  grouser robot husky.urdf -o husky.toml\n  grouser estimate run.mcap --robot husky.toml\n  \
        grouser robot examples/robots/five-wheel.toml --stance --pitch-deg 15"
)]
pub(crate) struct Arguments {
    /// The robot's description (.urdf); with --stance its robot file (.toml)
    #[arg(value_name = "ROBOT")]
    description: PathBuf,
    /// Write the robot file here; it is printed unless told
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
    let mut input = Input::open(path)?;
    std::io::copy(&mut input, &mut std::io::sink())
        .map_err(|error| Error::file("read", path, &error))?;
    session.used_input(input);
    let made = urdf::robot_file(&text).map_err(|error| Error::Content {
        path: path.clone(),
        message: error.to_string(),
        hint: error.hint(),
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
            format!("{}\n{wrote}", table(&robot))
        }
    };
    if arguments.output.is_some() {
        for note in &made.notes {
            said.extend(["note: ", note, "\n"]);
        }
    }
    Ok(Report::done(object(&robot, &made), said))
}

fn table(robot: &RobotFile) -> String {
    let mut table = Table::new()
        .text("wheel")
        .number("x, m")
        .number("y, m")
        .number("radius, m")
        .number("width, m")
        .text("drive");
    for wheel in robot.robot.wheels() {
        let width = wheel
            .width
            .map_or_else(|| "—".to_owned(), |width| rounded(width, 4));
        table.row([
            wheel.name.as_str(),
            &rounded(wheel.x, 4),
            &rounded(wheel.y, 4),
            &rounded(wheel.radius, 4),
            &width,
            drive(wheel.role),
        ]);
    }
    table.render()
}

const fn drive(drive: grouser_slip::WheelRole) -> &'static str {
    match drive {
        grouser_slip::WheelRole::Powered => "powered",
        grouser_slip::WheelRole::Free => "free",
    }
}

fn object(robot: &RobotFile, made: &urdf::Converted) -> Object {
    let wheels: Object = robot
        .robot
        .wheels()
        .iter()
        .map(|wheel| {
            let values = [
                ("x_m", Value::from(wheel.x)),
                ("y_m", Value::from(wheel.y)),
                ("heading_deg", Value::from(wheel.heading.deg())),
                ("radius_m", Value::from(wheel.radius)),
                ("width_m", Value::from(wheel.width)),
                ("drive", Value::from(drive(wheel.role))),
            ];
            let values = values.map(|(key, value)| (key.to_owned(), value));
            (wheel.name.clone(), Value::Object(Object::from_iter(values)))
        })
        .collect();
    Object::from_iter([
        ("name".to_owned(), Value::from(made.name.as_str())),
        ("wheels".to_owned(), Value::Object(wheels)),
        ("robot_file".to_owned(), Value::from(made.text.as_str())),
        (
            "notes".to_owned(),
            made.notes.iter().map(String::as_str).collect(),
        ),
    ])
}
