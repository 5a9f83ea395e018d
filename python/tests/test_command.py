"""The command from the wheel, and the same numbers through command and package."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from grouser import soils, wheel

ROOT = Path(__file__).parents[2]


def run(*arguments: str, command: list[str] | None = None) -> subprocess.CompletedProcess[str]:
    command = command or [sys.executable, "-m", "grouser"]
    return subprocess.run([*command, *arguments], capture_output=True, text=True, cwd=ROOT, check=False)


def test_the_exit_codes_pass_through() -> None:
    assert run("--version").returncode == 0
    bad = run("wheel", "--soil", "lunar", "--radius-m", "-1", "--width-m", "0.1", "--load-n", "60", "--slip", "0.1")
    assert bad.returncode == 2 and "radius" in bad.stderr
    assert run("no-such-verb").returncode == 2
    heavy = run("wheel", "--soil", "lunar", "--radius-m", "0.1", "--width-m", "0.1", "--load-n", "1e9", "--slip", "0.1")
    assert heavy.returncode == 1


@pytest.mark.skipif(shutil.which("grouser") is None, reason="the console script is not on the PATH")
def test_the_console_script_is_the_command() -> None:
    script = run("--version", command=["grouser"])
    assert script.returncode == 0 and script.stdout == run("--version").stdout


# soil, radius, width, load, slip
CASES = [
    ("lunar", 0.125, 0.15, 65.0, 0.25),
    ("lunar", 0.125, 0.15, 65.0, -0.3),
    ("lunar", 0.125, 0.15, 65.0, 0.0),
    ("dry-sand", 0.125, 0.1, 80.0, 0.2),
    ("dry-sand", 0.05, 0.03, 5.0, 0.9),
    ("dry-sand", 0.3, 0.25, 900.0, 0.05),
]
KEYS = ["sinkage_m", "vertical_force_n", "drawbar_pull_n", "torque_nm", "theta_1_deg", "theta_2_deg", "energy_j_per_m"]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_command_and_the_package_give_the_same_bits(case: tuple[str, float, float, float, float]) -> None:
    key, radius, width, load, slip = case
    printed = run(
        "wheel", "--soil", key, "--radius-m", repr(radius), "--width-m", repr(width),
        "--load-n", repr(load), "--slip", repr(slip), "--json",
    )  # fmt: skip
    assert printed.returncode == 0, printed.stderr
    theirs = json.loads(printed.stdout)
    contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=radius, width_m=width), soils.find(key))
    point = contact.under_load(load_n=load, slip=slip)
    assert point is not None
    for name in KEYS:
        assert getattr(point, name) == theirs[name], name
    batch = wheel.under_load(soils.find(key), radius_m=radius, width_m=width, load_n=load, slip=slip)
    scale = max(load, abs(point.drawbar_pull_n), abs(point.torque_nm) / radius)
    assert abs(batch.drawbar_pull_n - point.drawbar_pull_n) < 1e-9 * scale
    assert abs(batch.torque_nm - point.torque_nm) < 1e-9 * scale
    assert abs(batch.sinkage_m - point.sinkage_m) < 1e-9 * radius


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_library_gives_the_same_bits(case: tuple[str, float, float, float, float]) -> None:
    """The command that cargo built, where `GROUSER_COMMAND` names it."""
    command = os.environ.get("GROUSER_COMMAND")
    if not command:
        pytest.skip("GROUSER_COMMAND names no command that cargo built")
    key, radius, width, load, slip = case
    arguments = ["wheel", "--soil", key, "--radius-m", repr(radius), "--width-m", repr(width)]
    arguments += ["--load-n", repr(load), "--slip", repr(slip), "--json"]
    ours, theirs = run(*arguments), run(*arguments, command=[command])
    for name in KEYS:
        assert json.loads(ours.stdout)[name] == json.loads(theirs.stdout)[name], name
