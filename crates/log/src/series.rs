//! One number of one topic over time.

use std::path::Path;

use grouser_files::nearest;

use crate::container::Container;
use crate::error::{Error, Result};
use crate::messages::{Clock, LeftOut, Messages};

/// One number of one topic over time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Series {
    /// The time of the first sample, ns.
    pub start_ns: i64,
    /// Times in s since then, and values in the message's own unit, in the order of time.
    pub samples: Vec<(f64, f64)>,
    /// What was left out.
    pub left_out: LeftOut,
}

/// The number at `field` in all messages of `topic` of an MCAP file or a bag, for instance
/// `wrench.wrench.force.z` or `ticks[0]`. The whole series is held in memory.
///
/// Times are the stamps of the messages' headers, or when they were recorded if they have none.
///
/// # Errors
/// [`Error::NoTopic`] for a topic that is not there, [`Error::NoField`] for a field that its messages
/// do not have or that is no number.
pub fn series(path: &Path, topic: &str, field: &str) -> Result<Series> {
    let named = topic.to_owned();
    let messages = Messages::open(path, Clock::Header, move |channel| channel.topic == named)?;
    let mut series = Series {
        start_ns: 0,
        samples: Vec::new(),
        left_out: LeftOut::default(),
    };
    let mut messages = messages;
    for message in messages.by_ref() {
        let Some(number) = message.value.number_at(field) else {
            return Err(Error::NoField {
                file: path.display().to_string(),
                topic: topic.to_owned(),
                field: field.to_owned(),
            });
        };
        if series.samples.is_empty() {
            series.start_ns = message.time_ns;
        }
        let since = message.time_ns.saturating_sub(series.start_ns);
        series.samples.push((since as f64 * 1e-9, number));
    }
    series.left_out = messages.left_out().clone();
    if series.samples.is_empty() && series.left_out.undecoded == 0 {
        return Err(no_topic(path, topic)?);
    }
    Ok(series)
}

/// That `topic` is not in the file, with the one that was probably meant.
pub(crate) fn no_topic(path: &Path, topic: &str) -> Result<Error> {
    let mut container = Container::open(path)?;
    while container.next().is_some() {}
    let topics = container.channels().iter().map(|c| c.topic.as_str());
    Ok(Error::NoTopic {
        file: path.display().to_string(),
        topic: topic.to_owned(),
        meant: nearest(topic, topics).map(Into::into),
    })
}
