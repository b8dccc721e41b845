"""Shared by the scoring scripts: height maps, contour lines of files and of height maps, and the area that counts.

A grid's heights are at the centres of its cells; row 0 is in the north. All lengths are in map units.

The smooth surface through the cells is the cubic spline. It passes through every cell. Heights between cells come from it, and
so do contours that lie on no raster.
"""
import math
import sys

import contourpy
import numpy as np
import pyogrio
import rasterio
import shapely
from scipy import ndimage

ELEVATION_NAMES = ("elev", "elevation", "height", "ele", "z", "contour", "level")
BORDER = 0.01  # share of a grid's rows and columns that is left out along each edge
TURN = 27.0  # degrees from the map's raster to the turned one: far from 0 and from 45
TURNED_CELL = 0.8  # cells of the map in a cell of the turned raster
PAD = 12  # cells around a grid that are made up for its spline; what lies beyond them counts less than 1e-6


def read_dem(path):
    """Heights of the first band, NaN where there are none, and the affine transform of the cell corners."""
    try:
        with rasterio.open(path) as source:
            heights = source.read(1).astype(float)
            if source.nodata is not None:
                heights[heights == source.nodata] = np.nan
            return heights, source.transform
    except rasterio.errors.RasterioError as e:
        sys.exit(str(e))


def read_lines(path, layer=None, elev=None):
    """Lines of a vector file and the elevation of each: from an attribute with a usual name, else the first z."""
    try:
        meta, _, wkb, columns = pyogrio.raw.read(path, layer=layer)
    except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as e:
        sys.exit(str(e))
    if wkb is None:
        sys.exit(f"{path}: no geometries")
    fields = dict(zip(meta["fields"], columns))
    geometry = shapely.from_wkb(wkb)
    use = np.isin(shapely.get_type_id(geometry), (1, 5)) & ~shapely.is_empty(geometry)
    usual = {name.lower(): name for name in fields}
    name = elev or next((usual[n] for n in ELEVATION_NAMES if n in usual), None)
    if name is not None and name not in fields:
        sys.exit(f"{path}: no attribute {name}; there are: {', '.join(fields)}")
    parts, owner = shapely.get_parts(geometry[use], return_index=True)
    if name is not None:
        return parts, np.asarray(fields[name][use], float)[owner]
    return parts, shapely.get_z(shapely.get_point(parts, 0))


def contours(heights, transform, interval):
    """The lines at every multiple of `interval`, linear along the edges between cell centres, and their levels."""
    if not np.isfinite(heights).any():
        return np.array([], object), np.array([])
    generator = contourpy.contour_generator(z=np.ma.masked_invalid(heights))
    lines, levels = [], []
    for k in range(math.ceil(np.nanmin(heights) / interval), math.floor(np.nanmax(heights) / interval) + 1):
        for line in generator.lines(k * interval):
            line = line[np.r_[True, np.any(np.diff(line, axis=0) != 0, axis=1)]]
            if len(line) > 1:
                lines.append(shapely.linestrings(np.column_stack(to_map(transform, line[:, 1], line[:, 0]))))
                levels.append(k * interval)
    return np.array(lines, object), np.array(levels)


def turned_contours(heights, transform, interval):
    """Contours that lie on no raster of the map: those of the smooth surface, cut on a turned raster of smaller cells."""
    shape, turned = turned_raster(heights.shape, transform)
    x, y = to_map(turned, *np.indices(shape))
    return contours(spline_heights(heights, transform, x, y), turned, interval)


def turned_raster(shape, transform):
    """Shape and affine transform of a raster that covers the map and is turned about its middle."""
    rows, columns = shape
    size = math.ceil(math.hypot(rows, columns) / TURNED_CELL)
    affine = rasterio.Affine
    placed = affine.translation(columns / 2, rows / 2) * affine.rotation(TURN) * affine.scale(TURNED_CELL)
    return (size, size), transform * placed * affine.translation(-size / 2, -size / 2)


def spline_heights(heights, transform, x, y):
    """Heights of the smooth surface at map coordinates; NaN where one of the four cells around has none."""
    row, column = to_grid(transform, x, y)
    out = ndimage.map_coordinates(extended(heights), [row + PAD, column + PAD], order=3, mode="mirror")
    return np.where(between_known(heights, row, column), out, np.nan)


def extended(heights):
    """The grid with cells around it, and all gaps filled.

    A made-up cell continues the ground straight on: its height is that of the nearest known cell, plus the rise to it from the
    known cell opposite. So an even slope goes on beyond the edges, and the spline does not bend there.
    """
    padded = np.pad(heights, PAD, constant_values=np.nan)
    known = np.isfinite(padded)
    if not known.any():
        return np.zeros_like(padded)
    nearest = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    last = np.reshape(padded.shape, (2, 1, 1)) - 1
    opposite = np.clip(2 * nearest - np.indices(padded.shape), 0, last)
    at, beyond = padded[tuple(nearest)], padded[tuple(opposite)]
    return np.where(np.isfinite(beyond), 2 * at - beyond, at)


def between_known(heights, row, column):
    """Which of the broken rows and columns lie between four cells with heights."""
    rows, columns = heights.shape
    known = np.isfinite(heights)
    between = known[:-1, :-1] & known[:-1, 1:] & known[1:, :-1] & known[1:, 1:]
    inside = (row >= 0) & (row <= rows - 1) & (column >= 0) & (column <= columns - 1)
    # A place in the last row or column lies between it and the one before.
    r = np.clip(np.floor(row), 0, rows - 2).astype(int)
    c = np.clip(np.floor(column), 0, columns - 2).astype(int)
    return inside & between[r, c]


def to_map(transform, row, column):
    """Map coordinates of the cell centres at (broken) rows and columns."""
    x = transform.c + transform.a * (column + 0.5) + transform.b * (row + 0.5)
    return x, transform.f + transform.e * (row + 0.5) + transform.d * (column + 0.5)


def to_grid(transform, x, y):
    """Broken rows and columns, whole numbers at the cell centres, of map coordinates. The grid is not turned."""
    return (y - transform.f) / transform.e - 0.5, (x - transform.c) / transform.a - 0.5


def scored_area(shape, transform, lines):
    """The polygon that counts: one cell inside the convex hull of `lines`, off a border of the grid."""
    rows, columns = shape
    by, bx = max(1, int(rows * BORDER)), max(1, int(columns * BORDER))
    west, north = transform.c + bx * transform.a, transform.f + by * transform.e
    east, south = transform.c + (columns - bx) * transform.a, transform.f + (rows - by) * transform.e
    hull = shapely.convex_hull(shapely.multilinestrings(list(lines)))
    area = shapely.intersection(hull.buffer(-transform.a), shapely.box(west, south, east, north))
    shapely.prepare(area)
    return area
