//! Why a soil that was found is doubtful.

use core::fmt;

use grouser_files::soil::SoilNumber;
use grouser_real::median;

use crate::identification::{Identification, WheelStage};
use crate::identified::IdentifiedNumber;
use crate::least_squares::Verdict;
use crate::parameter::Parameter;
use crate::plate::PlateTest;
use crate::plausible::Plausibility;
use crate::shear::ShearReading;
use crate::wheel::{Misfit, Quantity, Support};

/// Why the result of a job is doubtful; displayed as a sentence without a full stop.
///
/// ```
/// use grouser_files::Document;
/// use grouser_identify::{Job, identify};
///
/// let job = Job::read(&Document::read("../../examples/bevameter/tests.toml".as_ref())?)?;
/// assert_eq!(identify(&job)?.doubts(), []);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// Numbers lie on bounds: other than 0, or so that others are not determined.
    OnBound {
        /// Their keys.
        names: Vec<String>,
        /// The keys of the numbers fitted with them that are not determined.
        undetermined: Vec<String>,
    },
    /// The modulus k_phi of plates is negative: wide wheels have no pressure.
    NegativeModulus {
        /// The width from which on k_c/b + k_phi is negative, m.
        from_width: f64,
    },
    /// Many readings of a plate have no positive force, or many of a shear test a negative displacement or normal stress.
    WrongSign {
        /// What the readings are.
        what: &'static str,
        /// How many.
        readings: usize,
        /// Of how many.
        of: usize,
    },
    /// Readings lie further from the law than their stated scatter explains.
    Misfit(Vec<Misfit>),
    /// The soil that was found does not bear the load of wheel tests at any sinkage up to the hub.
    HubBuried {
        /// How many tests.
        buried: usize,
        /// Of how many.
        tests: usize,
    },
    /// Numbers are of a size that soils or tests do not have.
    Implausible(Vec<Plausibility>),
    /// Pull alone was read, and the position of the maximum stress that it is fitted with is beyond published ones.
    PullAlone {
        /// c_1.
        c_1: f64,
    },
    /// Readings of sinkage fit with another zero, and no datum is fitted.
    SinkageZero {
        /// How far the zero is off, m.
        shift: f64,
    },
    /// The datum of the sinkage is negative, and larger than what was read.
    DatumAboveSinkage {
        /// The datum, m.
        datum: f64,
        /// The median sinkage that was read, m.
        read: f64,
    },
    /// Plates and wheel differ in size by more than a factor of two.
    PlateSize {
        /// Diameter of the smallest and the largest plate, m.
        plates: (f64, f64),
        /// Width of the wheel, m.
        wheel: f64,
    },
    /// Mistakes in units that explain the result, in words: the likeliest first.
    UnitMistake(Vec<String>),
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OnBound {
                names,
                undetermined,
            } => {
                let verb = if names.len() == 1 { "lies" } else { "lie" };
                let names = names.join(", ");
                write!(
                    f,
                    "{names} {verb} on a bound: the law does not fit, the bound is wrong, or tests are missing. "
                )?;
                match undetermined.as_slice() {
                    [] => write!(f, "The other numbers depend on that"),
                    others => write!(f, "Not determined with that: {}", others.join(", ")),
                }
            }
            Self::NegativeModulus { from_width } => write!(
                f,
                "k_phi is negative, and so is the pressure under wheels of a width b from {from_width:.3} m on: are depth \
                 and force exchanged, or the plates too alike?"
            ),
            Self::WrongSign { what, readings, of } => write!(f, "{readings} of {of} {what}"),
            Self::Misfit(misfits) => {
                let each = |misfit: &Misfit| {
                    format!(
                        "{} (of {} readings) by {:.1} times",
                        misfit.quantity.key(),
                        misfit.readings,
                        misfit.ratio
                    )
                };
                let each: Vec<String> = misfits.iter().map(each).collect();
                write!(
                    f,
                    "readings scatter about the law more than stated: {} the stated scatter. The law, [soil], a sign or \
                     a unit is wrong, or the scatter is. Errors and intervals are widened, but do not contain a wrong law",
                    each.join(", ")
                )
            }
            Self::HubBuried { buried, tests } => write!(
                f,
                "{buried} of {tests} wheel tests: the soil found does not bear the load at any sinkage up to the hub. \
                 The wheel is taken to sit at the hub there, whatever the load: check the unit of the loads"
            ),
            Self::Implausible(numbers) => {
                let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
                write!(f, "implausible: {}", numbers.join("; "))
            }
            Self::PullAlone { c_1 } => write!(
                f,
                "c_1 is {c_1:.2} (published: up to {MAX_PUBLISHED_C_1}), and only pull was read: one pull curve does not separate the position \
                 of the maximum stress from the strength of the soil. Read torque or sinkage too, or state c_1 in [soil]"
            ),
            Self::SinkageZero { shift } => write!(
                f,
                "readings of sinkage fit with their zero {:.1} mm off: add `sinkage_datum_m` to `fit`, or measure the zero",
                1e3 * shift
            ),
            Self::DatumAboveSinkage { datum, read } => write!(
                f,
                "sinkage_datum_m is {:.1} mm where {:.1} mm of sinkage were read (median): it makes up for another number or a law. Measure \
                 the zero of the sinkage",
                1e3 * datum,
                1e3 * read
            ),
            Self::PlateSize { plates, wheel } => write!(
                f,
                "plates of {:.0} to {:.0} mm and a wheel of {:.0} mm differ in size by more than a factor of two: plates may not predict the \
                 sinkage of such a wheel. Press plates of the wheel's width, or fit n and k_phi_kn_per_m_n2 on wheel tests",
                1e3 * plates.0,
                1e3 * plates.1,
                1e3 * wheel
            ),
            Self::UnitMistake(likely) => {
                write!(f, "likely mistake in a unit: {}", likely.join(", or "))
            }
        }
    }
}

impl Identification {
    /// Why the result is doubtful; empty where it is not.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        if !self.unit_mistakes.is_empty() {
            doubts.push(Doubt::UnitMistake(self.unit_mistakes.clone()));
        }
        if !self.implausible.is_empty() {
            doubts.push(Doubt::Implausible(self.implausible.clone()));
        }
        if let Some(stage) = &self.plates {
            doubts.extend(negative_modulus(stage.fit.k_c, stage.fit.k_phi));
            let used = stage.fit.fit.residuals.len();
            let unloaded = stage.fit.left_out.unloaded;
            doubts.extend(wrong_sign(
                "plate readings below `least_depth_m` have a force of 0 or less and are left out: those that stay \
                 are the greater ones",
                unloaded,
                used + unloaded,
            ));
            doubts.extend(on_bound(&stage.fit.numbers()));
        }
        if let Some(stage) = &self.shear {
            let negative = stage.readings.iter().filter(|reading| is_negative(reading));
            doubts.extend(wrong_sign(
                "shear readings have a negative displacement or normal stress",
                negative.count(),
                stage.readings.len(),
            ));
            doubts.extend(on_bound(&stage.fit.numbers()));
        }
        if let Some(stage) = &self.wheel {
            if !stage.misfits.is_empty() {
                doubts.push(Doubt::Misfit(stage.misfits.clone()));
            }
            let pairs = stage.tests.iter().zip(&stage.said);
            let is_buried =
                |test: &Support, hub_buried: bool| hub_buried && matches!(test, Support::Load(_));
            let buried = pairs.filter(|(test, said)| is_buried(&test.support, said.hub_buried));
            let (buried, tests) = (buried.count(), stage.tests.len());
            if buried > 0 {
                doubts.push(Doubt::HubBuried { buried, tests });
            }
            doubts.extend(on_bound(&stage.in_key_units()));
            doubts.extend(self.of_one_curve(stage));
        }
        doubts
    }
}

/// The largest published c_1 (loose sand, \[WR67\]). Prior from measured data.
const MAX_PUBLISHED_C_1: f64 = 0.43;

impl Identification {
    /// What the readings of one curve do not hold, and a wheel of another size than the plates.
    fn of_one_curve(&self, stage: &WheelStage) -> impl Iterator<Item = Doubt> {
        let fitted = |parameter| {
            let mut numbers = stage.numbers.iter();
            numbers.find(|number| number.parameter == parameter)
        };
        let is_read = |quantity| stage.tests.iter().any(|test| test.read(quantity).is_some());
        let others = [Quantity::Side, Quantity::Torque, Quantity::Sinkage];
        let c_1 = fitted(Parameter::Soil(SoilNumber::C1)).map(|number| number.value);
        let pull_alone = c_1
            .filter(|c_1| *c_1 > MAX_PUBLISHED_C_1 && !others.into_iter().any(is_read))
            .map(|c_1| Doubt::PullAlone { c_1 });
        let zero = stage
            .sinkage_shift
            .map(|shift| Doubt::SinkageZero { shift });
        let read = stage.tests.iter().filter_map(|test| test.sinkage);
        let mut read: Vec<f64> = read.map(f64::abs).collect();
        let datum = fitted(Parameter::SinkageDatum).zip(median(&mut read));
        let datum = datum.map(|(number, read)| (number.value, read));
        let datum = datum
            .filter(|(datum, read)| -datum > *read)
            .map(|(datum, read)| Doubt::DatumAboveSinkage { datum, read });
        let pressure = fitted(Parameter::Soil(SoilNumber::KPhi));
        let plates = self.plates.as_ref().filter(|_| pressure.is_none());
        let size = (plates.zip(self.soil.fitted.as_ref()))
            .and_then(|(plates, fitted)| plate_size(&plates.tests, fitted.width.0));
        [pull_alone, zero, datum, size].into_iter().flatten()
    }
}

/// Diameters of plates against the width of the wheel. Up to a factor of 1.2 plates were off by 10 to 25 % in the force of a pressed
/// wheel (`docs/decisions/plates-and-wheels.md`); beyond a factor of two no law of size was tested.
fn plate_size(tests: &[PlateTest], wheel: f64) -> Option<Doubt> {
    const MAX_RATIO: f64 = 2.0;
    let sizes = tests.iter().map(|test| 2.0 * test.plate.width);
    let plates = sizes.fold((f64::INFINITY, 0.0), |(low, high), size| {
        (f64::min(low, size), f64::max(high, size))
    });
    let differs = wheel * MAX_RATIO < plates.0 || wheel > MAX_RATIO * plates.1;
    differs.then_some(Doubt::PlateSize { plates, wheel })
}

/// k_c/b + k_phi below 0 from some width b on.
fn negative_modulus(k_c: f64, k_phi: f64) -> Option<Doubt> {
    (k_phi < 0.0).then(|| Doubt::NegativeModulus {
        from_width: (-k_c / k_phi).max(0.0),
    })
}

fn is_negative(reading: &ShearReading) -> bool {
    reading.normal < 0.0 || reading.displacement < 0.0
}

fn wrong_sign(what: &'static str, readings: usize, of: usize) -> Option<Doubt> {
    /// Of the readings: fewer are noise about 0, or the moment before the plate touches the ground.
    const MAX_SHARE: f64 = 0.05;
    (readings as f64 > MAX_SHARE * of as f64).then_some(Doubt::WrongSign { what, readings, of })
}

/// The doubt about numbers that were fitted together. A bound of 0 is one of nature, as of the cohesion of dry sand: where
/// the others are determined with it, whose errors include it, there is no doubt.
fn on_bound(numbers: &[IdentifiedNumber]) -> Option<Doubt> {
    let name = |number: &IdentifiedNumber| number.name.clone();
    let (bound, others): (Vec<_>, Vec<_>) = numbers
        .iter()
        .partition(|number| number.verdict == Verdict::OnBound);
    let undetermined: Vec<String> = others
        .into_iter()
        .filter(|number| number.verdict != Verdict::Identified)
        .map(name)
        .collect();
    let is_stopped = bound.iter().any(|number| number.value != 0.0);
    (is_stopped || (!bound.is_empty() && !undetermined.is_empty())).then(|| Doubt::OnBound {
        names: bound.into_iter().map(name).collect(),
        undetermined,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::Interval;

    fn number(name: &str, value: f64, verdict: Verdict) -> IdentifiedNumber {
        let (low, high) = (None, None);
        IdentifiedNumber {
            name: name.to_owned(),
            value,
            standard_error: f64::NAN,
            interval: Interval { low, high },
            verdict,
            overruled: None,
        }
    }

    #[test]
    fn numbers_on_bounds_are_doubtful_but_at_0_beside_what_is_determined() {
        use Verdict::{Identified, Loose, OnBound};
        let words = |numbers: &[IdentifiedNumber]| on_bound(numbers).map(|doubt| doubt.to_string());
        let fine = [
            number("phi_deg", 30.0, Identified),
            number("c_pa", 0.0, OnBound),
        ];
        assert_eq!(words(&fine), None);
        assert_eq!(words(&fine[..1]), None);
        assert_eq!(words(&[number("phi_deg", 30.0, Loose)]), None);
        let why = "on a bound: the law does not fit, the bound is wrong, or tests are missing.";
        let loose = [number("phi_deg", 30.0, Loose), number("c_pa", 0.0, OnBound)];
        let text = format!("c_pa lies {why} Not determined with that: phi_deg");
        assert_eq!(words(&loose), Some(text));
        let stopped = [
            number("n_0", 0.8, Identified),
            number("K_m", 0.5, OnBound),
            number("c_pa", 0.0, OnBound),
        ];
        let text = format!("K_m, c_pa lie {why} The other numbers depend on that");
        assert_eq!(words(&stopped), Some(text));
    }

    #[test]
    fn a_negative_modulus_is_met_from_a_width_on() {
        let from = |k_c, k_phi| match negative_modulus(k_c, k_phi) {
            Some(Doubt::NegativeModulus { from_width }) => Some(from_width),
            other => {
                assert_eq!(other, None);
                None
            }
        };
        assert_eq!([from(6e3, 0.0), from(-6e3, 1e5)], [None; 2]);
        // 6000/0.05 - 120,000 is 0
        assert_eq!(from(6e3, -120e3), Some(0.05));
        assert_eq!(from(-6e3, -120e3), Some(0.0));
    }

    #[test]
    fn a_stress_or_displacement_below_0_is_negative() {
        let of = |normal, displacement| {
            let shear = -1.0;
            is_negative(&ShearReading {
                normal,
                displacement,
                shear,
            })
        };
        assert!(!of(0.0, 0.0) && !of(1.0, 1.0));
        assert!(of(-1.0, 1.0) && of(1.0, -1.0) && of(-1.0, -1.0));
    }

    #[test]
    fn more_than_one_reading_in_twenty_has_a_wrong_sign() {
        let of =
            |readings, of| wrong_sign("are wrong", readings, of).map(|doubt| doubt.to_string());
        assert_eq!(
            [of(0, 0), of(0, 7), of(1, 20), of(5, 100)],
            [const { None }; 4]
        );
        assert_eq!(of(6, 100), Some("6 of 100 are wrong".to_owned()));
        assert_eq!(of(1, 19), Some("1 of 19 are wrong".to_owned()));
    }
}
