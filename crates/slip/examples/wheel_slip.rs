//! A powered wheel digs in, a free one measures the way: slip with its sigma, once a second.
//! `cargo run -p grouser-slip --example wheel_slip`

use std::io::Write as _;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{Measurement, Robot, Sample, Wheel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wheel = |wheel: Wheel, x| wheel.at(x, 0.0).radius(0.1).ticks_per_turn(20_480);
    let wheels = vec![
        wheel(Wheel::powered("drive"), 0.3),
        wheel(Wheel::free("fifth"), -0.3),
    ];
    let robot = Robot::new("bicycle".into(), wheels)?;
    let mut filter = SlipFilter::new(&robot, FilterSettings::default())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "time s  true slip  slip ± sigma")?;
    let (mut rim, mut ground) = (0, 0);
    for step in 0..=1000_u64 {
        // both roll for two seconds; then the powered wheel loses more and more of its way, in per cent
        let lost = (step.saturating_sub(200) / 10).min(50);
        rim += 100;
        ground += 100 - lost;
        let time_ns = step.cast_signed() * 10_000_000;
        let turned = Measurement::YawRate { rate: 0.0 };
        let counted = |wheel, raw| Measurement::WheelCount { wheel, raw };
        for measurement in [counted(0, rim), counted(1, ground), turned] {
            filter.update(Sample {
                time_ns,
                measurement,
            })?;
        }
        let drive = filter.latest().wheels[0];
        if let (0, Some(found), Some(sigma)) = (step % 100, drive.slip, drive.sigma) {
            let (time, slip) = (step / 100, found.value());
            writeln!(out, "{time:6}  {lost:8} %  {slip:.3} ± {sigma:.3}")?;
        }
    }
    Ok(())
}
