#!/usr/bin/env python3
"""Checks the contours of a map (`--supplementary`, `--scale`, `--thin`) without any code of tokosen, and prints their figures.

    check_map.py map.gpkg                         # kinds, shares, pieces, crossings
    check_map.py map.gpkg --scale 25000           # and the rules of that scale
    check_map.py map.gpkg --own other.geojson     # and how much of the supplementary contours of another map is in it

A row for each kind of contour has the number of lines, their share of the length of all, the shortest open line and the number of
rings. With --scale, lengths are millimetres on the map, and the rules are checked:

  closest   lines of different levels keep 0.25 mm, apart from two index contours; maps without --thin do not keep it
  ring      no ring is smaller than 1 mm in both directions
  vertices  vertices for each millimetre of line; not a rule

The exit status is 1 if lines meet or a rule does not hold. Lines are in a plane of metres, with the attributes elev and kind.
"""
import argparse
import sys

import numpy as np
import pyogrio
import shapely

CLOSEST, RING = 0.25, 1.0  # millimetres on the map
NEAR = 100.0  # metres between a contour and that of another map which it stands for
ROUNDING = 1e-6


def read(path):
    """Lines, and their elevations and kinds."""
    meta, _, wkb, columns = pyogrio.raw.read(path)
    fields = dict(zip(meta["fields"], columns))
    if "kind" not in fields:
        sys.exit(f"{path}: the lines have no attribute kind")
    return shapely.force_2d(shapely.from_wkb(wkb)), fields["elev"], fields["kind"]


def meetings(lines, levels):
    """Pairs of lines that meet, apart from vertices that lines of one level share, and lines that meet themselves."""
    a, b = shapely.STRtree(lines).query(lines, predicate="intersects")
    use = a < b
    pairs = zip(lines[a[use]], lines[b[use]], levels[a[use]] == levels[b[use]])
    return sum(not (same and share(one, other)) for one, other, same in pairs), int((~shapely.is_simple(lines)).sum())


def share(one, other):
    """Whether two lines meet at vertices of both alone."""
    at, *both = (set(map(tuple, shapely.get_coordinates(each))) for each in (shapely.intersection(one, other), one, other))
    return shapely.length(shapely.intersection(one, other)) == 0 and all(at <= vertices for vertices in both)


def closest(lines, levels, kinds, within):
    """The smallest distance between lines of different levels, up to `within`: of two index contours, and of all other pairs."""
    a, b = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=within)
    use = (a < b) & (levels[a] != levels[b])
    a, b = a[use], b[use]
    distance = shapely.distance(lines[a], lines[b])
    is_index = (kinds[a] == "index") & (kinds[b] == "index")
    return [distance[which].min(initial=within) for which in (is_index, ~is_index)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", nargs="+")
    parser.add_argument("--scale", type=float, help="the number of the scale")
    parser.add_argument("--own", help="a map with lines whose attribute objtype is Hjelpekurve")
    args = parser.parse_args()
    sys.exit(any([check(path, args.scale, args.own) for path in args.map]))


def check(path, scale, own):
    lines, levels, kinds = read(path)
    unit = scale / 1000 if scale else 1.0
    name = "mm" if scale else "m"
    length = shapely.length(lines) / unit
    rings = shapely.is_ring(lines)
    print(f"{path}: {len(lines)} lines")
    for kind in np.unique(kinds):
        of = kinds == kind
        shortest = length[of & ~rings].min(initial=np.inf)
        share = length[of].sum() / length.sum()
        print(f"  {kind:21} {of.sum():5} lines, {share:6.1%} of the length, shortest {shortest:.1f} {name}, {(of & rings).sum()} rings")
    meet, selves = meetings(lines, levels)
    print(f"  {meet} pairs of lines meet, {selves} lines meet themselves")
    wrong = meet + selves
    if scale:
        limit = 2 * CLOSEST
        of_index, of_others = (found / unit for found in closest(lines, levels, kinds, limit * unit))
        said = [f"{found:.3f}" if found < limit else f"over {limit}" for found in (of_index, of_others)]
        low, high = np.split(shapely.bounds(lines[rings]), 2, axis=1)
        ring = ((high - low).max(axis=1) / unit).min(initial=np.inf)
        print(f"  closest: two index contours {said[0]} mm, others {said[1]} mm; smallest ring {ring:.2f} mm; "
              f"{shapely.get_num_coordinates(lines).sum() / length.sum():.2f} vertices a mm")
        wrong += (of_others < CLOSEST - ROUNDING) + (ring < RING - ROUNDING)
    if own:
        beside(lines[np.char.startswith(kinds.astype(str), "supplementary")], own)
    return bool(wrong)


def beside(lines, path):
    """How much of the supplementary contours of a map is near the given ones, and the reverse."""
    meta, _, wkb, columns = pyogrio.raw.read(path)
    is_own = dict(zip(meta["fields"], columns))["objtype"] == "Hjelpekurve"
    theirs = shapely.force_2d(shapely.from_wkb(wkb[is_own]))
    ours, around = (shapely.union_all(shapely.buffer(set_, NEAR)) for set_ in (lines, theirs))
    found = shapely.length(shapely.intersection(theirs, ours)).sum() / shapely.length(theirs).sum()
    extra = shapely.length(shapely.difference(lines, around)).sum()
    print(f"  of {shapely.length(theirs).sum() / 1000:.0f} km of the other map, {found:.0%} are drawn; {extra / 1000:.0f} km of "
          f"{shapely.length(lines).sum() / 1000:.0f} km are where it has none")


if __name__ == "__main__":
    main()
