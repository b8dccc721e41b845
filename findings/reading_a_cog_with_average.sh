#!/usr/bin/env bash
# The good guess: dataset.read(out_shape=..., resampling=Resampling.average) of a DEM returns averages, whether the file has
#   overviews or not.
# What really happens: if an overview is near the wanted size, GDAL starts from it, and if it has exactly the size, the resampling is
#   not used at all. In a COG whose overviews were made with the method nearest (as rio-cogeo does if not told otherwise), "average"
#   returns single cells. The same request through WarpedVRT (or reproject) averages the full resolution.
# Version: rasterio 1.4.4 (GDAL 3.10.3), rio-cogeo 7.0.4.
# Source: GDAL's documentation of RasterIO mentions overviews; what becomes of the resampling is undocumented in rasterio as far as
#   we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q rasterio==1.4.4 rio-cogeo==7.0.4 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import rasterio
from rasterio.enums import Resampling
from rasterio.transform import from_origin
from rasterio.vrt import WarpedVRT
from rio_cogeo import cog_profiles, cog_translate

print("rasterio", rasterio.__version__, "GDAL", rasterio.__gdal_version__, "rio-cogeo", version("rio-cogeo"))
n = 1024
dem = np.zeros((n, n), "float32")
dem[1::2, 1::2] = 100  # in each 2 x 2 cells, one is 100 m high: the mean is 25 m
with rasterio.open("plain.tif", "w", driver="GTiff", width=n, height=n, count=1, dtype="float32", crs="EPSG:6677",
                   transform=from_origin(0, n, 1, 1)) as f:
    f.write(dem, 1)
cog_translate("plain.tif", "cog.tif", cog_profiles.get("deflate"), quiet=True)


def direct(name):
    with rasterio.open(name) as f:
        return float(f.read(1, out_shape=(n // 2, n // 2), resampling=Resampling.average).mean())


def warped(name):
    with rasterio.open(name) as f:
        with WarpedVRT(f, transform=from_origin(0, n, 2, 2), width=n // 2, height=n // 2, resampling=Resampling.average) as vrt:
            return float(vrt.read(1).mean())


with rasterio.open("cog.tif") as f:
    print("overviews of the COG:", f.overviews(1))
seen = {"plain file, read": direct("plain.tif"), "COG, read": direct("cog.tif"), "COG, WarpedVRT": warped("cog.tif")}
print("mean of all cells after asking for averages:", seen)
ok = abs(seen["plain file, read"] - 25) < 0.01 and seen["COG, read"] in (0.0, 100.0) and abs(seen["COG, WarpedVRT"] - 25) < 0.01
sys.exit(0 if ok else "The behaviour has changed.")
PY
