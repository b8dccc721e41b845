#!/usr/bin/env python3
"""Checks of terrain tiles, with readers of other people.

    check_terrain_tiles.py CONTOURS ZOOM [--command target/release/tokosen]

Makes terrain tiles of contours in all encodings, sizes and kinds of pictures, and a GeoTIFF with the same cells. Each pixel of
the highest zoom must have the height of the GeoTIFF, up to half a step of the encoding; each pixel of a lower zoom the mean of
the heights that it covers; and no pixel may have a height that is lower or higher than all of the GeoTIFF. Exit
status 0: all of that holds; 1: some does not.
"""
import argparse
import io
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import PIL.Image
import rasterio
from pmtiles.reader import MmapSource, Reader, all_tiles

WIDTH = 2 * 20037508.342789244
STEPS = {"terrarium": 1 / 256, "mapbox": 0.1, "gsi": 0.01}


def heights(picture, encoding):
    """The heights of a picture, in metres."""
    red, green, blue = np.moveaxis(np.asarray(picture.convert("RGB"), dtype=np.int64), 2, 0)
    number = 65536 * red + 256 * green + blue
    if encoding == "terrarium":
        return number / 256 - 32768
    if encoding == "mapbox":
        return number / 10 - 10000
    return np.where(number < 2**23, number, number - 2**24) / 100


def read(path, encoding):
    """The heights of each tile, by zoom, column and row; and the metadata."""
    with open(path, "rb") as file:
        source = MmapSource(file)
        tiles = {place: heights(PIL.Image.open(io.BytesIO(data)), encoding) for place, data in all_tiles(source)}
        return tiles, Reader(source).metadata()


def compared(tiles, zoom, side, truth, grid, step):
    """Number of pixels at the highest zoom and of those below it that are compared, and the faults."""
    counts, faults, own = [0, 0], 0, {}
    pixel = WIDTH / 2**zoom / side
    first = [round((grid.c + WIDTH / 2) / pixel), round((WIDTH / 2 - grid.f) / pixel)]
    low, high = np.nanmin(truth) - step, np.nanmax(truth) + step
    for (z, x, y), found in sorted(tiles.items(), key=lambda tile: -tile[0][0]):
        faults += int(((found < low) | (found > high)).sum()) + (found.shape != (side, side))
        # The heights that the tile should have; NaN where the height map has none.
        expected = np.full((side, side), np.nan)
        if z == zoom:
            rows, cols = y * side - first[1] + np.arange(side), x * side - first[0] + np.arange(side)
            in_rows, in_cols = (rows >= 0) & (rows < truth.shape[0]), (cols >= 0) & (cols < truth.shape[1])
            expected[np.ix_(in_rows, in_cols)] = truth[np.ix_(rows[in_rows], cols[in_cols])]
        else:
            for i, k in ((0, 0), (1, 0), (0, 1), (1, 1)):
                child = own.get((z + 1, 2 * x + i, 2 * y + k))
                if child is not None:
                    mean = child.reshape(side // 2, 2, side // 2, 2).mean(axis=(1, 3))
                    expected[k * side // 2:(k + 1) * side // 2, i * side // 2:(i + 1) * side // 2] = mean
        own[z, x, y] = expected
        off = np.abs(found - expected)
        counts[z < zoom] += int(np.isfinite(off).sum())
        faults += int((off > step / 2 + 1e-3).sum())
    return counts, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours")
    parser.add_argument("zoom", type=int)
    parser.add_argument("--command", default="target/release/tokosen")
    args = parser.parse_args()
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for side, encoding, image in ((512, "terrarium", "png"), (256, "mapbox", "webp"), (256, "gsi", "png")):
            pixel = WIDTH / 2**args.zoom / side
            run = [args.command, "dem", args.contours, "-q", "-o"]
            subprocess.run([*run, folder / "same.tif", "--to-crs", "EPSG:3857", "--cell", repr(pixel)], check=True)
            path = folder / f"{encoding}.pmtiles"
            tiled = ["--max-zoom", str(args.zoom), "--tile-size", str(side), "--tile-image", image, "--png-encoding", encoding]
            subprocess.run([*run, path, *tiled], check=True)
            with rasterio.open(folder / "same.tif") as source:
                truth, grid = source.read(1, masked=True).filled(np.nan).astype(float), source.transform
            tiles, about = read(path, encoding)
            counts, faults = compared(tiles, args.zoom, side, truth, grid, STEPS[encoding])
            faults += about["encoding"] != encoding or about["format"] != image
            print(f"{encoding:9} {side} {image:4}: {len(tiles)} tiles, {path.stat().st_size / 1e3:.0f} kB, {counts[0]} pixels and {counts[1]} of lower zooms compared, "
                  f"{faults} faults")
            failures += faults + (min(counts) == 0)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
