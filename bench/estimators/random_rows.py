"""The logs of bench/random_logs.py, from seeds that nobody tunes on, also with each of its troubles."""

import pathlib
import sys

import numpy as np

from truth import Log, WheelRun

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import random_logs  # noqa: E402

FIRST, COUNT = 1000, 60
TROUBLED_FIRST, TROUBLED_COUNT = 1100, 10
PLAIN = ("random-plain", "random-plain-with-accelerometer", "random-plain-without")
EVERY = 50  # steps between two points: 0.1 s


def one(seed, trouble, folder):
    random = np.random.default_rng(seed)
    world = random_logs.World(random, trouble)
    log = random_logs.Log(world, random, folder, None, trouble)
    points = np.arange(int(random_logs.SETTLED_S / random_logs.STEP_S), len(world.time), EVERY)
    runs = []
    for wheel, name in enumerate(log.names):
        at = points[np.abs(world.rims[wheel][points]) >= random_logs.MIN_RIM_M_PER_S]
        naive = {f"trailing {window:g} s": [log.naive(wheel, world.time[i], window) for i in at] for window in (1.0, 2.0)}
        naive = {key: np.array([np.nan if value is None else value for value in values]) for key, values in naive.items()}
        runs.append(WheelRun(name, world.time[at], world.time[at], world.slips[wheel][at], np.zeros(len(at)), naive))
    if trouble:
        rows = (f"random-{trouble}",)
    else:
        rows = (PLAIN[0], PLAIN[1] if log.has_accelerometer else PLAIN[2])
    files = [folder / "wheels.csv", folder / "reference.csv"]
    name = f"random_{trouble or 'plain'}_{seed}"
    return Log(name, rows, folder, files, folder / "robot.toml", folder / "columns.toml", len(log.rows), runs)


def logs():
    for seed in range(FIRST, FIRST + COUNT):
        yield PLAIN, f"random_plain_{seed}", lambda folder, seed=seed: one(seed, None, folder)
    for trouble in random_logs.TROUBLES:
        for seed in range(TROUBLED_FIRST, TROUBLED_FIRST + TROUBLED_COUNT):
            make = lambda folder, seed=seed, trouble=trouble: one(seed, trouble, folder)
            yield (f"random-{trouble}",), f"random_{trouble}_{seed}", make
