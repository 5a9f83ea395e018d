//! Faults of sensors and clocks, put into a stream of samples. The stream is in the order of arrival.

use grouser_slip::{Measurement, Sample};

use crate::noise::Noise;

/// What goes wrong with the sensors. Wheels are given by index; everything else is for all sensors of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// A wheel's encoder says nothing.
    WheelSilent(usize),
    /// A wheel's counter does not move on.
    WheelStuck(usize),
    /// A wheel's encoder misses this share of its pulses at random.
    PulsesLost(usize, f64),
    /// A wheel's counter counts this many ticks where it should count one, evenly: a wrong number of ticks a turn.
    CountsScaled(usize, f64),
    /// The counters of two wheels are exchanged.
    Exchanged(usize, usize),
    /// The first wheel shows the second's counter.
    Copies(usize, usize),
    /// A wheel's clock gains this many seconds a second.
    ClockRate(usize, f64),
    /// One slot in this many of a wheel's encoder is broken.
    SlotBroken(usize, i64),
    /// A wheel's two tracks are swapped: it counts the other way.
    Swapped(usize),
    /// A wheel's counter begins again at zero (once, at the beginning).
    CounterReset(usize),
    /// One reading of a wheel's counter is off by this many ticks (once, at the beginning).
    CounterJumps(usize, i64),
    /// Every sample comes twice; the second differs from the first if this is set.
    Repeated(bool),
    /// Every sample's time is off by this much, ns.
    Clock(i64),
    /// One row's time is off by this much, ns (once, at the beginning).
    ClockOnce(i64),
    /// Samples arrive late by up to this time, ns, each by its own; their stamps are right.
    Shuffled(i64),
    /// Stamps are off by up to half of this either way, ns, at random.
    Jitter(i64),
    /// Nothing arrives; at the end all of it at once, with the right stamps.
    Burst,
    /// Only every n-th row arrives.
    RowsLost(usize),
    /// Nothing arrives at all.
    AllSilent,
    /// The gyro and the accelerometer say nothing.
    ImuSilent,
    /// The gyro and the accelerometer repeat their last values to the bit.
    ImuStuck,
    /// The accelerometer shows its maximum forwards, m/s².
    AccelerometerSaturated(f64),
    /// The accelerometer has this much more bias forwards, m/s².
    AccelerometerBias(f64),
    /// The accelerometer's bias forwards grows by this much a second, m/s³.
    AccelerometerDrifts(f64),
    /// The gyro has this much more bias, rad/s.
    GyroBias(f64),
    /// The gyro's values are multiplied by this: a wrong unit, or a sign.
    GyroScale(f64),
    /// Every value of the gyro and the accelerometer is this.
    ImuValue(f64),
    /// Gyro and accelerometer show noise of this standard deviation (rad/s, m/s²).
    ImuGarbage(f64),
    /// The camera says nothing.
    CameraLost,
    /// The camera jumps ahead by this once, m (at the beginning).
    CameraJumps(f64),
    /// The camera's displacements are multiplied by this.
    CameraScale(f64),
    /// The camera repeats its last displacement to the bit.
    CameraFrozen,
    /// Every number of the camera is this.
    CameraValue(f64),
    /// The torque sensors are off by this, N m.
    TorqueOffset(f64),
    /// The torque sensors show nothing: 0.
    TorqueZero,
    /// The torque sensors show noise of this standard deviation, N m.
    TorqueNoise(f64),
}

/// Puts `fault` into `samples` between two times (s from the first sample). `bits` is the width of the counters.
#[must_use]
pub fn inject(
    samples: &[Sample],
    fault: Fault,
    (from, to): (f64, f64),
    bits: u32,
    seed: u64,
) -> Vec<Sample> {
    let start = samples.first().map_or(0, |sample| sample.time_ns);
    let mut state = State {
        noise: Noise::new(seed),
        bits,
        last: None,
        shown: 0,
        scaled: 0.0,
        copied: None,
        done: false,
        imu: [None; 2],
        camera: None,
        held: Vec::new(),
        late: Vec::new(),
        row: (i64::MIN, 0),
        first_row: None,
    };
    let mut out = Vec::with_capacity(samples.len());
    for sample in samples {
        let time = sample.time_ns.wrapping_sub(start) as f64 * 1e-9;
        if sample.time_ns != state.row.0 {
            state.row = (sample.time_ns, state.row.1 + 1);
            state.release(sample.time_ns, &mut out);
        }
        let within = time >= from && time < to;
        state.remember(sample, within);
        if within {
            state.alter(*sample, fault, &mut out);
        } else {
            if time >= to {
                out.append(&mut state.held);
            }
            out.push(state.after(*sample, fault, time >= to));
        }
    }
    state.release(i64::MAX, &mut out);
    out.append(&mut state.held);
    out
}

struct State {
    noise: Noise,
    bits: u32,
    /// The last true reading of the wheel at fault, and what its counter shows.
    last: Option<u64>,
    shown: i64,
    /// Ticks of a scaled counter since the beginning of the fault.
    scaled: f64,
    /// The last reading of the counter that is copied.
    copied: Option<u64>,
    done: bool,
    imu: [Option<Measurement>; 2],
    camera: Option<Measurement>,
    held: Vec<Sample>,
    /// Samples under way, with their times of arrival.
    late: Vec<(i64, Sample)>,
    /// Time and number of the present row.
    row: (i64, usize),
    /// The first row that the fault saw.
    first_row: Option<i64>,
}

impl State {
    fn release(&mut self, now: i64, out: &mut Vec<Sample>) {
        let mut arrived: Vec<_> = self.late.extract_if(.., |(due, _)| *due <= now).collect();
        arrived.sort_by_key(|(due, _)| *due);
        out.extend(arrived.into_iter().map(|(_, sample)| sample));
    }

    fn remember(&mut self, sample: &Sample, within: bool) {
        if within {
            return;
        }
        match sample.measurement {
            Measurement::YawRate { .. } => self.imu[0] = Some(sample.measurement),
            Measurement::Acceleration { .. } => self.imu[1] = Some(sample.measurement),
            Measurement::Displacement { .. } => self.camera = Some(sample.measurement),
            _ => {}
        }
    }

    /// The step of a counter since its last reading.
    fn counted(&mut self, raw: u64) -> i64 {
        let unused = 64 - self.bits;
        let step = self.last.map_or(0, |last| {
            (raw.wrapping_sub(last) << unused).cast_signed() >> unused
        });
        self.last = Some(raw);
        step
    }

    fn raw(&self, count: i64) -> u64 {
        count.cast_unsigned() & (u64::MAX >> (64 - self.bits))
    }

    /// A sample after the fault: a counter goes on from where the fault left it.
    fn after(&mut self, sample: Sample, fault: Fault, over: bool) -> Sample {
        if let Measurement::WheelCount { wheel, raw } = sample.measurement
            && wheel_of(fault) == Some(wheel)
        {
            if !over {
                self.last = Some(raw);
                self.shown = raw.cast_signed();
                return sample;
            }
            let keeps = matches!(
                fault,
                Fault::PulsesLost(..)
                    | Fault::SlotBroken(..)
                    | Fault::CountsScaled(..)
                    | Fault::Swapped(_)
                    | Fault::CounterReset(_)
            );
            if keeps {
                self.shown = self.shown.wrapping_add(self.counted(raw));
                let raw = self.raw(self.shown);
                return with(sample, Measurement::WheelCount { wheel, raw });
            }
        }
        sample
    }

    fn alter(&mut self, sample: Sample, fault: Fault, out: &mut Vec<Sample>) {
        match fault {
            Fault::AllSilent => {}
            Fault::Burst => self.held.push(sample),
            Fault::RowsLost(every) => {
                if self.row.1.is_multiple_of(every) {
                    out.push(sample);
                }
            }
            Fault::Repeated(differs) => {
                out.push(sample);
                out.push(if differs { other(sample) } else { sample });
            }
            Fault::Clock(off) => out.push(at(sample, sample.time_ns.saturating_add(off))),
            Fault::ClockOnce(off) => {
                let off = if *self.first_row.get_or_insert(sample.time_ns) == sample.time_ns {
                    off
                } else {
                    0
                };
                out.push(at(sample, sample.time_ns.saturating_add(off)));
            }
            Fault::Shuffled(most) => {
                let late = whole(self.noise.uniform() * most as f64);
                self.late
                    .push((sample.time_ns.saturating_add(late), sample));
            }
            Fault::Jitter(most) => {
                let off = whole((self.noise.uniform() - 0.5) * most as f64);
                out.push(at(sample, sample.time_ns.saturating_add(off)));
            }
            Fault::ClockRate(of, gain) => out.push(self.gained(sample, of, gain)),
            Fault::Exchanged(..) | Fault::Copies(..) => out.push(self.confused(sample, fault)),
            _ => out.extend(self.read(sample, fault)),
        }
    }

    /// A sample whose wheel has a clock that gains.
    fn gained(&mut self, sample: Sample, of: usize, gain: f64) -> Sample {
        match sample.measurement {
            Measurement::WheelCount { wheel, .. } if wheel == of => {
                let begun = *self.first_row.get_or_insert(sample.time_ns);
                let off = whole(gain * sample.time_ns.wrapping_sub(begun) as f64);
                at(sample, sample.time_ns.saturating_add(off))
            }
            _ => sample,
        }
    }

    /// A sample whose counter's name or number is another wheel's.
    fn confused(&mut self, sample: Sample, fault: Fault) -> Sample {
        let Measurement::WheelCount { wheel, raw } = sample.measurement else {
            return sample;
        };
        let (wheel, raw) = match fault {
            Fault::Exchanged(a, b) if wheel == a => (b, raw),
            Fault::Exchanged(a, b) if wheel == b => (a, raw),
            Fault::Copies(a, _) if wheel == a => (a, self.copied.unwrap_or(raw)),
            Fault::Copies(_, b) if wheel == b => {
                self.copied = Some(raw);
                (b, raw)
            }
            _ => (wheel, raw),
        };
        with(sample, Measurement::WheelCount { wheel, raw })
    }

    /// What the sensor at fault reads.
    fn read(&mut self, sample: Sample, fault: Fault) -> Option<Sample> {
        match sample.measurement {
            Measurement::WheelCount { wheel, raw } if wheel_of(fault) == Some(wheel) => {
                let raw = self.count(raw, fault)?;
                Some(with(sample, Measurement::WheelCount { wheel, raw }))
            }
            Measurement::YawRate { rate } => Some(with(sample, self.gyro(rate, fault)?)),
            Measurement::Acceleration { forward, left } => {
                let begun = *self.first_row.get_or_insert(sample.time_ns);
                let since = sample.time_ns.wrapping_sub(begun) as f64 * 1e-9;
                Some(with(
                    sample,
                    self.accelerometer((forward, left), since, fault)?,
                ))
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => Some(with(sample, self.seen((forward, left, turn), fault)?)),
            Measurement::WheelTorque { wheel, torque } => {
                let torque = match fault {
                    Fault::TorqueOffset(off) => torque + off,
                    Fault::TorqueZero => 0.0,
                    Fault::TorqueNoise(sigma) => torque + sigma * self.noise.normal(),
                    _ => torque,
                };
                Some(with(sample, Measurement::WheelTorque { wheel, torque }))
            }
            _ => Some(sample),
        }
    }

    fn count(&mut self, raw: u64, fault: Fault) -> Option<u64> {
        let before = self.last;
        let step = self.counted(raw);
        match fault {
            Fault::WheelSilent(_) => return None,
            Fault::WheelStuck(_) => return Some(self.raw(self.shown)),
            Fault::PulsesLost(_, share) => {
                for _ in 0..step.unsigned_abs() {
                    if self.noise.uniform() >= share {
                        self.shown = self.shown.wrapping_add(step.signum());
                    }
                }
            }
            Fault::CountsScaled(_, factor) => {
                let before = whole(self.scaled.floor());
                self.scaled += factor * step as f64;
                self.shown = self.shown.wrapping_add(whole(self.scaled.floor()) - before);
            }
            Fault::SlotBroken(_, slots) => {
                let from = before.unwrap_or(raw).cast_signed();
                let lost = (from + step).div_euclid(slots) - from.div_euclid(slots);
                self.shown = self.shown.wrapping_add(step - lost);
            }
            Fault::Swapped(_) => self.shown = self.shown.wrapping_sub(step),
            Fault::CounterReset(_) => {
                if std::mem::replace(&mut self.done, true) {
                    self.shown = self.shown.wrapping_add(step);
                } else {
                    self.shown = 0;
                }
            }
            Fault::CounterJumps(_, ticks) => {
                let off = if std::mem::replace(&mut self.done, true) {
                    0
                } else {
                    ticks
                };
                return Some(self.raw(raw.cast_signed().wrapping_add(off)));
            }
            _ => return Some(raw),
        }
        Some(self.raw(self.shown))
    }

    fn gyro(&mut self, rate: f64, fault: Fault) -> Option<Measurement> {
        let rate = match fault {
            Fault::ImuSilent => return None,
            Fault::ImuStuck => return self.imu[0],
            Fault::GyroBias(bias) => rate + bias,
            Fault::GyroScale(scale) => rate * scale,
            Fault::ImuValue(value) => value,
            Fault::ImuGarbage(sigma) => sigma * self.noise.normal(),
            _ => rate,
        };
        Some(Measurement::YawRate { rate })
    }

    fn accelerometer(
        &mut self,
        (forward, left): (f64, f64),
        since: f64,
        fault: Fault,
    ) -> Option<Measurement> {
        let (forward, left) = match fault {
            Fault::ImuSilent => return None,
            Fault::ImuStuck => return self.imu[1],
            Fault::AccelerometerSaturated(most) => (most, left),
            Fault::AccelerometerBias(bias) => (forward + bias, left),
            Fault::AccelerometerDrifts(by) => (forward + by * since, left),
            Fault::ImuValue(value) => (value, value),
            Fault::ImuGarbage(sigma) => (sigma * self.noise.normal(), sigma * self.noise.normal()),
            _ => (forward, left),
        };
        Some(Measurement::Acceleration { forward, left })
    }

    fn seen(
        &mut self,
        (forward, left, turn): (f64, f64, Option<f64>),
        fault: Fault,
    ) -> Option<Measurement> {
        let (forward, left, turn) = match fault {
            Fault::CameraLost => return None,
            Fault::CameraFrozen => return self.camera,
            Fault::CameraJumps(ahead) if !std::mem::replace(&mut self.done, true) => {
                (forward + ahead, left, turn)
            }
            Fault::CameraScale(scale) => (forward * scale, left * scale, turn),
            Fault::CameraValue(value) => (value, value, Some(value)),
            _ => (forward, left, turn),
        };
        Some(Measurement::Displacement {
            forward,
            left,
            turn,
        })
    }
}

const fn wheel_of(fault: Fault) -> Option<usize> {
    match fault {
        Fault::WheelSilent(wheel)
        | Fault::WheelStuck(wheel)
        | Fault::PulsesLost(wheel, _)
        | Fault::SlotBroken(wheel, _)
        | Fault::CountsScaled(wheel, _)
        | Fault::Swapped(wheel)
        | Fault::CounterReset(wheel)
        | Fault::CounterJumps(wheel, _) => Some(wheel),
        _ => None,
    }
}

const fn with(sample: Sample, measurement: Measurement) -> Sample {
    Sample {
        time_ns: sample.time_ns,
        measurement,
    }
}

const fn at(sample: Sample, time_ns: i64) -> Sample {
    Sample {
        time_ns,
        measurement: sample.measurement,
    }
}

/// The same sensor's reading with another value.
fn other(sample: Sample) -> Sample {
    let measurement = match sample.measurement {
        Measurement::WheelCount { wheel, raw } => Measurement::WheelCount {
            wheel,
            raw: raw ^ 1,
        },
        Measurement::YawRate { rate } => Measurement::YawRate { rate: rate + 0.01 },
        Measurement::Acceleration { forward, left } => Measurement::Acceleration {
            forward: forward + 0.1,
            left,
        },
        same => same,
    };
    with(sample, measurement)
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a time of seconds in ns, or some ticks"
)]
fn whole(value: f64) -> i64 {
    value as i64
}
