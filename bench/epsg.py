"""The ranges of `crates/rover/src/ground/file/epsg.rs`, from the EPSG dataset of PROJ.

    pip install pyproj==3.7.2 numpy && python bench/epsg.py

Lengths are compared with those on the ground at 13 by 13 places of each system's area of use.
"""

import pathlib

import numpy as np
from pyproj import CRS, Proj
from pyproj.database import query_crs_info
from pyproj.enums import PJType

TARGET = pathlib.Path(__file__).parents[1] / "crates/rover/src/ground/file/epsg.rs"
TOLERANCE = 0.005


def is_true_to_scale(code):
    """Is the system in metres, east and north, and true to scale all over its area of use?"""
    try:
        system = CRS.from_epsg(code)
        axes, area = system.axis_info[:2], system.area_of_use
        if any(axis.unit_conversion_factor != 1.0 for axis in axes) or area is None:
            return False
        if {axis.direction for axis in axes} != {"east", "north"}:
            return False
        east = area.east + (360.0 if area.east < area.west else 0.0)
        places = np.meshgrid(np.linspace(area.west, east, 13), np.linspace(area.south, area.north, 13))
        factors = Proj(system).get_factors(*(axis.ravel() for axis in places), errcheck=False)
        scales = np.array([factors.tissot_semimajor, factors.tissot_semiminor])
        return bool(np.isfinite(scales).all() and (abs(scales - 1.0) <= TOLERANCE).all())
    except Exception:  # methods that PROJ does not compute
        return False


def is_upwards_in_metres(code):
    """Are the numbers of the vertical system metres, upwards?"""
    axis = CRS.from_epsg(code).axis_info[0]
    return axis.direction == "up" and axis.unit_conversion_factor == 1.0


def ranges(kind, is_good):
    """First and last codes: a code that is not good ends a range, one that is not assigned does not."""
    found, is_open = [], False
    for code in sorted(int(info.code) for info in query_crs_info("EPSG", kind, allow_deprecated=True)):
        good = is_good(code)
        if good and is_open:
            found[-1][1] = code
        elif good:
            found.append([code, code])
        is_open = good
    return [code for pair in found for code in pair]


def main():
    text = TARGET.read_text()
    for name, kind, is_good in (
        ("TRUE_TO_SCALE", PJType.PROJECTED_CRS, is_true_to_scale),
        ("HEIGHTS_IN_METRES", PJType.VERTICAL_CRS, is_upwards_in_metres),
    ):
        codes = ranges(kind, is_good)
        before, rest = text.split(f"pub(super) const {name}: ")
        after = rest[rest.index("];") + 2 :]
        text = f"{before}pub(super) const {name}: [u16; {len(codes)}] = [{', '.join(map(str, codes))}];{after}"
    TARGET.write_text(text)
    print(f"wrote {TARGET}: format it with `cargo fmt`")


if __name__ == "__main__":
    main()
