//! Every data set against the model.

use std::path::Path;

use grouser_terra::{
    Angle, Bulldozing, GrouserRule, Grousers, Kinematics, LawChoice, ShearLaw, SlipSinkage,
    SoilParams, StressPosition, catalogue,
};
use rayon::prelude::*;

use super::cmu::{self, Trial};
use super::ding;
use super::fitting::{Fitted, Job};
use super::rows::{MeasuredPoint, ModelName, Row, Series, Split, Validation};
use super::score::{Score, pooled};
use crate::error::{Error, Result};
use crate::parameter::Parameter;
use crate::plate::{
    BagSource, DepthColumn, Plate, PlateFit, PlateSettings, PlateTest, fit_plates, read_bag,
};
use crate::wheel::{Quantity, Scatter, Support, WheelTest};

/// Beyond this stated slip a trial is left out: locked and nearly spinning wheels are no steady state here.
pub const GREATEST_SLIP: f64 = 0.75;

/// What residuals of the trials are divided by: N, N, N m, m. About the scatter of repeated trials.
const TRIAL_SCATTER: Scatter = Scatter {
    pull: 0.5,
    side: 0.5,
    torque: 0.1,
    sinkage: 7e-4,
};

/// The same for points read off Ding's figures.
const DIGITISED: Scatter = Scatter {
    pull: 1.5,
    side: 1.5,
    torque: 0.3,
    sinkage: 1e-3,
};

/// What the fits were made on.
const STRAIGHT: &str = "slip angle 0";
const BRACKET: &str = "slip angles 0 and 60";
const DING_ALL: &str = "all six slips";
const NOTHING: &str = "nothing";

const CMU: &str = "cmu-wheel";
const DING: &str = "ding-2011";

/// Wheel numbers of our laws that the smooth wheel at slip angle 0 tells, with the two offsets.
const OURS: [Parameter; 8] = [
    Parameter::C1,
    Parameter::C2,
    Parameter::KShear,
    Parameter::ExponentDriving,
    Parameter::ExponentBraking,
    Parameter::Rebound,
    Parameter::SinkageDatum,
    Parameter::SideDatum,
];

/// The same with cohesion, where drifting wheels are fitted too.
const OURS_DRIFTING: [Parameter; 9] = [
    Parameter::C1,
    Parameter::C2,
    Parameter::KShear,
    Parameter::ExponentDriving,
    Parameter::ExponentBraking,
    Parameter::Rebound,
    Parameter::Cohesion,
    Parameter::SinkageDatum,
    Parameter::SideDatum,
];

/// What Wong and Reece's laws have.
const PLAIN: [Parameter; 5] = [
    Parameter::C1,
    Parameter::C2,
    Parameter::KShear,
    Parameter::SinkageDatum,
    Parameter::SideDatum,
];

/// Ding's wheel: five numbers; K is held at the lower end of what that paper measured.
const OURS_DING: [Parameter; 5] = [
    Parameter::Exponent,
    Parameter::ExponentDriving,
    Parameter::C1,
    Parameter::C2,
    Parameter::RearDriving,
];

/// (slip angle deg, quantity, RMSE) of the model that was published with the trials, in the quantity's unit,
/// by running it (MODEL.md 9 of the project's notes): many hand-tuned numbers, some per slip angle.
const PUBLISHED: [(f64, Quantity, f64); 6] = [
    (0.0, Quantity::Pull, 0.89),
    (0.0, Quantity::Side, 1.64),
    (0.0, Quantity::Sinkage, 2.2),
    (30.0, Quantity::Pull, 1.25),
    (30.0, Quantity::Side, 1.11),
    (30.0, Quantity::Sinkage, 1.8),
];

/// Project Chrono's SCM on Ding's wheel and soil, run on four of the slips.
const CHRONO: [(Quantity, f64); 3] = [
    (Quantity::Pull, 18.9),
    (Quantity::Torque, 2.2),
    (Quantity::Sinkage, 5.9),
];

/// Where the plate tests stand below the folder of measured data: name, disc diameter (m) and the height of the
/// sand's surface (m), as the script that was published with them has it.
pub const PLATES: [(&str, f64, f64); 2] = [
    (
        "cmu-wheel/f-d-large-box__force-displacement_1",
        0.06,
        -9.62e-3,
    ),
    (
        "cmu-wheel/f-d-large-box__force-displacement_4",
        0.1,
        -9.0e-3,
    ),
];

/// Every measured data set below `data` against the model, plain Wong-Reece and what was published.
///
/// Plate tests first (their bags and text files), then the smooth wheel at slip angle 0, then everything else as
/// prediction; a second set of numbers is fitted on slip angles 0 and 60 and predicts those between. At 90°
/// every trial sits deeper than the wheel's radius, outside the model.
///
/// # Errors
/// What a file lacks.
pub fn validate(data: &Path) -> Result<Validation> {
    let tests = plate_tests(data)?;
    let plates = fit_plates(&tests, &PlateSettings::default())?;
    let trials = cmu::trials(&data.join(cmu::TRIALS), "smooth", GREATEST_SLIP + 0.01)?;
    let grouser = cmu::trials(&data.join(cmu::TRIALS), "grouser", GREATEST_SLIP + 0.01)?;
    let mut out = Validation {
        rows: Vec::new(),
        fits: Vec::new(),
        plates,
        series: Vec::new(),
    };
    add_trials(&mut out, &trials, &grouser)?;
    add_ding(&mut out)?;
    Ok(out)
}

/// The plate tests of the measured data, from their bags.
///
/// # Errors
/// What a file lacks.
pub fn plate_tests(data: &Path) -> Result<Vec<PlateTest>> {
    PLATES
        .iter()
        .map(|(name, diameter, surface)| {
            let file = |ending: &str| data.join(format!("{name}.{ending}"));
            let record = read_bag(
                &format!("{} mm disc", (1e3 * diameter).round()),
                Plate::disc(*diameter)?,
                &BagSource {
                    bag: file("bag"),
                    topic: None,
                    force: "wrench.wrench.force.z".to_owned(),
                    stamp: Some("wrench.header.stamp".to_owned()),
                    sign: -1.0,
                },
                &DepthColumn {
                    file: file("txt"),
                    height: 5,
                    height_unit: 1e-3,
                    clock: 7,
                    controller: Some((6, 1e-3)),
                    surface: Some(*surface),
                },
            )?;
            Ok(record.test)
        })
        .collect()
}

/// The sand of the trials: φ and the unit weight as measured with it, no cohesion in dry sand, n and moduli
/// from the plates.
fn sand(plates: &PlateFit) -> SoilParams {
    SoilParams {
        cohesion: 0.0,
        phi: Angle::from_deg(29.0),
        k_shear: 0.02,
        c_1: 0.3,
        c_2: 0.3,
        unit_weight: Some(13.0e3),
        ..SoilParams::bekker(plates.k_c, plates.k_phi, plates.n)
    }
}

/// The same with our laws.
fn our_sand(plates: &PlateFit) -> SoilParams {
    SoilParams {
        n_1: 0.2,
        n_2: 0.3,
        rebound: 0.25,
        // a wheel that only slides sideways has no rear
        rear_drift: 1.0,
        laws: LawChoice {
            slip_sinkage: SlipSinkage::Whole,
            stress_position: StressPosition::Whole,
            shear: Some(ShearLaw::SlipVelocity),
            bulldozing: Some(Bulldozing::Chord),
        },
        ..sand(plates)
    }
}

fn law_error(source: grouser_terra::Error) -> Error {
    Error::Law {
        what: "a wheel of the measured data".to_owned(),
        source,
    }
}

fn is_at(trial: &Trial, degrees: f64) -> bool {
    (trial.slip_angle.to_degrees() - degrees).abs() < 1e-6
}

fn add_trials(out: &mut Validation, trials: &[Trial], grouser: &[Trial]) -> Result<()> {
    let wheel = cmu::smooth_wheel()?;
    let of = |angles: &[f64]| -> Vec<WheelTest> {
        let chosen = trials
            .iter()
            .filter(|trial| angles.iter().any(|a| is_at(trial, *a)));
        chosen.map(|trial| trial.test).collect()
    };
    let (straight, bracket) = (of(&[0.0]), of(&[0.0, 60.0]));
    let (plain, ours) = (sand(&out.plates), our_sand(&out.plates));
    let job = |model, fit, soil, tests, parameters| Job {
        data_set: CMU,
        model,
        fit,
        wheel,
        soil,
        scatter: TRIAL_SCATTER,
        tests,
        parameters,
    };
    let fitted = [
        job(ModelName::Grouser, STRAIGHT, ours, &straight, &OURS),
        job(ModelName::WongReece, STRAIGHT, plain, &straight, &PLAIN),
        job(ModelName::Grouser, BRACKET, ours, &bracket, &OURS_DRIFTING),
    ]
    .par_iter()
    .map(Job::run)
    .collect::<Result<Vec<Fitted>>>()?;
    for angle in [0.0, 15.0, 30.0, 60.0, 90.0] {
        let here: Vec<Trial> = trials.iter().filter(|t| is_at(t, angle)).copied().collect();
        add_group(out, &fitted, ("smooth", angle, &here))?;
    }
    let bars = wheel
        .with_grousers(Grousers {
            height: cmu::GROUSER_HEIGHT,
            rule: GrouserRule::AreaShare { tips: 0.1 },
        })
        .map_err(law_error)?;
    let on_bars: Vec<Fitted> = fitted.iter().map(|one| one.on(bars)).collect();
    add_group(out, &on_bars, ("grouser", 0.0, grouser))?;
    out.fits.extend(fitted.into_iter().map(|one| one.report));
    Ok(())
}

/// Rows and figures of one wheel at one slip angle.
fn add_group(
    out: &mut Validation,
    fitted: &[Fitted],
    (wheel, angle, trials): (&'static str, f64, &[Trial]),
) -> Result<()> {
    let tests: Vec<WheelTest> = trials.iter().map(|trial| trial.test).collect();
    let said = fitted
        .iter()
        .map(|one| one.predict(&tests))
        .collect::<Result<Vec<_>>>()?;
    let lines = lines(fitted, trials, angle)?;
    for quantity in [Quantity::Pull, Quantity::Side, Quantity::Sinkage] {
        let unit = quantity.scale();
        let repeats: Vec<(i64, f64)> = trials
            .iter()
            .filter_map(|trial| Some((slip_key(trial), trial.test.read(quantity)?)))
            .collect();
        for (one, said) in fitted.iter().zip(&said) {
            let errors: Vec<f64> = tests
                .iter()
                .zip(said)
                .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
                .collect();
            let seen =
                wheel == "smooth" && (angle == 0.0 || (one.report.fit == BRACKET && angle == 60.0));
            let published = (wheel == "smooth")
                .then(|| {
                    PUBLISHED
                        .iter()
                        .find(|(a, q, _)| *a == angle && *q == quantity)
                })
                .flatten();
            if let Some(score) = Score::of(&errors) {
                out.rows.push(Row {
                    data_set: CMU,
                    wheel,
                    slip_angle_deg: angle,
                    quantity,
                    model: one.report.model,
                    fit: one.report.fit,
                    split: if seen { Split::Fitted } else { Split::HeldOut },
                    score: score.in_unit(unit),
                    fitted_parameters: one.parameters.len(),
                    published_rmse: published.map(|(_, _, rmse)| *rmse),
                    scatter: pooled(&repeats).map(|sd| sd / unit),
                    hub_buried: said.iter().filter(|said| said.hub_buried).count(),
                });
            }
        }
        out.series.push(Series {
            data_set: CMU,
            wheel,
            slip_angle_deg: angle,
            quantity,
            measured: trials
                .iter()
                .filter_map(|trial| {
                    let deviation = match quantity {
                        Quantity::Pull => trial.pull_deviation,
                        Quantity::Side => trial.side_deviation,
                        _ => pooled(&repeats).unwrap_or(0.0),
                    };
                    Some(MeasuredPoint {
                        slip: trial.stated_slip,
                        value: trial.test.read(quantity)? / unit,
                        deviation: deviation / unit,
                    })
                })
                .collect(),
            lines: lines
                .iter()
                .map(|(model, fit, points)| {
                    let line = points
                        .iter()
                        .map(|(slip, said)| [*slip, said.of(quantity) / unit])
                        .collect();
                    (*model, *fit, line)
                })
                .collect(),
        });
    }
    Ok(())
}

/// Trials of one command: the stated slip to a hundredth.
#[allow(clippy::cast_possible_truncation, reason = "a slip is small")]
fn slip_key(trial: &Trial) -> i64 {
    (100.0 * trial.stated_slip).round() as i64
}

type Line = (
    ModelName,
    &'static str,
    Vec<(f64, crate::wheel::Prediction)>,
);

/// Predictions between the slips that were tried, under a load that goes straight from trial to trial.
fn lines(fitted: &[Fitted], trials: &[Trial], angle: f64) -> Result<Vec<Line>> {
    const STEPS: i32 = 60;
    let beta = Angle::from_deg(angle);
    let mut loads: Vec<(f64, f64)> = trials
        .iter()
        .filter_map(|trial| match trial.test.support {
            Support::Load(load) => Some((trial.stated_slip, load)),
            Support::Sinkage(_) => None,
        })
        .collect();
    loads.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut slips = Vec::new();
    let mut tests = Vec::new();
    for step in 0..=STEPS {
        let slip = -0.7 + 1.45 * f64::from(step) / f64::from(STEPS);
        let (travel, rim) = if slip >= 0.0 {
            (1.0 - slip, 1.0)
        } else {
            (1.0, 1.0 + slip)
        };
        let forward = if angle == 90.0 { 0.0 } else { beta.cos() };
        let kinematics = Kinematics::from_speeds(travel * forward, travel * beta.sin(), rim)
            .map_err(law_error)?;
        slips.push(slip);
        tests.push(WheelTest {
            kinematics,
            support: Support::Load(load_at(&loads, slip)),
            pull: None,
            side: None,
            torque: None,
            sinkage: None,
        });
    }
    fitted
        .iter()
        .map(|one| {
            let said = one.predict(&tests)?;
            let points = slips.iter().copied().zip(said).collect();
            Ok((one.report.model, one.report.fit, points))
        })
        .collect()
}

/// The mean load of the trials near a slip.
fn load_at(loads: &[(f64, f64)], slip: f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (at, load) in loads {
        let weight = (-((at - slip) / 0.12).powi(2)).exp() + 1e-12;
        sum += weight * load;
        weights += weight;
    }
    sum / weights
}

fn add_ding(out: &mut Validation) -> Result<()> {
    let (radius, width, _) = ding::WHEEL;
    let wheel = grouser_terra::RigidWheel::new(radius, width).map_err(law_error)?;
    let entry = catalogue::find("hit-lss1").ok_or(Error::Missing {
        what: "the soil hit-lss1",
        needed_by: "Ding's wheel".to_owned(),
    })?;
    let complete = |k_shear| {
        entry
            .completed(&catalogue::Completion {
                k_shear: Some(k_shear),
                c_1: Some(0.4),
                c_2: Some(0.2),
                unit_weight: None,
            })
            .map(|soil| *soil.params())
            .map_err(law_error)
    };
    let tests = ding::tests()?;
    let job = |model, fit, soil| Job {
        data_set: DING,
        model,
        fit,
        wheel,
        soil,
        scatter: DIGITISED,
        tests: &tests,
        parameters: &OURS_DING,
    };
    let ours = SoilParams {
        // the rear contact of a wheel without slip as long as the front
        rebound: 1.0,
        rear_driving: 2.0,
        ..complete(ding::K_SHEAR_RANGE.0)?
    };
    let fitted = [
        job(ModelName::Grouser, DING_ALL, ours).run()?,
        job(ModelName::WongReece, NOTHING, complete(0.0115)?).unfitted(),
    ];
    for quantity in [Quantity::Pull, Quantity::Torque, Quantity::Sinkage] {
        let unit = quantity.scale();
        let mut series = Series {
            data_set: DING,
            wheel: "smooth",
            slip_angle_deg: 0.0,
            quantity,
            measured: ding::POINTS
                .iter()
                .zip(&tests)
                .filter_map(|((slip, ..), test)| {
                    Some(MeasuredPoint {
                        slip: *slip,
                        value: test.read(quantity)? / unit,
                        deviation: 0.0,
                    })
                })
                .collect(),
            lines: Vec::new(),
        };
        for one in &fitted {
            let said = one.predict(&tests)?;
            let errors: Vec<f64> = tests
                .iter()
                .zip(&said)
                .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
                .collect();
            if let Some(score) = Score::of(&errors) {
                out.rows.push(Row {
                    data_set: DING,
                    wheel: "smooth",
                    slip_angle_deg: 0.0,
                    quantity,
                    model: one.report.model,
                    fit: one.report.fit,
                    split: if one.parameters.is_empty() {
                        Split::HeldOut
                    } else {
                        Split::Fitted
                    },
                    score: score.in_unit(unit),
                    fitted_parameters: one.parameters.len(),
                    published_rmse: CHRONO
                        .iter()
                        .find(|(q, _)| *q == quantity)
                        .map(|(_, rmse)| *rmse),
                    scatter: None,
                    hub_buried: said.iter().filter(|said| said.hub_buried).count(),
                });
            }
            let fine: Vec<WheelTest> = (0..=60)
                .map(|step| {
                    let slip = grouser_terra::Slip::new(0.6 * f64::from(step) / 60.0)
                        .map_err(law_error)?;
                    Ok(WheelTest {
                        kinematics: Kinematics::straight(slip),
                        ..tests[0]
                    })
                })
                .collect::<Result<_>>()?;
            let line = one
                .predict(&fine)?
                .iter()
                .zip(&fine)
                .map(|(said, test)| [test.kinematics.slip().value(), said.of(quantity) / unit])
                .collect();
            series.lines.push((one.report.model, one.report.fit, line));
        }
        out.series.push(series);
    }
    let [ours, _] = fitted;
    out.fits.push(ours.report);
    Ok(())
}
