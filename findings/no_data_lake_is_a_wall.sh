#!/usr/bin/env bash
# The good guess: filling depressions treats cells without data inside the DEM (a lake, the sea in a bay) as places where water
#   leaves, in every flow tool.
# What really happens: pysheds treats them as a wall. A valley that drains into a lake without data is filled to the rim of the DEM:
#   the shore rises by 8 m and all slopes are gone. pyflwdir takes the same cells as an outlet and changes nothing.
# Version: pysheds 0.5, pyflwdir 0.5.12.
# Source: undocumented as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q pysheds==0.5 pyflwdir==0.5.12 rasterio==1.4.4 numpy==2.4.6
# Compiling would take minutes; 21 x 21 cells need none.
export NUMBA_DISABLE_JIT=1
cd "$dir"
"$dir/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import pyflwdir
import rasterio
from pysheds.grid import Grid
from rasterio.transform import from_origin

print("pysheds", version("pysheds"), "pyflwdir", version("pyflwdir"))
n = 21
y, x = np.mgrid[0:n, 0:n]
dem = (10 + np.hypot(x - 10, y - 10)).astype("float32")  # a round valley
dem[9:12, 9:12] = -9999  # the lake in its middle
with rasterio.open("dem.tif", "w", driver="GTiff", width=n, height=n, count=1, dtype="float32", nodata=-9999,
                   crs="EPSG:6677", transform=from_origin(0, n * 10, 10, 10)) as f:
    f.write(dem, 1)

grid = Grid.from_raster("dem.tif")
raster = grid.read_raster("dem.tif")
pysheds = np.asarray(grid.fill_depressions(grid.fill_pits(raster)))
other, _ = pyflwdir.dem.fill_depressions(dem.copy(), nodata=-9999)
land = dem != -9999
print("no-data value known to pysheds:", float(raster.nodata))
for name, filled in (("DEM", dem), ("pysheds", pysheds), ("pyflwdir", other)):
    print(f"{name}: from the rim to the shore", filled[10, :9].tolist())
raised = float((pysheds - dem)[land].max()), float((other - dem)[land].max())
print(f"largest rise: pysheds {raised[0]:.1f} m, pyflwdir {raised[1]:.1f} m")
ok = float(raster.nodata) == -9999 and raised[0] > 7 and raised[1] == 0
sys.exit(0 if ok else "The behaviour has changed.")
PY
