"""Worlds in MuJoCo: rigid ground with friction, and the same robots on soft ground of two laws."""

from __future__ import annotations

import math
from typing import List, Tuple

import numpy as np

from slipbench.log import Floats, Run
from slipbench.motion import SAMPLE_S
from slipbench.sensors import Suite, record
from slipbench.worlds import vehicles
from slipbench.worlds.commands import bends, drives, lagged, levels
from slipbench.worlds.ground import Ground, Sand, Turf
from slipbench.worlds.simulation import Plan, simulate

LASTS_S = 40.0
# A camera that looks at the ground or follows features: millimetres between pictures, 5 mm against a map.
MAP_CAMERA = Suite("pose", 10.0, 0.005, 0.01)
ODOMETRY_CAMERA = Suite("displacement", 15.0, 0.002, 0.003)


def times(lasts_s: float = LASTS_S) -> Floats:
    return SAMPLE_S * np.arange(1, round(lasts_s / SAMPLE_S) + 1)


def bands(random: np.random.Generator, low: Tuple[float, float], high: Tuple[float, float], length: Tuple[float, float]) -> List[Tuple[float, float]]:
    """Friction high and low in turn along x."""
    found, at, is_low = [(-math.inf, float(random.uniform(*high)))], float(random.uniform(0.5, 2)), True
    while at < 60:
        found.append((at, float(random.uniform(*(low if is_low else high)))))
        at += float(random.uniform(*length))
        is_low = not is_low
    return found


def straight(speed: Floats) -> Plan:
    return Plan(speed, np.zeros(len(speed)))


def five_waves(world: str, seed: int) -> Run:
    """The five-wheeled robot over waves of 4 m, amplitude 8 to 15 cm, on packed snow or wet clay (friction 0.12 to 0.3)."""
    random = np.random.default_rng([1, seed])
    ground = Ground(waves=[(random.uniform(0.08, 0.15), 2 * math.pi / 4, 0.0, -math.pi / 2)], bands=[(-math.inf, random.uniform(0.12, 0.3))])
    motion = simulate(vehicles.five(), ground, straight(drives(random, times(), 0.2)))
    return record(world, seed, motion, Suite("free-wheel"), random)


def five_patches(world: str, seed: int) -> Run:
    """The five-wheeled robot on ramps of 7 to 11 degrees with patches of wet loam or ice (0.1 to 0.25)."""
    random = np.random.default_rng([2, seed])
    slope = math.tan(math.radians(random.uniform(7, 11)))
    ground = Ground(ramps=[(1.5, 8.0, slope)], bands=bands(random, (0.1, 0.25), (0.6, 0.9), (0.4, 1.5)))
    motion = simulate(vehicles.five(), ground, straight(drives(random, times(), 0.25)))
    return record(world, seed, motion, Suite("free-wheel"), random)


def bogie_rough(world: str, seed: int) -> Run:
    """A rocker-bogie rover over rough ground (bumps of 0.7 to 3 m, 3 cm each), friction 0.3 to 0.7, a camera against a map."""
    random = np.random.default_rng([3, seed])
    waves = []
    for length in (0.7, 1.3, 3.0):
        heading = random.uniform(-0.6, 0.6)
        number = 2 * math.pi / length
        amplitude = 0.03 * random.uniform(0.5, 1) * min(1.0, length / 1.3)
        waves.append((amplitude, number * math.cos(heading), number * math.sin(heading), random.uniform(0, 6)))
    ground = Ground(waves=waves, bands=[(-math.inf, random.uniform(0.3, 0.7))])
    motion = simulate(vehicles.rocker_bogie(), ground, straight(drives(random, times(), 0.2)), cell_m=0.05)
    return record(world, seed, motion, MAP_CAMERA, random)


def skid_turns(world: str, seed: int) -> Run:
    """A skid-steered robot that turns: its wheels scrub, inner ones brake. Visual odometry."""
    random = np.random.default_rng([4, seed])
    time_s = times()
    speed = drives(random, time_s, 0.5)
    plan = Plan(speed, bends(random, time_s, 0.6, 0.9), holds_heading=False, turn_factor=1.6)
    motion = simulate(vehicles.four(), Ground(bands=[(-math.inf, random.uniform(0.4, 0.9))]), plan)
    return record(world, seed, motion, ODOMETRY_CAMERA, random)


def car_patches(world: str, seed: int) -> Run:
    """A fast car that accelerates and brakes over patches of ice or wet leaves; satellite positions (RTK, 2 cm, 5 Hz)."""
    random = np.random.default_rng([5, seed])
    time_s = times()
    speed = levels(random, time_s, (2, 5), lambda: float(random.choice([3.0, 2.0, 1.0, 0.3])), 0.3)
    ground = Ground(bands=bands(random, (0.08, 0.2), (0.5, 0.9), (2, 8)))
    plan = Plan(speed, bends(random, time_s, 0.5) * np.minimum(speed, 1.0), holds_heading=False)
    motion = simulate(vehicles.car(), ground, plan)
    return record(world, seed, motion, Suite("pose", 5.0, 0.02, 0.02), random)


def skid_slopes(world: str, seed: int) -> Run:
    """Four wheels up and along slopes of up to 12 degrees at friction 0.28 to 0.7, with a ground radar (speed, 10 Hz, 0.03 m/s)."""
    random = np.random.default_rng([6, seed])
    slope = math.tan(math.radians(random.uniform(4, 12)))
    side = math.tan(math.radians(random.uniform(-8, 8)))
    ground = Ground(ramps=[(1.5, 14.0, slope)], side_slope=side, bands=bands(random, (0.28, 0.35), (0.4, 0.7), (1, 3)))
    motion = simulate(vehicles.four(), ground, straight(drives(random, times(), 0.4)), extent=(20.0, 5.0))
    return record(world, seed, motion, Suite("speed", 10.0, 0.03), random)


def sand_hills(random: np.random.Generator, steepest: float) -> Ground:
    """Gentle hills: slopes up to a limit (rad), lengths of 4 to 9 m."""
    waves = []
    for length in (4.0, 9.0):
        slope = 0.5 * math.tan(steepest) * random.uniform(0.5, 1)
        waves.append((slope * length / (2 * math.pi), 2 * math.pi / length, 0.0, random.uniform(0, 6)))
    return Ground(waves=waves)


def sand_four(world: str, seed: int) -> Run:
    """Four wheels over sand hills of up to 12 degrees with gentle bends; a camera against a map."""
    random = np.random.default_rng([7, seed])
    time_s = times()
    plan = Plan(drives(random, time_s, 0.25), bends(random, time_s, 0.12), turn_factor=1.2)
    motion = simulate(vehicles.four(), sand_hills(random, math.radians(12)), plan, Sand(random.uniform(0.6, 1.3)))
    return record(world, seed, motion, MAP_CAMERA, random)


def sand_five(world: str, seed: int) -> Run:
    """The five-wheeled robot over sand hills of up to 10 degrees: its free wheel sinks and skids too."""
    random = np.random.default_rng([8, seed])
    motion = simulate(vehicles.five(), sand_hills(random, math.radians(10)), straight(drives(random, times(), 0.2)), Sand(random.uniform(0.6, 1.3)))
    return record(world, seed, motion, Suite("free-wheel"), random)


def sand_dig(world: str, seed: int) -> Run:
    """Four wheels in sand pull a sled that grows heavier until they dig, and is let go after some seconds. A camera at 5 Hz."""
    random = np.random.default_rng([9, seed])
    time_s = times()
    sled, at = np.zeros(len(time_s)), random.uniform(4, 8)
    while at < LASTS_S - 6:
        grows, holds = random.uniform(2, 8), random.uniform(3, 6)
        most = random.uniform(15, 60)
        rise = np.clip((time_s - at) / grows, 0, 1)
        sled = np.where((time_s >= at) & (time_s < at + grows + holds), most * rise, sled)
        at += grows + holds + random.uniform(4, 8)
    speed = levels(random, time_s, (100, 101), lambda: 0.25, 0.5)
    plan = Plan(speed, np.zeros(len(time_s)), sled_n=lagged(sled, time_s, 0.2))
    motion = simulate(vehicles.four(), Ground(), plan, Sand(random.uniform(0.6, 1.3)))
    return record(world, seed, motion, Suite("pose", 5.0, 0.005, 0.01), random)


def turf_four(world: str, seed: int) -> Run:
    """Four wheels on wet grass with bends and a mower's drag of 5 to 25 N; visual odometry."""
    random = np.random.default_rng([10, seed])
    time_s = times()
    drag = levels(random, time_s, (3, 8), lambda: float(random.uniform(5, 25)), 0.5)
    plan = Plan(drives(random, time_s, 0.6), bends(random, time_s, 0.3), sled_n=drag, turn_factor=1.3)
    waves = [(0.05, 2 * math.pi / 6, 0.3, random.uniform(0, 6))]
    motion = simulate(vehicles.four(), Ground(waves=waves), plan, Turf(random.uniform(0.3, 0.5)))
    return record(world, seed, motion, ODOMETRY_CAMERA, random)
