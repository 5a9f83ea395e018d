"""Measured robots, where copies of the public logs are present (`slipbench.fetch`).

The camera or motion capture at its full rate is the truth, over 0.5 s; the entrants get a pose of it at 5 Hz with noise added. The
fast car of DART is not here: its encoder reports speeds, held and late, and bench/estimators of Grouser judges it.
"""

from __future__ import annotations

import gzip
import math
import pathlib
from typing import Callable, Dict, List, Tuple

import numpy as np

from slipbench.log import Floats, Log, Reference, Robot, Run, Truth, Wheel, slip_of
from slipbench.motion import MIN_WHEEL_M_PER_S

SPAN_S, FROM_S, UNTIL_END_S = 0.5, 4.0, 1.5
POSE_HZ, POSE_SIGMA_M, YAW_SIGMA_RAD = 5.0, 0.002, 0.005


def reader(path: pathlib.Path, delimiter: str, header_lines: int) -> Dict[str, Floats]:
    """Columns by the names in the last line of the header. Plain or gzip."""
    text = (gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()).decode()
    lines = text.splitlines()
    names = lines[header_lines - 1].strip(delimiter).split(delimiter)
    rows = [[float(cell) for cell in line.split(delimiter)[: len(names)]] for line in lines[header_lines:] if line]
    return dict(zip(names, np.array(rows).T))


def summed(dx: Floats, dy: Floats, turn: Floats, wheel: Wheel) -> Floats:
    """Distance of a wheel's centre along its heading, from displacements in the robot's frame."""
    c, s = math.cos(wheel.heading_rad), math.sin(wheel.heading_rad)
    return np.cumsum(c * (dx - turn * wheel.y_m) + s * (dy + turn * wheel.x_m))


def in_frame(x: Floats, y: Floats, yaw: Floats) -> Tuple[Floats, Floats, Floats]:
    """Displacements between poses, in the frame halfway."""
    dx, dy, turn = (np.diff(one, prepend=one[0]) for one in (x, y, np.unwrap(yaw)))
    middle = yaw - 0.5 * turn
    return np.cos(middle) * dx + np.sin(middle) * dy, np.cos(middle) * dy - np.sin(middle) * dx, turn


def truths(time_s: Floats, rolled: Dict[str, Floats], ground: Dict[str, Floats]) -> Dict[str, Truth]:
    points = np.arange(FROM_S, time_s[-1] - UNTIL_END_S, 0.1)
    found = {}
    for name in rolled:
        over = lambda series: np.interp(points + SPAN_S / 2, time_s, series) - np.interp(points - SPAN_S / 2, time_s, series)
        wheel, robot = over(rolled[name]), over(ground[name])
        slip = slip_of(wheel, robot)
        judged = (np.abs(wheel) >= MIN_WHEEL_M_PER_S * SPAN_S) & (np.abs(slip) <= 1)
        found[name] = Truth(points[judged], slip[judged])
    return found


def thinned(time_s: Floats, x: Floats, y: Floats, yaw: Floats, random: np.random.Generator) -> Reference:
    at = np.unique(np.searchsorted(time_s, np.arange(time_s[0], time_s[-1], 1 / POSE_HZ)))
    noise = lambda sigma: sigma * random.normal(size=len(at))
    values = np.stack([x[at] + noise(POSE_SIGMA_M), y[at] + noise(POSE_SIGMA_M), yaw[at] + noise(YAW_SIGMA_RAD)], axis=1)
    return Reference("pose", time_s[at], values, POSE_SIGMA_M, YAW_SIGMA_RAD)


def robotino(world: str, seed: int, path: pathlib.Path) -> Run:
    """Three omni wheels on table, lino and carpet (BrOleg5/research-wheel-slippage). Encoders of 2000 ticks before a gear of 16."""
    table = reader(path, ";", 3)
    time_s = 1e-3 * table["t"]
    dx, dy, turn = 1e-3 * table["dx"], 1e-3 * table["dy"], np.radians(table["dang"])
    dx[0] = dy[0] = turn[0] = 0.0
    wheels = []
    for i, degrees in enumerate((60, 180, 300)):
        a = math.radians(degrees)
        wheels.append(Wheel(f"m{i + 1}", 0.125 * math.cos(a), 0.125 * math.sin(a), 0.04, 32000, heading_rad=a + math.pi / 2))
    counts = {f"m{i}": table[f"m{i}pos"] for i in (1, 2, 3)}
    rolled = {wheel.name: counts[wheel.name] / 32000 * 2 * math.pi * 0.04 for wheel in wheels}
    ground = {wheel.name: summed(dx, dy, turn, wheel) for wheel in wheels}
    yaw = np.cumsum(turn)
    middle = yaw - 0.5 * turn
    x, y = np.cumsum(np.cos(middle) * dx - np.sin(middle) * dy), np.cumsum(np.sin(middle) * dx + np.cos(middle) * dy)
    reference = thinned(time_s, x, y, yaw, np.random.default_rng([21, seed]))
    log = Log(Robot("robotino", tuple(wheels), mass_kg=20.0), time_s, counts, None, 0.0, reference)
    # a picture is up to one row of 31 ms old (9 ms) and scatters by 0.3 mm: 0.026 of slip over 0.5 s, at 0.1 to 0.3 m/s alike
    return Run(world, seed, path.name.split("_surface")[0], log, truths(time_s, rolled, ground), 0.026)


def optiodom(world: str, seed: int, path: pathlib.Path) -> Run:
    """A differential robot in a motion capture room (sousarbarb/optiodom), hardly slipping."""
    table = reader(path, ",", 1)
    time_s = table["time_s"]
    ticks = 64 * 43.7
    wheels = tuple(Wheel(side, 0.0, y, 0.042, ticks) for side, y in (("left", 0.1), ("right", -0.1)))
    counts = {wheel.name: np.round(table[f"{wheel.name}_ticks"]) for wheel in wheels}
    rolled = {wheel.name: table[f"{wheel.name}_ticks"] / ticks * 2 * math.pi * 0.042 for wheel in wheels}
    moved = in_frame(table["x_m"], table["y_m"], np.unwrap(table["yaw_rad"]))
    ground = {wheel.name: summed(*moved, wheel) for wheel in wheels}
    reference = thinned(time_s, table["x_m"], table["y_m"], np.unwrap(table["yaw_rad"]), np.random.default_rng([22, seed]))
    log = Log(Robot("optiodom", wheels, mass_kg=5.0), time_s, counts, None, 0.0, reference)
    # motion capture scatters by 0.2 mm; both clocks agree to a tenth of a row (5 ms, assumed)
    return Run(world, seed, "none", log, truths(time_s, rolled, ground), 0.015)


def plaza(world: str, seed: int, path: pathlib.Path) -> Run:
    """A lawn mower on firm grass that does not slip (gtrll/gpslam): every slip is an error. Satellite poses as they are."""
    table = reader(path, ",", 1)
    time_s = table["time_s"]
    wheel = Wheel("wheels", 0.0, 0.0, 0.3, round(2 * math.pi * 0.3 / 1e-4))
    counts = {"wheels": np.round(table["distance_m"] / 1e-4)}
    values = np.stack([table["x_m"], table["y_m"], np.unwrap(table["yaw_rad"])], axis=1)
    zeros = np.zeros(len(time_s))
    reference = Reference("pose", time_s, values, 0.02, math.radians(1.0))
    rates = np.stack([zeros, zeros, table["yaw_rate_rad_s"]], axis=1)
    log = Log(Robot("mower", (wheel,), mass_kg=100.0), time_s, counts, rates, 0.003, reference, is_odometer=True)
    points = np.arange(FROM_S, time_s[-1] - UNTIL_END_S, 0.1)
    over = lambda series: np.interp(points + 0.5, time_s, series) - np.interp(points - 0.5, time_s, series)
    forward = np.cumsum(in_frame(values[:, 0], values[:, 1], values[:, 2])[0])
    # the distance has no sign, and the mower reverses near 1407 s
    points = points[(over(table["distance_m"]) > 0.3) & (over(forward) > 0.5 * over(table["distance_m"]))]
    return Run(world, seed, "none", log, {"wheels": Truth(points, np.zeros(len(points)))}, 0.0006)


MEASURED: Dict[str, Tuple[str, Callable[[str, int, pathlib.Path], Run]]] = {
    "robotino": ("robotino", robotino),
    "robotino-two": ("robotino-two-surfaces", robotino),
    "optiodom": ("optiodom", optiodom),
    "plaza": ("plaza", plaza),
}


def files(data: pathlib.Path, world: str) -> List[pathlib.Path]:
    folder, _ = MEASURED[world]
    return sorted(path for path in (data / folder).glob("*.csv*") if path.is_file())
