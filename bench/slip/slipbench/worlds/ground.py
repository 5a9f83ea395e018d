"""Ground: height, friction, and two laws of soft ground that push the wheels in place of MuJoCo's contacts."""

from __future__ import annotations

import dataclasses
import math
from typing import List, Protocol, Sequence, Tuple

import numpy as np

from slipbench.log import Floats


@dataclasses.dataclass
class Ground:
    """Waves, each amplitude, wave numbers and phase; a ramp along x that rises between two places; friction in bands along x."""

    waves: List[Tuple[float, float, float, float]] = dataclasses.field(default_factory=list)
    ramps: List[Tuple[float, float, float]] = dataclasses.field(default_factory=list)  # begin, end, slope between them
    side_slope: float = 0.0
    bands: List[Tuple[float, float]] = dataclasses.field(default_factory=lambda: [(-math.inf, 0.8)])  # begins at x, friction

    def height(self, x: Floats, y: Floats) -> Floats:
        z = self.side_slope * y + 0.0 * x
        for amplitude, along, across, phase in self.waves:
            z = z + amplitude * np.sin(along * x + across * y + phase)
        for begin, end, slope in self.ramps:
            z = z + slope * rounded(x - begin) - slope * rounded(x - end)
        return z

    def gradient(self, x: Floats, y: Floats) -> Tuple[Floats, Floats]:
        along, across = 0.0 * x, self.side_slope + 0.0 * x
        for amplitude, number_x, number_y, phase in self.waves:
            steep = amplitude * np.cos(number_x * x + number_y * y + phase)
            along, across = along + number_x * steep, across + number_y * steep
        for begin, end, slope in self.ramps:
            along = along + slope * (rounded_slope(x - begin) - rounded_slope(x - end))
        return along, across

    def friction(self, x: float) -> float:
        return [value for begin, value in self.bands if begin <= x][-1]


CORNER_M = 0.3


def rounded(x: Floats) -> Floats:
    """max(x, 0) with a round corner, so that a wheel rolls over it."""
    return 0.5 * (x + np.sqrt(x * x + CORNER_M * CORNER_M))


def rounded_slope(x: Floats) -> Floats:
    return 0.5 * (1 + x / np.sqrt(x * x + CORNER_M * CORNER_M))


@dataclasses.dataclass(frozen=True)
class Push:
    """Of each wheel: normal force, force forwards, moment against its rotation, force against its motion to the side."""

    normal: Floats
    pull: Floats
    moment: Floats
    aside: Floats


class SoftGround(Protocol):
    """A law. `forces` is for wheels of the sizes that `prepare` got; `rate` is the speed of sinking."""

    relaxation_m: float
    rolling: float  # resistance over load, as a moment about the axle

    def prepare(self, sizes: Sequence[Tuple[float, float]]) -> None: ...

    def forces(self, sinkage: Floats, rate: Floats, slip: Floats, side: Floats) -> Push: ...

    def dig_rate(self, slip_speed: Floats) -> Floats: ...


class Sand:
    """Wong and Reece (1967): radial and shear stress along the contact of a rigid wheel, integrated here into a table over sinkage and
    slip. Dry sand of Wong, *Theory of Ground Vehicles*: n 1.1, k_c 0.99 kN/m^2.1, k_phi 1528 kN/m^3.1, c 1.04 kPa, phi 28 degrees;
    K 25 mm, c_1 0.18, c_2 0.32. The strength is scaled per run. In addition a spinning wheel digs: its rut deepens by 2 % of the
    distance that it slips and is left behind with travel (photographs of rovers that dug in show ruts of half a radius after a few turns).
    """

    rolling = 0.0  # the stresses include the resistance
    relaxation_m = 0.06  # half of a contact length: stresses build up over it
    exponent, k_c, k_phi = 1.1, 990.0, 1528e3
    cohesion, tan_phi, shear_m = 1040.0, math.tan(math.radians(28)), 0.025
    c_1, c_2 = 0.18, 0.32
    dig_share = 0.02
    table_slips = np.linspace(-1, 1, 41)
    table_depths = np.linspace(0, 0.8, 49)  # over the radius

    def __init__(self, strength: float) -> None:
        self.strength = strength

    def dig_rate(self, slip_speed: Floats) -> Floats:
        return self.dig_share * np.abs(slip_speed)

    def prepare(self, sizes: Sequence[Tuple[float, float]]) -> None:
        distinct = {size: stress_table(self, *size) for size in dict.fromkeys(sizes)}
        self.tables = np.stack([distinct[size] for size in sizes], axis=1)
        self.radius = np.array([radius for radius, _ in sizes])
        self.wheels = np.arange(len(sizes))

    def forces(self, sinkage: Floats, rate: Floats, slip: Floats, side: Floats) -> Push:
        row = np.clip(sinkage / self.radius / self.table_depths[1], 0, len(self.table_depths) - 1.001)
        column = np.clip((slip + 1) / (self.table_slips[1] + 1), 0, len(self.table_slips) - 1.001)
        i, j = row.astype(int), column.astype(int)
        a, b = row - i, column - j
        t, w = self.tables, self.wheels
        picked = (1 - a) * ((1 - b) * t[:, w, i, j] + b * t[:, w, i, j + 1]) + a * ((1 - b) * t[:, w, i + 1, j] + b * t[:, w, i + 1, j + 1])
        # sand yields: sinking faster costs a little more, rising presses less
        normal = picked[0] * np.clip(1 + 5 * rate, 0, 2)
        return Push(normal, picked[1], picked[2], normal * self.tan_phi * (1 - np.exp(-np.abs(side) / 0.2)) * np.sign(side))


def stress_table(sand: Sand, radius: float, width: float) -> Floats:
    """Normal force, pull and torque over sinkage and slip."""
    entry = np.arccos(1 - sand.table_depths)[:, None, None]
    slip = np.clip(sand.table_slips, -0.98, 1)[None, :, None]
    theta = entry * (np.arange(80) + 0.5) / 80  # exit at the lowest point: no rebound in dry sand
    peak = np.clip(sand.c_1 + sand.c_2 * np.abs(slip), 0, 0.9) * entry
    mirrored = entry - theta / np.maximum(peak, 1e-9) * (entry - peak)
    height = radius * np.maximum(np.cos(np.where(theta > peak, theta, mirrored)) - np.cos(entry), 0)
    sigma = sand.strength * (sand.k_c / width + sand.k_phi) * height**sand.exponent
    # v / (r omega): 1 - s driving, 1 / (1 + s) braking
    ratio = np.where(slip >= 0, 1 - slip, 1 / (1 + np.minimum(slip, 0)))
    shear = radius * ((entry - theta) - ratio * (np.sin(entry) - np.sin(theta)))
    strength = sand.strength * sand.cohesion + sigma * sand.tan_phi
    tau = np.sign(shear) * strength * (1 - np.exp(-np.abs(shear) / sand.shear_m))
    area = radius * width * entry / 80
    normal = (area * (sigma * np.cos(theta) + tau * np.sin(theta))).sum(axis=2)
    pull = (area * (tau * np.cos(theta) - sigma * np.sin(theta))).sum(axis=2)
    return np.stack([normal, pull, (radius * area * tau).sum(axis=2)])


class Turf:
    """The magic formula (Pacejka), F = D sin(C atan(B s - E (B s - atan B s))), over the load, on a firm and elastic sward with rolling
    resistance. Wet grass: peak friction 0.3 to 0.5, rolling resistance 0.06 of the load (tyres on grassland).
    """

    relaxation_m = 0.08
    b, c, e = 8.0, 1.5, 0.3
    rolling, stiffness, damping = 0.06, 12e3, 250.0

    def __init__(self, peak: float) -> None:
        self.peak = peak

    def prepare(self, sizes: Sequence[Tuple[float, float]]) -> None:
        self.radius = np.array([radius for radius, _ in sizes])

    def dig_rate(self, slip_speed: Floats) -> Floats:
        return 0.0 * slip_speed

    def forces(self, sinkage: Floats, rate: Floats, slip: Floats, side: Floats) -> Push:
        normal = np.where(sinkage > 0, np.maximum(self.stiffness * sinkage + self.damping * rate, 0), 0.0)
        # slip and drift share the peak along their common direction
        total = np.hypot(slip, side)
        steep = self.b * total
        curve = np.sin(self.c * np.arctan(steep - self.e * (steep - np.arctan(steep))))
        both = self.peak * normal * curve / np.maximum(total, 1e-6)
        return Push(normal, both * slip, self.radius * both * slip, both * side)
