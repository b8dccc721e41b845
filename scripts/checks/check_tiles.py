#!/usr/bin/env python3
"""Checks of contours in map tiles, with readers of other people.

    check_tiles.py TILES.pmtiles [CONTOURS] [--zoom Z ...] [--source SOURCE]

TILES is a PMTiles archive with the layer "contours", made by this program or another one. CONTOURS is the same map as a vector
file of this program. --source names the attribute of the elevation, if it is not "ele". For each zoom, it counts

- touching: pairs of lines of different levels that share a point, after all tiles are put together,
- borders: segments at the border of two tiles that only one of them has,
- values: tiles with elevations that CONTOURS does not have, or that are no multiple of the zoom's interval,

and it prints the size of the tiles. Exit status 0: all of them are 0; 1: some are not.
"""
import argparse
import collections
import gzip
import json
import sys

import mapbox_vector_tile
import numpy as np
import shapely
from pmtiles.reader import MmapSource, Reader, all_tiles

MOST_BYTES = 500_000
BUFFER = 1 / 64


def segments_of(tile, place, attribute):
    """The segments of a tile: (level, x, y, x, y), in steps of the zoom's grid; and the steps along a side."""
    layer = tile["contours"]
    extent = layer["extent"]
    corner = np.array(place) * extent
    found = []
    for feature in layer["features"]:
        geometry = feature["geometry"]
        lines = geometry["coordinates"] if geometry["type"] == "MultiLineString" else [geometry["coordinates"]]
        for line in lines:
            points = np.asarray(line, dtype=np.int64) + corner
            level = np.full(len(points) - 1, feature["properties"][attribute], dtype=float)
            found.append(np.column_stack([level, points[:-1], points[1:]]))
    return np.vstack(found) if found else np.empty((0, 5)), extent


def touching(segments):
    """Pairs of lines of different levels that share a point. Connected segments of a level count as one line."""
    segments = np.unique(segments, axis=0)
    segments = segments[(segments[:, 1] != segments[:, 3]) | (segments[:, 2] != segments[:, 4])]
    lines = shapely.linestrings(segments[:, 1:].reshape(-1, 2, 2))
    tree = shapely.STRtree(lines)
    left, right = tree.query(lines, predicate="intersects")
    differ = (left < right) & (segments[left, 0] != segments[right, 0])
    places = [segments[k, :3].tolist() for k in left[differ][:3]]
    return int(differ.sum()), places


def open_borders(tiles, extent):
    """Segments that meet the common border of two neighbouring tiles, and that only one of them has."""
    count = 0
    for (x, y), own in tiles.items():
        for axis, neighbour in ((0, (x + 1, y)), (1, (x, y + 1))):
            if neighbour not in tiles:
                continue
            border = (neighbour[axis]) * extent
            across = (x, y)[1 - axis] * extent
            sides = []
            for segments in (own, tiles[neighbour]):
                a, b = segments[:, 1 + axis], segments[:, 3 + axis]
                c, d = segments[:, 2 - axis], segments[:, 4 - axis]
                meets = (np.minimum(a, b) <= border) & (np.maximum(a, b) >= border)
                meets &= (np.minimum(c, d) >= across) & (np.maximum(c, d) <= across + extent)
                sides.append({tuple(row) for row in segments[meets]})
            count += len(sides[0] ^ sides[1])
    return count


def crossings_differ(tiles, extent):
    """Places where a line crosses the border of two tiles, and the other tile has none of its level within one step."""
    count = 0
    for (x, y), own in tiles.items():
        for axis, neighbour in ((0, (x + 1, y)), (1, (x, y + 1))):
            if neighbour not in tiles:
                continue
            border = neighbour[axis] * extent
            across = (x, y)[1 - axis] * extent
            sides = []
            for segments in (own, tiles[neighbour]):
                a, b = segments[:, 1 + axis], segments[:, 3 + axis]
                c, d = segments[:, 2 - axis], segments[:, 4 - axis]
                meets = ((a < border) & (b > border)) | ((a > border) & (b < border)) | ((a == border) ^ (b == border))
                share = np.divide(border - a, b - a, out=np.zeros_like(a), where=a != b)
                place = c + share * (d - c)
                meets &= (place > across + 2) & (place < across + extent - 2)
                sides.append(np.column_stack([segments[meets, 0], place[meets]]))
            for one, other in (sides, sides[::-1]):
                for level, place in one:
                    near = other[other[:, 0] == level, 1]
                    count += not (len(near) and np.abs(near - place).min() <= 1.0)
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tiles")
    parser.add_argument("contours", nargs="?")
    parser.add_argument("--zoom", type=int, action="append")
    parser.add_argument("--source", default="ele")
    args = parser.parse_args()
    known = None
    if args.contours:
        import pyogrio
        known = set(pyogrio.read_dataframe(args.contours, read_geometry=False)["elev"])
    failures = 0
    with open(args.tiles, "rb") as file:
        source = MmapSource(file)
        reader = Reader(source)
        header, about = reader.header(), reader.metadata()
        intervals = {int(zoom): step for zoom, step in about.get("intervals", {}).items()}
        print(f"{header['addressed_tiles_count']} tiles, {header['tile_contents_count']} different, clustered {header['clustered']}")
        by_zoom = collections.defaultdict(dict)
        for (zoom, x, y), data in all_tiles(source):
            by_zoom[zoom][x, y] = data
        print("zoom interval tiles extent    kB largest touching borders values")
        for zoom, tiles in sorted(by_zoom.items()):
            if args.zoom and zoom not in args.zoom:
                continue
            read, extents, odd = {}, set(), 0
            for place, data in tiles.items():
                tile = mapbox_vector_tile.decode(gzip.decompress(data), default_options={"y_coord_down": True})
                if "contours" not in tile:
                    continue
                read[place], extent = segments_of(tile, place, args.source)
                extents.add(extent)
                levels = set(read[place][:, 0])
                step = intervals.get(zoom)
                is_odd = (known is not None and not levels <= known) or (
                    step is not None and zoom < max(intervals) and any(abs(v / step - round(v / step)) > 1e-9 for v in levels))
                odd += is_odd
            assert len(extents) == 1, "tiles of one zoom differ in their extent"
            touch, places = touching(np.vstack(list(read.values())))
            borders = crossings_differ(read, extent)
            sizes = [len(data) for data in tiles.values()]
            too_large = sum(size > MOST_BYTES for size in sizes)
            print(f"{zoom:4} {intervals.get(zoom, '-'):>8} {len(tiles):5} {extent:6} {sum(sizes) / 1e3:7.1f} "
                  f"{max(sizes) / 1e3:7.1f} {touch:8} {borders:7} {odd:6}", *places)
            failures += touch + borders + odd + too_large
        if known is not None:
            finest = read
            drawn = set(np.unique(np.vstack(list(finest.values()))[:, 0]))
            missing = known - drawn
            print(f"levels of the file that the highest zoom lacks: {sorted(missing) if missing else 'none'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
