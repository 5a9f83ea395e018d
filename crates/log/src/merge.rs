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
    /// What a place is beside the sample that was given last.
    beside: Option<Sample>,
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
    poses: Poses,
}

/// What the poses of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Poses {
    WithHeading,
    /// Places without a heading, which are followed.
    Places,
    /// Places beside another reference.
    UnusedPlaces,
}

/// Files of one run whose times are further apart than this are not on one clock, s.
const MAX_APART_S: f64 = 60.0;

impl Samples {
    /// `places` is the track by the places of a table without a heading, and their standard deviation, m; `angles` are those of
    /// the wheels.
    pub(crate) fn new(places: Option<(Track, f64)>, angles: Angles) -> Self {
        Self {
            files: Vec::new(),
            angles,
            places,
            beside: None,
            failed: false,
        }
    }

    /// Adds a file whose times are shifted by `shift_ns`.
    pub(crate) fn add(
        &mut self,
        samples: impl Iterator<Item = Result<Sample>> + Send + 'static,
        shift_ns: i64,
        (clock, file, poses): (usize, &Source, Poses),
    ) {
        self.files.push(Shifted {
            samples: Box::new(samples),
            shift_ns,
            next: None,
            clock,
            name: file.name(),
            last_ns: None,
            poses,
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
        if let Some(beside) = self.beside.take() {
            return Some(Ok(beside));
        }
        loop {
            let (mut sample, poses) = match self.earliest()? {
                Ok(earliest) => earliest,
                Err(error) => return Some(Err(error)),
            };
            match (sample.measurement, &mut self.places) {
                (Measurement::YawRate { rate }, Some((track, _))) => {
                    track.turn(sample.time_ns, rate);
                }
                // the yaw of a fix is its standard deviation
                (Measurement::Pose { x, y, yaw }, Some((track, sigma)))
                    if poses == Poses::Places =>
                {
                    let sigma = if yaw > 0.0 { yaw } else { *sigma };
                    let measurements = track.take(sample.time_ns, [x, y], sigma);
                    let mut all = measurements.into_iter().flatten();
                    match all.next() {
                        Some(first) => sample.measurement = first,
                        None => continue,
                    }
                    self.beside = all.next().map(|measurement| Sample {
                        measurement,
                        ..sample
                    });
                }
                (Measurement::Pose { .. }, _) if poses == Poses::UnusedPlaces => continue,
                _ => {}
            }
            self.angles.unwrap(&mut sample);
            return Some(Ok(sample));
        }
    }
}

impl Samples {
    /// The earliest sample of all files, and what the poses of its file are.
    fn earliest(&mut self) -> Option<Result<(Sample, Poses)>> {
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
        let poses = earliest.poses;
        let is_first = earliest.last_ns.replace(sample.time_ns).is_none();
        let (clock, name) = (earliest.clock, earliest.name.clone());
        if is_first && let Some(error) = self.apart(clock, name, sample.time_ns) {
            self.failed = true;
            return Some(Err(error));
        }
        Some(Ok((sample, poses)))
    }
}
