"""Distances of the ground under a wheel, from the readings of a log."""

from __future__ import annotations

import dataclasses
import math
from typing import Tuple

import numpy as np

from slipbench.log import Floats, Log, Wheel

FREE_STEP_S = 0.1


@dataclasses.dataclass(frozen=True)
class Distances:
    """Distances of a wheel and of its centre over ground at the stamps of the reference. The noise of a difference has a part for each
    end and one that grows with the number of readings between.
    """

    time_s: Floats
    wheel: Floats
    ground: Floats
    piece: Floats  # number of the stretch without a loss; no distance is known between two
    wheel_sigma: float
    end_sigma: float
    step_sigma: float


def distances(log: Log, wheel: Wheel) -> Distances:
    reference, yaw = log.reference.known(), log.yaw()
    rolled = log.wheel_distance(wheel.name)
    # a count is up to a tick old
    tick = lambda one: 2 * math.pi * one.radius_m / one.ticks_per_turn / math.sqrt(12)
    end_sigma = step_sigma = 0.0
    piece = np.zeros(0)
    if reference.kind == "free-wheel":
        free = log.robot.free[0]
        time_s = np.arange(log.time_s[0], log.time_s[-1], FREE_STEP_S)
        at = lambda series: np.interp(time_s, log.time_s, series)
        ground = at(log.wheel_distance(free.name)) - at(yaw) * (wheel.y_m - free.y_m)
        end_sigma = tick(free)
    else:
        time_s = reference.time_s
        forward, left = travel(log)
        turned = np.interp(time_s, log.time_s, yaw)
        c, s = math.cos(wheel.heading_rad), math.sin(wheel.heading_rad)
        ground = c * (forward - turned * wheel.y_m) + s * (left + turned * wheel.x_m)
        if reference.kind == "pose":
            end_sigma = reference.sigma
        else:
            period = float(np.median(np.diff(time_s)))
            if reference.kind == "displacement":
                piece = np.cumsum(np.diff(time_s, prepend=time_s[0]) > 3 * period)
            step_sigma = reference.sigma * (period if reference.kind == "speed" else 1.0)
    piece = piece if len(piece) else np.zeros(len(time_s))
    return Distances(time_s, np.interp(time_s, log.time_s, rolled), ground, piece, tick(wheel), end_sigma, step_sigma)


def travel(log: Log) -> Tuple[Floats, Floats]:
    """The origin's distances forwards and to the left by the reference, at its stamps."""
    reference = log.reference.known()
    if reference.kind == "displacement":
        return np.cumsum(reference.values[:, 0]), np.cumsum(reference.values[:, 1])
    if reference.kind == "speed":
        speed = reference.values[:, 0]
        steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(reference.time_s)
        return np.concatenate([[0.0], np.cumsum(steps)]), np.zeros(len(speed))
    x, y, yaw = reference.values.T
    yaw = np.unwrap(yaw)
    middle = yaw[:-1] + 0.5 * np.diff(yaw)
    c, s, dx, dy = np.cos(middle), np.sin(middle), np.diff(x), np.diff(y)
    summed = lambda steps: np.concatenate([[0.0], np.cumsum(steps)])
    return summed(c * dx + s * dy), summed(c * dy - s * dx)
