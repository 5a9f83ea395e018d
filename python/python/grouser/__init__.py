"""Wheel slip of robots on soft ground.

Modules by subject: `soils`, `wheel`, `optimize`. Bad input raises `InputError` (a ValueError) or `InputTypeError`
(a TypeError) with field, value, limit and unit.
"""

from . import optimize, soils, wheel
from ._errors import InputError, InputTypeError

__all__ = ["InputError", "InputTypeError", "optimize", "soils", "wheel"]
