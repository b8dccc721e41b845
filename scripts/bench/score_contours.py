#!/usr/bin/env python3
"""How close densified contour lines come to the true ones, in place, in height and in shape.

    score_contours.py CONTOURS TRUTH.tif --given 20 --interval 4 [--layer NAME] [--json]
    score_contours.py CONTOURS TRUTH.tif --given 20 --interval 4 --dem DEM.tif      # beside the contours of a height map
    score_contours.py CONTOURS TRUTH.tif --given 20 --interval 4 --turned           # given contours that lie on no raster

TRUTH holds the heights that contour lines were cut from at the given interval; CONTOURS is what was made of those lines
alone at the finer interval, with the given lines among them or not. The true lines are cut from TRUTH through its
cell centres. Only levels count that are multiples of the finer interval and not of the given one: the new ones.
With --turned, the true lines and the given contours are those that benchmark_accuracy.py cuts with that option.

Distance. Both sets of lines are sampled every half cell, and the distance from each sample to the nearest line of the same
level of the other set is measured, exactly, to the segments. Samples count that lie between four heights of TRUTH, one
cell inside the convex hull of the given contours and off a border of 1 % of the grid.

A distance is at most CAP, and is CAP where there is no line of the level at all. By default CAP (--cap) is the mean
spacing of the given contours there: area divided by length of lines. A missing or invented line thus counts as wrong by
one mean spacing, however far away the next line of its level is.

Height error. The smooth surface through the cells of TRUTH is the cubic spline, which passes through every cell. The error
of a sample is its height minus the level of the line. With --dem, the contours that a plain contourer cuts from DEM at the
new levels are scored too. The true lines have a height error because they run straight between their vertices. Missing lines
have no height error: they count in the distances alone, true to new.

Bends. Each line is cut into even pieces of about one cell, so that dense and sparse vertices give the same figure. Where two
pieces meet, the line turns by an angle. The figure is the mean of these angles per cell of length. Bends shorter than two
cells are not seen.

Output, lengths in map units, one row per direction:

    new to true   from the new lines to the true ones: lines in the wrong place, or invented
    true to new   from the true lines to the new ones: lines in the wrong place, or missing
    mean, median, p95    of the capped distances (95 % are at most p95)
    at cap        share of the samples at CAP, per cent: invented or missing
    length        length of lines that was sampled

and the sum of both means, which is the score: less is better. Then one row per set of lines (new, true, dem):

    RMSE, p95     root mean square height error, and what 95 % of the height errors are at most, in units of height
    share         each of them as a share of the given interval
    bends         degrees per cell of length
    to true       bends, divided by those of the true lines: above 1, the lines wind more than the true ones

All figures count each sample by the length of its piece of line.
"""
import argparse
import json
import pathlib
import sys
from typing import NamedTuple

import numpy as np
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
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
    share = np.split((within + 0.5) / count[line], np.cumsum(count)[:-1])
    xy = np.concatenate([places(*pair) for pair in zip(lines, share)])
    return xy, number[line], piece[line]


def places(line, share):
    """Points on the line at shares of its length."""
    # shapely would walk along the line from its start for each point, which long lines make slow.
    corner = shapely.get_coordinates(line)
    along = np.r_[0, np.cumsum(np.hypot(*np.diff(corner, axis=0).T))]
    return np.column_stack([np.interp(share * along[-1], along, axis) for axis in corner.T])


def height_figures(error, weight, given):
    """Height error along lines, in units of height and as shares of the given interval."""
    rmse = float(np.sqrt((error**2 * weight).sum() / weight.sum()))
    p95 = quantile(np.abs(error), weight, 0.95)
    return {"rmse": rmse, "p95": p95, "rmse_share": rmse / given, "p95_share": p95 / given, "length": float(weight.sum())}


def turns(line, step):
    """Where even pieces of about `step` meet on the line, the angle there in degrees, and the length of a piece."""
    closed, length = shapely.is_closed(line), shapely.length(line)
    # The smallest ring that turns by a full circle has three pieces.
    count = max(3 if closed else 1, round(length / step))
    xy = places(line, np.linspace(0, 1, count + 1))
    if closed:
        xy = np.vstack([xy, xy[1]])
    heading = np.degrees(np.arctan2(*np.diff(xy, axis=0).T))
    angle = np.abs((np.diff(heading) + 180) % 360 - 180)
    return xy[1:-1], angle, np.full(len(angle), length / count)


def bends(lines, step, counts):
    """Mean turning of the lines per `step` of length, degrees, where the function `counts` says that a place counts."""
    xy, angle, length = (np.concatenate(part) for part in zip(*(turns(line, step) for line in lines)))
    use = counts(xy)
    return float(step * angle[use].sum() / length[use].sum()) if use.any() else float("nan")


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


def quantile(values, weight, share):
    """The value that this share of the weight is at most."""
    order = np.argsort(values)
    below = np.cumsum(weight[order]) / weight.sum()
    return float(values[order][np.searchsorted(below, share).clip(max=len(order) - 1)])


def figures(distance, weight, cap):
    """Figures of one direction; a sample counts by the length of its piece of line."""
    return {
        "mean": float((distance * weight).sum() / weight.sum()),
        "median": quantile(distance, weight, 0.5),
        "p95": quantile(distance, weight, 0.95),
        "at_cap": float(100 * weight[distance >= cap].sum() / weight.sum()),
        "length": float(weight.sum()),
    }


class Lines(NamedTuple):
    """Lines of the new levels, and samples along them that count."""

    lines: np.ndarray
    number: np.ndarray  # of each line's level, in units of the interval
    xy: np.ndarray  # of each sample
    level: np.ndarray  # its number too
    weight: np.ndarray  # length of its piece of line


def sampled(which, lines, levels, interval, given, step, counts):
    """The lines of the new levels with their samples; exits where there are none."""
    number, use = new_levels(levels, interval, given)
    if not use.any():
        sys.exit(f"no {which} line has a level at {interval:g} that is not one at {given:g}")
    lines, number = shapely.force_2d(lines[use]), number[use]
    xy, level, weight = samples(lines, number, step)
    inside = counts(xy)
    if not inside.any():
        sys.exit(f"no {which} line lies in the area that counts")
    return Lines(lines, number, xy[inside], level[inside], weight[inside])


def score(lines, levels, truth, transform, interval, given, cap=None, cut=terrain.contours, dem=None):
    """All figures for lines with levels against a grid of true heights.

    The function `cut` makes the true lines and the given ones; `dem` is a height map and its transform.
    """
    cell = transform.a
    given_lines, _ = cut(truth, transform, given)
    if not len(given_lines):
        sys.exit(f"the truth has no contours at an interval of {given:g}")
    area = terrain.scored_area(truth.shape, transform, given_lines)
    if cap is None:
        cap = area.area / shapely.length(shapely.intersection(shapely.multilinestrings(list(given_lines)), area))

    def counts(xy):
        # True lines end at the last centres with a height, so all four centres around a sample must have one.
        return shapely.contains_xy(area, xy) & terrain.between_known(truth, *terrain.to_grid(transform, *xy.T))

    sets = {"new": (lines, levels), "true": cut(truth, transform, interval)}
    if dem is not None:
        sets["dem"] = terrain.contours(*dem, interval)
    sets = {which: sampled(which, *pair, interval, given, cell / 2, counts) for which, pair in sets.items()}
    out = {"cap": float(cap)}
    for a, b in (("new", "true"), ("true", "new")):
        distance = distances(sets[a].xy, sets[a].level, sets[b].lines, sets[b].number, cap)
        out[f"{a}_to_{b}"] = figures(distance, sets[a].weight, cap)
    out["sum"] = out["new_to_true"]["mean"] + out["true_to_new"]["mean"]
    out["height"] = {}
    for which, s in sets.items():
        error = terrain.spline_heights(truth, transform, *s.xy.T) - s.level * interval
        out["height"][which] = height_figures(error, s.weight, given)
    turning = {which: bends(s.lines, cell, counts) for which, s in sets.items()}
    out["bends"] = {which: {"degrees": t, "to_true": t / turning["true"] if turning["true"] else float("nan")}
                    for which, t in turning.items()}
    return out


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("contours")
    a.add_argument("truth")
    a.add_argument("--given", type=float, required=True, help="interval of the contours that were given")
    a.add_argument("--interval", type=float, default=2.0, help="interval of the densified contours (2)")
    a.add_argument("--cap", type=float, help="greatest distance that counts, map units")
    a.add_argument("--dem", help="height map whose contours are scored beside the new lines")
    a.add_argument("--turned", action="store_true", help="the given contours lie on no raster")
    a.add_argument("--layer", help="layer of CONTOURS (the first)")
    a.add_argument("--elev", help="attribute of CONTOURS that holds the elevation (found by its name)")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if not 0 < o.interval < o.given or (o.cap is not None and o.cap <= 0):
        a.error("the interval lies between 0 and the given one, and the cap above 0")
    truth, transform = terrain.read_dem(o.truth)
    lines, levels = terrain.read_lines(o.contours, o.layer, o.elev)
    cut = terrain.turned_contours if o.turned else terrain.contours
    out = score(lines, levels, truth, transform, o.interval, o.given, o.cap, cut, terrain.read_dem(o.dem) if o.dem else None)
    if o.json:
        print(json.dumps(out, indent=1))
        return
    print(f"{'':14s}{'mean':>9s}{'median':>9s}{'p95':>9s}{'at cap':>9s}{'length':>12s}   cap {out['cap']:.3f}")
    for name in ("new_to_true", "true_to_new"):
        f = out[name]
        print(f"{name.replace('_', ' '):14s}{f['mean']:9.3f}{f['median']:9.3f}{f['p95']:9.3f}{f['at_cap']:9.2f}"
              f"{f['length']:12.0f}")
    print(f"{'sum':14s}{out['sum']:9.3f}\n")
    print(f"{'':14s}{'RMSE':>9s}{'share':>9s}{'p95':>9s}{'share':>9s}{'bends':>9s}{'to true':>9s}")
    for name, f in out["height"].items():
        bend = out["bends"][name]
        print(f"{name + ' lines':14s}{f['rmse']:9.3f}{f['rmse_share']:9.4f}{f['p95']:9.3f}{f['p95_share']:9.4f}"
              f"{bend['degrees']:9.2f}{bend['to_true']:9.3f}")


if __name__ == "__main__":
    main()
