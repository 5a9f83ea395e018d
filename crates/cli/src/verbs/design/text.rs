//! What `design` prints for people.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_design::mission::{MissionFront, SoilMeasure};
use grouser_report::Table;
use grouser_report::number::{rounded, shown};

use super::check::MAX_DIFFERENCE;
use super::object::{Designed, Point, station};

/// The formula of the mass does not describe the robot's wheels where it is off by more than this share.
const MAX_MASS_DIFFERENCE: f64 = 0.25;

/// Reserves are met to this.
const RESERVE_TOLERANCE: f64 = 1e-6;

impl Designed<'_> {
    pub(super) fn text(&self) -> String {
        let params = self.mission.params();
        let soils: Vec<&str> = params.soils.iter().map(|soil| soil.name.as_str()).collect();
        let mut text = format!(
            "{} on {} under {} m/s²: {}\n",
            self.carrier.name(),
            soils.join(", "),
            shown(self.carrier.gravity()),
            self.headline()
        );
        let _ = writeln!(text, "mass of one wheel, kg: {}", params.mass_formula);
        let (by_formula, by_file) = self.present_masses();
        if rounded(by_formula, 3) != rounded(by_file, 3) {
            let _ = writeln!(
                text,
                "that gives the present wheel {} kg, the robot file {} kg",
                rounded(by_formula, 3),
                rounded(by_file, 3)
            );
        }
        text.push('\n');
        text.push_str(&self.wheels());
        if let Some(point) = self.shown() {
            let title = match self.chosen() {
                Some(_) => "The chosen wheel:",
                None => "The nearest wheel:",
            };
            let _ = writeln!(text, "\n{title}");
            text.push_str(&station().table(Point(point, self).stations()));
            if self.has_shift() {
                let loads = self.carrier.all_names().zip(&point.loads);
                let loads: Vec<String> = loads
                    .map(|(name, load)| format!("{name} {} N", rounded(*load, 3)))
                    .collect();
                let slope = self.mission.params().slopes[0].slope_deg;
                let _ = writeln!(text, "loads at {} deg: {}", shown(slope), loads.join(", "));
            }
            if !point.held_by.is_empty() {
                let _ = writeln!(text, "held by: {}", point.held_by.join(", "));
            }
        }
        text.push_str(
            "Not decided here: strength, wear and life of the wheel, obstacles, turning, ruts, the drive's losses\n",
        );
        text
    }

    fn headline(&self) -> String {
        let measure = match self.mission.params().measure {
            _ if self.mission.params().soils.len() == 1 => "",
            SoilMeasure::Worst => " on the worst soil",
            SoilMeasure::Mean => " in the mean of the soils",
        };
        let Some(chosen) = self.chosen() else {
            return "no wheel within the bounds holds every slope with the reserve".to_owned();
        };
        let mut out = format!(
            "a wheel of {} kg takes {} J/m{measure}",
            rounded(chosen.wheel_mass, 4),
            rounded(chosen.energy.unwrap_or(f64::NAN), 4),
        );
        let _ = match self.present.energy {
            Some(energy)
                if self.present.least_reserve()
                    >= self.mission.params().min_reserve - RESERVE_TOLERANCE =>
            {
                write!(
                    out,
                    ", the present one of {} kg {} J/m",
                    rounded(self.present.wheel_mass, 4),
                    rounded(energy, 4)
                )
            }
            _ => write!(
                out,
                "; the present one does not hold every slope with the reserve"
            ),
        };
        if self.is_other_wheel() {
            let (by_formula, by_file) = self.present_masses();
            let _ = write!(
                out,
                "; the masses are doubtful: the formula gives the present wheel {} kg, the robot file {} kg",
                rounded(by_formula, 3),
                rounded(by_file, 3)
            );
        }
        out
    }

    /// Of the present wheel, kg: by the formula and by the robot file.
    fn present_masses(&self) -> (f64, f64) {
        let by_formula = self.mission.wheel_mass(&self.carrier.present);
        (by_formula, self.carrier.present_mass)
    }

    /// Is the formula that of other wheels than the robot's?
    fn is_other_wheel(&self) -> bool {
        let (by_formula, by_file) = self.present_masses();
        !((by_formula / by_file - 1.0).abs() <= MAX_MASS_DIFFERENCE)
    }

    fn has_shift(&self) -> bool {
        self.mission.params().ranges.mass_shift != (0.0, 0.0)
    }

    /// The front, the present wheel and, where nothing holds, the nearest.
    fn wheels(&self) -> String {
        let has_lugs = self.mission.params().ranges.grouser_count.1 > 0.0
            || self.present.wheel.grouser_count > 0.0;
        let mut table = Table::new().text("").number("radius m").number("width m");
        if has_lugs {
            table = table.number("lug height mm").number("lugs");
        }
        if self.has_shift() {
            table = table.number("mass forwards mm");
        }
        table = table
            .number("mass kg")
            .number("energy J/m")
            .number("least reserve")
            .number("saved J/m per kg");
        let MissionFront {
            points,
            chosen,
            knee,
            nearest,
            ..
        } = self.front;
        let front = points.iter().enumerate().map(|(index, point)| {
            let is = |place: Option<usize>| place == Some(index);
            let word = match (is(*chosen), is(*knee)) {
                (true, true) => "chosen, knee",
                (true, false) => "chosen",
                (false, true) => "knee",
                (false, false) => "",
            };
            (word, point)
        });
        let nearest = nearest.iter().map(|point| ("nearest", point));
        let present = std::iter::once(("present", self.present));
        for (word, point) in front.chain(nearest).chain(present) {
            let wheel = &point.wheel;
            let mut cells = vec![
                word.to_owned(),
                rounded(wheel.radius, 4),
                rounded(wheel.width, 4),
            ];
            if has_lugs {
                cells.push(rounded(1e3 * wheel.grouser_height, 3));
                cells.push(shown(wheel.grouser_count));
            }
            if self.has_shift() {
                cells.push(rounded(1e3 * wheel.mass_shift, 3));
            }
            let or_none = |x: Option<f64>, none: &str, digits| {
                x.map_or_else(|| none.to_owned(), |x| rounded(x, digits))
            };
            cells.push(rounded(point.wheel_mass, 4));
            cells.push(or_none(point.energy, "none", 4));
            cells.push(rounded(point.least_reserve(), 3));
            cells.push(or_none(point.energy_per_mass, "", 3));
            table.row(cells);
        }
        table.render()
    }

    /// What the numbers do not say by themselves.
    pub(super) fn warnings(&self, touching_radius: Option<f64>) -> Vec<String> {
        let mut list = Vec::new();
        if self.is_other_wheel() {
            let (by_formula, by_file) = self.present_masses();
            list.push(format!(
                "the formula gives the present wheel a mass of {} kg, the robot file {} kg: it does not describe this robot's wheels \
                 (`--wheel-mass-kg`)",
                rounded(by_formula, 3),
                rounded(by_file, 3)
            ));
        }
        if let Some(limit) = touching_radius {
            list.push(format!(
                "the bounds allow wheels that touch each other: from a radius of {} m",
                rounded(limit, 4)
            ));
        }
        if self.checked.difference > MAX_DIFFERENCE {
            list.push(format!(
                "the energies differ from those of `grouser climb` by up to {}: do not trust this design",
                rounded(self.checked.difference, 2)
            ));
        }
        if let Some(slope) = self.checked.lifts_at {
            list.push(format!(
                "a wheel loses the ground on a slope of {} deg: its load is not what the design assumes",
                shown(slope)
            ));
        }
        if self.checked.tip_over.is_some_and(|margin| !(margin > 0.0)) {
            list.push(
                "the robot with the chosen wheel tips over on a slope of the mission".to_owned(),
            );
        }
        list.extend(
            self.checked
                .cautions
                .iter()
                .map(|(caution, (soil, slope))| {
                    format!("caution on {soil} at {} deg: {caution}", shown(*slope))
                }),
        );
        let kept = self.carrier.names(false);
        if !kept.is_empty() {
            list.push(format!(
                "{} stays as it is and stays on the ground: its mounting must follow where the chassis rises or sinks",
                kept.join(", ")
            ));
        }
        if self.front.unsolved > 0 && !self.front.points.is_empty() {
            list.push(format!(
                "{} of the solves led to no wheel: the front has gaps",
                self.front.unsolved
            ));
        }
        list
    }
}
