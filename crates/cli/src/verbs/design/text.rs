//! What `design` prints for people.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_design::mission::{MissionFront, SoilMeasure};
use grouser_report::number::{rounded, shown};
use grouser_report::{Layout, fields};

use super::check::MAX_DIFFERENCE;
use super::object::{self, Designed, Point, station};
use crate::model_error;

/// The formula of the mass does not describe the robot's wheels where it is off by more than this share.
const MAX_MASS_DIFFERENCE: f64 = 0.25;

/// Reserves are met to this.
const RESERVE_TOLERANCE: f64 = 1e-6;

impl Designed<'_> {
    pub(super) fn text(&self) -> String {
        let params = self.mission.params();
        let soils: Vec<&str> = params.soils.iter().map(|soil| soil.name.as_str()).collect();
        let mut text = format!("{}: {}\n", self.carrier.name(), self.headline());
        if self.is_other_wheel() {
            let _ = writeln!(text, "WARNING: {}", self.mass_warning());
        }
        let _ = writeln!(
            text,
            "on {} under {} m/s²\n\n{}",
            soils.join(", "),
            shown(self.carrier.gravity()),
            self.wheels()
        );
        if let Some(point) = self.shown() {
            let title = match self.chosen() {
                Some(_) => "The chosen wheel:",
                None => "The nearest wheel:",
            };
            let _ = writeln!(text, "{title}");
            text.push_str(&station().table(Point(point, self).stations()));
            if !point.held_by.is_empty() {
                let _ = writeln!(text, "active limits: {}", point.held_by.join(", "));
            }
            if let Some(error) = Point(point, self).reserve_error() {
                let error = rounded(error, 2);
                let _ = writeln!(
                    text,
                    "90 % of measurements lie within ±{error} of a pull margin"
                );
            }
            if Layout::current().details {
                let loads = self.carrier.all_names().zip(&point.loads);
                let loads: Vec<String> = loads
                    .map(|(name, load)| format!("{name} {} N", shown(*load)))
                    .collect();
                let slope = shown(params.slopes[0].slope_deg);
                let _ = writeln!(text, "loads at {slope} deg: {}", loads.join(", "));
            }
        }
        let (by_formula, by_file) = self.present_masses();
        if Layout::current().details || shown(by_formula) != shown(by_file) {
            let _ = writeln!(
                text,
                "mass of one wheel, kg: {}\nit gives the present wheel {} kg, the robot file {} kg",
                params.mass_formula,
                shown(by_formula),
                shown(by_file)
            );
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
            return "no wheel within the bounds holds every slope with the pull margin".to_owned();
        };
        let doubt = if self.is_other_wheel() {
            " (masses uncertain)"
        } else {
            ""
        };
        let [mass, present_mass] = [chosen, self.present].map(|point| shown(point.wheel_mass));
        let chosen_energy = chosen.energy.unwrap_or(f64::NAN);
        let holds =
            self.present.least_reserve() >= self.mission.params().min_reserve - RESERVE_TOLERANCE;
        let present = match self.present.energy.filter(|_| holds) {
            Some(energy)
                if energy <= chosen_energy && self.present.wheel_mass <= chosen.wheel_mass =>
            {
                let (by_formula, by_file) = self.present_masses();
                let formula = if shown(by_formula) == shown(by_file) {
                    String::new()
                } else {
                    let mass = shown(by_formula);
                    format!("; the mass formula gives the present wheel {mass} kg")
                };
                return format!(
                    "keep the present wheel of {present_mass} kg: it needs {} J/m{measure}, the best found, of {mass} kg, needs {} J/m{doubt}{formula}",
                    shown(energy),
                    shown(chosen_energy)
                );
            }
            Some(energy) => format!("needs {} J/m", shown(energy)),
            None => "does not hold every slope with the pull margin".to_owned(),
        };
        format!(
            "a wheel of {mass} kg needs {} J/m{measure}{doubt}; the present one of {present_mass} kg {present}",
            shown(chosen_energy)
        )
    }

    fn mass_warning(&self) -> String {
        let (by_formula, by_file) = self.present_masses();
        format!(
            "the formula gives the present wheel a mass of {} kg, the robot file {} kg: it does not describe this robot's wheels \
             (`--wheel-mass-kg`)",
            shown(by_formula),
            shown(by_file)
        )
    }

    /// The mass of the present wheel, kg, by the formula and by the robot file.
    fn present_masses(&self) -> (f64, f64) {
        let by_formula = self.mission.wheel_mass(&self.carrier.present);
        (by_formula, self.carrier.present_mass)
    }

    /// Does the formula describe other wheels than the robot's?
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
        let mut keys = vec!["", "radius_m", "width_m"];
        if has_lugs {
            keys.extend(["grouser_height_m", "grouser_count"]);
        }
        if self.has_shift() {
            keys.push("mass_shift_m");
        }
        keys.extend([
            "wheel_mass_kg",
            "energy_j_per_m",
            "least_reserve",
            "energy_saved_j_per_m_kg",
        ]);
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
                (true, true) => "chosen, best trade-off",
                (true, false) => "chosen",
                (false, true) => "best trade-off",
                (false, false) => "",
            };
            (word, point)
        });
        let nearest = nearest.iter().map(|point| ("nearest", point));
        let present = std::iter::once(("present", self.present));
        let columns = fields! { |of: (&'static str, Point<'_>)|
            remark "" = of.0;
            join(object::point()) = of.1;
        };
        let rows = front.chain(nearest).chain(present);
        columns
            .pick(&keys)
            .table(rows.map(|(word, point)| (word, Point(point, self))))
    }

    /// What the numbers do not say by themselves.
    pub(super) fn warnings(&self, touching_radius: Option<f64>) -> Vec<String> {
        let mut list = Vec::new();
        if Point(self.present, self).reserve_error().is_none() {
            list.push(model_error::UNKNOWN.to_owned());
        }
        if self.is_other_wheel() {
            list.push(self.mass_warning());
        }
        if let Some(limit) = touching_radius {
            list.push(format!(
                "the bounds allow wheels that touch each other: from a radius of {} m",
                shown(limit)
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
                "{} stays unchanged and on the ground: its mounting must follow where the chassis rises or sinks",
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
