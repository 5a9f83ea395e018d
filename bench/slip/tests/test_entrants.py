"""Entrants on a robot whose slip is known and steady."""

from __future__ import annotations

import csv
import gzip
import pathlib

import numpy as np
import pytest

from slipbench import fetch, report, run, score
from slipbench.entrants import ENTRANTS, grouser
from slipbench.log import Log, Run
from slipbench.sensors import Suite, record
from slipbench.worlds import kinematic
from tests.test_worlds import straight

PYTHON_ENTRANTS = [name for name in ENTRANTS if not name.startswith("grouser") and name != "ratio"]


def steady(kind: str) -> Run:
    return record("w", 0, straight(0.25), Suite(kind, 10.0, 0.002, 0.003), np.random.default_rng(2))  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["pose", "displacement", "speed"])
@pytest.mark.parametrize("name", PYTHON_ENTRANTS)
def test_a_steady_slip_is_found(name: str, kind: str) -> None:
    one = steady(kind)
    result = score.of_run(one, ENTRANTS[name].estimate(one.log))["w"]
    assert result.answered == result.points
    assert (result.square / result.answered) ** 0.5 < (0.1 if name == "ekf" else 0.05)
    assert result.held / result.stated > 0.6


def test_the_free_wheel_serves_all_that_use_it() -> None:
    one = kinematic.random_free("w", 7)
    assert one.fault == "none"
    for name in ("ratio", "trailing-1", "ekf"):
        results = score.of_run(one, ENTRANTS[name].estimate(one.log))
        assert sum(wheel.answered for wheel in results.values()) > 0.9 * sum(wheel.points for wheel in results.values()), name
        assert sum(wheel.square for wheel in results.values()) / sum(wheel.answered for wheel in results.values()) < 0.2**2, name


def test_the_ratio_needs_a_free_wheel() -> None:
    assert ENTRANTS["ratio"].estimate(steady("pose").log) == {}


def test_a_causal_entrant_does_not_look_ahead() -> None:
    one = kinematic.random_camera("w", 3)
    cut_s = 20.0
    log = one.log
    rows, readings = log.time_s <= cut_s, log.reference.time_s <= cut_s
    assert log.rates is not None
    reference = type(log.reference)(log.reference.kind, log.reference.time_s[readings], log.reference.values[readings], log.reference.sigma, log.reference.yaw_sigma)
    counts = {name: series[rows] for name, series in log.counts.items()}
    short = Log(log.robot, log.time_s[rows], counts, log.rates[rows], log.rate_sigma, reference)
    wheel = log.robot.powered[0].name
    for name in PYTHON_ENTRANTS:
        if not ENTRANTS[name].is_causal:
            continue
        whole, part = ENTRANTS[name].estimate(log)[wheel], ENTRANTS[name].estimate(short)[wheel]
        same = part.time_s < cut_s - 0.5
        slips = np.interp(part.time_s[same], whole.time_s, whole.slip)
        np.testing.assert_allclose(slips, part.slip[same], atol=1e-9, err_msg=name)


def test_what_grouser_reads(tmp_path: pathlib.Path) -> None:
    one = kinematic.random_camera("w", 2)
    files = grouser.write(one.log, tmp_path)
    with files[0].open() as table:
        rows = list(csv.DictReader(table))
    assert len(rows) == len(one.log.time_s)
    name = one.log.robot.wheels[0].name
    lost = [row[f"{name}_ticks"] == "" for row in rows]
    assert one.fault == "lost-rows" and lost == np.isnan(one.log.counts[name]).tolist()
    text = (tmp_path / "robot.toml").read_text()
    assert f'reference = "{one.log.reference.kind}"' in text and text.count("[[wheel]]") == len(one.log.robot.wheels)


@pytest.mark.skipif(grouser.command() is None, reason="no command grouser")
def test_grouser_finds_a_steady_slip() -> None:
    for is_online in (True, False):
        one = steady("pose")
        result = score.of_run(one, grouser.estimate(one.log, is_online))["w"]
        assert result.answered > 0.9 * result.points and (result.square / result.answered) ** 0.5 < 0.05


def test_the_whole_way_to_a_table_and_a_page() -> None:
    todo = run.tasks(["random-free"], range(2), None)
    found = list(run.results(todo, ["trailing-1", "ratio"], 1))
    scores = run.grouped(found, lambda one: one.world)
    assert "random-free" in report.as_text(scores) and "90 % hold" in report.as_text(scores)
    lines = report.as_tsv(scores, "head").splitlines()
    assert len(lines) == 4 and all(len(line.split("\t")) == len(lines[1].split("\t")) for line in lines[1:])
    page = report.as_page(found, "a & b")
    assert "a &amp; b" in page and page.count("<table>") == page.count("</table>") == 2


def test_an_entrant_that_fails_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(log: Log) -> None:
        raise ValueError("no")

    monkeypatch.setitem(ENTRANTS, "fails", type(ENTRANTS["ekf"])(fails, True, ""))  # type: ignore[arg-type]
    result = run.do(run.Task("random-free", 0, None), ["fails"])
    one = score.of_world([result.outcomes["fails"]])
    assert one.failed == 1 and one.answered == 0 and one.points > 0


def test_a_changed_file_is_no_reference(tmp_path: pathlib.Path) -> None:
    path, _, digest = next(fetch.listed())
    changed = tmp_path / "a.csv.gz"
    changed.write_bytes(gzip.compress(b"something else"))
    assert not fetch.check(changed, digest)
    assert len(list(fetch.listed())) == 27
