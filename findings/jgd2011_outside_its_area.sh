#!/usr/bin/env bash
# The good guess: PROJ uses a coordinate operation inside its area of use. Where the grid for an area is not installed, the point
#   fails, or the stated accuracy is "unknown".
# What really happens: JGD2000 (EPSG:4612) to JGD2011 (EPSG:6668) on the Oshika peninsula, where the ground moved by about 5 m in
#   2011, returns the same coordinates and states an accuracy of 1 m. It uses the operation that changes nothing, whose area of
#   use says "excluding northern prefectures". The operation for these prefectures needs a grid that is not installed.
#   only_best=True does not help.
# Version: pyproj 3.7.2 (PROJ 9.5.1), without further grids.
# Source: undocumented as far as we found. TransformerGroup.unavailable_operations shows what is missing.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q pyproj==3.7.2
# Only the data of the wheel: no network, no grids of other installations.
export PROJ_NETWORK=OFF PROJ_USER_WRITABLE_DIRECTORY="$dir"
unset PROJ_DATA PROJ_LIB
"$dir/venv/bin/python" - <<'PY'
import sys
import warnings
import pyproj
from pyproj import Transformer
from pyproj.transformer import TransformerGroup

warnings.simplefilter("ignore")
print("pyproj", pyproj.__version__, "PROJ", pyproj.proj_version_str)
oshika = (38.3, 141.5)
plain = Transformer.from_crs(4612, 6668)
result = plain.transform(*oshika)
try:
    best = Transformer.from_crs(4612, 6668, only_best=True).transform(*oshika)
except Exception as e:
    best = str(e)
group = TransformerGroup(4612, 6668)
used = group.transformers[0]
print("in", oshika, "out", result, "only_best", best)
print("operation:", plain.description, "| accuracy", plain.accuracy, "m")
print("its area:", used.area_of_use.name)
print("not available:", [(o.name, o.accuracy) for o in group.unavailable_operations])

ok = (
    result == oshika
    and best == oshika
    and plain.accuracy == 1.0
    and "excluding northern prefectures" in used.area_of_use.name
    and [o.name for o in group.unavailable_operations] == ["JGD2000 to JGD2011 (1)"]
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
