"""Columns of pandas, polars and pyarrow: accepted, and without a copy where they are contiguous."""

from __future__ import annotations

import numpy as np
import pytest

from grouser import InputTypeError, soils, wheel
from grouser._arrays import as_floats

SAND = soils.find("dry-sand")
SIZE = {"radius_m": 0.125, "width_m": 0.1}
SLIP = np.linspace(0.0, 0.9, 50)
EXPECTED = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=SLIP).drawbar_pull_n


def pull(slip: object) -> np.ndarray:
    found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=slip).drawbar_pull_n
    return np.asarray(found)


def test_numpy_is_never_copied() -> None:
    assert as_floats("slip", SLIP) is SLIP or np.shares_memory(as_floats("slip", SLIP), SLIP)


def test_pandas() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"slip": SLIP, "other": 1.0})
    np.testing.assert_array_equal(pull(frame["slip"]), EXPECTED)
    assert np.shares_memory(as_floats("slip", frame["slip"]), frame["slip"].to_numpy())
    np.testing.assert_array_equal(pull(frame["slip"].astype("Float64")), EXPECTED)
    missing = frame["slip"].astype("Float64")
    missing.iloc[3] = pandas.NA
    found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=missing)
    assert found.status[3] == 3 and found.status[4] == 0
    with pytest.raises(InputTypeError):
        pull(pandas.Series(["a", "b"]))


def test_polars() -> None:
    polars = pytest.importorskip("polars")
    column = polars.Series("slip", SLIP)
    np.testing.assert_array_equal(pull(column), EXPECTED)
    assert np.shares_memory(as_floats("slip", column), column.to_numpy())
    found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=polars.Series([0.1, None, 0.2]))
    assert found.status.tolist() == [0, 3, 0]


def test_pyarrow() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    array = pyarrow.array(SLIP)
    np.testing.assert_array_equal(pull(array), EXPECTED)
    assert np.shares_memory(as_floats("slip", array), array.to_numpy())
    chunked = pyarrow.chunked_array([SLIP[:20], SLIP[20:]])
    np.testing.assert_array_equal(pull(chunked), EXPECTED)
    found = wheel.under_load(SAND, **SIZE, load_n=80.0, slip=pyarrow.array([0.1, None, 0.2]))
    assert found.status.tolist() == [0, 3, 0]
