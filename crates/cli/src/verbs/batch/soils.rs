//! The soils of a table, each read once.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::sync::{Arc, Mutex, PoisonError};

use grouser_terra::{BatchInput, BatchKernel, Soil, SoilColumns};

use super::columns::{Row, SOIL_NUMBERS};
use crate::session::Session;
use crate::soil_choice::{self, Overrides};

/// Soils kept at a time: a table may name any number of files.
const SOILS: usize = 256;
/// Names that are compared with a row's before the map is searched: few comparisons take less time than the map.
const FIRST_NAMES: usize = 8;

/// A soil, ready for batches.
pub(super) struct Known {
    pub(super) soil: Soil,
    pub(super) kernel: BatchKernel,
    /// The soil's [`SOIL_NUMBERS`], for rows without their own.
    pub(super) numbers: [f64; SOIL_NUMBERS.len()],
}

impl Known {
    fn new(soil: &Soil) -> Self {
        let mut columns = SoilColumns::from_soil(soil);
        Self {
            soil: *soil,
            kernel: BatchKernel::new(*soil),
            numbers: SOIL_NUMBERS.map(|number| match number.column(&mut columns) {
                Some(BatchInput::Constant(number)) => *number,
                _ => f64::NAN,
            }),
        }
    }
}

/// The soils that all threads have met.
pub(super) struct Met<'a> {
    overrides: &'a Overrides,
    state: Mutex<State<'a>>,
}

struct State<'a> {
    soils: BTreeMap<String, Arc<Known>>,
    /// Names and sources for the report.
    sources: BTreeMap<String, String>,
    session: &'a mut Session,
}

impl<'a> Met<'a> {
    pub(super) fn new(overrides: &'a Overrides, session: &'a mut Session) -> Self {
        Self {
            overrides,
            state: Mutex::new(State {
                soils: BTreeMap::new(),
                sources: BTreeMap::new(),
                session,
            }),
        }
    }

    /// The sources of the soils by their names.
    pub(super) fn into_sources(self) -> (BTreeMap<String, String>, &'a mut Session) {
        let state = self.state.into_inner();
        let State {
            sources, session, ..
        } = state.unwrap_or_else(PoisonError::into_inner);
        (sources, session)
    }

    /// The soil of a name; `None` if it cannot be read.
    fn soil(&self, name: &str) -> Option<Arc<Known>> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = state.soils.get(name) {
            return Some(Arc::clone(known));
        }
        let chosen = soil_choice::choose(OsStr::new(name), self.overrides).ok()?;
        if state.soils.len() >= SOILS {
            state.soils.pop_first();
        }
        if let Some(document) = &chosen.document {
            state.session.used_document(document);
        }
        if state.sources.len() < SOILS {
            state.sources.insert(name.to_owned(), chosen.source);
        }
        let known = Arc::new(Known::new(&chosen.soil));
        state.soils.insert(name.to_owned(), Arc::clone(&known));
        Some(known)
    }
}

/// The soils of some rows. One that cannot be read is left out: the status of its rows gives the reason.
#[derive(Default)]
pub(super) struct Soils<'a> {
    /// The first names, by their numbers.
    first: Vec<&'a str>,
    numbers: BTreeMap<&'a str, usize>,
    known: Vec<Option<Arc<Known>>>,
    /// How many of them could be read.
    count: usize,
    /// The number of each row's soil.
    of_rows: Vec<Option<usize>>,
}

impl<'a> Soils<'a> {
    pub(super) fn new(rows: &'a [Row<'_>], met: &Met<'_>) -> Self {
        let mut soils = Self::default();
        soils.of_rows.reserve(rows.len());
        for row in rows {
            let point = row.point.as_ref().ok();
            let number = point.map(|point| soils.number(&point.soil, met));
            soils.of_rows.push(number);
        }
        soils
    }

    /// The number of a name.
    fn number(&mut self, name: &'a str, met: &Met<'_>) -> usize {
        if let Some(number) = self.first.iter().position(|first| *first == name) {
            return number;
        }
        let next = self.known.len();
        let number = *self.numbers.entry(name).or_insert(next);
        if number == next {
            let known = (self.count < SOILS).then(|| met.soil(name)).flatten();
            self.count += usize::from(known.is_some());
            if number < FIRST_NAMES {
                self.first.push(name);
            }
            self.known.push(known);
        }
        number
    }

    pub(super) fn len(&self) -> usize {
        self.known.len()
    }

    pub(super) fn at(&self, number: usize) -> Option<&Known> {
        self.known[number].as_deref()
    }

    /// The soil of the row at a place, with its number.
    pub(super) fn of_row(&self, place: usize) -> Option<(usize, &Known)> {
        let number = self.of_rows[place]?;
        Some((number, self.at(number)?))
    }
}
