//! The result of `design` as a list of quantities.

use grouser_design::mission::{
    DesignPoint, MissionFront, MissionProfile, SlopeShare, SoilShare, StationResult, WheelDesign,
};
use grouser_report::{Fields, fields};

use super::carrier::Carrier;
use super::check::Checked;
use crate::model_error;

/// Everything that a mission gave.
pub(super) struct Designed<'a> {
    pub(super) mission: &'a MissionProfile,
    pub(super) carrier: &'a Carrier,
    /// Where the numbers of each soil come from.
    pub(super) sources: &'a [String],
    pub(super) front: &'a MissionFront,
    /// The present wheel on the same mission, its mass by the robot file.
    pub(super) present: &'a DesignPoint,
    pub(super) checked: &'a Checked,
}

impl Designed<'_> {
    pub(super) fn chosen(&self) -> Option<&DesignPoint> {
        self.front.points.get(self.front.chosen?)
    }

    /// The front as a CSV table.
    pub(super) fn csv(&self) -> String {
        let mut keys = WheelDesign::NAMES.to_vec();
        keys.extend([
            "wheel_mass_kg",
            "energy_j_per_m",
            "least_reserve",
            "energy_saved_j_per_m_kg",
            "is_chosen",
        ]);
        let columns = fields! { |of: (usize, Point<'_>)|
            join(point()) = of.1;
            "is_chosen" "whether it is chosen" = u8::from(self.front.chosen == Some(of.0));
        };
        let points = self.front.points.iter().enumerate();
        columns
            .pick(&keys)
            .csv(points.map(|(index, point)| (index, Point(point, self))))
    }

    /// The chosen wheel, or the nearest to one that holds.
    pub(super) fn shown(&self) -> Option<&DesignPoint> {
        self.chosen()
            .or(self.front.nearest.as_ref())
            .or(self.front.points.first())
    }
}

/// A point with the design that it is of.
#[derive(Clone, Copy)]
pub(super) struct Point<'a>(pub(super) &'a DesignPoint, pub(super) &'a Designed<'a>);

/// A station with the name of its soil.
#[derive(Clone, Copy)]
pub(super) struct Station<'a>(pub(super) &'a str, pub(super) &'a StationResult);

impl<'a> Point<'a> {
    /// Half of the interval about a reserve that holds 90 % of measurements, share of the weight.
    pub(super) fn reserve_error(self) -> Option<f64> {
        let params = self.1.mission.params();
        let soils = params.soils.iter().map(|share| &share.soil);
        let has_lugs = self.0.wheel.grouser_count > 0.0;
        model_error::pull_per_load(soils, params.max_slip, has_lugs)
    }

    pub(super) fn stations(self) -> Vec<Station<'a>> {
        let soils = self.1.mission.params().soils.iter().zip(&self.0.stations);
        soils
            .flat_map(|(soil, row)| row.iter().map(|one| Station(&soil.name, one)))
            .collect()
    }
}

pub(super) fn fields<'a>() -> Fields<'a, &'a Designed<'a>> {
    fields! { |of: &'a Designed<'a>|
        "robot" "the robot" = of.carrier.name();
        "gravity_m_per_s2" "gravity" = of.carrier.gravity();
        "designed_wheels" "wheels that are designed" = of.carrier.names(true);
        "kept_wheels" "wheels that stay" = of.carrier.names(false);
        "soils" "the soils" rows(soil()) = of.mission.params().soils.iter().zip(of.sources);
        "slopes" "the slopes" rows(slope()) = of.mission.params().slopes.iter();
        "soil_measure" "how the energies of the soils become one number" = of.mission.params().measure.name();
        "min_reserve" "minimum pull margin, share of the weight" = of.mission.params().min_reserve;
        "max_slip" "maximum slip at which a slope counts as held" = of.mission.params().max_slip;
        "wheel_mass_formula" "mass of one wheel in kg" = of.mission.params().mass_formula.as_str();
        "front" "Pareto front of mass and energy, by mass" rows(point()) =
            of.front.points.iter().map(|point| Point(point, of));
        "knee" "index of the best trade-off (knee point) in the front" = of.front.knee;
        "chosen" "the chosen wheel" group(point()) = of.chosen().map(|point| Point(point, of));
        "nearest" "where no wheel has the pull margin everywhere: the one with the largest minimum margin" group(point()) =
            of.front.nearest.as_ref().map(|point| Point(point, of));
        "present" "the present wheel, its mass by the robot file" group(point()) = Point(of.present, of);
        "present_formula_mass_kg" "mass that the formula gives the present wheel" =
            of.mission.wheel_mass(&of.carrier.present);
        "difference" "maximum relative difference of an energy from the solver of climb" = of.checked.difference;
        "cautions" "cautions about the chosen wheel on all slopes" =
            of.checked.cautions.keys().map(|caution| caution.key()).collect::<Vec<_>>();
        "tip_over_deg" "tip-over margin of the robot with the chosen wheel" = of.checked.tip_over.map(f64::to_degrees);
        "unsolved" "solves without a solution" = of.front.unsolved;
    }
}

fn soil<'a>() -> Fields<'a, (&'a SoilShare, &'a String)> {
    fields! { |soil: (&'a SoilShare, &'a String)|
        "soil" "soil" = soil.0.name.as_str();
        "share" "share of the distance" = soil.0.share;
        "source" "where its numbers come from" = soil.1.as_str();
    }
}

fn slope<'a>() -> Fields<'a, &'a SlopeShare> {
    fields! { |slope: &'a SlopeShare|
        "slope_deg" "slope" = slope.slope_deg;
        "share" "share of the distance" = slope.share;
    }
}

pub(super) fn sizes<'a>() -> Fields<'a, &'a WheelDesign> {
    fields! { |wheel: &'a WheelDesign|
        "radius_m" "radius" .shown("m") = wheel.radius;
        "width_m" "width" .shown("m") = wheel.width;
        "grouser_height_m" "lug height" .shown("mm") = wheel.grouser_height;
        "grouser_count" "lugs" .shown("") = wheel.grouser_count;
        "grouser_thickness_m" "lug thickness" = wheel.grouser_thickness;
        "mass_shift_m" "shift of the chassis' mass forwards" .shown("mm").label("mass shift") = wheel.mass_shift;
    }
}

pub(super) fn point<'a>() -> Fields<'a, Point<'a>> {
    fields! { |point: Point<'a>|
        join(sizes()) = &point.0.wheel;
        "wheel_mass_kg" "mass of one wheel" .shown("kg").label("mass") = point.0.wheel_mass;
        "energy_j_per_m" "energy" .shown("J/m").missing("none") = point.0.energy;
        "least_reserve" "minimum pull margin" .shown("") = point.0.least_reserve();
        "reserve_model_error" "half of the interval about a pull margin that holds 90 % of measurements" = point.reserve_error();
        "energy_saved_j_per_m_kg" "energy saved per kg of wheel mass" .shown("J/m/kg").label("saved") =
            point.0.energy_per_mass;
        "soil_energies_j_per_m" "energy per metre on each soil" values = {
            let soils = point.1.mission.params().soils.iter().zip(&point.0.soil_energies);
            let known: Option<Vec<(String, f64)>> = soils.map(|(soil, energy)| Some((soil.name.clone(), (*energy)?))).collect();
            known
        };
        "loads_n" "load of each wheel on the first slope" values = {
            let loads = point.0.loads.iter().copied();
            Some(point.1.carrier.all_names().zip(loads).collect::<Vec<_>>())
        };
        "held_by" "active limits of the wheel" = point.0.held_by.clone();
        "stations" "every soil and slope" rows(station()) = point.stations();
    }
}

pub(super) fn station<'a>() -> Fields<'a, Station<'a>> {
    fields! { |station: Station<'a>|
        "soil" "soil" .shown("") = station.0;
        "slope_deg" "slope" .shown("deg") = station.1.slope_deg;
        "slip" "slip" .shown("").missing("none") = station.1.slip;
        "energy_j_per_m" "energy" .shown("J/m").missing("none") = station.1.energy;
        "sinkage_m" "sinkage" .shown("mm") = station.1.sinkage;
        "reserve" "pull margin" .shown("") = station.1.reserve;
    }
}
