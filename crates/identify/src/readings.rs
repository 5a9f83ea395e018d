//! The readings of a job's tests, each reading once.

use std::collections::BTreeSet;

use crate::error::Result;
use crate::job::{Job, PlateSource, WheelJob};
use crate::plate::{self, PlateRecord, PlateTest, read_bag};
use crate::shear::{self, ShearReading};
use crate::wheel::{self, Quantity, Support, WheelTest};

/// The readings of a job's tests without copies.
///
/// A row that repeats another one in every number that is read is a copy of it, and no second measurement: noise does not
/// repeat itself to the last digit. A plate test all of whose readings are those of another test is a copy as well.
#[derive(Clone, Debug)]
pub(crate) struct Readings {
    pub plates: Vec<PlateTest>,
    pub records: Vec<PlateRecord>,
    pub shear: Option<Vec<ShearReading>>,
    pub wheel: Option<(WheelJob, Vec<WheelTest>)>,
    pub copies: Copies,
    /// Is a rough result wanted, without intervals of the wheel's numbers?
    pub is_rough: bool,
}

/// How many rows repeat others, by the kind of test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Copies {
    /// Rows of plate tests at the least depth or below it.
    pub plates: usize,
    pub shear: usize,
    pub wheel: usize,
}

impl Readings {
    /// # Errors
    /// As the readers of tables and bags.
    pub(crate) fn read(job: &Job) -> Result<Self> {
        let (mut plates, mut records) = (Vec::new(), Vec::new());
        for source in &job.plates {
            match source {
                PlateSource::Table(path) => plates.extend(plate::read_table(path)?),
                PlateSource::Bag(test) => {
                    let record = read_bag(&test.name, test.plate, &test.source, &test.depth)?;
                    plates.push(record.test.clone());
                    records.push(record);
                }
            }
        }
        let mut shear = job.shear.as_deref().map(shear::read_table).transpose()?;
        let mut wheel = match &job.wheel {
            Some(wheel) => Some((wheel.clone(), wheel::read_table(&wheel.table)?)),
            None => None,
        };
        let copies = Copies {
            plates: drop_copies_of_plates(&mut plates, job.plate_settings.least_depth),
            shear: shear.as_mut().map_or(0, |readings| {
                drop_copies(readings, |r| [r.normal, r.displacement, r.shear])
            }),
            wheel: (wheel.as_mut()).map_or(0, |(_, tests)| drop_copies(tests, numbers_of)),
        };
        Ok(Self {
            plates,
            records,
            shear,
            wheel,
            copies,
            is_rough: false,
        })
    }
}

/// Drops what has the numbers of an earlier one, and counts what is dropped.
fn drop_copies<T, const N: usize>(list: &mut Vec<T>, numbers: impl Fn(&T) -> [f64; N]) -> usize {
    let before = list.len();
    let mut seen = BTreeSet::new();
    list.retain(|one| seen.insert(numbers(one).map(f64::to_bits)));
    before - list.len()
}

/// The same of the readings of each test, and of whole tests; counts those at `least_depth` (m) or below it.
fn drop_copies_of_plates(tests: &mut Vec<PlateTest>, least_depth: f64) -> usize {
    let used = |test: &PlateTest| {
        let depths = test.depth.iter();
        depths.filter(|depth| **depth >= least_depth).count()
    };
    let before: usize = tests.iter().map(used).sum();
    for test in tests.iter_mut() {
        let pairs = test.depth.iter().copied().zip(test.force.iter().copied());
        let mut pairs: Vec<(f64, f64)> = pairs.collect();
        drop_copies(&mut pairs, |(depth, force)| [*depth, *force]);
        (test.depth, test.force) = pairs.into_iter().unzip();
    }
    let mut seen = BTreeSet::new();
    tests.retain(|test| {
        let size = [test.plate.area, test.plate.width];
        let numbers = size.iter().chain(&test.depth).chain(&test.force);
        seen.insert(numbers.map(|x| x.to_bits()).collect::<Vec<u64>>())
    });
    before - tests.iter().map(used).sum::<usize>()
}

fn numbers_of(test: &WheelTest) -> [f64; 8] {
    let motion = &test.kinematics;
    let (held, support) = match test.support {
        Support::Load(load) => (0.0, load),
        Support::Sinkage(sinkage) => (1.0, sinkage),
    };
    let [pull, side, torque, sinkage] =
        Quantity::ALL.map(|quantity| test.read(quantity).unwrap_or(f64::NAN));
    let slip = motion.slip().value();
    [
        slip,
        motion.q_y(),
        held,
        support,
        pull,
        side,
        torque,
        sinkage,
    ]
}
