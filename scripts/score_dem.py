#!/usr/bin/env python3
"""How close a height map comes to the ground it was rebuilt from.

    score_dem.py TRUTH.tif INTERVAL DEM.tif [DEM.tif ...]

TRUTH holds the heights that contour lines were cut from at INTERVAL metres, each DEM what was built from those lines
alone, on the same grid. Cells count where all of them have data. A row a DEM:

    rmse   root mean square error, divided by the interval
    p95    95 % of the errors are at most this, divided by the interval
    slope  root mean square error of the slope angle, degrees (Horn)
    flat   share of cells flatter than 0.5 degrees where the truth is steeper than 3 degrees, per cent: terraces
"""
import sys

import numpy as np
import rasterio


def read(path):
    with rasterio.open(path) as source:
        heights = source.read(1).astype(float)
        if source.nodata is not None:
            heights[heights == source.nodata] = np.nan
        return heights, source.transform


def slope(heights, dx, dy):
    p = np.pad(heights, 1, mode="edge")
    east = p[:-2, 2:] + 2 * p[1:-1, 2:] + p[2:, 2:] - p[:-2, :-2] - 2 * p[1:-1, :-2] - p[2:, :-2]
    south = p[2:, :-2] + 2 * p[2:, 1:-1] + p[2:, 2:] - p[:-2, :-2] - 2 * p[:-2, 1:-1] - p[:-2, 2:]
    return np.degrees(np.arctan(np.hypot(east / (8 * dx), south / (8 * dy))))


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    truth, transform = read(sys.argv[1])
    interval = float(sys.argv[2])
    dx, dy = transform.a, -transform.e
    truth_slope = slope(truth, dx, dy)
    dems = []
    for path in sys.argv[3:]:
        heights, placed = read(path)
        if heights.shape != truth.shape or not np.allclose(placed[:6], transform[:6]):
            sys.exit(f"{path}: not on the grid of {sys.argv[1]}")
        dems.append((path, heights, slope(heights, dx, dy)))
    use = np.isfinite(truth_slope) & np.all([np.isfinite(s) for _, _, s in dems], axis=0)
    print(f"{'':32s}{'rmse':>9s}{'p95':>9s}{'slope':>9s}{'flat':>9s}   over {use.sum()} cells")
    for path, heights, angle in dems:
        error = np.abs(heights - truth)[use] / interval
        steep = use & (truth_slope > 3)
        row = [
            np.sqrt((error**2).mean()),
            np.percentile(error, 95),
            np.sqrt(((angle - truth_slope)[use] ** 2).mean()),
            100 * (angle[steep] < 0.5).mean(),
        ]
        print(f"{path[-32:]:32s}" + "".join(f"{v:9.3f}" for v in row))


if __name__ == "__main__":
    main()
