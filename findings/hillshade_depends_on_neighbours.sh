#!/usr/bin/env bash
# The good guess: matplotlib's LightSource.hillshade gives each cell the cosine of the angle to the light, as other hillshades do.
#   So a DEM may be shaded tile by tile.
# What really happens: each call stretches its result so that the darkest cell is 0 and the brightest 1. The same hill is shaded
#   differently when a steeper hill lies elsewhere in the array, and a nearly flat plain looks like mountains. Tiles get seams.
#   Only a plane without any change of slope keeps its true value.
# Version: matplotlib 3.11.2.
# Source: a comment in the code of LightSource.shade_normals. The documentation says only that 0 is in shadow and 1 is illuminated.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q matplotlib==3.11.2 numpy==2.4.6
"$dir/venv/bin/python" - <<'PY'
import sys
import matplotlib
import numpy as np
from matplotlib.colors import LightSource

print("matplotlib", matplotlib.__version__)
light = LightSource(azdeg=315, altdeg=45)
y, x = np.mgrid[0:50, 0:50]


def hill(height, width):
    return height * np.exp(-((x - 25) ** 2 + (y - 25) ** 2) / width)


def shade(dem):
    return light.hillshade(dem, dx=10, dy=10)


gentle, steep = hill(50, 200), hill(800, 60)
alone = shade(gentle)
beside = shade(np.hstack([gentle, steep]))[:, :50]
change = np.abs(alone - beside)[1:-1, 1:-2].max()  # without the edge, where the gradient sees the neighbour
ripple = shade(np.sin(x / 4) * 0.01)  # one centimetre
plane = shade((x + y) * 0.5)
print(f"the same hill alone and beside a steeper one: differs by up to {change:.2f} of 1")
print(f"waves of 1 cm over 10 m cells: from {ripple.min():.2f} to {ripple.max():.2f}; a plane: {plane.min():.3f} to {plane.max():.3f}")

ok = change > 0.2 and ripple.min() == 0 and ripple.max() == 1 and 0.7 < plane.min() <= plane.max() < 0.8
sys.exit(0 if ok else "The behaviour has changed.")
PY
