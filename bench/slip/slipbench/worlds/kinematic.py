"""Robots, courses and slips drawn at random: no dynamics, and slips of any kind."""

from __future__ import annotations

import math
from typing import List

import numpy as np

from slipbench.log import Floats, Robot, Run, Wheel
from slipbench.motion import SAMPLE_S, Motion
from slipbench.sensors import Suite, record
from slipbench.worlds.commands import bends, drives, levels

LASTS_S = 45.0


def slips(random: np.random.Generator, time_s: Floats) -> Floats:
    """A common slip: constant, in jumps (patches of ground), or wandering; each as often."""
    kind = random.choice(["constant", "jumps", "wanders"])
    base = float(random.choice([0.02, 0.05, 0.15, 0.3]))
    if kind == "constant":
        return np.full(len(time_s), base)
    if kind == "jumps":
        return levels(random, time_s, (4, 10), lambda: float(random.choice([base, 0.1, 0.35, 0.7])), 0.2)
    # Ornstein-Uhlenbeck with 4 s of memory and a spread of 0.1: unlike a random walk it returns
    out, now = np.empty(len(time_s)), 0.0
    for i, kick in enumerate(random.normal(size=len(time_s))):
        now += -now * SAMPLE_S / 4 + 0.1 * math.sqrt(2 * SAMPLE_S / 4) * kick
        out[i] = base + now
    return np.clip(out, -0.2, 0.9)


def motion(random: np.random.Generator, has_free: bool) -> Motion:
    time_s = np.arange(0, LASTS_S, SAMPLE_S)
    size = 10 ** random.uniform(-0.3, 0.3)
    radius, half = 0.1 * size, 0.25 * size
    rows = {2: [0.0], 4: [half, -half], 6: [1.5 * half, 0.0, -1.5 * half]}[int(random.choice([2, 4, 6]))]
    ticks = float(random.choice([360, 1000, 4096]))
    wheels: List[Wheel] = []
    for place in rows:
        for side, aside in (("left", half), ("right", -half)):
            wheels.append(Wheel(f"{side}_{len(wheels) // 2}", place, aside, radius, ticks))
    if has_free:
        wheels.append(Wheel("free", -2 * half, 0.0, 0.8 * radius, 2000.0, is_powered=False))
    top = 10 ** random.uniform(-0.8, 0.2)
    speed = drives(random, time_s, top, (1.0, 0.6, 0.0, -0.4))
    turn = bends(random, time_s, min(0.5, 0.4 * top / half))
    turn = np.where(np.abs(speed) < 0.02, 0.0, turn)
    sum_up = lambda series: np.cumsum(series) * SAMPLE_S
    yaw = sum_up(turn)
    common = slips(random, time_s)
    turned, rolled, ground = {}, {}, {}
    for wheel in wheels:
        over_ground = speed - turn * wheel.y_m
        own = common + 0.02 * random.normal()
        # a free wheel on soft ground skids by a few per cent (bearing and soil)
        slip = np.clip(own, -0.3, 0.95) if wheel.is_powered else np.full(len(time_s), -abs(0.01 * random.normal()))
        rim = np.where(slip >= 0, over_ground / (1 - np.maximum(slip, 0)), over_ground * (1 + np.minimum(slip, 0)))
        ground[wheel.name], rolled[wheel.name] = sum_up(over_ground), sum_up(rim)
        turned[wheel.name] = rolled[wheel.name] / wheel.radius_m
    rates = np.stack([np.zeros(len(time_s)), np.zeros(len(time_s)), turn], axis=1)
    accelerations = np.stack([np.gradient(speed, SAMPLE_S), speed * turn, np.full(len(time_s), 9.81)], axis=1)
    x, y = sum_up(speed * np.cos(yaw)), sum_up(speed * np.sin(yaw))
    robot = Robot("drawn", tuple(wheels))
    left = np.zeros(len(time_s))
    return Motion(robot, time_s, x, y, yaw, sum_up(speed), left, rates, turned, rolled, ground, accelerations)


def random_camera(world: str, seed: int) -> Run:
    """Robots, courses and slips drawn at random; a pose, displacements or a speed as reference, with drawn rate and noise."""
    random = np.random.default_rng([11, seed])
    one = motion(random, has_free=False)
    kind = ("pose", "displacement", "speed")[int(random.integers(3))]
    rate_hz = float(random.choice([5, 10, 30]))
    if kind == "pose":
        suite = Suite("pose", rate_hz, float(random.choice([0.005, 0.02])))
    elif kind == "displacement":
        suite = Suite("displacement", rate_hz, 0.002, 0.003)
    else:
        suite = Suite("speed", rate_hz, float(random.choice([0.02, 0.05])))
    return record(world, seed, one, suite, random)


def random_free(world: str, seed: int) -> Run:
    """The same with a free wheel, which skids by 1 % or so."""
    random = np.random.default_rng([12, seed])
    return record(world, seed, motion(random, has_free=True), Suite("free-wheel"), random)
