"""Drives, with our controller and with one written in Python on the same seeds."""

from __future__ import annotations

import json
import math
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from grouser import InputError, InputTypeError, drive, slip

ROOT = Path(__file__).parents[2]
SANDBOX = ROOT / "examples" / "scenarios" / "sandbox.toml"
SCENARIO = drive.read(SANDBOX)


def test_a_drive_is_that_of_the_command() -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "grouser", "drive", str(SANDBOX), "--json"],
        capture_output=True, text=True, cwd=ROOT, check=False,
    )  # fmt: skip
    assert ended.returncode in (0, 3), ended.stderr
    found = json.loads(ended.stdout)
    ours = drive.run(SCENARIO)
    text = json.dumps(found)
    assert ours.outcome in text
    assert repr(ours.energy_j) in text and repr(ours.distance_m) in text


def test_a_drive_that_plans_its_way_is_refused_and_not_driven_otherwise() -> None:
    with pytest.raises(InputError) as caught:
        drive.read(SANDBOX.with_name("plan-and-learn.toml"))
    assert caught.value.field == "plan" and "grouser drive" in str(caught.value)


def test_the_settings_of_a_scenario_are_those_of_the_on_board_computer(tmp_path: Path) -> None:
    """Wheels whose counters stand are no reason; a lean beyond the limit that the scenario gives is one."""
    text = SANDBOX.read_text().replace("../", f"{SANDBOX.parents[1]}/")
    path = tmp_path / "s.toml"
    assert "[control]" not in text
    path.write_text(text + "\n[control]\nmost_tilt_deg = 12\noptimum = 0.2\n")
    control = drive.read(path).control
    assert control["most_tilt_deg"] == pytest.approx(12.0, rel=1e-15) and control["optimum"] == 0.2
    assert SCENARIO.control["optimum"] == SCENARIO.optimum_slip
    robot = slip.Robot.read(ROOT / "examples" / "robots" / "skid-steer.toml")
    with pytest.raises(InputError) as unknown:
        slip.OnBoard(robot, tilt=1.0)
    assert unknown.value.field == "tilt" and "most_tilt_deg" in str(unknown.value)

    def mode(**settings: float) -> str:
        computer = slip.OnBoard(robot, **settings)
        force = (0.0, 9.81 * math.sin(math.radians(15.0)), 9.81 * math.cos(math.radians(15.0)))
        for k in range(300):
            time_ns = k * 10_000_000
            computer.update(slip.Sample.inertial(time_ns=time_ns, force_mps2=force, rate_rad_per_s=(0.0, 0.0, 0.0)))
            for wheel in range(len(robot.wheels)):
                computer.update(slip.Sample.wheel_count(time_ns=time_ns, wheel=wheel, count=k))
            computer.tick(now_ns=time_ns, speed_mps=0.1, heading_rad=0.0)
            if computer.decision and "leans" in computer.decision:
                return "leans"
        return computer.mode

    assert mode(**control) == "leans" and mode() != "leans"


def open_loop(seen: drive.Observation) -> list[drive.WheelCommand]:
    return [drive.WheelCommand(seen.requested_speed_mps) for _ in seen.wheels]


def test_the_same_seed_is_the_same_drive() -> None:
    one = drive.run(SCENARIO, controller=open_loop, seed=5, duration_s=4.0)
    two = drive.run(SCENARIO, controller=open_loop, seed=5, duration_s=4.0)
    other = drive.run(SCENARIO, controller=open_loop, seed=6, duration_s=4.0)
    for key, column in one.track.items():
        np.testing.assert_array_equal(column, two.track[key])
    assert one.energy_j != other.energy_j
    assert one.distance_m > 0.05


def test_a_controller_in_python_limits_the_slip() -> None:
    """A proportional law on the estimated slip, against open loop on the same seeds."""

    def careful(seen: drive.Observation) -> list[drive.WheelCommand]:
        slips = [wheel.slip for wheel in seen.wheels if wheel.slip is not None and wheel.torque_share is not None]
        mean = float(np.mean(slips)) if slips else 0.0
        speed = seen.requested_speed_mps * float(np.clip(1.0 - 4.0 * (mean - 0.1), 0.2, 1.0))
        return [drive.WheelCommand(speed) for _ in seen.wheels]

    for seed in (1, 2):
        ours = drive.run(SCENARIO, controller=careful, seed=seed, duration_s=6.0)
        plain = drive.run(SCENARIO, controller=open_loop, seed=seed, duration_s=6.0)
        # the commands reach the wheels, which are slower
        assert ours.distance_m < 0.8 * plain.distance_m
        assert ours.track["slip"].shape == (600, len(SCENARIO.wheels))


def test_standing_still_stands_still() -> None:
    still = drive.run(SCENARIO, controller=lambda seen: [drive.WheelCommand(0.0)] * len(seen.wheels), duration_s=3.0)
    assert abs(still.distance_m) < 0.02 and still.outcome == "time-out"


class Boom(Exception):
    pass


def test_an_exception_in_a_controller_passes_through() -> None:
    def bad(seen: drive.Observation) -> list[drive.WheelCommand]:
        if seen.time_s > 0.1:
            raise Boom
        return open_loop(seen)

    with pytest.raises(Boom):
        drive.run(SCENARIO, controller=bad)


@pytest.mark.parametrize(
    ("commands", "kind"),
    [
        ([], InputError),
        ([(0.1,)], InputError),
        ([(float("nan"),)] * 5, InputError),
        ([(0.1, -1.0)] * 5, InputError),
        ([(0.1, 1.0, 99.0)] * 5, InputError),
        ([0.1] * 5, InputTypeError),
        ([("fast",)] * 5, InputTypeError),
        ([None] * 5, InputTypeError),
    ],
)
def test_bad_commands_are_refused(commands: list[object], kind: type[Exception]) -> None:
    simulation = drive.Simulation(SCENARIO, pilot="open-loop")
    simulation.advance()
    with pytest.raises(kind):
        simulation.command(commands)
    assert simulation.advance()


@pytest.mark.parametrize(
    ("keys", "kind"),
    [
        ({"pilot": "autopilot"}, InputError),
        ({"seed": -1}, InputError),
        ({"seed": 1.5}, InputTypeError),
        ({"duration_s": float("nan")}, InputError),
        ({"duration_s": "long"}, InputTypeError),
        ({"controller": 3}, InputTypeError),
    ],
)
def test_bad_drives_are_refused(keys: dict[str, object], kind: type[Exception]) -> None:
    with pytest.raises(kind):
        drive.run(SCENARIO, **keys)  # type: ignore[arg-type]


def test_ctrl_c_ends_a_drive() -> None:
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.3, lambda: signal.pthread_kill(main, signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        while True:
            drive.run(SCENARIO)
    assert time.monotonic() - began < 5.0
    timer.join()


def test_scenarios_are_picklable() -> None:
    again = pickle.loads(pickle.dumps(SCENARIO))
    a = drive.run(again, pilot="open-loop", duration_s=1.5)
    assert a.energy_j == drive.run(SCENARIO, pilot="open-loop", duration_s=1.5).energy_j
    assert pickle.loads(pickle.dumps(a)).energy_j == a.energy_j
