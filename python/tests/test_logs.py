"""Logs, the live engine and the filter: the same numbers as the command, and as each other."""

from __future__ import annotations

import copy
import csv
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from grouser import InputError, InputTypeError, logs
from grouser.slip import OnBoard, Robot, Sample, SlipFilter

ROOT = Path(__file__).parents[2]
FIVE = ROOT / "examples" / "five-wheel"
ROBOT = Robot.read(FIVE / "robot.toml")
COLUMNS = FIVE / "columns.toml"


def test_a_log_is_estimated_as_the_command_does(tmp_path: Path) -> None:
    result = logs.estimate(FIVE / "log.csv", ROBOT, columns=COLUMNS)
    out = tmp_path / "slip.csv"
    command = [sys.executable, "-m", "grouser", "estimate", str(FIVE / "log.csv"), "--robot", str(FIVE / "robot.toml")]
    ended = subprocess.run([*command, "-o", str(out)], capture_output=True, text=True, cwd=ROOT, check=False)
    assert ended.returncode in (0, 3), ended.stderr
    with out.open() as file:
        theirs = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(theirs) == len(result.rows.slip) == 5 * 2001
    ours, names = result.rows, ROBOT.wheels
    for k in range(0, len(theirs), 7):
        row = theirs[k]
        assert row["wheel"] == names[ours.wheel[k]]
        assert float(row["time_s"]) == ours.time_s[k]
        for column, value in (("slip", ours.slip[k]), ("slip_sigma", ours.slip_sigma[k])):
            if row[column]:
                assert float(row[column]) == value
            else:
                assert np.isnan(value)
        assert row["health"] == ours.health[k]


def test_known_slips_are_found() -> None:
    # it drives with a slip of 0.05 on firm ground and 0.35 in the soft patch, as it was made to
    result = logs.estimate([FIVE / "log.csv"], ROBOT, columns=str(COLUMNS))
    slip = result.summary["wheels"][0]["slip"]
    assert slip["median"] == pytest.approx(0.06, abs=0.01) and slip["p95"] > 0.33
    assert result.summary["status"] == "done" and result.summary["doubts"] == []


def test_samples_pushed_one_by_one_give_the_same_rows() -> None:
    samples = logs.read(FIVE / "log.csv", ROBOT, columns=COLUMNS)
    order = [ROBOT.wheels.index(name) for name in samples.wheels]
    engine = logs.Engine(ROBOT, reference="free-wheel", wheel_sensor="count")
    for time_ns, kind, wheel, numbers in zip(samples.time_ns, samples.kind, samples.wheel, samples.numbers):
        name = samples.kinds[kind]
        if name == "wheel-count":
            engine.push(Sample.wheel_count(time_ns=time_ns, wheel=order[wheel], count=int(numbers[0])))
        elif name == "yaw-rate":
            engine.push(Sample.yaw_rate(time_ns=time_ns, rate_rad_per_s=numbers[0]))
        else:
            pytest.fail(name)
    summary = engine.finish()
    pushed = engine.rows()
    whole = logs.estimate(FIVE / "log.csv", ROBOT, columns=COLUMNS, reference="free-wheel", wheel_sensor="count", online=True)
    np.testing.assert_array_equal(pushed.slip, whole.rows.slip)
    np.testing.assert_array_equal(pushed.slip_sigma, whole.rows.slip_sigma)
    assert summary["wheels"][0]["slip"] == whole.summary["wheels"][0]["slip"]
    with pytest.raises(InputError):
        engine.push(Sample.yaw_rate(time_ns=0, rate_rad_per_s=0.0))


def test_fixes_are_read_as_the_places_they_are(tmp_path: Path) -> None:
    table = tmp_path / "run.csv"
    rows = [f"{0.5 * k:.1f},{10 * k},{48.0 + 1e-5 * k:.7f},11.0" for k in range(20)]
    table.write_text("\n".join(["t,ticks,lat,lon", *rows]) + "\n")
    columns = tmp_path / "columns.toml"
    columns.write_text(
        """format = 1
[[table]]
time = { column = "t", unit = "s" }
columns = [
    { column = "ticks", meaning = "wheel_count", wheel = "front_left", unit = "tick" },
    { column = "lat", meaning = "latitude", unit = "deg" },
    { column = "lon", meaning = "longitude", unit = "deg" },
]
"""
    )
    samples = logs.read(table, ROBOT, columns=columns)
    _, wheels, numbers = samples.of_kind("position")
    assert len(numbers) >= 19 and set(wheels) == {-1}
    # a ten-millionth of 1e-5 degrees to the north is 1.1 m
    step = np.hypot(*np.diff(numbers[:, :2], axis=0).T)
    np.testing.assert_allclose(step, 1.11, atol=0.02)
    # no sample of any log is without its numbers
    assert not np.isnan(samples.numbers[:, 0]).any() and "other" not in samples.kinds


def test_the_filter_finds_a_slip_and_refuses_nonsense() -> None:
    slip_filter = SlipFilter(ROBOT)
    fifth = ROBOT.powered.index(False)
    for step in range(300):
        time_ns = step * 10_000_000
        for wheel in range(5):
            # radii and ticks differ: counts from the same rim speed, the fifth at 0.8 of it
            count = round((0.8 if wheel == fifth else 1.0) * 20 * step)
            assert slip_filter.update(Sample.wheel_count(time_ns=time_ns, wheel=wheel, count=count)) is None
        slip_filter.update(Sample.yaw_rate(time_ns=time_ns, rate_rad_per_s=0.0))
    estimate = slip_filter.latest()
    assert len(estimate.wheels) == 5 and estimate.forward_speed_mps.sigma > 0.0
    branch = copy.deepcopy(slip_filter)
    assert "wheel" in str(slip_filter.update(Sample.wheel_count(time_ns=10**10, wheel=77, count=1)))
    assert slip_filter.update(Sample.yaw_rate(time_ns=10**10, rate_rad_per_s=float("nan"))) is not None
    assert slip_filter.latest().rejected == branch.latest().rejected + 2
    assert slip_filter.latest().wheels == branch.latest().wheels
    silent = slip_filter.estimate_at(now_ns=10**11)
    assert silent.wheels[0].health.startswith("Invalid")
    with pytest.raises(InputError) as caught:
        slip_filter.set_steering_angle(9, angle_rad=0.1)
    assert caught.value.field == "wheel"


def test_the_computer_commands_every_wheel() -> None:
    computer = OnBoard(ROBOT, heading_rad=0.1)
    for step in range(300):
        time_ns = step * 10_000_000
        for wheel in range(5):
            computer.update(Sample.wheel_count(time_ns=time_ns, wheel=wheel, count=10 * step))
        computer.update(
            Sample.inertial(time_ns=time_ns, force_mps2=(0.0, 0.0, 9.81), rate_rad_per_s=(0.0, 0.0, 0.0))
        )
        commands = computer.tick(now_ns=time_ns, speed_mps=0.2, heading_rad=0.1)
        assert len(commands) == 5 and all(np.isfinite(command).all() for command in commands)
    assert computer.mode == "Forward" and len(computer.observations()) == 5
    assert copy.copy(computer).mode == computer.mode


def test_robots_and_samples_are_picklable() -> None:
    assert pickle.loads(pickle.dumps(ROBOT)) == ROBOT
    result = logs.estimate(FIVE / "log.csv", ROBOT, columns=COLUMNS, to_s=1.0)
    again = pickle.loads(pickle.dumps(result))
    np.testing.assert_array_equal(again.rows.slip, result.rows.slip)


@pytest.mark.parametrize(
    ("change", "kind", "field"),
    [
        ({"reference": "moon"}, InputError, "reference"),
        ({"wheel_sensor": "nose"}, InputError, "wheel_sensor"),
        ({"from_s": "early"}, InputTypeError, "from_s"),
        ({"from_s": float("nan")}, InputError, "from_s"),
    ],
)
def test_bad_choices_are_refused(change: dict[str, object], kind: type[Exception], field: str) -> None:
    with pytest.raises(kind) as caught:
        logs.estimate(FIVE / "log.csv", ROBOT, columns=COLUMNS, **change)  # type: ignore[arg-type]
    assert caught.value.field == field  # type: ignore[attr-defined]


def test_columns_beside_the_robot_file_are_used_as_the_command_does(tmp_path: Path) -> None:
    given = logs.estimate(FIVE / "log.csv", ROBOT, columns=COLUMNS, to_s=5.0)
    np.testing.assert_array_equal(logs.estimate(FIVE / "log.csv", ROBOT, to_s=5.0).rows.slip, given.rows.slip)
    again = pickle.loads(pickle.dumps(ROBOT))
    np.testing.assert_array_equal(logs.estimate(FIVE / "log.csv", again, to_s=5.0).rows.slip, given.rows.slip)
    alone = tmp_path / "robot.toml"
    alone.write_text((FIVE / "robot.toml").read_text())
    robot = Robot.read(alone)
    for call in (logs.estimate, logs.read):
        with pytest.raises(InputError, match="column map") as caught:
            call(FIVE / "log.csv", robot)
        assert caught.value.field == "columns"
        # a recording needs none
        call(FIVE / "log.mcap", robot)
        with pytest.raises(InputError, match="paths is empty") as caught:
            call([], robot)
        assert caught.value.field == "paths"
    # one that is damaged is an error of its own place
    (tmp_path / "columns.toml").write_text("format = 1\ntables = 3\n")
    with pytest.raises((InputError, InputTypeError), match="columns.toml:1"):
        Robot.read(alone)


def test_files_that_are_missing_or_damaged(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        logs.Robot.read("/no/such/robot.toml")
    with pytest.raises((OSError, InputError)):
        logs.estimate("/no/such/log.csv", ROBOT, columns=COLUMNS)
    broken = tmp_path / "log.csv"
    broken.write_text((FIVE / "log.csv").read_text()[:5000].replace("0", "x", 300))
    with pytest.raises(InputError):
        logs.estimate(broken, ROBOT, columns=COLUMNS)
    with pytest.raises(InputError, match="raduis_m"):
        logs.Robot.from_toml('format = 1\nname = "a"\n[[wheel]]\nname = "b"\nx_m = 0.0\ny_m = 0.0\ndrive = "powered"\nraduis_m = 0.1\n')
