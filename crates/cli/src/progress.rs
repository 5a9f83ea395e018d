//! How far a long job is, on standard error, and only where somebody looks at it.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A line that shows how far the job is; it disappears when the job ends. Nothing is shown when standard
/// error is not a terminal.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// Of a job of `total` bytes (unknown: a count without an end).
    pub(crate) fn of_bytes(total: Option<u64>) -> Self {
        let template = match total {
            Some(_) => {
                "{wide_bar} {percent:>3} %  {bytes}/{total_bytes}  {bytes_per_sec}  {eta} left"
            }
            None => "{spinner} {bytes}  {bytes_per_sec}  {elapsed}",
        };
        Self::new(total, template)
    }

    fn new(total: Option<u64>, template: &str) -> Self {
        let bar = ProgressBar::with_draw_target(total, ProgressDrawTarget::stderr_with_hz(5));
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// `done` of the whole is done.
    pub(crate) fn reach(&self, done: u64) {
        // Told for every message: the bar itself is asked only when something has changed.
        if done > self.0.position() {
            self.0.set_position(done);
        }
    }

    /// `amount` more is done.
    pub(crate) fn advance(&self, amount: u64) {
        self.0.inc(amount);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
