//! Ding's wheels, and NASA's, against the model.

use grouser_terra::{Kinematics, OpenSoil, RigidWheel, Slip, catalogue};

use super::fitting::{Fitted, Job, law_error};
use super::rows::{MeasuredPoint, ModelName, Row, Series, SlipGroup, Split, Validation};
use super::score::Score;
use super::{ding, trec};
use grouser_files::soil::SoilNumber;
use grouser_identify::Parameter;
use grouser_identify::wheel::{Quantity, Scatter, WheelTest};
use grouser_identify::{Error, Result};

const DING_ALL: &str = "all six slips";
const NOTHING: &str = "nothing";

const DING: &str = "ding-2011";
const TREC: &str = "nasa-trec";

/// What residuals of points read off Ding's figures are divided by.
const DIGITISED: Scatter = Scatter {
    pull: 1.5,
    side: 1.5,
    torque: 0.3,
    sinkage: 1e-3,
};

/// Ding's wheel: five numbers; K is held at the lower end of what that paper measured.
const OURS_DING: [Parameter; 5] = [
    Parameter::Soil(SoilNumber::Exponent),
    Parameter::Soil(SoilNumber::ExponentDriving),
    Parameter::Soil(SoilNumber::C1),
    Parameter::Soil(SoilNumber::C2),
    Parameter::Soil(SoilNumber::RearDriving),
];

/// Project Chrono's SCM on Ding's wheel and soil, run on four of the slips.
const CHRONO: [(Quantity, f64); 3] = [
    (Quantity::Pull, 18.9),
    (Quantity::Torque, 2.2),
    (Quantity::Sinkage, 5.9),
];

impl Validation {
    /// One fit, its rows and figures.
    pub(super) fn add_ding(&mut self, lugged: Option<&(RigidWheel, Vec<WheelTest>)>) -> Result<()> {
        let tests = ding::tests()?;
        let fitted = models(&tests)?;
        if let Some((wheel, lugged)) = lugged {
            for quantity in [Quantity::Pull, Quantity::Torque, Quantity::Sinkage] {
                for one in &fitted {
                    let one = one.on(*wheel);
                    self.rows.extend(row(&one, lugged, quantity, "grouser")?);
                }
            }
        }
        for quantity in [Quantity::Pull, Quantity::Torque, Quantity::Sinkage] {
            let mut lines = Vec::new();
            for one in &fitted {
                self.rows.extend(row(one, &tests, quantity, "smooth")?);
                lines.push((
                    one.report.model,
                    one.report.fit,
                    line(one, &tests, quantity)?,
                ));
            }
            let points = ding::POINTS.iter().zip(&tests);
            self.series.push(Series {
                data_set: DING,
                wheel: "smooth",
                slip_angle_deg: 0.0,
                quantity,
                measured: points
                    .filter_map(|((slip, ..), test)| {
                        Some(MeasuredPoint {
                            slip: *slip,
                            value: test.read(quantity)? / quantity.scale(),
                            deviation: 0.0,
                        })
                    })
                    .collect(),
                lines,
            });
        }
        let [ours, _] = fitted;
        self.fits.push(ours.report);
        Ok(())
    }
}

impl Validation {
    /// The row of NASA's lugged wheel: published numbers of its soil, nothing fitted.
    pub(super) fn add_trec(&mut self, tests: &[WheelTest]) -> Result<()> {
        let job = Job {
            data_set: TREC,
            model: ModelName::WongReece,
            fit: NOTHING,
            wheel: trec::wheel()?,
            soil: trec::soil(),
            scatter: DIGITISED,
            tests,
            parameters: &[],
        };
        let row = row(&job.unfitted(), tests, Quantity::Pull, "grouser")?;
        self.rows.extend(row);
        Ok(())
    }
}

/// Ours, fitted, and plain Wong-Reece without a fit.
fn models(tests: &[WheelTest]) -> Result<[Fitted; 2]> {
    let (radius, width, _) = ding::WHEEL;
    let wheel = RigidWheel::new(radius, width).map_err(law_error)?;
    let entry = catalogue::find("hit-lss1").ok_or(Error::Missing {
        what: "the soil hit-lss1",
        needed_by: "Ding's wheel".to_owned(),
    })?;
    let complete = |k_shear| entry.open().k_shear(k_shear).stress_position(0.4, 0.2);
    let job = |model, fit, soil| Job {
        data_set: DING,
        model,
        fit,
        wheel,
        soil,
        scatter: DIGITISED,
        tests,
        parameters: &OURS_DING,
    };
    let ours = OpenSoil {
        // the rear contact of a wheel without slip as long as the front
        rebound: 1.0,
        rear_driving: 2.0,
        ..complete(ding::K_SHEAR_RANGE.0)
    };
    Ok([
        job(ModelName::Grouser, DING_ALL, ours).run()?,
        job(ModelName::WongReece, NOTHING, complete(0.0115)).unfitted(),
    ])
}

fn row(
    one: &Fitted,
    tests: &[WheelTest],
    quantity: Quantity,
    wheel: &'static str,
) -> Result<Option<Row>> {
    let said = one.predict(tests)?;
    let errors: Vec<f64> = tests
        .iter()
        .zip(&said)
        .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?))
        .collect();
    let smooth = wheel == "smooth";
    let published = CHRONO.iter().find(|(q, _)| smooth && *q == quantity);
    Ok(Score::from_errors(&errors).map(|score| Row {
        data_set: one.report.data_set,
        wheel,
        slip_angle_deg: 0.0,
        slips: SlipGroup::Steady,
        quantity,
        model: one.report.model,
        fit: one.report.fit,
        split: if one.parameters.is_empty() || !smooth {
            Split::HeldOut
        } else {
            Split::Fitted
        },
        score: score.in_unit(quantity.scale()),
        fitted_parameters: one.parameters.len(),
        published_rmse: published.map(|(_, rmse)| *rmse),
        scatter: None,
        hub_buried: said.iter().filter(|said| said.hub_buried).count(),
    }))
}

/// Predictions between the slips.
fn line(one: &Fitted, tests: &[WheelTest], quantity: Quantity) -> Result<Vec<[f64; 2]>> {
    let fine: Vec<WheelTest> = (0..=60)
        .map(|step| {
            let slip = Slip::new(0.01 * f64::from(step)).map_err(law_error)?;
            Ok(WheelTest {
                kinematics: Kinematics::straight(slip),
                ..tests[0]
            })
        })
        .collect::<Result<_>>()?;
    let said = one.predict(&fine)?;
    Ok(said
        .iter()
        .zip(&fine)
        .map(|(said, test)| {
            let slip = test.kinematics.slip().value();
            [slip, said.of(quantity) / quantity.scale()]
        })
        .collect())
}
