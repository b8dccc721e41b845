#!/usr/bin/env python3
"""Makes the real-terrain sample: 20 m contour lines of the hills around Caryville, Tennessee, and their truth.

    python3 -m venv .venv && .venv/bin/pip install -r scripts/requirements.txt
    .venv/bin/python scripts/make/make_real_sample.py            # writes samples/caryville_20m.gpkg and _truth.tif

Source: the file jacksboro_fault_dem.npz among matplotlib's sample data, heights of the Shuttle Radar Topography
Mission (SRTM) at 3 arc seconds, whole metres, a work of the US government in the public domain.

Steps, in the order of the code:
1. Place the grid. Its cells are 1/1200 degree and the outer corner of the first cell is (xmin, north edge). The file
   gives `ymin` = `ymax` + 344 cells, so `ymin` lies north of `ymax`: a sign was lost when the south edge was computed.
   `ymax` is the north edge. So placed, the ridges, gaps and the reservoir fall where maps have them (the gap of
   Caryville at 36.30 N 84.22 W); 0.29 degrees further north they would not.
2. Smooth with a Gaussian of SIGMA cells, which takes out the whole-metre steps and little else.
3. Project: a square grid of CELL metres in UTM zone 16N (EPSG:32616), heights by cubic spline from the smoothed grid.
   Heights are rounded to a centimetre: this grid is the truth.
4. Cut contours through the cell centres of the truth at every multiple of INTERVAL, linearly along grid edges.
   Coordinates are rounded to a centimetre. Lines that leave the sheet stay open.
5. Check that no two lines touch and no line touches itself, then write both files.

The same versions of the libraries give the same bytes.
"""
import argparse
import math
import os
import pathlib

import contourpy
import matplotlib.cbook
import numpy as np
import pyogrio
import pyproj
import rasterio
import shapely
from scipy import ndimage

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
NAME = "caryville_20m"
EPSG = 32616
WEST, SOUTH = 744_000, 4_015_500  # south-west corner of the sheet, UTM metres
WIDTH, HEIGHT = 10_500, 9_000  # size of the sheet, metres
CELL = 30.0  # cell of the truth, metres
SIGMA = 0.8  # Gaussian, in cells of 3 arc seconds (about 75 by 92 m)
INTERVAL = 20.0  # contour interval, metres


def truth():
    """Heights at the cell centres of the sheet, row 0 in the north, and the grid's affine transform."""
    with np.load(matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as d:
        z, west, north = d["elevation"].astype(float), float(d["xmin"]), float(d["ymax"])
        dx, dy = float(d["dx"]), float(d["dy"])
    z = ndimage.gaussian_filter(z, SIGMA, mode="nearest")
    cols, rows = round(WIDTH / CELL), round(HEIGHT / CELL)
    x = WEST + (np.arange(cols) + 0.5) * CELL
    y = SOUTH + HEIGHT - (np.arange(rows) + 0.5) * CELL
    gx, gy = np.meshgrid(x, y)
    lon, lat = pyproj.Transformer.from_crs(EPSG, 4326, always_xy=True).transform(gx, gy)
    col, row = (lon - west) / dx - 0.5, (north - lat) / dy - 0.5
    inside = (col >= 0) & (col <= z.shape[1] - 1) & (row >= 0) & (row <= z.shape[0] - 1)
    if not inside.all():
        raise SystemExit("the sheet reaches beyond the source grid")
    h = np.round(ndimage.map_coordinates(z, [row, col], order=3, mode="nearest"), 2)
    return h, rasterio.transform.from_origin(WEST, SOUTH + HEIGHT, CELL, CELL), x, y


def contours(h, x, y):
    """Contour lines [(elevation, (n, 2) coordinates)], low to high."""
    gen = contourpy.contour_generator(x=x, y=y, z=h, line_type=contourpy.LineType.Separate)
    out = []
    for k in range(math.ceil(h.min() / INTERVAL), math.floor(h.max() / INTERVAL) + 1):
        for line in gen.lines(k * INTERVAL):
            line = np.round(line, 2)
            line = line[np.r_[True, np.any(np.diff(line, axis=0) != 0, axis=1)]]
            if len(line) > 2 or (len(line) == 2 and not np.array_equal(line[0], line[1])):
                out.append((k * INTERVAL, line))
    return out


def check(lines):
    """Stops when two lines share a point or a line touches itself."""
    geo = np.array([shapely.linestrings(l) for _, l in lines])
    bad = [i for i in range(len(geo)) if not shapely.is_simple(geo[i])]
    a, b = shapely.STRtree(geo).query(geo, predicate="intersects")
    bad += [(int(i), int(j)) for i, j in zip(a, b) if i < j]
    if bad:
        raise SystemExit(f"lines touch: {bad[:10]}")


def main():
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    h, transform, x, y = truth()
    lines = contours(h, x, y)
    check(lines)
    tif, gpkg = SAMPLES / f"{NAME}_truth.tif", SAMPLES / f"{NAME}.gpkg"
    for path in (tif, gpkg):
        path.unlink(missing_ok=True)
    with rasterio.open(tif, "w", driver="GTiff", dtype="float32", count=1, width=h.shape[1], height=h.shape[0],
                       crs=f"EPSG:{EPSG}", transform=transform, compress="deflate", predictor=3, zlevel=9,
                       tiled=True, blockxsize=256, blockysize=256) as f:
        f.write(h.astype("float32"), 1)
    # A fixed date keeps the file the same from run to run.
    pyogrio.set_gdal_config_options({"OGR_CURRENT_DATE": "2000-01-01T00:00:00Z"})
    pyogrio.raw.write(
        gpkg, layer="contours", driver="GPKG", crs=f"EPSG:{EPSG}", geometry_type="LineString Z",
        geometry=shapely.to_wkb([shapely.linestrings(np.column_stack([l, np.full(len(l), e)])) for e, l in lines],
                                output_dimension=3),
        field_data=[np.array([e for e, _ in lines])], fields=["elev"],
        dataset_options={"VERSION": "1.2"}, layer_options={"SPATIAL_INDEX": "NO"})
    closed = sum(np.array_equal(l[0], l[-1]) for _, l in lines)
    print(f"{len(lines)} lines ({closed} closed), {sum(len(l) for _, l in lines)} vertices, "
          f"levels {lines[0][0]:g} to {lines[-1][0]:g}, heights {h.min()} to {h.max()}")
    for path in (tif, gpkg):
        print(f"{path.name}: {os.path.getsize(path)} bytes")


if __name__ == "__main__":
    main()
