#!/usr/bin/env bash
# The good guess: in a State Plane system in US survey feet the height is in feet too, so 1000 becomes 304.8 m in WGS 84; and if
#   nothing is said of heights, they stay as they are.
# What really happens: it depends on how the third axis was asked for. New York Long Island (EPSG:2263), made 3-D with to_3d(),
#   has easting and northing in feet and height in metres: 1000 stays 1000. With NAVD88 in feet (EPSG:2263+6360) to 3-D WGS 84
#   it is 304.8 (without the geoid, since its grid is not there). The same source to 2-D WGS 84 gives 1000
#   back: feet, next to coordinates in degrees. Nothing warns in any of the three.
# Version: pyproj 3.7.2 (PROJ 9.5.1), without further grids.
# Source: undocumented in pyproj as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q pyproj==3.7.2
# Only the data of the wheel: no network, no grids of other installations.
export PROJ_NETWORK=OFF PROJ_USER_WRITABLE_DIRECTORY="$dir"
unset PROJ_DATA PROJ_LIB
"$dir/venv/bin/python" -W error - <<'PY'
import sys
import pyproj
from pyproj import CRS, Transformer

print("pyproj", pyproj.__version__, "PROJ", pyproj.proj_version_str)
made_3d = CRS("EPSG:2263").to_3d()
units = [axis.unit_name for axis in made_3d.axis_info]
print("axes of EPSG:2263 made 3-D:", units)


def height(source, target):
    return round(Transformer.from_crs(source, target, always_xy=True).transform(1_000_000, 200_000, 1000)[2], 1)


seen = {
    "2263 made 3-D, to 4979": height(made_3d, "EPSG:4979"),
    "2263+6360 to 4979": height("EPSG:2263+6360", "EPSG:4979"),
    "2263+6360 to 4326": height("EPSG:2263+6360", "EPSG:4326"),
}
print(seen)
ok = units == ["US survey foot", "US survey foot", "metre"] and list(seen.values()) == [1000.0, 304.8, 1000.0]
sys.exit(0 if ok else "The behaviour has changed.")
PY
