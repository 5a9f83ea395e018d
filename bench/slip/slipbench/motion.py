"""The true motion of a robot, at 100 Hz, and the slips in it."""

from __future__ import annotations

import dataclasses
from typing import Dict, Optional

import numpy as np

from slipbench.log import Floats, Robot, Truth, slip_of

SAMPLE_S = 0.01
POINT_S = 0.1  # between points at which slips are compared, and the span of a true slip
SETTLED_S, END_S = 3.0, 1.0  # no points before (estimators settle) and after (windows end)
MIN_WHEEL_M_PER_S = 0.05  # slower wheels are not judged: a slip of a wheel that hardly turns decides nothing


@dataclasses.dataclass(frozen=True)
class Motion:
    """Series at `time_s`. `turned` is each encoder's angle, `rolled` and `ground` are each wheel's distance by its rotation in the
    world and that of its centre along the ground in its heading; `forward` and `left` are the origin's distances in the robot's frame.
    """

    robot: Robot
    time_s: Floats
    x: Floats
    y: Floats
    yaw: Floats
    forward: Floats
    left: Floats
    rates: Floats
    turned: Dict[str, Floats]
    rolled: Dict[str, Floats]
    ground: Dict[str, Floats]
    accelerations: Optional[Floats] = None
    links: Dict[str, Floats] = dataclasses.field(default_factory=dict)
    steering: Optional[Floats] = None

    def truth(self) -> Dict[str, Truth]:
        points = np.arange(SETTLED_S, self.time_s[-1] - END_S, POINT_S)
        found = {}
        for wheel in self.robot.powered:
            rolled, ground = (over(points, self.time_s, series[wheel.name]) for series in (self.rolled, self.ground))
            slip = slip_of(rolled, ground)
            judged = (np.abs(rolled) >= MIN_WHEEL_M_PER_S * POINT_S) & (np.abs(slip) <= 1)
            found[wheel.name] = Truth(points[judged], slip[judged])
        return found


def over(points: Floats, time_s: Floats, distance: Floats) -> Floats:
    """Change of a distance over the span around each point."""
    half = 0.5 * POINT_S
    return np.interp(points + half, time_s, distance) - np.interp(points - half, time_s, distance)
