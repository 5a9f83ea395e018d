"""Figures as SVG or PNG: the same look as those of the command, shown by notebooks as they are.

Examples
--------
>>> import numpy as np
>>> from grouser import figures
>>> slip = np.linspace(0.0, 1.0, 50)
>>> figure = figures.lines("Pull", "Slip *s*", "Pull (N)", figures.Line(slip, 30.0 * slip, "*W* = 80 N"))
>>> figure.svg.startswith("<svg")
True
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from . import wheel as _wheel
from ._arrays import FloatArray, as_floats, flag, number, path_of
from ._core import Soil, Wheel
from ._errors import InputError

__all__ = ["Figure", "Line", "lines", "slip_curves"]


_Drawn = tuple[FloatArray, FloatArray, str, bool]


@dataclass(frozen=True)
class Figure:
    """A figure: SVG text, which notebooks show."""

    svg: str
    _drawn: tuple[str, str, str, list[_Drawn]] = field(repr=False, compare=False)

    def _repr_svg_(self) -> str:
        return self.svg

    def write(self, path: str | os.PathLike[str], *, dots_per_inch: float = 300.0) -> None:
        """Writes the figure as a whole, or what was there stays: SVG or PNG, as the path ends.

        Raises
        ------
        InputError
            A path that ends neither in `.svg` nor in `.png`.
        """
        file = Path(path_of("path", path))
        if file.suffix.lower() == ".svg":
            _core.write_file(file, self.svg.encode())
        elif file.suffix.lower() == ".png":
            _core.write_file(file, _core.chart(*self._drawn, number("dots_per_inch", dots_per_inch)))
        else:
            raise InputError(
                f"path is `{file}`, but must end in `.svg` or `.png`; a browser prints an SVG as PDF", "path", str(file)
            )


@dataclass(frozen=True)
class Line:
    """A line through points, or the points alone; NaN breaks a line.

    The label may contain *italic*, _{subscript} and ^{superscript}.
    """

    x: Any
    y: Any
    label: str = ""
    points: bool = False


def _column(field: str, value: Any) -> FloatArray:
    return np.ascontiguousarray(as_floats(field, value)).reshape(-1)


def lines(title: str, x_title: str, y_title: str, *given: Line) -> Figure:
    """A chart of lines and points; axis titles end with their unit in brackets.

    Raises
    ------
    InputError
        Columns of different lengths.
    """
    drawn = []
    for line in given:
        x, y = _column("x", line.x), _column("y", line.y)
        if x.size != y.size:
            raise InputError(f"y has {y.size} points, but x has {x.size}", "y", y.size, x.size, "1")
        drawn.append((x, y, line.label, flag("points", line.points)))
    chart = (title, x_title, y_title, drawn)
    return Figure(_core.chart(*chart, None).decode(), chart)


def slip_curves(soil: Soil, wheel: Wheel, *, load_n: Any, quantity: str = "drawbar_pull_n") -> Figure:
    """A quantity of one wheel against slip, a line for each load.

    Raises
    ------
    InputError
        No load, or one under which no slip has a solution; a line ends where there is none.

    Examples
    --------
    >>> from grouser import figures, soils
    >>> from grouser.wheel import Wheel
    >>> f = figures.slip_curves(soils.find("dry-sand"), Wheel(radius_m=0.125, width_m=0.1), load_n=[40.0, 80.0])
    >>> "Drawbar pull" in f.svg
    True
    """
    titles = {
        "drawbar_pull_n": "Drawbar pull *F*_{DP} (N)",
        "sinkage_m": "Sinkage *z* (m)",
        "torque_nm": "Torque *T* (N m)",
    }
    if quantity not in titles:
        raise InputError(f"quantity is `{quantity}`, but must be one of {', '.join(titles)}", "quantity", quantity)
    slip = np.linspace(0.0, 0.95, 96)
    loads = _column("load_n", load_n)
    if not loads.size:
        raise InputError("load_n is empty, but must hold one load at least", "load_n", 0, 1, "1")
    drawn = []
    for load in loads:
        points = _wheel.curve(soil, wheel, load_n=load, slip=slip)
        if np.all(points.status):
            raise InputError(
                f"load_n is {load} N, under which no slip has a solution (status {points.status[0]})", "load_n", load, unit="N"
            )
        drawn.append(Line(slip, getattr(points, quantity), f"*W* = {load:g} N"))
    return lines(f"{soil.name}: {quantity} against slip", "Slip *s*", titles[quantity], *drawn)
