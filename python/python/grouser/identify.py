"""Soil parameters from plate, shear and wheel tests, with their intervals.

Examples
--------
>>> from grouser import identify
>>> found = identify.run("examples/bevameter/tests.toml")
>>> found.numbers["n"].verdict
'identified'
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from . import _core
from ._arrays import path_of, threads_of
from ._core import Soil
from ._frames import write_job

__all__ = ["Identification", "Number", "run"]


class Number(NamedTuple):
    """An identified number, in the unit of its name."""

    value: float
    standard_error: float
    """NaN where the data do not determine it."""
    low: float | None
    """The lower end of the 95 % interval; None where it is open."""
    high: float | None
    verdict: str
    """`identified`, `loose`, `on-bound` or `not-identifiable`."""


class Identification(NamedTuple):
    """A soil and how well it is known."""

    soil: Soil | None
    """None where a number of a soil, or K, c_1 or c_2, is missing."""
    text: str | None
    """The text of the soil file, with the intervals as remarks."""
    missing: list[str]
    """The numbers that neither a test nor the file gives."""
    numbers: dict[str, Number]
    doubts: list[str]
    """Why the result is doubtful, a likely mistake in a unit first; empty where it is not."""


def run(job: str | os.PathLike[str] | Mapping[str, Any], *, threads: int | None = None) -> Identification:
    """Identifies the soil of a job: the same numbers as the command `grouser identify`.

    Parameters
    ----------
    job : path or mapping
        A job file (TOML), which names the tables of tests; or its keys, each `table` a path, a data frame, or a mapping
        of columns.
    threads : int, optional
        Threads of this call.

    Examples
    --------
    >>> import numpy as np
    >>> from grouser import identify
    >>> def plate(diameter_m):  # a plate of 1.4 kN/m^1.8 and 820 kN/m^2.8, exactly
    ...     depth = np.linspace(0.002, 0.03, 15)
    ...     pressure = (1.4e3 / (0.5 * diameter_m) + 8.2e5) * depth**0.8
    ...     force = pressure * np.pi / 4 * diameter_m**2
    ...     return {"table": {"depth_m": depth, "force_n": force, "plate_diameter_m": 15 * [diameter_m]}}
    >>> found = identify.run({"name": "exact", "plate": [plate(0.05), plate(0.1)]})
    >>> round(found.numbers["n"].value, 3)
    0.8

    Raises
    ------
    OSError
        A file cannot be read.
    InputError
        What a file lacks or has wrong.
    """
    threads = threads_of(threads)
    if isinstance(job, Mapping):
        import tempfile  # not with the package: importing it stays fast

        with tempfile.TemporaryDirectory() as folder:
            found = _core.identify(str(write_job(job, Path(folder))), threads)
    else:
        found = _core.identify(path_of("job", job), threads)
    text = found["text"]
    open_numbers = [] if text is None else [key for key in ("k_shear_m", "c_1", "c_2") if f"\n{key} = " not in text]
    soil = None if text is None or open_numbers else Soil.from_toml(text)
    return Identification(
        soil=soil,
        text=text,
        missing=found["missing"] + open_numbers,
        numbers={name: Number(*rest) for name, *rest in found["numbers"]},
        doubts=found["doubts"],
    )
