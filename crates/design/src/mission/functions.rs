//! A mission as a problem of the optimiser.

use grouser_opt::{Exact, Functions, Problem, ProblemParams, Variable};
use grouser_real::Scalar;

use super::wheel::{COUNT, SIZES};
use super::{MissionProfile, SoilMeasure, WheelDesign};
use crate::error::{Error, Result};

/// What a search minimises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// The energy per metre, with a mass of the wheel (kg) that must not be exceeded.
    Energy { max_mass: Option<f64> },
    /// The mass of the wheel.
    Mass,
    /// The shortage of pull, for missions that no wheel holds.
    Shortage,
}

/// A search over the sizes that are free. A variable of the solver is the share of the way from a size's lower to its upper bound.
#[derive(Clone, Debug)]
pub(super) struct Task<'m> {
    pub(super) mission: &'m MissionProfile,
    pub(super) aim: Aim,
    /// The fixed sizes.
    pub(super) base: WheelDesign,
    /// The places of the free ones.
    pub(super) free: Vec<usize>,
    /// Energies are divided by this, N, and masses by `mass`, kg, so that objectives are about 1.
    pub(super) weight: f64,
    pub(super) mass: f64,
}

impl<'m> Task<'m> {
    pub(super) fn new(mission: &'m MissionProfile, aim: Aim) -> Self {
        let ranges = mission.params.ranges.list();
        let middle = WheelDesign::from_sizes(ranges.map(|(low, high)| 0.5 * (low + high)));
        let free = (0..SIZES).filter(|&i| ranges[i].0 < ranges[i].1).collect();
        Self {
            mission,
            aim,
            base: middle,
            free,
            weight: mission.weight(&middle),
            mass: mission.wheel_mass(&middle),
        }
    }

    /// The same with the number of lugs fixed.
    pub(super) fn with_count(&self, count: f64) -> Self {
        let mut out = self.clone();
        out.base.grouser_count = count;
        out.free.retain(|place| *place != COUNT);
        out
    }

    pub(super) fn wheel(&self, x: &[f64]) -> WheelDesign {
        WheelDesign::from_sizes(self.sizes(x))
    }

    fn sizes<R: Scalar>(&self, x: &[R]) -> [R; SIZES] {
        let mut sizes = self.base.sizes().map(R::from_f64);
        let ranges = self.mission.params.ranges.list();
        for (place, share) in self.free.iter().zip(x) {
            let (low, high) = ranges[*place];
            sizes[*place] = R::from_f64(low) + *share * R::from_f64(high - low);
        }
        sizes
    }

    /// A wheel in the solver's variables.
    pub(super) fn place(&self, wheel: &WheelDesign) -> Vec<f64> {
        let (sizes, ranges) = (wheel.sizes(), self.mission.params.ranges.list());
        let share = |place: &usize| {
            let (low, high) = ranges[*place];
            ((sizes[*place] - low) / (high - low)).clamp(0.0, 1.0)
        };
        self.free.iter().map(share).collect()
    }

    fn stations(&self) -> usize {
        self.mission.params.soils.len() * self.mission.params.slopes.len()
    }

    fn objectives(&self) -> Vec<String> {
        let soils = &self.mission.params.soils;
        match (self.aim, self.mission.params.measure) {
            (Aim::Energy { .. }, SoilMeasure::Worst) => soils
                .iter()
                .map(|s| format!("energy @ {}", s.name))
                .collect(),
            (Aim::Energy { .. }, SoilMeasure::Mean) => vec!["mean energy".to_owned()],
            (Aim::Mass, _) => vec!["wheel mass".to_owned()],
            (Aim::Shortage, _) => self.station_names("shortage"),
        }
    }

    fn station_names(&self, what: &str) -> Vec<String> {
        let params = &self.mission.params;
        let mut names = Vec::with_capacity(self.stations());
        for soil in &params.soils {
            for slope in &params.slopes {
                names.push(format!(
                    "{what} on {} at {} deg",
                    soil.name, slope.slope_deg
                ));
            }
        }
        names
    }

    fn inequalities(&self) -> Vec<String> {
        let mut names = match self.aim {
            Aim::Shortage => Vec::new(),
            _ => self.station_names("pull margin"),
        };
        if let Aim::Energy { max_mass: Some(_) } = self.aim {
            names.push("wheel mass".to_owned());
        }
        names
    }

    /// The problem, from a wheel to begin with.
    pub(super) fn problem(&self, start: &WheelDesign) -> Result<Problem<'_>> {
        let start = self.place(start);
        let variables =
            self.free.iter().zip(&start).map(|(place, start)| {
                Variable::bounded(WheelDesign::NAMES[*place], *start, 0.0, 1.0)
            });
        let objectives = self.objectives();
        let params = ProblemParams::new(&start, objectives.len(), Exact(self))
            .variables(variables.collect::<Vec<_>>())
            .objectives(objectives)
            .inequalities(self.inequalities());
        Problem::new(params).map_err(|source| Error::Problem {
            file: "the mission".to_owned(),
            source,
        })
    }
}

impl Functions for &Task<'_> {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let params = &self.mission.params;
        out.fill(R::from_f64(f64::NAN));
        let sizes = self.sizes(x);
        let mass = self.mission.mass.evaluate(&sizes);
        let per_weight = R::from_f64(1.0 / self.weight);
        let (mut energies, mut reserves) = (Vec::new(), Vec::with_capacity(self.stations()));
        for soil in 0..params.soils.len() {
            let Ok(states) = self.mission.states(soil, &sizes) else {
                return;
            };
            let mut energy = R::ZERO;
            for (state, slope) in states.iter().zip(&params.slopes) {
                energy += state.energy * R::from_f64(slope.share);
                reserves.push(state.reserve / self.mission.stance.weight(mass));
            }
            energies.push(energy * per_weight);
        }
        let least = R::from_f64(params.min_reserve);
        let mut values = Vec::with_capacity(out.len());
        match (self.aim, params.measure) {
            (Aim::Energy { .. }, SoilMeasure::Worst) => values.append(&mut energies),
            (Aim::Energy { .. }, SoilMeasure::Mean) => {
                let soils = energies.iter().zip(&params.soils);
                let mean = soils.fold(R::ZERO, |sum, (energy, soil)| {
                    sum + *energy * R::from_f64(soil.share)
                });
                values.push(mean);
            }
            (Aim::Mass, _) => values.push(mass * R::from_f64(1.0 / self.mass)),
            (Aim::Shortage, _) => {}
        }
        values.extend(reserves.iter().map(|reserve| least - *reserve));
        if let Aim::Energy {
            max_mass: Some(max_mass),
        } = self.aim
        {
            values.push(mass * R::from_f64(1.0 / max_mass) - R::ONE);
        }
        out.copy_from_slice(&values);
    }
}

#[cfg(test)]
mod tests {
    use grouser_opt::check_derivatives;
    use grouser_terra::{RigidWheel, catalogue};

    use super::*;
    use crate::mission::{
        MissionParams, MissionWheel, SlopeShare, SoilShare, Standing, WheelRanges,
    };

    /// Two soils, two slopes, two axles that carry unequally, a free wheel, lugs: everything that has derivatives.
    #[test]
    fn derivatives_are_those_of_differences() {
        let soil = |name: &str| SoilShare {
            name: name.to_owned(),
            soil: catalogue::find(name).unwrap().soil().unwrap(),
            share: 0.5,
        };
        let slopes =
            [(0.0, 0.7), (8.0, 0.3)].map(|(slope_deg, share)| SlopeShare { slope_deg, share });
        let free = MissionWheel::kept(RigidWheel::new(0.08, 0.04).unwrap(), Some(0.002));
        let wheels = vec![MissionWheel::designed(), MissionWheel::designed(), free];
        let ranges = WheelRanges {
            radius: (0.1, 0.2),
            width: (0.06, 0.15),
            grouser_height: (0.004, 0.012),
            grouser_count: (8.0, 24.0),
            grouser_thickness: (0.002, 0.002),
            mass_shift: (-0.05, 0.1),
        };
        let soils = vec![soil("dry-sand"), soil("lunar")];
        let mission = MissionProfile::new(
            MissionParams::new(wheels, soils, slopes.to_vec(), ranges),
            |radius, mass, ahead| {
                let weight = 60.0 + 9.81 * mass * 2.0;
                let loads = slopes.iter().map(|slope| {
                    let (sin, cos) = slope.slope_deg.to_radians().sin_cos();
                    let shift = weight * sin * (0.1 + radius) / 0.4 - 60.0 * cos * ahead / 0.4;
                    let half = 0.5 * (weight * cos - 2.0);
                    vec![half - shift, half + shift, 2.0]
                });
                Ok::<_, Error>(Standing {
                    weight,
                    loads: loads.collect(),
                })
            },
        )
        .unwrap();
        for aim in [
            Aim::Energy {
                max_mass: Some(1.0),
            },
            Aim::Mass,
            Aim::Shortage,
        ] {
            let task = Task::new(&mission, aim);
            assert_eq!(task.free.len(), 5);
            let problem = task.problem(&task.base).unwrap();
            for x in [
                [0.5; 5],
                [0.1, 0.9, 0.3, 0.8, 0.7],
                [0.9, 0.2, 0.7, 0.1, 0.2],
            ] {
                let check = check_derivatives(&problem, &x, 1e-5).unwrap();
                assert!(check.wrong.is_empty(), "{aim:?} {x:?} {check:?}");
            }
        }
    }
}
