//! The columns of a run: what the page plays, whether it was simulated or recorded.

use serde_json::{Value, json};

/// One wheel's columns; `None` where there is no number.
#[derive(Debug, Default)]
pub(crate) struct WheelColumns {
    pub(crate) slip: Vec<Option<f64>>,
    pub(crate) sigma: Vec<Option<f64>>,
    pub(crate) true_slip: Vec<Option<f64>>,
    pub(crate) torque: Vec<Option<f64>>,
    pub(crate) sinkage: Vec<Option<f64>>,
    pub(crate) motion: Spans,
    pub(crate) health: Spans,
}

impl WheelColumns {
    pub(crate) fn object(&self, name: &str) -> Value {
        json!({
            "name": name,
            "slip": self.slip,
            "slip_sigma": self.sigma,
            "true_slip": self.true_slip,
            "torque_nm": self.torque,
            "sinkage_m": self.sinkage,
            "motion": self.motion.object(),
            "health": self.health.object(),
        })
    }
}

/// A name over time, as the times from which it holds.
#[derive(Debug, Default)]
pub(crate) struct Spans(Vec<(f64, String)>);

impl Spans {
    pub(crate) fn add(&mut self, time_s: f64, name: &str) {
        if self.0.last().is_none_or(|(_, last)| last != name) {
            self.0.push((time_s, name.to_owned()));
        }
    }

    pub(crate) fn object(&self) -> Value {
        self.0
            .iter()
            .map(|(time, name)| json!([time, name]))
            .collect()
    }
}
