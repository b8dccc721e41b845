#!/usr/bin/env python3
"""Runs tokosen on random maps whose ground is known, and counts broken promises.

    random_maps.py [--program TOKOSEN] [--maps 200] [--seed 1] [--only KIND] [--keep FOLDER] [--jobs 2]

Every random ground is cut into contours and given in one of several ways: as a whole, in a rectangle, cut to a district
that is the frame too, in four sheets, with a lake, with spot heights, or made denser twice. A row per kind counts:

  moved      vertices of the input that are not in the output bit for bit
  crossings  pairs of lines of different levels that share a point, and lines that touch themselves
  band       cells outside the two levels around the ground
  holes      cells inside the frame without a height
  spots      spot heights that the height map misses by more than a thousandth of the interval
  lake       cells beside a lake that lie below its level
  sheets     cells that differ from the whole map's by more than 0.051 intervals
  threads    files that differ between one and two threads
  failed     runs that did not end with exit status 0

Exit status 1 if anything was counted. --keep leaves the files of maps with faults in a folder.
"""
import argparse
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from random_map_parts import checks, ground, maps

ROOT = pathlib.Path(__file__).resolve().parent.parent
BINARY = ROOT / "target" / "release" / "tokosen"
COLUMNS = ["moved", "crossings", "band", "holes", "spots", "lake", "sheets", "threads", "failed"]
SECONDS = 300


def run(program, folder, *command):
    done = subprocess.run(
        [str(program), *map(str, command)], cwd=folder, capture_output=True, text=True, timeout=SECONDS, check=False
    )
    if done.returncode:
        (folder / "said.txt").open("a").write(f"{command}\n{done.stderr}\n")
    return done.returncode == 0


def counted(program, folder, found):
    """The counts of a map."""
    counts = dict.fromkeys(COLUMNS, 0)
    lines, levels, inputs = found.lines, found.levels, found.inputs
    spacing = found.ground.interval
    for step in range(found.steps):
        spacing /= 2.0
        first = step == 0
        heights = ["--dem", "out.tif", "--like", "ground.tif"] if first else []
        good = True
        for threads in (1, 2) if first else (2,):
            made = folder / f"threads{threads}"
            made.mkdir(exist_ok=True)
            options = [f"../{o}" if (folder / o).exists() else o for o in map(str, found.options + heights)]
            options = [f"{o}" if o != "out.tif" else "out.tif" for o in options]
            paths = [f"../{name}" for name in inputs]
            good &= run(
                program, made, "densify", *paths, "-i", repr(spacing), *options, "-o", f"out{step}.gpkg", "--threads", threads, "-q"
            )
        if not good:
            counts["failed"] += 1
            return counts
        out_lines, out_levels = checks.read_lines(folder / "threads2" / f"out{step}.gpkg")
        counts["moved"] += checks.moved(lines, levels, out_lines, out_levels, found.original if first else None)
        counts["crossings"] += checks.crossings(out_lines, out_levels) + checks.loops(out_lines)
        if first:
            files = [[(folder / f"threads{t}" / name).read_bytes() for t in (1, 2)] for name in ("out0.gpkg", "out.tif")]
            counts["threads"] += sum(a != b for a, b in files)
            z = checks.read_heights(folder / "threads2" / "out.tif")
            counts["band"] += checks.out_of_band(found, z)
            counts["holes"] += checks.holes(found, z)
            counts["spots"] += checks.spots_missed(found, z)
            counts["lake"] += checks.below_lake(found, z)
            if found.whole is not None:
                if run(program, folder, "dem", *found.whole.inputs, "--like", "ground.tif", "-o", "whole.tif", "-q"):
                    counts["sheets"] += checks.unlike_whole(found, z, checks.read_heights(folder / "whole.tif"))
                else:
                    counts["failed"] += 1
        lines, levels, inputs = out_lines, out_levels, [f"threads2/out{step}.gpkg"]
    return counts


def one(program, seed, number, keep):
    """A random map of a kind, and its counts."""
    random = np.random.default_rng([seed, number])
    kind = maps.KINDS[number % len(maps.KINDS)]
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        known = ground.ground(random)
        found = kind(known, folder, random)
        if found is None:
            return kind.__name__, number, None
        found.ground.write(folder / "ground.tif")
        counts = counted(program, folder, found)
        if keep and any(counts.values()):
            shutil.copytree(folder, keep / f"{number}_{kind.__name__}", dirs_exist_ok=True)
        return kind.__name__, number, counts
    finally:
        shutil.rmtree(folder)


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default=BINARY, type=lambda p: pathlib.Path(p).resolve())
    a.add_argument("--maps", default=200, type=int)
    a.add_argument("--seed", default=1, type=int)
    a.add_argument("--only", default="")
    a.add_argument("--keep", type=pathlib.Path)
    a.add_argument("--jobs", default=os.cpu_count(), type=int)
    o = a.parse_args()
    numbers = [n for n in range(o.maps) if o.only in maps.KINDS[n % len(maps.KINDS)].__name__]
    if not numbers:
        sys.exit(f"no kind of map has {o.only!r} in its name")
    total = {kind.__name__: [0, dict.fromkeys(COLUMNS, 0)] for kind in maps.KINDS}
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        for kind, number, counts in pool.map(lambda n: one(o.program, o.seed, n, o.keep), numbers):
            if counts is None:
                continue
            total[kind][0] += 1
            if any(counts.values()):
                print(f"map {number}, {kind}: " + ", ".join(f"{c} {n}" for c, n in counts.items() if n), flush=True)
            for column, count in counts.items():
                total[kind][1][column] += count
    print(f"{'kind':24}{'maps':>6}" + "".join(f"{c:>10}" for c in COLUMNS))
    for kind, (count, counts) in total.items():
        if count:
            print(f"{kind:24}{count:6}" + "".join(f"{n:10}" for n in counts.values()))
    sys.exit(any(n for _, counts in total.values() for n in counts.values()))


if __name__ == "__main__":
    main()
