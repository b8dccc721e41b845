#!/usr/bin/env bash
# The good guess: scipy.spatial.Delaunay makes every distinct point a vertex. A shift of all points changes nothing but rounding.
# What really happens: in projected coordinates (easting 500 km, northing 4000 km), points 0.25 m apart are left out by the
#   thousand, without a warning. LinearNDInterpolator, which stands on it, then gives wrong heights at its own data points.
#   Subtract an origin first. matplotlib.tri uses the same Qhull, subtracts the mean itself, and keeps every point.
# Version: scipy 1.17.1, matplotlib 3.11.2.
# Source: the attribute `coplanar` in the documentation of Delaunay says that points may be left out for numerical reasons.
#   That ordinary survey coordinates do it is undocumented as far as we found.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q scipy==1.17.1 matplotlib==3.11.2 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import sys
import matplotlib
import matplotlib.tri
import numpy as np
import scipy
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

print("scipy", scipy.__version__, "matplotlib", matplotlib.__version__)

# Twelve round contours of a hill, a vertex every 0.25 m. Each second vertex is 1 m higher, so that a lost one is felt.
rings, heights = [], []
for radius in range(5, 65, 5):
    n = int(2 * np.pi * radius / 0.25)
    angle = np.arange(n) / n * 2 * np.pi
    rings.append(np.c_[radius * np.cos(angle), radius * np.sin(angle)])
    heights.append(100.0 - radius + np.arange(n) % 2)
points, z = np.vstack(rings), np.concatenate(heights)
assert len(np.unique(points, axis=0)) == len(points)


def used(triangles):
    return len(np.unique(triangles))


def error(p):
    return np.nanmax(np.abs(LinearNDInterpolator(p, z)(p) - z))


near, far = points, points + (500_000.0, 4_000_000.0)
print(f"{len(points)} points. Vertices near the origin: {used(Delaunay(near).simplices)}, "
      f"in projected coordinates: {used(Delaunay(far).simplices)}, "
      f"matplotlib there: {used(matplotlib.tri.Triangulation(far[:, 0], far[:, 1]).triangles)}")
print(f"largest error at the data points themselves: near {error(near):.3f} m, far {error(far):.3f} m")

ok = (
    used(Delaunay(near).simplices) == len(points)
    and used(Delaunay(far).simplices) < 0.7 * len(points)
    and used(matplotlib.tri.Triangulation(far[:, 0], far[:, 1]).triangles) == len(points)
    and error(near) < 1e-6
    and error(far) > 0.5
)
sys.exit(0 if ok else "The behaviour has changed.")
PY
