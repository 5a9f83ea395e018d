//! Readings of plate tests that no fit uses, and why.

use super::PlateSettings;
use super::test::PlateTest;
use crate::branches::{Branch, branches};

/// Fewer readings than these show no law.
pub(super) const MIN_READINGS: usize = 10;

/// What a fit does with a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Fitted,
    Shallow,
    Unloading,
    Unloaded,
}

impl Use {
    /// Of each reading of a test whose readings lie on these branches; depths below `least_depth` (m) are left out.
    pub(super) fn of_test(test: &PlateTest, branches: &[Branch], least_depth: f64) -> Vec<Self> {
        let branches = branches.iter().enumerate();
        let of = |(index, branch)| Self::new(test, index, branch, least_depth);
        branches.map(of).collect()
    }

    fn new(test: &PlateTest, index: usize, branch: &Branch, least_depth: f64) -> Self {
        if !(test.depth[index] >= least_depth) {
            Self::Shallow
        } else if branch.is_unloading {
            Self::Unloading
        } else if !(test.force[index] > 0.0) {
            Self::Unloaded
        } else {
            Self::Fitted
        }
    }
}

/// Readings of plate tests that no fit uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LeftOut {
    /// Shallower than [`PlateSettings::least_depth`].
    pub shallow: usize,
    /// Deeper, while the plate goes up or comes down again to where it has been.
    pub unloading: usize,
    /// Others, with a force of 0 or less, which has no logarithm.
    pub unloaded: usize,
}

impl LeftOut {
    fn from_tests(tests: &[PlateTest], least_depth: f64) -> Self {
        let of_test = |test: &PlateTest| {
            let branches = branches(&test.depth, &test.force, false);
            Use::of_test(test, &branches, least_depth)
        };
        tests.iter().flat_map(of_test).collect()
    }

    /// How many there are.
    #[must_use]
    pub const fn count(self) -> usize {
        self.shallow + self.unloading + self.unloaded
    }
}

impl FromIterator<Use> for LeftOut {
    fn from_iter<I: IntoIterator<Item = Use>>(uses: I) -> Self {
        let mut out = Self::default();
        for own in uses {
            match own {
                Use::Fitted => {}
                Use::Shallow => out.shallow += 1,
                Use::Unloading => out.unloading += 1,
                Use::Unloaded => out.unloaded += 1,
            }
        }
        out
    }
}

/// Why a fit finds too few readings in `tests`: counts, and the least number.
pub(crate) fn too_few(tests: &[PlateTest], settings: &PlateSettings) -> String {
    let readings = |tests: &[PlateTest]| tests.iter().map(|test| test.depth.len()).sum::<usize>();
    let used = |tests: &[PlateTest]| {
        readings(tests) - LeftOut::from_tests(tests, settings.least_depth).count()
    };
    let LeftOut {
        shallow,
        unloading,
        unloaded,
    } = LeftOut::from_tests(tests, settings.least_depth);
    let least_mm = 1e3 * settings.least_depth;
    let empty = tests
        .iter()
        .find(|test| used(std::slice::from_ref(test)) == 0);
    let empty = empty.map_or(String::new(), |test| {
        format!(", of test `{}` none", test.name)
    });
    format!(
        "{} of {} plate readings can be used{empty}; a fit needs {MIN_READINGS}, and one of each test. {shallow} are \
         shallower than {least_mm} mm (`least_depth_m`), {unloading} lie where the plate goes up or has been before (readings \
         are in the order of time), and {unloaded} others have a force of 0 or less: force is positive when the plate \
         is pressed in",
        used(tests),
        readings(tests),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plate::Plate;

    /// Depths in mm, forces in N.
    fn test(name: &str, readings: &[(f64, f64)]) -> PlateTest {
        PlateTest {
            name: name.to_owned(),
            plate: Plate::disc(0.1).unwrap(),
            depth: readings.iter().map(|(mm, _)| 1e-3 * mm).collect(),
            force: readings.iter().map(|(_, force)| *force).collect(),
        }
    }

    #[test]
    fn each_reading_is_left_out_for_one_reason() {
        // three above 2 mm, two at 0 N or less, twelve, up and down again to where it was, two
        let mut readings = vec![
            (0.0, 0.0),
            (1.0, -5.0),
            (1.999, 9.0),
            (4.0, 0.0),
            (6.0, -1.0),
        ];
        let loaded = |mm: u32| (f64::from(mm), 10.0 * f64::from(mm));
        readings.extend((8..=30).step_by(2).map(loaded));
        readings.extend([(27.0, 10.0), (24.0, 0.0), (25.0, 30.0), (29.0, 200.0)]);
        readings.extend([32, 34].map(loaded));
        let first = test("a", &readings);
        let second = test("b", &[(3.0, 0.0), (5.0, 0.0)]);
        let tests = [first, second];
        let left_out = LeftOut::from_tests(&tests, 2e-3);
        let wanted = LeftOut {
            shallow: 3,
            unloading: 4,
            unloaded: 4,
        };
        assert_eq!(left_out, wanted);
        assert_eq!(left_out.count(), 11);
        let mut settings = PlateSettings::default();
        let why = too_few(&tests, &settings);
        assert!(
            why.starts_with(
                "14 of 25 plate readings can be used, of test `b` none; a fit needs 10, and one of each test. 3 are \
                 shallower than 2 mm (`least_depth_m`), 4 lie where"
            ) && why.contains(", and 4 others have a force of 0 or less"),
            "{why}"
        );
        settings.least_depth = 7.5e-3;
        let alone = too_few(&tests[..1], &settings);
        assert!(
            alone.starts_with("14 of 23 plate readings can be used; a fit")
                && alone.contains("shallower than 7.5 mm"),
            "{alone}"
        );
    }
}
