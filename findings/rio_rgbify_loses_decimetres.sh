#!/usr/bin/env bash
# The good guess: heights in whole decimetres fit the 0.1 m steps of Mapbox terrain tiles, so rio-rgbify stores them exactly. Other
#   heights are rounded to the nearest step.
# What really happens: it cuts off instead of rounding. In binary, (12.3 + 10000) / 0.1 is a little less than a whole number, so
#   12.3 m becomes 12.2 m. Of the heights from 0 to 999.9 m in steps of 0.1 m, four in ten come back 0.1 m too low, and heights
#   of any other kind are too low by 0.05 m on average: contours shift downhill. Round to (h + 10000) * 10 and encode yourself.
# Version: rio-rgbify 0.4.0.
# Source: undocumented as far as we found; see data_to_rgb in rio_rgbify/encoders.py.
set -euo pipefail
export PIP_DISABLE_PIP_VERSION_CHECK=1
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
python3 -m venv "$dir/venv"
"$dir/venv/bin/pip" install -q rio-rgbify==0.4.0 rasterio==1.4.4 numpy==2.4.6
"$dir/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from rio_rgbify.encoders import data_to_rgb

print("rio-rgbify", version("rio-rgbify"))


def back(heights):
    r, g, b = data_to_rgb(heights.reshape(1, -1).copy(), -10000, 0.1).astype("int64")[:, 0, :]
    return -10000 + (r * 65536 + g * 256 + b) / 10


decimetres = np.arange(10_000) / 10
error = np.round(back(decimetres) - decimetres, 3)
low = int((error == -0.1).sum())
print(f"heights in whole decimetres: {low} of {len(error)} come back 0.1 m too low, the others right: {set(error.tolist())}")
print("12.3 m comes back as", round(float(back(np.array([12.3]))[0]), 1))
any_height = np.random.default_rng(1).uniform(0, 1000, 100_000)
mean = float((back(any_height) - any_height).mean())
print(f"any heights: mean error {mean:.3f} m")

ok = 3000 < low < 5000 and set(error.tolist()) == {-0.1, 0.0} and -0.06 < mean < -0.04
sys.exit(0 if ok else "The behaviour has changed.")
PY
