"""The wheel in the soil: sinkage, forces, derivatives, slip demand, at one point or at millions.

Array functions broadcast their inputs as NumPy's own functions do. Every keyword carries its unit.
Inputs are numbers, NumPy arrays, lists, and columns of pandas, polars and pyarrow; contiguous columns of
float64 are read in place. A point that cannot be computed is not an exception but a status, with NaN in
its results: the others are computed. Results are tables: ``pandas.DataFrame(points)``, `Table.to_frame`.

=======  =================================================
status   meaning
=======  =================================================
0        solved
1        no sinkage below the hub carries the load, or no slip holds the slope
2        the search for the sinkage ended without its result
3        bad input: a value outside its limits, or NaN
=======  =================================================

The threads of a call end with it. While it computes, the interpreter is released, and Ctrl-C interrupts
it.

Examples
--------
>>> import numpy as np
>>> from grouser import soils, wheel
>>> points = wheel.under_load(
...     soils.find("lunar"), radius_m=0.125, width_m=0.15, load_n=65.0, slip=np.array([0.1, 0.25])
... )
>>> points.drawbar_pull_n.round(4)
array([-3.656 ,  3.2949])
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import FloatArray, as_floats, check_kind, columns, said, shaped, threads_of
from ._core import Soil, Wheel, WheelOnSoil
from ._declared import OperatingPoint
from ._errors import InputError
from ._tables import Table
from .soils import of as soil_of

__all__ = [
    "BestSlip",
    "Derivatives",
    "Demand",
    "OperatingPoint",
    "OperatingPoints",
    "Points",
    "Skid",
    "Wheel",
    "WheelOnSoil",
    "at_sinkage",
    "cautions",
    "curve",
    "free_slip",
    "instructions",
    "jacobian",
    "operating_points",
    "slip_demand",
    "slip_from_speeds",
    "slip_of_maximum_efficiency",
    "slip_of_maximum_pull",
    "under_load",
]

instructions = _core.instructions


class Points(Table):
    """Operating points side by side, in the shape of the inputs; NaN where the status is not 0."""

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): see the module."""
    sinkage_m: FloatArray
    """Sinkage, m."""
    vertical_force_n: FloatArray
    """Vertical force, N, upwards."""
    drawbar_pull_n: FloatArray
    """Drawbar pull, N, forwards."""
    torque_nm: FloatArray
    """Torque, N m, positive where a motor drives."""


class OperatingPoints(Table):
    """Operating points of one wheel that may drift; NaN where the status is not 0."""

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): see the module."""
    sinkage_m: FloatArray
    """Sinkage, m."""
    vertical_force_n: FloatArray
    """Vertical force, N, upwards."""
    drawbar_pull_n: FloatArray
    """Drawbar pull, N, forwards."""
    torque_nm: FloatArray
    """Torque, N m, positive where a motor drives."""
    side_force_n: FloatArray
    """Side force, N, to the left."""


class Demand(Table):
    """The slip that a slope needs; NaN where the status is not 0."""

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): 0 holds, 1 immobilised, 3 bad input."""
    slip: FloatArray
    """The smallest slip that holds the slope; negative downhill."""


class BestSlip(Table):
    """The slip at which a pull or an efficiency is greatest; NaN where the status is not 0."""

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): 0 found, 1 no slip carries the load or pulls, 3 bad input."""
    slip: FloatArray
    """The slip, 0 to 1."""
    value: FloatArray
    """The greatest pull, N, or efficiency."""


class Skid(Table):
    """The skid of a free wheel; NaN where the status is not 0."""

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): 0 turns, 1 locked or not carried, 3 bad input."""
    slip: FloatArray
    """The slip, negative."""


class Derivatives(Table):
    """Values and exact derivatives under a load; NaN where the status is not 0.

    The last axis of each derivative is (slip, radius_m, width_m, load_n), in SI units.
    """

    status: npt.NDArray[np.uint8]
    """How each point ended (uint8): see the module."""
    sinkage_m: FloatArray
    """Sinkage, m."""
    drawbar_pull_n: FloatArray
    """Drawbar pull, N."""
    torque_nm: FloatArray
    """Torque, N m."""
    d_sinkage: FloatArray
    """Derivatives of the sinkage, shape (..., 4)."""
    d_drawbar_pull: FloatArray
    """Derivatives of the drawbar pull, shape (..., 4)."""
    d_torque: FloatArray
    """Derivatives of the torque, shape (..., 4)."""


def _outputs(points: int) -> tuple[npt.NDArray[np.uint8], list[npt.NDArray[np.float64]]]:
    return np.empty(points, dtype=np.uint8), [np.empty(points) for _ in range(4)]


def _points(
    shape: tuple[int, ...], status: npt.NDArray[np.uint8], numbers: list[npt.NDArray[np.float64]]
) -> Points:
    return Points(shaped(shape, status), *(shaped(shape, column) for column in numbers))


def _drawn(draws: Mapping[str, Any] | None) -> tuple[list[str], dict[str, Any]]:
    """The keys of the numbers that differ from point to point, and the numbers by their names in messages."""
    if draws is None:
        return [], {}
    check_kind("draws", draws, Mapping)
    keys = [str(key) for key in draws]
    return keys, {f"draws[{key!r}]": value for key, value in zip(keys, draws.values())}


@said
def under_load(
    soil: Soil | str | os.PathLike[str],
    *,
    radius_m: Any,
    width_m: Any,
    load_n: Any,
    slip: Any,
    rebound: Any = None,
    draws: Mapping[str, Any] | None = None,
    threads: int | None = None,
) -> Points:
    """Sinkage and forces of smooth wheels under loads, straight ahead.

    Parameters
    ----------
    soil : Soil, str or path
        The soil of all points; a key of the catalogue, or a soil file.
    radius_m, width_m : array_like
        Radius and width of the wheels, m, 0.001 to 100.
    load_n : array_like
        Load of each wheel, N.
    slip : array_like
        Slip, -1 to 1; negative where the wheel brakes.
    rebound : array_like, optional
        Rebound ratio of the soil behind the wheel; the soil's own by default.
    draws : mapping of str to array_like, optional
        Numbers of the soil that differ from point to point, by the keys and in the units of soil files:
        ``k_c_kn_per_m_n1``, ``k_phi_kn_per_m_n2``, ``n``, ``cohesion_kpa``, ``phi_deg``, ``k_shear_m``, ``c_1``
        and ``c_2``. One outside its limits is a bad point.
    threads : int, optional
        Threads of this call; by default as many as the machine runs, one for each 16384 points.

    Returns
    -------
    Points
        Each in the shape of the broadcast inputs; accurate to 1e-9 of the largest force.

    Raises
    ------
    InputError
        Shapes that do not broadcast, a key of ``draws`` that is not listed above.
    InputTypeError
        Objects, text or complex numbers.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> p = wheel.under_load(soils.find("dry-sand"), radius_m=0.125, width_m=0.1, load_n=80.0, slip=[0.2, 2.0])
    >>> p.status
    array([0, 3], dtype=uint8)
    >>> p = wheel.under_load(
    ...     soils.find("dry-sand"),
    ...     radius_m=0.125,
    ...     width_m=0.1,
    ...     load_n=80.0,
    ...     slip=0.2,
    ...     draws={"n": [1.0, 1.1, 1.2], "phi_deg": [29.0, 30.0, 31.0]},
    ... )
    >>> p.drawbar_pull_n.round(2).tolist()
    [-2.57, -1.4, 0.21]
    """
    soil = soil_of("soil", soil)
    rebound = soil.rebound if rebound is None else rebound
    keys, drawn = _drawn(draws)
    shape, points, flat = columns(
        radius_m=radius_m, width_m=width_m, rebound=rebound, slip=slip, load_n=load_n, **drawn
    )
    status, numbers = _outputs(points)
    _core.solve_points(soil, True, (flat, keys), status, numbers, threads_of(threads))
    return _points(shape, status, numbers)


@said
def at_sinkage(
    soil: Soil | str | os.PathLike[str],
    *,
    radius_m: Any,
    width_m: Any,
    sinkage_m: Any,
    slip: Any,
    rebound: Any = None,
    draws: Mapping[str, Any] | None = None,
    threads: int | None = None,
) -> Points:
    """Forces of smooth wheels at sinkages (m), straight ahead; otherwise as `under_load`.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> p = wheel.at_sinkage(soils.find("dry-sand"), radius_m=0.1, width_m=0.05, sinkage_m=0.01, slip=0.2)
    >>> round(float(p.vertical_force_n), 6)
    11.899672
    """
    soil = soil_of("soil", soil)
    rebound = soil.rebound if rebound is None else rebound
    keys, drawn = _drawn(draws)
    shape, points, flat = columns(
        radius_m=radius_m, width_m=width_m, rebound=rebound, slip=slip, sinkage_m=sinkage_m, **drawn
    )
    status, numbers = _outputs(points)
    _core.solve_points(soil, False, (flat, keys), status, numbers, threads_of(threads))
    return _points(shape, status, numbers)


@said
def cautions(
    soil: Soil | str | os.PathLike[str],
    points: Points,
    *,
    radius_m: Any,
    width_m: Any,
    slip: Any,
    rebound: Any = None,
    draws: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """What to keep in mind about the solved points of `under_load`, `at_sinkage` or `curve`.

    The same as `OperatingPoint.cautions` of single points, but for `several-sinkages`, which only those have.

    Parameters
    ----------
    soil, radius_m, width_m, slip, rebound, draws
        As they were given for the points.
    points : Points
        What was computed.

    Returns
    -------
    dict of str to array
        For each caution that some point has: where (bool), in the common shape.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> sand, size = soils.find("dry-sand"), {"radius_m": 0.1, "width_m": 0.05}
    >>> p = wheel.under_load(sand, **size, load_n=[20.0, 200.0], slip=0.9)
    >>> wheel.cautions(sand, p, **size, slip=0.9)
    {'deep-sinkage': array([False,  True])}
    """
    soil = soil_of("soil", soil)
    check_kind("points", points, Points)
    rebound = soil.rebound if rebound is None else rebound
    keys, drawn = _drawn(draws)
    numbers = {name: column for name, column in points.items() if name != "status"}
    shape, count, flat = columns(
        radius_m=radius_m, width_m=width_m, rebound=rebound, slip=slip, **numbers, **drawn
    )
    found = _core.point_cautions(soil, (flat, keys), count)
    return {key: shaped(shape, mask) for key, mask in found}


@said
def curve(soil: Soil | str | os.PathLike[str], wheel: Wheel, *, load_n: float, slip: Any) -> Points:
    """Sinkage and forces of one smooth wheel under one load at many slips.

    `under_load` of a `Wheel`.

    Raises
    ------
    InputError
        A wheel with grousers, a load that is no single number.

    Examples
    --------
    >>> import numpy as np
    >>> from grouser import soils, wheel
    >>> slip = np.linspace(0.0, 0.9, 100)
    >>> c = wheel.curve(soils.find("dry-sand"), wheel.Wheel(radius_m=0.125, width_m=0.1), load_n=80.0, slip=slip)
    >>> bool(c.drawbar_pull_n[0] < 0.0 < c.drawbar_pull_n[-1])
    True
    """
    soil = soil_of("soil", soil)
    check_kind("wheel", wheel, Wheel)
    slips = as_floats("slip", slip)
    load = as_floats("load_n", load_n)
    if load.size != 1:
        raise InputError(f"load_n has the shape {load.shape}, but must be one number", "load_n")
    flat = np.ascontiguousarray(slips).reshape(-1)
    status, numbers = _outputs(flat.size)
    _core.solve_curve(soil, wheel, float(load.reshape(())), flat, status, numbers)
    return _points(slips.shape, status, numbers)


@said
def operating_points(
    contact: WheelOnSoil,
    *,
    load_n: Any,
    slip: Any,
    slip_angle_deg: Any = 0.0,
    threads: int | None = None,
) -> OperatingPoints:
    """Sinkage and forces of one wheel, with grousers and slip angles, point by point.

    The same bits as `WheelOnSoil.under_load`. For smooth wheels straight ahead `under_load` is some
    twenty times as fast.

    Parameters
    ----------
    contact : WheelOnSoil
    load_n : array_like
        Load, N.
    slip : array_like
        Slip, -1 to 1.
    slip_angle_deg : array_like
        Slip angle, degrees, -89.9 to 89.9, positive where the wheel drifts to its left.
    threads : int, optional
        Threads of this call.
    """
    check_kind("contact", contact, WheelOnSoil)
    shape, points, flat = columns(load_n=load_n, slip=slip, slip_angle_deg=slip_angle_deg)
    status, results = contact._operating_points(flat, points, threads_of(threads))
    return OperatingPoints(shaped(shape, status), *(shaped(shape, column) for column in results))


@said
def slip_demand(
    contact: WheelOnSoil, *, weight_n: Any, slope_deg: Any, threads: int | None = None
) -> Demand:
    """The smallest slip at which a wheel holds a slope.

    Parameters
    ----------
    contact : WheelOnSoil
    weight_n : array_like
        Weight on the wheel on the level, N.
    slope_deg : array_like
        Slope, degrees, positive uphill.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))
    >>> wheel.slip_demand(contact, weight_n=80.0, slope_deg=[0.0, 40.0]).status
    array([0, 1], dtype=uint8)
    """
    check_kind("contact", contact, WheelOnSoil)
    shape, points, flat = columns(weight_n=weight_n, slope_deg=slope_deg)
    status, slips = contact._slip_demand(flat, points, threads_of(threads))
    return Demand(shaped(shape, status), shaped(shape, slips))


@said
def slip_of_maximum_pull(
    contact: WheelOnSoil, *, load_n: Any, threads: int | None = None
) -> BestSlip:
    """The slip in [0, 1] of the greatest drawbar pull under each load, and that pull, N.

    Parameters
    ----------
    contact : WheelOnSoil
    load_n : array_like
        Load, N.
    threads : int, optional
        Threads of this call.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))
    >>> wheel.slip_of_maximum_pull(contact, load_n=[20.0, 40.0, 80.0]).status
    array([0, 0, 0], dtype=uint8)
    """
    return _best_slip(contact, True, load_n, threads)


@said
def slip_of_maximum_efficiency(
    contact: WheelOnSoil, *, load_n: Any, threads: int | None = None
) -> BestSlip:
    """The slip in [0, 1] of the greatest tractive efficiency under each load, and that efficiency.

    Parameters
    ----------
    contact : WheelOnSoil
    load_n : array_like
        Load, N.
    threads : int, optional
        Threads of this call.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))
    >>> best = wheel.slip_of_maximum_efficiency(contact, load_n=[20.0, 40.0])
    >>> bool(best.value[1] < best.value[0])
    True
    """
    return _best_slip(contact, False, load_n, threads)


def _best_slip(contact: WheelOnSoil, of_pull: bool, load_n: Any, threads: int | None) -> BestSlip:
    check_kind("contact", contact, WheelOnSoil)
    shape, points, flat = columns(load_n=load_n)
    status, results = contact._best_slip(of_pull, flat, points, threads_of(threads))
    return BestSlip(shaped(shape, status), *(shaped(shape, column) for column in results))


@said
def free_slip(
    contact: WheelOnSoil, *, load_n: Any, bearing_torque_nm: Any = 0.0, threads: int | None = None
) -> Skid:
    """The skid of a free wheel: the (negative) slip at which the soil turns it against its bearing's friction.

    Parameters
    ----------
    contact : WheelOnSoil
    load_n : array_like
        Load, N.
    bearing_torque_nm : array_like
        Friction of the bearing, N m, not negative.
    threads : int, optional
        Threads of this call.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.05, width_m=0.03), soils.find("dry-sand"))
    >>> wheel.free_slip(contact, load_n=5.0, bearing_torque_nm=[0.0, 0.01]).slip.round(3)
    array([-0.095, -0.155])
    """
    check_kind("contact", contact, WheelOnSoil)
    shape, points, flat = columns(load_n=load_n, bearing_torque_nm=bearing_torque_nm)
    status, slips = contact._free_slip(flat, points, threads_of(threads))
    return Skid(shaped(shape, status), shaped(shape, slips))


@said
def jacobian(
    contact: WheelOnSoil, *, load_n: Any, slip: Any, threads: int | None = None
) -> Derivatives:
    """Sinkage, drawbar pull and torque with exact derivatives in slip, radius, width and load.

    A load of 0 is bad input: there the derivatives in the load are infinite.

    Examples
    --------
    >>> from grouser import soils, wheel
    >>> contact = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))
    >>> d = wheel.jacobian(contact, load_n=80.0, slip=0.2)
    >>> d.d_drawbar_pull.shape
    (4,)
    """
    check_kind("contact", contact, WheelOnSoil)
    shape, points, flat = columns(load_n=load_n, slip=slip)
    status, numbers = contact._jacobian(flat, points, threads_of(threads))
    rows = numbers.reshape((*shape, 15))
    return Derivatives(
        shaped(shape, status),
        *(rows[..., k][()] for k in range(3)),
        *(rows[..., 3 + 4 * k : 7 + 4 * k] for k in range(3)),
    )


@said
def slip_from_speeds(*, forward_speed_mps: Any, rim_speed_mps: Any) -> Any:
    """Slip from the speed of the wheel's centre and of its rim, m/s.

    With v the speed of the centre and u that of the rim: 1 - v/u where the wheel drives, u/v - 1 where it
    brakes. NaN where the speeds define no slip: at standstill, and where the wheel travels against its
    rotation.

    Examples
    --------
    >>> from grouser import wheel
    >>> wheel.slip_from_speeds(forward_speed_mps=[0.8, 1.0], rim_speed_mps=1.0)
    array([0.2, 0. ])
    """
    shape, points, flat = columns(forward_speed_mps=forward_speed_mps, rim_speed_mps=rim_speed_mps)
    full = [np.ascontiguousarray(np.broadcast_to(column, (points,))) for column in flat]
    return shaped(shape, _core.slips_from_speeds(*full))
