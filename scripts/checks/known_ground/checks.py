"""What must hold of the lines and heights that tokosen makes from a map."""
import numpy as np
import pyogrio
import rasterio
import shapely
from scipy import sparse
from scipy.sparse.linalg import spsolve

import terrain
from streams import along

SHARE = 1e-3  # of the interval: rounding, and the steps of 32-bit numbers


def read_lines(path):
    _, _, wkb, columns = pyogrio.raw.read(path, layer=0, columns=["elev"])
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


def known(found):
    """Cells for which the contours tell the band."""
    if found.unknown is None:
        return certain(found)
    return certain(found) & ~shapely.contains_xy(found.unknown, *found.ground.centres())


def out_of_band(found, heights):
    """Cells above the level that is next above the ground, or below the one that is next below."""
    ground, interval = found.ground.heights, found.ground.interval
    below, above = np.floor(ground / interval) * interval, np.ceil(ground / interval) * interval
    off = np.fmax(below - heights, heights - above)
    return int(np.count_nonzero(known(found) & np.isfinite(heights) & (off > SHARE * interval)))


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
    lower = found.lines[np.asarray(found.levels) < level]
    if len(lower):
        rows, cols = np.nonzero(near)
        places = shapely.points(x[rows, cols], y[rows, cols])
        near[rows, cols] = 2 * shapely.distance(places, outline) < shapely.distance(places, shapely.multilinestrings(list(lower)))
    return int(np.count_nonzero(near & (heights < level - SHARE * found.ground.interval) & (found.ground.heights >= level)))


def unlike_whole(found, folder, heights):
    """Cells of sheets that are further from the height map of the whole map than a twentieth of the interval."""
    of_whole = read_heights(folder / "whole.tif")
    return int(np.count_nonzero(certain(found) & ~(np.abs(heights - of_whole) <= 0.051 * found.ground.interval)))


def cells_along(line, ground):
    """The cells that a line runs through, each once in a row. Of places between two cells, nobody knows the cell."""
    x, y = shapely.get_coordinates(line).T
    places = along(np.column_stack(terrain.to_grid(ground.transform, x, y)), 4)
    cells = np.round(places)
    known = (np.abs(places - cells) < 0.49).all(1) & (cells >= 0).all(1) & (cells < ground.heights.shape).all(1)
    cells = cells[known].astype(int)
    return tuple(cells[np.r_[True, (np.diff(cells, axis=0) != 0).any(1)][: len(cells)]].T)


def rises(found, folder, heights):
    """Places along streams, as they are used, where they rise or where the cells that they run through do. Cells may rise
    where the contours want it: from one band to the next."""
    interval, count = found.ground.interval, 0
    for stream in shapely.from_wkb(pyogrio.raw.read(folder / "threads2" / "diagnostics.gpkg", layer="streams")[2]):
        count += int(np.count_nonzero(np.diff(shapely.get_coordinates(stream, include_z=True)[:, 2]) > 0))
        cells = cells_along(stream, found.ground)
        z, truth = heights[cells], found.ground.heights[cells] / interval
        rise = np.diff(z) > SHARE * interval
        count += int(np.count_nonzero(rise & (np.floor(truth[1:]) < np.ceil(truth[:-1]))))
    return count


def wrong_side_of_coast(found, folder, heights):
    """Cells of the sea that are not at 0, and cells of the land that are not above it."""
    cells, truth = known(found), found.ground.heights
    sea = cells & (truth == 0) & ~(np.abs(heights) <= SHARE * found.ground.interval)
    land = cells & (truth > 0) & ~(heights > 0)
    return int(np.count_nonzero(sea | land))


def wrong_on_base(found, folder, heights):
    """Cells of a height map on a base: inside, those that differ from the one without; outside, those to which the difference
    at the border is not carried as the equation of the fade wants it. A few sweeps solve it to some hundredths."""
    based, base = read_heights(folder / "based.tif"), read_heights(folder / "base.tif")
    fade = found.runs[0][found.runs[0].index("--base-fade") + 1] / found.ground.cell
    differences = carried(heights - base, fade)
    inside = np.isfinite(heights)
    limit = np.where(inside, 0.0, 0.05 * np.abs(differences).max() + SHARE * found.ground.interval)
    wanted = np.where(inside, heights, base + differences)
    return int(np.count_nonzero(~(np.abs(based - wanted) <= limit)))


def carried(differences, fade):
    """Solves c'' = c / L^2 where differences are unknown. Nothing goes through the edge of the map. Beside a straight border
    a twentieth is left at the fade."""
    rows, cols = differences.shape
    number = np.arange(rows * cols).reshape(rows, cols)
    a = np.concatenate([number[1:].ravel(), number[:, 1:].ravel()])
    b = np.concatenate([number[:-1].ravel(), number[:, :-1].ravel()])
    ones = np.ones(len(a))
    beside = sparse.coo_matrix((ones, (a, b)), (rows * cols, rows * cols))
    beside = (beside + beside.T).tocsr()
    matrix = sparse.diags(np.asarray(beside.sum(1)).ravel() + (3.0 / fade) ** 2) - beside
    known = np.isfinite(differences).ravel()
    values = np.where(known, differences.ravel(), 0.0)
    if not known.all():
        values[~known] = spsolve(matrix.tocsr()[~known][:, ~known].tocsc(), -(matrix @ values)[~known])
    return values.reshape(rows, cols)
