#!/usr/bin/env bash
# The good guess: a contour line at 100 m that is clipped or merged still has 100 m at every vertex; a line without heights stays
#   without.
# What really happens: GEOS sets the height of a new vertex to the mean of the two lines that cross there. A clip polygon whose
#   heights are all 0 (as from KML or a PolygonZ shapefile) cuts a contour at 100 m to ends at 50 m. In a union, a line without
#   heights is given heights that were measured elsewhere.
#   Take the heights off the clip polygon (shapely.force_2d), and keep contours without heights apart.
# Version: shapely 2.2.0 (GEOS 3.14.1), geopandas 1.2.0.
# Source: comments in the C++ source of GEOS (OverlayNG, ElevationModel). shapely and geopandas do not mention it as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q shapely==2.2.0 geopandas==1.2.0 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import sys
import geopandas
import shapely
from shapely import LineString, Polygon

print("shapely", shapely.__version__, "GEOS", shapely.geos_version_string, "geopandas", geopandas.__version__)
contour = LineString([(0, 0, 100), (10, 0, 100)])
mask = Polygon([(2, -5, 0), (8, -5, 0), (8, 5, 0), (2, 5, 0)])
layer = geopandas.GeoDataFrame({"elev": [100]}, geometry=[contour], crs=6677)
clipped = geopandas.clip(layer, mask).geometry.iloc[0]
clipped_flat = geopandas.clip(layer, shapely.force_2d(mask)).geometry.iloc[0]
print("clipped with a polygon at height 0:      ", clipped.wkt)
print("clipped with a polygon without heights:  ", clipped_flat.wkt)

low = LineString([(0, 0, 100), (0, 10, 100)])
high = LineString([(100, 0, 300), (100, 10, 300)])
unknown = LineString([(50, 0), (50, 10)])
merged = shapely.union_all([low, high, unknown])
at_50 = [line for line in merged.geoms if line.coords[0][0] == 50][0]
print("a line without heights, after the union: ", at_50.wkt)

ok = (
    {c[2] for c in clipped.coords} == {50.0}
    and {c[2] for c in clipped_flat.coords} == {100.0}
    and {c[2] for c in at_50.coords} == {200.0}
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
