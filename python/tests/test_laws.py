"""Every law of a soil: the table of cases that the Rust test writes, point by point and in columns."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from grouser import soils, wheel

CASES = Path(__file__).parents[2] / "crates/design/tests/every_law"
LOAD_N = 60.0
WHEEL = {"radius_m": 0.125, "width_m": 0.1}
QUANTITIES = ("sinkage_m", "drawbar_pull_n", "torque_nm")


def rows() -> list[dict[str, str]]:
    with (CASES / "cases.csv").open() as file:
        return list(csv.DictReader(file))


def soil_of(laws: str, folder: Path) -> soils.Soil:
    lines = ['{} = "{}"\n'.format(*law.split("=")) for law in laws.split()]
    path = folder / "soil.toml"
    path.write_text((CASES / "soil.toml").read_text() + "".join(lines))
    return soils.read(path)


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row['laws']} {row['slip']} {row['slip_angle_deg']}")
def test_every_law_is_that_of_the_table(row: dict[str, str], tmp_path: Path) -> None:
    soil = soil_of(row["laws"], tmp_path)
    slip, angle = float(row["slip"]), float(row["slip_angle_deg"])
    contact = wheel.WheelOnSoil(wheel.Wheel(**WHEEL), soil)
    found = [wheel.operating_points(contact, load_n=LOAD_N, slip=slip, slip_angle_deg=angle)]
    if angle == 0.0:
        found.append(wheel.under_load(soil, **WHEEL, load_n=LOAD_N, slip=slip))
        found.append(wheel.curve(soil, wheel.Wheel(**WHEEL), load_n=LOAD_N, slip=slip))
    for points in found:
        for name in QUANTITIES:
            # 60 N and 7.5 N m: a force is known to 1e-9 of the greatest
            np.testing.assert_allclose(getattr(points, name), float(row[name]), rtol=1e-7, atol=1e-6)
