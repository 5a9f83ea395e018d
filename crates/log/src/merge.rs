//! The samples of several files as one stream.

use grouser_slip::Sample;

use crate::error::Result;

/// The samples of a log in the order of time. The first error ends it.
pub struct Samples {
    files: Vec<Shifted>,
    failed: bool,
}

struct Shifted {
    samples: Box<dyn Iterator<Item = Result<Sample>> + Send>,
    shift_ns: i64,
    next: Option<Sample>,
}

impl Samples {
    pub(crate) const fn new() -> Self {
        Self {
            files: Vec::new(),
            failed: false,
        }
    }

    /// Adds a file whose times are shifted by `shift_ns`.
    pub(crate) fn add(
        &mut self,
        samples: impl Iterator<Item = Result<Sample>> + Send + 'static,
        shift_ns: i64,
    ) {
        self.files.push(Shifted {
            samples: Box::new(samples),
            shift_ns,
            next: None,
        });
    }
}

impl Iterator for Samples {
    type Item = Result<Sample>;

    fn next(&mut self) -> Option<Self::Item> {
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
        earliest.next.take().map(Ok)
    }
}
