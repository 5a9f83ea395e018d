//! Radius, track and scale of the gyro from any log with a reference, with intervals.

use grouser_doctor::{KnownStep, Pairing};
use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_real::{Real, wrap_angle};
use grouser_slip::motion::common_motion;
use grouser_slip::{Measurement, Reference};

use crate::choice::Inputs;
use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::options::Options;
use crate::samples::{RobotSamples, held};

/// Sums are kept of blocks of this length, s: longer than the errors of a reference are correlated.
const BLOCK_S: f64 = 5.0;
/// Turns are compared over this time, s, within a block.
const STEP_S: f64 = 0.5;
/// Fewer blocks yield no interval.
const MIN_BLOCKS: usize = 5;
/// Sum of the turns of a log that hardly turns, rad: less shows neither a track nor the scale of a gyro.
const MIN_TURN_RAD: f64 = 3.0;
/// Two readings of the reference further apart are not compared, s.
const MAX_GAP_S: f64 = 1.0;

/// A factor with the half-width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factor {
    /// Right value over the one in the robot file.
    pub value: f64,
    /// Half of its 95 % interval: the wider one of jackknives over blocks of 5 s and over the runs, so that what differs from run
    /// to run (load, tyres, ground) is in it; `None` of one run of fewer than five blocks.
    pub half_width: Option<f64>,
}

/// What a log says of a robot's description, each as a factor on the robot file's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeometryCalibration {
    /// Of the radii of all powered wheels.
    pub radius: Factor,
    /// Of the distance of left and right wheels; `None` where the logs hardly turn or measure no turn.
    pub track: Option<Factor>,
    /// Of the yaw rate; `None` where the reference measures no turn.
    pub yaw_rate: Option<Factor>,
}

/// Sums of one block.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    way_reference: f64,
    way_wheels: f64,
    /// Σ θ_w θ, Σ θ_w² and Σ |θ_w| of turns by the wheels and by the best other measurement.
    wheels: [f64; 3],
    /// Number, Σ θ_g, Σ θ_r, Σ θ_g θ_r and Σ θ_g² of turns by gyro and reference: the gyro has a bias.
    gyro: [f64; 5],
}

impl Block {
    fn add(&mut self, other: &Self, sign: f64) {
        self.way_reference += sign * other.way_reference;
        self.way_wheels += sign * other.way_wheels;
        for (sum, part) in self.wheels.iter_mut().zip(other.wheels) {
            *sum += sign * part;
        }
        for (sum, part) in self.gyro.iter_mut().zip(other.gyro) {
            *sum += sign * part;
        }
    }

    fn radius(&self) -> f64 {
        self.way_reference / self.way_wheels
    }

    /// θ = (f / τ) θ_w, with the factors f of the radius and τ of the track.
    fn track(&self) -> f64 {
        self.radius() * self.wheels[1] / self.wheels[0]
    }

    /// θ_r = g θ_g + b.
    fn yaw_rate(&self) -> f64 {
        let [n, gyro, reference, product, square] = self.gyro;
        (product - gyro * reference / n) / (square - gyro * gyro / n)
    }
}

/// Radius, track and scale of the gyro with which the logs agree with their reference. Each log is a run of its own.
///
/// Assumes: no slip in these runs. What is left of a slip is in the radius; of one in turns, in the track: the track of a
/// skid-steered robot is the one that describes its turns.
///
/// # Errors
/// As [`run`](crate::run()); [`Error::NoReference`] of a log without an absolute reference, [`Error::NoCalibration`] where the
/// ways do not give a sensible radius.
pub fn calibrate_geometry(
    logs: &[Log],
    file: &RobotFile,
    options: &Options,
) -> Result<GeometryCalibration> {
    let (mut blocks, mut runs) = (Vec::new(), Vec::new());
    for log in logs {
        let of_run = blocks_of(log, file, options)?;
        runs.push(sum(&of_run));
        blocks.extend(of_run);
    }
    let all = sum(&blocks);
    if !(all.radius() > 0.2 && all.radius() < 5.0) {
        return Err(Error::NoCalibration {
            travel_reference: all.way_reference,
            travel_wheels: all.way_wheels,
        });
    }
    let factor = |of: fn(&Block) -> f64, weight: fn(&Block) -> f64| {
        let of_blocks = half_width(&blocks, &all, of);
        let of_runs = half_width_of_runs(&runs, &all, of, weight);
        Factor {
            value: of(&all),
            half_width: of_blocks.into_iter().chain(of_runs).reduce(f64::max),
        }
    };
    let is_sane = |factor: &Factor| factor.value > 0.2 && factor.value < 5.0;
    let turns = all.wheels[2] > MIN_TURN_RAD;
    let gyro_turns = all.gyro[4].sqrt() * all.gyro[0].sqrt() > MIN_TURN_RAD;
    Ok(GeometryCalibration {
        radius: factor(Block::radius, |run| run.way_wheels.abs()),
        track: turns
            .then(|| factor(Block::track, |run| run.wheels[1]))
            .filter(is_sane),
        yaw_rate: gyro_turns
            .then(|| factor(Block::yaw_rate, |run| run.gyro[4]))
            .filter(is_sane),
    })
}

fn sum(blocks: &[Block]) -> Block {
    let mut all = Block::default();
    for block in blocks {
        all.add(block, 1.0);
    }
    all
}

/// The 95 % interval by the jackknife over runs of different weights: with h = Σ weights / weight of a run, its pseudo-value is
/// h θ − (h − 1) θ without it, and the variance is the mean of (pseudo-value − θ)² / (h − 1).
///
/// Source: Busing, Meijer and van der Leeden 1999, *Delete-m Jackknife for Unequal m*; θ for the mean of the pseudo-values, which
/// differ by what is of second order.
fn half_width_of_runs(
    runs: &[Block],
    all: &Block,
    of: fn(&Block) -> f64,
    weight: fn(&Block) -> f64,
) -> Option<f64> {
    let used: Vec<&Block> = runs.iter().filter(|run| weight(run) > 0.0).collect();
    if used.len() < 2 {
        return None;
    }
    let total: f64 = used.iter().map(|run| weight(run)).sum();
    let parts = used.iter().map(|run| {
        let mut rest = *all;
        rest.add(run, -1.0);
        let others = total / weight(run) - 1.0;
        // the pseudo-value less θ is (h − 1) (θ − θ without the run)
        others * Real::powi(of(all) - of(&rest), 2)
    });
    let count = used.len() as f64;
    let variance = parts.sum::<f64>() / count;
    Some(student_97_5(count - 1.0) * variance.sqrt()).filter(|width| width.is_finite())
}

/// Quantile of Student's t at 97.5 %, to a hundredth.
fn student_97_5(freedom: f64) -> f64 {
    match freedom {
        ..1.5 => 12.71,
        ..2.5 => 4.30,
        ..3.5 => 3.18,
        _ => 1.96 + 2.37 / freedom + 2.82 / Real::powi(freedom, 2) + 2.0 / Real::powi(freedom, 3),
    }
}

/// The 95 % interval by the jackknife: what is left without each block in turn.
fn half_width(blocks: &[Block], all: &Block, of: fn(&Block) -> f64) -> Option<f64> {
    let count = blocks.len();
    if count < MIN_BLOCKS {
        return None;
    }
    let left = blocks.iter().map(|block| {
        let mut rest = *all;
        rest.add(block, -1.0);
        of(&rest)
    });
    let left: Vec<f64> = left.collect();
    let n = count as f64;
    let mean = left.iter().sum::<f64>() / n;
    let variance = left.iter().map(|x| Real::powi(x - mean, 2)).sum::<f64>() * (n - 1.0) / n;
    Some(student_97_5(n - 1.0) * variance.sqrt()).filter(|width| width.is_finite())
}

fn blocks_of(log: &Log, file: &RobotFile, options: &Options) -> Result<Vec<Block>> {
    let mut samples = RobotSamples::new(log, file)?;
    let inputs = Inputs::of(log, file, options)?;
    if inputs.reference == Reference::Grip {
        return Err(Error::NoReference {
            reference: "any",
            needs: "a displacement, a pose, a speed over ground or a free wheel",
        });
    }
    let online = Options {
        offline: false,
        learn_soil: None,
        ..*options
    };
    let mut settings = file.settings;
    settings.reference = inputs.reference;
    let mut fusion = Fusion::new(file, &settings, &inputs, &online)?;
    let mut pairing = Pairing::new(inputs.reference);
    let mut scratch = vec![0.0; file.robot.wheels().len()];
    let mut start_ns = None;
    let mut blocks: Vec<Block> = Vec::new();
    let mut turns = Turns::default();
    let (mut ways, mut stepped_s, mut begun_s): ([f64; 2], f64, Option<f64>) =
        ([0.0; 2], 0.0, None);
    let mut held = held(log, file, options, &[])?;
    for sample in log.samples(&vec![0; log.clocks()])? {
        let sample = sample?;
        if !held.keeps(&sample) {
            continue;
        }
        let sample = samples.convert(sample);
        let start = *start_ns.get_or_insert(sample.time_ns);
        let time_s = sample.time_ns.saturating_sub(start) as f64 * 1e-9;
        if !inputs.wheel_sensor.uses(&sample.measurement) {
            continue;
        }
        fusion.update(sample);
        turns.take(time_s, &sample.measurement, inputs.reference);
        fusion.advance(&mut |_, step, filter| {
            let by_wheels = common_motion(&step.wheels, None, 1.0, 0.0, &mut scratch);
            turns.step(by_wheels.and_then(|of| of.turn));
            let known = KnownStep::online(step, filter);
            if let Some(passed) = pairing.take(&known)
                && let Some(reference) = passed.distance_by_reference()
            {
                ways[0] += passed.length;
                ways[1] += reference;
            }
        });
        if time_s - stepped_s < STEP_S {
            continue;
        }
        stepped_s = time_s;
        let [way_wheels, way_reference] = std::mem::take(&mut ways);
        let turned = turns.pass();
        let is_inside = time_s >= options.from_s.unwrap_or(0.0)
            && time_s <= options.to_s.unwrap_or(f64::INFINITY);
        if !is_inside {
            continue;
        }
        if begun_s.is_none_or(|begun| time_s - begun > BLOCK_S) {
            begun_s = Some(time_s);
            blocks.push(Block::default());
        }
        if let Some(block) = blocks.last_mut() {
            block.way_wheels += way_wheels;
            block.way_reference += way_reference;
            turned.enter(block);
        }
    }
    Ok(blocks)
}

/// Turns since the last step by wheels, gyro and reference, rad.
#[derive(Clone, Copy, Debug, Default)]
struct Turned {
    wheels: Option<f64>,
    gyro: Option<f64>,
    reference: Option<f64>,
}

impl Turned {
    fn enter(&self, block: &mut Block) {
        if let Some((wheels, other)) = self.wheels.zip(self.reference.or(self.gyro)) {
            block.wheels[0] += wheels * other;
            block.wheels[1] += wheels * wheels;
            block.wheels[2] += wheels.abs();
        }
        if let Some((gyro, reference)) = self.gyro.zip(self.reference) {
            let parts = [1.0, gyro, reference, gyro * reference, gyro * gyro];
            for (sum, part) in block.gyro.iter_mut().zip(parts) {
                *sum += part;
            }
        }
    }
}

/// The turns of a log as they pass.
#[derive(Clone, Debug, Default)]
struct Turns {
    passed: Turned,
    /// Time and value of the last reading of gyro (a rate) and pose (a yaw).
    gyro: Option<(f64, f64)>,
    yaw: Option<(f64, f64)>,
}

impl Turns {
    fn take(&mut self, time_s: f64, measurement: &Measurement, reference: Reference) {
        match *measurement {
            Measurement::YawRate { rate } if rate.is_finite() => {
                integrate(&mut self.passed.gyro, &mut self.gyro, time_s, rate);
            }
            Measurement::Pose { yaw, .. } if reference == Reference::Pose && yaw.is_finite() => {
                let last = self.yaw.replace((time_s, yaw));
                if let Some((_, before)) = last.filter(|last| time_s - last.0 < MAX_GAP_S) {
                    *self.passed.reference.get_or_insert(0.0) += wrap_angle(yaw - before);
                }
            }
            Measurement::Displacement {
                turn: Some(turn), ..
            } if reference == Reference::Displacement && turn.is_finite() => {
                *self.passed.reference.get_or_insert(0.0) += turn;
            }
            _ => {}
        }
    }

    fn step(&mut self, wheels: Option<f64>) {
        if let Some(turn) = wheels {
            *self.passed.wheels.get_or_insert(0.0) += turn;
        }
    }

    /// The turns since the last call.
    fn pass(&mut self) -> Turned {
        std::mem::take(&mut self.passed)
    }
}

/// Adds the integral of a rate since its last value.
fn integrate(sum: &mut Option<f64>, last: &mut Option<(f64, f64)>, time_s: f64, rate: f64) {
    if let Some((before_s, before)) = last.replace((time_s, rate))
        && time_s - before_s < MAX_GAP_S
    {
        *sum.get_or_insert(0.0) += 0.5 * (before + rate) * (time_s - before_s);
    }
}
