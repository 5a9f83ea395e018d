"""Columns of numbers: checked, broadcast as NumPy's own functions do, and copied only where they must be."""

from __future__ import annotations

from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._errors import InputError, InputTypeError

FloatArray = npt.NDArray[np.float64]
Column = Union[float, FloatArray]

# real numbers: floats, signed and unsigned integers
_KINDS = "fiu"


def as_floats(field: str, value: Any) -> FloatArray:
    """``value`` as an array of float64, without a copy where it is one already."""
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
    return array.astype(np.float64, copy=False)


def _converted(field: str, value: Any) -> npt.NDArray[Any]:
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


def check_kind(field: str, value: Any, kind: type) -> None:
    """Raises unless ``value`` is an object of ``kind``."""
    if not isinstance(value, kind):
        raise InputTypeError(f"{field} is {type(value).__name__}, but must be a {kind.__name__}", field, value)


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
    if threads is None:
        return 0
    if isinstance(threads, bool) or not isinstance(threads, (int, np.integer)):
        raise InputTypeError(
            f"threads is {type(threads).__name__}, but must be a whole number", "threads", threads
        )
    if not 1 <= threads <= 1024:
        raise InputError(
            f"threads is {threads}, but must lie in [1, 1024]", "threads", threads, (1, 1024), "1"
        )
    return int(threads)
