#!/usr/bin/env python3
"""Do true streams help? Height maps with and without streams, on random grounds whose streams are known.

    score_true_streams.py [--program P] [--grounds 30] [--seed 1] [--json] [--keep FOLDER] [--jobs 2]
    score_true_streams.py --of DEM.tif STREAMS.gpkg [--interval 20] [--cell 10] [--below 740] [--program P]

The first form makes random grounds of several roughnesses. From each cell a way down to the border is breached, so the ground
drains. Contours are cut from it. Its thalwegs, cells that more than 1 % of all cells drain through, are the streams. `tokosen
dem` runs without streams and with each of these:

    true    from cell to cell
    moved   the same, each line moved by half a cell in some direction
    thin    every fifth vertex
    both    moved and thinned

A row per ground: its roughness, the RMSE without streams in intervals over all cells, and the RMSE with streams divided by that
without, over all cells and over the cells of the streams. Then the geometric means, and how many ratios are above 1.

The second form takes a height map and streams of a real place. Contours are cut from it. With the heights that the diagnostics
state for the streams ("own"), one row for the run without and one for the run with streams:

    below, above   5th and 95th percentile of cell minus own height, in the cells of the streams, metres
    low            RMSE of the stream cells where the truth is below --below, metres
    rmse           RMSE of all stream cells, metres
"""
import argparse
import concurrent.futures
import heapq
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyogrio
import rasterio
import shapely
from rasterio.transform import from_origin

SCRIPTS = pathlib.Path(__file__).resolve().parents[1]
sys.path += [str(SCRIPTS), str(SCRIPTS / "checks")]  # the modules that scripts share, and the random grounds
import score_streams
import terrain
import tools
from known_ground import flow, ground
from streams import STEPS, reaches

CELL = 10.0
SHARE = 0.01  # of all cells that drain through a stream
FALL = 1e-3  # intervals from cell to cell along breached ways
WAYS = ("true", "moved", "thin", "both")


def breached(heights, fall):
    """Ground whose every cell has a way down to the border: along the way that a flood from there takes to it, what is higher
    is cut."""
    rows, cols = heights.shape
    z = heights.copy()
    edge = np.ones(z.shape, bool)
    edge[1:-1, 1:-1] = False
    before = {cell: None for cell in zip(*(a.tolist() for a in np.nonzero(edge)))}
    queue = [(z[cell], cell) for cell in before]
    heapq.heapify(queue)
    while queue:
        _, cell = heapq.heappop(queue)
        at, most = before[cell], z[cell] - fall
        while at is not None and z[at] > most:
            z[at] = most
            at, most = before[at], most - fall
        for step in STEPS.values():
            near = cell[0] + step[0], cell[1] + step[1]
            if 0 <= near[0] < rows and 0 <= near[1] < cols and near not in before:
                before[near] = cell
                heapq.heappush(queue, (heights[near], near))
    return z


def made(random, roughness):
    """Random ground that drains."""
    rows, cols = random.integers(120, 241, 2)
    heights = ground.noise(random, 2 * rows, 2 * cols, roughness)[:rows, :cols]
    interval = float(random.choice([5.0, 10.0, 20.0]))
    levels = random.uniform(6.0, 20.0)
    heights = (heights - heights.min()) / np.ptp(heights) * levels * interval
    for _ in range(3):
        heights = ground.off_levels(breached(heights, FALL * interval), interval)
    return ground.Ground(heights, from_origin(0.0, rows * CELL, CELL, CELL), interval)


def drawn(lines, way, random):
    """The cells of streams as places in rows and columns, in one of the ways. Where streams meet, they still do."""
    found = []
    for line in lines:
        line = np.asarray(line, float)
        if way in ("thin", "both"):
            line = line[np.unique(np.r_[0 : len(line) : 5, len(line) - 1])]
        if way in ("moved", "both"):
            turn = random.uniform(0, 2 * np.pi)
            line = line + 0.5 * np.array([np.sin(turn), np.cos(turn)])
        found.append(line)
    return found


def write_lines(path, lines, transform, crs):
    place = lambda line: np.column_stack(terrain.to_map(transform, line[:, 0], line[:, 1]))
    pyogrio.raw.write(path, geometry=shapely.to_wkb([shapely.linestrings(place(line)) for line in lines]),
                      field_data=[np.arange(len(lines))], fields=["number"], geometry_type="LineString", crs=crs, driver="GPKG",
                      layer="streams")


def write_contours(path, lines, levels, crs):
    pyogrio.raw.write(path, geometry=shapely.to_wkb(shapely.force_3d(lines, levels)), field_data=[np.asarray(levels)], fields=["elev"],
                      geometry_type="LineString Z", crs=crs, driver="GPKG", layer="contours")


def run(o, folder, out, *options):
    command = [o.program, "dem", folder / "contours.gpkg", "-q", "--overwrite", "-o", out, *options]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return terrain.read_dem(out)[0]


def one(o, number):
    """The figures of one ground."""
    random = np.random.default_rng([o.seed, number])
    roughness = float(random.uniform(1.6, 2.8))
    g = made(random, roughness)
    kept = o.keep and o.keep / str(number)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(kept or temporary)
        folder.mkdir(exist_ok=True, parents=True)
        g.write(folder / "truth.tif")
        truth = terrain.read_dem(folder / "truth.tif")[0]
        write_contours(folder / "contours.gpkg", *g.contours(), ground.CRS)
        direction = flow.directions(truth)
        lines = reaches(direction, flow.accumulation(truth, direction), SHARE * truth.size)
        on_stream = np.zeros(truth.shape, bool)
        for line in lines:
            on_stream[tuple(np.asarray(line).T)] = True
        maps = {"without": run(o, folder, folder / "without.tif", "--like", folder / "truth.tif")}
        for way in WAYS[: o.ways]:
            write_lines(folder / f"{way}.gpkg", drawn(lines, way, random), g.transform, ground.CRS)
            maps[way] = run(o, folder, folder / f"{way}.tif", "--like", folder / "truth.tif", "--streams", folder / f"{way}.gpkg")
    ok = np.all([np.isfinite(z) for z in maps.values()], axis=0)
    rmse = {way: [float(np.sqrt(np.mean((z - truth)[which] ** 2))) for which in (ok, ok & on_stream)] for way, z in maps.items()}
    plain = rmse.pop("without")
    ratios = {way: [of[0] / plain[0], of[1] / plain[1]] for way, of in rmse.items()}
    return {"ground": number, "roughness": roughness, "rmse": plain[0] / g.interval, "on": plain[1] / g.interval, "ratios": ratios}


def random_grounds(o):
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        found = list(pool.map(lambda number: one(o, number), range(o.grounds)))
    ways = WAYS[: o.ways]
    ratios = {way: np.array([of["ratios"][way] for of in found]) for way in ways}
    means = {way: np.exp(np.log(r).mean(0)).tolist() for way, r in ratios.items()}
    if o.json:
        print(json.dumps({"grounds": found, "means": means}))
        return
    print(f"{'':6}{'rough':>6}{'rmse':>7}{'on':>7}" + "".join(f"{way:>7}{'on':>6}" for way in ways))
    for of in found:
        print(f"{of['ground']:6}{of['roughness']:6.2f}{of['rmse']:7.3f}{of['on']:7.3f}"
              + "".join(f"{of['ratios'][way][0]:7.3f}{of['ratios'][way][1]:6.2f}" for way in ways))
    print(f"{'mean':26}" + "".join(f"{means[way][0]:7.3f}{means[way][1]:6.2f}" for way in ways))
    print(f"{'above 1':26}" + "".join(f"{(r[:, 0] > 1).sum():7}{(r[:, 1] > 1).sum():6}" for r in ratios.values()))
    print(f"{'largest':26}" + "".join(f"{r[:, 0].max():7.3f}{r[:, 1].max():6.2f}" for r in ratios.values()))


def own_heights(file, transform, shape):
    """For each cell that streams run through: its row and column, and the height of the stream nearest to its centre."""
    nearest = {}
    for line in shapely.from_wkb(pyogrio.raw.read(file, layer="streams")[2]):
        points = shapely.get_coordinates(line, include_z=True)
        row, column = terrain.to_grid(transform, points[:, 0], points[:, 1])
        at = np.r_[0, np.cumsum(np.hypot(np.diff(row), np.diff(column)))]
        s = np.linspace(0, at[-1], max(2, int(4 * at[-1])))
        row, column, z = (np.interp(s, at, values) for values in (row, column, points[:, 2]))
        cells = np.round(np.column_stack([row, column])).astype(int)
        away = np.hypot(row - cells[:, 0], column - cells[:, 1])
        for cell, d, height in zip(map(tuple, cells.tolist()), away.tolist(), z.tolist()):
            if 0 <= cell[0] < shape[0] and 0 <= cell[1] < shape[1] and d < nearest.get(cell, (9.0,))[0]:
                nearest[cell] = (d, height)
    cells = np.array(list(nearest))
    return cells[:, 0], cells[:, 1], np.array([height for _, height in nearest.values()])


def real_place(o):
    heights, transform = terrain.read_dem(o.of[0])
    with rasterio.open(o.of[0]) as source:
        crs = source.crs.to_wkt()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(o.keep or temporary)
        folder.mkdir(exist_ok=True, parents=True)
        write_contours(folder / "contours.gpkg", *terrain.contours(heights, transform, o.interval), crs)
        grid = ["--cell", o.cell]
        maps = {
            "without": run(o, folder, folder / "without.tif", *grid),
            "with": run(o, folder, folder / "with.tif", *grid, "--streams", o.of[1], "--diagnostics", folder / "diagnostics.gpkg"),
        }
        _, fine = terrain.read_dem(folder / "with.tif")
        row, column, own = own_heights(folder / "diagnostics.gpkg", fine, maps["with"].shape)
    x, y = terrain.to_map(fine, row, column)
    truth = score_streams.bilinear(heights, *terrain.to_grid(transform, x, y))
    print(f"{'':8} {'below':>7} {'above':>7} {'low':>7} {'rmse':>7}")
    for name, z in maps.items():
        z = z[row, column]
        ok = np.isfinite(z) & np.isfinite(truth)
        below, above = np.percentile((z - own)[ok], [5, 95])
        rms = lambda which: float(np.sqrt(np.mean((z - truth)[which] ** 2)))
        print(f"{name:8} {below:7.2f} {above:7.2f} {rms(ok & (truth < o.below)):7.2f} {rms(ok):7.2f}")
    ok = np.isfinite(truth)
    rms = lambda which: float(np.sqrt(np.mean((own - truth)[which] ** 2)))
    print(f"{'own':8} {'':7} {'':7} {rms(ok & (truth < o.below)):7.2f} {rms(ok):7.2f}")


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--program", default=tools.BINARY, type=lambda p: pathlib.Path(p).resolve())
    a.add_argument("--grounds", default=30, type=int)
    a.add_argument("--ways", default=len(WAYS), type=int, help="only the first ways of drawing streams")
    a.add_argument("--seed", default=1, type=int)
    a.add_argument("--jobs", default=os.cpu_count(), type=int)
    a.add_argument("--keep", type=pathlib.Path, help="folder for all files")
    a.add_argument("--json", action="store_true")
    a.add_argument("--of", nargs=2, metavar=("DEM", "STREAMS"), help="a real place instead")
    a.add_argument("--interval", default=20.0, type=float, help="of the contours of the real place")
    a.add_argument("--cell", default=10.0, type=float, help="of the height maps of the real place")
    a.add_argument("--below", default=740.0, type=float, help="metres")
    o = a.parse_args()
    real_place(o) if o.of else random_grounds(o)


if __name__ == "__main__":
    main()
