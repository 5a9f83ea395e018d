//! Which mistake in a unit explains a result that no soil has?
//!
//! Each mistake is undone in the readings, and the job is done again: the one that makes every number plausible is likely.

use grouser_real::Real;
use grouser_terra::{Angle, Kinematics, RigidWheel};
use rayon::prelude::*;

use crate::identification::{Identification, WheelNumber, fitted};
use crate::job::Job;
use crate::least_squares::Verdict;
use crate::plate::PlateTest;
use crate::plausible::Plausibility;
use crate::readings::Readings;
use crate::shear::ShearReading;
use crate::wheel::{MAX_SCATTER_RATIO, Support, WheelTest};

/// What a mistake is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    PlateForce,
    PlateDepth,
    PlateDiameter,
    NormalStress,
    ShearStress,
    BothStresses,
    Displacement,
    Load,
    Pull,
    Torque,
    Sinkage,
    WheelForces,
    TravelSpeed,
    SlipAngle,
    Radius,
    Width,
}

impl Column {
    const fn words(self) -> &'static str {
        match self {
            Self::PlateForce => "the force of the plate tests is",
            Self::PlateDepth => "the depth of the plate tests is",
            Self::PlateDiameter => "the plates' diameter is",
            Self::NormalStress => "the normal stress of the shear tests is",
            Self::ShearStress => "the shear stress is",
            Self::BothStresses => "normal and shear stress are",
            Self::Displacement => "the displacement of the shear tests is",
            Self::Load => "the load of the wheel tests is",
            Self::Pull => "the drawbar pull is",
            Self::Torque => "the torque is",
            Self::Sinkage => "the sinkage is",
            Self::WheelForces => "load and forces of the wheel tests are",
            Self::TravelSpeed => "the travel speed is",
            Self::SlipAngle => "the slip angle is",
            Self::Radius => "the wheel's `radius_m` is",
            Self::Width => "the wheel's `width_m` is",
        }
    }
}

/// A unit in place of another.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    /// What the reading must be multiplied by.
    factor: f64,
    words: &'static str,
    /// Is it rarer than a wrong prefix?
    is_rare: bool,
}

const fn usual(factor: f64, words: &'static str) -> Exchange {
    let is_rare = false;
    Exchange {
        factor,
        words,
        is_rare,
    }
}

const fn rare(factor: f64, words: &'static str) -> Exchange {
    let is_rare = true;
    Exchange {
        factor,
        words,
        is_rare,
    }
}

const FORCES: [Exchange; 4] = [
    usual(1e3, "in kN, not N"),
    usual(1e-3, "in N, not kN"),
    usual(9.806_65, "in kg, not N"),
    rare(4.448_222, "in pounds, not N"),
];
const LENGTHS: [Exchange; 6] = [
    usual(1e-3, "in mm, not m"),
    usual(1e3, "in m, not mm"),
    usual(10.0, "in cm, not mm"),
    usual(1e-2, "in cm, not m"),
    rare(25.4, "in inches, not mm"),
    rare(0.0254, "in inches, not m"),
];
const STRESSES: [Exchange; 4] = [
    usual(1e3, "in MPa, not kPa (or in kPa, not Pa)"),
    usual(1e-3, "in Pa, not kPa (or in kPa, not MPa)"),
    rare(100.0, "in bar, not kPa"),
    rare(6.894_757, "in psi, not kPa"),
];
const TORQUES: [Exchange; 4] = [
    usual(1e-3, "in N mm, not N m"),
    usual(1e-2, "in N cm, not N m"),
    usual(1e3, "in kN m, not N m"),
    rare(9.806_65, "in kg m, not N m"),
];
const SPEEDS: [Exchange; 2] = [
    usual(1e-3, "in mm/s, not m/s"),
    usual(1e3, "in m/s, not mm/s"),
];
const ANGLES: [Exchange; 1] = [usual(180.0 / core::f64::consts::PI, "in rad, not degrees")];
const RADIUS_AS_DIAMETER: [Exchange; 1] = [usual(2.0, "the radius, not the diameter")];
const DIAMETER_AS_RADIUS: [Exchange; 1] = [usual(0.5, "the diameter, not the radius")];

const MISTAKES: [(Column, &[Exchange]); 18] = [
    (Column::PlateForce, &FORCES),
    (Column::PlateDepth, &LENGTHS),
    (Column::PlateDiameter, &LENGTHS),
    (Column::PlateDiameter, &RADIUS_AS_DIAMETER),
    (Column::NormalStress, &STRESSES),
    (Column::ShearStress, &STRESSES),
    (Column::BothStresses, &STRESSES),
    (Column::Displacement, &LENGTHS),
    (Column::Load, &FORCES),
    (Column::Pull, &FORCES),
    (Column::WheelForces, &FORCES),
    (Column::Torque, &TORQUES),
    (Column::Sinkage, &LENGTHS),
    (Column::TravelSpeed, &SPEEDS),
    (Column::SlipAngle, &ANGLES),
    (Column::Radius, &LENGTHS),
    (Column::Radius, &DIAMETER_AS_RADIUS),
    (Column::Width, &LENGTHS),
];

impl Column {
    /// The readings with this column multiplied by `factor`; `None` where there is no such column, or none that can be so.
    fn scaled(self, readings: &Readings, factor: f64) -> Option<Readings> {
        let mut out = readings.clone();
        match self {
            Self::PlateForce | Self::PlateDepth | Self::PlateDiameter => {
                let tests = out.plates.iter_mut();
                tests.for_each(|test| self.scale_plate(test, factor));
                return (!out.plates.is_empty()).then_some(out);
            }
            Self::NormalStress | Self::ShearStress | Self::BothStresses | Self::Displacement => {
                let readings = out.shear.as_mut()?.iter_mut();
                readings.for_each(|reading| self.scale_shear(reading, factor));
            }
            Self::Radius | Self::Width => {
                let (job, _) = out.wheel.as_mut()?;
                let own = job.wheel;
                let (radius, width) = if self == Self::Radius {
                    (factor * own.radius(), own.width())
                } else {
                    (own.radius(), factor * own.width())
                };
                let wheel = RigidWheel::new(radius, width).ok()?;
                job.wheel = match own.grousers() {
                    Some(grousers) => wheel.with_grousers(grousers).ok()?,
                    None => wheel,
                };
            }
            Self::Load
            | Self::Pull
            | Self::Torque
            | Self::Sinkage
            | Self::WheelForces
            | Self::TravelSpeed
            | Self::SlipAngle => {
                let (_, tests) = out.wheel.as_mut()?;
                let before = tests.clone();
                for test in tests.iter_mut() {
                    self.scale_wheel(test, factor)?;
                }
                if *tests == before {
                    return None;
                }
            }
        }
        Some(out)
    }

    fn scale_plate(self, test: &mut PlateTest, factor: f64) {
        match self {
            Self::PlateForce => test.force.iter_mut().for_each(|force| *force *= factor),
            Self::PlateDepth => test.depth.iter_mut().for_each(|depth| *depth *= factor),
            _ => {
                test.plate.width *= factor;
                test.plate.area *= factor * factor;
            }
        }
    }

    fn scale_shear(self, reading: &mut ShearReading, factor: f64) {
        if matches!(self, Self::NormalStress | Self::BothStresses) {
            reading.normal *= factor;
        }
        if matches!(self, Self::ShearStress | Self::BothStresses) {
            reading.shear *= factor;
        }
        if self == Self::Displacement {
            reading.displacement *= factor;
        }
    }

    /// `None` where no wheel can move so.
    fn scale_wheel(self, test: &mut WheelTest, factor: f64) -> Option<()> {
        let scale = |value: &mut Option<f64>| *value = value.map(|value| factor * value);
        if matches!(self, Self::Load | Self::WheelForces)
            && let Support::Load(load) = &mut test.support
        {
            *load *= factor;
        }
        if matches!(self, Self::Pull | Self::WheelForces) {
            scale(&mut test.pull);
        }
        match self {
            Self::WheelForces => scale(&mut test.side),
            Self::Torque => scale(&mut test.torque),
            Self::Sinkage => {
                scale(&mut test.sinkage);
                if let Support::Sinkage(sinkage) = &mut test.support {
                    *sinkage *= factor;
                }
            }
            Self::TravelSpeed => {
                let slip = test.kinematics.slip().value();
                let (travel, rim) = (1.0 - slip.max(0.0), 1.0 + slip.min(0.0));
                let angle = test.kinematics.slip_angle();
                let side = travel * angle.sin() / angle.cos();
                let (travel, side) = (factor * travel, factor * side);
                test.kinematics = Kinematics::from_speeds(travel, side, rim).ok()?;
            }
            Self::SlipAngle => {
                let angle = factor * test.kinematics.slip_angle().rad();
                let slip = test.kinematics.slip();
                test.kinematics = (angle.abs() < core::f64::consts::FRAC_PI_2)
                    .then(|| Kinematics::with_slip_angle(slip, Angle::from_rad(angle)).ok())??;
            }
            _ => {}
        }
        Some(())
    }
}

/// How far a result lies from what soils have and from what the readings' scatter allows, in decades, and how far its numbers
/// lie from the middle of their limits.
#[derive(Clone, Copy, Debug)]
struct Strain {
    decades: f64,
    from_middle: f64,
}

impl Strain {
    fn new(found: &Identification, readings: &Readings) -> Self {
        let numbers = found.plausibilities(readings);
        let mut strain = Self {
            decades: numbers.iter().map(Plausibility::decades_outside).sum(),
            from_middle: numbers.iter().map(Plausibility::square_from_middle).sum(),
        };
        if let Some(stage) = &found.wheel {
            let beyond = |ratio: f64| Real::log10(ratio / MAX_SCATTER_RATIO);
            let misfits = stage.misfits.iter();
            strain.decades += misfits.map(|misfit| beyond(misfit.ratio)).sum::<f64>();
            let buried = stage.said.iter().filter(|said| said.hub_buried).count();
            strain.decades += buried as f64 / stage.said.len().max(1) as f64;
            strain.from_middle += Real::ln(stage.mean_square_residual.max(1.0));
            // a number that is stopped at a bound makes up for something else
            let is_stopped =
                |own: &&WheelNumber| own.verdict == Verdict::OnBound && own.value != 0.0;
            strain.from_middle += stage.numbers.iter().filter(is_stopped).count() as f64;
        }
        strain
    }
}

/// Below this many decades a misfit is a matter of laws and scatters rather than of units: the smallest factor in
/// [`MISTAKES`] is 2.
const MIN_DECADES: f64 = 0.3;
/// A mistake explains a result if it leaves this share of its decades at most.
const MAX_SHARE: f64 = 0.25;
/// What a rare mistake counts as, beside the squares of distances from the middle.
const RARE: f64 = 0.3;
/// Mistakes whose results are plausible alike are both named.
const SAME: f64 = 0.1;
/// A few readings show a factor of two.
const MAX_READINGS: usize = 1000;
/// So do few tests of a wheel, from few starts.
const MAX_WHEEL_TESTS: usize = 40;
const MAX_STARTS: usize = 2;

/// The likely mistakes behind `found`, the likeliest first, at most two.
pub(crate) fn likely(job: &Job, readings: &Readings, found: &Identification) -> Vec<String> {
    let strain = Strain::new(found, readings).decades;
    if found.implausible.is_empty() && !(strain > MIN_DECADES) {
        return Vec::new();
    }
    explaining(job, readings, MAX_SHARE * strain)
}

/// The mistakes without which at most so many `decades` are left, the likeliest first, at most two.
pub(crate) fn explaining(job: &Job, readings: &Readings, decades: f64) -> Vec<String> {
    let few = few(readings);
    let candidates: Vec<(Column, &Exchange)> = MISTAKES
        .iter()
        .flat_map(|(column, exchanges)| exchanges.iter().map(|exchange| (*column, exchange)))
        .collect();
    let tried = candidates.par_iter().map(|(column, exchange)| {
        let undone = column.scaled(&few, exchange.factor)?;
        // the wheel's fit is the longest, and the soil before it need not be plausible
        let wheel = None;
        let soil = fitted(
            job,
            &Readings {
                wheel,
                ..undone.clone()
            },
        )
        .ok()?;
        if Strain::new(&soil, &undone).decades > decades {
            return None;
        }
        let strain = Strain::new(&fitted(job, &undone).ok()?, &undone);
        let rarity = if exchange.is_rare { RARE } else { 0.0 };
        (strain.decades <= decades).then_some((
            strain.decades + strain.from_middle + rarity,
            *column,
            *exchange,
        ))
    });
    let mut explaining: Vec<_> = tried.collect::<Vec<_>>().into_iter().flatten().collect();
    explaining.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = explaining.first().map_or(0.0, |first| first.0);
    let likely = explaining.into_iter().take(2);
    likely
        .filter(|(strain, ..)| *strain <= best + SAME)
        .map(|(_, column, exchange)| format!("{} {}", column.words(), exchange.words))
        .collect()
}

/// Few enough readings for a fit with each mistake.
fn few(readings: &Readings) -> Readings {
    fn thin<T: Clone>(list: &mut Vec<T>, stride: usize) {
        let kept = list.iter().step_by(stride.max(1)).cloned().collect();
        *list = kept;
    }
    let mut out = readings.clone();
    out.is_rough = true;
    let all: usize = out.plates.iter().map(|test| test.depth.len()).sum();
    for test in &mut out.plates {
        // no test is left without a reading
        let stride = all
            .div_ceil(MAX_READINGS)
            .min((test.depth.len() / 20).max(1));
        thin(&mut test.depth, stride);
        thin(&mut test.force, stride);
    }
    if let Some(readings) = &mut out.shear {
        let stride = readings.len().div_ceil(MAX_READINGS);
        thin(readings, stride);
    }
    if let Some((job, tests)) = &mut out.wheel {
        let stride = tests.len().div_ceil(MAX_WHEEL_TESTS);
        thin(tests, stride);
        job.starts.starts = job.starts.starts.min(MAX_STARTS);
    }
    out
}
