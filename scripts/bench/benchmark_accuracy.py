#!/usr/bin/env python3
"""Accuracy of height maps by tokosen and other tools: each gets only contours that were cut from known heights.

    benchmark_accuracy.py                                  # the sample and its contours every 20 m
    benchmark_accuracy.py lidar.tif 10
    benchmark_accuracy.py lidar.tif 10 --only tokosen --only GMT --keep height_maps
    benchmark_accuracy.py lidar.tif 10 --contours drawn.gpkg
    benchmark_accuracy.py --turned                         # the sample, with contours that lie on no raster
    benchmark_accuracy.py lidar.tif 10 --turned

TRUTH is a height map in metres with square cells, INTERVAL the contour interval in metres. The contours are cut at every
multiple of it, by linear interpolation between cell centres; --contours takes those of a file instead. Each tool makes a
height map on the cells of TRUTH. benchmark_speed.py lists the tools and their parameters.

Contours that are cut between the cells of TRUTH give some of its heights away. Where two contours pass between two cells, a
straight line through both points gives the heights of both cells. A tool that works on the same cells gains by this.
Contours that people draw lie on no raster. With --turned, the contours do not lie on one either:

- The smooth surface through the cells is the cubic spline. It passes through every cell, so the truth stays exact there.
- Its contours are cut on another raster, turned by 27 degrees, with cells of 0.8 of those of TRUTH.
- Some of their vertices are not met even by TRUTH itself, because heights between its cells are bilinear for that figure.

One row per tool:

    RMSE         root mean square error, in units of the interval
    95 % below   95 % of the errors are at most this, in units of the interval
    slope RMSE   root mean square error of the slope angle (Horn)
    terraces     share of cells flatter than 0.5 degrees where the truth is steeper than 3 degrees
    met          share of the contours' vertices where the height map is within 2 % of the interval of the contour's level

All figures are over the cells that have heights in every row; score_dem.py describes them. They do not include errors of
a map's contours, only what is lost between contours and height map.
"""
import argparse
import json
import math
import pathlib
import shutil
import sys
import tempfile

import numpy as np
import rasterio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import score_dem
import terrain
import tools

COLUMNS = {"RMSE": ("rmse", "{:.3f}"), "95 % below": ("p95", "{:.3f}"), "slope RMSE": ("slope", "{:.2f}°"),
           "terraces": ("flat", "{:.1f} %"), "met": ("meets", "{:.0f} %")}


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("truth", nargs="?", help="height map of the true ground (the sample's)")
    a.add_argument("interval", nargs="?", type=float, help="of the contours, metres")
    a.add_argument("--contours", help="use these instead of cutting contours")
    a.add_argument("--turned", action="store_true", help="cut contours that lie on no raster")
    a.add_argument("--layer", help="layer of --contours (the first)")
    a.add_argument("--elev", help="attribute of --contours that holds the elevation (found by its name)")
    a.add_argument("--tokosen", default=str(tools.BINARY), help="the program (target/release/tokosen)")
    a.add_argument("--only", action="append", metavar="NAME", help="run only tools with NAME in their name; may be repeated")
    a.add_argument("--limit", type=float, default=600, metavar="SECONDS", help="for each step of a tool (600)")
    a.add_argument("--keep", metavar="DIR", help="leave the contours and the height maps there")
    a.add_argument("--json", action="store_true", help="print the figures as JSON")
    o = a.parse_args()
    if o.turned and o.contours:
        a.error("--turned cuts contours, so it does not go with --contours")
    if o.truth is None:
        o.truth, o.interval = str(tools.SAMPLE_TRUTH), tools.SAMPLE_INTERVAL
        if not o.turned:
            o.contours = o.contours or str(tools.SAMPLE)
    if o.interval is None or not 0 < o.interval < math.inf or not 0 < o.limit < math.inf:
        a.error("name the INTERVAL of the contours; it and --limit are above 0")
    binary = tools.find(o.tokosen)
    heights, transform = terrain.read_dem(o.truth)
    way = terrain.turned_contours if o.turned else terrain.contours
    lines, crs = given(o) if o.contours else cut(way, o.truth, heights, transform, o.interval)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        inputs = tools.write_inputs(folder, lines, crs, transform, heights.shape)
        every = tools.tools(folder, inputs, binary)
        # Threads do not change what comes out.
        present, missing = tools.chosen([tool for tool in every if tool.name != tools.ONE_THREAD], o.only)
        made, failed = {}, []
        for tool in present:
            tools.say(tool.name)
            wrong = make(tool, folder, o.limit)
            if wrong:
                failed.append(f"{tool.name} " + (f"took over {o.limit:g} s." if "over" in wrong else f"failed: {wrong['failed']}"))
            else:
                made[tool.name] = tool.output
        tools.say("")
        cells, scores = score_dem.compare(o.truth, o.interval, made.values(), cut=way) if made else (0, {})
        if o.keep:
            pathlib.Path(o.keep).mkdir(parents=True, exist_ok=True)
            for path in [inputs.lines, *made.values()]:
                shutil.copy(path, o.keep)
    figures = {name: scores[path] for name, path in made.items()}
    about = {"turned": o.turned, "vertices": int(shapely.get_num_coordinates(lines).sum()), "interval": o.interval,
             "cells": cells, "versions": tools.versions(present), "not installed": missing, "failed": failed}
    if o.json:
        print(json.dumps({**about, "figures": figures}, indent=1))
    else:
        show(figures, about)
    sys.exit(not figures or any("failed:" in line for line in failed))


def given(o):
    return tools.read_contours(o.contours, o.layer, o.elev)


def cut(way, path, heights, transform, interval):
    """3-D contours of the heights, cut by the function `way`, and the coordinate reference system of their file."""
    if not np.isfinite(heights).any():
        sys.exit(f"{path}: no cell has data")
    lines, levels = way(heights, transform, interval)
    if not len(lines):
        sys.exit(f"{path}: no contours every {interval:g} m in {np.nanmin(heights):g} to {np.nanmax(heights):g} m")
    with rasterio.open(path) as file:
        return shapely.force_3d(lines, levels), file.crs.to_wkt() if file.crs else None


def make(tool, folder, limit):
    """Makes the tool's height map: nothing, or what went wrong."""
    for step in (tools.prepare, tools.interpolate, tools.finish):
        told = step(tool, folder, limit)
        if "seconds" not in told:
            return told
    return None


def show(figures, about):
    where = " that lie on no raster" if about["turned"] else ""
    print(f"{about['vertices']:,} vertices of contours every {about['interval']:g} m{where}, {about['cells']:,} cells; "
          f"{about['versions']}.\n")
    print(tools.table(["", *COLUMNS], [[name, *(form.format(f[key]) for key, form in COLUMNS.values())]
                                       for name, f in figures.items()]))
    if about["not installed"]:
        print(f"\nNot installed: {', '.join(about['not installed'])}.")
    for line in about["failed"]:
        print(f"\n{line}")


if __name__ == "__main__":
    main()
