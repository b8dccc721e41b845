#!/usr/bin/env python3
"""Runs tokosen on some hundred hostile inputs, and prints a row for each.

    hostile.py [--program TOKOSEN] [--only NAME] [--seconds 60] [--gigabytes 3] [--kills 60] [--seed 1]

A run is bad if it panics, ends by a signal, needs more time or address space than allowed, ends with another status than 0,
1 or 2, fails without a message, succeeds without its output, leaves anything else in its folder, or does not do what the
case asks for. Runs are also killed at random moments, and two runs write one file at the same time: then the output is bad
if it is neither the old nor the new one as a whole. Exit status 1 if any run is bad. The inputs are in hostile_inputs.
"""
import argparse
import itertools
import os
import pathlib

from hostile_inputs import (
    archives, drawings, geojson_files, geopackages, kills, line_roles, locks, mixed_roles, option_values, places, point_roles,
    polygon_roles, rasters, run_files, several_files, shapefiles, tables, two_runs,
)  # fmt: skip
from hostile_inputs.running import row_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = ROOT / "target" / "release" / "tokosen"
KINDS = [
    geojson_files, geopackages, shapefiles, drawings, archives, rasters, line_roles, point_roles, polygon_roles, tables, mixed_roles,
    several_files, run_files, places, locks, option_values,
]  # fmt: skip


def rows(program, o):
    cases = itertools.chain.from_iterable(kind.cases() for kind in KINDS)
    yield from (row_of(program, case, o.seconds, o.gigabytes) for case in cases if o.only in case.name)
    sample = ROOT / "samples" / "caryville_20m.gpkg"
    yield from kills.rows(program, sample, o)
    yield from two_runs.rows(program, sample, o)


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default=BINARY)
    a.add_argument("--only", default="", help="cases with this in their name")
    a.add_argument("--seconds", type=float, default=60)
    a.add_argument("--gigabytes", type=float, default=3, help="of address space")
    a.add_argument("--kills", type=int, default=60, help="runs that are killed")
    a.add_argument("--seed", type=int, default=1, help="of the moments at which runs are killed")
    o = a.parse_args()
    bad = total = 0
    slowest = (0.0, "")
    for row in rows(os.path.abspath(o.program), o):
        total, bad = total + 1, bad + bool(row.fault)
        slowest = max(slowest, (row.seconds, row.name))
        message = next((text for text in reversed(row.said.splitlines()) if "error: " in text), "")
        print(f"{'BAD' if row.fault else 'ok':4}{row.status!s:>5}{row.seconds:7.2f} s  {row.name[:64]:66}{row.fault or message[:110]}", flush=True)
    print(f"\n{total} inputs, {bad} bad; the slowest took {slowest[0]:.1f} s: {slowest[1]}")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
