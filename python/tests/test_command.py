"""The command from the wheel, and the same numbers through command and package."""

from __future__ import annotations

import csv
import importlib.metadata
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import grouser
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


# The table that the library (crates/terra/tests/reference_cases.rs) and the command (crates/cli/tests/command/batch.rs) are
# tested with: quadrature to 30 digits.
REFERENCE = ROOT / "crates" / "terra" / "tests" / "oracle" / "wheel_cases.csv"
INPUTS = ["kind", "soil", "radius_m", "width_m", "rebound", "slip"]
FORCES = ["vertical_force_n", "drawbar_pull_n", "torque_nm"]


def test_one_table_of_cases_through_every_door(tmp_path: Path) -> None:
    """Within 1e-9 by batch and by single points; the command's batch and the package's give the same bits."""
    with REFERENCE.open() as file:
        cases = list(csv.DictReader(file))
    assert len(cases) > 200
    given = []
    for case in cases:
        is_load = case["kind"] == "sinkage"
        row = [case[key] for key in INPUTS]
        given.append([*row, "" if is_load else case["sinkage_m"], case["vertical_force_n"] if is_load else ""])
    with (tmp_path / "in.csv").open("w", newline="") as file:
        csv.writer(file).writerows([[*INPUTS, "sinkage_m", "load_n"], *given])
    ended = run("batch", str(tmp_path / "in.csv"), "-o", str(tmp_path / "out.csv"))
    assert ended.returncode == 0, ended.stderr
    with (tmp_path / "out.csv").open() as file:
        printed = list(csv.DictReader(file))
    worst = 0.0
    for key in sorted({case["soil"] for case in cases}):
        soil = soils.find(key)
        for kind in ("forces", "sinkage"):
            rows = [k for k, case in enumerate(cases) if (case["soil"], case["kind"]) == (key, kind)]
            if not rows:
                continue
            number = {name: np.array([float(cases[k][name]) for k in rows]) for name in [*INPUTS[2:], "sinkage_m", *FORCES]}
            shared = {name: number[name] for name in INPUTS[2:]}
            if kind == "forces":
                found = wheel.at_sinkage(soil, **shared, sinkage_m=number["sinkage_m"])
            else:
                found = wheel.under_load(soil, **shared, load_n=number["vertical_force_n"])
            assert (found.status == 0).all()
            for name in ["sinkage_m", *FORCES]:
                np.testing.assert_array_equal(getattr(found, name), [float(printed[k][name]) for k in rows], err_msg=name)
            scale = np.max([abs(number[FORCES[0]]), abs(number[FORCES[1]]), abs(number[FORCES[2]]) / number["radius_m"]], axis=0)
            per = {"sinkage_m": number["sinkage_m"], FORCES[0]: scale, FORCES[1]: scale, FORCES[2]: scale * number["radius_m"]}
            for j, k in enumerate(rows):
                rim = wheel.Wheel(radius_m=shared["radius_m"][j], width_m=shared["width_m"][j])
                contact = wheel.WheelOnSoil(rim, soil.with_rebound(rebound=shared["rebound"][j]))
                slip = shared["slip"][j]
                if kind == "forces":
                    point = contact.at_sinkage(sinkage_m=number["sinkage_m"][j], slip=slip)
                else:
                    point = contact.under_load(load_n=number["vertical_force_n"][j], slip=slip)
                assert point is not None
                for name, scales in per.items():
                    exact = number[name][j]
                    for value in (getattr(point, name), getattr(found, name)[j]):
                        worst = max(worst, abs(value - exact) / scales[j])
    assert worst < 1e-9, worst


def test_the_version_is_that_of_the_distribution() -> None:
    assert grouser.__version__ == importlib.metadata.version("grouser")


def test_a_wheel_has_the_keys_of_the_command() -> None:
    listed = json.loads((ROOT / "crates" / "cli" / "tests" / "result_keys.json").read_text())["wheel"]
    lugged = wheel.Wheel(radius_m=0.125, width_m=0.1, grouser_height_m=0.01, grouser_count=12)
    contact = wheel.WheelOnSoil(lugged, soils.find("dry-sand"))
    result = contact.result(load_n=60.0, slip=0.2)
    assert set(listed["keys"]) - set(result) == set(listed["python"]["lacks"])
    assert set(result) - set(listed["keys"]) == set(listed["python"]["adds"])
    # the attributes of a point are the same numbers
    point = contact.under_load(load_n=60.0, slip=0.2)
    assert point is not None and {key: getattr(point, key) for key in result} == result
    # without a sinkage that carries the load there is no point, but a result
    heavy = contact.result(load_n=1e9, slip=0.2)
    assert contact.under_load(load_n=1e9, slip=0.2) is None
    assert heavy["status"] == "no-solution" and heavy["sinkage_m"] is None and 0.0 < heavy["max_load_n"] < 1e9
