#!/usr/bin/env python3
"""Runs tokosen on random maps whose ground is known, and counts broken promises.

    random_maps.py [--program TOKOSEN] [--maps 200] [--seed 1] [--only KIND] [--cells 60,300] [--quick] [--keep FOLDER] [--jobs 2]

Every random ground is cut into contours and given in one of several ways (known_ground/kinds.py). A row per kind counts:

  moved      vertices of the input that are not in the output bit for bit
  crossings  pairs of lines of different levels that share a point, and lines that touch themselves
  band       cells outside the two levels around the ground
  holes      cells inside the frame without a height
  spots      spot heights, and vertices of break lines, that the height map misses by more than a thousandth of the interval
  lake       cells beside a lake that lie below its level
  sheets     cells that differ from the whole map's by more than 0.051 intervals
  rises      places along streams where they rise, or where their cells do though no contour wants it
  coast      cells of the sea that are not level, and cells of the land that are not higher
  base       cells on a base that differ from the map inside its frame, or from the base too much outside
  threads    files that differ between one and two threads
  warned     maps that have an error or a warning about the input, though nothing is wrong with it
  failed     runs that did not end with exit status 0

Exit status 1 if anything was counted. --keep leaves the files of maps with faults in a folder. --quick runs 20 small maps of
the kinds that have no faults, which must stay so with every change.
"""
import argparse
import concurrent.futures
import os
import pathlib
import shutil
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
from known_ground import counts, ground, kinds

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = ROOT / "target" / "release" / "tokosen"
QUICK = {"cells": (60, 70), "maps": 20}


def one(kind, number, o):
    """A random map of a kind, and its counts: none if the ground has no place for what the kind needs."""
    random = np.random.default_rng([o.seed, number])
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        found = kind(ground.ground(random, o.cells), folder, random)
        if found is None:
            return None
        found.ground.write(folder / "ground.tif")
        counted = counts.counted(o.program, folder, found)
        if o.keep and any(counted.values()):
            shutil.copytree(folder, o.keep / f"{number}_{kind.__name__}", dirs_exist_ok=True)
        return counted
    finally:
        shutil.rmtree(folder)


def options():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default=BINARY, type=lambda p: pathlib.Path(p).resolve())
    a.add_argument("--maps", default=200, type=int)
    a.add_argument("--seed", default=1, type=int)
    a.add_argument("--only", default="", help="kinds with this in their name")
    a.add_argument("--cells", default=(60, 300), type=lambda t: tuple(map(int, t.split(","))), help="fewest and most rows and columns")
    a.add_argument("--quick", action="store_true")
    a.add_argument("--keep", type=pathlib.Path)
    a.add_argument("--jobs", default=os.cpu_count(), type=int)
    o = a.parse_args()
    if o.quick:
        vars(o).update(QUICK)
    return o


def main():
    o = options()
    use = kinds.QUICK if o.quick else kinds.KINDS
    maps = [(use[n % len(use)], n) for n in range(o.maps) if o.only in use[n % len(use)].__name__]
    if not maps:
        sys.exit(f"no map is of a kind with {o.only!r} in its name")
    total = {kind.__name__: [0, dict.fromkeys(counts.COLUMNS, 0)] for kind, _ in maps}
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        for (kind, number), counted in zip(maps, pool.map(lambda m: one(*m, o), maps)):
            if counted is None:
                continue
            row = total[kind.__name__]
            row[0] += 1
            if any(counted.values()):
                print(f"map {number}, {kind.__name__}: " + ", ".join(f"{c} {n}" for c, n in counted.items() if n), flush=True)
            for column, count in counted.items():
                row[1][column] += count
    print(f"{'kind':24}{'maps':>6}" + "".join(f"{c:>10}" for c in counts.COLUMNS))
    for kind, (made, counted) in total.items():
        print(f"{kind:24}{made:6}" + "".join(f"{n:10}" for n in counted.values()))
    sys.exit(any(n for _, counted in total.values() for n in counted.values()))


if __name__ == "__main__":
    main()
