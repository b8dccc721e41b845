#!/usr/bin/env bash
# The good guess: simplify with a tolerance of 0, and cleanCoords, remove only what is redundant: the line afterwards is the same.
# What really happens: shapely (GEOS) and Turf decide in plan. A straight break line or road loses every vertex between its ends, and
#   with them the crest: 100, 180, 100 m becomes level at 100 m. The result is still 3-D, so nothing looks missing.
# Version: shapely 2.2.0 (GEOS 3.14.1), @turf/turf 7.4.0.
# Source: undocumented for heights as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
python3 -m venv venv
venv/bin/pip install -q shapely==2.2.0 numpy==2.4.6
npm install --silent --no-fund --no-audit @turf/turf@7.4.0
cat > run.mjs <<'JS'
import * as turf from '@turf/turf';
const road = turf.lineString([[139, 0, 100], [139.01, 0, 180], [139.02, 0, 100]]);
const heights = line => line.geometry.coordinates.map(c => c[2]);
console.log(JSON.stringify([heights(turf.cleanCoords(road)), heights(turf.simplify(road, {tolerance: 0}))]));
JS
venv/bin/python - <<'PY'
import json
import subprocess
import sys
import shapely

turf_version = json.load(open("node_modules/@turf/turf/package.json"))["version"]
print("shapely", shapely.__version__, "GEOS", shapely.geos_version_string, "@turf/turf", turf_version)
road = shapely.LineString([(0, 0, 100), (5, 0, 180), (10, 0, 100)])


def heights(line):
    return [z for _, _, z in line.coords]


clean, simple = json.loads(subprocess.run(["node", "run.mjs"], check=True, capture_output=True, text=True).stdout)
seen = {
    "shapely.simplify": heights(shapely.simplify(road, 0)),
    "shapely.simplify, no topology": heights(shapely.simplify(road, 0, preserve_topology=False)),
    "turf.cleanCoords": clean,
    "turf.simplify": simple,
}
print("heights of a straight line over a crest", heights(road), "afterwards:", seen)
sys.exit(0 if all(h == [100, 100] for h in seen.values()) else "The behaviour has changed.")
PY
