//! What was identified, number by number, in the units of files.

use grouser_files::soil::SoilNumber;

use crate::identification::{Identification, WheelStage};
use crate::least_squares::{Interval, Verdict};
use crate::plate::{PlateFit, PlateParameter};
use crate::shear::ShearFit;

/// An identified number in the unit of its name.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct IdentifiedNumber {
    /// Its key in files, with its unit.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard error; NaN where the data do not determine it.
    pub standard_error: f64,
    /// Its 95 % interval.
    pub interval: Interval,
    /// What the data say about it.
    pub verdict: Verdict,
    /// What plates, shear tests or the job state for it, where the wheel tests overrule that.
    pub overruled: Option<f64>,
}

fn scaled(interval: Interval, unit: f64) -> Interval {
    Interval {
        low: interval.low.map(|low| low / unit),
        high: interval.high.map(|high| high / unit),
    }
}

impl PlateFit {
    /// The numbers that were fitted, in the units of their names.
    #[must_use]
    pub fn numbers(&self) -> Vec<IdentifiedNumber> {
        self.parameters
            .iter()
            .map(|own| plate_number(own, own.name.clone(), 1.0))
            .collect()
    }

    /// [`PlateFit::moduli`] in the units of their keys in soil files.
    #[must_use]
    pub fn moduli_in_key_units(&self) -> Vec<IdentifiedNumber> {
        self.moduli
            .iter()
            .zip([SoilNumber::KC, SoilNumber::KPhi])
            .map(|(own, key)| plate_number(own, key.key().to_owned(), key.key_unit()))
            .collect()
    }
}

fn plate_number(own: &PlateParameter, name: String, unit: f64) -> IdentifiedNumber {
    IdentifiedNumber {
        name,
        value: own.value / unit,
        standard_error: own.standard_error / unit,
        interval: scaled(own.interval, unit),
        verdict: own.verdict,
        overruled: None,
    }
}

impl ShearFit {
    /// What [`ShearFit::values`] are.
    const NUMBERS: [SoilNumber; 3] = [SoilNumber::Cohesion, SoilNumber::Phi, SoilNumber::KShear];

    /// The numbers, in the units of their names.
    #[must_use]
    pub fn numbers(&self) -> Vec<IdentifiedNumber> {
        let number = |(index, number): (usize, SoilNumber)| {
            let unit = number.key_unit();
            IdentifiedNumber {
                name: number.key().to_owned(),
                value: self.values[index] / unit,
                standard_error: self.standard_errors[index] / unit,
                interval: scaled(self.intervals[index], unit),
                verdict: self.uncertainty.verdicts[index],
                overruled: None,
            }
        };
        Self::NUMBERS.into_iter().enumerate().map(number).collect()
    }
}

impl WheelStage {
    /// The numbers, in the units of their names.
    #[must_use]
    pub fn in_key_units(&self) -> Vec<IdentifiedNumber> {
        let number = |own: &crate::WheelNumber| {
            let unit = own.parameter.key_unit();
            IdentifiedNumber {
                name: own.parameter.key().to_owned(),
                value: own.value / unit,
                standard_error: own.standard_error / unit,
                interval: scaled(own.interval, unit),
                verdict: own.verdict,
                overruled: own.overruled.map(|known| known / unit),
            }
        };
        self.numbers.iter().map(number).collect()
    }
}

impl Identification {
    /// All numbers: of plates, of shear tests, of wheel tests.
    ///
    /// ```
    /// use grouser_files::Document;
    /// use grouser_identify::{Job, identify};
    ///
    /// let job = Job::read(&Document::read("../../examples/bevameter/tests.toml".as_ref())?)?;
    /// let numbers = identify(&job)?.numbers();
    /// let phi = numbers.iter().find(|number| number.name == "phi_deg").expect("shear tests give it");
    /// assert!((phi.value - 30.96).abs() < 0.2); // what the example was made of
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn numbers(&self) -> Vec<IdentifiedNumber> {
        let plates = self.plates.iter().flat_map(|stage| stage.fit.numbers());
        let shear = self.shear.iter().flat_map(|stage| stage.fit.numbers());
        let wheel = self.wheel.iter().flat_map(WheelStage::in_key_units);
        plates.chain(shear).chain(wheel).collect()
    }

    /// Names of the numbers whose intervals do not contain how plate or shear tests of the same soil differ, since no second
    /// test determines them.
    ///
    /// ```
    /// use grouser_files::Document;
    /// use grouser_identify::{Job, identify};
    ///
    /// let job = Job::read(&Document::read("../../examples/bevameter/tests.toml".as_ref())?)?;
    /// // one plate of each of two widths
    /// assert!(identify(&job)?.of_single_tests().contains(&"k_c_kn_per_m_n1".to_owned()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn of_single_tests(&self) -> Vec<String> {
        let mut names = Vec::new();
        if let Some(stage) = &self.plates {
            names.extend(stage.fit.single_test.iter().cloned());
            if stage.fit.is_separable() && names.iter().any(|name| name.starts_with("k_")) {
                let moduli = stage.fit.moduli_in_key_units().into_iter();
                names.extend(moduli.map(|number| number.name));
            }
        }
        if let Some(stage) = &self.shear {
            let numbers = stage.fit.numbers();
            let single = stage.fit.single_test.iter();
            names.extend(single.map(|index| numbers[*index].name.clone()));
        }
        names
    }

    /// The numbers with their intervals in words, for the remarks of a soil file.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let doubts = self.doubts();
        let mut list: Vec<String> = doubts
            .iter()
            .map(|doubt| format!("WARNING: {doubt}"))
            .collect();
        let single = self.of_single_tests();
        if !single.is_empty() {
            list.push(format!(
                "not in the intervals of {}: how tests of the same soil differ",
                single.join(", ")
            ));
        }
        // with plates of one width the file's k_c and k_phi are no numbers of the soil
        let one_width = self.plates.iter().filter(|stage| !stage.fit.is_separable());
        let moduli = one_width.flat_map(|stage| stage.fit.moduli_in_key_units());
        for number in self.numbers().into_iter().chain(moduli) {
            let digits = if number.value.abs() > 1e3 { 0 } else { 4 };
            let end = |end: Option<f64>| end.map_or("open".to_owned(), |v| format!("{v:.digits$}"));
            let IdentifiedNumber {
                name,
                value,
                interval,
                ..
            } = &number;
            let (low, high) = (end(interval.low), end(interval.high));
            let verdict = number.verdict.key();
            list.push(format!(
                "{name} {value:.digits$}, 95 % [{low}, {high}], {verdict}"
            ));
            if let Some(known) = number.overruled {
                list.push(format!(
                    "{name} is that of the wheel tests; {known:.4} was measured or stated"
                ));
            }
        }
        list
    }
}
