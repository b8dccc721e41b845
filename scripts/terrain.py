"""Shared by the scoring scripts: height maps, contour lines of files and of height maps, and the area that counts.

A grid's heights are at the centres of its cells; row 0 is in the north. All lengths are in map units.
"""
import math
import sys

import contourpy
import numpy as np
import pyogrio
import rasterio
import shapely

ELEVATION_NAMES = ("elev", "elevation", "height", "ele", "z", "contour", "level")
BORDER = 0.01  # share of a grid's rows and columns that is left out along each edge


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
    generator = contourpy.contour_generator(z=np.ma.masked_invalid(heights))
    lines, levels = [], []
    for k in range(math.ceil(np.nanmin(heights) / interval), math.floor(np.nanmax(heights) / interval) + 1):
        for line in generator.lines(k * interval):
            line = line[np.r_[True, np.any(np.diff(line, axis=0) != 0, axis=1)]]
            if len(line) > 1:
                lines.append(shapely.linestrings(np.column_stack(to_map(transform, line[:, 1], line[:, 0]))))
                levels.append(k * interval)
    return np.array(lines, object), np.array(levels)


def to_map(transform, row, column):
    """Map coordinates of the cell centres at (broken) rows and columns."""
    return transform.c + transform.a * (column + 0.5), transform.f + transform.e * (row + 0.5)


def to_grid(transform, x, y):
    """Broken rows and columns, whole numbers at the cell centres, of map coordinates."""
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
