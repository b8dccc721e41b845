#!/usr/bin/env bash
# The good guess: contour tools differ by where a line runs between cells, but agree on which lines there are. The contours of a
#   DEM turned upside down are the same lines.
# What really happens: where flat ground lies exactly at a level, they disagree on whether there is a contour at all. contourpy
#   (matplotlib) and scikit-image draw the shore of a lake at 100 m and nothing around a table hill whose top is at 100 m;
#   d3-contour draws the table hill and, in place of the lake, no ring at all. With heights in whole metres this is common.
#   A pit of one cell at the level becomes, in contourpy, a closed ring of five equal points.
# Version: contourpy 1.3.3, scikit-image 0.26.0, d3-contour 4.0.3.
# Source: the documentation of contourpy says for filled contours which end belongs to a band; for lines we found nothing.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
python3 -m venv venv
venv/bin/pip install -q contourpy==1.3.3 scikit-image==0.26.0 numpy==2.4.6
npm install --silent --no-fund --no-audit d3-contour@4.0.3
cat > d3.mjs <<'JS'
import {readFileSync} from 'fs';
import {contours} from 'd3-contour';
const {size, grids} = JSON.parse(readFileSync('grids.json', 'utf8'));
// Rings that do not run along the border of the grid.
const inside = ring => ring.every(([x, y]) => x > 0.5 && y > 0.5 && x < size - 0.5 && y < size - 0.5);
for (const {level, values} of grids) {
  const rings = contours().size([size, size]).contour(values, level).coordinates.flat();
  console.log(rings.filter(inside).length);
}
JS
venv/bin/python - <<'PY'
import json
import subprocess
import sys
import contourpy
import numpy as np
import skimage
from skimage.measure import find_contours

d3_version = json.load(open("node_modules/d3-contour/package.json"))["version"]
print("contourpy", contourpy.__version__, "scikit-image", skimage.__version__, "d3-contour", d3_version)
y, x = np.mgrid[0:20, 0:20]
r = np.hypot(x - 10, y - 10)
lake = np.where(r < 5, 100.0, 100.7 + 3 * (r - 5))  # flat at 100 m, the ground around it is higher
mesa = 200 - lake  # flat at 100 m, the ground around it is lower
grids = {"lake": (lake, 100.0), "table hill": (mesa, 100.0), "lake upside down": (-lake, -100.0)}
with open("grids.json", "w") as f:
    json.dump({"size": 20, "grids": [{"level": l, "values": z.ravel().tolist()} for z, l in grids.values()]}, f)
d3 = [int(n) for n in subprocess.run(["node", "d3.mjs"], check=True, capture_output=True, text=True).stdout.split()]
seen = {
    name: (len(contourpy.contour_generator(z=z).lines(level)), len(find_contours(z, level)), d3[i])
    for i, (name, (z, level)) in enumerate(grids.items())
}
for name, counts in seen.items():
    print(f"{name}: contourpy {counts[0]}, scikit-image {counts[1]}, d3-contour {counts[2]} lines")
pit = np.zeros((7, 7))
pit[3, 3] = -10
ring = contourpy.contour_generator(z=pit).lines(-10.0)
print("a pit of one cell at the level, contourpy:", [line.tolist() for line in ring], "scikit-image:", find_contours(pit, -10.0))

ok = (
    seen == {"lake": (1, 1, 0), "table hill": (0, 0, 1), "lake upside down": (0, 0, 1)}
    and len(ring) == 1 and len(ring[0]) == 5 and len(np.unique(ring[0], axis=0)) == 1
    and find_contours(pit, -10.0) == []
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
