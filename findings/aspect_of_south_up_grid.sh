#!/usr/bin/env bash
# The good guess: xarray-spatial takes the direction of north from the y coordinates of the DataArray, as it takes the size of cells.
# What really happens: it uses only the distance of the coordinates. The same ground, stored with y upwards (as netCDF files
#   usually are) instead of downwards (as GeoTIFF), gets the opposite aspect, 180 degrees instead of 0, and a hillshade lit from
#   the opposite side. Slope is the same. Sort first: dem.sortby("y", ascending=False).
# Version: xarray-spatial 0.5.3.
# Source: undocumented as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q xarray-spatial==0.5.3 numpy==2.4.6
"$dir/venv/bin/python" -W error::UserWarning - <<'PY'
import sys
import numpy as np
import xarray
import xrspatial

print("xarray-spatial", xrspatial.__version__)
x, y = np.arange(20) * 10.0, np.arange(20) * 10.0
# The ground falls to the north: height goes down with y.
south_up = xarray.DataArray(1000 - 0.5 * y[:, None] + 0 * x[None, :], coords={"y": y, "x": x}, dims=("y", "x"))
north_up = south_up.sortby("y", ascending=False)


def at(result):
    return round(float(result.sel(x=100, y=100)), 2)


seen = {
    name: (at(xrspatial.slope(dem)), at(xrspatial.aspect(dem)), at(xrspatial.hillshade(dem, azimuth=0, angle_altitude=45)))
    for name, dem in (("north up", north_up), ("south up", south_up))
}
for name, values in seen.items():
    print(f"{name}: slope {values[0]}, aspect {values[1]} (0 is north), lit from the north {values[2]}")
same_heights = bool((north_up.sel(y=50, x=50) == south_up.sel(y=50, x=50)).all())

ok = (
    same_heights
    and seen["north up"][0] == seen["south up"][0]
    and seen["north up"][1] == 0
    and seen["south up"][1] == 180
    and seen["north up"][2] > 0.9
    and seen["south up"][2] < 0.3
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
