#!/usr/bin/env bash
# The good guess: a contour of one height in DXF reaches a GIS at that height, whether it is an LWPOLYLINE (elevation in group 38) or
#   the older 2-D POLYLINE (elevation in group 30 of the POLYLINE).
# What really happens: GDAL, and with it QGIS and geopandas, uses the elevation of the LWPOLYLINE only. A 2-D POLYLINE that ezdxf
#   writes at 50 m arrives as a 3-D line at 0 m; only z on each VERTEX would count. Within ezdxf itself, points() gives 0 as well
#   and points_in_wcs() gives 50.
# Version: ezdxf 1.4.5, pyogrio 0.13.0 (GDAL 3.12.4).
# Source: undocumented for GDAL as far as we found. The DXF reference keeps the elevation of a 2-D polyline in group 30.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q ezdxf==1.4.5 pyogrio==0.13.0 geopandas==1.2.0 numpy==2.4.6
cd "$dir"
"$dir/venv/bin/python" -W ignore - <<'PY'
import sys
import ezdxf
import pyogrio

print("ezdxf", ezdxf.__version__, "pyogrio", pyogrio.__version__, "GDAL", pyogrio.__gdal_version_string__)
drawing = ezdxf.new("R2010")
model = drawing.modelspace()
model.add_lwpolyline([(0, 0), (10, 0)], dxfattribs={"elevation": 50, "layer": "LWPOLYLINE"})
model.add_polyline2d([(0, 0), (10, 0)], dxfattribs={"elevation": (0, 0, 50), "layer": "POLYLINE"})
drawing.saveas("contours.dxf")

old = ezdxf.readfile("contours.dxf").modelspace().query("POLYLINE").first
own = {p.z for p in old.points()}, {p.z for p in old.points_in_wcs()}
lines = pyogrio.read_dataframe("contours.dxf").set_index("Layer").geometry
gdal = {name: {c[2] for c in lines[name].coords} for name in lines.index}
print("POLYLINE in ezdxf, points():", own[0], "points_in_wcs():", own[1])
print("heights in GDAL:", gdal)
ok = own == ({0.0}, {50.0}) and gdal == {"LWPOLYLINE": {50.0}, "POLYLINE": {0.0}}
sys.exit(0 if ok else "The behaviour has changed.")
PY
