"""Many Python threads at once; on free-threaded Python they run truly side by side."""

from __future__ import annotations

import sys
import sysconfig
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from grouser import InputError, drive, identify, logs, optimize, soils, terrain, wheel
from grouser.slip import Robot, Sample, SlipFilter

EXAMPLES = Path(__file__).parents[2] / "examples"
THREADS, ROUNDS = 8, 2
SAND = soils.find("dry-sand")
SIZE = {"radius_m": 0.125, "width_m": 0.1}
CONTACT = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
ROBOT = Robot.read(EXAMPLES / "five-wheel" / "robot.toml")
SCENARIO = drive.read(EXAMPLES / "scenarios" / "sandbox.toml")
MAPPER = terrain.SlipMapper(EXAMPLES / "robots" / "skid-steer.toml", soils.find("sandy-loam"), cell_m=1.0, headings=4)
SLIP = np.linspace(0.0, 0.9, 20_000)
SLIP.flags.writeable = False


@pytest.mark.skipif(not sysconfig.get_config_var("Py_GIL_DISABLED"), reason="this Python has a global lock")
def test_the_package_switches_no_lock_on() -> None:
    assert not getattr(sys, "_is_gil_enabled")()


def everywhere(call: Callable[[], Any]) -> list[Any]:
    """What every thread got, all of which begin at once."""
    start = threading.Barrier(THREADS)

    def work(_: int) -> list[Any]:
        start.wait()
        return [call() for _ in range(ROUNDS)]

    with ThreadPoolExecutor(THREADS) as pool:
        return [result for results in pool.map(work, range(THREADS)) for result in results]


def refused() -> str:
    try:
        wheel.Wheel(radius_m=-1.0, width_m=0.1)
    except InputError as error:
        return f"{error.field} {error.value} {error}"
    return ""


CALLS: dict[str, Callable[[], Any]] = {
    "batch": lambda: wheel.under_load(SAND, **SIZE, load_n=80.0, slip=SLIP).drawbar_pull_n.tobytes(),
    "curve": lambda: wheel.curve(SAND, CONTACT.wheel, load_n=80.0, slip=SLIP).torque_nm.tobytes(),
    "points": lambda: wheel.operating_points(CONTACT, load_n=80.0, slip=SLIP[:200], slip_angle_deg=5.0).side_force_n.tobytes(),
    "one point": lambda: repr(CONTACT.under_load(load_n=80.0, slip=0.2)),
    "soil": lambda: soils.Soil.from_toml(SAND.to_toml()) == SAND,
    "error": refused,
    "minimax": lambda: optimize.minimax(lambda x: [x[0] ** 2, (x[0] - 1.0) ** 2], start=[0.3], lower=-1.0, upper=1.0, starts=3).x.tobytes(),
    "problem": lambda: optimize.solve_file(EXAMPLES / "problems" / "pull-against-torque.toml").objectives.tobytes(),
    "identify": lambda: repr(identify.run(EXAMPLES / "bevameter" / "tests.toml").numbers),
    "log": lambda: logs.estimate(
        EXAMPLES / "five-wheel" / "log.csv", ROBOT, columns=EXAMPLES / "five-wheel" / "columns.toml"
    ).rows.slip.tobytes(),
    "drive": lambda: drive.run(SCENARIO, pilot="open-loop", duration_s=0.5).energy_j,
    "map": lambda: terrain.slip_map(MAPPER, 0.05 * np.sin(np.arange(80.0)).reshape(8, 10)).quantity("slip").tobytes(),
}


@pytest.mark.parametrize("name", CALLS)
def test_threads_get_what_one_gets(name: str) -> None:
    alone = CALLS[name]()
    assert set(everywhere(CALLS[name])) == {alone}


def test_an_object_under_way_is_one_thread_s() -> None:
    """Others that change it meanwhile are refused; it takes each sample whole or not at all."""
    filter_ = SlipFilter(ROBOT)
    taken = []

    def push(thread: int) -> None:
        for k in range(2000):
            try:
                filter_.update(Sample.wheel_count(time_ns=k * 1_000_000, wheel=thread % 5, count=k))
                filter_.latest()
                taken.append(1)
            except RuntimeError as error:
                assert "borrowed" in str(error)

    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(push, range(THREADS)))
    assert taken and np.isfinite(filter_.latest().forward_speed_mps.value)


def test_a_drive_is_advanced_by_one_thread_at_a_time() -> None:
    simulation = drive.Simulation(SCENARIO, pilot="open-loop")
    ended = []

    def advance(_: int) -> None:
        for _ in range(50):
            try:
                simulation.advance()
                ended.append(1)
            except RuntimeError as error:
                assert "borrowed" in str(error)

    with ThreadPoolExecutor(THREADS) as pool:
        list(pool.map(advance, range(THREADS)))
    # every period that was run is there, and no other
    assert len(simulation.result().track["time_s"]) == len(ended)
