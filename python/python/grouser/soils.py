"""Soils: a published catalogue, files, and keywords.

Examples
--------
>>> from grouser import soils
>>> soils.keys()[:2]
['dry-sand', 'sandy-loam']
>>> soils.find("lunar").cohesion_kpa
0.17
"""

from __future__ import annotations

import os
from typing import Any

from ._arrays import check_kind
from ._core import Soil, catalogue_keys

__all__ = ["Soil", "find", "keys", "read"]

find = Soil.find
read = Soil.read


def of(field: str, value: Any) -> Soil:
    """A soil, a key of the catalogue, or a soil file (a path; text with `/` or `.`), as the command's `--soil`."""
    if isinstance(value, os.PathLike) or (isinstance(value, str) and ("/" in value or "." in value)):
        return Soil.read(value)
    if isinstance(value, str):
        return Soil.find(value)
    check_kind(field, value, Soil, "a soil, a key of the catalogue, or a soil file")
    found: Soil = value
    return found


def keys() -> list[str]:
    """The keys of the catalogue, in its order."""
    return catalogue_keys()
