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
from typing import NamedTuple

from . import _core
from ._arrays import path_of, threads_of
from ._core import Soil

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


def run(path: str | os.PathLike[str], *, threads: int | None = None) -> Identification:
    """Identifies the soil of a job file (TOML), which names the tables of tests.

    The same numbers as the command `grouser identify`.

    Raises
    ------
    OSError
        A file cannot be read.
    InputError
        What a file lacks or has wrong.
    """
    found = _core.identify(path_of("path", path), threads_of(threads))
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
