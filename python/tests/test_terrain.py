"""Slip maps and ways: the command's numbers, whatever the tiles."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from grouser import InputError, InputTypeError, soils, terrain

EXAMPLES = Path(__file__).parents[2] / "examples"
DUNES = EXAMPLES / "terrain" / "dunes.asc"
ROBOT = EXAMPLES / "robots" / "skid-steer.toml"
LOAM = soils.find("sandy-loam")
INTERVALS = 'format = 1\nsource = "made up"\nphi_deg = { low = 27.5, high = 30.5 }\n'


def command(*words: str | Path) -> str:
    arguments = [sys.executable, "-m", "grouser", *map(str, words)]
    return subprocess.run(arguments, capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module")
def heights() -> npt.NDArray[np.float64]:
    found: npt.NDArray[np.float64] = np.loadtxt(DUNES, skiprows=6)
    return np.where(found == -9999.0, np.nan, found)


@pytest.fixture(scope="module")
def mapper() -> terrain.SlipMapper:
    return terrain.SlipMapper(ROBOT, LOAM, cell_m=1.0, headings=4)


@pytest.fixture(scope="module")
def whole(mapper: terrain.SlipMapper, heights: npt.NDArray[np.float64]) -> terrain.SlipMap:
    return terrain.slip_map(mapper, heights)


def equal(a: terrain.SlipMap, b: terrain.SlipMap) -> None:
    assert a.shape == b.shape
    for name in terrain.QUANTITIES:
        np.testing.assert_array_equal(a.quantity(name), b.quantity(name), err_msg=name)


def test_a_map_has_the_command_s_numbers(whole: terrain.SlipMap, tmp_path: Path) -> None:
    target = tmp_path / "map.tif"
    command("map", DUNES, "--robot", ROBOT, "--soil", "sandy-loam", "--headings", "4", "-o", target)
    read = terrain.read(target)
    equal(whole, read)
    assert (read.cell_m, read.robot, read.soil_draws) == (1.0, whole.robot, 0)
    assert np.isfinite(read.quantity("slip")).mean() > 0.5


def test_probabilities_have_the_command_s_numbers(heights: npt.NDArray[np.float64], tmp_path: Path) -> None:
    intervals, target = tmp_path / "intervals.toml", tmp_path / "map.tif"
    intervals.write_text(INTERVALS)
    words = ["--soil-intervals", intervals, "--soil-draws", "5", "--seed", "3", "--gravity-m-per-s2", "3.72"]
    command("map", DUNES, "--robot", ROBOT, "--soil", "sandy-loam", "--headings", "4", *words, "-o", target)
    uncertain = terrain.SlipMapper(
        ROBOT, LOAM, cell_m=1.0, headings=4, gravity_m_per_s2=3.72, soil_intervals=intervals, soil_draws=5, seed=3
    )
    found = terrain.slip_map(uncertain, heights, threads=2)
    equal(found, terrain.read(target))
    risk = found.quantity("immobilisation")
    assert ((risk > 0.0) & (risk < 1.0)).any()
    weakest, strongest = uncertain.steepest_deg[1:]
    assert weakest < strongest


def test_tiles_have_the_numbers_of_the_whole(
    mapper: terrain.SlipMapper, whole: terrain.SlipMap, heights: npt.NDArray[np.float64]
) -> None:
    reach, tile = mapper.reach, 13
    rows, columns = heights.shape
    copy = pickle.loads(pickle.dumps(mapper))
    joined = np.full(whole.shape, np.nan, dtype=np.float32)
    for top in range(0, rows, tile):
        for left in range(0, columns, tile):
            above, before = min(reach, top), min(reach, left)
            part = heights[top - above : top + tile + reach, left - before : left + tile + reach]
            slip = terrain.slip_map(copy, part).quantity("slip")
            joined[:, top : top + tile, left : left + tile] = slip[:, above : above + tile, before : before + tile]
    np.testing.assert_array_equal(joined, whole.quantity("slip"))


def test_a_way_is_the_command_s(whole: terrain.SlipMap, tmp_path: Path) -> None:
    target = tmp_path / "map.tif"
    command("map", DUNES, "--robot", ROBOT, "--soil", "sandy-loam", "--headings", "4", "-o", target)
    other = json.loads(command("plan", target, "--from", "3,3", "--to", "20,9", "--turn-energy-j", "20", "--json"))["route"]
    found = terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(20.0, 9.0), turn_energy_j=20.0)
    assert found.route is not None
    assert found.route.energy_j == pytest.approx(other["energy_j"], rel=1e-12)
    assert found.route.turns == other["turns"]
    for key in ("x_m", "y_m", "heading_deg", "slip", "energy_j"):
        np.testing.assert_array_equal(found.route.way[key], [point[key] for point in other["waypoints"]])
    assert [route.energy_j for route in found.alternatives] == sorted(route.energy_j for route in found.alternatives)
    steep = terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(20.0, 9.0), min_tip_over_deg=60.0)
    assert steep.route is None


def test_a_heading_that_the_map_does_not_have_warns(whole: terrain.SlipMap) -> None:
    with pytest.warns(UserWarning, match="start_heading_deg 30 counts as 0, the nearest of the map's 4 headings"):
        terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(20.0, 9.0), start_heading_deg=30.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(20.0, 9.0), start_heading_deg=-90.5, goal_heading_deg=360.0)


def test_unknown_ground_stays_unknown(mapper: terrain.SlipMapper, heights: npt.NDArray[np.float64]) -> None:
    holed = heights.copy()
    holed[10, 10] = np.nan
    slip = terrain.slip_map(mapper, holed).quantity("slip")
    assert np.isnan(slip[:, 10, 10]).all() and np.isfinite(slip[:, 20, 20]).any()


def test_bad_input_is_named(mapper: terrain.SlipMapper, whole: terrain.SlipMap) -> None:
    with pytest.raises(InputError, match="cell_m"):
        terrain.SlipMapper(ROBOT, LOAM, cell_m=float("nan"))
    with pytest.raises(InputError) as raised:
        terrain.SlipMapper(ROBOT, LOAM, cell_m=1.0, headings=7)
    assert raised.value.field == "headings"
    with pytest.raises(InputError, match="soil_draws"):
        terrain.SlipMapper(ROBOT, LOAM, cell_m=1.0, soil_draws=-1)
    with pytest.raises(FileNotFoundError):
        terrain.SlipMapper("none.toml", LOAM, cell_m=1.0)
    with pytest.raises(InputError, match="dimensions"):
        terrain.slip_map(mapper, [1.0, 2.0])
    with pytest.raises(InputError, match="heights_m has 1 rows") as raised:
        terrain.slip_map(mapper, np.zeros((1, 5)))
    assert (raised.value.field, raised.value.value) == ("heights_m", (1, 5))
    with pytest.raises(InputTypeError):
        terrain.slip_map(mapper, np.zeros((3, 3), dtype=complex))
    with pytest.raises(InputError, match="outside the map"):
        terrain.plan(whole, start_m=(-9.0, 3.0), goal_m=(20.0, 9.0))
    for keys, field, value in (
        ({"start_m": (1e300, 1.0), "goal_m": (20.0, 9.0)}, "start_m", (1e300, 1.0)),
        ({"start_m": (3.0, 3.0), "goal_m": (20.0, -9.0)}, "goal_m", (20.0, -9.0)),
    ):
        with pytest.raises(InputError, match=f"{field} \\(") as raised:
            terrain.plan(whole, **keys)
        assert (raised.value.field, raised.value.value, raised.value.unit) == (field, value, "m")
        assert len(str(raised.value)) < 120
    with pytest.raises(InputError, match="max_risk"):
        terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(20.0, 9.0), max_risk=2.0)
    with pytest.raises(InputError, match="goal_m"):
        terrain.plan(whole, start_m=(3.0, 3.0), goal_m=(float("nan"), 9.0))
    with pytest.raises(InputError, match="quantity"):
        whole.quantity("colour")
    with pytest.raises(InputError):
        terrain.read(DUNES)
