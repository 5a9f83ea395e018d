//! A job done: plates, then shear, then the wheel, each stage with what those before it found.

use grouser_files::soil::{SoilFile, SoilNumber};
use grouser_terra::{Angle, Bekker, OpenSoil, Pressure};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::inherited;
use crate::job::{Job, WheelJob};
use crate::least_squares::{
    Bounded, Interval, Settings, Status, Uncertainty, Verdict, multi_start, profile, redundancy,
    student_quantile,
};
use crate::parameter::Parameter;
use crate::plate::{self, PlateFit, PlateRecord, PlateTest, fit_plates};
use crate::plausible::{self, Plausibility};
use crate::readings::Readings;
use crate::shear::{self, ShearFit, ShearReading, fit_shear};
use crate::wheel::{self, Fixed, LawScore, Misfit, Prediction, WheelModel, WheelTest, predict};

/// A soil and how it was found.
///
/// ```
/// use grouser_files::Document;
/// use grouser_identify::{Job, identify};
///
/// let file = Document::read("../../examples/bevameter/tests.toml".as_ref())?;
/// let mut job = Job::read(&file)?;
/// job.wheel = None; // plates and shear alone
/// let found = identify(&job)?;
/// assert!(found.missing().is_empty());
/// assert!(found.soil.n.is_some_and(|n| n > 0.5) && found.soil.c_1.is_none()); // wheel tests would find c_1
/// # Ok::<(), grouser_identify::Error>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Identification {
    /// The soil; open where neither a test nor a statement gives a number.
    pub soil: OpenSoil,
    /// Plate tests.
    pub plates: Option<PlateStage>,
    /// Shear tests.
    pub shear: Option<ShearStage>,
    /// Wheel tests.
    pub wheel: Option<WheelStage>,
    /// Numbers of a size that soils or tests do not have.
    pub implausible: Vec<Plausibility>,
    /// Mistakes in units that explain the result, the likeliest first, in words.
    pub unit_mistakes: Vec<String>,
    /// Sets of laws on tests that they were not fitted to, if they were compared ([`compare_laws`](crate::compare_laws)).
    pub comparison: Vec<LawScore>,
}

/// The result of plate tests.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlateStage {
    /// The tests.
    pub tests: Vec<PlateTest>,
    /// How those out of bags were read.
    pub records: Vec<PlateRecord>,
    /// How many readings repeat others and are not counted again.
    pub copies: usize,
    /// Their result.
    pub fit: PlateFit,
}

/// The result of shear tests.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShearStage {
    /// The readings that were used.
    pub readings: Vec<ShearReading>,
    /// How many others lie where the displacement goes back, or forth again to where it has been.
    pub unloading: usize,
    /// How many readings repeat others and are not counted again.
    pub copies: usize,
    /// Their result.
    pub fit: ShearFit,
}

/// One number that wheel tests determined.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct WheelNumber {
    /// Which.
    pub parameter: Parameter,
    /// Its value, SI.
    pub value: f64,
    /// Its standard error, SI, with what plates and shear tests leave uncertain; NaN where the data do not determine it.
    pub standard_error: f64,
    /// Its 95 % interval, SI, likewise.
    pub interval: Interval,
    /// What the data say about it.
    pub verdict: Verdict,
    /// What plates, shear tests or the job state for it, SI, where the wheel tests overrule that.
    pub overruled: Option<f64>,
}

/// The result of wheel tests.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct WheelStage {
    /// The tests.
    pub tests: Vec<WheelTest>,
    /// How many tests repeat others and are not counted again.
    pub copies: usize,
    /// How many times more readings there are than independent ones (from the residuals' correlation).
    pub redundancy: f64,
    /// Mean square of the residuals, in stated variances.
    pub mean_square_residual: f64,
    /// The model's predictions of them.
    pub said: Vec<Prediction>,
    /// The numbers.
    pub numbers: Vec<WheelNumber>,
    /// Quantities whose readings lie further from the law than their stated scatter explains.
    pub misfits: Vec<Misfit>,
    /// How far the zero of the measured sinkages is off, m, where the readings show it and no datum is fitted.
    pub sinkage_shift: Option<f64>,
    /// Correlation of each pair of them.
    pub correlation: Vec<Vec<f64>>,
    /// Greatest over least singular value of the scaled Jacobian.
    pub condition: f64,
    /// How the search ended.
    pub status: Status,
    /// How many starts ended as well as the best.
    pub reached: usize,
    /// How many starts there were.
    pub starts: usize,
}

impl Identification {
    /// Its numbers beside what soils have, and the sizes of the `readings` behind it.
    pub(crate) fn plausibilities(&self, readings: &Readings) -> Vec<Plausibility> {
        let plates = self.plates.as_ref().map(|stage| &stage.fit);
        let shear = self.shear.as_ref().map(|stage| &stage.fit);
        plausible::all(plates, shear, readings)
    }
}

/// The job done with these readings, without a look at whether the result is plausible.
pub(crate) fn fitted(job: &Job, readings: &Readings) -> Result<Identification> {
    let mut out = Identification {
        soil: job.soil,
        plates: None,
        shear: None,
        wheel: None,
        implausible: Vec::new(),
        unit_mistakes: Vec::new(),
        comparison: Vec::new(),
    };
    if !job.plates.is_empty() {
        let stage = plates(job, readings)?;
        out.soil.n = Some(stage.fit.n);
        out.soil.pressure = Pressure::Bekker(Bekker {
            k_c: Some(stage.fit.k_c),
            k_phi: Some(stage.fit.k_phi),
        });
        out.plates = Some(stage);
    }
    if let Some(all) = &readings.shear {
        let loading = shear::loading(all);
        let unloading = all.len() - loading.len();
        let fit = fit_shear(&loading, crate::least_squares::Loss::Squares)?;
        let [cohesion, phi, k_shear] = fit.values;
        out.soil = out
            .soil
            .cohesion(cohesion)
            .phi(Angle::from_rad(phi))
            .k_shear(k_shear);
        out.shear = Some(ShearStage {
            readings: loading,
            unloading,
            copies: readings.copies.shear,
            fit,
        });
    }
    if let Some((wheel, tests)) = &readings.wheel {
        wheel_stage(wheel, tests, readings, &mut out)?;
    }
    Ok(out)
}

fn plates(job: &Job, readings: &Readings) -> Result<PlateStage> {
    let tests = readings.plates.clone();
    let fit = fit_plates(&tests, &job.plate_settings).map_err(|error| match error {
        Error::TooFew { .. } => Error::TooFewReadings {
            message: plate::too_few(&tests, &job.plate_settings),
        },
        other => other,
    })?;
    Ok(PlateStage {
        tests,
        records: readings.records.clone(),
        copies: readings.copies.plates,
        fit,
    })
}

/// Steps of a rough search: fits of sound readings end after about ten.
const ROUGH_STEPS: u32 = 25;

/// Fits the wheel's numbers and puts them into the soil.
///
/// The fit holds what earlier stages found for exact; the errors of its answer contain theirs. Source: error propagation
/// through the stages, as for two-step estimators (Murphy & Topel 1985, J. Business & Economic Statistics 3).
fn wheel_stage(
    job: &WheelJob,
    tests: &[WheelTest],
    readings: &Readings,
    out: &mut Identification,
) -> Result<()> {
    let soil = &out.soil;
    check_known(job, soil)?;
    let fixed = Fixed {
        wheel: job.wheel,
        soil: *soil,
        scatter: job.scatter,
    };
    let model = WheelModel::new(fixed, tests, &job.parameters);
    let start: Vec<Bounded> = job.parameters.iter().map(|p| p.bounded(soil)).collect();
    let settings = Settings {
        loss: job.loss,
        steps: if readings.is_rough { ROUGH_STEPS } else { 200 },
        ..Settings::default()
    };
    let (best, reached) = multi_start(&model, model.count(), &start, &settings, &job.starts)?;
    let redundancy = redundancy(
        model
            .series(&best.residuals)
            .into_iter()
            .map(Vec::into_iter),
    );
    let mut uncertainty = Uncertainty::from_fit(&best, job.loss).of_alike(&best, redundancy);
    let plates = (out.plates.as_ref()).map(|stage| (&stage.fit, stage.tests.as_slice()));
    let shear = out.shear.as_ref().map(|stage| &stage.fit);
    let changes = inherited::changes(plates, shear, job, (&fixed, tests), &best);
    let inherited = uncertainty.widen(&best, job.loss, changes.as_deref());
    let quantile = student_quantile(0.975, uncertainty.freedom);
    // how far a number may leave its bound, and takes others along, is no matter of a straight line
    let any_on_bound = (0..best.x.len()).any(|index| best.on_bound(index));
    let intervals = (0..best.x.len())
        .into_par_iter()
        .map(|index| {
            if !readings.is_rough && (job.profile || any_on_bound) {
                let short = Settings {
                    steps: 40,
                    ..settings
                };
                let own = profile(&model, &best, index, 0.95, &short)?;
                let (x, bound) = (best.x[index], &best.bounds[index]);
                let own = own.widened(x, redundancy.sqrt());
                return Ok(own.with_added(x, quantile * inherited[index], bound));
            }
            let half = uncertainty.half_width(index, 0.95);
            let end = |value: f64| value.is_finite().then_some(value);
            Ok(Interval {
                low: end(best.x[index] - half),
                high: end(best.x[index] + half),
            })
        })
        .collect::<Result<Vec<Interval>>>()?;
    uncertainty.judge_intervals(&best, &intervals);
    let numbers = job
        .parameters
        .iter()
        .enumerate()
        .map(|(index, parameter)| WheelNumber {
            parameter: *parameter,
            value: best.x[index],
            standard_error: uncertainty.standard_errors[index],
            interval: intervals[index],
            verdict: uncertainty.verdicts[index],
            overruled: parameter
                .of(&fixed.soil)
                .filter(|_| parameter.is_measured()),
        })
        .collect();
    for (parameter, value) in job.parameters.iter().zip(&best.x) {
        parameter.put(&mut out.soil, *value);
    }
    out.soil.fitted = wheel::fitted_range(&job.wheel, tests);
    let said = predict(&fixed, tests, &job.parameters, &best.x)?;
    let freedom = uncertainty.freedom as f64 / best.residuals.len() as f64;
    let squares: f64 = best.residuals.iter().map(|r| r * r).sum();
    let variance = redundancy * f64::max(squares / uncertainty.freedom as f64, 1.0);
    let has_datum = job.parameters.contains(&Parameter::SinkageDatum);
    out.wheel = Some(WheelStage {
        sinkage_shift: (!has_datum)
            .then(|| wheel::sinkage_shift(tests, job.scatter.sinkage, &best, variance))
            .flatten(),
        misfits: wheel::misfits(tests, &said, &job.scatter, job.loss, freedom),
        said,
        tests: tests.to_vec(),
        copies: readings.copies.wheel,
        redundancy,
        mean_square_residual: squares / best.residuals.len() as f64,
        numbers,
        correlation: uncertainty.correlation,
        condition: uncertainty.condition,
        status: best.status,
        reached,
        starts: job.starts.starts.max(1),
    });
    Ok(())
}

/// What a soil file must have.
const NEEDED_IN_FILES: [SoilNumber; 5] = [
    SoilNumber::Exponent,
    SoilNumber::KC,
    SoilNumber::KPhi,
    SoilNumber::Cohesion,
    SoilNumber::Phi,
];
/// What the stresses under a wheel take.
const NEEDED: [SoilNumber; 8] = {
    let [n, k_c, k_phi, cohesion, phi] = NEEDED_IN_FILES;
    [
        n,
        k_c,
        k_phi,
        cohesion,
        phi,
        SoilNumber::KShear,
        SoilNumber::C1,
        SoilNumber::C2,
    ]
};

/// Every number that a wheel needs must be known or be fitted.
fn check_known(job: &WheelJob, soil: &OpenSoil) -> Result<()> {
    for parameter in NEEDED.map(Parameter::Soil) {
        if parameter.of(soil).is_none() && !job.parameters.contains(&parameter) {
            return Err(Error::Missing {
                what: parameter.key(),
                needed_by: "the wheel's stresses need it: name it in `fit`, or state it in [soil]"
                    .to_owned(),
            });
        }
    }
    Ok(())
}

impl Identification {
    /// The numbers that a soil file needs and that nothing gives.
    #[must_use]
    pub fn missing(&self) -> Vec<&'static str> {
        NEEDED_IN_FILES
            .into_iter()
            .filter(|number| number.of(&self.soil).is_none())
            .map(SoilNumber::key)
            .collect()
    }

    /// The soil as a file, with what it was identified from in its source and the numbers' intervals in its
    /// remarks.
    #[must_use]
    pub fn soil_file(&self, job: &Job) -> (SoilFile, Vec<String>) {
        let mut from = Vec::new();
        if let Some(stage) = &self.plates {
            from.push(format!("{} plate tests", stage.tests.len()));
        }
        if let Some(stage) = &self.shear {
            from.push(format!("{} shear readings", stage.readings.len()));
        }
        if let Some(stage) = &self.wheel {
            from.push(format!("{} wheel tests", stage.tests.len()));
        }
        let source = format!("identified by grouser from {}", from.join(", "));
        let mut file = SoilFile::new(&job.name, &source, self.soil);
        file.key.clone_from(&job.key);
        (file, self.remarks())
    }
}
