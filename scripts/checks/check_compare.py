#!/usr/bin/env python3
"""Checks the figures of `tokosen compare` against an independent computation.

    check_compare.py A.tif B.tif FIGURES.json [--contours LINES.gpkg] [--tolerance 1e-6]

FIGURES.json is what `tokosen compare A.tif B.tif --json` printed, or what it printed for the contours that A.tif was made
from. A and B are on one grid. With --contours the classes by distance to the nearest contour are checked too. The exit
status is 1 if a figure is off by more than the tolerance (relative where figures are above 1), or if there is nothing to
check.
"""
import argparse
import json
import pathlib
import sys

import numpy as np
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import terrain


def figures(d):
    size = np.abs(d)
    bias, median = d.mean(), np.median(d)
    return {
        "cells": len(d),
        "bias": bias,
        "rmse": np.sqrt((d**2).mean()),
        "rmse_debiased": d.std(),
        "mae": size.mean(),
        "median": median,
        "nmad": 1.4826 * np.median(np.abs(d - median)),
        "le90": np.quantile(size, 0.9),
        "le95": np.quantile(size, 0.95),
        "lowest": d.min(),
        "highest": d.max(),
    }


def gradient(heights, dx, dy):
    """Rise over run by Horn's eight neighbours, and whether all of them have heights.

    A neighbour that is missing is carried on in a straight line: one across an edge from the opposite one through the cell,
    one at a corner from the two beyond it in its column and in its row, else from the opposite one as well. A pair that
    is missing altogether follows from the other pairs as on a plane.
    """
    p = np.pad(heights, 1, constant_values=np.nan)
    rows, columns = heights.shape
    at = lambda down, right: p[1 + down : 1 + down + rows, 1 + right : 1 + right + columns]

    def corner(down, right):
        column = 2 * at(0, right) - at(-down, right)
        row = 2 * at(down, 0) - at(down, -right)
        return next_finite(at(down, right), (column + row) / 2, column, row)

    def pair(down, right, of=at):
        a, b = of(down, right), of(-down, -right)
        return np.where(np.isfinite(a), np.where(np.isfinite(b), a - b, 2 * (a - heights)), 2 * (heights - b))

    whole = np.all([np.isfinite(at(i, j)) for i in (-1, 0, 1) for j in (-1, 0, 1)], axis=0)
    ne, se = pair(-1, 1, corner), pair(1, 1, corner)
    east = next_finite(pair(0, 1), (ne + se) / 2, np.zeros_like(heights))
    north = next_finite(pair(-1, 0), (ne - se) / 2, np.zeros_like(heights))
    ne, se = next_finite(ne, east + north), next_finite(se, east - north)
    return np.hypot((2 * east + ne + se) / (8 * dx), (2 * north + ne - se) / (8 * dy)), whole


def next_finite(*choices):
    """The first choice that is a number, cell by cell."""
    out = choices[0]
    for choice in choices[1:]:
        out = np.where(np.isfinite(out), out, choice)
    return out


class Checks:
    def __init__(self, tolerance):
        self.tolerance, self.done, self.bad = tolerance, 0, 0

    def same(self, name, given, expected):
        self.done += 1
        if given is None or abs(given - expected) > self.tolerance * max(1.0, abs(expected)):
            self.bad += 1
            print(f"{name}: {given} is not {expected}")

    def statistics(self, name, given, d):
        if given is None or not len(d):
            self.same(f"{name}, cells", given["cells"] if given else 0, len(d))
            return
        for key, expected in figures(d).items():
            value = given[key]["value"] if isinstance(given[key], dict) else given[key]
            self.same(f"{name}, {key}", value, expected)

    def classes(self, name, given, value, d):
        for c in given:
            top = np.inf if c["to"] is None else c["to"]
            inside = (value >= c["from"]) & (value < top)
            self.statistics(f"{name} {c['from']} to {top}", c["statistics"], d[inside])


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("a")
    a.add_argument("b")
    a.add_argument("figures")
    a.add_argument("--contours", help="the contour lines, for distances to them")
    a.add_argument("--tolerance", type=float, default=1e-6)
    o = a.parse_args()
    heights_a, transform = terrain.read_dem(o.a)
    heights_b, placed = terrain.read_dem(o.b)
    if heights_a.shape != heights_b.shape or not np.allclose(placed[:6], transform[:6]):
        sys.exit("A and B are not on one grid")
    with open(o.figures) as f:
        found = json.load(f)
    checks = Checks(o.tolerance)
    use = np.isfinite(heights_a) & np.isfinite(heights_b)
    d = (heights_a - heights_b)[use]
    checks.statistics("all cells", found["overall"], d)
    row, column = np.nonzero(use)
    for key, pick in (("lowest", np.argmin), ("highest", np.argmax)):
        k = pick(d)
        x, y = terrain.to_map(transform, row[k], column[k])
        checks.same(f"{key}, x", found["overall"][key]["place"][0], x)
        checks.same(f"{key}, y", found["overall"][key]["place"][1], y)

    dx, dy = placed.a, -placed.e
    (steep_a, whole_a), (steep_b, whole_b) = gradient(heights_a, dx, dy), gradient(heights_b, dx, dy)
    slope_a, slope_b = np.degrees(np.arctan(steep_a)), np.degrees(np.arctan(steep_b))
    error = (slope_a - slope_b)[whole_a & whole_b]
    checks.same("slope, cells", found["slope"]["cells"], len(error))
    checks.same("slope, rmse", found["slope"]["rmse"], np.sqrt((error**2).mean()))
    checks.same("slope, bias", found["slope"]["bias"], error.mean())
    checks.classes("slope", found["by_slope"], slope_b[use], d)
    checks.classes("elevation", found["by_elevation"], heights_b[use], d)
    if o.contours:
        lines, _ = terrain.read_lines(o.contours)
        # Single segments, because the boxes around whole lines say little.
        ends = [np.stack([xy[:-1], xy[1:]], axis=1) for xy in map(shapely.get_coordinates, lines)]
        tree = shapely.STRtree(shapely.linestrings(np.concatenate(ends)))
        centres = shapely.points(*terrain.to_map(transform, row, column))
        _, distance = tree.query_nearest(centres, return_distance=True, all_matches=False)
        checks.classes("distance", found["by_distance"], distance, d)
    for side, heights in (("a", heights_a), ("b", heights_b)):
        levels = found[side]["levels"]
        if levels is None:
            continue
        h = heights[np.isfinite(heights)]
        bins = len(levels["shares"])
        of = np.floor(bins * (h - levels["base"]) / levels["interval"]) % bins
        for k, count in enumerate(np.bincount(of.astype(int), minlength=bins)):
            checks.same(f"levels of {side}, bin {k}", levels["shares"][k], count / len(h))
    if found["significance"]:
        beyond = (np.abs(d) > 1.96 * found["significance"]["sigma"]).mean()
        checks.same("significance", found["significance"]["share"], beyond)
    print(f"{checks.done} figures checked, {checks.bad} off")
    sys.exit(1 if checks.bad or not checks.done else 0)


if __name__ == "__main__":
    main()
