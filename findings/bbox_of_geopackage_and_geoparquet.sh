#!/usr/bin/env bash
# The good guess: geopandas.read_file(..., bbox=box) of a GeoPackage and geopandas.read_parquet(..., bbox=box) of the same
#   layer in GeoParquet give the same contours.
# What really happens: GDAL tests the lines themselves, so a contour that bends around the box is left out. read_parquet compares
#   bounding boxes only, so it comes back. Long contours have large boxes: of 40 nested C-shaped contours, none of which comes
#   near the box, GeoPackage, FlatGeobuf and Shapefile give 0 and GeoParquet 40.
# Version: geopandas 1.2.0, pyogrio 0.13.0 (GDAL 3.12.4), pyarrow 26.0.1.
# Source: pyogrio says of its bbox that geometries are tested if GDAL has GEOS. The documentation of read_parquet does not say what
#   is compared.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q geopandas==1.2.0 pyogrio==0.13.0 pyarrow==26.0.1 shapely==2.2.0 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" - <<'PY'
import sys
import geopandas
import numpy as np
import pyogrio
import shapely

print("geopandas", geopandas.__version__, "pyogrio", pyogrio.__version__, "GDAL", pyogrio.__gdal_version_string__)
angle = np.linspace(0, 1.5 * np.pi, 200)
contours = [shapely.LineString(np.c_[r * np.cos(angle), r * np.sin(angle)]) for r in range(100, 140)]
layer = geopandas.GeoDataFrame({"elev": range(100, 140)}, geometry=contours, crs=6677)
box = (-10, -10, 10, 10)
layer.to_file("a.gpkg")
layer.to_file("a.fgb")
layer.to_file("a.shp")
layer.to_parquet("a.parquet", write_covering_bbox=True)
truth = int(layer.intersects(shapely.box(*box)).sum())
seen = {
    "gpkg": len(geopandas.read_file("a.gpkg", bbox=box)),
    "gpkg, arrow": len(geopandas.read_file("a.gpkg", bbox=box, use_arrow=True)),
    "fgb": len(geopandas.read_file("a.fgb", bbox=box)),
    "shp": len(geopandas.read_file("a.shp", bbox=box)),
    "parquet": len(geopandas.read_parquet("a.parquet", bbox=box)),
}
print("contours that meet the box:", truth, "read:", seen)
ok = truth == 0 and seen == {"gpkg": 0, "gpkg, arrow": 0, "fgb": 0, "shp": 0, "parquet": 40}
sys.exit(0 if ok else "The behaviour has changed.")
PY
