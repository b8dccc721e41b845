#!/usr/bin/env bash
# The good guess: geopandas.testing.assert_geodataframe_equal fails if two layers of 3-D contours have different heights. So does
#   geom_equals_exact with a tolerance of 0.
# What really happens: both compare x and y only. A layer whose lines all lie 800 m higher, or have no heights at all, is "equal",
#   also with check_less_precise, which uses the exact comparison. A test suite built on it does not see lost heights.
#   geom_equals_identical and == of shapely do see them.
# Version: geopandas 1.2.0, shapely 2.2.0 (GEOS 3.14.1).
# Source: undocumented for geopandas.testing as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q geopandas==1.2.0 shapely==2.2.0 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import sys
import geopandas
import shapely
from geopandas.testing import assert_geodataframe_equal

print("geopandas", geopandas.__version__, "shapely", shapely.__version__, "GEOS", shapely.geos_version_string)


def layer(*heights):
    lines = [shapely.LineString([(0, 0, z), (1, 1, z)]) for z in heights]
    return geopandas.GeoDataFrame({"name": ["a", "b"]}, geometry=lines, crs=6677)


def passes(a, b, **options):
    try:
        assert_geodataframe_equal(a, b, **options)
        return True
    except AssertionError:
        return False


low, high = layer(100, 110), layer(900, 910)
flat = low.set_geometry(shapely.force_2d(low.geometry.values))
flat = flat.set_crs(6677)
moved = low.set_geometry(low.translate(xoff=1))
seen = {
    "800 m higher": passes(low, high),
    "800 m higher, check_less_precise": passes(low, high, check_less_precise=True),
    "no heights": passes(low, flat),
    "1 m to the east": passes(low, moved),
    "geom_equals_exact": bool(low.geom_equals_exact(high, 0).all()),
    "geom_equals_identical": bool(low.geometry.geom_equals_identical(high.geometry).all()),
    "== of shapely": low.geometry[0] == high.geometry[0],
}
for name, equal in seen.items():
    print(f"{name}: {'equal' if equal else 'different'}")
ok = list(seen.values()) == [True, True, True, False, True, False, False]
sys.exit(0 if ok else "The behaviour has changed.")
PY
