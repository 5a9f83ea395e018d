//! How to search for a front.

use super::mutation::Mutation;
use super::sbx::Crossover;
use crate::error::{Error, Result};
use crate::settings::Settings;

/// Which evolutionary search covers the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Algorithm {
    /// Rank and crowding: for two objectives.
    NsgaII,
    /// Rank and reference directions: for three and more.
    NsgaIII,
}

/// How to search for a front.
///
/// ```
/// let mut settings = grouser_opt::ParetoSettings::default();
/// settings.population = 60;
/// assert!(settings.polish); // each point is exact to the solver's tolerance
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ParetoSettings {
    /// The search; `None` takes NSGA-II for two objectives and NSGA-III for more.
    pub algorithm: Option<Algorithm>,
    /// Points kept from generation to generation.
    pub population: usize,
    /// Generations.
    pub generations: usize,
    /// Divisions of the simplex for NSGA-III's directions; `None` takes the most for which there are
    /// no more directions than points.
    pub divisions: Option<usize>,
    /// Crossover; `None` takes η = 20 for NSGA-II and 30 for NSGA-III, every pair crossed.
    pub crossover: Option<Crossover>,
    /// Mutation; `None` takes η = 15 for NSGA-II and 60 for NSGA-III, one variable in each point on average.
    pub mutation: Option<Mutation>,
    /// The seed of the random stream.
    pub seed: u64,
    /// Polish every point by a goal-attainment solve.
    pub polish: bool,
    /// How exactly to polish.
    pub solve: Settings,
}

impl Default for ParetoSettings {
    fn default() -> Self {
        Self {
            algorithm: None,
            population: 100,
            generations: 250,
            divisions: None,
            crossover: None,
            mutation: None,
            seed: 1,
            polish: true,
            solve: Settings::default(),
        }
    }
}

/// Members of a population, and directions of NSGA-III, at most. To sort them compares all pairs: at this number a
/// generation takes a second, at ten times as many two minutes.
pub const MAX_POPULATION: u16 = 10_000;

impl ParetoSettings {
    pub(super) fn algorithm_for(&self, objectives: usize) -> Algorithm {
        self.algorithm.unwrap_or(if objectives == 2 {
            Algorithm::NsgaII
        } else {
            Algorithm::NsgaIII
        })
    }

    /// Chosen on ZDT1 and DTLZ2 over ten seeds: NSGA-III keeps few points per direction, so smaller
    /// changes serve it better.
    pub(super) fn crossover_for(&self, objectives: usize) -> Crossover {
        self.crossover.unwrap_or(Crossover {
            eta: match self.algorithm_for(objectives) {
                Algorithm::NsgaII => 20.0,
                Algorithm::NsgaIII => 30.0,
            },
            probability: 1.0,
        })
    }

    pub(super) fn mutation_for(&self, objectives: usize) -> Mutation {
        self.mutation.unwrap_or(Mutation {
            eta: match self.algorithm_for(objectives) {
                Algorithm::NsgaII => 15.0,
                Algorithm::NsgaIII => 60.0,
            },
            probability: None,
        })
    }

    /// The requested divisions, or the most that fit the population.
    pub(super) fn divisions_for(&self, objectives: usize) -> usize {
        self.divisions.unwrap_or_else(|| {
            (1..=self.population)
                .take_while(|&d| simplex_size(objectives, d) <= self.population)
                .last()
                .unwrap_or(1)
        })
    }

    /// Checks the settings for the number of objectives.
    pub(super) fn check(&self, objectives: usize) -> Result<()> {
        let count = |n: usize| n as f64;
        Error::check_range(
            "population",
            count(self.population),
            4.0,
            f64::from(MAX_POPULATION),
        )?;
        Error::check_range("generations", count(self.generations), 0.0, 1e9)?;
        if let Some(divisions) = self.divisions {
            let fits = |d: &usize| simplex_size(objectives, *d) <= usize::from(MAX_POPULATION);
            let most = (1..=1000).take_while(fits).last().unwrap_or(1);
            Error::check_range("divisions", count(divisions), 1.0, count(most))?;
        }
        if let Some(crossover) = self.crossover {
            Error::check_range("crossover.eta", crossover.eta, 0.0, 1e3)?;
            Error::check_range("crossover.probability", crossover.probability, 0.0, 1.0)?;
        }
        if let Some(mutation) = self.mutation {
            Error::check_range("mutation.eta", mutation.eta, 0.0, 1e3)?;
            let probability = mutation.probability.unwrap_or(0.0);
            Error::check_range("mutation.probability", probability, 0.0, 1.0)?;
        }
        self.solve.check()
    }
}

/// C(divisions + objectives − 1, objectives − 1), saturating.
fn simplex_size(objectives: usize, divisions: usize) -> usize {
    let mut size = 1_usize;
    for k in 1..objectives {
        size = size.saturating_mul(divisions + k) / k;
    }
    size
}

#[cfg(test)]
mod tests {
    use super::ParetoSettings;

    #[test]
    fn populations_and_directions_that_fill_the_memory_are_refused() {
        let refused = |change: fn(&mut ParetoSettings), objectives| {
            let mut settings = ParetoSettings::default();
            change(&mut settings);
            let error = settings.check(objectives).err()?;
            Some(error.to_string())
        };
        assert_eq!(refused(|s| s.population = 10_000, 2), None);
        let large = refused(|s| s.population = 10_001, 2).unwrap();
        assert!(
            large.contains("population") && large.contains("10000"),
            "{large}"
        );
        // three objectives have (d + 1)(d + 2)/2 directions, 9870 for 139 divisions; six have 8e12 for a thousand
        assert_eq!(refused(|s| s.divisions = Some(139), 3), None);
        // by default as many as the population has individuals: (12 + 1)(12 + 2)/2 = 91
        for (population, divisions) in [(90, 11), (91, 12), (92, 12)] {
            let settings = ParetoSettings {
                population,
                ..ParetoSettings::default()
            };
            assert_eq!(settings.divisions_for(3), divisions);
        }
        assert!(refused(|s| s.divisions = Some(140), 3).is_some());
        assert!(refused(|s| s.divisions = Some(1000), 6).is_some());
    }
}
