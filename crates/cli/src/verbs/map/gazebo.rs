//! A slip map for gz-sim's system `LookupWheelSlip`: a picture, and the SDF of the systems that read it.
//!
//! Source: `LookupWheelSlip.hh` and `.cc` of gz-sim 10 (gazebosim/gz-sim, pull request 3003) and
//! `WheelSlip.cc`. A pixel's green value G adds (G − 128) · delta to the longitudinal slip compliance c of
//! the wheel on it, its blue value the same to the friction coefficients; red, the sideways compliance, is
//! not in a map and stays 128, "unchanged". The wheel slips by c · F / N, with its pull F and the constant N
//! of the system.
//!
//! Pixel (u, v) is read within half a pixel around x = u·p − S/2, y = S/2 − v·p, for a picture of the side S
//! with pixels of p. Rows are found by v · height + u, so that only a square picture is read as it is drawn.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::PathBuf;

use grouser_figure::{Colour, Picture, escaped};
use grouser_rover::robot::RobotModel;
use grouser_terrain::{Band, MapLayout, MapMaker, Quantity};

use super::outputs::CellFile;
use crate::error::{Error, Result};
use crate::output::OutputFile;

/// The value of a colour that changes nothing.
const NOMINAL: u8 = 128;
/// Steps of the two colours: compliances up to 5.1, friction from −0.28, which the system takes for 0, to
/// 2.27.
const COMPLIANCE_STEP: f64 = 0.02;
const FRICTION_STEP: f64 = 0.01;
/// The friction coefficient of SDF's collisions unless the model gives another one.
const SDF_FRICTION_COEFFICIENT: f64 = 1.0;
/// On flatter ground the pull of the wheels is that of this pitch, rad (5°): rolling itself takes slip, but
/// no pull in gz-sim.
const MIN_PITCH_RAD: f64 = 0.087;

/// The picture in the making.
pub(super) struct SlipPicture<'a> {
    file: OutputFile,
    image: PathBuf,
    layout: &'a MapLayout,
    maker: &'a MapMaker,
    model: &'a RobotModel,
    pixels: Vec<Colour>,
}

impl<'a> SlipPicture<'a> {
    pub(super) fn new(
        file: OutputFile,
        layout: &'a MapLayout,
        (maker, model): (&'a MapMaker, &'a RobotModel),
    ) -> Self {
        let image = file.path().with_extension("png");
        let side = side(layout) as usize;
        Self {
            file,
            image,
            layout,
            maker,
            model,
            pixels: vec![Colour(NOMINAL, NOMINAL, NOMINAL); side * side],
        }
    }

    /// The colour of a cell: that of its steepest heading uphill. Unknown ground changes nothing.
    fn colour(&self, cell: &[f32]) -> Colour {
        let headings = self.layout.headings;
        let value = |quantity, heading| f64::from(cell[Band { quantity, heading }.index(headings)]);
        let pitch = |heading: &usize| value(Quantity::Pitch, *heading);
        let uphill = (0..headings.count()).filter(|heading| pitch(heading) >= 0.0);
        let Some(steepest) = uphill.max_by(|a, b| pitch(a).total_cmp(&pitch(b))) else {
            return Colour(NOMINAL, NOMINAL, NOMINAL);
        };
        let pull = pitch(&steepest).to_radians().max(MIN_PITCH_RAD).sin() / self.powered_share();
        let slip = value(Quantity::Slip, steepest);
        let compliance = if slip.is_nan() {
            f64::INFINITY
        } else {
            slip.max(0.0) / pull
        };
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a soil's number; anything else finds no soil"
        )]
        let soil = value(Quantity::Soil, steepest) as usize;
        let friction = self
            .maker
            .soils()
            .get(soil)
            .map_or(SDF_FRICTION_COEFFICIENT, |soil| {
                soil.steepest()[0].tan() / self.powered_share()
            });
        Colour(
            NOMINAL,
            step(compliance / COMPLIANCE_STEP),
            step(f64::from(NOMINAL) + (friction - SDF_FRICTION_COEFFICIENT) / FRICTION_STEP),
        )
    }

    /// Powered wheels as a share of all: they carry the pull of the others too.
    fn powered_share(&self) -> f64 {
        self.model.powered().count() as f64 / self.model.wheels.len() as f64
    }

    fn sdf(&self) -> String {
        let side = f64::from(side(self.layout)) * self.layout.cell;
        let load = self.model.weight() / self.model.wheels.len() as f64;
        let image = self.image.file_name().unwrap_or_default();
        let image = escaped(&image.to_string_lossy());
        let mut wheels = String::new();
        let mut names = String::new();
        for mount in self.model.powered().map(|index| &self.model.wheels[index]) {
            let name = escaped(&mount.name);
            let _ = write!(
                wheels,
                "      <wheel link_name=\"{name}\">\n        \
                 <slip_compliance_longitudinal>{}</slip_compliance_longitudinal>\n        \
                 <wheel_normal_force>{load}</wheel_normal_force>\n        \
                 <wheel_radius>{}</wheel_radius>\n      </wheel>\n",
                f64::from(NOMINAL) * COMPLIANCE_STEP,
                mount.wheel.radius()
            );
            let _ = writeln!(names, "      <wheel_link_name>{name}</wheel_link_name>");
        }
        format!(
            "<?xml version=\"1.0\"?>\n<!--\n  Put both systems into the model of the robot; link_name is that of the wheel's link \
             there.\n  The wheels' collisions have the friction coefficients mu = mu2 = {SDF_FRICTION_COEFFICIENT}.\n  The centre of the \
             map's upper left cell lies at x = {}, y = {} of the world.\n-->\n<sdf version=\"1.9\">\n  <model name=\"{}\">\n    \
             <plugin filename=\"gz-sim-wheel-slip-system\" name=\"gz::sim::systems::WheelSlip\">\n{wheels}    \
             </plugin>\n    \
             <plugin filename=\"gz-sim-lookup-wheel-slip-system\" \
             name=\"gz::sim::systems::LookupWheelSlip\">\n      \
             <slip_map>{image}</slip_map>\n      <size_x>{side}</size_x>\n      <size_y>{side}</size_y>\n      \
             <slip_compliance_longitudinal_delta>{COMPLIANCE_STEP}</slip_compliance_longitudinal_delta>\n      \
             <friction_delta>{FRICTION_STEP}</friction_delta>\n{names}    </plugin>\n  </model>\n</sdf>\n",
            -0.5 * side,
            0.5 * side,
            escaped(&self.layout.robot),
        )
    }
}

impl CellFile for SlipPicture<'_> {
    fn see(&mut self, strip: u32, cells: &[f32]) -> Result<()> {
        let (columns, side) = (self.layout.columns as usize, side(self.layout) as usize);
        let first = self.layout.rows_of(strip).start as usize;
        for (index, cell) in cells.chunks_exact(self.layout.bands()).enumerate() {
            let (row, column) = (first + index / columns, index % columns);
            self.pixels[row * side + column] = self.colour(cell);
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<String> {
        let text = self.sdf();
        let side = side(self.layout);
        let picture = Picture::new([side, side], |column, row| {
            self.pixels[(row * side + column) as usize]
        });
        let bytes = picture
            .png()
            .map_err(|error| Error::usage_without_hint(error.to_string()))?;
        let written = OutputFile::create(&self.image)?.write_whole(&bytes)?;
        Ok(written + &self.file.write_whole(text.as_bytes())?)
    }
}

/// The picture is square: the longer side of the map, filled up at the right and below.
fn side(layout: &MapLayout) -> u32 {
    layout.columns.max(layout.rows)
}

/// The nearest value of a colour.
fn step(value: f64) -> u8 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and 255, as just clamped"
    )]
    let step = value.clamp(0.0, 255.0).round() as u8;
    step
}
