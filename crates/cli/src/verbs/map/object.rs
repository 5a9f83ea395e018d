//! A map's result, as a list of fields.

use grouser_report::number::shown;
use grouser_report::{Fields, fields};
use grouser_terrain::{Envelope, MapLayout, MapMaker, MapSoil, State, TableError};

use super::summary::Summary;
use super::work::Part;

/// What is known of a map.
pub(super) struct Mapped<'a> {
    pub(super) layout: &'a MapLayout,
    pub(super) summary: &'a Summary,
    pub(super) maker: &'a MapMaker,
    pub(super) envelope: Envelope,
    pub(super) soil: &'a str,
    pub(super) gravity: f64,
    pub(super) resumed: u32,
    /// Half of the interval about a slope that holds 90 % of measurements, rad; `None` where that is not known.
    pub(super) model_error: Option<f64>,
}

impl Mapped<'_> {
    pub(super) fn error(&self) -> TableError {
        self.maker.table_error()
    }

    /// Of the map's own soil.
    fn steepest(&self) -> [f64; 3] {
        self.maker
            .soils()
            .first()
            .map_or([f64::NAN; 3], MapSoil::steepest)
    }

    fn share(&self, state: State) -> Option<f64> {
        let poses = self.summary.poses();
        (poses > 0).then(|| self.summary.states[state as usize] as f64 / poses as f64)
    }

    /// The share of cells and headings that drive with a wheel sunk too deep for the laws; `None` where none drives.
    pub(super) fn deep_share(&self) -> Option<f64> {
        mean(self.summary.deep as f64, self.summary.driving())
    }

    /// What people read.
    pub(super) fn text(&self) -> String {
        let summary = self.summary;
        let certainty = if self.layout.draws == 0 {
            "the soil is treated as exactly known: probabilities are 0 or 1".to_owned()
        } else {
            format!(
                "probabilities by {} soils drawn from the intervals of the soil",
                self.layout.draws
            )
        };
        let percent = |part: u64| match mean(part as f64, summary.known) {
            Some(share) => format!("{} %", shown(100.0 * share)),
            None => "none".to_owned(),
        };
        format!(
            "passable in every heading: {} of the known cells; in none: {}\n{certainty}\n\
             {} x {} cells of {} m, {} headings; {} under {} m/s²\n\n{}",
            percent(summary.open),
            percent(summary.closed),
            self.layout.columns,
            self.layout.rows,
            shown(self.layout.cell),
            self.layout.headings.count(),
            match self.layout.soils.get(1..) {
                Some(others) if !others.is_empty() =>
                    format!("{} with {}", self.soil, others.join(", ")),
                _ => self.soil.to_owned(),
            },
            shown(self.gravity),
            fields().lines(self)
        )
    }
}

fn mean(sum: f64, count: u64) -> Option<f64> {
    (count > 0 && sum.is_finite()).then(|| sum / count as f64)
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Mapped<'a>> {
    fields! { |map: &'a Mapped<'a>|
        "columns" "cells across" = map.layout.columns;
        "rows" "cells down" = map.layout.rows;
        "cell_m" "size of a cell" = map.layout.cell;
        "headings" "headings" = map.layout.headings.count();
        "soil" "soil" = map.soil;
        "soils" "all soils, by their numbers in the map" rows(soil()) =
            map.layout.soils.iter().zip(map.maker.soils()).collect::<Vec<_>>();
        "gravity_m_per_s2" "gravity" = map.gravity;
        "soil_draws" "soils drawn from the intervals; 0: the soil is treated as exactly known" = map.layout.draws;
        "turning_radius_m" "minimum turning radius of the robot" .shown("m").detail() = map.layout.turning_radius;
        "max_pitch_deg" "maximum pitch computed" .shown("deg").detail() = map.envelope.max_pitch.to_degrees();
        "max_roll_deg" "maximum roll computed" .shown("deg").detail() = map.envelope.max_roll.to_degrees();
        "known_cells" "cells with known ground" .shown("") = map.summary.known;
        "open_cells" "known cells that every heading can drive" = map.summary.open;
        "closed_cells" "known cells that no heading can drive" = map.summary.closed;
        "drives" "share of cells and headings: drives, by the table" .shown("%") = map.share(State::Drives);
        "marginal" "near a limit (drives or not), solved exactly" .shown("%") = map.share(State::Marginal);
        "immobilised" "no slip gives the pull" .shown("%") = map.share(State::Immobilised);
        "slides" "slides downhill" .shown("%") = map.share(State::Slides);
        "steep" "steeper than computed" .shown("%") = map.share(State::Steep);
        "slip_median" "median slip where it drives" .shown("").decimals(3) = map.summary.slip_quantile(0.5);
        "slip_95" "95 % quantile of the slip" .shown("").decimals(3) = map.summary.slip_quantile(0.95);
        "energy_mean_j_per_m" "mean energy where it drives" .shown("J/m") =
            mean(map.summary.energy_sum, map.summary.driving());
        "energy_max_j_per_m" "maximum energy" .shown("J/m") =
            (map.summary.driving() > 0).then_some(map.summary.energy_max);
        "sinkage_max_m" "maximum sinkage" .shown("mm") =
            (map.summary.driving() > 0).then_some(map.summary.sinkage_max);
        "deep" "a wheel sinks by more than a sixth of its diameter (laws uncertain)" .shown("%") =
            map.deep_share();
        "tip_over_min_deg" "minimum tip-over margin" .shown("deg") =
            (map.summary.driving() > 0).then_some(map.summary.tip_over_min);
        "immobilisation_mean" "mean probability of immobilisation, at most" .shown("%") =
            mean(map.summary.risk_sum, map.summary.poses());
        "steepest_deg" "slope climbed straight on" .shown("deg") = map.steepest()[0].to_degrees();
        "steepest_model_error_deg" "90 % of measurements lie within this of it" .shown("deg") =
            map.model_error.map(f64::to_degrees);
        "steepest_weakest_draw_deg" "slope climbed on the weakest soil draw" .shown("deg").detail() = map.steepest()[1].to_degrees();
        "steepest_strongest_draw_deg" "slope climbed on the strongest soil draw" .shown("deg").detail() =
            map.steepest()[2].to_degrees();
        "slip_error" "table against exact solver: slip" .shown("").detail() = map.error().slip;
        "limit_error_deg" "table against exact solver: maximum slope" .shown("deg").detail() = map.error().limit.to_degrees();
        "energy_error" "table against exact solver: energy" .shown("%").detail() = map.error().energy;
        "sinkage_error_m" "table against exact solver: sinkage" .shown("mm").detail() = map.error().sinkage;
        "tip_over_error_deg" "table against exact solver: tip-over margin" .shown("deg").detail() = map.maker.tip_over_error().to_degrees();
        "error_checks" "places where table and solver were compared" = map.error().checks;
        "resumed_strips" "strips that an earlier run had computed" = map.resumed;
        "strips" "strips" = map.layout.strips();
        "job_sha256" "SHA-256 of all that the map was computed from" = map.layout.job.as_str();
    }
}

fn soil<'a>() -> Fields<'a, (&'a String, &'a MapSoil)> {
    fields! { |of: (&'a String, &'a MapSoil)|
        "name" "name" = of.0.as_str();
        "steepest_deg" "slope that is climbed straight on" = of.1.steepest()[0].to_degrees();
    }
}

/// A shard's result.
pub(super) fn part<'a>() -> Fields<'a, &'a Part> {
    fields! { |part: &'a Part|
        "shard" "part" = u32::from(part.shard.index);
        "shards" "parts" = u32::from(part.shard.of);
        "strips" "strips of this part" = part.strips;
        "file" "the file of this part" = part.file.as_str();
    }
}
