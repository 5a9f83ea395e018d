"""The notebooks run as they stand, and say what they should."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from typing import Any

import numpy as np
import pytest

from grouser import soils, wheel

pytest.importorskip("marimo")
NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.py"))


def plate_to_drive(names: Any) -> None:
    # the tests of the example were made with a soil that its file names: the best slip is that soil's
    truth = soils.read(NOTEBOOKS[0].parents[1] / "bevameter" / "truth.toml")
    contact = wheel.WheelOnSoil(names["rim"], truth)
    assert names["best_slip"] == pytest.approx(contact.slip_of_maximum_efficiency(load_n=60.0)[0], abs=0.03)
    assert names["result"].summary["wheels"][0]["slip"]["p95"] > 0.33
    assert names["pull"].svg.startswith("<svg")
    assert names["runs"]["own"].energy_j != names["runs"]["open loop"].energy_j


def pareto_choice(names: Any) -> None:
    mass, pull = names["mass"], names["pull"]
    assert mass.size >= 10 and (np.diff(mass) > 0.0).all() and (np.diff(pull) > 0.0).all()


def two_controllers(names: Any) -> None:
    assert np.isfinite(names["difference"]).all() and abs(names["difference"]).max() > 0.0


CHECKS = {check.__name__: check for check in (plate_to_drive, pareto_choice, two_controllers)}


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    outputs, names = module.app.run()
    assert len(outputs) > 3
    CHECKS[path.stem](names)
