#!/usr/bin/env python3
"""The flow of water by tokosen beside that of pysheds, on the same height maps.

    compare_flow.py DEM.tif [DEM.tif ...] [--command tokosen] [--outlets 40]

It needs pysheds (`pip install pysheds`), which fills pits and resolves level ground by itself. For each map:

    outside pits   share of the cells away from the border, and not in a pit, with the same direction
    all            the same with pits, where both programs are free to choose
    accumulation   share of the cells that drain at least a thousandth of the map, without ground from the border, whose
                   accumulation by pysheds, in the cell or one around it, differs by at most 5 %
    catchments     intersection over union of the catchments of random cells of streams, away from the border: the median, and
                   the share above 0.95
    edge           the map is cut in the middle. Share of the cells along the cut that drain over it in the whole map and are
                   outlets of the part (found), and of the others that are outlets (false); by tokosen and by pysheds
"""
import argparse
import pathlib
import subprocess
import tempfile
import warnings

import numpy as np
import rasterio

if not hasattr(np, "in1d"):
    np.in1d = np.isin  # pysheds 0.5 still calls it
from pysheds.grid import Grid  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEPS = {1: (0, 1), 2: (1, 1), 4: (1, 0), 8: (1, -1), 16: (0, -1), 32: (-1, -1), 64: (-1, 0), 128: (-1, 1)}


def read(path):
    with rasterio.open(path) as source:
        return source.read(1, masked=True).astype(float).filled(np.nan)


def tokosen(command, dem, folder, *flags):
    subprocess.run([command, "derive", str(dem), *flags, "-q", "--overwrite"], check=True, cwd=folder, stderr=subprocess.DEVNULL)


def flow_of_tokosen(command, dem, folder):
    tokosen(command, dem, folder, "--flow-direction", "d.tif", "--flow-accumulation", "a.tif")
    return read(folder / "d.tif"), read(folder / "a.tif")


def flow_of_pysheds(dem):
    grid = Grid.from_raster(str(dem))
    heights = grid.read_raster(str(dem))
    filled = grid.fill_depressions(grid.fill_pits(heights))
    directions = grid.flowdir(grid.resolve_flats(filled))
    pits = np.abs(np.asarray(filled, float) - np.asarray(heights, float)) > 1e-6
    return grid, directions, np.asarray(grid.accumulation(directions)), pits


def border(shape):
    cells = np.zeros(shape, bool)
    cells[[0, -1], :] = cells[:, [0, -1]] = True
    return cells


def drains_from(cells, directions):
    """The cells downstream of some cells, with them."""
    found = np.zeros(directions.shape, bool)
    for row, col in np.argwhere(cells):
        while 0 <= row < found.shape[0] and 0 <= col < found.shape[1] and not found[row, col]:
            found[row, col] = True
            step = STEPS.get(int(directions[row, col])) if np.isfinite(directions[row, col]) else None
            if step is None:
                break
            row, col = row + step[0], col + step[1]
    return found


def around(values, row, col):
    return [(r, c) for r in range(row - 1, row + 2) for c in range(col - 1, col + 2) if 0 <= r < values.shape[0] and 0 <= c < values.shape[1]]


def compare(command, dem, outlets, folder):
    ours, counts = flow_of_tokosen(command, dem, folder)
    grid, theirs, their_counts, pits = flow_of_pysheds(dem)
    edge = border(ours.shape)
    inner = np.isfinite(ours) & ~edge
    same = ours == np.asarray(theirs)
    streams = inner & (counts >= 0.001 * np.isfinite(ours).sum()) & ~drains_from(edge & np.isfinite(ours), ours)
    cells = np.argwhere(streams)
    near = [min((abs(their_counts[p] / counts[r, c] - 1), p) for p in around(counts, r, c)) for r, c in cells]
    like = np.mean([off <= 0.05 for off, _ in near]) if len(near) else np.nan
    unions = []
    for k in np.random.default_rng(1).permutation(len(cells))[:outlets]:
        (row, col), (_, (their_row, their_col)) = cells[k], near[k]
        with rasterio.open(dem) as source:
            x, y = source.xy(row, col)
        tokosen(command, dem, folder, "--outlet", f"{x},{y}", "--outlet-snap", "0", "--catchments", "c.tif")
        own = np.isfinite(read(folder / "c.tif"))
        other = np.asarray(grid.catchment(x=their_col, y=their_row, fdir=theirs, xytype="index")) > 0
        unions.append((own & other).sum() / (own | other).sum())
    print(f"{dem.name}: outside pits {same[inner & ~pits].mean():.4f}, all {same[inner].mean():.4f}; accumulation {like:.3f} of {len(cells)}")
    print(f"    catchments {len(unions)}: median {np.median(unions):.3f}, above 0.95 {np.mean(np.array(unions) > 0.95):.3f}")


def edge_of_part(command, dem, folder):
    with rasterio.open(dem) as source:
        rows, cols = source.height, source.width
        window = rasterio.windows.Window(cols // 4, rows // 4, cols // 2, rows // 2)
        profile = source.profile | {"height": window.height, "width": window.width, "transform": source.window_transform(window)}
        part = source.read(1, window=window)
    with rasterio.open(folder / "part.tif", "w", **profile) as sink:
        sink.write(part, 1)
    whole = flow_of_tokosen(command, dem, folder)[0]
    top, left = rows // 4, cols // 4
    inside = border(part.shape)
    truth = np.zeros(part.shape, bool)
    for row, col in np.argwhere(inside):
        step = STEPS.get(int(np.nan_to_num(whole[top + row, left + col])), (0, 0))
        truth[row, col] = not (0 <= row + step[0] < part.shape[0] and 0 <= col + step[1] < part.shape[1])
    found = {"tokosen": flow_of_tokosen(command, folder / "part.tif", folder)[0] == 0}
    directions = np.asarray(flow_of_pysheds(folder / "part.tif")[1])
    outwards = np.zeros(part.shape, bool)
    for row, col in np.argwhere(inside):
        step = STEPS.get(int(directions[row, col]))
        outwards[row, col] = step is None or not (0 <= row + step[0] < part.shape[0] and 0 <= col + step[1] < part.shape[1])
    found["pysheds"] = outwards
    words = [f"{name} found {cells[inside & truth].mean():.3f}, false {cells[inside & ~truth].mean():.3f}" for name, cells in found.items()]
    print(f"    edge, {truth[inside].mean():.3f} of {inside.sum()} drain outwards: " + "; ".join(words))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dems", nargs="+", type=pathlib.Path, metavar="DEM.tif")
    parser.add_argument("--command", default=str(ROOT / "target" / "release" / "tokosen"))
    parser.add_argument("--outlets", type=int, default=40)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for dem in given.dems:
        with tempfile.TemporaryDirectory() as folder:
            compare(given.command, dem.resolve(), given.outlets, pathlib.Path(folder))
            edge_of_part(given.command, dem.resolve(), pathlib.Path(folder))


if __name__ == "__main__":
    main()
