"""What must hold of the lines and heights that tokosen makes from a map."""
import numpy as np
import pyogrio
import rasterio
import shapely

SHARE = 1e-3  # of the interval: rounding, and the steps of 32-bit numbers


def read_lines(path):
    _, _, wkb, columns = pyogrio.raw.read(path, columns=["elev"])
    lines = shapely.force_2d(shapely.from_wkb(wkb))
    parts, owners = shapely.get_parts(lines, return_index=True)
    return parts, np.asarray(columns[0], float)[owners]


def vertices(lines, levels):
    points, owners = shapely.get_coordinates(lines, return_index=True)
    table = np.column_stack([points, np.asarray(levels, float)[owners]])
    return set(map(bytes, np.ascontiguousarray(table + 0.0)))


def moved(lines, levels, out_lines, out_levels, original=None):
    """Vertices of the input that are not in the output, bit for bit and at their level. Of lines that tokosen cuts itself,
    only those that were there before count."""
    wanted = vertices(lines, levels)
    if original is not None:
        wanted &= vertices(*original)
    return len(wanted - vertices(out_lines, out_levels))


def crossings(lines, levels):
    """Pairs of lines of different levels that share a point."""
    tree = shapely.STRtree(lines)
    a, b = tree.query(lines, predicate="intersects")
    return int(np.count_nonzero((a < b) & (levels[a] != levels[b])))


def loops(lines):
    """Lines that touch or cross themselves."""
    return int(np.count_nonzero(~shapely.is_simple(lines)))


def read_heights(path):
    with rasterio.open(path) as source:
        heights = source.read(1).astype(float)
        if source.nodata is not None:
            heights[heights == source.nodata] = np.nan
    return heights


def certain(found):
    """Cells that the area holds, not by a rounding error, and that are no lake."""
    x, y = found.ground.centres()
    inside = shapely.contains_xy(shapely.buffer(found.area, -1e-3), x, y)
    if found.lake is not None:
        inside &= ~shapely.contains_xy(shapely.buffer(found.lake[0], 1e-3), x, y)
    return inside


def out_of_band(found, heights):
    """Cells above the level that is next above the ground, or below the one that is next below."""
    ground, interval = found.ground.heights, found.ground.interval
    below, above = np.floor(ground / interval) * interval, np.ceil(ground / interval) * interval
    off = np.fmax(below - heights, heights - above)
    return int(np.count_nonzero(certain(found) & np.isfinite(heights) & (off > SHARE * interval)))


def holes(found, heights):
    return int(np.count_nonzero(certain(found) & ~np.isfinite(heights)))


def spots_missed(found, heights):
    if found.spots is None:
        return 0
    x, y = found.ground.centres()
    rows, cols = np.nonzero(np.isin(x + 1j * y, found.spots[:, 0] + 1j * found.spots[:, 1]))
    off = np.abs(heights[rows, cols] - found.ground.heights[rows, cols])
    return int(np.count_nonzero(~(off <= SHARE * found.ground.interval)))


def below_lake(found, heights):
    """Cells beside a lake that lie below it, though the shore is much nearer than any contour below.

    At the outlet the contours do not tell where the ground begins to fall.
    """
    if found.lake is None:
        return 0
    outline, level = found.lake
    x, y = found.ground.centres()
    near = shapely.contains_xy(shapely.buffer(outline, 3 * found.ground.cell), x, y) & certain(found)
    rows, cols = np.nonzero(near)
    places = shapely.points(x[rows, cols], y[rows, cols])
    to_lower = shapely.distance(places, shapely.multilinestrings(list(found.lines[np.asarray(found.levels) < level])))
    near[rows, cols] = 2 * shapely.distance(places, outline) < to_lower
    return int(np.count_nonzero(near & (heights < level - SHARE * found.ground.interval) & (found.ground.heights >= level)))


def unlike_whole(found, heights, of_whole):
    """Cells of sheets that are further from the height map of the whole map than a twentieth of the interval."""
    return int(np.count_nonzero(certain(found) & ~(np.abs(heights - of_whole) <= 0.051 * found.ground.interval)))
