"""Slip maps of real terrain and ways over them: what `grouser map` and `grouser plan` compute, on arrays.

A tile with an overlap of `mapper.reach` cells has the same numbers as the whole, so that tiles can be computed
anywhere (`examples/engines/with_dask_map.py`).

Examples
--------
>>> import numpy as np
>>> from grouser import soils, terrain
>>> mapper = terrain.SlipMapper("examples/robots/skid-steer.toml", soils.find("sandy-loam"), cell_m=1.0, headings=4)
>>> y, x = np.mgrid[0:12, 0:16]
>>> found = terrain.slip_map(mapper, 0.1 * np.sin(0.6 * x) * np.cos(0.5 * y))
>>> found.quantity("slip").shape
(4, 12, 16)
>>> way = terrain.plan(found, start_m=(3.5, 3.5), goal_m=(12.5, 8.5)).route
>>> bool(way.energy_j > 0.0)
True
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._arrays import as_floats, check_kind, flag, number, threads_of, whole
from ._core import SlipMap, SlipMapper
from ._errors import InputError
from ._tables import Table

__all__ = ["QUANTITIES", "STATES", "Plan", "Route", "SlipMap", "SlipMapper", "plan", "read", "slip_map"]

QUANTITIES = (
    "slip",
    "slip_95",
    "sinkage_m",
    "energy_j_per_m",
    "energy_cvar_j_per_m",
    "tip_over_deg",
    "immobilisation",
    "pitch_deg",
    "state",
    "soil",
)
"""What a map knows of a cell at a heading; docs/terrain.md describes each."""

STATES = ("drives", "marginal", "immobilised", "slides", "steep")
"""The names of the numbers of the quantity `state`."""

read = SlipMap.read


def slip_map(
    mapper: SlipMapper,
    heights_m: Any,
    *,
    upper_left_m: tuple[float, float] | None = None,
    threads: int | None = None,
) -> SlipMap:
    """The map of an elevation model in memory.

    Parameters
    ----------
    mapper : SlipMapper
    heights_m : array_like, shape (rows, columns)
        Heights of the cells' centres, m, the first row at the upper edge; NaN is unknown. Heights are taken to
        seven digits, as elevation models hold them.
    upper_left_m : (float, float), optional
        Place of the upper left corner; (0, rows · cell) by default, so that the lower left corner is the origin.
    threads : int, optional
        As many as the machine runs by default; 1 inside an engine.

    Raises
    ------
    InputError
        Fewer than two rows or columns.
    """
    check_kind("mapper", mapper, SlipMapper)
    heights = as_floats("heights_m", heights_m)
    if heights.ndim != 2:
        raise InputError(f"heights_m has {heights.ndim} dimensions, but must have 2", "heights_m", heights.ndim, (2, 2), "1")
    if upper_left_m is not None:
        upper_left_m = _place("upper_left_m", upper_left_m)
    # a height beyond single precision is no height
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(heights, dtype=np.float32)
    return mapper._map(single, upper_left_m, threads_of(threads))


@dataclass(frozen=True)
class Route:
    """A way."""

    energy_j: float
    energy_cvar_j: float
    """Its CVaR over the soil draws, at most."""
    time_s: float
    length_m: float
    """Along the ground."""
    risk: float
    """Probability to be immobilised anywhere on it, at most."""
    tip_over_deg: float
    """The least tip-over margin."""
    turns: int
    """By one heading each."""
    deep_share: float
    """Share of its cells in which a wheel sinks by more than a sixth of its diameter, where the laws lose their grip."""
    way: Table
    """Columns by waypoint: `x_m`, `y_m`, `heading_deg`, and since the start `energy_j`, `time_s`, `length_m`; `slip`
    and `risk` there."""


@dataclass(frozen=True)
class Plan:
    """What planning found."""

    route: Route | None
    """The way of least energy; None where no way keeps the bounds."""
    alternatives: list[Route]
    """Other ways, by energy."""
    least_risk: float | None
    """Where there is no way: the smallest bound on the risk that some way keeps, None if none does."""


def plan(
    found: SlipMap,
    *,
    start_m: tuple[float, float],
    goal_m: tuple[float, float],
    max_risk: float = 0.05,
    max_slip: float = 0.6,
    min_tip_over_deg: float = 10.0,
    rim_speed_mps: float = 0.25,
    turn_energy_j: float = 0.0,
    by_cvar: bool = False,
    start_heading_deg: float | None = None,
    goal_heading_deg: float | None = None,
    alternatives: int = 2,
) -> Plan:
    """The way of least energy between two places of a map, m in its coordinates.

    The risk is that of steady straight driving on one soil of uncertain strength (docs/terrain.md): turns, drift on
    side slopes and ruts are not in a map. With `by_cvar` the energy's CVaR over the soil draws is minimised. Of the
    headings at start and goal the nearest of `found.headings_deg` count, with a warning where they are off by more than
    1°; `route.way["heading_deg"]` has them.

    Raises
    ------
    InputError
        A place outside the map or on unknown ground, a number outside its limits.
    """
    check_kind("found", found, SlipMap)
    headings = [
        None if start_heading_deg is None else number("start_heading_deg", start_heading_deg),
        None if goal_heading_deg is None else number("goal_heading_deg", goal_heading_deg),
    ]
    for field, heading in zip(("start_heading_deg", "goal_heading_deg"), headings, strict=True):
        _warn_of_other_heading(found, field, heading)
    answer = found._plan(
        _place("start_m", start_m),
        _place("goal_m", goal_m),
        number("max_risk", max_risk),
        number("max_slip", max_slip),
        number("min_tip_over_deg", min_tip_over_deg),
        number("rim_speed_mps", rim_speed_mps),
        number("turn_energy_j", turn_energy_j),
        flag("by_cvar", by_cvar),
        (headings[0], headings[1]),
        whole("alternatives", alternatives, 0, 20),
    )
    route = answer["route"]
    return Plan(
        route=None if route is None else _route(route),
        alternatives=[_route(other) for other in answer["alternatives"]],
        least_risk=answer["least_risk"],
    )


def _route(found: dict[str, Any]) -> Route:
    return Route(way=Table(**found.pop("way")), **found)


def _warn_of_other_heading(found: SlipMap, field: str, angle: float | None) -> None:
    """Warns of a heading that is none of the map's; less than a degree is no turn that a plan could mean."""
    if angle is None:
        return

    def off(heading: float) -> float:
        return abs((angle - heading + 180.0) % 360.0 - 180.0)

    nearest = min(found.headings_deg, key=off)
    if off(nearest) > 1.0:
        warnings.warn(
            f"{field} {angle:g} counts as {nearest:g}, the nearest of the map's {len(found.headings_deg)} headings",
            stacklevel=3,
        )


def _place(field: str, place: Any) -> tuple[float, float]:
    array = as_floats(field, place)
    if array.shape != (2,) or not np.isfinite(array).all():
        raise InputError(f"{field} is {place!r}, but must be two finite numbers, x and y in m", field, place)
    return float(array[0]), float(array[1])
