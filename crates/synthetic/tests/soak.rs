//! Random faults over many runs: never Ok and more than four sigma off for over a second. `GROUSER_SOAK_RUNS` says how many
//! (100 by default; `just soak` takes 10 000).

use grouser_slip::Health;
use grouser_synthetic::{Camera, Event, Fault, Leg, Noise};

use crate::trial::{FREE, Trial};

/// One of `count` kinds at random.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small whole number"
)]
fn choose(noise: &mut Noise, count: usize) -> usize {
    ((noise.uniform() * count as f64) as usize).min(count - 1)
}

fn of<T: Copy>(noise: &mut Noise, values: &[T]) -> T {
    values[choose(noise, values.len())]
}

fn fault(noise: &mut Noise) -> Fault {
    let wheel = choose(noise, FREE + 1);
    let powered = choose(noise, FREE);
    match choose(noise, 29) {
        0 => Fault::WheelSilent(wheel),
        1 => Fault::WheelStuck(wheel),
        2 => Fault::PulsesLost(powered, of(noise, &[0.01, 0.05, 0.2])),
        3 => Fault::SlotBroken(wheel, of(noise, &[96, 480])),
        4 => Fault::Swapped(wheel),
        5 => Fault::CounterReset(wheel),
        6 => Fault::CounterJumps(wheel, of(noise, &[-5000, 3, 5000])),
        7 => Fault::Repeated(choose(noise, 2) == 1),
        8 => Fault::ClockOnce(of(noise, &[-1_000, -1_000_000_000, 10_000_000_000])),
        9 => Fault::Shuffled(10_000_000),
        10 => Fault::Burst,
        11 => Fault::RowsLost(of(noise, &[2, 5, 10])),
        12 => Fault::AllSilent,
        13 => Fault::ImuSilent,
        14 => Fault::ImuStuck,
        15 => Fault::AccelerometerSaturated(156.9),
        16 => Fault::AccelerometerBias(of(noise, &[-0.5, 0.5])),
        17 => Fault::GyroBias(of(noise, &[-0.05, 0.05])),
        18 => Fault::GyroScale(of(noise, &[-1.0, 57.3, 0.1])),
        19 => Fault::ImuValue(of(noise, &[f64::NAN, f64::INFINITY, 0.0, 1e30])),
        20 => Fault::ImuGarbage(of(noise, &[0.1, 2.0])),
        21 => Fault::CameraLost,
        22 => Fault::CameraJumps(of(noise, &[-2.0, 2.0])),
        23 => Fault::CameraScale(of(noise, &[0.5, 2.0, 0.001])),
        24 => Fault::CameraFrozen,
        25 => Fault::CameraValue(of(noise, &[f64::NAN, f64::MAX, 0.0])),
        26 => Fault::TorqueOffset(3.0),
        27 => Fault::TorqueZero,
        _ => Fault::TorqueNoise(3.0),
    }
}

fn event(noise: &mut Noise) -> Event {
    match choose(noise, 4) {
        0 => Event::LiftOff {
            wheel: choose(noise, FREE),
        },
        1 => Event::Immobilised,
        2 => Event::FreeWheelLocked,
        _ => Event::Backlash { play: 0.02 },
    }
}

/// A run of 30 s with one or two faults, and sometimes an event.
pub(crate) fn random(seed: u64) -> Trial {
    let mut noise = Noise::new(seed ^ 0x0050_a4c0_ffee);
    let mut trial = Trial::new(seed);
    trial.robot.legs.push(Leg {
        seconds: 4.0,
        speed: 0.0,
        yaw_rate: 0.0,
        brakes: false,
    });
    let start = 1.0 + 4.0 * noise.uniform();
    trial.robot.patch = (start, start + 1.8);
    trial.robot.drive_slip = (0.02 + 0.1 * noise.uniform(), 0.2 + 0.3 * noise.uniform());
    if choose(&mut noise, 3) == 0 {
        trial.sensors.camera = Some(Camera {
            every: of(&mut noise, &[3, 5, 10]),
            sigma: 0.001,
            late: 0,
        });
    }
    let span = |noise: &mut Noise| {
        let from = 0.3 + 24.0 * noise.uniform();
        (from, from + of(noise, &[0.1, 0.5, 2.0, 5.0]))
    };
    if choose(&mut noise, 5) == 0 {
        let span = span(&mut noise);
        trial.events.push((event(&mut noise), span));
    }
    for _ in 0..=choose(&mut noise, 2) {
        let span = span(&mut noise);
        trial.faults.push((fault(&mut noise), span));
    }
    trial
}

#[test]
fn no_run_is_ok_and_wrong_for_a_second() {
    let number = |name: &str, otherwise: u64| {
        std::env::var(name).map_or(otherwise, |text| text.parse().unwrap())
    };
    let (runs, first) = (
        number("GROUSER_SOAK_RUNS", 100),
        number("GROUSER_SOAK_FIRST", 0),
    );
    let (mut wrong, mut late, mut worst) = (0, 0, 0.0_f64);
    let mut samples = 0;
    let (mut ok, mut slips) = (0_u64, 0_u64);
    // FNV-1a over the bits of every slip: the same on every repetition
    let mut bits = 0xcbf2_9ce4_8422_2325_u64;
    for seed in first..first + runs {
        let trial = random(seed);
        let (course, arrived) = trial.samples();
        samples += arrived.len();
        let out = trial.follow(&course, &arrived);
        for slip in out
            .moments
            .iter()
            .flat_map(|moment| moment.wheels.map(|w| w.slip))
        {
            let value = slip.map_or(u64::MAX, |slip| slip.value().to_bits());
            bits = (bits ^ value).wrapping_mul(0x0100_0000_01b3);
        }
        for moment in out.moments.iter().filter(|m| m.speed.abs() > 0.05) {
            let powered = &moment.wheels[..FREE];
            slips += powered.len() as u64;
            ok += powered.iter().filter(|w| w.health == Health::Ok).count() as u64;
        }
        let (lasted, at, wheel) = out.silence();
        worst = worst.max(lasted);
        if lasted > 1.0 {
            wrong += 1;
            println!(
                "run {seed}: wheel {wheel} Ok and wrong for {lasted:.2} s until {at:.2} s: {:?} {:?} camera {:?}",
                trial.faults,
                trial.events,
                trial.sensors.camera.is_some()
            );
        }
        // two seconds after the last fault all is well again
        let end = trial
            .faults
            .iter()
            .map(|f| f.1.1)
            .chain(trial.events.iter().map(|e| e.1.1))
            .fold(0.0, f64::max);
        let after = end + 2.0;
        if after < 19.0 && out.rms(after, 20.0) > 0.06 {
            late += 1;
            println!(
                "run {seed}: rms {:.3} two seconds after {:?} {:?}",
                out.rms(after, 20.0),
                trial.faults,
                trial.events
            );
        }
    }
    println!(
        "{runs} runs, {samples} samples: {wrong} Ok and wrong for over 1 s (longest {worst:.2} s), {late} not back after 2 s; {:.3} % of slips in motion Ok; bits {bits:016x}",
        100.0 * ok as f64 / slips as f64
    );
    assert_eq!(wrong, 0);
}

/// Runs of the first 110 000 seeds that were Ok and wrong for 1.3 to 2.1 s: a wheel in the air beside a gyro that is silent,
/// reversed, refused or in another unit; a robot that gets stuck while it brakes; a free wheel that was locked.
#[test]
fn runs_that_were_once_wrong_are_not() {
    for seed in [36892, 58503, 63121, 65506, 81830, 88720, 93219, 103_652] {
        let (lasted, at, wheel) = random(seed).run().silence();
        assert!(
            lasted <= 1.0,
            "run {seed}: wheel {wheel}, {lasted:.2} s until {at:.2} s"
        );
    }
}
