//! The controller compared with open loop at the same mean speed, over all seeds.

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_real::median;
use grouser_report::number::rounded;
use grouser_report::{Fields, fields};
use grouser_rover::drive::{MIN_GAIN, Outcome, Pilot};

use super::run::Run;

/// Both drivers over the seeds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    /// Seeds.
    seeds: usize,
    /// Seeds in which the controller arrives, in which open loop does, in which one alone does.
    controller: usize,
    open_loop: usize,
    controller_alone: usize,
    open_loop_alone: usize,
    /// Median over the seeds in which both arrive: the controller's energy per metre over that of open loop.
    energy_ratio: Option<f64>,
}

impl Comparison {
    /// Of drives with both drivers; `None` of others.
    pub(super) fn of(runs: &[Run]) -> Option<Self> {
        let own = |pilot| runs.iter().filter(move |run| run.pilot == pilot);
        let mut found = Self::default();
        let mut ratios = Vec::new();
        for (controller, open_loop) in own(Pilot::Controller).zip(own(Pilot::OpenLoop)) {
            let [a, b] = [controller, open_loop].map(|run| run.result.outcome == Outcome::Arrived);
            found.seeds += 1;
            found.controller += usize::from(a);
            found.open_loop += usize::from(b);
            found.controller_alone += usize::from(a && !b);
            found.open_loop_alone += usize::from(b && !a);
            let energies = [controller, open_loop].map(|run| run.result.energy_per_metre());
            if let (true, true, [Some(own), Some(other)]) = (a, b, energies) {
                ratios.push(own / other);
            }
        }
        found.energy_ratio = median(&mut ratios);
        (found.seeds > 0).then_some(found)
    }

    /// Less or more energy, or no gain.
    fn gain(&self) -> Option<String> {
        let change = self.energy_ratio? - 1.0;
        let percent = rounded(100.0 * change.abs(), 2);
        Some(if change.abs() < MIN_GAIN {
            "no gain".to_owned()
        } else if change < 0.0 {
            format!("{percent} % less")
        } else {
            format!("{percent} % more")
        })
    }

    /// Arrivals, then energies.
    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "only the controller arrives in {} of {} drives, only open loop in {}\n",
            self.controller_alone, self.seeds, self.open_loop_alone
        );
        if let (Some(ratio), Some(gain)) = (self.energy_ratio, self.gain()) {
            let _ = writeln!(
                text,
                "energy per metre of the controller over open loop, where both arrive: {ratio:.2} ({gain})"
            );
        }
        text
    }
}

pub(super) fn fields<'a>() -> Fields<'a, Comparison> {
    fields! { |of: Comparison|
        "seeds" "seeds" = of.seeds as u64;
        "controller_arrives" "seeds in which the controller arrives" = of.controller as u64;
        "open_loop_arrives" "seeds in which open loop arrives" = of.open_loop as u64;
        "controller_alone" "seeds in which only the controller arrives" = of.controller_alone as u64;
        "open_loop_alone" "seeds in which only open loop arrives" = of.open_loop_alone as u64;
        "energy_ratio" "median energy per metre of the controller over open loop at the same mean speed, where both arrive" =
            of.energy_ratio;
        "energy_gain" "what that is: `no gain` for less than 5 %" = of.gain();
    }
}
