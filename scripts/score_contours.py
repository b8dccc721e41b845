#!/usr/bin/env python3
"""How close densified contour lines come to the true ones.

    score_contours.py CONTOURS TRUTH.tif --given 20 --interval 4 [--layer NAME] [--json]

TRUTH holds the heights that contour lines were cut from at the given interval; CONTOURS is what was made of those lines
alone at the finer interval, with the given lines among them or not. The true lines are cut from TRUTH through its
cell centres. Only levels count that are multiples of the finer interval and not of the given one: the new ones.

Both sets of lines are sampled every half cell, and the distance from each sample to the nearest line of the same
level of the other set is measured, exactly, to the segments. Samples count that lie between four heights of TRUTH, one
cell inside the convex hull of the given contours and off a border of 1 % of the grid.

A distance is at most CAP, and is CAP where there is no line of the level at all. By default CAP (--cap) is the mean
spacing of the given contours there: area divided by length of lines. A missing or invented line thus counts as wrong by
one mean spacing, however far away the next line of its level is.

Output, lengths in map units, one row per direction:

    new to true   from the new lines to the true ones: lines in the wrong place, or invented
    true to new   from the true lines to the new ones: lines in the wrong place, or missing
    mean, median, p95    of the capped distances (95 % are at most p95)
    at cap        share of the samples at CAP, per cent: invented or missing
    length        length of lines that was sampled

and the sum of both means, which is the score: less is better.
"""
import argparse
import json
import sys

import numpy as np
import shapely

import terrain


def whole(values):
    """Which quotients are whole numbers, up to rounding of the level."""
    return np.abs(values - np.round(values)) < 1e-6


def new_levels(levels, interval, given):
    """Number of each line's level in units of the interval, and which lines are of a new level."""
    return np.round(levels / interval).astype(int), whole(levels / interval) & ~whole(levels / given)


def samples(lines, number, step):
    """Points in the middle of even pieces of about `step` along each line, with their levels and pieces' lengths."""
    length = shapely.length(lines)
    count = np.maximum(1, np.round(length / step)).astype(int)
    piece = length / count
    line = np.repeat(np.arange(len(lines)), count)
    within = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    # shapely would walk along the line from its start for each point, which long lines make slow.
    xy = np.empty((len(line), 2))
    start = 0
    for i, geometry in enumerate(lines):
        corner = shapely.get_coordinates(geometry)
        along = np.r_[0, np.cumsum(np.hypot(*np.diff(corner, axis=0).T))]
        stop = start + count[i]
        at = (within[start:stop] + 0.5) * piece[i]
        xy[start:stop, 0] = np.interp(at, along, corner[:, 0])
        xy[start:stop, 1] = np.interp(at, along, corner[:, 1])
        start = stop
    return xy, number[line], piece[line]


def segments(lines):
    """Each segment as a line of its own, and the line that it is of."""
    xy, owner = shapely.get_coordinates(lines, return_index=True)
    same = owner[1:] == owner[:-1]
    pairs = np.stack([xy[:-1][same], xy[1:][same]], axis=1)
    return shapely.linestrings(pairs), owner[1:][same]


def distances(xy, level, lines, line_level, cap):
    """Distance of each point to the nearest line of its level, at most `cap`."""
    out = np.full(len(xy), cap)
    parts, owner = segments(lines)
    part_level = line_level[owner]
    for number in np.unique(level):
        here = np.flatnonzero(level == number)
        others = parts[part_level == number]
        if not len(others):
            continue
        (point, _), found = shapely.STRtree(others).query_nearest(
            shapely.points(xy[here]), max_distance=cap, return_distance=True, all_matches=False)
        out[here[point]] = np.minimum(found, cap)
    return out


def figures(distance, weight, cap):
    """Figures of one direction; a sample counts by the length of its piece of line."""
    order = np.argsort(distance)
    share = np.cumsum(weight[order]) / weight.sum()
    quantile = lambda q: float(distance[order][np.searchsorted(share, q).clip(max=len(order) - 1)])
    return {
        "mean": float((distance * weight).sum() / weight.sum()),
        "median": quantile(0.5),
        "p95": quantile(0.95),
        "at_cap": float(100 * weight[distance >= cap].sum() / weight.sum()),
        "length": float(weight.sum()),
    }


def score(lines, levels, truth, transform, interval, given, cap=None):
    """Both directions, the sum of their means and the cap, for lines with levels against a grid of true heights."""
    cell = transform.a
    given_lines, _ = terrain.contours(truth, transform, given)
    if not len(given_lines):
        sys.exit(f"the truth has no contours at an interval of {given:g}")
    area = terrain.scored_area(truth.shape, transform, given_lines)
    if cap is None:
        cap = area.area / shapely.length(shapely.intersection(shapely.multilinestrings(list(given_lines)), area))
    true_lines, true_levels = terrain.contours(truth, transform, interval)
    # True lines end at the last centres with a height, so all four centres around a sample must have one.
    known = np.isfinite(truth)
    between_known = known[:-1, :-1] & known[:-1, 1:] & known[1:, :-1] & known[1:, 1:]
    sets = []
    for which, lines, levels in (("new", lines, levels), ("true", true_lines, true_levels)):
        number, use = new_levels(levels, interval, given)
        if not use.any():
            sys.exit(f"no {which} line has a level at {interval:g} that is not one at {given:g}")
        lines, number = shapely.force_2d(lines[use]), number[use]
        xy, level, weight = samples(lines, number, cell / 2)
        row, column = (np.floor(a).astype(int) for a in terrain.to_grid(transform, xy[:, 0], xy[:, 1]))
        inside = shapely.contains_xy(area, xy)
        inside[inside] = between_known[row[inside], column[inside]]
        if not inside.any():
            sys.exit(f"no {which} line lies in the area that counts")
        sets.append((lines, number, xy[inside], level[inside], weight[inside]))
    out = {"cap": float(cap)}
    for name, a, b in (("new_to_true", *sets), ("true_to_new", *sets[::-1])):
        out[name] = figures(distances(a[2], a[3], b[0], b[1], cap), a[4], cap)
    out["sum"] = out["new_to_true"]["mean"] + out["true_to_new"]["mean"]
    return out


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("contours")
    a.add_argument("truth")
    a.add_argument("--given", type=float, required=True, help="interval of the contours that were given")
    a.add_argument("--interval", type=float, default=2.0, help="interval of the densified contours (2)")
    a.add_argument("--cap", type=float, help="greatest distance that counts, map units")
    a.add_argument("--layer", help="layer of CONTOURS (the first)")
    a.add_argument("--elev", help="attribute of CONTOURS that holds the elevation (found by its name)")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if not 0 < o.interval < o.given or (o.cap is not None and o.cap <= 0):
        a.error("the interval lies between 0 and the given one, and the cap above 0")
    truth, transform = terrain.read_dem(o.truth)
    lines, levels = terrain.read_lines(o.contours, o.layer, o.elev)
    out = score(lines, levels, truth, transform, o.interval, o.given, o.cap)
    if o.json:
        print(json.dumps(out, indent=1))
        return
    print(f"{'':14s}{'mean':>9s}{'median':>9s}{'p95':>9s}{'at cap':>9s}{'length':>12s}   cap {out['cap']:.3f}")
    for name in ("new_to_true", "true_to_new"):
        f = out[name]
        print(f"{name.replace('_', ' '):14s}{f['mean']:9.3f}{f['median']:9.3f}{f['p95']:9.3f}{f['at_cap']:9.2f}"
              f"{f['length']:12.0f}")
    print(f"{'sum':14s}{out['sum']:9.3f}")


if __name__ == "__main__":
    main()
