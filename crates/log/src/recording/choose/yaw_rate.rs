//! Which topic measures the yaw rate, and about which direction.

use grouser_files::columns::Meaning;

use super::names::words;
use super::{Choosing, Job, Seen};
use crate::error::Result;
use crate::message::{Imu, Trust, View};
use crate::recording::mounting::{agree, up_by_transforms};

impl Choosing<'_> {
    pub(super) fn yaw_rate(&mut self) -> Result<()> {
        let seen = if let Some(name) = &self.topics.yaw_rate {
            let seen = self.named("yaw_rate", name)?;
            if !matches!(seen.view, Some(View::Imu(_))) {
                return Err(self.unfit("yaw_rate", seen, "sensor_msgs/Imu"));
            }
            Some(seen)
        } else if self.measures(Meaning::YawRate) {
            None
        } else {
            // Filtered data before raw, the first of these.
            let imus = self.free().filter(|seen| match &seen.view {
                Some(View::Imu(imu)) => imu.angular_rate.is_some(),
                _ => false,
            });
            imus.min_by_key(|seen| words(&seen.channel.topic).any(|word| word == "raw"))
        };
        let Some((seen, Some(View::Imu(imu)))) = seen.map(|seen| (seen, &seen.view)) else {
            return Ok(());
        };
        let (up, by) = self.up(seen, imu);
        let usable = imu
            .angular_rate_trust
            .iter()
            .zip(up)
            .all(|(trust, u)| u.abs() < 0.1 || *trust != Trust::DoNotUse);
        if imu.angular_rate.is_none() || !usable {
            let what = format!(
                "`{}` says by its covariance that its rate about the vertical is not to be used",
                seen.channel.topic
            );
            self.choice.notes.push(what);
            return Ok(());
        }
        let word = format!("yaw rate about its {} ({by})", direction(up));
        let align = self.topics.align_clock;
        let chosen = self.take(seen, Job::YawRate(up), word, [(Meaning::YawRate, None)]);
        chosen.align = align;
        Ok(())
    }

    /// Which way is up for an IMU, and what tells it.
    fn up(&mut self, seen: &Seen, imu: &Imu) -> ([f64; 3], &'static str) {
        let topic = &seen.channel.topic;
        if let Some(up) = self.topics.imu_up {
            return (up, "by the robot file");
        }
        let by_transforms = up_by_transforms(&self.peek.transforms, &imu.frame);
        match (by_transforms, seen.accelerations.up()) {
            (Some(up), None) => (up, "by its transforms"),
            (Some(up), Some(gravity)) if agree(up, gravity) => (up, "by its transforms"),
            (Some(up), Some(gravity)) => {
                self.choice.notes.push(format!(
                    "the transforms of `{topic}` say that {} points up, but gravity says {}: gravity is \
                     believed (`imu_up` in the robot file decides)",
                    direction(up),
                    direction(gravity)
                ));
                (gravity, "by gravity")
            }
            (None, Some(gravity)) => (gravity, "by gravity"),
            (None, None) => {
                self.choice.notes.push(format!(
                    "neither transforms nor gravity tell how the IMU of `{topic}` is mounted: its z axis \
                     is taken to point up (`imu_up` in the robot file decides)"
                ));
                ([0.0, 0.0, 1.0], "taken to point up")
            }
        }
    }
}

/// A direction in words: an axis, or its three parts.
fn direction(up: [f64; 3]) -> String {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if up[axis].abs() > 0.9999 {
            let sign = if up[axis] < 0.0 { "-" } else { "" };
            return format!("{sign}{name} axis");
        }
    }
    format!("direction ({:.3}, {:.3}, {:.3})", up[0], up[1], up[2])
}
