//! The samples of several files as one stream.

use grouser_slip::{Measurement, Sample};

use crate::error::{Error, Result};
use crate::recording::navigation::Track;
use crate::source::Source;
use crate::wrapped_angles::Angles;

/// The samples of a log in the order of time. The first error ends it.
pub struct Samples {
    files: Vec<Shifted>,
    angles: Angles,
    /// The track by the places of a table, and their standard deviation, m.
    places: Option<(Track, f64)>,
    failed: bool,
}

struct Shifted {
    samples: Box<dyn Iterator<Item = Result<Sample>> + Send>,
    shift_ns: i64,
    next: Option<Sample>,
    /// Files of one clock.
    clock: usize,
    name: String,
    last_ns: Option<i64>,
    /// Its poses are places without a heading; are they used?
    places: Option<bool>,
}

/// Files of one run whose times are further apart than this are not on one clock, s.
const MAX_APART_S: f64 = 60.0;

impl Samples {
    /// `places` is the track by the places of a table without a heading, and their standard deviation, m.
    pub(crate) fn new(places: Option<(Track, f64)>) -> Self {
        Self {
            files: Vec::new(),
            angles: Angles::default(),
            places,
            failed: false,
        }
    }

    /// Adds a file whose times are shifted by `shift_ns`. `places`: its poses are places without a heading; are they used?
    pub(crate) fn add(
        &mut self,
        samples: impl Iterator<Item = Result<Sample>> + Send + 'static,
        shift_ns: i64,
        (clock, file, places): (usize, &Source, Option<bool>),
    ) {
        self.files.push(Shifted {
            samples: Box::new(samples),
            shift_ns,
            next: None,
            clock,
            name: file.name(),
            last_ns: None,
            places,
        });
    }
}

impl Samples {
    /// A file begins at `time_ns`: an error where every file on another clock was over long before.
    fn apart(&self, clock: usize, name: String, time_ns: i64) -> Option<Error> {
        let others = || self.files.iter().filter(|file| file.clock != clock);
        if others().any(|file| file.next.is_some())
            || self
                .files
                .iter()
                .any(|file| file.clock == clock && file.name != name && file.last_ns.is_some())
        {
            return None;
        }
        let last = others().max_by_key(|file| file.last_ns)?;
        let by_s = time_ns.saturating_sub(last.last_ns?) as f64 * 1e-9;
        (by_s > MAX_APART_S).then(|| Error::Apart {
            first: last.name.clone(),
            second: name,
            by_s,
        })
    }
}

impl Iterator for Samples {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let (mut sample, places) = match self.earliest()? {
                Ok(earliest) => earliest,
                Err(error) => return Some(Err(error)),
            };
            if let (Some((track, sigma)), time_ns) = (&mut self.places, sample.time_ns) {
                match sample.measurement {
                    Measurement::YawRate { rate } => track.turn(time_ns, rate),
                    Measurement::Pose { x, y, .. } if places == Some(true) => {
                        match track.moved(time_ns, [x, y], *sigma) {
                            Some(moved) => sample.measurement = moved,
                            None => continue,
                        }
                    }
                    _ => {}
                }
            }
            if places == Some(false) && matches!(sample.measurement, Measurement::Pose { .. }) {
                continue;
            }
            self.angles.unwrap(&mut sample);
            return Some(Ok(sample));
        }
    }
}

impl Samples {
    /// The earliest sample of all files, and what the poses of its file are.
    fn earliest(&mut self) -> Option<Result<(Sample, Option<bool>)>> {
        if self.failed {
            return None;
        }
        for file in &mut self.files {
            if file.next.is_none() {
                match file.samples.next() {
                    Some(Ok(mut sample)) => {
                        sample.time_ns = sample.time_ns.saturating_add(file.shift_ns);
                        file.next = Some(sample);
                    }
                    Some(Err(error)) => {
                        self.failed = true;
                        return Some(Err(error));
                    }
                    None => {}
                }
            }
        }
        let waiting = self.files.iter_mut().filter(|file| file.next.is_some());
        let earliest = waiting.min_by_key(|file| file.next.as_ref().map(|next| next.time_ns))?;
        let sample = earliest.next.take()?;
        let places = earliest.places;
        let is_first = earliest.last_ns.replace(sample.time_ns).is_none();
        let (clock, name) = (earliest.clock, earliest.name.clone());
        if is_first && let Some(error) = self.apart(clock, name, sample.time_ns) {
            self.failed = true;
            return Some(Err(error));
        }
        Some(Ok((sample, places)))
    }
}
