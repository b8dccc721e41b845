#!/usr/bin/env python3
"""Checks the lines of `tokosen contour` against the height map that they are from.

    check_contour.py --command target/release/tokosen DEM.tif INTERVAL [DEM.tif INTERVAL ...] [--tolerance CELLS]

For each height map, the lines are made at the interval, and compared with those that contourpy traces through the cell
centres: straight pieces with a vertex on each side of a square that is crossed, as gdal_contour traces them. A row of
the table has:

  crossings   pairs of segments that meet, apart from neighbours on a line
  off         largest distance between a line and contourpy's lines of the same level, both ways, in cells
  ends        open lines that end neither at the outermost cell centres nor beside a cell without data
  wrong       lines with higher ground on the left
  share       vertices, as a share of contourpy's
  time        seconds of the whole program, and of its step "tracing"; each the best of three
  contourpy   seconds of contourpy's serial tracing of the same levels, the best of three
  ratio       whole program / contourpy

The exit status is 1 if lines meet, are off by more than the tolerance, end inside, or have higher ground on the left.
"""
import argparse
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import contourpy
import numpy as np
import pyogrio
import rasterio
import shapely


def traced(z, levels):
    """contourpy's lines by level, as columns and rows of cell centres, and the best time of three."""
    best, found = math.inf, {}
    for _ in range(3):
        start = time.perf_counter()
        generator = contourpy.contour_generator(z=np.ma.masked_invalid(z), name="serial", corner_mask=False)
        # contourpy takes a height that equals the level as below it. Just under the level, it is above.
        found = {level: generator.lines(np.nextafter(level, -np.inf)) for level in levels}
        best = min(best, time.perf_counter() - start)
    return found, best


def written(command, path, interval, tolerance):
    """The lines of the program, and the best times of three of the program and of its tracing."""
    whole, tracing = math.inf, math.inf
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "lines.fgb"
        arguments = [command, "contour", path, "-i", str(interval), "-o", str(out), "--overwrite", "-v"]
        arguments += ["--tolerance", repr(tolerance)] if tolerance is not None else []
        for _ in range(3):
            start = time.perf_counter()
            text = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout
            whole = min(whole, time.perf_counter() - start)
            tracing = min(tracing, float(re.search(r"tracing ([0-9.]+)", text)[1]))
        _, _, geometry, fields = pyogrio.raw.read(out, columns=["elev", "closed"])
    return shapely.force_2d(shapely.from_wkb(geometry)), fields[0], fields[1].astype(bool), whole, tracing


def segments_of(lines):
    """Start and end of all segments, and the line of each."""
    coordinates, line = shapely.get_coordinates(lines, return_index=True)
    same = line[1:] == line[:-1]
    return coordinates[:-1][same], coordinates[1:][same], line[:-1][same]


def meetings(lines):
    start, end, line = segments_of(lines)
    pieces = shapely.linestrings(np.stack([start, end], axis=1))
    a, b = shapely.STRtree(pieces).query(pieces, predicate="intersects")
    a, b = a[a < b], b[a < b]
    neighbours = (line[a] == line[b]) & ((end[a] == start[b]).all(1) | (end[b] == start[a]).all(1))
    # Neighbours may only share their vertex.
    along = np.einsum("ij,ij->i", end[a] - start[a], end[b] - start[b])
    turn = np.cross(np.pad(end[a] - start[a], ((0, 0), (0, 1))), np.pad(end[b] - start[b], ((0, 0), (0, 1))))[:, 2]
    return int((~neighbours | ((turn == 0) & (along < 0))).sum())


def distances(points, lines):
    """The distance of each point to the nearest segment of the lines."""
    start, end, _ = segments_of(lines)
    tree = shapely.STRtree(shapely.linestrings(np.stack([start, end], axis=1)))
    (point, _), found = tree.query_nearest(shapely.points(points), return_distance=True, all_matches=False)
    off = np.full(len(points), np.inf)
    off[point] = found
    return off


def densified(lines, step):
    return shapely.get_coordinates(shapely.segmentize(lines, step))


def off(z, lines, elevations, raw):
    """The largest distance between both kinds of lines, in cells."""
    largest = 0.0
    for level, traced_lines in raw.items():
        of_level = lines[elevations == level]
        traced_lines = linestrings(traced_lines)
        if len(of_level) == 0:
            continue
        largest = max(largest, distances(densified(of_level, 0.2), traced_lines).max())
        largest = max(largest, distances(densified(traced_lines, 0.2), of_level).max())
    return largest


def wrong_ends(z, lines, is_closed):
    ends = np.concatenate([shapely.get_coordinates(shapely.get_point(lines[~is_closed], i)) for i in (0, -1)])
    has_data = np.isfinite(z)
    square = has_data[1:, 1:] & has_data[1:, :-1] & has_data[:-1, 1:] & has_data[:-1, :-1]
    square = np.pad(square, 1)
    wrong = 0
    for x, y in ends:
        on_x, on_y = abs(x - round(x)) < 1e-6, abs(y - round(y)) < 1e-6
        col, row = (round(x), math.floor(y)) if on_x else (math.floor(x), round(y))
        beside = (square[row + 1, col + 1], square[row + 1, col] if on_x else square[row, col + 1])
        wrong += on_x == on_y or beside[0] == beside[1]
    return wrong


def wrong_sides(z, lines, elevations):
    """Lines whose corners on the right are not all higher, where they cross sides of squares from west to east."""
    start, end, line = segments_of(lines)
    wrong = set()
    for s, e, l in zip(start, end, line):
        low, high = sorted((s[0], e[0]))
        for col in range(math.floor(low + 1e-6) + 1, math.ceil(high - 1e-6)):
            y = s[1] + (col - s[0]) / (e[0] - s[0]) * (e[1] - s[1])
            north, south = z[math.floor(y), col], z[math.floor(y) + 1, col]
            right = south if e[0] > s[0] else north
            left = north if e[0] > s[0] else south
            if not (right >= np.float32(elevations[l]) > left):
                wrong.add(int(l))
    return len(wrong)


def linestrings(lines):
    """Lines without repeated points; a line of one point is none."""
    kept = [l[np.r_[True, (np.diff(l, axis=0) != 0).any(1)]] for l in lines]
    return np.array([shapely.linestrings(l) for l in kept if len(l) > 1])


def row(command, path, interval, tolerance):
    with rasterio.open(path) as source:
        z, transform = source.read(1).astype(float), source.transform
        if source.nodata is not None:
            z[z == source.nodata] = np.nan
    z = z.astype(np.float32).astype(float)
    levels = [k * interval for k in range(math.ceil(np.nanmin(z) / interval), math.floor(np.nanmax(z) / interval) + 1)]
    raw, contourpy_time = traced(z, levels)
    cell = min(transform.a, -transform.e)
    lines, elevations, is_closed, whole, tracing = written(command, path, interval, tolerance and tolerance * cell)
    in_cells = shapely.transform(
        lines, lambda p: np.column_stack([(p[:, 0] - transform.c) / transform.a, (p[:, 1] - transform.f) / transform.e]) - 0.5
    )
    count = int(shapely.get_num_coordinates(lines).sum())
    before = sum(len(l) for lines in raw.values() for l in lines)
    return {
        "crossings": meetings(lines),
        "off": off(z, in_cells, elevations, raw),
        "ends": wrong_ends(z, in_cells, is_closed),
        "wrong": wrong_sides(z, in_cells, elevations),
        "lines": len(lines),
        "vertices": count,
        "before": before,
        "share": count / before,
        "whole": whole,
        "tracing": tracing,
        "contourpy": contourpy_time,
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="+", metavar="DEM INTERVAL")
    parser.add_argument("--command", default="tokosen")
    parser.add_argument("--tolerance", type=float, help="cells; default: the program's own, half a cell")
    args = parser.parse_args()
    if len(args.maps) % 2:
        parser.error("each height map needs an interval")
    most = (args.tolerance if args.tolerance is not None else 0.5) + 1e-6
    print(f"{'map':24} {'crossings':>9} {'off':>6} {'ends':>4} {'wrong':>5} {'lines':>6} {'vertices':>8} {'share':>6} "
          f"{'time':>12} {'contourpy':>9} {'ratio':>5}")
    failed, count, before = False, 0, 0
    for path, interval in zip(args.maps[::2], args.maps[1::2]):
        r = row(args.command, path, float(interval), args.tolerance)
        print(f"{Path(path).stem + ' ' + interval:24} {r['crossings']:9} {r['off']:6.3f} {r['ends']:4} {r['wrong']:5} "
              f"{r['lines']:6} {r['vertices']:8} {r['share']:6.3f} {r['whole']:5.2f} ({r['tracing']:4.2f}) "
              f"{r['contourpy']:9.3f} {r['whole'] / r['contourpy']:5.2f}", flush=True)
        failed |= r["crossings"] > 0 or r["off"] > most or r["ends"] > 0 or r["wrong"] > 0
        count, before = count + r["vertices"], before + r["before"]
    print(f"all: share of vertices {count / before:.3f}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
