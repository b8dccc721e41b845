#!/usr/bin/env python3
"""Checks that areas between contours are a partition, without any code of tokosen. It reads those of `gdal_contour -p` too.

    check_bands.py bands.gpkg --lines lines.gpkg
    check_bands.py bands.gpkg gdal.gpkg --sliver 0.5

  invalid    areas that are no valid polygons
  overlap    area that is covered more than once, as a share of all
  gap        area of holes of the whole, as a share of all: lakes without an area, cells without data
  slivers    areas whose mean width (twice the area over the length of the border) is below --sliver
  off        vertices of lines that are on no border, bit for bit (with --lines; one file of areas)

The exit status is 1 if an area is invalid, areas overlap by more than 1e-9 of all, or a vertex is off.
"""
import argparse
import sys

import numpy as np
import pyogrio
import shapely

EVEN = 1e-9  # share of the area of all


def places(geometries):
    """Each vertex as 16 bytes, so that they are compared bit for bit."""
    coordinates = np.ascontiguousarray(shapely.get_coordinates(geometries))
    return coordinates.view("V16").ravel()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bands", nargs="+")
    parser.add_argument("--lines", help="the lines between the areas")
    parser.add_argument("--sliver", type=float, default=1.0, help="map units (default: 1)")
    args = parser.parse_args()
    wrong = 0
    for path in args.bands:
        areas = shapely.get_parts(shapely.force_2d(shapely.from_wkb(pyogrio.raw.read(path)[2])))
        valid = shapely.is_valid(areas)
        size = shapely.area(areas)
        whole = shapely.union_all(np.where(valid, areas, shapely.make_valid(areas)))
        filled = shapely.union_all([shapely.polygons(shapely.get_exterior_ring(part)) for part in shapely.get_parts(whole)])
        overlap, gap = size.sum() / whole.area - 1, 1 - whole.area / filled.area
        slivers = (2 * size < args.sliver * shapely.length(areas)).sum()
        vertices = shapely.get_num_coordinates(areas).sum()
        print(f"{path}: {len(areas)} areas with {vertices} vertices, {(~valid).sum()} invalid, overlap {overlap:.1e}, gap {gap:.1e}, "
              f"{slivers} slivers, smallest {size.min():.3g}")
        wrong += (~valid).sum() + (abs(overlap) > EVEN)
        if args.lines:
            lines = shapely.force_2d(shapely.from_wkb(pyogrio.raw.read(args.lines)[2]))
            off = (~np.isin(places(lines), places(areas))).sum()
            print(f"  {off} of {shapely.get_num_coordinates(lines).sum()} vertices of lines are on no border")
            wrong += off
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
