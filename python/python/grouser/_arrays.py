"""Columns of numbers: checked, broadcast as NumPy's own functions do, and copied only where they must be."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, Union

import numpy as np
import numpy.typing as npt

from ._errors import InputError, InputTypeError

FloatArray = npt.NDArray[np.float64]
Column = Union[float, FloatArray]

_P = ParamSpec("_P")
_R = TypeVar("_R")

# real numbers: floats, signed and unsigned integers
_KINDS = "fiu"


def said(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """`function`, whose calls that do not fit its parameters are told what to write."""

    @functools.wraps(function)
    def call(*positional: _P.args, **keywords: _P.kwargs) -> _R:
        try:
            return function(*positional, **keywords)
        except TypeError:
            signature = inspect.signature(function)
            try:
                signature.bind(*positional, **keywords)
            except TypeError:
                raise InputTypeError(_misfit(function.__name__, signature, len(positional), keywords)) from None
            raise

    return call


def _misfit(name: str, signature: inspect.Signature, positional: int, keywords: dict[str, Any]) -> str:
    parameters = signature.parameters.values()
    by_place = sum(each.kind is not each.KEYWORD_ONLY for each in parameters)
    needed = [each.name for each in parameters if each.default is each.empty][by_place:]
    if positional > by_place:
        return f"{name} takes numbers by keyword: {', '.join(f'{each}=…' for each in needed)}"
    for key in keywords:
        if key.startswith(("grouser_", "slip_angle")) and key not in signature.parameters:
            return f"{name} has no `{key}`: lugs belong to a `Wheel`, and `operating_points` computes it, with slip angles as well"
        if key not in signature.parameters:
            import difflib  # not with the package: importing it stays fast

            near = difflib.get_close_matches(key, signature.parameters, 1)
            hint = f"did you mean `{near[0]}`?" if near else f"it has {', '.join(signature.parameters)}"
            return f"{name} has no `{key}`; {hint}"
    return f"{name} needs {', '.join(f'{each}=…' for each in needed if each not in keywords)}"


def as_floats(field: str, value: Any) -> FloatArray:
    """``value`` as an array of float64, without a copy where it is one already; what is masked is NaN."""
    if isinstance(value, np.ndarray) and not isinstance(value, np.ma.MaskedArray):
        array = value
    elif isinstance(value, (float, int)) and not isinstance(value, bool):
        try:
            array = np.asarray(float(value))
        except OverflowError:
            raise InputError(
                f"{field} is an integer beyond 1.8e308, but must be a finite number", field, value
            ) from None
    else:
        array = _converted(field, value)
    if array.dtype.kind not in _KINDS:
        raise InputTypeError(
            f"{field} has the type {array.dtype}, but must hold real numbers", field, str(array.dtype)
        )
    # the extension module reads aligned numbers: a column of a packed record is copied
    return np.require(array, np.float64, "A")


def _converted(field: str, value: Any) -> npt.NDArray[Any]:
    # NumPy leaves out the masks of arrays in a list
    if isinstance(value, (list, tuple)) and any(isinstance(one, np.ma.MaskedArray) for one in value):
        value = np.ma.array(value)
    if isinstance(value, np.ma.MaskedArray):
        if value.dtype.kind in _KINDS:
            return np.where(np.ma.getmaskarray(value), np.nan, value.data)
        return np.asarray(value.data)
    # a nullable column of pandas: what is missing becomes NaN, which is a bad point
    dtype = getattr(value, "dtype", None)
    if getattr(dtype, "na_value", None) is not None and getattr(dtype, "kind", "O") in _KINDS:
        return np.asarray(value.to_numpy(dtype=np.float64, na_value=np.nan))
    try:
        array = np.asarray(value)
    except (ValueError, TypeError) as error:
        raise InputTypeError(f"{field} is no array of numbers: {error}", field) from None
    return array


def check_kind(field: str, value: Any, kind: type | tuple[type, ...], wanted: str | None = None) -> None:
    """Raises unless ``value`` is an object of ``kind``, which messages call ``wanted``."""
    if not isinstance(value, kind):
        wanted = wanted or f"a {getattr(kind, '__name__', kind)}"
        raise InputTypeError(f"{field} is {type(value).__name__}, but must be {wanted}", field, value)


def flag(field: str, value: Any) -> bool:
    """``value`` where it is True or False."""
    check_kind(field, value, (bool, np.bool_), "True or False")
    return bool(value)


def path_of(field: str, value: Any) -> str:
    """``value`` where it is a path."""
    check_kind(field, value, (str, os.PathLike), "a path")
    found: str = os.fspath(value)
    return found


def number(field: str, value: Any) -> float:
    """``value`` where it is one finite number."""
    array = as_floats(field, value)
    if array.ndim != 0 or not np.isfinite(array):
        raise InputError(f"{field} is {value!r}, but must be one finite number", field, value)
    return float(array)


def whole(field: str, value: Any, least: int = 0, most: int = 2**63 - 1) -> int:
    """``value`` where it is a whole number in [least, most]."""
    check_kind(field, value, () if isinstance(value, bool) else (int, np.integer), "a whole number")
    if not least <= value <= most:
        limits = f"lie in [{least}, {most}]" if most < 2**32 else f"be at least {least}"
        raise InputError(f"{field} is {value}, but must {limits}", field, value, (least, most), "1")
    return int(value)


def columns(**named: Any) -> tuple[tuple[int, ...], int, list[Column]]:
    """The common shape, the number of points, and each column flat: an array, or one number."""
    arrays = {field: as_floats(field, value) for field, value in named.items()}
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{field} {array.shape}" for field, array in arrays.items())
        raise InputError(f"the shapes do not broadcast: {shapes}", "shape") from None
    flat: list[Column] = []
    for array in arrays.values():
        if array.size == 1:
            flat.append(float(array.reshape(())))
        else:
            flat.append(np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1))
    size = 1
    for length in shape:
        size *= length
    return shape, size, flat


def shaped(shape: tuple[int, ...], column: npt.NDArray[Any]) -> Any:
    """A result in the common shape; a number where every input was one."""
    return column.reshape(shape)[()]


def threads_of(threads: int | None) -> int:
    """The number of threads; 0 leaves the choice to the library."""
    return 0 if threads is None else whole("threads", threads, 1, 1024)
