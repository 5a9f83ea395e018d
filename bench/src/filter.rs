//! The slip filter in a control loop: one cycle is six wheels' counters, gyro and accelerometer, every cycle timed by itself.

use std::hint::black_box;
use std::time::Instant;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{CounterWidth, Encoder, Measurement, Robot, Sample, Wheel};

const CYCLES: usize = 50_000;
const RUNS: usize = 5;

fn robot() -> Robot {
    let width = CounterWidth::new(32).expect("a width");
    let encoder = Encoder::counting(2000).counter(width);
    let wheel = |wheel: Wheel, x: f64, y: f64| wheel.at(x, y).radius(0.1).encoder(encoder);
    let wheels = vec![
        wheel(Wheel::powered("front left"), 0.3, 0.25),
        wheel(Wheel::powered("front right"), 0.3, -0.25),
        wheel(Wheel::powered("middle left"), 0.0, 0.25),
        wheel(Wheel::powered("middle right"), 0.0, -0.25),
        wheel(Wheel::powered("rear left"), -0.3, 0.25),
        wheel(Wheel::free("fifth"), -0.45, 0.0),
    ];
    Robot::new("six wheels".into(), wheels).expect("a robot")
}

/// The samples of one cycle.
fn cycle(row: u64, samples: &mut [Sample; 8]) {
    let time_ns = i64::try_from(row).expect("small") * 10_000_000;
    for (wheel, sample) in samples[..6].iter_mut().enumerate() {
        let raw = if wheel == 5 {
            9 * row
        } else {
            10 * row + row % 3
        };
        sample.measurement = Measurement::WheelCount { wheel, raw };
    }
    let sway = (row as f64 * 0.01).sin();
    samples[6].measurement = Measurement::YawRate { rate: 0.05 * sway };
    samples[7].measurement = Measurement::Acceleration {
        forward: 0.1 * sway,
        left: 0.02,
    };
    for sample in samples {
        sample.time_ns = time_ns;
    }
}

/// Median, 99.9 % and greatest of the cycles' times, ns.
fn timed() -> [f64; 3] {
    let mut filter = SlipFilter::new(&robot(), FilterSettings::default()).expect("a filter");
    let mut samples = [Sample {
        time_ns: 0,
        measurement: Measurement::YawRate { rate: 0.0 },
    }; 8];
    let mut times = Vec::with_capacity(CYCLES);
    for row in 0..CYCLES as u64 {
        cycle(row, &mut samples);
        let start = Instant::now();
        for sample in &samples {
            let _ = black_box(filter.update(black_box(*sample)));
        }
        times.push(start.elapsed().as_secs_f64() * 1e9);
    }
    times.sort_by(f64::total_cmp);
    [0.5, 0.999, 1.0].map(|q| times[((times.len() - 1) as f64 * q) as usize])
}

pub fn run() {
    println!("one cycle: six wheels, gyro, accelerometer; ns      p50     p99.9       max");
    let mut best = [f64::MAX; 3];
    for _ in 0..RUNS {
        let [p50, p999, most] = timed();
        println!("{p50:>55.0}{p999:>10.0}{most:>10.0}");
        best = [best[0].min(p50), best[1].min(p999), best[2].min(most)];
    }
    println!(
        "best of {RUNS}{:>46.0}{:>10.0}{:>10.0}",
        best[0], best[1], best[2]
    );
}
