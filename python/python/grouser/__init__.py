"""Wheel slip of robots on soft ground.

Modules by subject: `soils`, `wheel` (forces and sinkage, at one point or at millions), `optimize`, `slip`
(filter and on-board computer), `logs`, `drive` (simulation),
`identify` (soils from tests), `terrain` (slip maps and ways), `figures`, `commands` (the command's verbs). Bad input raises `InputError` (a
ValueError) or `InputTypeError` (a TypeError) with field, value, limit and unit.
"""

from . import commands, drive, figures, identify, logs, optimize, slip, soils, terrain, wheel
from ._core import __version__ as __version__
from ._errors import InputError, InputTypeError

__all__ = [
    "InputError",
    "InputTypeError",
    "commands",
    "drive",
    "figures",
    "identify",
    "logs",
    "optimize",
    "slip",
    "soils",
    "terrain",
    "wheel",
]

for _module in (commands, drive, figures, identify, logs, optimize, slip, soils, terrain, wheel):
    # what a module imports is none of its names
    setattr(_module, "__dir__", _module.__all__.copy)  # noqa: B010
