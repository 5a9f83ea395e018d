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

from ._core import Soil, catalogue_keys

__all__ = ["Soil", "find", "keys", "read"]

find = Soil.find
read = Soil.read


def keys() -> list[str]:
    """The keys of the catalogue, in its order."""
    return catalogue_keys()
