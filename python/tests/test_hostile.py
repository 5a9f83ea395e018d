"""Random calls, forks, interrupts, memory: errors are typed, and nothing crashes or leaks."""

from __future__ import annotations

import gc
import multiprocessing
import os
import random
import resource
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from grouser import InputError, InputTypeError, drive, figures, identify, logs, optimize, soils, terrain, wheel
from grouser.slip import Robot, Sample, SlipFilter

SAND = soils.find("dry-sand")
SIZE = {"radius_m": 0.125, "width_m": 0.1}
EXAMPLES = Path(__file__).parents[2] / "examples"
MAPPER = terrain.SlipMapper(EXAMPLES / "robots" / "skid-steer.toml", soils.find("sandy-loam"), cell_m=1.0, headings=4)
MAP = terrain.slip_map(MAPPER, 0.05 * np.sin(np.arange(80.0)).reshape(8, 10))
SCENARIO = drive.read(EXAMPLES / "scenarios" / "sandbox.toml")
# ten times as many where time allows
CALLS = int(os.environ.get("GROUSER_RANDOM_CALLS", "20000"))

ROBOT = Robot.from_toml(
    """
format = 1
name = "bicycle"
[[wheel]]
name = "drive"
x_m = 0.3
y_m = 0.0
radius_m = 0.1
drive = "powered"
ticks_per_turn = 1000
[[wheel]]
name = "fifth"
x_m = -0.3
y_m = 0.0
radius_m = 0.1
drive = "free"
ticks_per_turn = 1000
"""
)


def value(rng: random.Random) -> Any:
    """Anything that a caller might pass by mistake, and much that is right."""
    return rng.choice(
        [
            lambda: rng.uniform(-1.0, 1.0),
            lambda: rng.uniform(0.0, 200.0),
            lambda: rng.choice([0.0, -0.0, 1.0, -1.0, 5e-324, 1.7e308, float("inf"), float("-inf"), float("nan")]),
            lambda: rng.randint(-(2**70), 2**70),
            lambda: rng.choice([None, True, "0.1", b"1", object(), {}, [], (), [[1.0], [1.0, 2.0]], 1j, wheel, len]),
            lambda: np.array([rng.uniform(0.0, 1.0) for _ in range(rng.randint(0, 4))]),
            lambda: np.full((rng.randint(0, 2), rng.randint(0, 3)), rng.uniform(0.0, 1.0))[::-1],
            lambda: np.array([rng.uniform(0.0, 1.0)] * 3, dtype=rng.choice(["f2", "f4", ">f8", "i4", "u1", "O", "c16", "U3"])),
            lambda: np.ma.masked_array([0.1, 0.2], mask=[True, False]),
            lambda: np.float32(rng.uniform(0.0, 1.0)),
        ]
    )()


def call(rng: random.Random) -> Any:
    v = lambda: value(rng)  # noqa: E731
    return rng.choice(
        [
            lambda: wheel.under_load(SAND, radius_m=v(), width_m=v(), load_n=v(), slip=v()),
            lambda: wheel.under_load(SAND, **SIZE, load_n=v(), slip=v(), rebound=v(), threads=rng.choice([None, 1, 2, v()])),
            lambda: wheel.at_sinkage(SAND, **SIZE, sinkage_m=v(), slip=v()),
            lambda: wheel.curve(SAND, wheel.Wheel(**SIZE), load_n=v(), slip=v()),
            lambda: wheel.Wheel(radius_m=v(), width_m=v(), grouser_height_m=v(), grouser_tip_share=v()),
            lambda: wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND).under_load(load_n=v(), slip=v(), slip_angle_deg=v()),
            lambda: wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND).at_sinkage(sinkage_m=v(), slip=v()),
            lambda: wheel.jacobian(wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND), load_n=v(), slip=v()),
            lambda: wheel.slip_from_speeds(forward_speed_mps=v(), rim_speed_mps=v()),
            lambda: soils.find(v(), k_shear_m=v()),
            lambda: soils.Soil(name=v(), n=v(), cohesion_kpa=v(), phi_deg=v(), shear=v()),
            lambda: soils.Soil.from_toml(v()),
            lambda: SAND.with_rebound(rebound=v()),
            lambda: Sample.wheel_count(time_ns=v(), wheel=v(), count=v()),
            lambda: Sample.pose(time_ns=v(), x_m=v(), y_m=v(), yaw_rad=v()),
            lambda: terrain.slip_map(MAPPER, v(), upper_left_m=v(), threads=v()),
            lambda: terrain.plan(MAP, start_m=v(), goal_m=v(), max_risk=v(), alternatives=v()),
            lambda: terrain.plan(MAP, start_m=(2.5, 2.5), goal_m=(v(), 5.5), max_slip=v(), goal_heading_deg=v()),
            lambda: terrain.SlipMapper(EXAMPLES / "robots" / "skid-steer.toml", SAND, cell_m=v(), headings=v(), seed=v(), soil_draws=v(), threads=v()),
            lambda: MAP.quantity(v()),
            lambda: drive.Simulation(SCENARIO, pilot=v(), seed=v()),
            lambda: figures.lines("a", "b", "c", figures.Line(v(), v(), "d")),
            lambda: optimize.minimax(lambda x: v(), start=v(), lower=v(), upper=v(), settings=optimize.Settings(max_values=20)),
        ]
    )()


@pytest.mark.filterwarnings("ignore:goal_heading_deg")
def test_random_calls_raise_nothing_but_typed_errors() -> None:
    rng = random.Random(2012)
    ended: dict[str, int] = {}
    filter_ = SlipFilter(ROBOT)
    for _ in range(CALLS):
        try:
            with np.errstate(all="ignore"):
                result = call(rng)
            if isinstance(result, Sample):
                filter_.update(result)
            kind = "done"
        except (TypeError, ValueError) as error:
            kind = type(error).__name__
            assert str(error)
        ended[kind] = ended.get(kind, 0) + 1
    # calls of every kind were made
    assert ended["done"] > CALLS // 20 and ended["InputError"] > CALLS // 50 and ended["InputTypeError"] > CALLS // 20
    assert np.isfinite(filter_.latest().forward_speed_mps.value)


def test_nothing_leaks() -> None:
    slip = np.linspace(0.0, 0.9, 2000)

    def work(n: int) -> None:
        for k in range(n):
            wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
            with pytest.raises(InputError):
                wheel.Wheel(radius_m=-1.0, width_m=0.1)
            with pytest.raises(InputTypeError):
                wheel.under_load(SAND, **SIZE, load_n="x", slip=slip)
            if k % 10 == 0:
                optimize.minimax(lambda x: [x[0] ** 2, (x[0] - 1.0) ** 2], start=[0.3])

    def resident() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * resource.getpagesize()

    work(100)
    gc.collect()
    before = resident()
    work(600)
    gc.collect()
    # 600 calls with 66 kB each would be 39 MB
    assert resident() - before < 8_000_000


def test_a_batch_is_interrupted() -> None:
    main = threading.main_thread().ident
    assert main is not None
    slip = np.full(3_000_000, 0.2)
    slip[::4] = -0.2  # braking points pass one by one: a minute of work
    timer = threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip)
    assert time.monotonic() - began < 15.0
    timer.join()


def test_the_interpreter_is_released() -> None:
    """Another thread counts on while a batch runs."""
    counts = [0]
    stop = threading.Event()

    def count() -> None:
        while not stop.is_set():
            counts[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    time.sleep(0.05)
    before = counts[0]
    wheel.under_load(SAND, **SIZE, load_n=80.0, slip=np.linspace(0.0, 0.9, 400_000), threads=1)
    during = counts[0] - before
    stop.set()
    thread.join()
    assert during >= 5


def _child(queue: Any) -> None:
    slip = np.linspace(0.0, 0.9, 100_000)
    batch = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip, threads=2)
    found = optimize.minimax(lambda x: [x[0] ** 2, (x[0] - 1.0) ** 2], start=[0.3], lower=-1.0, upper=1.0, starts=3)
    queue.put((float(batch.drawbar_pull_n.sum()), float(found.x[0])))


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_child_processes_compute_as_the_parent(method: str) -> None:
    # threads of the parent have run before
    slip = np.linspace(0.0, 0.9, 100_000)
    ours = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip, threads=2)
    optimize.minimax(lambda x: [x[0] ** 2, (x[0] - 1.0) ** 2], start=[0.3], lower=-1.0, upper=1.0, starts=3)
    context: Any = multiprocessing.get_context(method)
    queue = context.Queue()
    child = context.Process(target=_child, args=(queue,))
    child.start()
    total, x = queue.get(timeout=60.0)
    child.join(10.0)
    assert child.exitcode == 0
    assert total == float(ours.drawbar_pull_n.sum()) and abs(x - 0.5) < 1e-6


def test_what_does_not_fit_in_memory_is_a_memory_error() -> None:
    rows, columns = np.broadcast_arrays(np.zeros((10**7, 1)), np.zeros((1, 10**7)))
    with pytest.raises(MemoryError):
        wheel.under_load(SAND, **SIZE, load_n=rows, slip=columns)


def _long_calls() -> dict[str, Callable[[], object]]:
    contact = wheel.WheelOnSoil(wheel.Wheel(**SIZE), SAND)
    slope = np.linspace(0.0, 5.0, 200_000)
    rig = EXAMPLES / "five-wheel"

    def environments_reset() -> None:
        from grouser import environments

        environments.DriveVectorEnv(SCENARIO, num_envs=4096).reset(seed=1)

    def environments_step() -> None:
        from grouser import environments

        robots = environments.DriveVectorEnv(SCENARIO, num_envs=8, step_s=100.0)
        robots.reset(seed=1)
        robots.step(np.zeros(robots.action_space.shape))

    return {
        "operating_points": lambda: wheel.operating_points(contact, load_n=80.0, slip=slope / 10.0, slip_angle_deg=5.0),
        "slip_demand": lambda: wheel.slip_demand(contact, weight_n=80.0, slope_deg=slope),
        "slip_of_maximum_pull": lambda: wheel.slip_of_maximum_pull(contact, load_n=np.linspace(1.0, 100.0, 2_000_000)),
        "free_slip": lambda: wheel.free_slip(contact, load_n=np.linspace(1.0, 100.0, 200_000)),
        "jacobian": lambda: wheel.jacobian(contact, load_n=80.0, slip=slope / 10.0),
        "curve": lambda: wheel.curve(SAND, wheel.Wheel(**SIZE), load_n=80.0, slip=np.linspace(0.0, 0.9, 20_000_000)),
        "solve_file": lambda: optimize.solve_file(EXAMPLES / "problems" / "robust-wheel.toml"),
        "identify": lambda: identify.run(EXAMPLES / "bevameter" / "tests.toml"),
        "slip_map": lambda: terrain.slip_map(MAPPER, np.zeros((1500, 1500))),
        "plan": lambda: terrain.plan(MAP, start_m=(2.5, 2.5), goal_m=(6.5, 5.5)),
        "estimate": lambda: logs.estimate(
            rig / "log.csv", logs.Robot.read(rig / "robot.toml"), columns=rig / "columns.toml"
        ),
        "environments reset": environments_reset,
        "environments step": environments_step,
    }


@pytest.mark.parametrize("name", _long_calls())
def test_ctrl_c_ends_every_long_call(name: str) -> None:
    if name.startswith("environments"):
        pytest.importorskip("gymnasium")
    call = _long_calls()[name]
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.2, lambda: signal.pthread_kill(main, signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while time.monotonic() - began < 60.0:
            call()
    assert time.monotonic() - began < 10.0
    timer.join()
