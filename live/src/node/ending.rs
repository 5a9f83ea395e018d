//! The end of a node: state, recording and transport, each whatever became of the others.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;

use grouser_replay::Status;

use super::{Node, Outcome};
use crate::arguments::Arguments;
use crate::error::{Error, Result};
use crate::print::{SCREEN_IS_OPEN, complain, say, summary_line, warn};
use crate::recorder::Recorder;
use crate::state_file;

impl Node {
    /// Ends state, recording and transport, each whatever became of the others. The first fault of the run is the
    /// result; later ones are printed.
    pub(super) fn end(
        mut self,
        turned: Result<()>,
        (arguments, robot): (&Arguments, &grouser_slip::Robot),
    ) -> Result<Outcome> {
        // the terminal is given back before anything is printed
        let closed = guarded(|| {
            self.screen = None;
            Ok(())
        });
        SCREEN_IS_OPEN.store(false, Ordering::Relaxed);
        let kept = guarded(|| match &arguments.state {
            Some(path) => state_file::write(path, robot, &self.engine.learnt()),
            None => Ok(()),
        });
        let latency = self.latency.microseconds();
        let mut faults: Vec<Error> = [turned, closed, kept]
            .into_iter()
            .filter_map(Result::err)
            .collect();
        // after a fault the estimate is not worth a last message
        let summary = if faults.is_empty() {
            let engine = self.engine;
            Some(guarded(|| Ok(engine.finish(&mut self.outputs)?)))
        } else {
            None
        };
        let recorder = self.outputs.recorder.take();
        let written = guarded(|| recorder.map(Recorder::finish).transpose());
        let unencoded = self.outputs.unencoded();
        let dropped = unencoded.1.map(|reason| {
            let count = unencoded.0;
            format!("{count} messages were not published: they cannot be encoded: {reason}")
        });
        let transport = self.outputs.transport;
        let left = guarded(|| {
            transport.close();
            Ok(())
        });
        faults.extend(left.err());
        let written = written.map_err(|error| faults.push(error)).ok().flatten();
        let summary = summary.and_then(|summary| summary.map_err(|error| faults.push(error)).ok());
        if let (Some(path), false) = (&written, arguments.quiet) {
            say(&format!("wrote {}", path.display()));
        }
        let mut faults = faults.into_iter();
        let first = faults.next();
        for later in faults {
            complain(&later.to_string());
        }
        let summary = match (first, summary) {
            (Some(first), _) => return Err(first),
            (None, None) => return Ok(Outcome::NoSlip),
            (None, Some(summary)) => summary,
        };
        if !arguments.quiet {
            say(&summary_line(&summary, self.messages, self.outputs.steps));
            if let Some([median, high, longest]) = latency {
                say(&format!(
                    "from a message to its slip: median {median:.0} µs, 99.9 % {high:.0} µs, longest {longest:.0} µs"
                ));
            }
        }
        let doubts = summary.doubts().into_iter().map(|doubt| doubt.to_string());
        let doubts: Vec<String> = doubts.chain(dropped).collect();
        for doubt in &doubts {
            warn(doubt);
        }
        Ok(match summary.status {
            _ if !doubts.is_empty() => Outcome::Doubtful,
            Status::Done => Outcome::Done,
            _ => Outcome::NoSlip,
        })
    }
}

/// Does `act`; a panic in it is an error.
pub(super) fn guarded<T>(act: impl FnOnce() -> Result<T>) -> Result<T> {
    // what it was about to change is only stopped, saved if it is whole, and closed
    catch_unwind(AssertUnwindSafe(act)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(Error::Panic {
            what: text.unwrap_or_else(|| "no reason is known".to_owned()),
        })
    })
}
