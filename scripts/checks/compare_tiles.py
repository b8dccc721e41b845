#!/usr/bin/env python3
"""Compare a map that is made in tiles with the same map made in one run.

    compare_tiles.py CONTOURS [--program tokosen] [-i STEP] [--cell SIZE] [--interval METRES] [--sizes S1,S2,...] [--picture FILE]

For each size of tiles (map units), it prints how far heights differ, in contour intervals; how many lines there are; whether lines of the
input are the same bit for bit; how many new lines end inside the map; and the time. Needs numpy, rasterio, pyogrio and shapely.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyogrio
import rasterio


def run(program, *arguments):
    """Runs the program; returns seconds and what it printed."""
    started = time.time()
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, arguments))}\n{done.stderr}")
    return time.time() - started, done.stdout + done.stderr


def heights(path):
    with rasterio.open(path) as raster:
        values = raster.read(1).astype(float)
        values[values == raster.nodata] = np.nan
        return values, raster.transform


def lines(path):
    layer = pyogrio.list_layers(path)[0][0]
    table = pyogrio.read_dataframe(path, layer=layer)
    is_input = table["source"] == "input"
    given = sorted((z, line.wkb) for z, line in zip(table["elev"][is_input], table.geometry[is_input]))
    new = table[~is_input]
    ends = [(z, line.coords[k]) for z, line in zip(new["elev"], new.geometry) if not line.is_closed for k in (0, -1)]
    return given, new, ends


def nearest(end, others):
    """The distance from the end of a line to the nearest end of a line of its level."""
    level, place = end
    return min((np.hypot(place[0] - p[0], place[1] - p[1]) for z, p in others if z == level), default=np.inf)


def shade(values, cell):
    dy, dx = np.gradient(values, cell)
    slope, aspect = np.arctan(np.hypot(dx, dy)), np.arctan2(-dx, dy)
    return np.cos(np.pi / 4) * np.cos(slope) + np.sin(np.pi / 4) * np.sin(slope) * np.cos(np.radians(315) - aspect)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours")
    parser.add_argument("--program", default="tokosen")
    parser.add_argument("-i", "--step", type=float, help="interval of new contours")
    parser.add_argument("--cell", type=float, required=True)
    parser.add_argument("--interval", type=float, required=True, help="contour interval of the input, for the figures")
    parser.add_argument("--sizes", default="", help="sizes of tiles, map units, by commas")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--picture", help="a shaded relief of untiled, tiled and their difference: .png")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        whole_dem, whole_lines = folder / "whole.tif", folder / "whole.gpkg"
        if asked.step:
            output = ["-o", whole_lines, "--dem", whole_dem, "-i", asked.step]
            seconds, _ = run(asked.program, "densify", asked.contours, *output, "--cell", asked.cell)
            given, new, ends = lines(whole_lines)
            print(f"untiled: {seconds:.1f} s, {len(given)} input lines, {len(new)} new, {len(ends)} open ends")
        else:
            seconds, _ = run(asked.program, "dem", asked.contours, "-o", whole_dem, "--cell", asked.cell)
            print(f"untiled: {seconds:.1f} s")
        untiled, place = heights(whole_dem)
        for size in map(float, asked.sizes.split(",")):
            plan, dem, dense = folder / f"plan{size}", folder / "tiled.tif", folder / "tiled.gpkg"
            step = ["-i", asked.step] if asked.step else []
            of_plan, text = run(asked.program, "plan", asked.contours, "--cell", asked.cell, *step, "--tile-side", size, "-o", plan)
            tiles = text.split(" tiles;")[0].split()[-1]
            of_work, _ = run(asked.program, "work", plan, "--jobs", asked.jobs)
            output = ["-o", dense] if asked.step else []
            of_join, text = run(asked.program, "join", plan, *output, "--dem", dem)
            tiled, its_place = heights(dem)
            assert (tiled.shape, its_place) == (untiled.shape, place), "the grids differ"
            off = np.abs(tiled - untiled) / asked.interval
            nodata = int((np.isnan(tiled) != np.isnan(untiled)).sum())
            row, col = np.unravel_index(np.nanargmax(off), off.shape)
            off = off[~np.isnan(off)]
            print(
                f"{tiles} tiles of {size:g}: largest {off.max():.4f} at {place * (col + 0.5, row + 0.5)}, "
                f"{(off > 0.01).sum()} of {off.size} cells above 0.01, RMS {np.sqrt((off**2).mean()):.6f}, "
                f"nodata differs {nodata}; plan {of_plan:.1f} s, work {of_work:.1f} s, join {of_join:.1f} s"
            )
            if asked.step:
                its_given, its_new, its_ends = lines(dense)
                moved = [nearest(end, ends) for end in its_ends]
                print(
                    f"    input lines the same: {its_given == given}; new {len(its_new)} (untiled {len(new)}); "
                    f"open ends {len(its_ends)} (untiled {len(ends)}), further than a cell from one of those {sum(d > asked.cell for d in moved)}"
                )
                print("    " + "\n    ".join(line for line in text.splitlines() if "seam" in line or "of a tile" in line))
        if asked.picture:
            import matplotlib.pyplot as plt

            cell = asked.cell
            figure, axes = plt.subplots(1, 3, figsize=(24, 8))
            axes[0].imshow(shade(untiled, cell), cmap="gray")
            axes[1].imshow(shade(tiled, cell), cmap="gray")
            axes[2].imshow(np.log10(np.abs(tiled - untiled) / asked.interval + 1e-6))
            figure.tight_layout()
            figure.savefig(asked.picture)


if __name__ == "__main__":
    main()
