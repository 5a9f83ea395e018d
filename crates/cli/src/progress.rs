//! How far a long job is, on standard error, and only where somebody looks at it.

use std::time::Duration;

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

    /// Of a job of `total` items, such as strips.
    pub(crate) fn of_items(total: u64, items: &str) -> Self {
        let template =
            format!("{{wide_bar}} {{percent:>3}} %  {{pos}}/{{len}} {items}  {{eta}} left");
        Self::new(Some(total), &template)
    }

    /// Of `jobs` simulated drives that last `seconds` together: how much of them is driven, and how fast.
    pub(crate) fn of_drives(seconds: f64, jobs: usize) -> Self {
        let drives = if jobs == 1 { "drive" } else { "drives" };
        let template =
            format!("{{wide_bar}} {{percent:>3}} % of {jobs} {drives}  {{msg}}  {{eta}} left");
        Self::new(Some(whole(1e3 * seconds)), &template)
    }

    /// A job of unknown length: what it does, and for how long.
    pub(crate) fn of_work(what: &str) -> Self {
        let work = Self::new(None, &format!("{{spinner}} {what}  {{elapsed}}"));
        work.0.enable_steady_tick(Duration::from_millis(200));
        work
    }

    /// `seconds` more of a drive are done; the robot goes at `speed` (m/s) with this slip.
    pub(crate) fn drove(&self, seconds: f64, speed: f64, slip: Option<f64>) {
        if let Some(slip) = slip {
            self.0
                .set_message(format!("{speed:.2} m/s, slip {slip:.2}"));
        }
        self.0.inc(whole(1e3 * seconds));
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
        // Called for every message: the bar is updated only when the position has changed.
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

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a count of milliseconds for a bar; the cast saturates"
)]
fn whole(value: f64) -> u64 {
    value as u64
}
