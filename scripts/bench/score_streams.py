#!/usr/bin/env python3
"""Height maps with and without streams, against the true ground.

    score_streams.py TRUTH.tif CONTOURS.gpkg [--program P] [--area KM2] [--shift CELLS] [--turn] [--seed N] [--json]

CONTOURS holds lines that were cut from TRUTH. Streams are cut from TRUTH too: cells that at least AREA square kilometres
drain through, followed by the directions of flow of `tokosen derive`. --shift moves each stream by CELLS in a direction of
its own, --turn turns every second one. Then `tokosen dem` runs twice, without and with --streams. One row each:

    rmse   root mean square error within three mean spacings of the contours from streams, metres
    far    the same further away
    rise   how much heights rise downstream, metres per kilometre: read at the nearest cell, and bilinear between cells
    D8     share of stream cells from which water stays within a cell of a stream for ten steps, per cent: along the true
           streams, and along the streams as they are used (moved into bends of contours)
    pits   cells lower than all eight neighbours, within three spacings of streams
    trench places, of 200 drawn ones on streams, where the ground lies deeper below the line between the two banks (two
           cells away) than the truth does, by over 0.05 intervals
    time   seconds
"""
import argparse
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile
import time

import numpy as np
import pyogrio
import rasterio
import shapely
from scipy.ndimage import distance_transform_edt

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import terrain
import tools
from score_dem import pits
from streams import STEPS, along, reaches

TRENCH = 0.05  # intervals
PLACES = 200
STEPS_DOWN = 10


def run(*command):
    start = time.monotonic()
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
    return time.monotonic() - start


def bilinear(heights, row, column):
    i, j = np.floor(row).astype(int), np.floor(column).astype(int)
    ok = (i >= 0) & (j >= 0) & (i + 1 < heights.shape[0]) & (j + 1 < heights.shape[1])
    i, j = np.where(ok, i, 0), np.where(ok, j, 0)
    u, v = column - j, row - i
    z = (heights[i, j] * (1 - u) + heights[i, j + 1] * u) * (1 - v) + (heights[i + 1, j] * (1 - u) + heights[i + 1, j + 1] * u) * v
    return np.where(ok, z, np.nan)


def rises(heights, lines, reader):
    up, length = 0.0, 0.0
    for line in lines:
        places = along(line)
        z = reader(heights, places[:, 0], places[:, 1])
        z = z[np.isfinite(z)]
        up += np.maximum(np.diff(z), 0).sum()
        length += np.hypot(*np.diff(places, axis=0).T).sum()
    return up, length


def nearest(heights, row, column):
    i, j = np.clip(np.round(row).astype(int), 0, heights.shape[0] - 1), np.clip(np.round(column).astype(int), 0, heights.shape[1] - 1)
    return heights[i, j]


def d8_share(heights, lines, near):
    """The share of stream cells whose way down, along the steepest descents, stays near streams for STEPS_DOWN steps."""
    p = np.pad(heights, 1, constant_values=np.nan)
    around = np.stack([p[1 + i : 1 + i + heights.shape[0], 1 + j : 1 + j + heights.shape[1]] for i, j in STEPS.values()])
    falls = np.nan_to_num((heights - around) / np.array([np.hypot(*step) for step in STEPS.values()])[:, None, None], nan=-1)
    best, moves = falls.argmax(0), np.array(list(STEPS.values()))
    best[falls.max(0) <= 0] = -1
    cells = np.unique(np.concatenate([np.asarray(line, int) for line in lines]), axis=0)
    at, stays = cells.copy(), np.ones(len(cells), bool)
    for _ in range(STEPS_DOWN):
        step = best[at[:, 0], at[:, 1]]
        at = np.where(step[:, None] >= 0, at + moves[step], at)
        stays &= near[at[:, 0], at[:, 1]]
    return 100 * stays.mean()


def used_streams(file, transform, shape):
    """The streams as they are used, from a file of diagnostics: for each one, the cells that it runs through."""
    found = []
    for line in shapely.from_wkb(pyogrio.raw.read(file, layer="streams")[2]):
        x, y = shapely.get_coordinates(line).T
        place = np.column_stack([(y - transform.f) / transform.e, (x - transform.c) / transform.a]) - 0.5
        cells = np.round(along(place, 4)).astype(int)
        found.append(cells[((cells >= 0) & (cells < shape)).all(1)])
    return [cells for cells in found if len(cells)]


def near_cells(lines, shape):
    """Cells within one cell of lines, and the distance of all cells from them."""
    is_stream = np.zeros(shape, bool)
    for line in lines:
        is_stream[tuple(np.asarray(line).T)] = True
    distance = distance_transform_edt(~is_stream)
    return distance <= 1.5, distance


def trenches(heights, truth, lines, interval, seed):
    draw = np.random.default_rng(seed)
    lengths = np.array([len(line) for line in lines], float)
    deeper = 0
    for _ in range(PLACES):
        line = np.asarray(lines[draw.choice(len(lines), p=lengths / lengths.sum())], float)
        k = draw.integers(1, max(2, len(line) - 1))
        way = line[min(k + 2, len(line) - 1)] - line[max(k - 2, 0)]
        across = np.array([-way[1], way[0]]) / max(np.hypot(*way), 1e-9)
        here = line[min(k, len(line) - 1)]
        places = np.array([here, here + 2 * across, here - 2 * across])
        depth = []
        for z in (heights, truth):
            at, left, right = bilinear(z, places[:, 0], places[:, 1])
            depth.append((left + right) / 2 - at)
        deeper += bool(depth[0] - depth[1] > TRENCH * interval)
    return deeper


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truth", type=pathlib.Path)
    parser.add_argument("contours", type=pathlib.Path)
    parser.add_argument("--program", default=tools.BINARY, type=pathlib.Path)
    parser.add_argument("--area", type=float, help="square kilometres that drain through a stream (default: 1000 cells)")
    parser.add_argument("--shift", type=float, default=0.0, help="cells")
    parser.add_argument("--turn", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for streams and height maps")
    parser.add_argument("--other", action="append", default=[], metavar="NAME=COMMAND",
                        help="another tool: a command with {contours}, {streams}, {truth} and {out}; scored as a row of its own")
    parser.add_argument("--tune", action="append", default=[], help="as of tokosen")
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    truth, transform = terrain.read_dem(args.truth)
    with rasterio.open(args.truth) as source:
        crs = source.crs
    cell = (transform.a * -transform.e) ** 0.5
    _, _, wkb, columns = pyogrio.raw.read(args.contours)
    lines = shapely.from_wkb(wkb)
    levels = np.unique(shapely.get_coordinates(shapely.get_point(shapely.get_parts(lines), 0), include_z=True)[:, 2])
    interval = float(np.median(np.diff(levels)))
    spacing = np.isfinite(truth).sum() * cell**2 / shapely.length(lines).sum() / cell
    with tempfile.TemporaryDirectory() as made:
        folder = args.keep or pathlib.Path(made)
        folder.mkdir(exist_ok=True)
        flow = [folder / "direction.tif", folder / "accumulation.tif"]
        run(args.program, "derive", args.truth, "--flow-direction", flow[0], "--flow-accumulation", flow[1], "-q", "--overwrite")
        least = args.area * 1e6 / cell**2 if args.area else 1000
        true = reaches(terrain.read_dem(flow[0])[0], terrain.read_dem(flow[1])[0], least)
        draw = np.random.default_rng(args.seed)
        drawn = []
        for k, line in enumerate(true):
            turn = draw.uniform(0, 2 * np.pi)
            moved = np.asarray(line, float) + args.shift * np.array([np.sin(turn), np.cos(turn)])
            drawn.append(moved[::-1] if args.turn and k % 2 else moved)
        place = lambda line: np.column_stack([transform.c + transform.a * (line[:, 1] + 0.5), transform.f + transform.e * (line[:, 0] + 0.5)])
        pyogrio.raw.write(folder / "streams.gpkg", geometry=shapely.to_wkb([shapely.linestrings(place(line)) for line in drawn]),
                          field_data=[np.arange(len(drawn))], fields=["number"], geometry_type="LineString", crs=crs.to_wkt(),
                          driver="GPKG", layer="streams")
        beside, distance = near_cells(true, truth.shape)
        rows = []
        streams, diagnostics = folder / "streams.gpkg", folder / "diagnostics.gpkg"
        ours = [args.program, "dem", args.contours, "--like", args.truth, "-q", "--overwrite", *[f"--tune={t}" for t in args.tune]]
        runs = [("without", ours), ("with", [*ours, "--streams", streams])]
        for other in args.other:
            name, _, command = other.partition("=")
            runs.append((name, [word.format(contours=args.contours, streams=streams, truth=args.truth, out=folder / f"{name}.tif")
                                for word in shlex.split(command)]))
        for name, command in runs:
            out = folder / f"{name}.tif"
            taken = run(*command, *(["-o", out] if command[0] == args.program else []))
            heights = terrain.read_dem(out)[0]
            error = heights - truth
            ok = np.isfinite(error)
            near = ok & (distance <= 3 * spacing)
            rms = lambda which: float(np.sqrt(np.mean(error[which] ** 2)))
            up, length = rises(heights, true, nearest)
            between, _ = rises(heights, true, bilinear)
            used = []
            if name == "with":
                # A run of its own: diagnostics take time.
                run(*command, "--diagnostics", diagnostics, "-o", folder / "again.tif")
                used = used_streams(diagnostics, transform, truth.shape)
            rows.append({
                "run": name, "rmse": rms(near), "far": rms(ok & ~near) if (ok & ~near).any() else float("nan"),
                "rise_nearest": up / length / cell * 1000, "rise_bilinear": between / length / cell * 1000,
                "d8": d8_share(heights, true, beside),
                "d8_used": d8_share(heights, used, near_cells(used, truth.shape)[0]) if used else float("nan"),
                "pits": int((pits(heights) & near).sum()),
                "trench": trenches(heights, truth, true, interval, args.seed), "time": taken,
            })
    if args.json:
        print(json.dumps({"streams": len(true), "rows": rows}))
        return
    print(f"{len(true)} streams, interval {interval:g} m, mean spacing {spacing:.1f} cells")
    print(f"{'':8} {'rmse':>7} {'far':>7} {'rise nearest/bilinear':>22} {'D8 true/used':>13} {'pits':>5} {'trench':>6} {'time':>6}")
    for row in rows:
        rise = f"{row['rise_nearest']:.2f} / {row['rise_bilinear']:.2f}"
        print(f"{row['run']:8} {row['rmse']:7.3f} {row['far']:7.3f} {rise:>22} {row['d8']:6.1f} {row['d8_used']:6.1f} {row['pits']:5} {row['trench']:6} {row['time']:6.1f}")
    without, with_, *_ = rows
    print(f"ratio    {with_['rmse'] / without['rmse']:7.3f} {with_['far'] / without['far']:7.3f} {'':22} {'':13} {'':5} {'':6} {with_['time'] / without['time']:6.2f}")


if __name__ == "__main__":
    main()
