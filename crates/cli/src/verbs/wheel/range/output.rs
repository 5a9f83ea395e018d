//! What a range of slip reports: text, a table, JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _; // writing to a string cannot fail

use grouser_terra::{BestSlip, Caution, LoadSolution, LugPassage, Prescribed, WheelOnSoil};

use super::Family;
use crate::operation::{self, passage};
use crate::wheel_choice::WheelArguments;
use grouser_report::number::shown;
use grouser_report::{Fields, fields};

/// The maxima of a curve and its cautions.
pub(super) fn summary(family: &Family) -> String {
    let mut text = String::new();
    let _ = match family.prescribed {
        Prescribed::Load(load) => write!(text, "under {} N:", shown(load)),
        Prescribed::Sinkage(sinkage) => {
            write!(text, "at a sinkage of {} mm:", shown(1e3 * sinkage))
        }
    };
    let solved = family
        .points
        .iter()
        .filter(|(_, answer)| answer.point().is_some())
        .count();
    let _ = write!(text, " {solved} of {} points solved", family.points.len());
    if let Some(best) = &family.most_pull {
        let (pull, slip) = (shown(best.value), shown(best.slip.value()));
        let _ = write!(text, "; maximum pull {pull} N at slip {slip}");
    }
    if let Some(best) = &family.most_efficient {
        let (share, slip) = (shown(100.0 * best.value), shown(best.slip.value()));
        let _ = write!(text, "; best efficiency {share} % at slip {slip}");
    }
    text.push('\n');
    let mut cautions: BTreeMap<Caution, u32> = BTreeMap::new();
    for point in family
        .points
        .iter()
        .filter_map(|(_, answer)| answer.point())
    {
        for caution in point.cautions.iter() {
            *cautions.entry(caution).or_default() += 1;
        }
    }
    for (caution, count) in cautions {
        let _ = writeln!(text, "caution at {count} points: {caution}");
    }
    text
}

/// A point of a curve and what all points share.
#[derive(Clone, Copy)]
pub(super) struct Point<'a> {
    frame: Frame<'a>,
    family: &'a Family,
    slip: f64,
    answer: &'a LoadSolution,
}

impl Point<'_> {
    fn lugs(self) -> Option<LugPassage> {
        self.frame.pair.lug_passage(&self.answer.point()?)
    }
}

/// What all points of the run share.
#[derive(Clone, Copy)]
pub(in crate::verbs::wheel) struct Frame<'a> {
    pub(super) wheel: &'a WheelArguments,
    pub(super) pair: &'a WheelOnSoil,
    pub(super) soil: &'a str,
    pub(super) families: &'a [Family],
}

impl<'a> Frame<'a> {
    fn points(self) -> impl Iterator<Item = Point<'a>> {
        self.families.iter().flat_map(move |family| {
            family.points.iter().map(move |(slip, answer)| Point {
                frame: self,
                family,
                slip: *slip,
                answer,
            })
        })
    }

    /// All points, with the columns of `batch`.
    pub(super) fn csv(self) -> String {
        let columns = fields! { |point: Point<'a>|
            join(wheel()) = point.frame;
            join(points()) = point;
        };
        let keys = "soil,radius_m,width_m,grouser_height_m,grouser_count,grouser_thickness_m,rebound,slip,slip_angle_deg,\
            sinkage_m,load_n,vertical_force_n,drawbar_pull_n,torque_nm,side_force_n,pull_fluctuation_n,\
            torque_fluctuation_nm,status,cautions";
        columns.pick(&self.present(keys)).csv(self.points())
    }

    /// Those keys that this wheel and this drift have.
    fn present(self, keys: &'static str) -> Vec<&'static str> {
        let lugged = self.pair.wheel().grousers().is_some();
        let drifting = self.wheel.slip_angle_deg != 0.0;
        let is_present = |key: &&str| match *key {
            "slip_angle_deg" | "side_force_n" => drifting,
            "pull_fluctuation_n" | "torque_fluctuation_nm" => lugged,
            key => lugged || !key.starts_with("grouser"),
        };
        keys.split(',').filter(is_present).collect()
    }

    /// All points, for people.
    pub(super) fn table(self) -> String {
        let load = |point: Point<'_>| {
            let carried = || Some(point.answer.point()?.forces.vertical_force);
            point
                .family
                .prescribed
                .load()
                .or_else(carried)
                .map_or_else(|| "-".to_owned(), shown)
        };
        let columns = fields! { |point: Point<'a>|
            "load N" "load" .shown("N").as_number() = load(point);
            join(points()) = point;
        };
        let keys = "slip,load N,sinkage_m,drawbar_pull_n,side_force_n,torque_nm,pull_fluctuation_n,tractive_efficiency,status";
        columns
            .at("drawbar_pull_n")
            .label("pull")
            .at("tractive_efficiency")
            .label("efficiency")
            .missing("-")
            .at("pull_fluctuation_n")
            .label("pull fluctuation")
            .pick(&self.present(keys))
            .table(self.points())
    }
}

fn wheel<'a>() -> Fields<'a, Frame<'a>> {
    fields! { |frame: Frame<'a>|
        "soil" "soil" = frame.soil;
        "radius_m" "radius of the wheel" .given() = frame.wheel.radius_m;
        "width_m" "width of the wheel" .given() = frame.wheel.width_m;
        "grouser_height_m" "height of the lugs" .given() = frame.wheel.grousers.grouser_height_m;
        "grouser_count" "number of the lugs" .given() = frame.wheel.grousers.grouser_count.map(f64::from);
        "grouser_thickness_m" "thickness of the lugs" .given() = frame.wheel.grousers.grouser_thickness_m;
        "rebound" "rebound ratio" .given() = frame.pair.soil().params().rebound;
        "slip_angle_deg" "slip angle" .given() = frame.wheel.slip_angle_deg;
    }
}

fn points<'a>() -> Fields<'a, Point<'a>> {
    fields! { |point: Point<'a>|
        "slip" "slip" .shown("").given() = point.slip;
        "load_n" "load" .given() = point.family.prescribed.load();
        join(operation::fields()) = point.answer;
        join(passage().pick(&["pull_fluctuation_n", "torque_fluctuation_nm"])) = point.lugs();
    }
}

/// `curves` has one entry for each load or sinkage, `points` all points of all of them.
pub(in crate::verbs::wheel) fn fields<'a>() -> Fields<'a, Frame<'a>> {
    fields! { |frame: Frame<'a>|
        join(wheel()) = frame;
        "curves" "the curves: one for each load or sinkage" rows(curve()) = frame.families;
        "points" "all points of all curves" rows(points()) = frame.points();
    }
}

fn curve<'a>() -> Fields<'a, &'a Family> {
    let pull = fields! { |best: BestSlip|
        "slip" "slip" = best.slip.value();
        "drawbar_pull_n" "drawbar pull" = best.value;
    };
    let efficiency = fields! { |best: BestSlip|
        "slip" "slip" = best.slip.value();
        "tractive_efficiency" "tractive efficiency" = best.value;
    };
    fields! { |family: &'a Family|
        "load_n" "load" = family.prescribed.load();
        "sinkage_m" "sinkage" = family.prescribed.sinkage();
        "most_pull" "maximum of the drawbar pull" group(pull) = family.most_pull;
        "most_efficient" "maximum of the tractive efficiency" group(efficiency) = family.most_efficient;
    }
}
