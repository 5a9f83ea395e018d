"""A raster of slopes to a raster of slip demands with xarray: labels and dimensions stay."""

import numpy as np
import xarray as xr

from grouser import soils, wheel

CONTACT = wheel.WheelOnSoil(wheel.Wheel(radius_m=0.125, width_m=0.1), soils.find("dry-sand"))


def slip_demand(slope_deg: xr.DataArray, weight_n: float) -> xr.DataArray:
    return xr.apply_ufunc(lambda slope: wheel.slip_demand(CONTACT, weight_n=weight_n, slope_deg=slope).slip, slope_deg)


if __name__ == "__main__":
    slope = xr.DataArray(np.linspace(-3.0, 6.0, 60).reshape(6, 10), dims=("y", "x"), name="slope_deg")
    print(slip_demand(slope, weight_n=80.0).round(3))
