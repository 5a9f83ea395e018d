"""What an entrant reads, what it returns, and what was true.

Units are SI, angles in radians. Frame: x forwards, y to the left, z up; heading, yaw rate and steering are positive to the left,
pitch and the angles of links with the nose down (right-handed about y).
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Dict, Literal, Optional, Tuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[Any]
ReferenceKind = Literal["pose", "displacement", "speed", "free-wheel"]


@dataclasses.dataclass(frozen=True)
class Wheel:
    """A wheel as its owner describes it. `link` carries it; None: the chassis."""

    name: str
    x_m: float
    y_m: float
    radius_m: float
    ticks_per_turn: float
    is_powered: bool = True
    is_steered: bool = False
    heading_rad: float = 0.0  # in which it drives
    width_m: float = 0.1
    link: Optional[str] = None


@dataclasses.dataclass(frozen=True)
class Link:
    """A rocker or arm that turns about an axis across the robot."""

    name: str
    pivot_m: Tuple[float, float, float]
    on: Optional[str] = None
    opposite: Optional[str] = None


@dataclasses.dataclass(frozen=True)
class Robot:
    """The description that a team has of its robot. Masses serve entrants that need them."""

    name: str
    wheels: Tuple[Wheel, ...]
    links: Tuple[Link, ...] = ()
    mass_kg: float = 10.0
    cg_z_m: float = 0.25
    origin_z_m: float = 0.0  # height over the ground of the point whose motion a reference reads

    @property
    def powered(self) -> Tuple[Wheel, ...]:
        return tuple(wheel for wheel in self.wheels if wheel.is_powered)

    @property
    def free(self) -> Tuple[Wheel, ...]:
        return tuple(wheel for wheel in self.wheels if not wheel.is_powered)

    def wheel(self, name: str) -> Wheel:
        return next(wheel for wheel in self.wheels if wheel.name == name)

    def chain(self, wheel: Wheel) -> Tuple[str, ...]:
        """Names of the links between a wheel and the chassis."""
        found, link = [], wheel.link
        while link is not None:
            found.append(link)
            link = next(one for one in self.links if one.name == link).on
        return tuple(found)


@dataclasses.dataclass(frozen=True)
class Reference:
    """Readings of the robot's motion over ground at the robot's origin, with the noise that the sensor's data sheet states.

    `pose`: values x, y, yaw in a fixed frame. `displacement`: forward, left, turn since the previous row, in the frame halfway; NaN where
    the sensor lost track.
    `speed`: forward. `free-wheel`: no readings; the free wheels are the reference.
    """

    kind: ReferenceKind
    time_s: Floats
    values: Floats  # one row a reading
    sigma: float  # m of a pose, m of a displacement, m/s of a speed
    yaw_sigma: float = 0.01

    def known(self) -> Reference:
        """Without the rows in which the sensor lost track."""
        rows = np.isfinite(self.values).all(axis=1)
        return dataclasses.replace(self, time_s=self.time_s[rows], values=self.values[rows])


@dataclasses.dataclass(frozen=True)
class Log:
    """One drive as recorded. All series but the reference's are at `time_s`; a count of NaN was not received.

    `accelerations` are specific forces forward, left, up; `rates` roll, pitch, yaw. `links` has the measured angle of each link. Of an
    odometer the logger kept distances, not pulses: its counts are of tenths of a millimetre.
    """

    robot: Robot
    time_s: Floats
    counts: Dict[str, Floats]
    rates: Optional[Floats]
    rate_sigma: float
    reference: Reference
    accelerations: Optional[Floats] = None
    links: Dict[str, Floats] = dataclasses.field(default_factory=dict)
    steering: Optional[Floats] = None
    is_odometer: bool = False

    def wheel_distance(self, name: str) -> Floats:
        """Distance that a wheel has rolled relative to the world, by its counts, its links and the pitch rate."""
        wheel = self.robot.wheel(name)
        counts = self.counts[name]
        known = np.isfinite(counts)
        filled = np.interp(self.time_s, self.time_s[known], counts[known])
        angle = filled / wheel.ticks_per_turn * 2 * math.pi
        chain = self.robot.chain(wheel)
        if chain and self.links and self.rates is not None:
            carried = sum((self.links[link] for link in chain), np.zeros(len(angle)))
            steps = np.diff(self.time_s, prepend=self.time_s[0])
            angle = angle + carried + np.cumsum(steps * self.rates[:, 1])
        return wheel.radius_m * angle

    def yaw(self) -> Floats:
        """The gyro, summed up; without one the reference's yaw."""
        if self.rates is None:
            known = self.reference.known()
            turns = known.values[:, 2]
            yaw = np.unwrap(turns) if known.kind == "pose" else np.cumsum(turns)
            return np.asarray(np.interp(self.time_s, known.time_s, yaw))
        steps = np.diff(self.time_s, prepend=self.time_s[0])
        return np.cumsum(steps * self.rates[:, 2])


@dataclasses.dataclass(frozen=True)
class Truth:
    """True slip of a wheel at points in time: over the 0.1 s around each."""

    time_s: Floats
    slip: Floats


@dataclasses.dataclass(frozen=True)
class Run:
    """A log and what was true. `sigma` is the truth's own standard deviation where it was measured."""

    world: str
    seed: int
    fault: str
    log: Log
    truth: Dict[str, Truth]
    sigma: float = 0.0


@dataclasses.dataclass(frozen=True)
class Series:
    """An entrant's slips of one wheel. An interval of NaN is not stated."""

    time_s: Floats
    slip: Floats
    low: Floats
    high: Floats


Estimates = Dict[str, Series]


def slip_of(wheel: npt.ArrayLike, ground: npt.ArrayLike) -> Floats:
    """1 - ground/wheel where the wheel is faster, wheel/ground - 1 where the robot is: in [-1, 1] unless both differ in sign."""
    one, other = np.broadcast_arrays(np.asarray(wheel, dtype=float), np.asarray(ground, dtype=float))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(np.abs(other) <= np.abs(one), 1 - other / one, one / other - 1))
