#!/usr/bin/env python3
"""Errors of height maps against the true ground.

    score_dem.py TRUTH.tif INTERVAL DEM.tif [DEM.tif ...] [--lines SKELETON.gpkg] [--json]

TRUTH holds the heights that contour lines were cut from at INTERVAL metres. Each DEM was built from those lines alone, on
the same grid. Only cells where all of them have data count. One row per DEM:

    rmse   root mean square error, divided by the interval
    p95    95 % of the errors are at most this, divided by the interval
    slope  root mean square error of the slope angle, degrees (Horn)
    flat   share of cells flatter than 0.5 degrees where the truth is steeper than 3 degrees, per cent: terraces
    pits   cells lower than all eight neighbours
    beads  artefact pits along valleys: pits whose centre is within a cell of a canyon line (with --lines, the file of
           `tokosen skeleton`)
    meets  share of the contours' vertices where the height map, bilinear between cell centres, is within 2 % of the
           interval of the contour's level, per cent

The contours are cut from TRUTH again; their vertices count for `meets` where every other contour line is at least two
cells away, because one grid cannot meet both of two nearer lines. The first row is the truth itself, because real ground
has pits too.
"""
import argparse
import json
import pathlib
import sys

import numpy as np
import pyogrio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import terrain

MEETS = 0.02  # of the interval: a height map that is so near meets the contour
APART = 2.0  # cells between a contour's vertex and any other contour, for the vertex to count
CHUNK = 16  # segments in one piece of a line in the spatial index


def slope(heights, dx, dy):
    p = np.pad(heights, 1, mode="edge")
    east = p[:-2, 2:] + 2 * p[1:-1, 2:] + p[2:, 2:] - p[:-2, :-2] - 2 * p[1:-1, :-2] - p[2:, :-2]
    south = p[2:, :-2] + 2 * p[2:, 1:-1] + p[2:, 2:] - p[:-2, :-2] - 2 * p[:-2, 1:-1] - p[:-2, 2:]
    return np.degrees(np.arctan(np.hypot(east / (8 * dx), south / (8 * dy))))


def pits(heights):
    """Cells lower than all eight neighbours; a cell that lacks one of them is none."""
    rows, columns = heights.shape
    p = np.pad(heights, 1, constant_values=np.nan)
    around = [p[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
    return np.all([heights < a for a in around], axis=0)


def canyon_lines(path):
    """The lines of kind canyon among those that `tokosen skeleton` wrote."""
    try:
        meta, _, wkb, columns = pyogrio.raw.read(path, layer=0)
    except pyogrio.errors.DataSourceError as e:
        sys.exit(str(e))
    fields = dict(zip(meta["fields"], columns))
    if wkb is None or "kind" not in fields:
        sys.exit(f"{path}: no ridge and canyon lines (no attribute kind)")
    return shapely.force_2d(shapely.from_wkb(wkb[fields["kind"] == "canyon"]))


def near_lines(cells, lines, transform):
    """Which of the cells have their centre within a cell of a line."""
    row, column = np.nonzero(cells)
    if not len(row) or not len(lines):
        return np.zeros_like(cells)
    centres = shapely.points(*terrain.to_map(transform, row, column))
    point, _ = shapely.STRtree(lines).query(centres, predicate="dwithin", distance=transform.a)
    out = np.zeros_like(cells)
    out[row[point], column[point]] = True
    return out


def pieces(lines):
    """The lines cut into pieces of a few segments, and the line that each is of."""
    cut, owner = [], []
    for i, line in enumerate(lines):
        xy = shapely.get_coordinates(line)
        for start in range(0, len(xy) - 1, CHUNK):
            cut.append(xy[start : start + CHUNK + 1])
            owner.append(i)
    size = [len(c) for c in cut]
    return shapely.linestrings(np.concatenate(cut), indices=np.repeat(np.arange(len(cut)), size)), np.array(owner)


def lone_vertices(lines, levels, transform):
    """Vertices of the contours with no other contour line near: rows and columns (broken) and levels."""
    xy, owner = shapely.get_coordinates(lines, return_index=True)
    parts, part_owner = pieces(lines)
    vertex, part = shapely.STRtree(parts).query(shapely.points(xy), predicate="dwithin", distance=APART * transform.a)
    lone = np.ones(len(xy), bool)
    lone[vertex[owner[vertex] != part_owner[part]]] = False
    row, column = terrain.to_grid(transform, *xy[lone].T)
    return row, column, levels[owner[lone]]


def bilinear(heights, row, column):
    """Heights at broken rows and columns; NaN where one of the four cells has none that is needed."""
    r = np.clip(np.floor(row), 0, heights.shape[0] - 2).astype(int)
    c = np.clip(np.floor(column), 0, heights.shape[1] - 2).astype(int)
    out = np.zeros(len(row))
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        weight = np.abs(1 - i - (row - r)) * np.abs(1 - j - (column - c))
        # A vertex lies on an edge of the grid: the cells beside the edge have no weight and need no height.
        weight[weight < 1e-6] = 0
        out += np.where(weight > 0, weight * heights[r + i, c + j], 0)
    return out


def share_met(heights, use, vertices, interval):
    """Per cent of the vertices that the heights meet, of those nearest to a cell that counts."""
    row, column, level = vertices
    counts = use[np.round(row).astype(int).clip(0, use.shape[0] - 1), np.round(column).astype(int).clip(0, use.shape[1] - 1)]
    error = np.abs(bilinear(heights, row[counts], column[counts]) - level[counts])
    error = error[np.isfinite(error)]
    return 100 * float((error <= MEETS * interval).mean()) if len(error) else float("nan")


def score(heights, angle, truth, truth_slope, use, transform, interval, vertices, canyons):
    error = np.abs(heights - truth)[use] / interval
    steep = use & (truth_slope > 3)
    low = pits(heights) & use
    out = {
        "rmse": float(np.sqrt((error**2).mean())),
        "p95": float(np.percentile(error, 95)),
        "slope": float(np.sqrt(((angle - truth_slope)[use] ** 2).mean())),
        "flat": float(100 * (angle[steep] < 0.5).mean()) if steep.any() else float("nan"),
        "pits": int(low.sum()),
    }
    if canyons is not None:
        out["beads"] = int(near_lines(low, canyons, transform).sum())
    out["meets"] = share_met(heights, use, vertices, interval)
    return out


def compare(path, interval, dems, lines=None, cut=terrain.contours):
    """Cells that count, and the figures of the truth at `path` and of each height map among `dems`, by path.

    `cut` makes the contours of the truth that the height maps have to meet.
    """
    truth, transform = terrain.read_dem(path)
    dx, dy = transform.a, -transform.e
    truth_slope = slope(truth, dx, dy)
    read = [(path, truth, truth_slope)]
    for dem in dems:
        heights, placed = terrain.read_dem(dem)
        if heights.shape != truth.shape or not np.allclose(placed[:6], transform[:6]):
            sys.exit(f"{dem}: not on the grid of {path}")
        read.append((dem, heights, slope(heights, dx, dy)))
    use = np.all([np.isfinite(s) for _, _, s in read], axis=0)
    if not use.any():
        sys.exit("no cell has data in all of the height maps")
    vertices = lone_vertices(*cut(truth, transform, interval), transform)
    canyons = canyon_lines(lines) if lines else None
    return int(use.sum()), {
        dem: score(heights, angle, truth, truth_slope, use, transform, interval, vertices, canyons)
        for dem, heights, angle in read}


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("truth")
    a.add_argument("interval", type=float, help="of the contours, metres")
    a.add_argument("dem", nargs="+")
    a.add_argument("--lines", help="ridge and canyon lines, as `tokosen skeleton` writes them")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if not o.interval > 0:
        a.error("the interval is above 0")
    cells, rows = compare(o.truth, o.interval, o.dem, o.lines)
    if o.json:
        print(json.dumps({"cells": cells, "dems": rows}, indent=1))
        return
    print(f"{'':32s}" + "".join(f"{name:>9s}" for name in rows[o.truth]) + f"   over {cells} cells")
    for path, figures in rows.items():
        print(f"{path[-32:]:32s}" + "".join(f"{v:9d}" if isinstance(v, int) else f"{v:9.3f}" for v in figures.values()))


if __name__ == "__main__":
    main()
