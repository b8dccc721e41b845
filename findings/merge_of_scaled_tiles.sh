#!/usr/bin/env bash
# The good guess: merging two neighbouring DEM tiles that hold integers with scale and offset keeps the heights, or refuses.
# What really happens: both tiles hold the count 5000; by their own scale and offset that is 150 m in one and 350 m in the other.
#   rasterio.merge copies the counts and writes no scale at all: 5000 m everywhere. rioxarray.merge copies the counts and keeps
#   the scale and offset of the first tile: 150 m everywhere, with nothing that looks wrong. No warning in either.
#   (rioxarray with mask_and_scale=True decodes first and is right.)
# Version: rasterio 1.4.4, rioxarray 0.19.0.
# Source: undocumented as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q rasterio==1.4.4 rioxarray==0.19.0 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" -W error::UserWarning - <<'PY'
import sys
import numpy as np
import rasterio
import rasterio.merge
import rioxarray
from rasterio.transform import from_origin
from rioxarray.merge import merge_arrays

print("rasterio", rasterio.__version__, "GDAL", rasterio.__gdal_version__, "rioxarray", rioxarray.__version__)


def tile(name, west, offset):
    with rasterio.open(name, "w", driver="GTiff", width=4, height=4, count=1, dtype="int16", nodata=-32768,
                       crs="EPSG:6677", transform=from_origin(west, 40, 10, 10)) as f:
        f.write(np.full((4, 4), 5000, "int16"), 1)
        f.scales, f.offsets = (0.01,), (offset,)


def heights(name):
    """The westernmost and the easternmost height, with the scale and offset that the file states."""
    with rasterio.open(name) as f:
        row = f.read(1)[0] * f.scales[0] + f.offsets[0]
        return round(float(row[0]), 2), round(float(row[-1]), 2)


tile("west.tif", 0, 100.0)
tile("east.tif", 40, 300.0)
rasterio.merge.merge(["west.tif", "east.tif"], dst_path="rasterio.tif")
merge_arrays([rioxarray.open_rasterio(n) for n in ("west.tif", "east.tif")]).rio.to_raster("rioxarray.tif")
decoded = merge_arrays([rioxarray.open_rasterio(n, mask_and_scale=True) for n in ("west.tif", "east.tif")])
right = round(float(decoded[0, 0, 0]), 2), round(float(decoded[0, 0, -1]), 2)
print("tiles:", heights("west.tif")[0], heights("east.tif")[0])
print("rasterio.merge:", heights("rasterio.tif"), "rioxarray.merge:", heights("rioxarray.tif"), "decoded first:", right)

ok = (
    heights("rasterio.tif") == (5000.0, 5000.0)
    and heights("rioxarray.tif") == (150.0, 150.0)
    and right == (150.0, 350.0)
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
