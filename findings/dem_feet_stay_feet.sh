#!/usr/bin/env bash
# The good guess: a DEM in NAVD88 height (US survey feet), reprojected to the same grid with NAVD88 height (metres), is divided by
#   3.28. The CRS of source and target say so, and pyproj does it with single points.
# What really happens: rasterio.warp.reproject, WarpedVRT and rioxarray leave every height as it is, and the result carries the CRS
#   in metres: 1000 ft have become 1000 m.
# Version: rasterio 1.4.4 (GDAL 3.10.3), rioxarray 0.19.0, pyproj 3.7.2.
# Source: undocumented for rasterio and rioxarray as far as we found. The program gdalwarp shifts heights by its manual (-novshift).
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q rasterio==1.4.4 rioxarray==0.19.0 pyproj==3.7.2 numpy==2.4.6
export PROJ_NETWORK=OFF
unset PROJ_DATA PROJ_LIB
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
import sys
import numpy as np
import pyproj
import rasterio
import rioxarray
from rasterio.transform import from_origin
from rasterio.vrt import WarpedVRT
from rasterio.warp import reproject

print("rasterio", rasterio.__version__, "GDAL", rasterio.__gdal_version__, "rioxarray", rioxarray.__version__, "pyproj", pyproj.__version__)
feet, metres = "EPSG:6339+6360", "EPSG:6339+5703"
place = from_origin(500_000, 4_000_040, 10, 10)
with rasterio.open("feet.tif", "w", driver="GTiff", width=4, height=4, count=1, dtype="float32", crs=feet, transform=place) as f:
    f.write(np.full((4, 4), 1000, "float32"), 1)

point = pyproj.Transformer.from_crs(feet, metres, always_xy=True).transform(500_020, 4_000_020, 1000)[2]
with rasterio.open("feet.tif") as f:
    into = np.zeros((4, 4), "float32")
    reproject(rasterio.band(f, 1), into, dst_crs=metres, dst_transform=place)
    with WarpedVRT(f, crs=metres) as vrt:
        through_vrt, vrt_crs = vrt.read(1)[1, 1], vrt.crs
array = rioxarray.open_rasterio("feet.tif").rio.reproject(metres)
print(f"one point with pyproj: {point:.4f} m")
print(f"reproject: {into[1, 1]}, WarpedVRT: {through_vrt}, rioxarray: {float(array[0, 1, 1])}")
unit = pyproj.CRS(array.rio.crs.to_wkt()).axis_info[-1].unit_name
print("unit of height in the CRS of rioxarray's result:", unit)

ok = (
    abs(point - 304.8006) < 0.001
    and into[1, 1] == 1000
    and through_vrt == 1000
    and float(array[0, 1, 1]) == 1000
    and unit == "metre"
    and vrt_crs == rasterio.crs.CRS.from_user_input(metres)
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
