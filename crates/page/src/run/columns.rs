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
    /// Of a simulated wheel.
    pub(crate) truth: Vec<WheelTruth>,
    pub(crate) motion: Spans,
    pub(crate) health: Spans,
}

/// Where a simulated wheel is, and what the ground does to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelTruth {
    /// m.
    pub(crate) place: [f64; 2],
    /// deg.
    pub(crate) heading: f64,
    /// Along its heading, to the left, its load, N.
    pub(crate) forces: [f64; 3],
}

impl WheelColumns {
    pub(crate) fn object(&self, name: &str) -> Value {
        let mut object = json!({
            "name": name,
            "slip": self.slip,
            "slip_sigma": self.sigma,
            "true_slip": self.true_slip,
            "torque_nm": self.torque,
            "sinkage_m": self.sinkage,
            "motion": self.motion.object(),
            "health": self.health.object(),
        });
        if !self.truth.is_empty() {
            let column =
                |of: &dyn Fn(&WheelTruth) -> f64| self.truth.iter().map(of).collect::<Vec<f64>>();
            for (key, values) in [
                ("wheel_x_m", column(&|truth| truth.place[0])),
                ("wheel_y_m", column(&|truth| truth.place[1])),
                ("wheel_heading_deg", column(&|truth| truth.heading)),
                ("drawbar_pull_n", column(&|truth| truth.forces[0])),
                ("side_force_n", column(&|truth| truth.forces[1])),
                ("load_n", column(&|truth| truth.forces[2])),
            ] {
                object[key] = json!(values);
            }
        }
        object
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
