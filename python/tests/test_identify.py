"""Identification: the soil that the tests were made with."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from grouser import identify, soils

ROOT = Path(__file__).parents[2]
BEVAMETER = ROOT / "examples" / "bevameter"


def test_the_true_soil_lies_in_the_intervals() -> None:
    found = identify.run(BEVAMETER / "tests.toml")
    truth = soils.read(BEVAMETER / "truth.toml")
    known = [name for name in found.numbers if hasattr(truth, name)]
    assert "n" in known and len(known) >= 3
    inside = 0
    for name in known:
        number = found.numbers[name]
        assert number.verdict
        low = number.low if number.low is not None else -float("inf")
        high = number.high if number.high is not None else float("inf")
        inside += low <= getattr(truth, name) <= high
    assert inside >= len(known) - 1  # 95 % intervals


def test_the_command_finds_the_same_bits() -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "grouser", "identify", str(BEVAMETER / "tests.toml"), "--json"],
        capture_output=True, text=True, cwd=ROOT, check=False,
    )  # fmt: skip
    assert ended.returncode in (0, 3), ended.stderr
    theirs = json.dumps(json.loads(ended.stdout))
    found = identify.run(BEVAMETER / "tests.toml")
    assert repr(found.numbers["n"].value) in theirs


def test_a_missing_job() -> None:
    with pytest.raises(FileNotFoundError):
        identify.run("/no/such/job.toml")


def test_a_mistake_in_a_unit_is_a_doubt(tmp_path: Path) -> None:
    assert identify.run(BEVAMETER / "tests.toml").doubts == []
    rows = (BEVAMETER / "plates.csv").read_text().replace("force_n", "force_kn")
    (tmp_path / "plates.csv").write_text(rows)
    (tmp_path / "tests.toml").write_text('format = 1\nname = "x"\n[[plate]]\ntable = "plates.csv"\n')
    doubts = identify.run(tmp_path / "tests.toml").doubts
    assert "the force of the plate tests is in N, not kN" in doubts[0]
