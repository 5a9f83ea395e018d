"""A motion as a robot's sensors record it, with one fault of a list."""

from __future__ import annotations

import dataclasses
import math
from typing import Dict, Tuple

import numpy as np

from slipbench.log import Floats, Log, Reference, ReferenceKind, Run
from slipbench.motion import SAMPLE_S, Motion

ROW_SAMPLES = 2  # rows at 50 Hz, a common rate of base controllers
# A MEMS gyro on a driving robot: vibration, not the sensor's own noise (0.0002 rad/s), sets the scatter.
RATE_SIGMA = 0.003
RATE_BIAS_SIGMA = 0.002  # left after the calibration at power-on
ACCELERATION_SIGMA, ACCELERATION_BIAS_SIGMA = 0.1, 0.1

FAULTS: Dict[str, str] = {
    "none": "nothing but the noise of the data sheets",
    "coarse-encoder": "90 ticks a turn: a magnet ring in place of an optical disc",
    "lost-rows": "3 % of the rows of wheels are lost, and four times all of them for 1 s: a busy serial bus",
    "gyro-bias": "0.01 rad/s of bias that drifts by 0.002 rad/s in 10 s: a gyro that warms up",
    "radius": "the powered wheels are 1 % smaller than described: wear, tyre pressure, a rule of thumb",
    "late": "the reference is 0.15 s late and nobody says so: stamps of arrival after image processing",
    "jitter": "stamps of the reference scatter by 10 ms (exponential): stamps of arrival of a loaded computer",
    "slow": "the reference has 5 Hz, or half of its rate if that is 5 Hz",
    "drift": "the reference's scale is 1 % off and it drifts by 1 % of the distance at random: visual odometry",
    "outliers": "3 % of the readings are off by 30 sigma: mismatched features, multipath",
    "outage": "the reference is silent for 8 s in the middle of the drive",
    "play": "the free wheel's encoder has 5 degrees of play: a worn coupling",
    "skid": "the free wheel's bearing drags: it skids by 2 %",
}
FREE_WHEEL_FAULTS = ("none", "coarse-encoder", "lost-rows", "gyro-bias", "radius", "play", "skid")
REFERENCE_FAULTS = tuple(name for name in FAULTS if name not in ("play", "skid"))


@dataclasses.dataclass(frozen=True)
class Suite:
    """The reference of a world's robot."""

    kind: ReferenceKind
    rate_hz: float = 10.0
    sigma: float = 0.005
    yaw_sigma: float = 0.01

    @property
    def faults(self) -> Tuple[str, ...]:
        return FREE_WHEEL_FAULTS if self.kind == "free-wheel" else REFERENCE_FAULTS


def with_ticks(motion: Motion, ticks: float) -> Motion:
    wheels = tuple(dataclasses.replace(wheel, ticks_per_turn=ticks) for wheel in motion.robot.wheels)
    return dataclasses.replace(motion, robot=dataclasses.replace(motion.robot, wheels=wheels))


def record(world: str, seed: int, motion: Motion, suite: Suite, random: np.random.Generator) -> Run:
    """The run of a seed: its fault is the seed's place in the list of the suite's faults."""
    fault = suite.faults[seed % len(suite.faults)]
    if fault == "coarse-encoder":
        motion = with_ticks(motion, 90)
    rows = np.arange(0, len(motion.time_s), ROW_SAMPLES)
    counts = {wheel.name: counted(motion, wheel.name, rows, fault, random) for wheel in motion.robot.wheels}
    if fault == "lost-rows":
        lost = random.random(len(rows)) < 0.03
        for begin_s in motion.time_s[-1] * random.uniform(0.1, 0.9, 4):
            lost |= (motion.time_s[rows] > begin_s) & (motion.time_s[rows] < begin_s + 1)
        lost[0] = False
        counts = {name: np.where(lost, np.nan, series) for name, series in counts.items()}
    bias = RATE_BIAS_SIGMA * random.normal(size=3)
    drift = np.zeros(len(rows))
    if fault == "gyro-bias":
        bias = bias + 0.01 * random.choice([-1, 1])
        drift = 0.002 * random.choice([-1, 1]) * motion.time_s[rows] / 10
    rates = row_means(motion.rates) + bias + drift[:, None] + RATE_SIGMA * random.normal(size=(len(rows), 3))
    accelerations = None
    if motion.accelerations is not None:
        noise = ACCELERATION_SIGMA * random.normal(size=(len(rows), 3)) + ACCELERATION_BIAS_SIGMA * random.normal(size=3)
        accelerations = row_means(motion.accelerations) + noise
    reference = referred(motion, suite, fault, random)
    links = {name: angle[rows] + 0.002 * random.normal(size=len(rows)) for name, angle in motion.links.items()}
    steering = None if motion.steering is None else motion.steering[rows] + 0.005 * random.normal(size=len(rows))
    time_s = motion.time_s[rows]
    log = Log(motion.robot, time_s, counts, rates, RATE_SIGMA, reference, accelerations, links, steering)
    return Run(world, seed, fault, log, motion.truth())


def row_means(series: Floats) -> Floats:
    """What a low-pass filter of one row keeps: the mean of the samples of each row."""
    rows = np.arange(0, len(series), ROW_SAMPLES)
    sums = np.concatenate([np.zeros((1, series.shape[1])), np.cumsum(series, axis=0)])
    first = np.maximum(rows - ROW_SAMPLES + 1, 0)
    return np.asarray((sums[rows + 1] - sums[first]) / (rows + 1 - first)[:, None])


def counted(motion: Motion, name: str, rows: Floats, fault: str, random: np.random.Generator) -> Floats:
    wheel = motion.robot.wheel(name)
    angle = motion.turned[name]
    if fault == "radius" and wheel.is_powered:
        # the true wheel is smaller than the described one: it turns more for the same distance
        angle = angle * 1.01
    if not wheel.is_powered and fault == "skid":
        angle = angle * 0.98
    if not wheel.is_powered and fault == "play":
        angle = with_play(angle, math.radians(5.0))
    return np.floor(angle[rows] / (2 * math.pi) * wheel.ticks_per_turn + random.uniform(0, 1))


def with_play(angle: Floats, play: float) -> Floats:
    """The angle behind a coupling with play: it follows once the play is used up."""
    out = np.empty_like(angle)
    now = angle[0]
    for i, one in enumerate(angle):
        now = min(max(now, one - play), one)
        out[i] = now
    return out


def referred(motion: Motion, suite: Suite, fault: str, random: np.random.Generator) -> Reference:
    if suite.kind == "free-wheel":
        return Reference("free-wheel", np.zeros(0), np.zeros((0, 3)), 0.0)
    rate_hz = suite.rate_hz
    if fault == "slow":
        rate_hz = 5.0 if rate_hz > 5 else rate_hz / 2
    at = np.arange(random.uniform(0, 1 / rate_hz), motion.time_s[-1], 1 / rate_hz)
    value = lambda series: np.interp(at, motion.time_s, series)
    count = len(at)
    scale, wander = 1.0, np.zeros((2, count))
    if fault == "drift":
        scale = 1 + 0.01 * random.choice([-1, 1])
        steps = np.abs(np.diff(value(motion.forward), prepend=motion.forward[0]))
        # 1 % of the distance after 1 m, growing with its square root
        wander = np.cumsum(0.01 * np.sqrt(steps) * random.normal(size=(2, count)), axis=1)
    is_off = random.random(count) < 0.03 if fault == "outliers" else np.zeros(count, bool)
    off = 30 * suite.sigma * np.where(is_off, random.choice([-1, 1], count), 0)
    noise = lambda sigma: sigma * random.normal(size=count)
    yaw = value(motion.yaw)
    if suite.kind == "pose":
        x, y = scale * value(motion.x) + wander[0], scale * value(motion.y) + wander[1]
        values = np.stack([x + noise(suite.sigma) + off, y + noise(suite.sigma), yaw + noise(suite.yaw_sigma)], axis=1)
    elif suite.kind == "displacement":
        forward = np.diff(scale * value(motion.forward) + wander[0], prepend=np.nan)
        left = np.diff(scale * value(motion.left) + wander[1], prepend=np.nan)
        turn = np.diff(yaw, prepend=np.nan)
        values = np.stack([forward + noise(suite.sigma) + off, left + noise(suite.sigma), turn + noise(suite.yaw_sigma)], axis=1)
    else:
        speed = scale * np.interp(at, motion.time_s, np.gradient(motion.forward, SAMPLE_S))
        values = (speed + noise(suite.sigma) + off)[:, None]
    stamps = at.copy()
    if fault == "late":
        stamps += 0.15
    if fault == "jitter":
        stamps = np.maximum.accumulate(stamps + 0.01 * random.exponential(size=count)) + 1e-6 * np.arange(count)
    kept = np.isfinite(values).all(axis=1) & (stamps <= motion.time_s[-1])
    if fault == "outage":
        middle = 0.5 * motion.time_s[-1]
        is_out = np.abs(at - middle) < 4
        if suite.kind == "displacement":
            # visual odometry that lost track begins anew: a row that says so, from which the next one counts
            values[np.flatnonzero(is_out)[-1]] = np.nan
            is_out[np.flatnonzero(is_out)[-1]] = False
            kept |= np.isnan(values).any(axis=1) & (at > 1)
        kept &= ~is_out
    return Reference(suite.kind, stamps[kept], values[kept], suite.sigma, suite.yaw_sigma)
