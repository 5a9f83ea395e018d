"""Robot-seconds a second of `grouser.environments`: 64 robots of a scenario, everything included (dynamics, sensors,
estimator, observations), on all cores and on one.

    python bench/environments.py [SCENARIO.toml]

needs the package and gymnasium.
"""

import os
import sys
import time
from pathlib import Path

import numpy as np

from grouser import drive, environments

ROBOTS, STEPS, STEP_S = 64, 20, 0.1


def rate(scenario, threads):
    robots = environments.DriveVectorEnv(scenario, num_envs=ROBOTS, step_s=STEP_S, threads=threads)
    began = time.perf_counter()
    robots.reset(seed=1)
    start = time.perf_counter() - began
    action = np.zeros(robots.action_space.shape)
    action[..., 0] = 0.15
    # they come to rest on the soil first
    for _ in range(5):
        robots.step(action)
    began, busy = time.perf_counter(), time.process_time()
    for _ in range(STEPS):
        robots.step(action)
    wall, busy = time.perf_counter() - began, time.process_time() - busy
    simulated = ROBOTS * STEPS * STEP_S
    return simulated / wall, simulated / busy, start / ROBOTS


def main():
    examples = Path(__file__).parents[1] / "examples" / "scenarios"
    paths = sys.argv[1:] or [examples / "sandbox.toml", examples / "slope.toml"]
    for path in paths:
        scenario = drive.read(path)
        for threads in (1, os.cpu_count()):
            found, of_processor, start = rate(scenario, threads)
            print(
                f"{Path(path).stem}, {len(scenario.wheels)} wheels, {threads} threads: {found:.0f} robot-seconds a second, "
                f"{of_processor:.0f} a second of processor time, "
                f"{1e3 * start:.1f} ms to begin a drive; load {os.getloadavg()[0]:.1f}"
            )


if __name__ == "__main__":
    main()
