#!/usr/bin/env python3
"""Time and memory of tokosen and other tools for the same height map, on one machine in one run.

    benchmark_speed.py                                     # the sample, on the grid of its truth
    benchmark_speed.py contours.gpkg --cell 5
    benchmark_speed.py contours.shp --elev HOEHE --like published_dem.tif --limit 1800
    benchmark_speed.py contours.gpkg --cell 5 --only tokosen --only GMT --keep height_maps

One row per tool; tools that are not installed are named below the table.

    tokosen                    dem, with the defaults: the smooth surface
    tokosen, one thread        the same on one core
    tokosen skeleton, linear   with --surface skeleton and --surface linear
    GMT surface                blockmean, then minimum curvature with no tension
    SAGA multilevel B-spline   grid_spline 4, defaults
    GRASS r.surf.contour       flood fill between rasterised contours
    GRASS v.surf.rst           regularised spline with tension, defaults, all cores; also with npmin=120
    gdal_grid linear           Delaunay triangulation of the vertices

For tokosen and gdal_grid the whole run is measured, from the GeoPackage that they read to the GeoTIFF that they write.
For the other tools only the interpolation is measured. GMT's binary table, SAGA's points, GRASS's import and rasterised
lines are made before, and GRASS's export after it. The last column includes GRASS's import, rasterising and export. It
includes no time for GMT's table and SAGA's points, because this script writes them.

wall is the elapsed time of the program, CPU the time of all its threads and processes, memory the peak resident memory
of its largest process (values below 10 MB cannot be measured). Of several runs the least value counts; the tools take
turns. A tool that takes longer than --limit is stopped; its ratio is then a lower bound. Use a machine that runs nothing
else: other work increases wall most.
"""
import argparse
import json
import math
import os
import pathlib
import platform
import shutil
import sys
import tempfile

import rasterio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import terrain
import tools

SHORT = 0.1  # of the limit: what took longer is not run again


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("contours", nargs="?", help="vector file of contour lines, in metres (the sample)")
    grid = a.add_mutually_exclusive_group()
    grid.add_argument("--cell", type=float, help="cell size; the grid covers the contours")
    grid.add_argument("--like", metavar="DEM", help="the grid of this raster, which is in the contours' system")
    a.add_argument("--layer", help="layer of CONTOURS (the first)")
    a.add_argument("--elev", help="attribute of CONTOURS that holds the elevation (found by its name)")
    a.add_argument("--tokosen", default=str(tools.BINARY), help="the program (target/release/tokosen)")
    a.add_argument("--only", action="append", metavar="NAME", help="run only tools with NAME in their name; may be repeated")
    a.add_argument("--runs", type=int, default=3, help="of each tool (3); one of what takes over a tenth of the limit")
    a.add_argument("--limit", type=float, default=600, metavar="SECONDS", help="for each run and each step before it (600)")
    a.add_argument("--keep", metavar="DIR", help="leave the height maps there")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if o.contours and o.cell is None and not o.like:
        a.error("name the grid: --cell METRES or --like DEM")
    if o.cell is not None and not 0 < o.cell < math.inf or not 0 < o.limit < math.inf or o.runs < 1:
        a.error("--cell and --limit are above 0, --runs is 1 or more")
    binary = tools.find(o.tokosen)
    lines, crs = tools.read_contours(o.contours or str(tools.SAMPLE), o.layer, o.elev)
    if o.cell is None:
        heights, transform = terrain.read_dem(o.like or str(tools.SAMPLE_TRUTH))
        shape = heights.shape
    else:
        transform, shape = grid_over(lines, o.cell)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        every = tools.tools(folder, tools.write_inputs(folder, lines, crs, transform, shape), binary)
        present, missing = tools.chosen(every, o.only)
        figures = measure(present, folder, o.runs, o.limit)
        if o.keep:
            keep(present, figures, pathlib.Path(o.keep))
        about = {"vertices": int(shapely.get_num_coordinates(lines).sum()), "rows": shape[0], "columns": shape[1],
                 "cell": transform.a, "versions": tools.versions(present), "machine": machine(), "not installed": missing}
    if o.json:
        print(json.dumps({**about, "figures": figures}, indent=1))
    else:
        show(figures, about, o.limit)
    # A missing tool and a tool that takes too long are no failures; a tool that ends with an error is one.
    sys.exit(any("failed" in f for f in figures.values()))


def grid_over(lines, cell):
    """The grid with cell borders on multiples of `cell` that covers the lines: transform, rows and columns."""
    west, south, east, north = shapely.total_bounds(lines)
    first, last = math.floor(west / cell), math.ceil(east / cell)
    bottom, top = math.floor(south / cell), math.ceil(north / cell)
    if last == first or top == bottom:
        sys.exit("the contours have no extent")
    if (last - first) * (top - bottom) > 2**31:
        sys.exit("--cell: the grid would have more cells than other tools count")
    return rasterio.transform.from_origin(first * cell, top * cell, cell, cell), (top - bottom, last - first)


def measure(present, folder, runs, limit):
    """Seconds and bytes of each tool, the least of its runs, or what went wrong."""
    figures = {}
    before = {}
    for tool in present:
        tools.say(f"preparing {tool.name}")
        told = tools.prepare(tool, folder, limit)
        before[tool.name] = told.pop("seconds", None)
        figures[tool.name] = told
    # In turns, so that other work on the machine does not slow down one tool alone.
    for turn in range(runs):
        for tool in present:
            best = figures[tool.name]
            if "failed" in best or "over" in best or best.get("seconds", 0) > SHORT * limit:
                continue
            tools.say(f"run {turn + 1} of {tool.name}")
            new = tools.interpolate(tool, folder, limit)
            figures[tool.name] = {k: min(v, best.get(k, v)) for k, v in new.items()} if "seconds" in new else new
    for tool in present:
        if "seconds" in figures[tool.name]:
            tools.say(f"export of {tool.name}")
            after = tools.finish(tool, folder, limit)
            if "seconds" in after:
                whole = before[tool.name] + figures[tool.name]["seconds"] + after["seconds"]
                figures[tool.name]["whole_seconds"] = whole
            else:
                figures[tool.name] = after
    tools.say("")
    return figures


def keep(present, figures, target):
    target.mkdir(parents=True, exist_ok=True)
    for tool in present:
        if "seconds" in figures[tool.name]:
            shutil.copy(tool.output, target)


def machine():
    """The processor's name and how many threads it runs."""
    name = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            name = next(line.partition(":")[2].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{os.cpu_count()} cores of {name}"


def show(figures, about, limit):
    first = next((f for f in figures.values() if "seconds" in f), None)
    base = next((name for name, f in figures.items() if f is first), "")
    rows, failed = [], []
    for name, f in figures.items():
        if "seconds" in f:
            rows.append([name, f"{f['seconds']:.2f} s", f"{f['cpu_seconds']:.2f} s", f"{f['peak_bytes'] / 1e6:.0f} MB",
                         f"{f['seconds'] / first['seconds']:.2f}", f"{f['peak_bytes'] / first['peak_bytes']:.2f}",
                         f"{f['whole_seconds']:.2f} s"])
        elif "over" in f:
            least = f"> {limit / first['seconds']:.1f}" if first else ""
            rows.append([name, f"> {limit:g} s", "", "", least, "", ""])
        else:
            failed.append(f"{name} failed: {f['failed']}")
    print(f"{about['vertices']:,} vertices, {about['columns']} x {about['rows']} = {about['columns'] * about['rows']:,} cells "
          f"of {about['cell']:g}; {about['machine']}; {about['versions']}.\n")
    print(tools.table(["", "wall", "CPU", "memory", f"wall / {base}'s", "memory", "import to export"], rows))
    if about["not installed"]:
        failed.append(f"Not installed: {', '.join(about['not installed'])}.")
    if failed:
        print("\n" + "\n".join(failed))


if __name__ == "__main__":
    main()
