"""The notebooks run as they stand, and say what they should."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

pytest.importorskip("marimo")
NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples" / "notebooks").glob("*.py"))


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    outputs, names = module.app.run()
    assert len(outputs) > 3
    if path.stem == "plate_to_drive":
        assert 0.3 < names["best_slip"] < 0.6
        assert names["result"].summary["wheels"][0]["slip"]["p95"] > 0.33
        assert names["pull"].svg.startswith("<svg")
        assert names["runs"]["own"].energy_j != names["runs"]["open loop"].energy_j
