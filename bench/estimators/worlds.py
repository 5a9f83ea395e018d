"""Logs of the five-wheeled robot: the shipped scenarios by `grouser drive`, and the same robot in MuJoCo where that is installed.

Truth is the simulations' own. The logs of a drive are judged twice: as MCAP with all sensors, and as the table of a simple logger.
"""

import csv
import importlib.util
import json
import math
import pathlib
import subprocess
import sys

import numpy as np

import entrants
from truth import Distances, Log, WheelRun, naive_series, write_map

SCENARIOS = sorted(path.stem for path in (entrants.ROOT / "examples" / "scenarios").glob("*.toml"))
ROBOT = entrants.ROOT / "examples" / "robots" / "five-wheel.toml"
TICKS = 3840
# Radius in m, and how far to the left in m, as in the robot file.
WHEELS = {name: (0.15, side * 0.25) for name, side in (("front_left", 1), ("front_right", -1), ("rear_left", 1), ("rear_right", -1))}
WHEELS["fifth"] = (0.12, 0.0)
FREE_RADIUS_M, FREE_TICKS = 0.10, 2000
# The bare ratio of counts, over the windows that a robot might use.
WINDOWS = {f"{kind} {span:g} s": (span, kind == "centred") for kind in ("trailing", "centred") for span in (0.25, 0.5, 1.0)}
FROM_S, POINT_S = 2.0, 0.1
MIN_SPEED_M_PER_S = 0.05  # wheels slower than this are not judged, as in the loop's own figure (docs/drive.md)
# The same robot in MuJoCo: amplitude of the waves in m, and friction. At 0.2 the wheels slip on crests, by up to 0.5.
MUJOCO = {"mujoco-waves": (0.125, 1.0), "mujoco-slippery": (0.125, 0.2)}


class Skipped(Exception):
    """What a row needs is not installed."""


def counts(table, name):
    """Without the wrapping of 32 bits."""
    steps = np.diff(table[f"{name}_ticks"])
    return np.concatenate([[0.0], np.cumsum((steps + 2**31) % 2**32 - 2**31)])


def read_numbers(path):
    with path.open() as lines:
        names = next(csv.reader(lines))
        rows = np.array([[float(cell or "nan") if is_number(cell) else math.nan for cell in row] for row in csv.reader(lines)])
    return dict(zip(names, rows.T))


def is_number(cell):
    return cell[-1:].isdigit() or not cell


def wheel_runs(table, true_at):
    """Runs of the powered wheels, from the table of a simple logger and the true slip of a wheel at times."""
    time_s = 1e-3 * table["time_ms"]
    free_m = counts(table, "free") / FREE_TICKS * 2 * math.pi * FREE_RADIUS_M
    gyro = np.concatenate([[0.0], np.cumsum(table["gyro_z_rad_per_s"][1:] * np.diff(time_s))])
    points = np.arange(FROM_S, time_s[-1] - 1.0, POINT_S)
    runs = []
    for name, (radius_m, side_m) in WHEELS.items():
        wheel_m = counts(table, name) / TICKS * 2 * math.pi * radius_m
        speed = np.interp(points, time_s, wheel_m) - np.interp(points - POINT_S, time_s, wheel_m)
        true = true_at(name, points)
        at = (np.abs(speed) > MIN_SPEED_M_PER_S * POINT_S) & np.isfinite(true)
        readings = Distances(time_s, wheel_m, free_m - gyro * side_m)
        naive = naive_series(readings, points[at], 0.005, WINDOWS)
        runs.append(WheelRun(name, points[at], points[at], true[at], np.zeros(at.sum()), naive))
    return runs


def topic(grouser_log, name, folder):
    out = folder / f"{name.strip('/').replace('/', '_')}.csv"
    command = [entrants.GROUSER, "log", "convert", grouser_log, out, "--topic", name]
    subprocess.run(command, check=True, capture_output=True)
    return out


def slips_at(path, points):
    """Of each wheel: slips and healths of a topic of slips at points, the last at or before each."""
    with path.open() as lines:
        rows = list(csv.DictReader(lines))
    time_s = np.array([1e-9 * float(row["time_ns"]) for row in rows])
    at = np.maximum(np.searchsorted(time_s, points + 1e-6, side="right") - 1, 0)
    found = {}
    for i in range(len(WHEELS) + 1):
        slips = np.array([float(rows[k][f"slip[{i}]"] or "nan") for k in at])
        found[rows[0][f"name[{i}]"]] = slips, np.array([rows[k][f"health[{i}]"] for k in at])
    return found


def drive(scenario, kind, folder):
    if not entrants.GROUSER.exists():
        raise Skipped("skipped: no grouser, cargo build --release -p grouser")
    mcap, table = folder / "drive.mcap", folder / "drive.csv"
    path = entrants.ROOT / "examples" / "scenarios" / f"{scenario}.toml"
    command = [entrants.GROUSER, "drive", path, "-o", mcap, "-o", table, "--json"]
    done = subprocess.run(command, capture_output=True, text=True)
    if not done.stdout.strip():
        raise Skipped(done.stderr.strip())
    numbers = read_numbers(table)
    if "free_ticks" not in numbers:
        raise Skipped("skipped: another robot")
    truth_path = topic(mcap, "/simulation/truth/slip", folder)
    runs = wheel_runs(numbers, lambda name, points: slips_at(truth_path, points)[name][0])
    loop_path = topic(mcap, "/grouser/slip", folder)
    errors = []
    for run in runs:
        slips, healths = slips_at(loop_path, run.begin_s)[run.wheel]
        errors.append((slips - run.slip)[(healths == "Ok") & np.isfinite(slips)])
    files = [mcap if kind == "mcap" else table]
    log = Log(f"drive_{kind}_{scenario}", (f"drive-{kind}-{scenario}",), folder, files, ROBOT, None, len(numbers["time_ms"]), runs)
    rmse = np.mean([np.sqrt(np.mean(one**2)) for one in errors if len(one)])
    log.extra = {"loop": float(rmse), "loop_printed": json.loads(done.stdout)["runs"][-1]["slip_rmse"]}
    return log


def mujoco(name, world, folder):
    if importlib.util.find_spec("mujoco") is None:
        raise Skipped("skipped: mujoco is not installed")
    script = pathlib.Path(__file__).parent / "mujoco_five_wheel.py"
    subprocess.run([sys.executable, script, *map(str, world)], check=True, cwd=folder, capture_output=True)
    table, truth = read_numbers(folder / "mj.csv"), read_numbers(folder / "mj_truth.csv")
    true_at = lambda wheel, points: np.interp(points, truth["time_s"], truth[f"{wheel}_slip"], np.nan, np.nan)
    columns = [(f"{wheel}_ticks", "wheel_count", "tick", wheel) for wheel in [*WHEELS, "free"]]
    write_map(folder / "columns.toml", [*columns, ("gyro_z_rad_per_s", "yaw_rate", "rad/s", None)], "time_ms", "ms")
    runs = wheel_runs(table, true_at)
    return Log(name, (name,), folder, [folder / "mj.csv"], ROBOT, folder / "columns.toml", len(table["time_ms"]), runs)


def logs():
    for kind in ("mcap", "csv"):
        for scenario in SCENARIOS:
            make = lambda folder, kind=kind, scenario=scenario: drive(scenario, kind, folder)
            yield (f"drive-{kind}-{scenario}",), f"drive_{kind}_{scenario}", make
    for name, world in MUJOCO.items():
        yield (name,), name, lambda folder, name=name, world=world: mujoco(name, world, folder)
