"""Robotino, three omni wheels: its overhead camera as reference and as truth, and the camera's path thinned to poses at 5 Hz."""

import csv
import gzip
import math

import numpy as np

from truth import Distances, Log, WheelRun, centre_distance, displacements, naive_series, over_windows, sliding, text, write_map, write_table

GEAR, RADIUS_M = 16.0, 0.04
WHEELS = [(f"m{i + 1}", (0.125 * math.cos(math.radians(a)), 0.125 * math.sin(math.radians(a))), math.radians(a + 90)) for i, a in enumerate((60, 180, 300))]
FROM_S = 4.0  # the start is stationary, and the longer mean needs two seconds (crates/replay/tests/measured_poses.rs)
UNTIL_END_S = 1.5
MIN_SPEED_M_PER_S = 0.03  # wheels slower than this on average are across the course and have no slip to compare
MIN_WHEEL_M = 0.005
# A picture is up to one row of 31 ms old: uniform, 9 ms. Stationary, the camera scatters by 0.3 mm.
CAMERA_TIME_SIGMA_S, CAMERA_SIGMA_M = 0.031 / math.sqrt(12), 0.0003
POSE_PERIOD_S, POSE_SIGMA_M, YAW_SIGMA_RAD = 0.2, 0.002, 0.005
POSE_SPAN_S = 0.5
SEEDS = 3  # of the thinned poses, for each log


def read(path):
    with gzip.open(path, "rt") as lines:
        rows = list(csv.reader(lines, delimiter=";"))
    names = rows[2][:-1]
    values = np.array([[float(value) for value in row[: len(names)]] for row in rows[3:]])
    column = lambda name: values[:, names.index(name)]
    time_s = 1e-3 * column("t")
    forward, left, turn = 1e-3 * column("dx"), 1e-3 * column("dy"), np.radians(column("dang"))
    forward[0] = left[0] = turn[0] = 0.0
    rates = [column(f"m{i}vel") for i in (1, 2, 3)]
    return time_s, rates, forward, left, turn


def distances_of(time_s, rates, moved):
    """Of each wheel: a rate holds since the reading before."""
    since = np.diff(time_s, prepend=time_s[0])
    for (name, place, heading), rate in zip(WHEELS, rates):
        wheel = np.cumsum(since * RADIUS_M * rate / GEAR)
        yield name, place, heading, Distances(time_s, wheel, centre_distance(*moved, place, heading))


def sigma_of(wheel, centre, span_s):
    """Standard deviation of a window's true slip."""
    at_ends = np.hypot(CAMERA_SIGMA_M, CAMERA_TIME_SIGMA_S * np.abs(centre) / span_s)
    return math.sqrt(2) * at_ends / np.abs(wheel)


def run_of(name, distances, readings, span_s, step_s):
    """True slips over windows; of a slow wheel only those of the row high-slip, where it is fast enough at times."""
    end_s = distances.time_s[-1]
    is_slow = abs(distances.wheel[-1]) < MIN_SPEED_M_PER_S * end_s
    until_s = FROM_S - 1.0 if is_slow else end_s - UNTIL_END_S
    begins, ends, slip, wheel, centre = sliding(distances, FROM_S, until_s, span_s, MIN_WHEEL_M, step_s)
    series = naive_series(readings, distances.time_s, MIN_WHEEL_M)
    naive = {key: over_windows(distances.time_s, values, begins, ends) for key, values in series.items()}
    high_begins, high_ends, high, wheel_1, centre_1 = sliding(distances, 0.5, end_s - 0.5, 1.0, 4 * MIN_WHEEL_M)
    high = (0.5 * (high_begins + high_ends), high, sigma_of(wheel_1, centre_1, 1.0))
    return WheelRun(name, begins, ends, slip, sigma_of(wheel, centre, span_s), naive, high)


def full(path, folder, shipped, surfaces):
    """The camera's displacement in each row, and true slips over each second: consistency with the camera alone."""
    time_s, rates, *moved = read(path)
    runs = []
    for name, _, _, distances in distances_of(time_s, rates, moved):
        runs.append(run_of(name, distances, distances, 1.0, 1.0))
    robot, column_map = folder / "robot.toml", folder / "columns.toml"
    robot.write_text((shipped / "robot.toml").read_text())
    column_map.write_text((shipped / "columns.toml").read_text())
    return Log(path.name.split(".")[0], (f"robotino-full-{surfaces}", "high-slip-full"), folder, [path], robot, column_map, len(time_s), runs)


def thinned(path, folder, shipped, surfaces, seed):
    """A noisy pose of the camera's path each fifth of a second; the camera at its full rate is the truth, over half a second."""
    time_s, rates, *moved = read(path)
    forward, left, turn = moved
    yaw = np.cumsum(turn)
    middle = yaw - 0.5 * turn
    x = np.cumsum(np.cos(middle) * forward - np.sin(middle) * left)
    y = np.cumsum(np.sin(middle) * forward + np.cos(middle) * left)
    random = np.random.default_rng(seed)
    due = np.arange(0.0, time_s[-1], POSE_PERIOD_S)
    at = np.unique(np.searchsorted(time_s - time_s[0], due))
    at = at[at < len(time_s)]
    pose = [np.full(len(time_s), np.nan) for _ in range(3)]
    for out, true, sigma in zip(pose, (x, y, yaw), (POSE_SIGMA_M, POSE_SIGMA_M, YAW_SIGMA_RAD)):
        out[at] = true[at] + sigma * random.normal(size=len(at))
    columns = {"t": text(time_s, 6)} | {f"m{i + 1}": text(rate, 6) for i, rate in enumerate(rates)}
    columns |= {name: text(values, 6) for name, values in zip(("x", "y", "yaw"), pose)}
    write_table(folder / "log.csv", columns)
    meanings = [(f"m{i}", "wheel_rate", "rad/s", f"m{i}") for i in (1, 2, 3)]
    meanings += [("x", "pose_x", "m", None), ("y", "pose_y", "m", None), ("yaw", "pose_yaw", "rad", None)]
    write_map(folder / "columns.toml", meanings)
    robot = (shipped / "robot.toml").read_text().replace('"displacement"', '"pose"')
    robot = robot.replace("position_sigma_m = 0.001", f"position_sigma_m = {POSE_SIGMA_M}")
    (folder / "robot.toml").write_text(robot)
    seen = displacements(*(values[at] for values in pose))
    runs = []
    for name, place, heading, distances in distances_of(time_s, rates, moved):
        readings = Distances(time_s[at], distances.wheel[at], centre_distance(*seen, place, heading))
        runs.append(run_of(name, distances, readings, POSE_SPAN_S, 0.1))
    rows = (f"robotino-5hz-{surfaces}", "high-slip-5hz")
    name = f"{path.name.split('.')[0]}_5hz_{seed}"
    return Log(name, rows, folder, [folder / "log.csv"], folder / "robot.toml", folder / "columns.toml", len(time_s), runs)


def logs(data, shipped):
    """(rows, name, function that writes the log into a folder)"""
    for kind, surfaces in (("robotino", "one"), ("robotino-two-surfaces", "two")):
        for path in sorted((data / kind).glob("*.csv.gz")):
            name = path.name.split(".")[0]
            yield (f"robotino-full-{surfaces}", "high-slip-full"), name, lambda folder, path=path, s=surfaces: full(path, folder, shipped, s)
            for seed in range(SEEDS):
                make = lambda folder, path=path, s=surfaces, seed=seed: thinned(path, folder, shipped, s, seed)
                yield (f"robotino-5hz-{surfaces}", "high-slip-5hz"), f"{name}_5hz_{seed}", make
